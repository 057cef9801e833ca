"""What the receiver of a message reads in its fields, compared with what the sender wrote."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ...diagnostics.diagnostic import DocumentPath
from ...model import formatting
from ...model.layout import ConstantRole, Field, NodeRole, Space
from ...model.message import KeyRole, Message
from ...model.types import Assignment, Encoding, Type
from ...semantics.decoder import Value, field_value, value_of
from ...semantics.encoder import Encoder, Encoders
from ...semantics.frame import CanFrame, Raw, has_id_rule, raw_of, wrong_constants
from ..change import Fact, Impact, Side, Word
from . import candidates
from .assignments import Assignments
from .counterparts import Counterparts
from .witness import Aspect, Observation, Witness


@dataclass(frozen=True)
class Transfer:
    """A message as its sender encodes it, and the message as which its receiver decodes it."""

    side: Side
    commands: tuple[str, ...]
    available: Sequence[Mapping[str, tuple[str, ...]]]
    """The conditions of the command in both editions."""
    sent: Message
    read: Message
    nodes: Sequence[int] | None
    """The nodes of the message."""
    has_same_origin: bool
    """Whether both are the same message, so that its fields can have been renamed."""

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters that decide on the fields of the messages and on the command."""
        conditions = (name for only in self.available for name in only)
        layouts = (m.layout.parameter for m in (self.sent, self.read))
        return tuple(dict.fromkeys((*(name for name in layouts if name), *conditions)))

    def is_available(self, assignment: Assignment) -> bool:
        """Whether the sender has the command under some parameters, and an old host that receives it."""
        conditions = self.available[:1] if self.side is Side.SENDING else self.available
        return all(assignment.get(name, v[0]) in v for only in conditions for name, v in only.items())


class Reading:
    """Compares the fields of messages of two editions."""

    def __init__(self, counterparts: Counterparts, assignments: Assignments) -> None:
        self._counterparts = counterparts
        self._assignments = assignments
        self._encoders = Encoders()

    def observations(self, transfer: Transfer) -> Iterator[Observation]:
        """Every field that is not read as it was sent, with a frame for each aspect and each parameter value."""
        for assignment in self._assignments.of(transfer.parameters):
            if transfer.is_available(assignment):
                yield from self._under(transfer, assignment)

    def _under(self, transfer: Transfer, assignment: Assignment) -> Iterator[Observation]:
        encoder = self._encoders.under({**self._assignments.first, **assignment})
        fields, read = encoder.fields(transfer.sent), transfer.read.layout.variant(encoder.assignment)
        nodes = transfer.nodes
        base = candidates.base_raws(encoder, transfer.sent, nodes[0] if nodes else None)
        if fields is None or read is None or base is None:
            return
        pair = _Pair(self, transfer, assignment, encoder, base)
        written = transfer.sent.layout.variant(encoder.assignment)
        every = {field.name: field for field in written.fields} if written else {}
        of = self._sources(transfer, every)
        for target in read.fields:
            source = every.get(of.get(target.name, ""))
            if target.demanded is not None:
                yield from pair.constant(target, source)
            elif target.fixed is None:
                is_sent = source is not None and source.fixed is None
                yield from pair.field(target, source) if source and is_sent else pair.unset(target, source)
        if transfer.side is Side.SENDING:
            used = {
                of.get(target.name) for target in read.fields if target.fixed is None or target.demanded is not None
            }
            constants = {key.name for key in transfer.read.keys if key.role is KeyRole.CONSTANT}
            for name, field in fields.items():
                if name not in used | constants:
                    yield from pair.ignored(field)

    def _sources(self, transfer: Transfer, every: Mapping[str, Field]) -> dict[str, str]:
        """The name of the field that is sent, by that of the field that is read."""
        if not transfer.has_same_origin:
            return {field.name: field.name for field in transfer.read.layout.fields if field.name in every}
        if transfer.side is Side.SENDING:
            pairs = self._counterparts.fields(transfer.sent.layout, transfer.read.layout)
            return {new.name: old.name for old, new in pairs if old.name in every}
        pairs = self._counterparts.fields(transfer.read.layout, transfer.sent.layout)
        return {old.name: new.name for old, new in pairs if new.name in every}

    def is_same_type(self, one: Type, other: Type) -> bool:
        return self._counterparts.is_same_type(one, other)

    def members(self, side: Side, sent: Type, read: Type) -> Mapping[str, str]:
        """The names of members that are read, by those that are sent."""
        if side is Side.SENDING:
            return self._counterparts.members(sent, read)
        return self._counterparts.former_members(read, sent)

    def further(self, encoder: Encoder, known: Assignment, *fields: Field) -> Iterator[tuple[Assignment, Encoder]]:
        """`known` with every value of the further parameters that some fields depend on."""
        names = [name for f in fields for name in (*f.type.parameters, *f.type.numbers) if name not in known]
        for more in self._assignments.of(names):
            assignment = {**known, **more}
            yield assignment, self._encoders.under({**encoder.assignment, **assignment})


