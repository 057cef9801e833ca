"""Different items have different names in every target, such as C, which compares 63 characters, or Python.

No name is a word that the language of a target reserves.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence

from ..diagnostics.diagnostic import Severity
from ..model.edition import Edition
from ..targets.base import NameProblem
from ..targets.registry import targets
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    return findings(subject, Severity.ERROR)


def findings(subject: CheckInput, severity: Severity) -> Findings:
    """The problems of one severity that any target has with names."""
    for problem in _problems(subject.edition):
        if problem.severity is severity:
            related = (RelatedItem(*problem.other, key=True),) if problem.other else ()
            yield Finding(problem.path, problem.message, problem.hint, key=len(problem.path) > 1, related=related)


@functools.lru_cache(maxsize=1)
def _problems(edition: Edition) -> Sequence[NameProblem]:
    """All problems with names, which two rules report."""
    return tuple(problem for target in targets() for problem in target.problems(edition))
