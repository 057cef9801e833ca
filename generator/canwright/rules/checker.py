"""The rules of a spec, phase by phase, as diagnostics with positions."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..diagnostics.diagnostic import MAX_FINDINGS, Diagnostic, DocumentPath, Related, Severity, with_number_of_others
from ..document.document import Document
from ..resolve.affected import Affected, decides_code
from ..resolve.edition import Unresolved
from . import RULES
from .rule import CheckInput, Finding, Phase, Rule


def check(
    subject: CheckInput,
    document: Document,
    frames: Document | None,
    errors: Sequence[Diagnostic],
    invalid: Iterable[DocumentPath],
    unresolved: Unresolved,
) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """All errors, those of loading included, and all warnings.

    `document` and `frames` give the positions. Definitions at the paths of `invalid` and `unresolved` values, and those
    that mention them, are left out, so that no finding only follows from another. Golden frames are compared with a
    spec without errors.
    """
    checker = _Checker(subject, document, frames, errors)
    invalid = list(invalid)
    checker.check(Phase.SIZE, [])
    if checker.invalid:
        return checker.errors, checker.warnings
    checker.check(Phase.PARTS, [*invalid, *unresolved.references])
    checker.check(Phase.CODES, filter(decides_code, [*invalid, *unresolved.paths]))
    checker.check(Phase.WHOLE, [*invalid, *unresolved.paths, *checker.invalid])
    for phase in (Phase.FRAMES, Phase.COVERAGE):
        if not checker.errors:
            checker.check(phase, [])
    return checker.errors, checker.warnings


MAX_COUNTED = 9500
"""The maximum number of findings of a phase that are counted besides the listed ones."""


class _Checker:
    """Collects the findings of one phase after the other."""

    def __init__(
        self, subject: CheckInput, document: Document, frames: Document | None, errors: Sequence[Diagnostic]
    ) -> None:
        self._subject = subject
        self._document = document
        self._frames = frames or document
        self._rules = {error.place: error.rule for error in errors}
        self.errors = list(errors)
        self.warnings: list[Diagnostic] = []
        self.invalid: list[DocumentPath] = []

    def check(self, phase: Phase, invalid: Iterable[DocumentPath]) -> None:
        """Checks the definitions that errors at some paths do not affect."""
        affected = Affected(self._document.data, invalid)
        edition = affected.others(self._subject.edition)
        subject = self._subject._replace(edition=edition, partial=edition is not self._subject.edition)
        found = (
            (rule, finding) for rule in RULES if rule.check and rule.phase is phase for finding in rule.check(subject)
        )
        relevant = (one for one in found if one[1].path not in affected or one[1].in_frames)
        listed = self.warnings
        for rule, finding in itertools.islice(relevant, MAX_FINDINGS):
            listed = self._add(rule, finding)
        others = sum(1 for _ in itertools.islice(relevant, MAX_COUNTED))
        listed[:] = with_number_of_others(listed, others, at_least=others == MAX_COUNTED)

    def _add(self, rule: Rule, finding: Finding) -> list[Diagnostic]:
        """Adds a finding, unless it is about a key that another rule has reported; returns the list of its severity."""
        document = self._frames if finding.in_frames else self._document
        is_warning = rule.severity is Severity.WARNING
        diagnostic = document.finding(
            finding.path, rule.id, finding.message, finding.hint, key=finding.key, warning=is_warning
        )
        if finding.related:
            written = (r for r in finding.related if r.path in self._document or not r.may_be_missing)
            items = ((self._document.position(r.path, key=r.key), r.item) for r in written)
            diagnostic = replace(diagnostic, related=tuple(Related(*item) for item in items))
        listed = self.warnings if is_warning else self.errors
        if self._rules.setdefault(diagnostic.place, rule.id) != rule.id and finding.key:
            return listed
        listed.append(diagnostic)
        if not is_warning:
            self.invalid.append(finding.path)
        return listed
