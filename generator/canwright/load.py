"""A spec file and its golden frames, read, resolved and checked."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from . import rules, source
from .diagnostics import MOST_FINDINGS, Diagnostic, Severity, SpecError, nearest
from .golden import GoldenFrames
from .model import Edition, Path as ItemPath
from .processes import for_each
from .resolve import resolve
from .rules import Subject
from .rules.too_large import commands
from .schema import EditionSpec
from .source import Document
from .targets import Described, c
from .validate import validate_parts

FRAMES_SUFFIX = ".frames.yaml"


@dataclass(frozen=True)
class Loaded:
    """A spec that is right: what targets are given of it, its text with positions, and what might be better."""

    described: Described
    document: Document
    warnings: tuple[Diagnostic, ...]


def load(file: Path, name: str | None = None, *, golden: bool = True) -> Loaded:
    """The edition in `file`, with the golden frames beside it where there are any, unless without `golden`.

    `name` is what findings call the file, when it is not the path. Raises SpecError with all findings when one of them
    is an error, and OSError.
    """
    document, content = source.read(file, name)
    read = validate_parts(document, EditionSpec)
    if read.spec is None:
        raise SpecError(read.diagnostics)
    too_many = [document.finding(f.path, "too-large", f.message, f.hint, key=f.key) for f in commands(read.spec)]
    if too_many:
        raise SpecError([*read.diagnostics, *too_many])
    digest = hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()
    edition, unresolved = resolve(document, read.spec, digest, read.dropped)
    findings = [*read.diagnostics, *unresolved]
    beside = frames_file(file)
    frames, frames_document = None, document
    if golden and beside.is_file():
        try:
            frames_document, _ = source.read(beside)
            frames, amiss = _frames(frames_document, edition)
            findings += amiss
        except SpecError as error:
            findings += error.diagnostics
    known = {_place(d): d.rule for d in findings}
    found = list(rules.check(Subject(edition, read.spec, frames), whole=not findings))
    wrong = bool(findings) or any(rule.severity is Severity.ERROR for rule, _ in found)
    for rule, finding in itertools.islice(found, MOST_FINDINGS):
        warning = rule.severity is Severity.WARNING
        where = frames_document if finding.in_frames else document
        diagnostic = where.finding(
            finding.path, rule.id, finding.message, finding.hint, key=finding.key, warning=warning
        )
        spoilt = any(_related(finding.path, path) for path in read.dropped)
        told = known.setdefault(_place(diagnostic), rule.id) != rule.id
        if not (spoilt or told or (wrong and warning and rule.whole)):
            findings.append(diagnostic)
    if wrong:
        raise SpecError(findings)
    return Loaded(Described(edition, frames), document, tuple(findings))


def described(file: Path) -> Described:
    """What targets are given of the edition in `file`. Raises as `load`."""
    return load(file).described


def all_loaded(files: Iterable[Path]) -> list[Loaded]:
    """Every edition of `files`, in order of family and edition. Raises SpecError with the findings of all files."""
    tried = for_each(_tried, list(files))
    findings = [finding for one in tried if not isinstance(one, Loaded) for finding in one]
    if findings:
        raise SpecError(findings)
    result = [one for one in tried if isinstance(one, Loaded)]
    result.sort(key=lambda one: (one.described.edition.family, one.described.edition.name))
    documents = {id(one.described.edition): one.document for one in result}
    clashes = c.between([one.described.edition for one in result])
    findings = [
        documents[id(edition)].finding(("edition",), "name-collision", text, "rename one of the editions")
        for edition, text in clashes
    ]
    if findings:
        raise SpecError(findings)
    return result


def _tried(file: Path) -> Loaded | Sequence[Diagnostic]:
    """An edition, or what is wrong with it."""
    try:
        return load(file)
    except SpecError as error:
        return error.diagnostics


def frames_file(file: Path) -> Path:
    """Where the golden frames of a spec stand."""
    return file.with_name(file.name.removesuffix(file.suffix) + FRAMES_SUFFIX)


def spec_files(folder: Path) -> list[Path]:
    """The editions below a folder: `FAMILY/EDITION.yaml`, without golden frames."""
    return sorted(f for f in folder.glob("*/*.yaml") if not f.name.endswith(FRAMES_SUFFIX))


def _frames(document: Document, edition: Edition) -> tuple[GoldenFrames | None, list[Diagnostic]]:
    """Golden frames of an edition, and what is amiss with them: then they are None."""
    read = validate_parts(document, GoldenFrames)
    if read.spec is None or read.diagnostics:
        return None, list(read.diagnostics)
    others = [
        document.finding((key,), "other-edition", f"these frames stand beside {key} `{wanted}`", f"{key}: {wanted}")
        for key, wanted in (("family", edition.family), ("edition", edition.name))
        if getattr(read.spec, key) != wanted
    ]
    known = read.spec.sources
    others += [
        document.finding((*path, "source"), "unknown-reference", f"there is no source `{name}`", nearest(name, known))
        for path, name in _sources(read.spec)
        if name not in known
    ]
    return (None if others else read.spec), others


def _sources(golden: GoldenFrames) -> Iterator[tuple[ItemPath, str]]:
    """Every entry of the golden frames, with the name of its source."""
    for key, entries in (("frames", golden.frames), ("refused", golden.refused), ("exchanges", golden.exchanges)):
        yield from (((key, i), entry.source) for i, entry in enumerate(entries))


def _place(finding: Diagnostic) -> tuple[str, int, int]:
    return (finding.position.file, finding.position.line, finding.position.column)


def _related(one: ItemPath, other: ItemPath) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]
