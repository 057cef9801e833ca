"""No two commands of one address have the same code."""

from __future__ import annotations

from ..model import Command
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    seen: dict[tuple[str, str], Command] = {}
    for command in subject.edition.commands:
        for other in subject.edition.commands:
            if other is command:
                break
            pair = (command.group, other.group)
            if pair not in seen and sends_the_same(command, other):
                seen[pair] = other
                yield _finding(command, other)


def sends_the_same(one: Command, other: Command) -> bool:
    """Whether the requests of two commands have the same code, the same index and as many bytes, at the same address."""
    if one.request is None or other.request is None or one.code is None:
        return False
    if (one.request.id, one.request.remote) != (other.request.id, other.request.remote):
        return False
    if one.request.dlc != other.request.dlc and not one.request.remote:
        return False
    return [(k.space, k.segments, k.value) for k in one.request.keys] == [
        (k.space, k.segments, k.value) for k in other.request.keys
    ]


def _finding(command: Command, other: Command) -> Finding:
    if command.group == other.group:
        text = f"two entries of its table have the same index, so `{command.name}` and `{other.name}` are one command"
        return Finding((*command.path, "table"), text, "give each entry its own `index`")
    text = f"`{other.group}` has the code 0x{command.code:02X} as well"
    return Finding(
        (*command.path, "code"), text, "check both codes, or give one of them another `address`, or another `dlc`"
    )
