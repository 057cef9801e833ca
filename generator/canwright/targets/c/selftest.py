"""The self-test of an edition: its golden frames as tables, and the calls that replay them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, TypeVar

from ...model.edition import Edition
from ...model.golden_frames import CheckedFrame, GoldenFrame, GoldenFrames, RawValue, RefusedFrame, RefusedValues
from ...model.layout import Field, Layout
from ...model.message import Direction, Message
from ...semantics.decoder import Decoder, Identified
from ...semantics.frame import CanFrame, node_of
from ..base import EditionInput
from .names import Names, member
from .numbers import integer
from .view import DirectionView, EditionView, FrameView

EXTENDED, REMOTE = 1 << 31, 1 << 30
UNIQUE, ENCODED = "CANWRIGHT_GOLDEN_UNIQUE", "CANWRIGHT_GOLDEN_ENCODED"

Known = Mapping[str, int | str | Fraction]
Raws = Mapping[str, RawValue]
T = TypeVar("T")


class LayoutTable(NamedTuple):
    """The raw integers of all entries that use a layout; `same` are the conditions for equal fields."""

    name: str
    table: str
    same: tuple[str, ...]
    entries: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class MessageCase:
    """A message: its number in tables, and the conditions under which decoding any frame returns the same."""

    number: int
    command: str
    frame: FrameView
    table: str
    any_depends: bool
    any_same: tuple[str, ...]


class Entry(NamedTuple):
    comment: str
    text: str


class Table(NamedTuple):
    name: str
    kind: str
    entries: tuple[Entry, ...]


class SelfTestView(NamedTuple):
    """The tables of a self-test, without empty ones, and its calls."""

    layouts: tuple[LayoutTable, ...]
    messages: tuple[MessageCase, ...]
    directions: tuple[DirectionView, ...]
    parameters: tuple[str, ...]
    tables: tuple[Table, ...]


def has_self_test(specification: EditionInput) -> bool:
    """True if there are golden frames to replay."""
    return specification.frames is not None and bool(specification.frames.frames)


def self_test(specification: EditionInput, view: EditionView) -> SelfTestView:
    """The self-test of an edition with golden frames.

    Omitted are values in units, and raw integers that the members of a struct cannot contain.
    """
    assert specification.frames is not None
    return _SelfTest(specification.edition, specification.frames, view).view()


class _SelfTest:
    def __init__(self, edition: Edition, frames: GoldenFrames, view: EditionView) -> None:
        self._edition, self._frames, self._view = edition, frames, view
        self._names = Names(edition)
        self._decoder = Decoder(edition)
        self._by_name = {f.name: f for command in view.commands for f in command.frames}
        self._messages: dict[Message, int] = {}
        self._raws: dict[Layout, dict[str, int]] = {}
        self._known: dict[str, int] = {}

    def view(self) -> SelfTestView:
        tables = (
            Table("frames", "canwright_golden_t", tuple(map(self._frame, self._frames.frames))),
            Table("rejections", "canwright_golden_rejection_t", tuple(self._rejections())),
            Table("refusals", "canwright_golden_refusal_t", tuple(self._refusals())),
            Table("exchanges", "canwright_golden_exchange_t", tuple(self._exchanges())),
        )
        number, numbered = 0, []
        for table in tables:
            entries = []
            for entry in table.entries:
                number += 1
                entries.append(Entry(f"{number}: {entry.comment}", entry.text))
            numbered += [Table(table.name, table.kind, tuple(entries))] if entries else []
        return SelfTestView(
            layouts=tuple(self._layout(layout, entries) for layout, entries in self._raws.items()),
            messages=tuple(self._case(message, number) for message, number in self._messages.items()),
            directions=tuple(d for d in self._view.directions if d.decode),
            parameters=tuple(self._known),
            tables=tuple(numbered),
        )

    def _frame(self, frame: GoldenFrame) -> Entry:
        message = self._message(frame.direction, frame.command)
        alone = self._decoder.identify(frame.direction, _can(frame))
        is_unique = isinstance(alone, Identified) and alone.message is message
        flags = [*([UNIQUE] if is_unique else []), *([] if frame.decode_only else [ENCODED])]
        text = _braces(
            _stored(frame),
            f"{_node(message, frame)}u",
            f"{_index(self._messages, message)}u",
            f"{self._raw_index(message, frame.raw)}u",
            f"{self._parameters(frame.parameters)}u",
            f"{len(frame.data)}u",
            " | ".join(flags) or "0u",
        )
        return Entry(f"{frame.direction.value} of {frame.command}", text)

    def _rejections(self) -> Iterator[Entry]:
        for entry in self._frames.refused:
            if isinstance(entry, RefusedFrame) and self._edition.messages(entry.decode):
                is_request = int(entry.decode is Direction.REQUEST)
                status = f"CANWRIGHT_{entry.says.name}"
                known = self._parameters(entry.parameters)
                text = _braces(_stored(entry), f"{len(entry.data)}u", f"{known}u", f"{is_request}u", status)
                yield Entry(f"{entry.decode.value}: {entry.says.value}", text)

    def _refusals(self) -> Iterator[Entry]:
        for entry in self._frames.refused:
            if isinstance(entry, RefusedValues) and not entry.values:
                message = self._message(entry.encode, entry.command)
                if all(_fits(f, entry.raw.get(f.name, 0)) for f in _members(message.layout)):
                    text = _braces(
                        f"{entry.node or 0}u",
                        f"{_index(self._messages, message)}u",
                        f"{self._raw_index(message, entry.raw)}u",
                        self._names.upper("field", entry.field_name or "none"),
                        f"{self._parameters(entry.parameters)}u",
                        f"CANWRIGHT_{entry.says.name}",
                    )
                    yield Entry(f"{entry.encode.value} of {entry.command}: {entry.says.value}", text)

    def _exchanges(self) -> Iterator[Entry]:
        for entry in self._frames.exchanges if self._view.answers else ():
            status = entry.says.name if entry.says else "OK"
            lengths = (f"{len(frame.data)}u" for frame in (entry.request, entry.reply))
            text = _braces(_stored(entry.request), _stored(entry.reply), *lengths, f"CANWRIGHT_{status}")
            yield Entry(f"request and reply: {status.lower()}", text)

    def _message(self, direction: Direction, command: str) -> Message:
        message = self._edition.command(command).message(direction)
        if message is None:
            raise ValueError(f"{command} has no {direction.value}")
        return message

    def _raw_index(self, message: Message, raws: Raws) -> int:
        """The index of raw integers in the table of the layout; 0 without fields."""
        fields = list(_members(message.layout))
        if not fields:
            return 0
        text = _braces(*(_literal(f, raws.get(f.name, 0)) for f in fields))
        return _index(self._raws.setdefault(message.layout, {}), text)

    def _parameters(self, known: Known) -> int:
        """The index of parameters in their table; 0 if the edition has none."""
        if not self._edition.parameters:
            return 0
        values = []
        for parameter in self._edition.parameters:
            given = known.get(parameter.name)
            number = Fraction(0) if given is None or parameter.is_choice else Fraction(str(given))
            name = "unknown" if given is None else str(given)
            values.append(
                self._names.upper(parameter.name, name)
                if parameter.is_choice
                else f"{{{number.numerator}, {0 if given is None else number.denominator}u}}"
            )
        return _index(self._known, _braces(*values))

    def _layout(self, layout: Layout, entries: Mapping[str, int]) -> LayoutTable:
        same = []
        for field in _members(layout):
            places = [f"[{i}]" for i in range(len(field.elements))] if field.is_array else [""]
            same += [f"one->{member(field.name)}{p} == other->{member(field.name)}{p}" for p in places]
        return LayoutTable(self._names.lower(layout.name), _table(layout), tuple(same), tuple(entries))

    def _case(self, message: Message, number: int) -> MessageCase:
        frame = self._by_name[self._names.lower(message.name)]
        enumerator = self._names.command(message.command)
        any_ = next(d for d in self._view.directions if d.word == message.direction.value)
        same = [f"{any_.word}.command == {enumerator}", f"{any_.word}.node == result->node"]
        if frame.struct:
            content = any_.by_command[enumerator]
            wanted = f"&wanted.{_table(message.layout)}"
            same.append(f"{frame.layout.name}_matches(&{any_.word}.as.{content.member}, {wanted})")
        return MessageCase(
            number=number,
            command=message.command,
            frame=frame,
            table=_table(message.layout),
            any_depends=any_.depends,
            any_same=tuple(same),
        )


def _table(layout: Layout) -> str:
    """The name of the table of a layout, which no other variable has."""
    return f"raws_{layout.name}"


def _members(layout: Layout) -> Iterator[Field]:
    return (f for f in layout.fields if f.role.is_value)


def _index(numbers: dict[T, int], item: T) -> int:
    """The number of an item, which is added if it is new."""
    return numbers.setdefault(item, len(numbers))


def _braces(*parts: str) -> str:
    return f"{{{', '.join(parts)}}}"


def _literal(field: Field, raw: RawValue) -> str:
    kind = integer(field.type)
    if field.is_array:
        raws = raw if isinstance(raw, list) else [raw] * len(field.elements)
        return _braces(*(kind.literal(number) for number in raws))
    return kind.literal(raw if isinstance(raw, int) else raw[0])


def _fits(field: Field, raw: RawValue) -> bool:
    low, high = integer(field.type).limits
    raws = raw if isinstance(raw, list) else [raw]
    return all(low <= number <= high for number in raws) and (
        not field.is_array or len(raws) in (1, len(field.elements))
    )


def _node(message: Message, frame: GoldenFrame) -> int:
    """The node in the id or in the data; 0 if the frame contains none."""
    return node_of(message, _can(frame)) or 0


def _can(frame: GoldenFrame) -> CanFrame:
    return CanFrame(frame.id, frame.data, frame.extended, frame.remote)


def _stored(frame: GoldenFrame | RefusedFrame | CheckedFrame) -> str:
    flags = (EXTENDED if frame.extended else 0) | (REMOTE if frame.remote else 0)
    data = [f"0x{byte:02X}u" for byte in frame.data.ljust(8, b"\0")[:8]]
    return _braces(f"0x{frame.id | flags:X}u", _braces(*data))
