"""A name does not exceed the maximum length of a target, such as DBC."""

from __future__ import annotations

from ..diagnostics.diagnostic import Severity
from .name_collision import findings
from .rule import CheckInput, Findings


def check(subject: CheckInput) -> Findings:
    return findings(subject, Severity.WARNING)
