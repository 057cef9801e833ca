"""What tells messages apart once all of them are known: constants that are keys, and codes that are claimed."""

from __future__ import annotations

import dataclasses
import functools
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

from ..model.layout import Field, Layout, Segment, Space, Variant, bits_of
from ..model.message import Command, Direction, Key, KeyRole, Message

FieldBits = tuple[Space, tuple[Segment, ...]]
Constants = dict[FieldBits, Field]
Deciding = dict[str, frozenset[str]]
"""Message to the names of the constants that tell it from others."""


def keyed_by_constants(commands: Sequence[Command]) -> tuple[Command, ...]:
    """The commands with a key in place of each constant that tells a message from others of the same id and code.

    The others are also those of its id that have no code, or no index: what is left when the message is not meant. Where
    messages of one code have a length each, that tells them apart, and their constants are only looked at.

    A layout with a name of its own keeps its constants: it is the same in all its messages.
    """
    deciding: Deciding = {}
    for direction in Direction:
        together: dict[object, list[Message]] = {}
        for message in _distinct(commands, direction):
            together.setdefault((message.id, message.remote), []).append(message)
        for messages in together.values():
            alike: dict[frozenset[object], list[Message]] = {}
            for message in messages:
                alike.setdefault(_selected(message), []).append(message)
            holding = {keys: [_constants(message) for message in same] for keys, same in alike.items()}
            by_length = {keys for keys, same in alike.items() if _lengths_tell(same)}
            for message in messages:
                mine = {} if message.layout.shared else _by_themselves(message)
                selected = _selected(message) if mine else frozenset()
                less = (frozenset(c) for size in range(len(selected) + 1) for c in combinations(selected, size))
                meant = (keys for keys in less if keys != selected or keys not in by_length)
                others = [constants for keys in meant for constants in holding.get(keys, ())]
                names = (f.name for at, f in mine.items() if any(_holds(o.get(at)) != f.fixed for o in others))
                deciding[message.name] = frozenset(names)
    for command in commands:
        if command.is_echoed and command.request and command.reply:
            both = deciding.get(command.request.name, frozenset()) | deciding.get(command.reply.name, frozenset())
            deciding |= {command.request.name: both, command.reply.name: both}
    known: dict[tuple[Layout, frozenset[str]], Layout] = {}
    return _with_messages(commands, lambda message: _keyed(message, deciding, known))


def _with_messages(commands: Sequence[Command], changed: Callable[[Message], Message]) -> tuple[Command, ...]:
    """The commands with other messages; one that is the reply of several commands stays one."""
    of = functools.cache(changed)
    return tuple(
        dataclasses.replace(
            command,
            request=command.request and of(command.request),
            replies=tuple(dataclasses.replace(reply, message=of(reply.message)) for reply in command.replies),
        )
        for command in commands
    )


def _lengths_tell(messages: Sequence[Message]) -> bool:
    """Whether each message has a length of its own."""
    return not messages[0].remote and len({message.dlc for message in messages}) == len(messages)


def _distinct(commands: Sequence[Command], direction: Direction) -> Iterator[Message]:
    for command in commands:
        message = command.message(direction)
        if message is not None and message.command == command.name:
            yield message


def _selected(message: Message) -> frozenset[object]:
    """What the selectors of a message have to hold."""
    return frozenset((key.space, key.segments, key.value) for key in message.keys)


def _by_themselves(message: Message) -> Constants:
    """Its constants, but for those that share a bit with something: that is a mistake, and told of the field."""
    constants = _constants(message)
    if not constants:
        return constants
    taken = Counter((key.space, bit) for key in message.keys for bit in bits_of(key.segments))
    taken.update((f.space, bit) for f in message.layout.fields for e in f.elements for bit in e.bits)
    return {
        place: field
        for place, field in constants.items()
        if all(taken[field.space, bit] == 1 for bit in field.elements[0].bits)
    }


def _constants(message: Message) -> Constants:
    """The constants that are always there, by place."""
    fields = (f for f in message.layout.fields if f.demanded is not None and not f.only and not f.is_array)
    return {(field.space, field.elements[0].segments): field for field in fields}


def _holds(field: Field | None) -> int | None:
    return field.fixed if field else None


def _keyed(message: Message, deciding: Deciding, known: dict[tuple[Layout, frozenset[str]], Layout]) -> Message:
    """The message with its keys; what one layout becomes is one layout again, for a request and its echo."""
    names = deciding.get(message.name)
    if not names:
        return message
    keys = tuple(_key(f) for f in message.layout.fields if f.name in names)
    layout = known.setdefault((message.layout, names), _without(message.layout, names))
    return dataclasses.replace(message, keys=(*message.keys, *keys), layout=layout)


def _key(field: Field) -> Key:
    width = field.type.width
    return Key(
        name=field.name,
        role=KeyRole.CONSTANT,
        space=field.space,
        order=field.type.order,
        width=width,
        segments=field.elements[0].segments,
        value=(field.fixed or 0) & ((1 << width) - 1),
    )


def _without(layout: Layout, names: frozenset[str]) -> Layout:
    def rest(fields: Sequence[Field]) -> tuple[Field, ...]:
        return tuple(f for f in fields if f.name not in names)

    variants = tuple(Variant(values=v.values, fields=rest(v.fields)) for v in layout.variants)
    return dataclasses.replace(layout, fields=rest(layout.fields), variants=variants)


def with_claims(commands: Sequence[Command]) -> tuple[Command, ...]:
    """The commands with `claims` filled in: which codes stand for which message when nothing else is known."""
    claims: dict[str, list[int]] = {}
    for direction in Direction:
        messages = [(c, c.message(direction)) for c in commands]
        own = [(c.code, m) for c, m in messages if m is not None and m.command == c.name and m.keys]
        taken: set[tuple[object, ...]] = set()
        by_right = [(m.keys[0].value, m) for code, m in own if code == m.keys[0].value]
        by_sending = [(m.keys[0].value, m) for _, m in own]
        by_accepting = [(value, m) for _, m in own for value in m.accept]
        for value, message in by_right + by_sending + by_accepting:
            first, *others = message.keys
            rest = tuple((k.segments, k.value) for k in others)
            length = None if message.remote else message.dlc
            place = (message.id, message.remote, length, first.space, first.segments, rest, value)
            if place not in taken:
                taken.add(place)
                claims.setdefault(message.name, []).append(value)

    return _with_messages(commands, lambda m: dataclasses.replace(m, claims=tuple(claims.get(m.name, ()))))
