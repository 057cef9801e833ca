"""Loader of a spec file and its golden frames, phase by phase; each phase reports all that it finds, then the run ends."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..diagnostics.diagnostic import Diagnostic, SpecError
from ..document.document import MAX_BYTES, Document, read_document
from ..language.decoder import decode
from ..language.edition import EditionSpec
from ..language.references import check_references
from ..model.edition import Edition
from ..resolve.edition import resolve
from ..rules.checker import check
from ..rules.rule import CheckInput
from ..targets.base import EditionInput
from ..targets.registry import targets
from ..templating.resources import NO_ANSWER, QUESTIONS, QUICK_START, SYNONYMS, UNITS

if TYPE_CHECKING:
    from .golden_file import GoldenFile

FRAMES_SUFFIX = ".frames.yaml"
_NO_SPECS = tuple(file.name for file in (UNITS, SYNONYMS, QUESTIONS, QUICK_START, NO_ANSWER))


class Loaded(NamedTuple):
    """A valid spec: the input of targets, the document, and warnings."""

    specification: EditionInput
    document: Document
    warnings: tuple[Diagnostic, ...]
    golden: GoldenFile | None
    """All golden frames, of which the input of targets has those with a source."""


def load(file: Path, name: str | None = None, *, for_output: bool = True) -> Loaded:
    """The edition in `file`, with the golden frames beside it.

    Without `for_output`, golden frames and targets are not loaded, so that names are not compared with theirs. `name` is
    the name of the file in findings; by default its path. Raises OSError, and SpecError with all findings of the first
    phase with an error: YAML, keys and values, references, edition, golden frames, rules.
    """
    document, _ = read_document(file, name)
    decoded = decode(document, EditionSpec)
    check_references(document, decoded.names)
    edition = resolve(document, decoded.value)
    golden = _golden_file(frames_file(file), edition) if for_output else None
    frames, frames_document = golden or (None, None)
    warnings = check(CheckInput(edition, decoded.value, frames), document, frames_document, for_output=for_output)
    reviewed = frames and frames.reviewed
    return Loaded(EditionInput(edition, reviewed), document, tuple(sorted(warnings, key=lambda d: d.place)), golden)


def _golden_file(file: Path, edition: Edition) -> GoldenFile | None:
    """The golden frames in a file, if it is there."""
    from .golden_file import read_golden_file  # not every command needs them

    return read_golden_file(file, edition) if file.is_file() else None


def specification(file: Path, *, for_output: bool = True) -> EditionInput:
    """The input of targets for the edition in `file`. Raises as `load`."""
    return load(file, for_output=for_output).specification


def all_loaded(files: Iterable[Path], *, for_output: bool = True) -> list[Loaded]:
    """The editions of `files`, sorted by family and name. Raises SpecError with the findings of all files. See `load`."""
    results = [_load_or_findings(file, for_output=for_output) for file in files]
    if not all(isinstance(result, Loaded) for result in results):
        raise SpecError(f for result in results for f in (result.warnings if isinstance(result, Loaded) else result))
    loaded = sorted((result for result in results if isinstance(result, Loaded)), key=_name)
    findings = [
        later.document.finding(
            ("edition",),
            "name-collision",
            f"{earlier.document.name} describes {later.specification.edition.family} {later.specification.edition.name}, too",
            "rename one of the editions",
        )
        for earlier, later in itertools.pairwise(loaded)
        if _name(earlier) == _name(later)
    ]
    if findings:
        raise SpecError(findings)
    if not for_output:
        return loaded
    editions = [item.specification.edition for item in loaded]
    clashes = (clash for target in targets() for clash in target.collisions(editions))
    documents = {item.specification.edition: item.document for item in loaded}
    findings = [
        documents[edition].finding(("edition",), "name-collision", text, "rename this edition")
        for edition, text in clashes
    ]
    if findings:
        raise SpecError(findings)
    return loaded


def _load_or_findings(file: Path, *, for_output: bool) -> Loaded | Sequence[Diagnostic]:
    """A loaded spec, or its findings."""
    try:
        return load(file, for_output=for_output)
    except SpecError as error:
        return error.diagnostics


def _name(item: Loaded) -> tuple[str, str]:
    return item.specification.edition.family, item.specification.edition.name


def frames_file(file: Path) -> Path:
    """The path of the golden frames of a spec."""
    return file.with_name(file.name.removesuffix(file.suffix) + FRAMES_SUFFIX)


def spec_files(folder: Path) -> list[Path]:
    """The specs below a folder: `FAMILY/EDITION.yaml`, without golden frames."""
    return sorted(f for f in folder.glob("*/*.yaml") if not f.name.endswith(FRAMES_SUFFIX))


def project_specs(folder: Path, specs: Path) -> list[Path]:
    """The specs of the project in a folder: those below its folder `specs`, or else the files in it that start as specs do.

    Other YAML files lie in the folder of a project, too, so a spec in it is known by its key `canwright`.
    """
    return spec_files(folder / specs) or [
        file for file in specs_below(folder) if file.parent == folder and _is_spec(file)
    ]


def _is_spec(file: Path) -> bool:
    with file.open("rb") as content:
        return re.search(rb"^(\xef\xbb\xbf)?canwright *:", content.read(MAX_BYTES), re.MULTILINE) is not None


def specs_below(folder: Path) -> list[Path]:
    """The specs in a folder and in its folders: `FAMILY/EDITION.yaml` and `EDITION.yaml`."""
    own = (f for f in folder.glob("*.yaml") if not f.name.endswith(FRAMES_SUFFIX) and f.name not in _NO_SPECS)
    return sorted([*own, *spec_files(folder)])
