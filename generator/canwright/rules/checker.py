"""The rules of a spec, phase by phase, as diagnostics with positions."""

from __future__ import annotations

import itertools
from dataclasses import replace

from ..diagnostics.diagnostic import MAX_FINDINGS, Diagnostic, Related, Severity, SpecError, with_number_of_others
from ..document.document import Document
from . import RULES
from .rule import CheckInput, Finding, Phase, Rule

OF_THE_SPEC = [phase for phase in Phase if phase < Phase.NAMES]
"""The phases that need the spec alone, neither targets nor golden frames."""

MAX_COUNTED = 9500
"""The maximum number of findings of a phase that are counted besides the listed ones."""


def check(
    subject: CheckInput, document: Document, frames: Document | None, *, for_output: bool = True
) -> list[Diagnostic]:
    """The warnings of all rules. Raises SpecError with all findings up to the first phase with an error.

    `document` and `frames` give the positions. The phases for output run only if `for_output`.
    """
    listed: list[Diagnostic] = []
    for phase in Phase if for_output else OF_THE_SPEC:
        listed += _check(subject, phase, document, frames or document)
        if any(diagnostic.severity is Severity.ERROR for diagnostic in listed):
            raise SpecError(listed)
    return listed


def _check(subject: CheckInput, phase: Phase, document: Document, frames: Document) -> list[Diagnostic]:
    """The findings of a phase. Of several rules about the same key, the first reports it."""
    by_rule = ((rule, rule.check(subject)) for rule in RULES if rule.phase is phase)
    pairs = ((rule, finding) for rule, findings in by_rule for finding in findings)
    rules: dict[tuple[str, int, int], str] = {}
    listed: list[Diagnostic] = []
    for rule, finding in itertools.islice(pairs, MAX_FINDINGS):
        diagnostic = _diagnostic(rule, finding, document, frames)
        if rules.setdefault(diagnostic.place, rule.id) == rule.id or not finding.key:
            listed.append(diagnostic)
    unlisted = sum(1 for _ in itertools.islice(pairs, MAX_COUNTED))
    return with_number_of_others(listed, unlisted, at_least=unlisted == MAX_COUNTED)


def _diagnostic(rule: Rule, finding: Finding, document: Document, frames: Document) -> Diagnostic:
    """A finding with its position."""
    file, is_warning = frames if finding.in_frames else document, rule.severity is Severity.WARNING
    diagnostic = file.finding(finding.path, rule.id, finding.message, finding.hint, key=finding.key, warning=is_warning)
    written = (item for item in finding.related if item.path in document or not item.may_be_missing)
    related = ((document.position(item.path, key=item.key), item.item) for item in written)
    return replace(diagnostic, related=tuple(Related(*item) for item in related))
