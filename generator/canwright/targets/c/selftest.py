"""The self-test of an edition: its golden frames as tables, and the calls that replay them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, TypeVar

from ...model.edition import Edition
from ...model.golden_frames import (
    CheckedFrame,
    GoldenFrame,
    GoldenFrames,
    RawValue,
    RefusedFrame,
    RefusedValues,
    Sourced,
)
from ...model.layout import Field, Layout
from ...model.message import Direction, Message
from ...model.refusal import Refusal
from ...semantics.decoder import Decoder, Identified
from ...semantics.frame import CanFrame, code_of, node_of
from ...semantics.plan import value_fields
from ..base import EditionInput
from .choices import parameter_literal
from .expressions import integer, raw_of
from .layouts import FRAME_CODE, code_member, initializer, literals, numbers
from .messages import MessageView
from .view import EditionView

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
    message: MessageView
    table: str
    any_depends: bool
    any_same: tuple[str, ...]


class Entry(NamedTuple):
    comment: str
    text: str
    golden: Sourced


class Table(NamedTuple):
    """Golden frames of one kind; `first` is the number of the first one among all."""

    name: str
    kind: str
    first: int
    entries: tuple[Entry, ...]


def has_self_test(specification: EditionInput) -> bool:
    """True if there are golden frames to replay."""
    return specification.frames is not None and bool(specification.frames.frames)


def _braces(*parts: str) -> str:
    return f"{{{', '.join(parts)}}}"


class SelfTest:
    """The tables of an edition with golden frames, without empty ones, and the calls.

    Omitted are values in units, and raw integers that the members of a struct cannot contain.
    """

    def __init__(self, edition: Edition, frames: GoldenFrames, view: EditionView) -> None:
        self._edition, self._frames, self._view = edition, frames, view
        self._names = view.names
        self._most = edition.bus.frame_format.max_data_bytes
        self.blank = _braces("0u", _braces(*["0u"] * self._most))
        """The initializer of a stored frame without anything."""
        self._decoder = Decoder(edition)
        self._messages: dict[Message, int] = {}
        self._raws: dict[Layout, dict[str, int]] = {}
        self._known: dict[str, int] = {}
        self.tables: list[Table] = []
        first = 1
        for name, kind, entries in (
            ("frames", f"{view.fd}golden", [*map(self._frame, frames.frames)]),
            ("rejections", f"{view.fd}golden_rejection", [*self._rejections()]),
            ("refusals", "golden_refusal", [*self._refusals()]),
            ("exchanges", f"{view.fd}golden_exchange", [*self._exchanges()]),
        ):
            self.tables += [Table(name, f"canwright_{kind}_t", first, tuple(entries))] if entries else []
            first += len(entries)
        self.layouts = [self._layout(layout, entries) for layout, entries in self._raws.items()]
        self.messages = [self._case(message, number) for message, number in self._messages.items()]
        self.directions = [direction for direction in view.directions if direction.decode]
        self.parameters = list(self._known)

    def _frame(self, frame: GoldenFrame) -> Entry:
        message = self._message(frame.direction, frame.command)
        alone = self._decoder.identify(frame.direction, _can(frame), frame.parameters)
        is_unique = isinstance(alone, Identified) and alone.message is message
        flags = [*([UNIQUE] if is_unique else []), *([] if frame.decode_only else [ENCODED])]
        text = _braces(
            self._stored(frame),
            f"{_node(message, frame)}u",
            f"{_index(self._messages, message)}u",
            f"{self._raw_index(message, frame.raw, code_of(message, _can(frame)))}u",
            f"{self._parameters(frame.parameters)}u",
            f"{len(frame.data)}u",
            " | ".join(flags) or "0u",
        )
        return Entry(f"{frame.direction.value} of {frame.command}", text, frame)

    def _rejections(self) -> Iterator[Entry]:
        for entry in self._frames.refused:
            if isinstance(entry, RefusedFrame) and self._edition.messages(entry.decode):
                is_request = int(entry.decode is Direction.REQUEST)
                status = f"CANWRIGHT_{entry.says.name}"
                known = self._parameters(entry.parameters)
                text = _braces(self._stored(entry), f"{len(entry.data)}u", f"{known}u", f"{is_request}u", status)
                yield Entry(f"{entry.decode.value}: {entry.says.value}", text, entry)

    def _refusals(self) -> Iterator[Entry]:
        """Raw integers that the function of a message rejects; it does not ask whether the node has the command."""
        for entry in self._frames.refused:
            if isinstance(entry, RefusedValues) and not entry.values and entry.says is not Refusal.NOT_AVAILABLE:
                message = self._message(entry.encode, entry.command)
                if all(_fits(f, entry.raw.get(f.name, 0)) for f in value_fields(message.layout.fields).values()):
                    text = _braces(
                        f"{entry.node or 0}u",
                        f"{_index(self._messages, message)}u",
                        f"{self._raw_index(message, entry.raw, None)}u",
                        self._names.upper("field", entry.field_name or "none"),
                        f"{self._parameters(entry.parameters)}u",
                        f"CANWRIGHT_{entry.says.name}",
                    )
                    yield Entry(f"{entry.encode.value} of {entry.command}: {entry.says.value}", text, entry)

    def _exchanges(self) -> Iterator[Entry]:
        for entry in self._frames.exchanges if self._view.answers else ():
            status = entry.says.name if entry.says else "OK"
            lengths = (f"{len(frame.data)}u" for frame in (entry.request, entry.reply))
            known = [f"{self._parameters(entry.parameters)}u"] if self._view.check_reply_parameters else ["0u"]
            text = _braces(
                self._stored(entry.request), self._stored(entry.reply), *lengths, *known, f"CANWRIGHT_{status}"
            )
            yield Entry(f"request and reply: {status.lower()}", text, entry)

    def _stored(self, frame: GoldenFrame | RefusedFrame | CheckedFrame) -> str:
        """A frame, without the bytes that its format does not have."""
        flags = (EXTENDED if frame.extended else 0) | (REMOTE if frame.remote else 0)
        data = [f"0x{byte:02X}u" for byte in frame.data.ljust(self._most, b"\0")[: self._most]]
        return _braces(f"0x{frame.id | flags:X}u", _braces(*data))

    def _message(self, direction: Direction, command: str) -> Message:
        message = self._edition.command(command).message(direction)
        if message is None:
            raise ValueError(f"{command} has no {direction.value}")
        return message

    def _raw_index(self, message: Message, raws: Raws, code: int | None) -> int:
        """The index of raw integers, and of a code, in the table of the layout; 0 without members."""
        fields, member = value_fields(message.layout.fields), self._view.message(message).layout.code
        if not fields and member is None:
            return 0
        texts = [initializer(f, literals(f, raws.get(name, 0)).values()) for name, f in fields.items()]
        texts += [member.stored(message, code)] if member else []
        return _index(self._raws.setdefault(message.layout, {}), _braces(*texts))

    def _parameters(self, known: Known) -> int:
        """The index of parameters in their table; 0 if the edition has none."""
        values = (parameter_literal(self._names, p, known.get(p.name)) for p in self._edition.parameters)
        return _index(self._known, _braces(*values)) if self._edition.parameters else 0

    def _layout(self, layout: Layout, entries: Mapping[str, int]) -> LayoutTable:
        fields = value_fields(layout.fields).values()
        raws = [raw_of(field.type, number) for field in fields for number in numbers(field)]
        raws += [FRAME_CODE] if code_member(self._edition.of_layout(layout)) else []
        same = (f"one->{raw} == other->{raw}" for raw in raws)
        return LayoutTable(self._names.lower(layout.name), _table(layout), tuple(same), tuple(entries))

    def _case(self, message: Message, number: int) -> MessageCase:
        view = self._view.message(message)
        enumerator = self._names.command(message.command)
        any_ = self._view.direction(message.direction)
        same = [f"{any_.word}.command == {enumerator}", f"{any_.word}.node == result->node"]
        if view.struct:
            content = any_.by_command[enumerator]
            wanted = f"&wanted.{_table(message.layout)}"
            same.append(f"{view.layout.name}_matches(&{any_.word}.as.{content.member}, {wanted})")
        return MessageCase(
            number=number,
            command=message.command,
            message=view,
            table=_table(message.layout),
            any_depends=any_.depends,
            any_same=tuple(same),
        )


def _table(layout: Layout) -> str:
    """The name of the table of a layout, which no other variable has."""
    return f"raws_{layout.name}"


def _index(numbers: dict[T, int], item: T) -> int:
    """The number of an item, which is added if it is new."""
    return numbers.setdefault(item, len(numbers))


def _fits(field: Field, raw: RawValue) -> bool:
    if isinstance(raw, list) and len(raw) != len(field.elements):
        return False
    return integer(field.type).holds(*(raw if isinstance(raw, list) else [raw]))


def _node(message: Message, frame: GoldenFrame) -> int:
    """The node in the id or in the data; 0 if the frame contains none."""
    return node_of(message, _can(frame), frame.parameters) or 0


def _can(frame: GoldenFrame) -> CanFrame:
    return CanFrame(frame.id, frame.data, frame.extended, frame.remote)
