"""Loader of a spec file and its golden frames: read, decode, resolve, check."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..diagnostics.diagnostic import Diagnostic, SpecError
from ..document.document import Document, read_document
from ..language.decoder import decode
from ..language.edition import EditionSpec
from ..resolve.edition import resolve
from ..resolve.golden_frames import resolve_golden_frames
from ..rules.checker import check
from ..rules.rule import CheckInput
from ..targets.base import EditionInput
from ..targets.registry import targets
from ..templating.resources import SYNONYMS, UNITS
from .golden_file import GoldenFile, read_golden_file

FRAMES_SUFFIX = ".frames.yaml"
_NO_SPECS = (UNITS.name, SYNONYMS.name)


@dataclass(frozen=True)
class Loaded:
    """A valid spec: the input of targets, the document, and warnings."""

    specification: EditionInput
    document: Document
    warnings: tuple[Diagnostic, ...]


def load(file: Path, name: str | None = None, *, golden: bool = True) -> Loaded:
    """The edition in `file`, with the golden frames beside it, unless `golden` is False.

    `name` is the name of the file in findings; by default its path. Raises SpecError with all findings if one of them
    is an error, and OSError.
    """
    frames = frames_file(file)
    golden_file = read_golden_file(frames) if golden and frames.is_file() else GoldenFile()
    try:
        return _load(file, name, golden_file)
    except SpecError as error:
        raise SpecError([*error.diagnostics, *golden_file.findings]) from None


def _load(file: Path, name: str | None, golden_file: GoldenFile) -> Loaded:
    document, content = read_document(file, name)
    decoded = decode(document, EditionSpec)
    if decoded.value is None:
        raise SpecError(decoded.findings)
    spec = decoded.value
    digest = hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()
    try:
        edition, unresolved = resolve(document, spec, digest, decoded.invalid)
    except SpecError as error:
        raise SpecError([*decoded.findings, *error.diagnostics]) from None
    names = {"family": edition.family, "edition": edition.name}
    others = golden_file.other_edition({key: text for key, text in names.items() if (key,) not in decoded.invalid})
    errors = [*decoded.findings, *unresolved.findings, *golden_file.findings, *others]
    golden = None if golden_file.golden is None else resolve_golden_frames(edition, golden_file.golden)
    subject = CheckInput(edition, spec, golden)
    errors, warnings = check(subject, document, golden_file.document, errors, decoded.invalid, unresolved)
    if errors:
        raise SpecError([*errors, *warnings])
    return Loaded(EditionInput(edition, golden), document, tuple(sorted(warnings, key=lambda d: d.place)))


def specification(file: Path) -> EditionInput:
    """The input of targets for the edition in `file`. Raises as `load`."""
    return load(file).specification


def all_loaded(files: Iterable[Path]) -> list[Loaded]:
    """The editions of `files`, sorted by family and name. Raises SpecError with the findings of all files."""
    results = [_load_or_findings(file) for file in files]
    if not all(isinstance(one, Loaded) for one in results):
        raise SpecError(f for one in results for f in (one.warnings if isinstance(one, Loaded) else one))
    result = [one for one in results if isinstance(one, Loaded)]
    result.sort(key=lambda one: (one.specification.edition.family, one.specification.edition.name))
    findings = [
        later.document.finding(
            ("edition",),
            "name-collision",
            f"{earlier.document.name} describes {later.specification.edition.family} {later.specification.edition.name}, too",
            "rename one of the editions",
        )
        for earlier, later in itertools.pairwise(result)
        if _name(earlier) == _name(later)
    ]
    if findings:
        raise SpecError(findings)
    editions = [one.specification.edition for one in result]
    clashes = (clash for target in targets() for clash in target.collisions(editions))
    documents = {one.specification.edition: one.document for one in result}
    findings = [
        documents[edition].finding(("edition",), "name-collision", text, "rename this edition")
        for edition, text in clashes
    ]
    if findings:
        raise SpecError(findings)
    return result


def _load_or_findings(file: Path) -> Loaded | Sequence[Diagnostic]:
    """A loaded spec, or its findings."""
    try:
        return load(file)
    except SpecError as error:
        return error.diagnostics


def _name(one: Loaded) -> tuple[str, str]:
    return one.specification.edition.family, one.specification.edition.name


def frames_file(file: Path) -> Path:
    """The path of the golden frames of a spec."""
    return file.with_name(file.name.removesuffix(file.suffix) + FRAMES_SUFFIX)


def spec_files(folder: Path) -> list[Path]:
    """The specs below a folder: `FAMILY/EDITION.yaml`, without golden frames."""
    return sorted(f for f in folder.glob("*/*.yaml") if not f.name.endswith(FRAMES_SUFFIX))


def specs_below(folder: Path) -> list[Path]:
    """The specs in a folder and in its folders: `FAMILY/EDITION.yaml` and `EDITION.yaml`."""
    own = (f for f in folder.glob("*.yaml") if not f.name.endswith(FRAMES_SUFFIX) and f.name not in _NO_SPECS)
    return sorted([*own, *spec_files(folder)])
