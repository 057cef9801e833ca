"""What the receiver of a message reads in its fields, compared with what the sender wrote."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ...model import formatting
from ...model.layout import MAX_DATA_BYTES, ConstantRole, Element, Field, NodeRole, ReservedRole, Space
from ...model.message import Direction, Key, KeyRole, Message
from ...model.types import IDENTITY, Assignment, ByParameter, Encoding, Type
from ...semantics.bits import data_bits
from ...semantics.decoder import Decoder, Identified, Value, field_value, is_finite, rejects_constants, value_of
from ...semantics.encoder import Encoder, Encoders
from ...semantics.frame import CanFrame, Raw, difference, has_id_rule, raw_of, wrong_constants
from .. import match
from ..change import Impact, Keyword, SentenceArgument, Side
from . import candidates
from .assignments import Assignments
from .counterparts import Counterparts
from .paths import MEMBER, RANGE, RAW, VALUE, Aspect, Paths, of_fields
from .witness import Witness


@dataclass(frozen=True)
class MessagePair:
    """A message as its sender encodes it, and the message as which its receiver decodes it."""

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


class FieldComparison:
    """Compares the fields of messages of two editions."""

    def __init__(self, counterparts: Counterparts, assignments: Assignments) -> None:
        self._counterparts = counterparts
        self._assignments = assignments
        self._encoders = Encoders()
        self._keys: dict[Message, Mapping[str, Field]] = {}

    def witnesses(self, pair: MessagePair) -> Iterator[Witness]:
        """Every field that is not read as it was sent, with a frame for each aspect and each parameter value."""
        for assignment in self._assignments.of(pair.parameters):
            if pair.is_available(assignment):
                yield from self._under(pair, assignment)

    def _under(self, pair: MessagePair, assignment: Assignment) -> Iterator[Witness]:
        encoder = self._encoders.for_parameters({**self._assignments.first, **assignment})
        fields, read = encoder.fields(pair.sent), pair.read.layout.variant(encoder.assignment)
        nodes = pair.nodes
        base = candidates.base_raws(encoder, pair.sent, nodes[0] if nodes else None)
        if fields is None or read is None or base is None:
            return
        sent_keys, read_keys = self._constants(pair.sent), self._constants(pair.read)
        demanded = [f for f in (*read.fields, *read_keys.values()) if f.role.is_checked and not f.is_array]
        fields_of = FieldPair(self, pair, assignment, encoder, base, demanded)
        written = pair.sent.layout.variant(encoder.assignment)
        every = {field.name: field for field in written.fields} if written else {}
        of = self._sources(pair, every)
        if pair.side is Side.SENDING and pair.has_same_length:
            used = {of.get(target.name) for target in read.fields if target.role.is_value or target.role.is_checked}
            for name, field in fields.items():
                if name not in used | read_keys.keys():
                    yield from fields_of.ignored(field)
        for target in read.fields:
            source = every.get(of.get(target.name, "")) or sent_keys.get(target.name)
            if target.role.is_checked:
                yield from fields_of.constant(target, source)
            elif target.role.is_value:
                is_sent = source is not None and not isinstance(source.role, ReservedRole)
                if source and is_sent:
                    yield from fields_of.field(target, source)
                elif pair.has_same_length:
                    yield from fields_of.unset(target, source)
        for name in read_keys.keys() & fields.keys():
            yield from fields_of.field(read_keys[name], fields[name])

    def _constants(self, message: Message) -> Mapping[str, Field]:
        """The constants among the keys of a message, as fields by name."""
        if message not in self._keys:
            keys = (key for key in message.keys if key.role is KeyRole.CONSTANT)
            self._keys[message] = {key.name: _constant(key) for key in keys}
        return self._keys[message]

    def _sources(self, pair: MessagePair, every: Mapping[str, Field]) -> dict[str, str]:
        """The name of the field that is sent, by that of the field that is read."""
        if not pair.has_same_origin:
            return {field.name: field.name for field in pair.read.layout.fields if field.name in every}
        if pair.side is Side.SENDING:
            fields = self._counterparts.fields(pair.sent.layout, pair.read.layout)
            return {new.name: old.name for old, new in fields if old.name in every}
        fields = self._counterparts.fields(pair.read.layout, pair.sent.layout)
        return {old.name: new.name for old, new in fields if new.name in every}

    def is_same_type(self, first: Type, second: Type) -> bool:
        return self._counterparts.is_same_type(first, second)

    def members(self, side: Side, sent: Type, read: Type) -> Mapping[str, str]:
        """The names of members that are read, by those that are sent."""
        if side is Side.SENDING:
            return self._counterparts.members(sent, read)
        return self._counterparts.former_members(read, sent)

    def further(self, encoder: Encoder, known: Assignment, *fields: Field) -> Iterator[tuple[Assignment, Encoder]]:
        """`known` with every value of the further parameters that some fields depend on."""
        names = [name for f in fields for name in parameters_of(f.type) if name not in known]
        for more in self._assignments.of(names):
            assignment = {**known, **more}
            yield assignment, self._encoders.for_parameters({**encoder.assignment, **assignment})


class FieldPair:
    """One message under some parameters, sent and read."""

    def __init__(
        self,
        comparison: FieldComparison,
        messages: MessagePair,
        assignment: Assignment,
        encoder: Encoder,
        base: Mapping[str, Raw],
        demanded: Sequence[Field],
    ) -> None:
        self._comparison = comparison
        self._demanded = demanded
        self._messages = messages
        self._assignment = assignment
        self._encoder = encoder
        self._base = base
        self._node = messages.nodes[0] if messages.nodes else None

    def field(self, target: Field, source: Field) -> Iterator[Witness]:
        """The differences of a field that both messages have."""
        same_type = self._comparison.is_same_type(source.type, target.type)
        if same_type and source.elements == target.elements:
            return
        for assignment, encoder in self._comparison.further(self._encoder, self._assignment, source, target):
            seen: set[Paths] = set()
            for witness in self._compared(target, source, assignment, encoder):
                if witness.paths not in seen:
                    seen.add(witness.paths)
                    yield witness

    def _compared(self, target: Field, source: Field, assignment: Assignment, encoder: Encoder) -> Iterator[Witness]:
        for varied, made in self._frames(source, target, encoder):
            if target.space is Space.ID and self._has_foreign_id(made):
                continue
            frame = self._accepted(encoder, made)
            raw, received = raw_of(source, frame), raw_of(target, frame)
            if target.role.is_checked and target.role.required_raw not in _by_index(target, received).values():
                continue
            differences = [
                difference
                for sent, read in self._elements(source, raw, target, received)
                for difference in self._differences(source.type, sent, target.type, read, encoder)
            ]
            fields = tuple(dict.fromkeys((source, target, varied, *self._fixed_in(target))))
            for aspect, members in differences:
                yield self._misread(aspect, assignment, encoder, frame, source, raw, target, received, fields, members)
            if not differences and not target.role.is_checked and encoder.rejects_raw(target, received) is not None:
                yield from self._out_of_range(assignment, encoder, frame, source, raw, target)

    def _fixed_in(self, target: Field) -> list[Field]:
        """The fields that are always sent as the same raw integer and that share bits with one that is read."""
        variant = self._messages.sent.layout.variant(self._encoder.assignment)
        return [f for f in (variant.fields if variant else ()) if not f.role.is_value and match.overlap(f, target)]

    def _has_foreign_id(self, frame: CanFrame) -> bool:
        """Whether a frame is rejected because of bits of its id, although both messages follow one rule."""
        sent, read = self._messages.sent, self._messages.read
        return sent.id == read.id and not has_id_rule(read, frame)

    def _elements(self, source: Field, sent: Raw, target: Field, read: Raw) -> Iterator[tuple[int | None, int | None]]:
        """The raw integers of the elements of a field, sent and read; None of an element that one side does not have."""
        before, after = _by_index(source, sent), _by_index(target, read)
        compared = before.keys() | after.keys() if self._messages.side is Side.SENDING else after.keys()
        return ((before.get(index), after.get(index)) for index in sorted(compared, key=str))

    def _differences(
        self, source: Type, sent: int | None, target: Type, read: int | None, encoder: Encoder
    ) -> Iterator[tuple[Aspect, tuple[str, ...]]]:
        """The aspects in which a raw integer is understood differently; none if it has the same meaning."""
        if sent is None or read is None:
            yield RAW, ()
            return
        if self._difference(source, sent, target, read, encoder) is None:
            return
        formats = [(type_.width, type_.encoding, type_.order) for type_ in (source, target)]
        if sent != read and (self._messages.has_same_length or formats[0] != formats[1]):
            yield RAW, ()
        difference = self._difference(source, sent, target, sent, encoder)
        if difference is not None:
            yield difference

    def _difference(
        self, source: Type, sent: int, target: Type, read: int, encoder: Encoder
    ) -> tuple[Aspect, tuple[str, ...]] | None:
        """The difference between the values of two raw integers, with the members that it is about."""
        low, high = target.raw_limits
        if target.encoding is Encoding.FLOAT and not low <= read <= high:
            return None
        values = value_of(source, sent, encoder.assignment), value_of(target, read, encoder.assignment)
        if source.is_number and target.is_number:
            units = [t.unit and t.unit.name for t in (source, target)]
            is_float = [t.encoding is Encoding.FLOAT for t in (source, target)]
            same = sent == read and is_float[0] == is_float[1] if values == (None, None) else values[0] == values[1]
            return None if same and units[0] == units[1] else (VALUE, ())
        expected = _renamed(self._comparison.members(self._messages.side, source, target), values[0])
        before, after = _members(expected), _members(values[1])
        same = source.is_number is target.is_number and (before, _rest(source, sent)) == (after, _rest(target, read))
        if same:
            return None
        members = (*_members(values[0]), *_members(values[1]))
        return MEMBER, tuple(m for m in dict.fromkeys(members) if not (m in after and m in before))

    def _out_of_range(
        self, assignment: Assignment, encoder: Encoder, frame: CanFrame, source: Field, raw: Raw, target: Field
    ) -> Iterator[Witness]:
        """A number that the old host sends and that is outside the range of the new node."""
        if self._messages.side is Side.SENDING and source.type.is_number and target.type.is_number:
            text = shown(source, raw, encoder.assignment)
            facts = {"sent": self._named(text), "allowed": _allowed(target.type, encoder.assignment)}
            yield self._made(RANGE, Impact.LOUD, assignment, frame, "sent-out-of-range", facts, (source, target))

    def unset(self, target: Field, source: Field | None) -> Iterator[Witness]:
        """A field that is read but not sent."""
        made = self._unvaried()
        if made is None:
            return
        frame = self._accepted(self._encoder, made)
        text = shown(target, raw_of(target, frame), self._encoder.assignment)
        sentence = "sent-unset" if self._messages.side is Side.SENDING else "received-unset"
        facts: dict[str, SentenceArgument] = {"name": target.name, "read": (f"`{self._messages.read.command}`: ", text)}
        yield self._made(RAW, Impact.SILENT, self._assignment, frame, sentence, facts, (source or target, target))

    def ignored(self, source: Field) -> Iterator[Witness]:
        """A field that is sent but not read."""
        for _, made in self._frames(source, source, self._encoder):
            frame = self._accepted(self._encoder, made)
            facts = {"sent": self._named(shown(source, raw_of(source, frame), self._encoder.assignment))}
            yield self._made(RAW, Impact.SILENT, self._assignment, frame, "sent-ignored", facts, (source,))
            return

    def constant(self, target: Field, source: Field | None) -> Iterator[Witness]:
        """A constant that the receiver requires and that is not always sent, or that means something else."""
        if (
            source is not None
            and source.role.sent_raw == target.role.required_raw
            and source.elements == target.elements
        ):
            return
        frames = [self._unvaried()]
        if source is not None and source.role.is_value:
            frames += [frame for _, frame in self._frames(source, target, self._encoder)]
            yield from self.field(target, source)
        for frame in filter(None, frames):
            if wrong_constants([target], frame):
                sentence = "sent-rejected" if self._messages.side is Side.SENDING else "received-rejected"
                facts: dict[str, SentenceArgument] = {
                    "sent": f"`{self._messages.sent.command}`",
                    "reason": Keyword("wrong constant"),
                }
                fields = (target,) if source is None else (source, target)
                yield self._made(RAW, Impact.LOUD, self._assignment, frame, sentence, facts, fields)
                return

    def _frames(self, source: Field, target: Field, encoder: Encoder) -> Iterator[tuple[Field, CanFrame]]:
        """Frames with other raw integers of a field, then of the fields that share bits with the one that is read."""
        sent = self._messages.sent
        base = candidates.base_raws(encoder, sent, self._node) or self._base
        varied = [(source, candidates.raws(encoder, source, target))] if source.role.is_value else []
        fields = (encoder.fields(sent) or {}).values()
        sharing = [field for field in fields if field is not source and match.overlap(field, target)]
        for field, raws in (*varied, *((shared, candidates.raws_of_each_bit(encoder, shared)) for shared in sharing)):
            nodes = self._messages.nodes if isinstance(field.role, NodeRole) else None
            for raw in raws:
                if nodes is not None and raw not in nodes:
                    continue
                for given in _spread(field, raw, base[field.name]):
                    frame = self._encoded(encoder, {**base, field.name: given})
                    if frame is not None:
                        yield field, frame
        if not source.role.is_value:
            frame = self._encoded(encoder, base)
            if frame is not None:
                yield source, frame

    def _accepted(self, encoder: Encoder, frame: CanFrame) -> CanFrame:
        """The frame with the constants that the receiver demands, if the sender can send it."""
        wrong = [field for field in wrong_constants(self._demanded, frame) if field.space is Space.DATA]
        if not wrong:
            return frame
        mask = data_bits((field.space, field.elements[0].segments) for field in wrong)
        constants = sum(candidates.placed(f.elements[0].segments, f.role.required_raw or 0) for f in wrong)
        data = (int.from_bytes(frame.data, "little") & ~mask | constants).to_bytes(MAX_DATA_BYTES, "little")
        changed = CanFrame(frame.id, data[: len(frame.data)], frame.extended, frame.remote)
        fields = encoder.fields(self._messages.sent) or {}
        again = self._encoded(encoder, {name: raw_of(field, changed) for name, field in fields.items()})
        return changed if again == changed else frame

    def _encoded(self, encoder: Encoder, raws: Mapping[str, Raw]) -> CanFrame | None:
        """The frame of the message; None if it cannot be sent."""
        sent = self._messages.sent
        frame = encoder.encode_raws(sent, self._node if sent.id.nodes else None, raws)
        return frame if isinstance(frame, CanFrame) else None

    def _unvaried(self) -> CanFrame | None:
        """The frame with the first allowed value in each field."""
        return self._encoded(self._encoder, self._base)

    def _named(self, shown: SentenceArgument) -> SentenceArgument:
        return (f"`{self._messages.sent.command}`: ", shown)

    def _misread(
        self,
        aspect: Aspect,
        assignment: Assignment,
        encoder: Encoder,
        frame: CanFrame,
        source: Field,
        sent: Raw,
        target: Field,
        read: Raw,
        fields: Iterable[Field],
        members: tuple[str, ...],
    ) -> Witness:
        sentence = "sent-read" if self._messages.side is Side.SENDING else "received-read"
        facts = {
            "sent": self._named(shown(source, sent, encoder.assignment)),
            "read": shown(target, read, encoder.assignment),
        }
        return self._made(aspect, Impact.SILENT, assignment, frame, sentence, facts, fields, members)

    def _made(
        self,
        aspect: Aspect,
        impact: Impact,
        assignment: Assignment,
        frame: CanFrame,
        sentence: str,
        facts: Mapping[str, SentenceArgument],
        fields: Iterable[Field],
        members: tuple[str, ...] = (),
    ) -> Witness:
        known, fields = {**self._encoder.assignment, **assignment}, tuple(fields)
        stated = {**assignment, **{n: known[n] for f in fields for n in parameters_of(f.type) if n in known}}
        messages = self._messages
        exists = messages.is_identified(frame) and (
            impact is Impact.LOUD or rejects_constants(messages.read, frame, known) is None
        )
        paths = messages.of_use | frozenset(of_fields(aspect, fields, members))
        return Witness(messages.side, impact, stated, frame, sentence, facts, messages.commands, paths, exists, True)


def parameters_of(type_: Type) -> tuple[str, ...]:
    """The parameters that the values of a type depend on."""
    return (*type_.parameters, *type_.numbers)


def _by_index(field: Field, raw: Raw) -> dict[int | None, int]:
    ordered = raw if isinstance(raw, list) else [raw]
    return {element.index: number for element, number in zip(field.elements, ordered, strict=True)}


def _constant(key: Key) -> Field:
    """A constant that distinguishes messages, as a field: a number without a unit."""
    type_ = Type(
        name=key.name,
        width=key.width,
        encoding=Encoding.UNSIGNED,
        order=key.order,
        unit=None,
        linear=ByParameter.always(IDENTITY),
        raw_range=ByParameter.always(None),
        enum=(),
        flags=(),
        plausible=None,
        title={},
        about={},
        differs={},
        path=key.path,
    )
    return Field(
        name=key.name,
        renamed_from=None,
        deprecated=None,
        type=type_,
        space=key.space,
        elements=(Element(None, key.segments),),
        is_array=False,
        only=(),
        role=ConstantRole(key.value),
        title={},
        about={},
        manual="",
        path=key.path,
    )


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
    ends = [end for end in (candidates.end_of(bound, assignment) for bound in bounds) if end is not None]
    if len(ends) < 2:
        ends = [] if is_float else [Fraction(limit) for limit in type_.raw_limits]
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
