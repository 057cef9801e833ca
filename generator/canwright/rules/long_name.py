"""No target has to change a name."""

from __future__ import annotations

from ..diagnostics.diagnostic import Severity
from .name_collision import findings
from .rule import Findings, Subject


def check(subject: Subject) -> Findings:
    return findings(subject, Severity.WARNING)