class _Pair:
    """One message under some parameters, sent and read."""

    def __init__(
        self,
        reading: Reading,
        transfer: Transfer,
        assignment: Assignment,
        encoder: Encoder,
        base: Mapping[str, Raw],
    ) -> None:
        self._reading = reading
        self._transfer = transfer
        self._assignment = assignment
        self._encoder = encoder
        self._base = base
        self._node = transfer.nodes[0] if transfer.nodes else None

    def field(self, target: Field, source: Field) -> Iterator[Observation]:
        """The differences of a field that both messages have."""
        same_type = self._reading.is_same_type(source.type, target.type)
        if same_type and source.elements == target.elements:
            return
        for assignment, encoder in self._reading.further(self._encoder, self._assignment, source, target):
            seen: set[Aspect] = set()
            for observation in self._compared(target, source, assignment, encoder):
                if observation.aspect is Aspect.MEMBER or observation.aspect not in seen:
                    seen.add(observation.aspect)
                    yield observation

    def _compared(
        self, target: Field, source: Field, assignment: Assignment, encoder: Encoder
    ) -> Iterator[Observation]:
        for one, raw, frame in self._frames(source, target, encoder):
            if target.space is Space.ID and self._has_foreign_id(frame):
                continue
            found = raw_of(target, frame)
            if self._differs(source, raw, target, found):
                yield self._misread(Aspect.RAW, assignment, encoder, frame, source, raw, target, found)
            yield from self._meaning(assignment, encoder, frame, source, one, target)

    def _has_foreign_id(self, frame: CanFrame) -> bool:
        """Whether a frame is rejected because of bits of its id, although both messages follow one rule."""
        sent, read = self._transfer.sent, self._transfer.read
        return sent.id == read.id and not has_id_rule(read, frame)

    def _differs(self, source: Field, sent: Raw, target: Field, read: Raw) -> bool:
        """Whether raw integers differ; those of arrays are compared by the index of their elements."""
        one, other = _by_index(source, sent), _by_index(target, read)
        compared = one.keys() | other.keys() if self._transfer.side is Side.SENDING else other.keys()
        return any(one.get(index) != other.get(index) for index in compared)

    def _meaning(
        self,
        assignment: Assignment,
        encoder: Encoder,
        frame: CanFrame,
        source: Field,
        raw: int,
        target: Field,
    ) -> Iterator[Observation]:
        """The difference between the values that two types give one raw integer."""
        low, high = target.type.raw_limits
        if target.type.encoding is Encoding.FLOAT and not low <= raw <= high:
            return
        sent, read = value_of(source.type, raw, encoder.assignment), value_of(target.type, raw, encoder.assignment)
        if source.type.is_number and target.type.is_number:
            units = [t.unit and t.unit.name for t in (source.type, target.type)]
            kinds = [t.encoding is Encoding.FLOAT for t in (source.type, target.type)]
            if sent != read or units[0] != units[1] or (sent is None and kinds[0] != kinds[1]):
                yield self._misread(Aspect.VALUE, assignment, encoder, frame, source, raw, target, raw)
            elif self._transfer.side is Side.SENDING and encoder.rejects_raw(target, _like(target, raw)) is not None:
                text = shown(source, raw, encoder.assignment)
                facts = {"sent": self._named(text), "allowed": encoder.limits(target.type)}
                yield self._made(
                    Aspect.RANGE, Impact.LOUD, assignment, frame, "sent-out-of-range", facts, (source, target)
                )
            return
        names = self._reading.members(self._transfer.side, source.type, target.type)
        expected = _renamed(names, sent)
        if expected != read or source.type.is_number != target.type.is_number:
            members = (*_members(sent), *_members(read))
            differing = [m for m in dict.fromkeys(members) if not (m in _members(read) and m in _members(expected))]
            yield self._misread(Aspect.MEMBER, assignment, encoder, frame, source, raw, target, raw, tuple(differing))

    def unset(self, target: Field, source: Field | None) -> Iterator[Observation]:
        """A field that is read but not sent; not one that is always sent as the same value."""
        if source is not None and isinstance(source.role, ConstantRole) and source.elements == target.elements:
            return
        if any(key.role is KeyRole.CONSTANT and key.name == target.name for key in self._transfer.sent.keys):
            return
        frame = self._unvaried()
        if frame is None:
            return
        text = shown(target, raw_of(target, frame), self._encoder.assignment)
        sentence = "sent-unset" if self._transfer.side is Side.SENDING else "received-unset"
        facts: dict[str, Fact] = {"name": target.name, "read": self._named(text)}
        yield self._made(
            Aspect.RAW, Impact.SILENT, self._assignment, frame, sentence, facts, (source or target, target)
        )

    def ignored(self, source: Field) -> Iterator[Observation]:
        """A field that is sent but not read."""
        for _, raw, frame in self._frames(source, source, self._encoder):
            facts = {"sent": self._named(shown(source, raw, self._encoder.assignment))}
            yield self._made(Aspect.RAW, Impact.SILENT, self._assignment, frame, "sent-ignored", facts, (source,))
            return

    def constant(self, target: Field, source: Field | None) -> Iterator[Observation]:
        """A constant that the receiver requires and that is not always sent."""
        if source is not None and source.fixed == target.demanded and source.elements == target.elements:
            return
        frames = [self._unvaried()]
        if source is not None and source.fixed is None:
            frames += [frame for _, _, frame in self._frames(source, source, self._encoder)]
        for frame in filter(None, frames):
            if wrong_constants([target], frame):
                sentence = "sent-rejected" if self._transfer.side is Side.SENDING else "received-rejected"
                facts: dict[str, Fact] = {
                    "sent": f"`{self._transfer.sent.command}`",
                    "reason": Word("wrong constant"),
                }
                fields = (target,) if source is None else (source, target)
                yield self._made(Aspect.RAW, Impact.LOUD, self._assignment, frame, sentence, facts, fields)
                return

    def _frames(self, source: Field, target: Field, encoder: Encoder) -> Iterator[tuple[int, Raw, CanFrame]]:
        """Frames with different raw integers of a field; for an array also the one that differs."""
        nodes = self._transfer.nodes if isinstance(source.role, NodeRole) else None
        base = candidates.base_raws(encoder, self._transfer.sent, self._node) or self._base
        for raw in candidates.raws(encoder, source, target):
            if nodes is not None and raw not in nodes:
                continue
            for given in _spread(source, raw, base[source.name]):
                frame = encoder.encode_raws(self._transfer.sent, self._node, {**base, source.name: given})
                if isinstance(frame, CanFrame):
                    yield raw, given, frame

    def _unvaried(self) -> CanFrame | None:
        """The frame with the first allowed value in each field."""
        made = self._encoder.encode_raws(self._transfer.sent, self._node, self._base)
        return made if isinstance(made, CanFrame) else None

    def _named(self, shown: Fact) -> Fact:
        return (f"`{self._transfer.sent.command}`: ", shown)

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
        members: tuple[str, ...] = (),
    ) -> Observation:
        sentence = "sent-read" if self._transfer.side is Side.SENDING else "received-read"
        facts = {
            "sent": self._named(shown(source, sent, encoder.assignment)),
            "read": shown(target, read, encoder.assignment),
        }
        return self._made(aspect, Impact.SILENT, assignment, frame, sentence, facts, (source, target), members)

    def _made(
        self,
        aspect: Aspect,
        impact: Impact,
        assignment: Assignment,
        frame: CanFrame,
        sentence: str,
        facts: Mapping[str, Fact],
        fields: Iterable[Field],
        members: tuple[str, ...] = (),
    ) -> Observation:
        witness = Witness(self._transfer.side, impact, assignment, frame, sentence, facts)
        paths: list[DocumentPath] = [path for f in fields for path in (f.path, f.type.path)]
        return Observation(aspect, witness, self._transfer.commands, tuple(dict.fromkeys(paths)), members)


