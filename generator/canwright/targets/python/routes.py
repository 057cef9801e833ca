"""How a frame finds its class: routes by id, selectors, and what answers what."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...model.edition import Edition
from ...model.message import BitRun, Direction, Message
from ...semantics.decoder import by_rule, open_bits
from . import bits, text
from .imports import Imports


class Readers:
    """The functions that read selectors: each expression once, with a name."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def of(self, key: BitRun, shortest: int) -> str:
        """The name of the function that reads a key in data of that length or more."""
        return self.names.setdefault(bits.read_key(key, shortest), f"_key_{len(self.names) + 1}")


def routes(edition: Edition, direction: Direction, readers: Readers, imports: Imports) -> Iterator[str]:
    """One `Route(...)` expression for every rule from node to id."""
    for messages in by_rule(edition.messages(direction)):
        yield _route(messages, readers, imports)


def _route(messages: list[Message], readers: Readers, imports: Imports) -> str:
    rule, mask = messages[0].id, open_bits(messages)
    nodes = f"range({rule.nodes[0]}, {rule.nodes[-1] + 1})" if rule.nodes is not None else "None"
    arguments = [f"0x{rule.base:X}", str(rule.node_step), nodes]
    if mask:
        arguments.append(f"mask=0x{mask:X}")
    if rule.extended:
        arguments.append("extended=True")
    if messages[0].remote:
        arguments.append("remote=True")
    by_place: dict[object, list[Message]] = {}
    of_length = _of_length(messages)
    others_of_length = {name for names in of_length.values() for name in names}
    first = [m for m in messages if text.class_name(m.name) not in others_of_length]
    for message in first:
        if message.keys:
            by_place.setdefault((message.keys[0].space, message.keys[0].segments), []).append(message)
    shortest = min(0 if m.remote else m.dlc for m in messages)
    selectors = [
        (readers.of(keyed[0].keys[0], shortest), _lines("{", _entries(keyed, shortest, readers), "}"))
        for keyed in by_place.values()
    ]
    if selectors:
        arguments += [f"selector={selectors[0][0]}", f"messages={selectors[0][1]}"]
    if len(selectors) > 1:
        arguments.append(f"more=({', '.join(f'({read}, {codes})' for read, codes in selectors[1:])},)")
    single = [m for m in first if not m.keys][:1]
    arguments += [f"single={text.class_name(m.name)}" for m in single]
    if of_length:
        listed = (f"{name}: ({', '.join(others)},)" for name, others in of_length.items())
        arguments.append(f"of_length={{{', '.join(listed)}}}")
    unused = {text.class_name(m.name): mask & ~m.id_mask for m in messages if mask & ~m.id_mask}
    if unused:
        arguments.append(f"unused={{{', '.join(f'{name}: 0x{bits_:X}' for name, bits_ in unused.items())}}}")
    answers = [text.class_name(m.name) for m in first if not m.claims and m not in single]
    if answers:
        arguments.append(f"answers=frozenset({{{', '.join(answers)}}})")
    return f"{imports.use('Route')}({', '.join(arguments)})"


def _of_length(messages: list[Message]) -> dict[str, list[str]]:
    """The messages that only their length tells from a message before them, by that one."""
    found: dict[tuple[object, ...], dict[int, str]] = {}
    for message in (m for m in messages if not m.remote):
        keys = tuple((k.space, k.segments, k.value) for k in message.keys)
        if message.claims or not message.keys:
            found.setdefault((keys, message.claims), {}).setdefault(message.dlc, text.class_name(message.name))
    alike = [list(by_length.values()) for by_length in found.values()]
    return {first: others for first, *others in alike if others}


def _lines(begin: str, entries: Iterable[str], end: str, indent: int = 4) -> str:
    """Entries one below the other, for an expression at an indent."""
    margin = " " * indent
    return "".join((begin, *(f"\n{margin}    {entry}," for entry in entries), f"\n{margin}{end}"))


def _entries(messages: list[Message], shortest: int, readers: Readers) -> Iterator[str]:
    found: dict[int, list[str]] = {}
    for message in sorted(messages, key=lambda m: -len(m.keys)):
        more = text.tuple_of(f"({readers.of(k, shortest)}, 0x{k.value:02X})" for k in message.keys[1:])
        for value in message.claims:
            found.setdefault(value, []).append(f"({text.class_name(message.name)}, {more})")
    for value, entries in found.items():
        yield f"0x{value:02X}: " + (f"({entries[0]},)" if len(entries) == 1 else _lines("(", entries, ")", 8))


def answers(edition: Edition, readers: Readers, imports: Imports) -> Iterator[str]:
    """One `request: answer` entry for every command that has both."""
    for command in edition.commands:
        if command.request is None or command.reply is None:
            continue
        reply = command.reply
        length = 0 if reply.remote else reply.dlc
        selectors = text.tuple_of(
            f"({readers.of(k, length)}, {text.tuple_of(f'0x{v:02X}' for v in (k.value, *(reply.accept if i == 0 else ())))})"
            for i, k in enumerate(reply.keys)
        )
        nodes = text.tuple_of(map(str, command.from_each))
        echo = command.is_echoed
        names = text.class_name(command.request.name), text.class_name(reply.name)
        held = "".join(
            f", {word}=({readers.of(key, 0 if m.remote else m.dlc)}, 0x{(1 << key.width) - 1:X})"
            for word, m in (("asked", command.request), ("told", reply))
            if (key := m.node_bits) is not None
        )
        yield f"{names[0]}: {imports.use('Answer')}({names[1]}, {selectors}, {nodes}, {echo}{held})"
