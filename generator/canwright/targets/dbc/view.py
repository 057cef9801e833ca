"""The parts of a DBC file, with all numbers as text."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeVar

from .text import fitting

EXTENDED = 1 << 31
"""Marks a 29-bit id."""


class Signal(NamedTuple):
    """An SG_ line with its comment, values and attributes. `mux` is empty, `M`, or `m` and a selector value."""

    name: str
    mux: str
    start: int
    width: int
    big_endian: bool
    signed: bool
    factor: str
    offset: str
    minimum: str
    maximum: str
    unit: str
    comment: str
    values: tuple[tuple[int, str], ...]
    start_value: int
    float_kind: int
    """1 for a float of 32 bits, 2 for one of 64, 0 for an integer."""


class Message(NamedTuple):
    """A BO_ line with its signals. `id` has bit 31 set if it is a 29-bit id."""

    id: int
    name: str
    length: int
    senders: tuple[str, ...]
    receivers: tuple[str, ...]
    comment: str
    signals: tuple[Signal, ...]

    @property
    def extended(self) -> bool:
        return bool(self.id & EXTENDED)


Named = TypeVar("Named", Signal, Message)


def fitted(views: Iterable[Named]) -> tuple[Named, ...]:
    """The signals of a message, or the messages of a file, with unique names that readers accept."""
    found: dict[str, Named] = {}
    for view in views:
        name = fitting(view.name, found)
        found[name] = view if name == view.name else view._replace(name=name)
    return tuple(found.values())


class File(NamedTuple):
    """One DBC file. `known` are the parameter values it is valid for; `part` is the rest of its name.

    `joined` is the name of selectors that are read as one number; empty in a file of the first selector.
    """

    edition: str
    known: tuple[str, ...]
    kind: str
    joined: str
    part: tuple[str, ...]
    header: str
    comment: str
    nodes: tuple[str, ...]
    messages: tuple[Message, ...]

    @property
    def name(self) -> str:
        return "-".join((self.edition, *self.known, self.kind, *self.part))
