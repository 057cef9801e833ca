"""Families, editions and commands have names that files can have on every system.

Files are named after them.
"""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from .rule import CheckInput, Finding, Findings

DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(10))})
"""Names of devices in Windows, which cannot be names of files there, also with an extension and in upper case."""


def check(subject: CheckInput) -> Findings:
    edition = subject.edition
    yield from _if_device(("family",), edition.family, f"{edition.family}_protocol")
    yield from _if_device(("edition",), edition.name, f"v-{edition.name}")
    for path, name in {command.path: command.name for command in edition.commands}.items():
        yield from _if_device(path, name, f"{name}_command", key=True)


def _if_device(path: DocumentPath, name: str, valid: str, *, key: bool = False) -> Findings:
    device = name.partition(".")[0].lower()
    if device in DEVICES:
        text = f"files with the name `{name}` cannot exist in Windows, where `{device}` is a device"
        yield Finding(path, text, f"choose another name, for example {valid}", key=key)
