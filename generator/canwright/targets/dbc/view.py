"""The parts of a DBC file, with all numbers as text."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import NamedTuple, TypeVar

from ...model.message import Direction
from ...model.metadata import FrameFormat
from ...model.types import Order
from .text import NAME_LENGTH, fitting

KIND = {Direction.REPLY: "reply", Direction.REQUEST: "command"}
"""Direction as it appears in names of files and messages."""

EXTENDED = 1 << 31
"""Marks a 29-bit id."""


class Numbers(NamedTuple):
    """The numbers of a signal as text, their unit, and attributes."""

    minimum: str
    maximum: str
    factor: str = "1"
    offset: str = "0"
    unit: str = ""
    signed: bool = False
    start_value: int = 0
    float_kind: int = 0
    """1 for a float of 32 bits, 2 for one of 64, 0 for an integer."""


class Signal(NamedTuple):
    """An SG_ line with its comment, values and attributes.

    `mux` is empty, `M`, or `m` and a selector value, the first of all if it has `ranges`; `bits` are in the data, least significant bit first.
    """

    name: str
    mux: str
    bits: tuple[int, ...]
    order: Order
    comment: str
    numbers: Numbers
    values: tuple[tuple[int, str], ...] = ()
    ranges: tuple[range, ...] = ()
    """The selector values, where a message has those that the others of its id leave; otherwise empty."""
    long_name: str = ""
    """The whole name, if `name` is a shorter one."""

    @property
    def whole_name(self) -> str:
        """The name in readers that show long names."""
        return self.long_name or self.name

    @property
    def start(self) -> int:
        return self.bits[-1] if self.big_endian else self.bits[0]

    @property
    def big_endian(self) -> bool:
        return self.order is Order.BIG


class Message(NamedTuple):
    """A BO_ line with its signals. `id` has bit 31 set if it is a 29-bit id."""

    id: int
    name: str
    length: int
    shortest: int
    """Length of the shortest frame with this id."""
    senders: tuple[str, ...]
    receivers: tuple[str, ...]
    comment: str
    signals: tuple[Signal, ...]
    send_type: str = ""
    """When the frame is sent; empty if that is not stated, or not the same for all messages of the id."""
    cycle_ms: int = 0
    """The period in whole milliseconds; 0 without one."""
    long_name: str = ""
    """The whole name, if `name` is a shorter one."""

    @property
    def whole_name(self) -> str:
        """The name in readers that show long names."""
        return self.long_name or self.name

    @property
    def extended(self) -> bool:
        return bool(self.id & EXTENDED)


Named = TypeVar("Named", Signal, Message)


def fitted(views: Iterable[Named]) -> tuple[Named, ...]:
    """The signals of a message, or the messages of a file, with unique names that readers accept.

    The second of two items with the same whole name gets a number.
    """
    by_name: dict[str, Named] = {}
    for view in views:
        numbered = (view.name if n == 1 else f"{view.name}_{n}" for n in itertools.count(1))
        whole_name = next(name for name in numbered if fitting(name) not in by_name)
        name = fitting(whole_name)
        long_name = whole_name if len(whole_name) > NAME_LENGTH else ""
        by_name[name] = view if name == view.name else view._replace(name=name, long_name=long_name)
    return tuple(by_name.values())


class File(NamedTuple):
    """One DBC file. `directions` are those it describes; `known` are the parameter values it is valid for.

    `table` names the table whose selectors are read as one number; it is empty in a file of the first selector.
    `variant` are the words of the name for what the user selected.
    """

    edition: str
    known: tuple[str, ...]
    directions: tuple[Direction, ...]
    table: str
    variant: tuple[str, ...]
    version: str
    comment: str
    nodes: tuple[str, ...]
    messages: tuple[Message, ...]
    frame_format: FrameFormat

    @property
    def name(self) -> str:
        return "-".join(filter(None, (self.edition, *self.known, self.kind, self.table, *self.variant)))

    @property
    def kind(self) -> str:
        """The direction in the name of the file; empty if it describes both."""
        return KIND[self.directions[0]] if len(self.directions) == 1 else ""
