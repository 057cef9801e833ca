"""What the C functions do, against bits and fractions that are worked out here from the model alone."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.conformance.adapter import CanFrame, Decoded, Parameters, Raw, Refused, assignment
from canwright.model.checksum import Arithmetic, ConstantBytes, DataBytes
from canwright.model.edition import Edition
from canwright.model.layout import MAX_DATA_BYTES, ChecksumRole, Field, FixedRole, Segment, Space
from canwright.model.message import Command, Direction, Message
from canwright.model.refusal import Refusal
from canwright.model.types import Encoding, Order, Type
from canwright.project.loader import specification
from canwright.semantics.decoder import linear_of
from canwright.targets.c.expressions import integer

from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.reference import ReferenceAdapter
from ..semantics.random_frames import random_frames
from ..spec_texts import MINIMAL, SMALL, called
from .test_c_compiles import SPECS

ROUNDS = 20


@pytest.fixture(scope="module", params=[*SPECS, *SMALL], ids=called)
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Edition, CAdapter]:
    edition_input = specification(request.param)
    return edition_input.edition, CAdapter.create(edition_input, tmp_path_factory.mktemp("codec"))


def test_every_message_is_decoded_as_it_was_encoded(made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    chance = random.Random(1)
    for command, direction, message in _messages(edition):
        for parameters in _having(edition, command):
            for _ in range(ROUNDS):
                raw = {f.name: _raw(f, chance, parameters) for f in _fields(message, parameters)}
                node = chance.choice(message.id.nodes) if message.id.nodes is not None else None
                frame = _frame(message, node, raw, parameters)
                encoded = target.encode_raw(direction, command.name, node, raw, parameters)
                assert encoded == CanFrame(frame.id, frame.data, frame.extended, frame.remote), (message.name, raw)
                decoded = target.decode(direction, frame, parameters, command.name)
                assert isinstance(decoded, Decoded), (message.name, raw, decoded)
                assert (decoded.command, decoded.node, decoded.raw) == (command.name, _node(message, node, raw), raw)


WIDTHS = (2, 7, 8, 9, 12, 15, 16, 17, 20, 24, 25, 31, 32, 33, 36, 40, 47, 48, 49, 52, 55, 56)


@pytest.mark.parametrize("order", ["little", "big"])
def test_signed_fields_of_every_shape(order: str, tmp_path: Path) -> None:
    """C reads the sign of a field from its C type, from its highest byte or from a bit, whichever the width allows."""
    starts = [(w, start) for w in WIDTHS for start in (8, 12, 64 - w) if start + w <= 64]
    if order == "big":
        starts = [(w, start) for w in WIDTHS for start in (15, 11) if w <= 52]
    texts = [
        f"  c{number}: {{code: {number}, manual: x, reply: none,"
        f" request: {{level: {{at: {start // 8}.{start % 8}, raw: i{width}}}}}}}\n"
        for number, (width, start) in enumerate(starts, 1)
    ]
    head = MINIMAL.partition("commands:")[0].replace("selector", f"byte_order: {order}\nselector")
    (tmp_path / "spec.yaml").write_text(f"{head}commands:\n{''.join(texts)}", "utf-8")
    item = specification(tmp_path / "spec.yaml")
    target = CAdapter.create(item, tmp_path)
    for (width, _), command in zip(starts, item.edition.commands, strict=True):
        assert command.request is not None
        ends = -(1 << width - 1), (1 << width - 1) - 1
        for raw in {*ends, ends[0] + 1, ends[1] - 1, -1, 0, 1, ends[0] // 3, ends[1] // 3}:
            frame = _frame(command.request, 1, {"level": raw}, {})
            decoded = target.decode(Direction.REQUEST, frame, {}, command.name)
            assert isinstance(decoded, Decoded), (width, raw, decoded)
            assert decoded.raw == {"level": raw}, (command.name, width)


def test_noise_in_reserved_bits_is_ignored_and_other_frames_are_refused(made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    for command, direction, message in _messages(edition):
        for parameters in _having(edition, command):
            chance = random.Random(2)
            raw = {f.name: _raw(f, chance, parameters) for f in _fields(message, parameters)}
            node = message.id.nodes[0] if message.id.nodes is not None else None
            frame = _frame(message, node, raw, parameters)
            used = _used(message, parameters)
            noise = [bit for bit in range(8 * len(frame.data)) if bit not in used]
            loud = _frame(message, node, raw, parameters, noise)

            def ask(
                can: CanFrame, direction: Direction = direction, known: Parameters = parameters, c: Command = command
            ) -> Decoded | Refused:
                return target.decode(direction, can, known, c.name)

            noisy = ask(loud)
            assert isinstance(noisy, Decoded)
            assert noisy.raw == raw
            other_format = CanFrame(frame.id, frame.data, not frame.extended, frame.remote)
            assert isinstance(ask(other_format), Refused)
            other_kind = CanFrame(frame.id, frame.data, frame.extended, not frame.remote)
            assert isinstance(ask(other_kind), Refused)
            if message.dlc < MAX_DATA_BYTES and not message.remote:
                long = CanFrame(frame.id, frame.data + b"\0", frame.extended, frame.remote)
                assert ask(long) in (Refused(Refusal.WRONG_LENGTH), Refused(Refusal.UNKNOWN_CODE))


def test_a_raw_integer_beyond_its_range_is_refused_by_name(made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    for command, direction, message in _messages(edition):
        for parameters in _having(edition, command):
            chance = random.Random(3)
            node = message.id.nodes[0] if message.id.nodes is not None else None
            raw = {f.name: _raw(f, chance, parameters) for f in _fields(message, parameters)}
            for field in _fields(message, parameters):
                for beyond in _beyond(field.type, parameters):
                    value: Raw = [beyond] * len(field.elements) if field.is_array else beyond
                    answer = target.encode_raw(direction, command.name, node, {**raw, field.name: value}, parameters)
                    assert answer == Refused(Refusal.OUT_OF_RANGE, field.name), (message.name, field.name, beyond)


def test_the_reason_for_a_rejection_is_that_of_the_reference(made: tuple[Edition, CAdapter]) -> None:
    """The node comes first, then a missing parameter, then the fields in their order."""
    edition, target = made
    reference = ReferenceAdapter(edition)
    chance = random.Random(5)
    seen = set()
    for command, direction, message in _messages(edition):
        nodes = None if message.id.nodes is None else [*message.id.nodes, message.id.nodes[-1] + 1]
        for parameters in [*_having(edition, command), {}]:
            variant = message.layout.variant({name: str(value) for name, value in parameters.items()})
            fields = [f for f in variant.fields if f.is_given] if variant else []
            for _ in range(ROUNDS):
                node = chance.choice([nodes[0], nodes[-1]]) if nodes else None
                raw = {f.name: _raw(f, chance, parameters) for f in fields}
                for field in chance.sample(fields, chance.randint(0, len(fields))):
                    bits = [_any_bits(field.type, chance) for _ in field.elements]
                    raw[field.name] = bits if field.is_array else bits[0]
                encoded = target.encode_raw(direction, command.name, node, raw, parameters)
                wanted = reference.encode_raw(direction, command.name, node, raw, parameters)
                if isinstance(wanted, Refused):
                    seen.add(wanted.says)
                    wanted = Refused(wanted.says, None if wanted.says is Refusal.UNKNOWN_NODE else wanted.field)
                assert encoded == wanted, (message.name, node, raw, parameters)
    assert Refusal.UNKNOWN_NODE in seen


def test_the_check_of_any_frame_is_that_of_the_reference(made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    reference = ReferenceAdapter(edition)
    results = set()
    for frame in random_frames(edition, 400):
        for direction in Direction:
            for parameters in [*_assignments(edition)[:2], {}]:
                if not edition.messages(direction):
                    continue
                wanted: Decoded | CanFrame | Refused = reference.decode(direction, frame, parameters, None)
                decoded = isinstance(wanted, Decoded)
                if isinstance(wanted, Decoded):
                    wanted = reference.encode_raw(direction, wanted.command, wanted.node, wanted.raw, parameters)
                refusal = target.check(direction, frame, parameters)
                results.add((decoded, refusal is None))
                if not isinstance(wanted, Refused):
                    assert refusal is None, (frame, direction, parameters)
                else:
                    assert refusal == (wanted if decoded else Refused(wanted.says)), (frame, direction, parameters)
    assert (True, True) in results


def test_thousandths_are_the_nearest(made: tuple[Edition, CAdapter]) -> None:
    edition, target = made
    chance = random.Random(4)
    for type_ in edition.types:
        if not type_.is_number or type_.is_plain or type_.encoding is Encoding.FLOAT:
            continue
        for parameters in _assignments(edition):
            linear = linear_of(type_, {name: str(value) for name, value in parameters.items()})
            low, high = _limits(type_, parameters)
            for raw in [low, low + 1, 0, 1, -1, high - 1, high, *(chance.randint(low, high) for _ in range(ROUNDS))]:
                if not low <= raw <= high:
                    continue
                answer = target.milli(type_.name, "to", raw, parameters)
                if type_.no_value(raw):
                    assert answer == Refused(Refusal.NO_VALUE), (type_.name, raw)
                    continue
                if linear is None:
                    assert answer == Refused(Refusal.NO_SCALE)
                    continue
                exact = (raw * linear.scale + linear.offset) * 1000
                assert answer == _nearest(exact), (type_.name, raw)
                assert isinstance(answer, int)
                back = _nearest((Fraction(answer, 1000) - linear.offset) / linear.scale)
                if low <= back <= high and not type_.no_value(back):
                    assert target.milli(type_.name, "from", answer, parameters) == back, (type_.name, answer)
                else:
                    says = target.milli(type_.name, "from", answer, parameters)
                    assert says == Refused(Refusal.OUT_OF_RANGE), (type_.name, answer)
            if linear is not None:
                for end in (low - 1, high + 1):
                    milli = _nearest((end * linear.scale + linear.offset) * 1000)
                    beyond = _nearest((Fraction(milli, 1000) - linear.offset) / linear.scale)
                    if not low <= beyond <= high or type_.no_value(beyond):
                        says = target.milli(type_.name, "from", milli, parameters)
                        assert says == Refused(Refusal.OUT_OF_RANGE), (type_.name, milli)


def _messages(edition: Edition) -> Iterator[tuple[Command, Direction, Message]]:
    for message in edition.all_messages():
        yield edition.command(message.command), message.direction, message


def _having(edition: Edition, command: Command) -> Iterator[Parameters]:
    """The parameters of nodes that have a command."""
    return (known for known in _assignments(edition) if command.available(assignment(known)))


def _assignments(edition: Edition) -> list[Parameters]:
    """Every value of every parameter at least once, numbers as 7/2."""
    count = max((len(p.values) for p in edition.parameters), default=1)
    return [
        {p.name: p.values[i % len(p.values)].name if p.is_choice else "3.5" for p in edition.parameters}
        for i in range(count)
    ]


def _fields(message: Message, parameters: Parameters) -> list[Field]:
    variant = message.layout.variant({name: str(value) for name, value in parameters.items()})
    assert variant is not None
    return [field for field in variant.fields if field.is_given]


def _limits(type_: Type, parameters: Parameters) -> tuple[int, int]:
    low, high = type_.raw_limits
    limits = type_.raw_range.at({name: str(value) for name, value in parameters.items()})
    if limits is not None:
        numbers = {n: Fraction(str(v)) for n, v in parameters.items() if str(v)[0].isdigit()}
        least, most = limits.low.at(numbers), limits.high.at(numbers)
        low = low if least is None else max(low, math.ceil(least))
        high = high if most is None else min(high, math.floor(most))
    return low, high


def _raw(field: Field, chance: random.Random, parameters: Parameters) -> Raw:
    numbers = [_one(field.type, chance, parameters) for _ in field.elements]
    return numbers if field.is_array else numbers[0]


def _one(type_: Type, chance: random.Random, parameters: Parameters) -> int:
    if type_.enum:
        return chance.choice(type_.enum).value
    if type_.flags:
        return sum(1 << m.value for m in type_.flags if chance.random() < 0.5)
    if type_.encoding is Encoding.FLOAT:
        return chance.choice([0, 1 << (type_.width - 1), 0x3F800000 << (type_.width - 32), 1])
    low, high = _limits(type_, parameters)
    return chance.choice([low, high, chance.randint(low, high)])


def _any_bits(type_: Type, chance: random.Random) -> int:
    """Any number that fits the member of the struct; infinity for a float."""
    if type_.encoding is Encoding.FLOAT:
        return {32: 0x7F800000, 64: 0x7FF << 52}[type_.width]
    kind = integer(type_)
    return chance.randint(*kind.limits)


def _beyond(type_: Type, parameters: Parameters) -> list[int]:
    if type_.encoding is Encoding.FLOAT:
        return []
    if type_.flags:
        return [1 << bit for bit in range(type_.width + 1) if bit not in {m.value for m in type_.flags}]
    if type_.enum:
        return [n for n in range(1 << min(type_.width, 8)) if n not in {m.value for m in type_.enum}]
    low, high = _limits(type_, parameters)
    return [low - 1, high + 1]


def _place(frame: list[int], segments: Iterable[Segment], raw: int) -> None:
    for segment in segments:
        for bit in range(segment.width):
            frame[segment.byte * 8 + segment.low + bit] = raw >> (segment.raw_low + bit) & 1


def _used(message: Message, parameters: Parameters) -> set[int]:
    used = {
        s.byte * 8 + s.low + i
        for k in message.keys
        if k.space is Space.DATA
        for s in k.segments
        for i in range(s.width)
    }
    variant = message.layout.variant({name: str(value) for name, value in parameters.items()})
    for field in variant.fields if variant else ():
        if field.space is Space.DATA:
            used |= {bit for element in field.elements for bit in element.bits}
    return used


def _frame(
    message: Message, node: int | None, raw: dict[str, Raw], parameters: Parameters, noise: Iterable[int] = ()
) -> CanFrame:
    """The frame bit by bit; the bits of the data in `noise` are 1."""
    spaces = {Space.DATA: [0] * 8 * MAX_DATA_BYTES, Space.ID: [0] * 32}
    for bit in noise:
        spaces[Space.DATA][bit] = 1
    for key in message.keys:
        _place(spaces[key.space], key.segments, key.value)
    variant = message.layout.variant({name: str(value) for name, value in parameters.items()})
    fields = variant.fields if variant else ()
    for field in (f for f in fields if not isinstance(f.role, ChecksumRole)):
        given = field.role.raw if isinstance(field.role, FixedRole) else raw[field.name]
        numbers = given if isinstance(given, list) else [given] * len(field.elements)
        for element, number in zip(field.elements, numbers, strict=True):
            _place(spaces[field.space], element.segments, number)
    id_ = message.id.base + (node or 0) * message.id.node_step
    id_ += sum(bit << i for i, bit in enumerate(spaces[Space.ID]))
    for field in fields:
        if isinstance(field.role, ChecksumRole):
            checksum = _checksum(field.role, field.type.width, CanFrame(id_, _data(spaces), message.id.extended))
            _place(spaces[Space.DATA], field.elements[0].segments, checksum)
    data = b"" if message.remote else _data(spaces)[: message.dlc]
    return CanFrame(id_, data, message.id.extended, message.remote)


def _data(spaces: Mapping[Space, list[int]]) -> bytes:
    return sum(bit << i for i, bit in enumerate(spaces[Space.DATA])).to_bytes(MAX_DATA_BYTES, "little")


def _checksum(role: ChecksumRole, width: int, frame: CanFrame) -> int:
    """The checksum of a frame in which its bits are 0; a CRC bit by bit, as the catalogues define it."""
    of, content = role.algorithm, b""
    for part in role.inputs:
        if isinstance(part, ConstantBytes):
            content += part.data
        elif isinstance(part, DataBytes):
            content += frame.data[part.first : part.last + 1]
        elif part.is_low:
            content += bytes([frame.id & 0xFF])
        else:
            content += frame.id.to_bytes(4 if frame.extended else 2, "little" if part.order is Order.LITTLE else "big")
    if of.arithmetic is Arithmetic.SUM:
        return ((of.init + sum(content)) ^ of.xor_out) % (1 << width)
    register = of.init
    if of.arithmetic is Arithmetic.XOR:
        for byte in content:
            register ^= byte
    else:
        for bit in "".join(f"{byte:08b}"[:: -1 if of.is_reflected else 1] for byte in content):
            carry = register >> width - 1 ^ int(bit)
            register = register << 1 & (1 << width) - 1 ^ of.poly * carry
        if of.is_reflected:
            register = int(f"{register:0{width}b}"[::-1], 2)
    return (register ^ of.xor_out) % (1 << width)


def _node(message: Message, node: int | None, raw: Mapping[str, Raw]) -> Raw | None:
    """The node that a frame identifies: the one in its id, else the raw integer of a field with all of its bits."""
    return node if message.node_in_data is None else raw[message.node_in_data.name]


def _nearest(number: Fraction) -> int:
    magnitude = math.floor(abs(number) + Fraction(1, 2))
    return magnitude if number >= 0 else -magnitude
