"""Every command has the section of the manual.

An edition without a manual needs none.
"""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    if not any(subject.spec.manual.values()):
        return
    for name, command in subject.spec.commands.items():
        if command.manual is None:
            text = f"`{name}` has no section of the manual"
            yield Finding(("commands", name, "manual"), text, 'add manual: "2.1"', key=True)
