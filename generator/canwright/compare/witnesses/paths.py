"""Paths of the definitions that a witness is about. A change at such a path, or at what contains it, explains the witness."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ...diagnostics.diagnostic import DocumentPath
from ...model.layout import ROLE_KEYS, Field, NodeRole
from ...model.message import Command, Direction, Message
from ...model.types import Type
from ..forms import constants

Paths = frozenset[DocumentPath]


class Aspect(NamedTuple):
    """What two sides of a frame understand differently in a field: the keys of the field and of its type that decide it."""

    of_field: tuple[str, ...]
    of_type: tuple[str, ...]


RAW = Aspect(("array", "at", "byte_order", "only", *ROLE_KEYS), ("byte_order", "raw"))
"""The raw integer."""
VALUE = Aspect((), ("offset", "padding", "raw", "scale", "unit"))
"""The value of a raw integer."""
RANGE = Aspect((), ("raw", "raw_range"))
"""Whether a raw integer is allowed."""
MEMBER = Aspect((), ("raw",))
"""The name of a raw integer, or the names of its bits; the members add their own paths."""


def of_fields(aspect: Aspect, fields: Iterable[Field], members: Iterable[str] = ()) -> Iterator[DocumentPath]:
    """What decides an aspect of some fields; for some members of an enum or of flags, or all if none are given."""
    yield ("byte_order",)
    for field in fields:
        yield from ((*field.path, key) for key in aspect.of_field)
        for path in _of_type(field):
            yield from ((*path, key) for key in aspect.of_type)
            if aspect is MEMBER:
                yield from (
                    (*path, key, name)
                    for key, named in field.type.members_by_key.items()
                    for name in (members or (member.name for member in named))
                )


def _of_type(field: Field) -> Iterator[DocumentPath]:
    """Where the type of a field is named or defined, and the type itself if it has a name."""
    if is_named(field.type):
        yield field.type.path
        yield (*field.path, "type")
    else:
        yield (*field.path, "raw")


def is_named(type_: Type) -> bool:
    """Whether a type is defined apart from the fields that use it."""
    return type_.path[0] == "types"


def of_use(command: Command, direction: Direction) -> Iterator[DocumentPath]:
    """What makes a frame one of a command: its request or reply as a whole, and the table."""
    yield (*command.path, direction.value)
    yield (*command.path, "table")


def of_existence(command: Command, message: Message) -> Iterator[DocumentPath]:
    """What a command without a counterpart exists by, besides itself."""
    yield ("addresses", message.address)
    if command.entry is not None:
        yield command.entry.path


def of_availability(command: Command) -> Iterator[DocumentPath]:
    """What decides which nodes have a command."""
    yield (*command.path, "only")
    if command.entry is not None:
        yield (*command.entry.path, "only")


def of_identity(command: Command, message: Message) -> Iterator[DocumentPath]:
    """What distinguishes the frames of a message from others, besides its id."""
    yield from ((key,) for key in ("byte_order", "selector"))
    yield ("bus", "dlc")
    yield from ((*command.path, key) for key in ("address", "code"))
    yield from ((*message.path, key) for key in ("accept", "address", "code", "dlc", "remote"))
    selectors = ("selector",) if message.direction is Direction.REQUEST else ("selector", "reply_selector")
    yield from (("addresses", message.address, key) for key in selectors)
    for constant in constants(message).values():
        yield from ((*constant.path, key) for key in ("at", "byte_order", "constant"))
    if command.entry is not None:
        yield ("tables", command.entry.table, "index")
        yield from ((*command.entry.path, key) for key in ("index", "kind"))


def of_id(command: Command, message: Message) -> Iterator[DocumentPath]:
    """What decides the ids of a message."""
    yield from (("addresses", message.address, key) for key in ("extended", "id", "nodes", message.direction.value))
    yield from ((*owner.path, "address") for owner in (command, message))


def of_node(message: Message) -> Iterator[DocumentPath]:
    """Which field of a message contains the node."""
    yield from ((*field.path, NodeRole.key) for field in message.layout.fields if field.is_node)
