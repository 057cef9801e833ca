"""Every meaning of a single frame: all messages that it can be, in both directions, in all editions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Direction, Message
from ..model.types import Assignment, Type
from ..semantics.decoder import Rejection, rejects_checked
from ..semantics.encoder import Encoder
from ..semantics.frame import CanFrame, raw_of
from .frame_classes import MessageForm, frame_classes
from .rows import CellValue, value_reader


@dataclass(frozen=True)
class FieldMeaning:
    """A field in a frame: its position, its raw integer, and its value under each value of an unknown parameter.

    `only` is the condition under which the field exists.
    """

    name: str
    place: str
    raw: int
    values: Sequence[tuple[str, CellValue]]
    type: Type
    only: str


@dataclass(frozen=True)
class Meaning:
    """What a frame is in one direction of an edition: a message, or the reason why it is none.

    `unusual` names reserved bits, fields and values that a sender that obeys the spec does not send, and implausible
    values.
    """

    direction: Direction
    message: Message | None
    node: int | None
    unusual: tuple[str, ...]
    fields: tuple[FieldMeaning, ...]
    rejection: Rejection | None


def meanings(edition: Edition, frame: CanFrame, assignment: Assignment) -> Iterator[Meaning]:
    """The messages that a frame can be, replies first, or a rejection for each direction."""
    kind = frame_classes(edition).of(frame)
    forms = {
        Direction.REPLY: kind.replies,
        Direction.REQUEST: (kind.request,) if kind.request else (),
    }
    for direction, those in forms.items():
        if not those:
            yield Meaning(direction, None, None, (), (), kind.rejection(direction, frame))
        for form in those:
            yield _meaning(form, frame, assignment, edition.command(form.message.command).only)


Only = Mapping[str, tuple[str, ...]]
"""Parameters, and their values under which a command or a field exists."""


def _meaning(form: MessageForm, frame: CanFrame, assignment: Assignment, only: Only) -> Meaning:
    message = form.message
    rejection = rejects_checked(message, frame, assignment)
    if rejection is not None:
        return Meaning(message.direction, None, None, (), (), rejection)
    variant = message.layout.variant(assignment)
    fields = variant.fields if variant else message.layout.fields
    parameter = None if variant else message.layout.parameter
    varying = [(f, {parameter: f.only} if parameter and f.only else {}) for f in fields if f.is_given]
    listed = [*varying, *((f, {}) for f in fields if f.checksum)]
    meanings = [meaning for f, limits in listed for meaning in _fields(f, frame, assignment, only, limits)]
    unusual = [*_reserved(form, frame)]
    for field, limits in varying:
        unusual += _unusual(field, frame, assignment, {**only, **limits})
    return Meaning(message.direction, message, form.node, tuple(unusual), tuple(meanings), None)


def _reserved(form: MessageForm, frame: CanFrame) -> Iterator[str]:
    """The bytes with reserved bits that are not sent."""
    wrong = (int.from_bytes(frame.data, "little") & form.reserved.mask) ^ form.reserved.value
    bytes_ = [f"DATA[{at}]" for at, byte in enumerate(wrong.to_bytes(len(frame.data), "little")) if byte]
    if bytes_:
        yield f"{', '.join(bytes_)} {'have' if len(bytes_) > 1 else 'has'} reserved bits that are not sent"


def _unusual(field: Field, frame: CanFrame, assignment: Assignment, only: Only) -> Iterator[str]:
    """The elements of a field whose values are not sent under any possible value of a parameter, or are implausible."""
    raw, type_ = raw_of(field, frame), field.type
    limits = type_.raw_range
    cases: list[Assignment] = [assignment]
    if limits.parameter is not None and limits.parameter not in assignment:
        names = [case for case in limits.cases if case in only.get(limits.parameter, limits.cases)]
        cases = [{**assignment, limits.parameter: case} for case in names] or cases
    for (name, _), number in zip(formatting.elements(field), raw if isinstance(raw, list) else [raw], strict=True):
        if all(Encoder(case).rejects_raw(field, number) for case in cases):
            if type_.enum or type_.flags:
                yield f"`{name}` has {'bits' if type_.flags else 'a value'} without a name"
                continue
            spans = dict.fromkeys(formatting.span(span) for case in cases if (span := limits.at(case)))
            yield f"`{name}` is {number}" + (
                f", outside the raw range {' or '.join(spans)}" if spans else ", no valid number"
            )
        elif not any(type_.is_plausible(value) for _, value in _values(field, number, assignment, only)):
            unit = f" {type_.unit.symbol}" if type_.unit else ""
            range_ = formatting.span(type_.plausible) if type_.plausible else ""
            yield f"`{name}` is outside the plausible range {range_}{unit}"


def _fields(field: Field, frame: CanFrame, assignment: Assignment, command: Only, only: Only) -> Iterator[FieldMeaning]:
    raw = raw_of(field, frame)
    raws = raw if isinstance(raw, list) else [raw]
    for (name, segments), number in zip(formatting.elements(field), raws, strict=True):
        values = [("", "correct")] if field.checksum else [*_values(field, number, assignment, {**command, **only})]
        place = formatting.place(field.space, segments, order=field.type.order)
        yield FieldMeaning(name, place, number, values, field.type, formatting.condition(only))


def _values(field: Field, raw: int, assignment: Assignment, only: Only) -> Iterator[tuple[str, CellValue]]:
    """Parameter values, and the value under them."""
    linear = field.type.linear
    name = linear.parameter
    if name is None or name in assignment or not field.type.is_number:
        yield "", value_reader(field.type, assignment)(raw)
        return
    for names, _ in linear.distinct():
        cases = [case for case in names if case in only.get(name, names)]
        if cases:
            yield ", ".join(cases), value_reader(field.type, {**assignment, name: cases[0]})(raw)
