"""No two commands of one address have the same code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..model.edition import Edition
from ..model.message import Command, Direction
from ..semantics.dispatch import selection
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    seen: set[tuple[str, str]] = set()
    entries: set[DocumentPath] = set()
    for command, earlier in _duplicates(subject.edition.commands):
        pair = (command.spec_name, earlier.spec_name)
        if pair not in seen:
            seen.add(pair)
            finding = _finding(command, earlier)
            if finding.path not in entries:
                yield finding
            entries |= {finding.path} if command.spec_name == earlier.spec_name else set()
    yield from _accepted_codes(subject.edition)


def _accepted_codes(edition: Edition) -> Findings:
    """Accepted codes of a request that are the codes of others. Replies are exempt: their request decides."""
    for message in edition.all_messages():
        for i, code in enumerate(message.accepted_codes if message.direction is Direction.REQUEST else ()):
            messages = edition.of_rule(message.direction, message.id) if code not in message.identifying_codes else ()
            owner = next(
                (m for m in messages if code in m.identifying_codes and m.keys[0].segments == message.keys[0].segments),
                None,
            )
            if owner is not None:
                text = f"0x{code:02X} is the code of `{owner.command}` and identifies it"
                related = RelatedItem((*edition.command(owner.command).path, "code"), f"the code of `{owner.command}`")
                path = (*message.path, "accept", i)
                yield Finding(path, text, "check both codes, or remove it", related=(related,))


def without_duplicates(commands: Sequence[Command]) -> list[Command]:
    """The commands that do not repeat the address, code, index and length of the request of an earlier one."""
    repeated = {command.name for command, _ in _duplicates(commands)}
    return [command for command in commands if command.name not in repeated]


def _duplicates(commands: Sequence[Command]) -> Iterator[tuple[Command, Command]]:
    """Every command with the request of an earlier one, and the first of those."""
    first: dict[object, Command] = {}
    for command in commands:
        if command.request is not None and command.code is not None:
            earlier = first.setdefault(selection(command.request), command)
            if earlier is not command:
                yield command, earlier


def _finding(command: Command, earlier: Command) -> Finding:
    if command.entry is not None and earlier.entry is not None and command.spec_name == earlier.spec_name:
        text = f"`{earlier.entry.name}` also has this index, so `{command.name}` and `{earlier.name}` are one command"
        related = RelatedItem((*earlier.entry.path, "index"), f"the index of `{earlier.entry.name}`")
        return Finding((*command.entry.path, "index"), text, "give each entry its own `index`", related=(related,))
    text = f"`{earlier.spec_name}` also has the code 0x{command.code:02X}"
    hint = "check both codes, or give one of them another `address` or `dlc`"
    related = RelatedItem((*earlier.path, "code"), f"the code of `{earlier.spec_name}`")
    return Finding((*command.path, "code"), text, hint, related=(related,))
