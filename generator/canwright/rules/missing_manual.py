"""Every command has the section of the manual.

An edition without a manual needs none.
"""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings

LISTED = 8
"""So many commands are named; the others are counted."""


def check(subject: CheckInput) -> Findings:
    if not any(subject.spec.manual.values()):
        return
    missing = [name for name, command in subject.spec.commands.items() if command.manual is None]
    if missing:
        listed = ", ".join(f"`{name}`" for name in missing[:LISTED])
        more = f" and {len(missing) - LISTED} more" if len(missing) > LISTED else ""
        text = f"{listed}{more} {'has' if len(missing) == 1 else 'have'} no section of the manual"
        yield Finding(("commands", missing[0], "manual"), text, 'add manual: "2.1"', key=True)
