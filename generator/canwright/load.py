"""A spec file and its golden frames, read and resolved."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

from . import rules, source
from .diagnostics import Diagnostic, SpecError
from .golden import GoldenFrames
from .model import Edition
from .resolve import resolve
from .targets import Described
from .validate import validate

FRAMES_SUFFIX = ".frames.yaml"


def described(file: Path) -> Described:
    """The edition in `file`, with the golden frames beside it where there are any. Raises SpecError, OSError."""
    document, content = source.read(file)
    digest = hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()
    edition = resolve(document, digest)
    findings = list(rules.check(edition, document))
    if findings:
        raise SpecError(findings)
    beside = frames_file(file)
    return Described(edition, frames(beside, edition) if beside.is_file() else None)


def all_described(files: Iterable[Path]) -> list[Described]:
    """Every edition of `files`, in order of family and edition. Raises SpecError with the findings of all files."""
    result: list[Described] = []
    findings: list[Diagnostic] = []
    for file in files:
        try:
            result.append(described(file))
        except SpecError as error:
            findings += error.diagnostics
    if findings:
        raise SpecError(findings)
    return sorted(result, key=lambda d: (d.edition.family, d.edition.name))


def frames_file(file: Path) -> Path:
    """Where the golden frames of a spec stand."""
    return file.with_name(file.name.removesuffix(file.suffix) + FRAMES_SUFFIX)


def spec_files(folder: Path) -> list[Path]:
    """The editions below a folder: `FAMILY/EDITION.yaml`, without golden frames."""
    return sorted(f for f in folder.glob("*/*.yaml") if not f.name.endswith(FRAMES_SUFFIX))


def frames(file: Path, edition: Edition) -> GoldenFrames:
    """Golden frames of an edition. Raises SpecError, also when they are another edition's."""
    document, _ = source.read(file)
    golden = validate(document, GoldenFrames)
    for key, wanted in (("family", edition.family), ("edition", edition.name)):
        if getattr(golden, key) != wanted:
            raise SpecError([document.finding((key,), "other-edition", f"these frames stand beside {key} `{wanted}`")])
    return golden
