"""What the receiver of a message reads in its fields, compared with what the sender wrote."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.exhaustive import assert_never
from ...model.layout import ChecksumRole, ConstantRole, Field, GivenRole, ParameterRole, ReservedRole, Space
from ...model.message import Direction, Message
from ...model.types import Assignment, Encoding, Type
from ...semantics.decoder import Decoder, Identified, Value, field_value, is_finite, rejects_checked, value_of
from ...semantics.encoder import Encoder
from ...semantics.frame import CanFrame, Raw, difference, differs, has_id_rule, raw_of, required_raw, with_checksum
from ...semantics.plan import MaskedBits
from ...semantics.valid_raws import end_of
from .. import forms, match
from ..change import Impact, Keyword, SentenceArgument, Side
from . import candidates
from .assignments import Assignments
from .candidates import Sender
from .paths import MEMBER, RANGE, RAW, VALUE, Aspect, Paths, of_fields
from .witness import Witness, sentence

IGNORED = (ReservedRole, ParameterRole)
"""The roles of fields that a receiver does not look at if it knows no parameters."""


class MessagePair(NamedTuple):
    """A message as its sender encodes it, and the message as which its receiver decodes it."""

    assignments: Assignments
    side: Side
    commands: tuple[str, ...]
    of_use: Paths
    """The paths of the messages of both commands as a whole."""
    available: Sequence[Mapping[str, tuple[str, ...]]]
    """The conditions of the command in both editions."""
    sent: Message
    read: Message
    nodes: Sequence[int] | None
    """The nodes of the message."""
    has_same_origin: bool
    """Whether both are the same message, so that its fields can have been renamed."""
    receiver: Decoder

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters that decide on the fields of the messages and on the command."""
        conditions = (name for only in self.available for name in only)
        layouts = (m.layout.parameter for m in (self.sent, self.read))
        return tuple(dict.fromkeys((*(name for name in layouts if name), *conditions)))

    @property
    def has_same_length(self) -> bool:
        """Whether the number of data bytes is the same; otherwise fields come and go with the bytes that contain them."""
        return self.sent.dlc == self.read.dlc

    def is_identified(self, frame: CanFrame) -> bool:
        """Whether the receiver takes a frame for this message, whatever its constants are."""
        if self.side is Side.RECEIVING:  # of some replies only their requests identify the message
            return difference(self.read, frame) is None
        result = self.receiver.identify(Direction.REQUEST, frame)
        return isinstance(result, Identified) and result.message is self.read

    def is_available(self, assignment: Assignment) -> bool:
        """Whether the sender has the command under some parameters, and an old host that receives it."""
        conditions = self.available[:1] if self.side is Side.SENDING else self.available
        return all(assignment.get(name, v[0]) in v for only in conditions for name, v in only.items())

    def witnesses(self) -> Iterator[Witness]:
        """Every field that is not read as it was sent, with a frame for each aspect and each parameter value."""
        for assignment in self.assignments.of(self.parameters):
            if self.is_available(assignment):
                yield from self._under(assignment)

    def _under(self, assignment: Assignment) -> Iterator[Witness]:
        encoder = self.assignments.encoder(assignment)
        sender = Sender(encoder, self.sent, self.nodes[0] if self.nodes else None)
        fields, read = sender.fields, self.read.layout.variant(encoder.assignment)
        if sender.base is None or read is None:
            return
        sent_keys, read_keys = forms.constants(self.sent), forms.constants(self.read)
        constants = ((f, required_raw(f)) for f in (*read.fields, *read_keys.values()) if not f.is_array)
        demanded = {field: raw for field, raw in constants if raw is not None}
        fields_of = FieldPair(self, demanded, assignment, sender)
        written = self.sent.layout.variant(encoder.assignment)
        every = {field.name: field for field in written.fields} if written else {}
        of = self._sources(every)
        if self.side is Side.SENDING and self.has_same_length:
            used = {of.get(target.name) for target in read.fields if not isinstance(target.role, IGNORED)}
            for name, field in fields.items():
                if name not in used | read_keys.keys():
                    yield from fields_of.ignored(field)
        for target in read.fields:
            source = every.get(of.get(target.name, "")) or sent_keys.get(target.name)
            yield from fields_of.compared(target, source)
        for name in (name for name in read_keys if name in fields):
            yield from fields_of.field(read_keys[name], fields[name])

    def _sources(self, every: Mapping[str, Field]) -> dict[str, str]:
        """The name of the field that is sent, by that of the field that is read."""
        sent, read = self.sent.layout, self.read.layout
        if not self.has_same_origin:
            return {field.name: field.name for field in read.fields if field.name in every}
        if self.side is Side.SENDING:
            pairs = match.fields(sent, read).pairs
        else:
            pairs = tuple((new, old) for old, new in match.fields(read, sent).pairs)
        return {target.name: source.name for source, target in pairs if source.name in every}


