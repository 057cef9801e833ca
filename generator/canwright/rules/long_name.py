"""A name does not exceed the maximum length of a target."""

from __future__ import annotations

from ..diagnostics.diagnostic import Severity
from ..targets.registry import targets
from .rule import Finding, Findings, Subject


def check(subject: Subject) -> Findings:
    for target in targets():
        for problem in target.problems(subject.edition):
            if problem.severity is Severity.WARNING:
                yield Finding(problem.path, problem.message, problem.hint, key=True)
