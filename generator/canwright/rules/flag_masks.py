"""Flags are numbers of bits, not masks."""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings

MASKS = 4
"""The minimum number of flags that are 1, 2, 4, 8 and so on: of fewer, they can be numbers of bits."""


def check(subject: CheckInput) -> Findings:
    for type_ in subject.edition.types:
        bits = sorted(flag.value for flag in type_.flags)
        if len(bits) >= MASKS and bits == [1 << i for i in range(len(bits))]:
            listed = ", ".join(f"{flag.name}: {flag.value.bit_length() - 1}" for flag in type_.flags[:MASKS])
            text = f"the flags of `{type_.name}` look like masks, but are numbers of bits"
            yield Finding((*type_.path, "flags"), text, f"write {listed}, and so on", key=True)