def _by_index(field: Field, raw: Raw) -> dict[int | None, int]:
    ordered = raw if isinstance(raw, list) else [raw]
    return {element.index: one for element, one in zip(field.elements, ordered, strict=True)}


def _like(field: Field, raw: int) -> Raw:
    return [raw] * len(field.elements) if field.is_array else raw


def _spread(field: Field, raw: int, base: Raw) -> Iterator[Raw]:
    """A raw integer, or for an array the raw integer in each of its elements alone."""
    if not isinstance(base, list):
        yield raw
        return
    for at in range(len(field.elements)):
        yield [*base[:at], raw, *base[at + 1 :]]


def shown(field: Field, raw: Raw, assignment: Assignment) -> str:
    """A field with its value: `` `voltage = 48.7 V` ``."""
    values = field_value(field, raw, assignment)
    raws = raw if isinstance(raw, list) else [raw]
    each = values if isinstance(raw, list) and isinstance(values, list) else [values]
    unit = f" {field.type.unit.symbol}" if field.type.unit else ""
    texts = [_text(field.type, one, number, unit) for one, number in zip(each, raws, strict=False)]
    return f"`{field.name} = {', '.join(texts)}`"


def _text(type_: Type, value: Value | list[Value], raw: int, unit: str) -> str:
    if value is None:
        return str(raw)
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        known = sum(1 << flag.value for flag in type_.flags)
        others = [str(raw & ~known)] if raw & ~known else []
        return " + ".join([*map(str, value), *others]) or "0"
    written = formatting.exact(value)
    return (written if len(written) < 25 else repr(float(value))) + unit


def _members(value: object) -> tuple[str, ...]:
    if isinstance(value, str):
        return (value,)
    return tuple(map(str, value)) if isinstance(value, list) else ()


def _renamed(names: Mapping[str, str], value: object) -> object:
    """The members of a value under their names in the other edition; an empty name for one that is not there."""
    if isinstance(value, str):
        return names.get(value, "")
    return [names.get(str(one), "") for one in value] if isinstance(value, list) else value
