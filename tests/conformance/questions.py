"""Questions to the targets of an edition, near the limits of every message and at random, and the comparison of answers."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from canwright.conformance.adapter import Adapter, CanFrame, Decoded, Parameters, Raw, Refused
from canwright.model.edition import Edition
from canwright.model.joined import Joined, JoinedText
from canwright.model.layout import Field, Space, bits_of
from canwright.model.message import Direction, Key, Message
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS, Encoding, Parameter
from canwright.resolve.number_parameters import number
from canwright.semantics.decoder import linear_of
from canwright.semantics.encoder import Encoder, Encoders
from canwright.semantics.frame import required_raw, with_checksum
from canwright.semantics.plan import message_plan

from ..float_rule import float_of
from ..semantics.random_frames import random_frame

Answer = Decoded | CanFrame | Refused | None

NUMBERS = ("1", "6", "3.5", "0.25", "36")
"""The values of number parameters; few, because a DBC is generated for each."""

HUGE = (Fraction(2.0**63), Fraction(-(2.0**63)), Fraction(1e300), Fraction(-1e300), Fraction(2.0**-1074))


@dataclass(frozen=True)
class Question:
    """A call of a method of `Adapter`; `kind` groups questions, as a target may be unable to answer some kinds."""

    kind: str
    task: str
    arguments: tuple[Any, ...]

    def ask(self, adapter: Adapter) -> Answer:
        """The answer of a target. Raises Cannot."""
        answer: Answer = getattr(adapter, self.task)(*self.arguments)
        return answer


class Questions:
    """Questions about one edition. Equal seeds give equal questions.

    Values are doubles, because C has no other numbers; with `fractions`, most of them are exact fractions.
    """

    def __init__(self, edition: Edition, seed: int = 1, *, fractions: bool = False) -> None:
        self._edition = edition
        self._chance = random.Random(seed)
        self._encoders = Encoders()
        self._messages = list(edition.all_messages())
        self._fractions = fractions
        self._choices = [(p.name, list(_values(edition, p))) for p in edition.parameters]

    def forever(self) -> Iterator[Question]:
        """Round after round."""
        while True:
            yield from self.round()

    def round(self) -> Iterator[Question]:
        """Questions about every message: each limit of its id, its length, its keys, its fields and its reply.

        The messages take turns, so that some questions reach all of them.
        """
        for group in itertools.zip_longest(*map(self._about, self._messages)):
            yield from (question for question in group if question is not None)

    def _about(self, message: Message) -> Iterator[Question]:
        """Questions about one message; its kinds of questions take turns."""
        kinds = [self._frames(message), self._raws(message), self._given_values(message), self._mistakes(message)]
        kinds.append(self._codes(message))
        if message.direction is Direction.REQUEST:
            kinds.append(self._replies(message))
        for group in itertools.zip_longest(*kinds):
            yield from (question for question in group if question is not None)

    def _parameters(self) -> Parameters:
        """A value for most parameters."""
        known = ((name, self._chance.choice(values)) for name, values in self._choices if self._chance.random() < 0.9)
        return {name: value for name, value in known if value is not None}

    def _nodes(self, message: Message) -> Sequence[int | None]:
        """A node, both ends of the nodes, and beyond them."""
        nodes = message.id.nodes
        if nodes is None:
            return (None,)
        ends = (nodes[0], nodes[-1], nodes[-1] + 1, *((nodes[0] - 1,) if nodes[0] else ()), 1 << 32 - 1)
        return (self._chance.choice(nodes), *ends)

    def _node(self, message: Message) -> int | None:
        return self._nodes(message)[0]

    def _frames(self, message: Message) -> Iterator[Question]:
        """Frames of a message, by itself and as a message that is expected."""
        for frame in (*self._near(message), *self._random(message), *self._with_fields(message)):
            known = self._parameters()
            for direction in Direction:
                yield Question("decode", "decode", (direction, frame, known, None))
            yield Question("decode expected", "decode", (message.direction, frame, known, message.command))

    def _near(self, message: Message, known: Parameters = NO_PARAMETERS) -> Iterator[CanFrame]:
        """A frame of a message, and frames that differ from it in one part."""
        chance = self._chance
        first = self._node(message)
        frame = self._frame(message, first, known=known)
        ids = frame.id & message.id_mask
        base = (frame.id & ~message.id_mask) - (first or 0) * message.id.node_step
        for node in self._nodes(message)[:-1]:
            if node is not None:
                yield frame._replace(id=base + node * message.id.node_step | ids)
        bits = 29 if message.id.extended else 11
        for bit in (chance.randrange(bits), chance.randrange(bits), chance.randrange(29)):
            yield frame._replace(id=frame.id ^ 1 << bit)
        yield frame._replace(extended=not frame.extended)
        yield frame._replace(remote=not frame.remote)
        if not frame.remote:
            lengths = {another.dlc for another in self._messages if another.direction is message.direction}
            for length in sorted({0, 8, message.dlc - 1, message.dlc + 1, *lengths} & set(range(9))):
                yield frame._replace(data=frame.data[:length].ljust(length, b"\0"))
            fixed = (f for f in message.layout.fields if not f.is_given)
            parts = [(k.space, bits_of((segment,))) for k in message.keys for segment in k.segments]
            parts += [(f.space, e.bits) for f in fixed for e in f.elements]
            beyond = base + ((message.id.nodes or range(1))[-1] + 1) * message.id.node_step
            for space, bits_ in parts:
                wrong = _flipped(frame, space, chance.choice(list(bits_)))
                yield from (wrong, wrong._replace(data=wrong.data[:-1]), wrong._replace(id=beyond | ids))

    def _with_fields(self, message: Message) -> Iterator[CanFrame]:
        """Frames with raw integers at the limits of each field and beyond them, one field at a time."""
        encoder = self._encoders.for_parameters(self._known(message))
        for field in (encoder.fields(message) or {}).values():
            for raw in dict.fromkeys(self._candidates(encoder, field)):
                frame = self._frame(message, self._node(message))
                for i, bit in enumerate(self._chance.choice(field.elements).bits):
                    if not frame.remote and _bit(frame, field.space, bit) != raw >> i & 1:
                        frame = _flipped(frame, field.space, bit)
                yield sealed(message, frame)

    def _random(self, message: Message) -> Iterator[CanFrame]:
        """Frames with random data and frames with something of another message."""
        for _ in range(4):
            yield self._frame(message, self._node(message), noise=True)
            mixed = random_frame(message, self._chance.choice(self._messages), self._chance)
            yield from dict.fromkeys((mixed, sealed(message, mixed)))
        yield CanFrame(self._chance.getrandbits(11), self._chance.randbytes(self._chance.randrange(9)))
        yield CanFrame(self._chance.getrandbits(29), self._chance.randbytes(self._chance.randrange(9)), True)

    def _frame(
        self, message: Message, node: int | None, noise: bool = False, known: Parameters = NO_PARAMETERS
    ) -> CanFrame:
        """A frame of a message, or of one of its accepted keys; with `noise`, bits are random, except for constants."""
        encoder = self._encoders.for_parameters(self._known(message, known))
        raws = {name: self._raw(encoder, field) for name, field in (encoder.fields(message) or {}).items()}
        frame = encoder.encode_raws(message, node, raws)
        assert isinstance(frame, CanFrame), frame
        keys: list[tuple[Key, tuple[int, ...]]] = [(key, (key.value,)) for key in message.keys]
        if keys and (message.accepted_codes or message.identifying_codes):
            keys[0] = (keys[0][0], (*message.accepted_codes, *message.identifying_codes))
        id_, word = frame.id, int.from_bytes(frame.data, "little")
        if noise:
            constants = (f for f in message.layout.fields if f.space is Space.DATA and required_raw(f) is not None)
            fixed = sum(1 << bit for f in constants for e in f.elements for bit in e.bits)
            word |= self._chance.getrandbits(8 * len(frame.data) or 1) & ~fixed
        for key, values in keys:
            value = self._chance.choice(values)
            for i, bit in enumerate(bits_of(key.segments)):
                change = (value >> i & 1) << bit
                if key.space is Space.ID:
                    id_ = id_ & ~(1 << bit) | change
                else:
                    word = word & ~(1 << bit) | change
        data = (word & (1 << 8 * len(frame.data)) - 1).to_bytes(len(frame.data), "little")
        return sealed(message, frame._replace(id=id_, data=data))

    def _having(self, message: Message, known: Parameters) -> Parameters:
        """Parameters of a node that has the command of a request: C does not encode it for other nodes."""
        only = message.only
        lacking = [name for name, values in only.items() if known.get(name, values[0]) not in values]
        return {**known, **{name: self._chance.choice(only[name]) for name in lacking}}

    def _known(self, message: Message, preferred: Parameters = NO_PARAMETERS) -> Parameters:
        """Parameters under which id and fields of a message are known and a node has the command of a request."""
        known = dict(self._having(message, preferred or self._parameters()))
        name = message.layout.parameter
        if name is not None and name not in known:
            known[name] = self._chance.choice(self._edition.parameter(name).values).name
        values = dict(self._choices)
        return {**{needed: self._chance.choice(values[needed]) for needed in message.parameters}, **known}

    def _raw(self, encoder: Encoder, field: Field) -> Raw:
        """A valid raw integer of a field, or a list for an array."""
        raws = [self._valid(encoder, field) for _ in field.elements]
        return raws if field.is_array else raws[0]

    def _valid(self, encoder: Encoder, field: Field) -> int:
        """A valid raw integer of an element of a field."""
        candidates = self._candidates(encoder, field)
        start = self._chance.randrange(len(candidates))
        turned = itertools.chain(candidates[start:], candidates[:start])
        return next((raw for raw in turned if encoder.rejects_raw(field, raw) is None), 0)

    def _candidates(self, encoder: Encoder, field: Field) -> list[int]:
        """Raw integers at the limits of a field, beyond them, and between."""
        type_, chance = field.type, self._chance
        low, high = type_.raw_limits
        ends = {low, high, 0, 1}
        span = type_.raw_range.at(encoder.assignment)
        if type_.encoding is Encoding.FLOAT:
            near = [0.0, -0.0, 1.0, -1.0, chance.uniform(-10, 10), math.inf, -math.inf, math.nan, 3e38, 1e-40]
            if span is not None:
                numbers = [float(end.constant) for end in (span.low, span.high)]
                near += [n for number in numbers for n in (number, number * 1.000001, number * 0.999999)]
            bits = (encoder.nearest_raw(field, Fraction(n)) for n in near if math.isfinite(n))
            infinity, sign = {32: 0xFF << 23, 64: 0x7FF << 52}[type_.width], 1 << type_.width - 1
            special = (infinity, infinity | sign, infinity | 1, infinity - 1, sign, sign | 1, 1)
            return [*(b for b in bits if isinstance(b, int)), chance.getrandbits(type_.width), high, 0, *special]
        if span is not None:
            numbers_ = {n: Fraction(v) for n, v in encoder.assignment.items() if n in type_.numbers}
            for bound in (span.low.at(numbers_), span.high.at(numbers_)):
                ends |= {math.floor(bound), math.ceil(bound)} if bound is not None else set()
        ends |= {member.value for member in type_.enum} | {1 << flag.value for flag in type_.flags}
        ends |= {end for no_value in type_.no_values for end in (no_value.raws[0], no_value.raws[-1])}
        ends |= {member.value for member in type_.names}
        mask = sum(1 << flag.value for flag in type_.flags)
        inner = [chance.getrandbits(type_.width) & mask] if mask else [chance.randint(low, high) for _ in range(4)]
        bounds = sorted(ends)
        inner += [chance.randint(a, b) for a, b in itertools.pairwise(bounds[1:-1]) if b - a > 2][:4]
        return [*inner, *(near for end in bounds for near in (end - 1, end, end + 1))]

    def _raws(self, message: Message) -> Iterator[Question]:
        """Every limit of every field, one field at a time, and every limit of the node."""
        known = self._having(message, self._parameters())
        for node in self._nodes(message):
            encoder = self._encoders.for_parameters(known)
            raws = {name: self._raw(encoder, field) for name, field in (encoder.fields(message) or {}).items()}
            if encoder.fields(message) is not None:
                yield Question("encode raw", "encode_raw", (*_start(message), node, raws, known))
        known = self._known(message)
        encoder = self._encoders.for_parameters(known)
        fields = encoder.fields(message) or {}
        for name, field in fields.items():
            for candidate in self._candidates(encoder, field):
                raws = {other_name: self._raw(encoder, other_field) for other_name, other_field in fields.items()}
                there = raws[name]
                if isinstance(there, list):
                    there[self._chance.randrange(len(there))] = candidate
                else:
                    raws[name] = candidate
                yield Question("encode raw", "encode_raw", (*_start(message), self._node(message), raws, known))

        if message.id.nodes is not None and fields:  # several reasons to reject: the node comes first
            largest = {name: _largest(field) for name, field in fields.items()}
            unknown = {name: value for name, value in known.items() if name != message.layout.parameter}
            for parameters in (known, unknown) if unknown != known else (known,):
                given = (*_start(message), message.id.nodes[-1] + 1, largest, self._having(message, parameters))
                yield Question("encode raw", "encode_raw", given)

    def _mistakes(self, message: Message) -> Iterator[Question]:
        """Several mistakes at once: a node that does not exist, no parameters, and only invalid raw integers."""
        nodes = message.id.nodes
        for parameters in (self._known(message), self._having(message, {})):
            fields = self._encoders.for_parameters(parameters).fields(message) or {}
            invalid = {name: _largest(field) for name, field in fields.items()}
            for node in (None,) if nodes is None else (nodes[0], nodes[-1] + 1):
                yield Question("several mistakes", "encode_raw", (*_start(message), node, invalid, parameters))
        for name, values in message.only.items():
            lacking = [value.name for value in self._edition.parameter(name).values if value.name not in values]
            for parameters in ({name: value} for value in lacking):
                node = None if nodes is None else nodes[-1] + 1
                yield Question("not available", "encode_raw", (*_start(message), node, {}, parameters))

    def _codes(self, message: Message) -> Iterator[Question]:
        """Each accepted code, one that is none, and that one with another mistake."""
        codes = message_plan(message).codes
        if not codes:
            return
        known = self._known(message)
        encoder = self._encoders.for_parameters(known)
        fields = encoder.fields(message) or {}
        wrong = next(code for code in itertools.count(1) if code not in codes)
        for code in (*codes, wrong):
            raws = {name: self._raw(encoder, field) for name, field in fields.items()}
            yield Question("code", "encode_raw", (*_start(message), self._node(message), raws, known, code))
        for node in self._nodes(message):
            largest = {name: _largest(field) for name, field in fields.items()}
            yield Question("code", "encode_raw", (*_start(message), node, largest, known, wrong))

    def _given_values(self, message: Message) -> Iterator[Question]:
        """Values at the limits of every field, ties, and what is no number."""
        known = self._known(message)
        encoder = self._encoders.for_parameters(known)
        fields = encoder.fields(message) or {}
        for name, field in fields.items():
            for kind, candidate in self._values_of(encoder, field):
                values = {other_name: self._value(encoder, other_field) for other_name, other_field in fields.items()}
                is_list = field.is_array and field.type.joined is None
                values[name] = [candidate] * len(field.elements) if is_list else candidate
                if all(value is not None for value in values.values()):
                    yield Question(kind, "encode_values", (*_start(message), self._node(message), values, known))

    def _value(self, encoder: Encoder, field: Field) -> Any:
        """A valid value; None where the field has no scale."""
        if field.type.joined is not None:
            return self._chance.choice([value for kind, value in self._joined(field.type.joined) if kind == "value"])
        values = [self._of_raw(encoder, field, self._valid(encoder, field)) for _ in field.elements]
        return None if None in values else values if field.is_array else values[0]

    def _joined(self, joined: Joined) -> Iterator[tuple[str, Any]]:
        """Texts that fit and that do not, and numbers around the limits of decimal digits."""
        if isinstance(joined, JoinedText):
            end = chr(joined.padding) if 0 < joined.padding < 128 else "\0"
            widest = "\u20ac" * (joined.count // 3) if joined.codec == "utf-8" else "~" * joined.count
            texts = ["", "A", "0042"[: joined.count], "x" * joined.count, widest]
            yield from (("value", text) for text in texts)
            refused = ("x" * (joined.count + 1), f"a{end}", "\0", "\ud800", "\u20ac" * joined.count)
            yield from (("no value", text) for text in refused)
        else:
            most = Fraction(10**joined.count - 1)
            yield from (("value", Fraction(number)) for number in (0, 1, most, most // 7))
            half = Fraction(1, 2)
            yield from (("tie", number) for number in (half, most + half, -half, most - half))
            yield from (("no value", value) for value in (Fraction(-1), most + 1, "nan", "inf", "-inf"))

    def _of_raw(self, encoder: Encoder, field: Field, raw: int, steps: Fraction = Fraction(0)) -> Any:
        """The value of a raw integer and a part of a step, as a double or as a fraction."""
        type_ = field.type
        if type_.enum:
            return next((member.name for member in type_.enum if member.value == raw), type_.enum[0].name)
        if type_.flags:
            return [flag.name for flag in type_.flags if raw >> flag.value & 1]
        no_value = type_.no_value(raw)
        if no_value is not None and not steps:
            return no_value.name
        if type_.name_of(raw) and not steps and self._chance.random() < 0.5:
            return type_.name_of(raw)
        linear = linear_of(type_, encoder.assignment)
        if linear is None:
            return None
        exact = Fraction(_number(type_.encoding, type_.width, raw)) + steps
        exact = exact * linear.scale + linear.offset
        if self._fractions and self._chance.random() < 0.7:
            return exact
        return Fraction(float(exact))

    def _values_of(self, encoder: Encoder, field: Field) -> Iterator[tuple[str, Any]]:
        """Values of raw integers; values between them, ties included, and values that no raw integer has."""
        type_ = field.type
        half, little = Fraction(1, 2), Fraction(1, 1 << 20)
        if type_.joined is not None:
            yield from self._joined(type_.joined)
            return
        for raw in dict.fromkeys(self._candidates(encoder, field)):
            yield "encode values", self._of_raw(encoder, field, raw)
            if type_.is_number and type_.encoding is not Encoding.FLOAT:
                sign = self._chance.choice((-1, 1))
                for part in (little, half - little, half, half + little):
                    yield "encode between", self._of_raw(encoder, field, raw, sign * part)
        if type_.is_number:
            yield from (("encode between", value) for value in ("nan", "inf", "-inf", *HUGE))
        if type_.encoding is Encoding.FLOAT:
            yield from (("encode between", value) for value in self._near_ties(encoder, field))

    def _near_ties(self, encoder: Encoder, field: Field) -> Iterator[Fraction]:
        """Doubles between the floats next to the value 0, where an offset takes all digits that decide on the nearest."""
        type_, linear = field.type, linear_of(field.type, encoder.assignment)
        at_zero = encoder.nearest_raw(field, Fraction(0))
        if linear is None or not isinstance(at_zero, int):
            return
        for raw in (at_zero, at_zero + 1):
            low, high = (Fraction(_number(type_.encoding, type_.width, number)) for number in (raw, raw + 1))
            tie = (low + high) / 2 * linear.scale + linear.offset
            for part in (-1, 0, 1):
                yield Fraction(float(tie * (1 + Fraction(part, 1 << 50))))

    def _replies(self, message: Message) -> Iterator[Question]:
        """Replies to a request, and frames that differ from them in one part."""
        known = self._parameters()
        for request, reply in itertools.chain(self._answers(message, known), self._requests(message, known)):
            yield Question("answers", "answers", (request, reply, known))

    def _answers(self, message: Message, known: Parameters) -> Iterator[tuple[CanFrame, CanFrame]]:
        """A request with replies from the nodes near its own, each also with a part changed."""
        chance = self._chance
        command = self._edition.command(message.command)
        node = self._node(message)
        request = self._frame(message, node, noise=True, known=known)
        replies = [m for m in self._messages if m.direction is Direction.REPLY]
        for reply in (*(own.message for own in command.replies), *([chance.choice(replies)] if replies else [])):
            nodes = reply.id.nodes
            to = command.from_each or ((node,) if nodes is not None and node in nodes else (None,))
            near = {n + step for n in to if n is not None for step in (-1, 0, 1, 2, 4)} & set(nodes or ())
            for sender in (*sorted(near), *((chance.choice(nodes),) if nodes is not None else (None,))):
                answer = self._frame(reply, sender, known=known)
                if command.is_echoed and reply is command.reply and chance.random() < 0.8:
                    answer = answer._replace(data=request.data)
                yield request, answer
                yield from ((request, changed) for changed in self._changed(reply, answer))

    def _changed(self, message: Message, frame: CanFrame) -> Iterator[CanFrame]:
        """A frame with one bit changed, in each of some fields of the id and in each byte, and with another length."""
        for field in (f for f in message.layout.fields if f.space is Space.ID):
            yield _flipped(frame, Space.ID, field.elements[0].bits[0])
        for byte in range(len(frame.data)):
            yield _flipped(frame, Space.DATA, 8 * byte + self._chance.randrange(8))
        for length in {len(frame.data) - 1, len(frame.data) + 1, 0} & set(range(9)):
            yield frame._replace(data=frame.data[:length].ljust(length, b"\0"))

    def _requests(self, message: Message, known: Parameters) -> Iterator[tuple[CanFrame, CanFrame]]:
        """Frames that are nearly a request, with its reply."""
        reply = self._edition.command(message.command).reply or message
        for frame in self._near(message, known):
            yield frame, self._frame(reply, self._node(reply), known=known)


def _start(message: Message) -> tuple[Direction, str]:
    return message.direction, message.command


def _values(edition: Edition, parameter: Parameter) -> Iterator[str]:
    """The values of a choice, and some that a number can have."""
    yield from (value.name for value in parameter.values)
    if parameter.whole and parameter.minimum is not None and parameter.maximum is not None:
        ends = (parameter.minimum, (parameter.minimum + parameter.maximum) // 2, parameter.maximum)
        yield from dict.fromkeys(str(end) for end in ends)
    elif not parameter.is_choice:
        for text in NUMBERS:
            try:
                number(edition, parameter, text)
            except ValueError:
                continue
            yield text


def _largest(field: Field) -> Raw:
    """The largest raw integer that the type of a field in C contains, mostly an invalid one; a list for an array."""
    bits = max(8, 1 << (field.type.width - 1).bit_length())
    raw = (1 << bits - (field.type.encoding is Encoding.SIGNED)) - 1
    return [raw] * len(field.elements) if field.is_array else raw


def _number(encoding: Encoding, width: int, raw: int) -> Fraction | int:
    """The number that raw bits are."""
    if encoding is not Encoding.FLOAT:
        return raw
    number = float_of(raw, width)
    return Fraction(number) if math.isfinite(number) else 0


def _bit(frame: CanFrame, space: Space, bit: int) -> int:
    return (frame.id if space is Space.ID else int.from_bytes(frame.data, "little")) >> bit & 1


def sealed(message: Message, frame: CanFrame) -> CanFrame:
    """A frame with the checksum of a message, if it has its length."""
    return with_checksum(message, frame) if len(frame.data) == message.dlc else frame


def _flipped(frame: CanFrame, space: Space, bit: int) -> CanFrame:
    """A frame with another value of one bit."""
    if space is Space.ID:
        return frame._replace(id=frame.id ^ 1 << bit)
    word = int.from_bytes(frame.data, "little") ^ 1 << bit
    return frame._replace(data=(word & (1 << 8 * len(frame.data)) - 1).to_bytes(len(frame.data), "little"))


def disagreement(wanted: Answer, answer: Answer, tolerance: float = 0.0, *, reports_code: bool = False) -> str:
    """The first part in which an answer differs from that of the reference; empty if they agree."""
    if isinstance(wanted, Decoded) and isinstance(answer, Decoded):
        for part in ("command", "node", "raw", *(["code"] if reports_code else [])):
            if getattr(wanted, part) != getattr(answer, part):
                return f"{part} {getattr(answer, part)}, not {getattr(wanted, part)}"
        return _differing(wanted.values, answer.values, tolerance)
    if isinstance(wanted, Refused) and isinstance(answer, Refused):
        names = wanted.field is not None and answer.field not in (None, "") and wanted.says is not Refusal.UNKNOWN_NODE
        if wanted.says is not answer.says or (names and wanted.field != answer.field):
            return f"{answer}, not {wanted}"
        return ""
    return "" if wanted == answer else f"{answer}, not {wanted}"


def _differing(wanted: Mapping[str, Any], given: Mapping[str, Any], tolerance: float) -> str:
    for name in {**wanted, **given}:
        if name not in wanted or name not in given or not _same(wanted[name], given[name], tolerance):
            if tolerance and wanted.get(name) is None and given.get(name) is None:
                continue  # a target that is not exact cannot tell why there is no value
            return f"{name} is {given.get(name, 'missing')!r}, not {wanted.get(name, 'missing')!r}"
    return ""


def _same(wanted: Any, given: Any, tolerance: float) -> bool:
    if isinstance(wanted, list) and isinstance(given, list):
        return len(wanted) == len(given) and all(_same(w, f, tolerance) for w, f in zip(wanted, given, strict=True))
    if isinstance(given, float) and not math.isfinite(given):
        return wanted is None
    if isinstance(wanted, float) and isinstance(given, (int, float)):
        return abs(given - wanted) <= tolerance * abs(wanted)
    return bool(wanted == given)