class FieldPair(NamedTuple):
    """One message under some parameters, sent and read."""

    messages: MessagePair
    demanded: Mapping[Field, int]
    """The fields and keys with the constants that the receiver demands."""
    assignment: Assignment
    sender: Sender

    @property
    def _encoder(self) -> Encoder:
        return self.sender.encoder

    def compared(self, target: Field, source: Field | None) -> Iterator[Witness]:
        """The differences of what the receiver reads in a field, or requires in it."""
        match target.role:
            case ChecksumRole():
                yield from self.checksum(target, source)
            case ConstantRole():
                yield from self.constant(target, target.role.raw, source)
            case GivenRole():
                if source and match.has_meaning(source):
                    yield from self.field(target, source)
                elif self.messages.has_same_length:
                    yield from self.unset(target, source)
            case ReservedRole() | ParameterRole():
                pass
            case _:
                assert_never(target.role)

    def field(self, target: Field, source: Field) -> Iterator[Witness]:
        """The differences of a field that both messages have, under every value of the parameters of its types."""
        if match.same_values(source.type, target.type) and source.elements == target.elements:
            return
        names = [name for field in (source, target) for name in parameters_of(field.type)]
        assignments = self.messages.assignments
        for more in assignments.of(name for name in names if name not in self.assignment):
            assignment, seen = {**self.assignment, **more}, set[Paths]()
            sender = Sender(assignments.encoder(assignment), self.sender.message, self.sender.node)
            for witness in self._replace(assignment=assignment, sender=sender)._compared(target, source):
                if witness.paths not in seen:
                    seen.add(witness.paths)
                    yield witness

    def _compared(self, target: Field, source: Field) -> Iterator[Witness]:
        for varied, made in self._frames(source, target):
            if target.space is Space.ID and self._has_foreign_id(made):
                continue
            frame = self._accepted(made)
            raw, received = raw_of(source, frame), raw_of(target, frame)
            required = required_raw(target)
            if required is not None and required not in _by_index(target, received).values():
                continue
            if source.type.joined or target.type.joined:
                differences = self._joined_differences(source, raw, target, received)
            else:
                differences = [
                    difference
                    for sent, read in self._elements(source, raw, target, received)
                    for difference in self._differences(source.type, sent, target.type, read)
                ]
            is_rejected = not differences and required is None and self._is_out_of_range(source, target, received)
            if not differences and not is_rejected:
                continue
            sent_as = self._named(shown(source, raw, self._encoder.assignment))
            fields = tuple(dict.fromkeys((source, target, varied, *self._fixed_in(target))))
            for aspect, members in differences:
                facts = {"sent": sent_as, "read": shown(target, received, self._encoder.assignment)}
                yield self._made(aspect, "read", frame, facts, fields, members)
            if is_rejected:
                facts = {"sent": sent_as, "allowed": _allowed(target.type, self._encoder.assignment)}
                yield self._made(RANGE, "out-of-range", frame, facts, (source, target))

    def _joined_differences(
        self, source: Field, raw: Raw, target: Field, received: Raw
    ) -> list[tuple[Aspect, tuple[str, ...]]]:
        """The aspects in which a text, or a number of decimal digits, is understood differently."""
        assignment = self._encoder.assignment
        if field_value(source, raw, assignment) == field_value(target, received, assignment):
            return []
        return [(VALUE if raw == received else RAW, ())]

    def _fixed_in(self, target: Field) -> list[Field]:
        """The fields that are always sent as the same raw integer and that share bits with one that is read."""
        variant = self.messages.sent.layout.variant(self._encoder.assignment)
        return [f for f in (variant.fields if variant else ()) if not f.is_given and match.overlap(f, target)]

    def _has_foreign_id(self, frame: CanFrame) -> bool:
        """Whether a frame is rejected because of bits of its id, although both messages follow one rule."""
        sent, read = self.messages.sent, self.messages.read
        return sent.id == read.id and not has_id_rule(read, frame)

    def _elements(self, source: Field, sent: Raw, target: Field, read: Raw) -> Iterator[tuple[int | None, int | None]]:
        """The raw integers of the elements of a field, sent and read; None of an element that one side does not have."""
        before, after = _by_index(source, sent), _by_index(target, read)
        compared = before.keys() | after.keys() if self.messages.side is Side.SENDING else after.keys()
        return ((before.get(index), after.get(index)) for index in sorted(compared, key=str))

    def _differences(
        self, source: Type, sent: int | None, target: Type, read: int | None
    ) -> Iterator[tuple[Aspect, tuple[str, ...]]]:
        """The aspects in which a raw integer is understood differently; none if it has the same meaning."""
        if sent is None or read is None:
            yield RAW, ()
            return
        if self._difference(source, sent, target, read) is None:
            return
        formats = [(type_.width, type_.encoding, type_.order) for type_ in (source, target)]
        if sent != read and (self.messages.has_same_length or formats[0] != formats[1]):
            yield RAW, ()
        difference = self._difference(source, sent, target, sent)
        if difference is not None:
            yield difference

    def _difference(self, source: Type, sent: int, target: Type, read: int) -> tuple[Aspect, tuple[str, ...]] | None:
        """The difference between the values of two raw integers, with the members that it is about."""
        low, high = target.raw_limits
        if target.encoding is Encoding.FLOAT and not low <= read <= high:
            return None
        assignment = self._encoder.assignment
        values = value_of(source, sent, assignment), value_of(target, read, assignment)
        if source.is_number and target.is_number:
            units = [t.unit and t.unit.name for t in (source, target)]
            is_float = [t.encoding is Encoding.FLOAT for t in (source, target)]
            if any(isinstance(value, str) for value in values):
                named = tuple(name for value in values for name in _members(value))
                return None if _renamed(self._member_names(source, target), values[0]) == values[1] else (MEMBER, named)
            same = sent == read and is_float[0] == is_float[1] if values == (None, None) else values[0] == values[1]
            return None if same and units[0] == units[1] else (VALUE, ())
        expected = _renamed(self._member_names(source, target), values[0])
        before, after = _members(expected), _members(values[1])
        same = source.is_number is target.is_number and (before, _rest(source, sent)) == (after, _rest(target, read))
        if same:
            return None
        members = (*_members(values[0]), *_members(values[1]))
        return MEMBER, tuple(m for m in dict.fromkeys(members) if not (m in after and m in before))

    def _member_names(self, source: Type, target: Type) -> Mapping[str, str]:
        """The names of members that are read, by those that are sent."""
        if self.messages.side is Side.SENDING:
            return match.member_names(source, target)
        return {now: was for was, now in match.member_names(target, source).items()}

    def _is_out_of_range(self, source: Field, target: Field, raw: Raw) -> bool:
        """Whether the old host sends a number that is outside the range of the new node."""
        is_sent = self.messages.side is Side.SENDING and source.type.is_number and target.type.is_number
        return is_sent and self._encoder.rejects_raw(target, raw) is not None

    def unset(self, target: Field, source: Field | None) -> Iterator[Witness]:
        """A field that is read but not sent."""
        made = self.sender.encode(self.sender.base)
        if made is None:
            return
        frame = self._accepted(made)
        text = shown(target, raw_of(target, frame), self._encoder.assignment)
        facts: dict[str, SentenceArgument] = {"name": target.name, "read": (f"`{self.messages.read.command}`: ", text)}
        yield self._made(RAW, "unset", frame, facts, (source or target, target))

    def ignored(self, source: Field) -> Iterator[Witness]:
        """A field that is sent but not read."""
        frames = (self._accepted(made) for _, made in self._frames(source, source))
        frame = max(frames, key=self.messages.is_identified, default=None)  # the first that the receiver identifies
        if frame is not None:
            facts = {"sent": self._named(shown(source, raw_of(source, frame), self._encoder.assignment))}
            yield self._made(RAW, "ignored", frame, facts, (source,))

    def constant(self, target: Field, required: int, source: Field | None) -> Iterator[Witness]:
        """A constant that the receiver requires and that is not always sent, or that means something else."""
        always = (ConstantRole(required), ReservedRole(required))
        if source is not None and source.role in always and source.elements == target.elements:
            return
        frames = [self.sender.encode(self.sender.base)]
        if source is not None and source.is_given:
            frames += [frame for _, frame in self._frames(source, target)]
            yield from self.field(target, source)
        wrong = next((frame for frame in filter(None, frames) if differs(target, required, frame)), None)
        if wrong is not None:
            facts = {"sent": f"`{self.messages.sent.command}`", "reason": Keyword("wrong constant")}
            yield self._made(RAW, "rejected", wrong, facts, (target,) if source is None else (source, target))

    def checksum(self, target: Field, source: Field | None) -> Iterator[Witness]:
        """A frame whose checksum the receiver rejects."""
        sent, read = self.messages.sent, self.messages.read
        is_same = source is not None and (source.role, source.elements) == (target.role, target.elements)
        if is_same and sent.id == read.id:
            return
        frames = (frame for field in self.sender.fields.values() for _, frame in self._frames(field, field))
        for frame in itertools.chain(filter(None, [self.sender.encode(self.sender.base)]), frames):
            if len(frame.data) == read.dlc and with_checksum(read, frame) != frame:
                facts = {"sent": f"`{sent.command}`", "reason": Keyword("wrong checksum")}
                yield self._made(RAW, "rejected", frame, facts, (target,) if source is None else (source, target))
                return

    def _frames(self, source: Field, target: Field) -> Iterator[tuple[Field, CanFrame]]:
        """Frames with other raw integers of a field, then of the fields that share bits with the one that is read."""
        base, encoder = self.sender.base, self._encoder
        if base is None:
            return
        varied = [(source, candidates.raws(encoder, source, target))] if source.is_given else []
        sharing = [f for f in self.sender.fields.values() if f is not source and match.overlap(f, target)]
        for field, raws in (*varied, *((shared, candidates.raws_of_each_bit(encoder, shared)) for shared in sharing)):
            nodes = self.messages.nodes if field.is_node else None
            for raw in raws:
                for given in _spread(field, raw, base[field.name]) if nodes is None or raw in nodes else ():
                    frame = self.sender.encode({**base, field.name: given})
                    if frame is not None:
                        yield field, frame
        if not source.is_given:
            frame = self.sender.encode(base)
            if frame is not None:
                yield source, frame

    def _accepted(self, frame: CanFrame) -> CanFrame:
        """The frame with the constants and the checksum that the receiver demands, if the sender can send it."""
        constants = ((f, raw) for f, raw in self.demanded.items() if f.space is Space.DATA and differs(f, raw, frame))
        wrong = MaskedBits.of((field.elements[0].segments, raw) for field, raw in constants)
        changed = candidates.with_data(frame, int.from_bytes(frame.data, "little") & ~wrong.mask | wrong.value)
        if len(frame.data) == self.messages.read.dlc:
            changed = with_checksum(self.messages.read, changed)
        if changed == frame:
            return frame
        again = self.sender.encode({name: raw_of(field, changed) for name, field in self.sender.fields.items()})
        return changed if again == changed else frame

    def _named(self, shown: SentenceArgument) -> SentenceArgument:
        return (f"`{self.messages.sent.command}`: ", shown)

    def _made(
        self,
        aspect: Aspect,
        about: str,
        frame: CanFrame,
        facts: Mapping[str, SentenceArgument],
        fields: Sequence[Field],
        members: tuple[str, ...] = (),
    ) -> Witness:
        known, messages = self._encoder.assignment, self.messages
        stated = {**self.assignment, **{n: known[n] for f in fields for n in parameters_of(f.type) if n in known}}
        paths = messages.of_use | frozenset(of_fields(aspect, fields, members))
        name = sentence(messages.side, about)
        witness = Witness(messages.side, stated, frame, name, facts, messages.commands, paths, is_of_field=True)
        accepted = witness.impact is Impact.LOUD or rejects_checked(messages.read, frame, known) is None
        return witness._replace(exists=accepted and messages.is_identified(frame))


