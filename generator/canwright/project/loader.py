"""Loader of a spec file and its golden frames: read, decode, resolve, check."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from .. import rules
from ..diagnostics.diagnostic import MOST_FINDINGS, Diagnostic, DocumentPath, Severity, SpecError
from ..document.document import Document, read_document
from ..language.decoder import decode
from ..language.edition import EditionSpec
from ..resolve.affected import Affected, decides_code
from ..resolve.edition import resolve
from ..rules import Finding, Phase, Rule, Subject
from ..rules.too_large import commands
from ..targets.base import Specification
from ..targets.registry import targets
from .golden_file import GoldenFile, read_golden_file

FRAMES_SUFFIX = ".frames.yaml"


@dataclass(frozen=True)
class Loaded:
    """A valid spec: the input of targets, the document, and warnings."""

    specification: Specification
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
    too_many = [document.finding(f.path, "too-large", f.message, f.hint, key=f.key) for f in commands(spec)]
    if too_many:
        raise SpecError([*decoded.findings, *too_many])
    digest = hashlib.sha256(content.replace(b"\r\n", b"\n")).hexdigest()
    edition, unresolved = resolve(document, spec, digest, decoded.invalid)
    names = {"family": edition.family, "edition": edition.name}
    others = golden_file.other_edition({key: text for key, text in names.items() if (key,) not in decoded.invalid})
    errors = [*decoded.findings, *unresolved.findings, *golden_file.findings, *others]
    checker = _Checker(document, golden_file, Subject(edition, spec, golden_file.golden), errors)
    checker.check(Phase.PARTS, [*decoded.invalid, *unresolved.references])
    checker.check(Phase.CODES, filter(decides_code, [*decoded.invalid, *unresolved.paths]))
    checker.check(Phase.WHOLE, [*decoded.invalid, *unresolved.paths, *checker.invalid])
    for phase in (Phase.FRAMES, Phase.COVERAGE):
        if not checker.errors:
            checker.check(phase, [])
    if checker.errors:
        raise SpecError([*checker.errors, *checker.warnings])
    return Loaded(Specification(edition, golden_file.golden), document, tuple(sorted(checker.warnings, key=_position)))


class _Checker:
    """Checks the rules of each phase, and collects their findings."""

    def __init__(
        self, document: Document, golden_file: GoldenFile, subject: Subject, errors: Sequence[Diagnostic]
    ) -> None:
        self._document = document
        self._golden_file = golden_file
        self._subject = subject
        self._rules = {_position(error): error.rule for error in errors}
        self.errors = list(errors)
        self.warnings: list[Diagnostic] = []
        self.invalid: list[DocumentPath] = []

    def check(self, phase: Phase, invalid: Iterable[DocumentPath]) -> None:
        """Checks the definitions that are unaffected by errors at the `invalid` paths."""
        affected = Affected(self._document.data, invalid)
        edition = affected.others(self._subject.edition)
        subject = self._subject._replace(edition=edition, partial=edition is not self._subject.edition)
        for rule, finding in itertools.islice(rules.check(subject, phase), MOST_FINDINGS):
            if finding.path not in affected or finding.in_frames:
                self._add(rule, finding)

    def _add(self, rule: Rule, finding: Finding) -> None:
        document = self._golden_file.document if finding.in_frames else self._document
        is_warning = rule.severity is Severity.WARNING
        diagnostic = (document or self._document).finding(
            finding.path, rule.id, finding.message, finding.hint, key=finding.key, warning=is_warning
        )
        if self._rules.setdefault(_position(diagnostic), rule.id) != rule.id and finding.key:
            return
        (self.warnings if is_warning else self.errors).append(diagnostic)
        if not is_warning:
            self.invalid.append(finding.path)


def specification(file: Path) -> Specification:
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
        documents[edition].finding(("edition",), "name-collision", text, "rename one of the editions")
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


def _position(finding: Diagnostic) -> tuple[str, int, int]:
    return (finding.position.file, finding.position.line, finding.position.column)
