"""Rows: the frames of a log with the values of their fields."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ..model.layout import Element, Field, Space
from ..model.message import Message
from ..model.types import Assignment, Encoding, Type
from ..semantics.decoder import linear_of, value_of
from ..semantics.frame import CanFrame, bits_at, parts_of
from .directions import DirectedFrame

CellValue = int | float | str | list[str] | None
"""A number in the unit, the name of a member, the names of flags; None without a scale or a name."""


@dataclass(frozen=True, eq=False)
class Column:
    """A field, or one element of an array, such as `level[1]`."""

    name: str
    field: Field

    @property
    def unit(self) -> str:
        unit = self.field.type.unit
        return unit.symbol if unit else ""


class Cell(NamedTuple):
    """The raw integer and the value of a column in one frame."""

    column: Column
    raw: int
    value: CellValue


class Row(NamedTuple):
    """A frame with the values of its fields. Some are missing without the parameters `missing`.

    `edition` has the names of all editions that fit. `implausible` are values outside the plausible range of their type.
    """

    judged: DirectedFrame
    edition: str
    cells: tuple[Cell, ...] = ()
    missing: tuple[str, ...] = ()
    implausible: tuple[Cell, ...] = ()


class _Reader(NamedTuple):
    """How a column is read: from the id or the data as one integer, as a raw integer, and as a value."""

    column: Column
    in_id: bool
    raw: Callable[[int], int]
    value: Callable[[int], CellValue]
    is_plausible: Callable[[CellValue], bool] | None
    """None if all values are plausible."""


class _Plan(NamedTuple):
    """How the fields of a message are read under some parameters."""

    readers: tuple[_Reader, ...]
    missing: tuple[str, ...]


_MAX_PLANS = 1 << 14


def _edition_name(judged: DirectedFrame) -> str:
    return judged.edition.name if judged.edition else ""


class RowReader:
    """Reads the fields of frames; `assignment` are the parameters of a node on a bus, `label` names the editions that fit."""

    def __init__(
        self, assignment: Callable[[str, int | None], Assignment], label: Callable[[DirectedFrame], str] = _edition_name
    ) -> None:
        self._assignment = assignment
        self._label = label
        self._plans: dict[tuple[Message, str, int | None], _Plan] = {}

    def rows(self, judged: Iterable[DirectedFrame]) -> Iterator[Row]:
        """A row for each frame."""
        for directed in judged:
            edition = self._label(directed)
            if directed.message is None:
                yield Row(directed, edition)
                continue
            known = (directed.message, directed.recorded.bus, directed.node)
            plan = self._plans.get(known)
            if plan is None:
                if len(self._plans) >= _MAX_PLANS:
                    self._plans.clear()
                plan = self._plans[known] = _plan(
                    directed.message, self._assignment(directed.recorded.bus, directed.node)
                )
            yield Row(directed, edition, *_read(plan, directed.recorded.frame))


def cells(message: Message, frame: CanFrame, assignment: Assignment) -> tuple[Cell, ...]:
    """The values of a frame that is known to be a message."""
    values, _, _ = _read(_plan(message, assignment), frame)
    return values


def _read(plan: _Plan, frame: CanFrame) -> tuple[tuple[Cell, ...], tuple[str, ...], tuple[Cell, ...]]:
    """The values, the parameters that are missing, and the values that are not plausible."""
    id_, data = frame.id, int.from_bytes(frame.data, "little")
    cells, implausible = [], []
    for column, in_id, raw_of, value, is_plausible in plan.readers:
        raw = raw_of(id_ if in_id else data)
        cell = Cell(column, raw, value(raw))
        cells.append(cell)
        if is_plausible is not None and not is_plausible(cell.value):
            implausible.append(cell)
    return tuple(cells), plan.missing, tuple(implausible)


def _plan(message: Message, assignment: Assignment) -> _Plan:
    layout = message.layout
    variant = layout.variant(assignment)
    fields = variant.fields if variant else tuple(field for field in layout.fields if not field.only)
    missing = [] if variant or layout.parameter is None else [layout.parameter]
    readers = []
    for field in fields:
        if field.role.is_value:
            missing += [name for name in needed(field.type, assignment) if name not in assignment]
            value, is_plausible = (
                value_reader(field.type, assignment),
                field.type.is_plausible if field.type.plausible else None,
            )
            for column, element in zip(columns(field), field.elements, strict=True):
                raw = _raw_reader(field.type, element)
                readers.append(_Reader(column, field.space is Space.ID, raw, value, is_plausible))
    return _Plan(tuple(readers), tuple(dict.fromkeys(missing)))


def _raw_reader(type_: Type, element: Element) -> Callable[[int], int]:
    """The raw integer of an element of a field, in the id or the data as one integer."""
    parts = parts_of(element.segments)
    sign = 1 << type_.width - 1 if type_.encoding is Encoding.SIGNED else 0
    if len(parts) == 1:
        ((shift, mask, low),) = parts
        if low == 0:
            return lambda source: ((source >> shift & mask) ^ sign) - sign
    return lambda source: (bits_at(parts, source) ^ sign) - sign


def columns(field: Field) -> tuple[Column, ...]:
    """The columns of a field."""
    return tuple(
        Column(field.name if element.index is None else f"{field.name}[{element.index}]", field)
        for element in field.elements
    )


def needed(type_: Type, assignment: Assignment) -> Iterator[str]:
    """The parameters that a value depends on."""
    if type_.is_number:
        if type_.linear.parameter is not None:
            yield type_.linear.parameter
        linear = type_.linear.at(assignment)
        if linear is not None and linear.times is not None:
            yield linear.times


def value_reader(type_: Type, assignment: Assignment) -> Callable[[int], CellValue]:
    """The conversion from a raw integer to a value: an integer, or the nearest float."""
    linear = linear_of(type_, assignment)
    if linear is not None and type_.is_number and type_.encoding is not Encoding.FLOAT:
        factor, addend, divisor = linear.as_quotient
        if divisor == 1:
            return lambda raw: raw * factor + addend
        return lambda raw: (raw * factor + addend) / divisor  # of integers, so it is rounded once

    def value(raw: int) -> CellValue:
        exact = value_of(type_, raw, assignment)
        return exact if exact is None or isinstance(exact, (str, list)) else float(exact)

    return value
