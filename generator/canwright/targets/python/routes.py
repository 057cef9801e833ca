"""How a frame finds its class: routes by id, selectors, and what answers what."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Direction, Edition, Key, Message, ReplyForm
from . import bits, text


def routes(edition: Edition, direction: Direction) -> Iterator[str]:
    """One `Route(...)` expression for every rule from node to id."""
    groups: dict[tuple[object, bool, int], list[Message]] = {}
    for message in edition.messages(direction):
        groups.setdefault((message.id, message.remote, message.id_mask), []).append(message)
    for messages in groups.values():
        yield _route(messages)


def _route(messages: list[Message]) -> str:
    rule = messages[0].id
    nodes = f"range({rule.nodes[0]}, {rule.nodes[-1] + 1})" if rule.nodes is not None else "None"
    arguments = [f"0x{rule.base:X}", str(rule.node_shift), nodes]
    if messages[0].id_mask:
        arguments.append(f"mask=0x{messages[0].id_mask:X}")
    if rule.extended:
        arguments.append("extended=True")
    if messages[0].remote:
        arguments.append("remote=True")
    keyed = [m for m in messages if m.keys]
    if keyed:
        arguments.append(f"selector=lambda can_id, data: {_read(keyed[0].keys[0], keyed[0].dlc)}")
        arguments.append(f"messages={{{', '.join(_entries(keyed))}}}")
    arguments += [f"single={text.class_name(m.name)}" for m in messages if not m.keys]
    return f"Route({', '.join(arguments)})"


def _entries(messages: list[Message]) -> Iterator[str]:
    found: dict[int, list[str]] = {}
    for message in messages:
        more = "".join(f"(lambda can_id, data: {_read(k, message.dlc)}, 0x{k.value:X})," for k in message.keys[1:])
        for value in message.claims:
            found.setdefault(value, []).append(f"({text.class_name(message.name)}, ({more}))")
    for value, entries in found.items():
        yield f"0x{value:02X}: ({', '.join(entries)},)"


def _read(key: Key, dlc: int) -> str:
    return bits.read(bits.key_place(key), dlc)


def answers(edition: Edition) -> Iterator[str]:
    """One `request: answer` entry for every command that has both."""
    for command in edition.commands:
        if command.request is None or command.reply is None:
            continue
        reply = command.reply
        selectors = "None"
        if reply.keys:
            selectors = f"({''.join(f'0x{v:02X}, ' for v in (reply.keys[0].value, *reply.accept))})"
        nodes = "".join(f"{node}, " for node in command.from_each)
        echo = command.reply_form is ReplyForm.ECHO
        yield f"{text.class_name(command.request.name)}: _Answer({text.class_name(reply.name)}, {selectors}, ({nodes}), {echo})"
