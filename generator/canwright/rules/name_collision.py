"""No two names become one in a target, nor a word that its language keeps for itself."""

from __future__ import annotations

from ..targets import c, python
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    for problems in (c.problems, python.problems):
        for path, text, hint in problems(subject.edition):
            yield Finding(path, text, hint, key=True)
