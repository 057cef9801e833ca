"""Keys from constants that identify messages, and claims of codes that several messages accept."""

from __future__ import annotations

import dataclasses
import functools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import combinations

from ..model.layout import Field, Layout, Segment, Space, Variant, bits_of
from ..model.message import Command, Confusion, Direction, Key, KeyRole, Message
from ..semantics.confusion import confusions
from ..semantics.frame import required_raw

FieldBits = tuple[Space, tuple[Segment, ...]]
Constants = dict[FieldBits, Key]
Deciding = dict[str, frozenset[str]]
"""Message to the names of the constants that identify it."""


def keyed_by_constants(commands: Sequence[Command]) -> tuple[Command, ...]:
    """The commands with a key for each constant that distinguishes a message from others of the same id and code.

    The others include messages of the same id without a code or an index, because they are decoded if the constant
    differs. Messages of one code with different lengths are distinguished by length; their constants stay fields.

    A shared layout keeps its constants, because it is the same in all its messages.
    """
    deciding: Deciding = {}
    for direction in Direction:
        for messages in _by_route(commands, direction):
            groups: dict[frozenset[object], list[Message]] = {}
            for message in messages:
                groups.setdefault(_selected(message), []).append(message)
            constants_of = {keys: [_constants(message) for message in same] for keys, same in groups.items()}
            by_length = {keys for keys, same in groups.items() if _have_distinct_lengths(same)}
            for message in messages:
                own = {} if message.layout.shared else _separate_constants(message)
                selected = _selected(message) if own else frozenset()
                subsets = (frozenset(c) for size in range(len(selected) + 1) for c in combinations(selected, size))
                competing = (keys for keys in subsets if keys != selected or keys not in by_length)
                competitors = [constants for keys in competing for constants in constants_of.get(keys, ())]
                deciding[message.name] = frozenset(
                    key.name for at, key in own.items() if any(_value(o.get(at)) != key.value for o in competitors)
                )
    for command in commands:
        if command.is_echoed and command.request and command.reply:
            both = deciding.get(command.request.name, frozenset()) | deciding.get(command.reply.name, frozenset())
            deciding |= {command.request.name: both, command.reply.name: both}
    known: dict[tuple[Layout, frozenset[str]], Layout] = {}
    return _with_messages(commands, lambda message: _keyed(message, deciding, known))


def _with_messages(commands: Sequence[Command], changed: Callable[[Message], Message]) -> tuple[Command, ...]:
    """The commands with changed messages; the shared reply of several commands remains one object."""
    of = functools.cache(changed)
    return tuple(
        dataclasses.replace(
            command,
            request=command.request and of(command.request),
            replies=tuple(dataclasses.replace(reply, message=of(reply.message)) for reply in command.replies),
        )
        for command in commands
    )


def _have_distinct_lengths(messages: Sequence[Message]) -> bool:
    """Whether all messages have different lengths."""
    return not messages[0].remote and len({message.dlc for message in messages}) == len(messages)


def _distinct(commands: Sequence[Command], direction: Direction) -> Iterator[Message]:
    for command in commands:
        message = command.message(direction)
        if message is not None and message.command == command.name:
            yield message


def _selected(message: Message) -> frozenset[object]:
    """The values of the selectors of a message."""
    return frozenset((key.space, key.segments, key.value) for key in message.keys)


def _separate_constants(message: Message) -> Constants:
    """The constants of a message, without those that overlap other fields; a rule reports the overlap."""
    constants = _constants(message)
    if not constants:
        return constants
    uses = Counter((key.space, bit) for key in message.keys for bit in bits_of(key.segments))
    uses.update((f.space, bit) for f in message.layout.fields for e in f.elements for bit in e.bits)
    return {
        place: key
        for place, key in constants.items()
        if all(uses[key.space, bit] == 1 for bit in bits_of(key.segments))
    }


def _constants(message: Message) -> Constants:
    """The constants that exist for all parameters as keys, by bits."""
    fields = ((f, required_raw(f)) for f in message.layout.fields if not f.only and not f.is_array)
    keys = (_key(field, raw) for field, raw in fields if raw is not None)
    return {(key.space, key.segments): key for key in keys}


def _value(key: Key | None) -> int | None:
    return key.value if key else None


def _keyed(message: Message, deciding: Deciding, known: dict[tuple[Layout, frozenset[str]], Layout]) -> Message:
    """The message with its keys; a request and its echo share the changed layout."""
    names = deciding.get(message.name)
    if not names:
        return message
    keys = tuple(key for key in _constants(message).values() if key.name in names)
    layout = known.setdefault((message.layout, names), _without(message.layout, names))
    return dataclasses.replace(message, keys=(*message.keys, *keys), layout=layout)


def _key(field: Field, raw: int) -> Key:
    width = field.type.width
    return Key(
        name=field.name,
        role=KeyRole.CONSTANT,
        space=field.space,
        order=field.type.order,
        width=width,
        segments=field.elements[0].segments,
        value=raw & ((1 << width) - 1),
        path=field.path,
    )


def _without(layout: Layout, names: frozenset[str]) -> Layout:
    def rest(fields: Sequence[Field]) -> tuple[Field, ...]:
        return tuple(f for f in fields if f.name not in names)

    variants = tuple(Variant(values=v.values, fields=rest(v.fields)) for v in layout.variants)
    return dataclasses.replace(layout, fields=rest(layout.fields), variants=variants)


def with_claims(commands: Sequence[Command]) -> tuple[Command, ...]:
    """The commands with `identifying_codes`: the codes that identify a message if several messages accept them."""
    codes: dict[str, list[int]] = {}
    for direction in Direction:
        messages = [(c, c.message(direction)) for c in commands]
        own = [(c.code, m) for c, m in messages if m is not None and m.command == c.name and m.keys]
        taken: set[tuple[object, ...]] = set()
        by_right = [(m.keys[0].value, m) for code, m in own if code == m.keys[0].value]
        by_sending = [(m.keys[0].value, m) for _, m in own]
        by_accepting = [(value, m) for _, m in own for value in m.accepted_codes]
        for value, message in by_right + by_sending + by_accepting:
            first, *further = message.keys
            rest = tuple((k.segments, k.value) for k in further)
            length = None if message.remote else message.dlc
            place = (message.id, message.remote, length, first.space, first.segments, rest, value)
            if place not in taken:
                taken.add(place)
                codes.setdefault(message.name, []).append(value)

    return _with_messages(commands, lambda m: dataclasses.replace(m, identifying_codes=tuple(codes.get(m.name, ()))))


def with_confusions(commands: Sequence[Command]) -> tuple[Command, ...]:
    """The commands with `confusions`: the values with which a message is identified as another one."""
    of_message: dict[str, tuple[Confusion, ...]] = {}
    for direction in Direction:
        for messages in _by_route(commands, direction):
            of_message |= {message.name: values for message, values in confusions(messages).items()}
    return _with_messages(commands, lambda m: dataclasses.replace(m, confusions=of_message.get(m.name, ())))


def _by_route(commands: Sequence[Command], direction: Direction) -> Iterable[Sequence[Message]]:
    """The messages of each id rule and kind of frame."""
    together: dict[object, list[Message]] = {}
    for message in _distinct(commands, direction):
        together.setdefault((message.id, message.remote), []).append(message)
    return together.values()