def parameters_of(type_: Type) -> tuple[str, ...]:
    """The parameters that the values of a type depend on."""
    return (*type_.parameters, *type_.numbers)


def _by_index(field: Field, raw: Raw) -> dict[int | None, int]:
    ordered = raw if isinstance(raw, list) else [raw]
    return {element.index: number for element, number in zip(field.elements, ordered, strict=True)}


def _spread(field: Field, raw: int, base: Raw) -> Iterator[Raw]:
    """A raw integer, or for an array the raw integer in each of its elements alone."""
    if not isinstance(base, list):
        yield raw
        return
    for at in range(len(field.elements)):
        yield [*base[:at], raw, *base[at + 1 :]]


def shown(field: Field, raw: Raw, assignment: Assignment) -> str:
    """A field with its value: `` `voltage = 48.7 V` ``, `` `cell[1..2] = 3.2 V, 3.3 V` ``."""
    values = field_value(field, raw, assignment)
    if field.type.joined is not None and values is not None:
        return f"`{field.name} = {formatting.exact(values) if isinstance(values, Fraction) else values}`"
    raws = raw if isinstance(raw, list) else [raw]
    each = values if isinstance(raw, list) and isinstance(values, list) else [values]
    unit = f" {field.type.unit.symbol}" if field.type.unit else ""
    texts = [_text(field.type, value, number, unit) for value, number in zip(each, raws, strict=False)]
    numbers = formatting.numbers(e.index for e in field.elements if e.index is not None)
    return f"`{field.name}{f'[{numbers}]' if numbers else ''} = {', '.join(texts)}`"


