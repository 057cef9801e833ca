"""Every command names its section of the manual, where the edition has a manual."""

from __future__ import annotations

from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    if subject.spec.manual is None:
        return
    for name, command in subject.spec.commands.items():
        if command.manual is None:
            text = f"`{name}` names no section of the manual"
            yield Finding(("commands", name, "manual"), text, 'add manual: "2.1"', key=True)
