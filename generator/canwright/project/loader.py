"""A spec file and its golden frames, read, resolved and checked."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from .. import rules
from ..diagnostics.diagnostic import MOST_FINDINGS, Diagnostic, DocumentPath, Severity, SpecError
from ..document.document import Document, read_document
from ..language.edition import EditionSpec
from ..language.validate import Validated, validate_parts
from ..resolve.doubts import Doubts, is_text, matters
from ..resolve.edition import resolve
from ..rules import Finding, Phase, Rule, Subject
from ..rules.too_large import commands
from ..targets.base import Specification
from ..targets.registry import targets
from .golden_file import Beside, read as read_frames

FRAMES_SUFFIX = ".frames.yaml"


@dataclass(frozen=True)
class Loaded:
    """A spec that is right: what targets are given of it, its text with positions, and what might be better."""

    specification: Specification
    document: Document
    warnings: tuple[Diagnostic, ...]


def load(file: Path, name: str | None = None, *, golden: bool = True) -> Loaded:
    """The edition in `file`, with the golden frames beside it where there are any, unless without `golden`.

    `name` is what findings call the file, when it is not the path. Raises SpecError with all findings when one of them
    is an error, and OSError.
    """
    frames = frames_file(file)
    return _load(file, name, read_frames(frames) if golden and frames.is_file() else Beside())


def _load(file: Path, name: str | None, frames: Beside) -> Loaded:
    try:
        document, content, read, spec = _written(file, name)
    except SpecError as error:
        raise SpecError([*error.diagnostics, *frames.findings]) from None
    digest = hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()
    ids = {path for path in read.doubtful if path[:1] == ("addresses",)}
    edition, unresolved = resolve(document, spec, digest, read.dropped | ids)
    said = {"family": edition.family, "edition": edition.name}
    beside = frames.beside({key: text for key, text in said.items() if (key,) not in read.dropped})
    amiss, first = [*read.doubtful, *unresolved.paths], _first_address(document)
    doubts = Doubts(spec, amiss, first)
    findings = [*read.diagnostics, *unresolved.findings, *beside.findings]
    is_partial = not all(map(is_text, (*read.dropped, *unresolved.paths)))
    subject = Subject(edition, spec, beside.golden, is_partial)
    found, of_frames = list(rules.check(subject, doubts, *Phase)), doubts
    if _errors(found):
        found, of_frames = _found_by_phase(subject, amiss, first)
    wrong = bool(findings or _errors(found))
    known = {_place(d): d.rule for d in findings}
    for rule, finding in itertools.islice(found, MOST_FINDINGS):
        diagnostic = _diagnostic(document, beside, rule, finding)
        again = known.setdefault(_place(diagnostic), rule.id) != rule.id and finding.key
        if not (again or (wrong and finding.unless_wrong) or _follows(finding, read.dropped, beside, of_frames)):
            findings.append(diagnostic)
    if wrong:
        raise SpecError(findings)
    findings.sort(key=_place)
    return Loaded(Specification(edition, beside.golden), document, tuple(findings))


def _found_by_phase(
    subject: Subject, amiss: Sequence[DocumentPath], first: str
) -> tuple[list[tuple[Rule, Finding]], Doubts]:
    """What rules find where there are errors: each phase leaves out what one before it doubts; what the last doubts."""
    doubts = Doubts(subject.spec, amiss, first)
    found = list(rules.check(subject, doubts, Phase.PARTS))
    widely = [f.about for f in _errors(found) if f.about is not None]
    if widely:
        subject, doubts = subject._replace(partial=True), Doubts(subject.spec, [*amiss, *widely], first)
    found += rules.check(subject, doubts, Phase.WHOLE)
    errors = [f.path if f.about is None else f.about for f in _errors(found)]
    of_frames = Doubts(subject.spec, [*amiss, *errors], first)
    return [*found, *rules.check(subject, of_frames, Phase.FRAMES)], of_frames


def _written(file: Path, name: str | None) -> tuple[Document, bytes, Validated[EditionSpec], EditionSpec]:
    """A file, and what of it is a spec. Raises SpecError when too little is, and OSError."""
    document, content = read_document(file, name)
    read = validate_parts(document, EditionSpec)
    if read.spec is None:
        raise SpecError(read.diagnostics)
    too_many = [document.finding(f.path, "too-large", f.message, f.hint, key=f.key) for f in commands(read.spec)]
    if too_many:
        raise SpecError([*read.diagnostics, *too_many])
    return document, content, read, read.spec


def _errors(found: Sequence[tuple[Rule, Finding]]) -> list[Finding]:
    return [finding for rule, finding in found if rule.severity is Severity.ERROR]


def _diagnostic(document: Document, beside: Beside, rule: Rule, finding: Finding) -> Diagnostic:
    path = finding.path
    if finding.in_frames and beside.document is not None:
        document, path = beside.document, beside.path(path)
    warning = rule.severity is Severity.WARNING
    return document.finding(path, rule.id, finding.message, finding.hint, key=finding.key, warning=warning)


def _follows(finding: Finding, dropped: Collection[DocumentPath], beside: Beside, doubts: Doubts) -> bool:
    """Whether a finding may only be there because something else is amiss."""
    path = finding.path
    if finding.in_frames:
        commands = beside.commands(path)
        return doubts.any if commands is None else not all(map(doubts.knows, commands))
    return any(path[: len(lost)] == lost or (lost[: len(path)] == path and matters(lost)) for lost in dropped)


def _first_address(document: Document) -> str:
    """The address of commands that name none, as it is written."""
    addresses = document.data.get("addresses") if isinstance(document.data, dict) else None
    return next(iter(addresses), "") if isinstance(addresses, dict) else ""


def specification(file: Path) -> Specification:
    """What targets are given of the edition in `file`. Raises as `load`."""
    return load(file).specification


def all_loaded(files: Iterable[Path]) -> list[Loaded]:
    """Every edition of `files`, in order of family and edition. Raises SpecError with the findings of all files."""
    tried = [_tried(file) for file in files]
    if not all(isinstance(one, Loaded) for one in tried):
        raise SpecError(f for one in tried for f in (one.warnings if isinstance(one, Loaded) else one))
    result = [one for one in tried if isinstance(one, Loaded)]
    result.sort(key=lambda one: (one.specification.edition.family, one.specification.edition.name))
    findings = [
        later.document.finding(
            ("edition",),
            "name-collision",
            f"{earlier.document.name} is {later.specification.edition.family} {later.specification.edition.name} as well",
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
        documents[edition].finding(("edition",), "name-collision", text, "rename one of the editions")
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


def _name(one: Loaded) -> tuple[str, str]:
    return one.specification.edition.family, one.specification.edition.name


def frames_file(file: Path) -> Path:
    """Where the golden frames of a spec stand."""
    return file.with_name(file.name.removesuffix(file.suffix) + FRAMES_SUFFIX)


def spec_files(folder: Path) -> list[Path]:
    """The editions below a folder: `FAMILY/EDITION.yaml`, without golden frames."""
    return sorted(f for f in folder.glob("*/*.yaml") if not f.name.endswith(FRAMES_SUFFIX))


def _place(finding: Diagnostic) -> tuple[str, int, int]:
    return (finding.position.file, finding.position.line, finding.position.column)