def _text(type_: Type, value: Value | list[Value], raw: int, unit: str) -> str:
    if value is None:
        is_number = type_.encoding is not Encoding.FLOAT or is_finite(type_, raw)
        return str(raw) if is_number else "not finite"
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        unnamed = [str(_rest(type_, raw))] if _rest(type_, raw) else []
        return " + ".join([*map(str, value), *unnamed]) or "0"
    return formatting.decimal(value) + unit


def _allowed(type_: Type, assignment: Assignment) -> str:
    """The values that a number may have: `0..90 %`; raw integers without a known scale."""
    unit = f" {type_.unit.symbol}" if type_.unit else ""
    span, is_float = type_.raw_range.at(assignment), type_.encoding is Encoding.FLOAT
    bounds = (span.low, span.high) if span else ()
    ends = [end for end in (end_of(bound, assignment) for bound in bounds) if end is not None]
    if len(ends) < 2:
        ends = [] if is_float else [Fraction(limit) for limit in type_.number_limits]
    if not ends:
        return "any finite number"
    raws = math.ceil(ends[0]), math.floor(ends[1])
    values = ends if is_float else [value_of(type_, raw, assignment) for raw in raws]
    numbers = sorted(value for value in values if isinstance(value, Fraction))
    if not numbers:
        return f"raw {raws[0]}..{raws[1]}"
    return f"{formatting.decimal(numbers[0])}..{formatting.decimal(numbers[1])}{unit}"


def _rest(type_: Type, raw: int) -> int:
    """The bits of a raw integer that flags do not name; 0 of another type."""
    return raw & ~sum(1 << flag.value for flag in type_.flags) if type_.flags else 0


def _members(value: object) -> tuple[str, ...]:
    """The names of a value, in one order; empty for a number."""
    if isinstance(value, str):
        return (value,)
    return tuple(sorted(map(str, value))) if isinstance(value, list) else ()


def _renamed(names: Mapping[str, str], value: object) -> object:
    """The members of a value under their names in the other edition; an empty name for one that is not there."""
    if isinstance(value, str):
        return names.get(value, "")
    return [names.get(str(member), "") for member in value] if isinstance(value, list) else value
