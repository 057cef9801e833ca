"""Rows: the frames of a log with the values of their fields."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.joined import Joined
from ..model.layout import CounterRole, Element, Field, Space
from ..model.message import Direction, Message
from ..model.types import Assignment, Encoding, Linear, Type, factors
from ..semantics.decoder import linear_of, value_of
from ..semantics.encoder import Encoder
from ..semantics.frame import bits_at, parts_of
from .directions import DecidedBy, DirectedFrame
from .log_frame import new_tuple

CellValue = int | float | str | list[str] | None
"""A number in the unit or the name for no value, the name of a member, the names of flags; None without a scale or a name."""


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

    @property
    def no_value(self) -> str | None:
        """The name for no value of a number; None for a number, and for a name of an enum."""
        return self.value if isinstance(self.value, str) and self.column.field.type.no_values else None


class Limit(NamedTuple):
    """A range of a column as text; `accepts` what is at the place of its raw integers or values in the fields of a row."""

    column: int
    place: int
    text: str
    accepts: Callable[[Any], bool]


_Reader = tuple[bool, Callable[[int], int], Callable[[int], CellValue]]


@dataclass(frozen=True, eq=False, kw_only=True)
class RowForm:
    """The rows of alike frames: of one message on one bus, to or from one node, in one direction by one rule.

    `label` has the names of all editions that fit. Some values are missing without the parameters `missing`.
    """

    bus: str
    node: int | None
    edition: Edition | None
    label: str
    direction: Direction | None
    decided_by: DecidedBy
    message: Message | None
    columns: Sequence[Column]
    missing: Sequence[str]
    readers: Sequence[_Reader]
    """For each column: whether it is in the id, its raw integer in the id or in the data as one integer, and its value."""
    numbers: Sequence[bool]
    """For each column, whether all values are numbers."""
    limits: Sequence[Limit]
    counters: Sequence[tuple[int, CounterRole]]
    """The positions of columns that are counters."""

    def row(self, judged: DirectedFrame) -> Row:
        """The row of a frame."""
        _, _, (id_, content, _, _), _ = judged.recorded
        data = int.from_bytes(content, "little")
        fields: list[Any] = []
        for in_id, read, value in self.readers:
            raw = read(id_ if in_id else data)
            fields += raw, value(raw)
        implausible: Sequence[tuple[int, str]] = ()
        if self.limits:
            implausible = [(at, text) for at, place, text, accepts in self.limits if not accepts(fields[place])]
        return new_tuple(Row, (judged, self, fields, implausible))


class Row(NamedTuple):
    """A frame with the raw integer and the value of each column of its form, one after the other in `fields`.

    `implausible` are the positions of the columns with values outside a range of their type, and the range as text.
    """

    judged: DirectedFrame
    form: RowForm
    fields: Sequence[Any]
    implausible: Sequence[tuple[int, str]]

    @property
    def cells(self) -> Iterable[Cell]:
        """The columns with their raw integers and values."""
        return map(Cell, self.form.columns, self.fields[::2], self.fields[1::2])


MAX_FORMS = 1 << 14
"""The maximum number of forms of rows that are remembered."""


def _edition_name(judged: DirectedFrame) -> str:
    return judged.edition.name if judged.edition else ""


class RowReader:
    """Reads the fields of frames; `assignment` are the parameters of a node on a bus, `label` names the editions that fit."""

    def __init__(
        self, assignment: Callable[[str, int | None], Assignment], label: Callable[[DirectedFrame], str] = _edition_name
    ) -> None:
        self._assignment = assignment
        self._label = label
        self._forms: dict[tuple[object, ...], RowForm] = {}

    def rows(self, judged: Iterable[DirectedFrame]) -> Iterator[Row]:
        """A row for each frame."""
        forms, label = self._forms, self._label
        for frame in judged:
            (_, bus, _, _), _, *known, _, _, _, _ = frame  # node, edition, direction, rule and message
            alike = (bus, label(frame), *known)
            yield (forms.get(alike) or self._form(alike, frame)).row(frame)

    def _form(self, alike: tuple[object, ...], frame: DirectedFrame) -> RowForm:
        if len(self._forms) >= MAX_FORMS:
            self._forms.clear()
        bus = frame.recorded.bus
        assignment = self._assignment(bus, frame.node)
        fields, missing = _fields(frame.message, assignment) if frame.message else ((), ())
        listed = [(field, *reading) for field in fields for reading in _readings(field, assignment)]
        form = self._forms[alike] = RowForm(
            bus=bus,
            node=frame.node,
            edition=frame.edition,
            label=self._label(frame),
            direction=frame.direction,
            decided_by=frame.decided_by,
            message=frame.message,
            columns=tuple(column for _, column, _ in listed),
            missing=missing,
            readers=tuple(reader for _, _, reader in listed),
            numbers=tuple(
                field.type.joined is None and _scale(field.type, assignment) is not None for field, _, _ in listed
            ),
            limits=tuple(
                limit
                for at, (field, _, _) in enumerate(listed)
                if not field.counter  # the summary of its gaps counts its values
                for limit in _limits(at, field.type, assignment)
            ),
            counters=tuple((at, field.counter) for at, (field, _, _) in enumerate(listed) if field.counter),
        )
        return form


def _limits(column: int, type_: Type, assignment: Assignment) -> Iterator[Limit]:
    """The plausible range of a type, and that of its raw integers as far as the parameters are known."""
    if type_.joined is not None or not type_.is_number:
        return
    unit = f" {type_.unit.symbol}" if type_.unit else ""
    if type_.plausible is not None:
        yield Limit(column, 2 * column + 1, f"{formatting.span(type_.plausible)}{unit}", type_.is_plausible)
    if not type_.accepts_every_raw:
        span = type_.raw_range.at(assignment)
        kind = "" if type_.encoding is Encoding.FLOAT else "raw "
        text = f"{kind}{formatting.span(span)}{'' if kind else unit}" if span else "the finite numbers"
        yield Limit(column, 2 * column, text, Encoder(assignment).accepts(type_))


def _fields(message: Message, assignment: Assignment) -> tuple[Sequence[Field], Sequence[str]]:
    """The fields with values under some parameters, and the parameters that are missing."""
    layout = message.layout
    variant = layout.variant(assignment)
    fields = variant.fields if variant else tuple(field for field in layout.fields if not field.only)
    fields = tuple(field for field in fields if field.is_given)
    missing = [] if variant or layout.parameter is None else [layout.parameter]
    missing += [name for field in fields for name in needed(field.type, assignment) if name not in assignment]
    return fields, tuple(dict.fromkeys(missing))


def _readings(field: Field, assignment: Assignment) -> Iterator[tuple[Column, _Reader]]:
    """The columns of a field, and how they are read."""
    joined = field.type.joined
    parts = field.elements if joined is None else (_joined_element(field),)
    value = value_reader(field.type, assignment) if joined is None else _joined_reader(joined)
    for column, element in zip(columns(field), parts, strict=True):
        yield column, (field.space is Space.ID, _raw_reader(field.type, element), value)


def _raw_reader(type_: Type, element: Element) -> Callable[[int], int]:
    """The raw integer of an element of a field, in the id or the data as one integer."""
    parts = parts_of(element.segments)
    sign = 1 << type_.width - 1 if type_.encoding is Encoding.SIGNED else 0
    if len(parts) == 1:
        ((shift, mask, low),) = parts
        if low == 0:
            return lambda source: ((source >> shift & mask) ^ sign) - sign
    return lambda source: (bits_at(parts, source) ^ sign) - sign


def _joined_element(field: Field) -> Element:
    """All elements of a field as one integer, the first one in its highest bits."""
    width, last = field.type.width, len(field.elements) - 1
    shifted = (
        replace(segment, raw_low=segment.raw_low + width * (last - number))
        for number, element in enumerate(field.elements)
        for segment in element.segments
    )
    return Element(None, tuple(shifted))


def elements(joined: Joined, raw: int) -> list[int]:
    """The elements in the integer of a field with joined ones."""
    shifts = range(joined.width * (joined.count - 1), -1, -joined.width)
    return [raw >> shift & (1 << joined.width) - 1 for shift in shifts]


def _joined_reader(joined: Joined) -> Callable[[int], CellValue]:
    def value(raw: int) -> CellValue:
        read = joined.value(elements(joined, raw))
        return int(read) if isinstance(read, Fraction) else read

    return value


def columns(field: Field) -> tuple[Column, ...]:
    """The columns of a field."""
    if field.type.joined is not None:
        return (Column(field.name, field),)
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
            yield from factors(linear.times).names


def value_reader(type_: Type, assignment: Assignment) -> Callable[[int], CellValue]:
    """The conversion from a raw integer to a value: an integer, or the nearest float."""
    linear = _scale(type_, assignment)
    if linear is not None:
        factor, addend, divisor = linear.as_quotient
        if divisor == 1:
            return lambda raw: raw * factor + addend
        return lambda raw: (raw * factor + addend) / divisor  # of integers, so it is rounded once

    def value(raw: int) -> CellValue:
        exact = value_of(type_, raw, assignment)
        if isinstance(exact, Fraction) and exact.denominator == 1 and type_.encoding is not Encoding.FLOAT:
            return exact.numerator
        return exact if exact is None or isinstance(exact, (str, list)) else float(exact)

    return value


def _scale(type_: Type, assignment: Assignment) -> Linear | None:
    """The scale of integers that all are numbers; None for floats, names and flags, and without the parameter that the scale depends on."""
    is_integer = type_.is_number and type_.encoding is not Encoding.FLOAT and not type_.no_values
    return linear_of(type_, assignment) if is_integer else None
