"""The parts of a DBC file."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple, TypeVar

from ...model.edition import Edition
from ...model.message import Direction
from ...model.types import IDENTITY, Assignment, Linear, Order
from .text import fitting, number

KIND = {Direction.REPLY: "reply", Direction.REQUEST: "command"}
"""Direction as it appears in names of files and messages."""

EXTENDED = 1 << 31
"""Marks a 29-bit id."""


class Numbers(NamedTuple):
    """The limits of a signal, its scale and unit, and attributes."""

    minimum: Fraction
    maximum: Fraction
    linear: Linear = IDENTITY
    unit: str = ""
    signed: bool = False
    start_value: int = 0
    float_kind: int = 0
    """1 for a float of 32 bits, 2 for one of 64, 0 for an integer."""


class Signal(NamedTuple):
    """An SG_ line with its comment, values and attributes.

    `mux` is empty, `M`, or `m` and a selector value, the first of all if it has `ranges`; `bits` are in the data, least significant bit first.
    """

    whole_name: str
    """The name in readers that show long names."""
    mux: str
    bits: tuple[int, ...]
    order: Order
    comment: str
    numbers: Numbers
    values: tuple[tuple[int, str], ...] = ()
    ranges: tuple[range, ...] = ()
    """The selector values, where a message has those that the others of its id leave; otherwise empty."""

    @property
    def name(self) -> str:
        return fitting(self.whole_name)

    @property
    def start(self) -> int:
        return self.bits[-1] if self.big_endian else self.bits[0]

    @property
    def big_endian(self) -> bool:
        return self.order is Order.BIG


class Message(NamedTuple):
    """A BO_ line with its signals. `id` has bit 31 set if it is a 29-bit id."""

    id: int
    whole_name: str
    """The name in readers that show long names."""
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

    @property
    def name(self) -> str:
        return fitting(self.whole_name)

    @property
    def extended(self) -> bool:
        return bool(self.id & EXTENDED)


Named = TypeVar("Named", Signal, Message)


def fitted(views: Iterable[Named]) -> tuple[Named, ...]:
    """The signals of a message, or the messages of a file; the second of two with the same name gets a number."""
    by_name: dict[str, Named] = {}
    for view in views:
        numbered = (view.whole_name if n == 1 else f"{view.whole_name}_{n}" for n in itertools.count(1))
        whole_name = next(name for name in numbered if fitting(name) not in by_name)
        by_name[fitting(whole_name)] = view._replace(whole_name=whole_name)
    return tuple(by_name.values())


def known_values(edition: Edition, assignment: Assignment) -> Iterator[str]:
    """Parameter values in the names of files: a name alone, a number together with the name of its parameter."""
    for name, value in assignment.items():
        written = number(value) if isinstance(value, Fraction) else value
        yield f"{name}_{written}" if edition.parameter(name).is_numeric else written


def file_name(edition: Edition, assignment: Assignment, directions: Sequence[Direction], *words: str) -> str:
    """The name of a file that describes these directions for these parameter values, with further words."""
    kind = KIND[directions[0]] if len(directions) == 1 else ""
    return "-".join(filter(None, (edition.family, edition.name, *known_values(edition, assignment), kind, *words)))


def agree(known: Assignment, assignment: Assignment) -> bool:
    """Whether the values of parameters are the same, as far as both are given."""
    return all(assignment.get(name, value) == value for name, value in known.items())


class File(NamedTuple):
    """One DBC file. `directions` are those it describes; it is valid for the parameter values of `assignment`.

    `table` names the table whose selectors are read as one number; it is empty in a file of the first selector.
    `commands` are those of its messages, by their names in the spec.
    `variant` are the words of the name for what the user selected.
    """

    edition: Edition
    assignment: Assignment
    directions: tuple[Direction, ...]
    table: str
    commands: tuple[str, ...]
    variant: tuple[str, ...]
    comment: str
    nodes: tuple[str, ...]
    messages: tuple[Message, ...]

    @property
    def name(self) -> str:
        return file_name(self.edition, self.assignment, self.directions, self.table, *self.variant)

    @property
    def known(self) -> tuple[str, ...]:
        """The parameter values in the name of the file."""
        return tuple(known_values(self.edition, self.assignment))

    @property
    def kind(self) -> str:
        """The direction in the name of the file; empty if it describes both."""
        return KIND[self.directions[0]] if len(self.directions) == 1 else ""
