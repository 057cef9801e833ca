"""The functions of an edition, printed step by step from its plans.

An expression names the parts of a frame `id` and `d`, its data; a message is the constant `DIRECTION_COMMAND`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import TypeVar

from ...model.exhaustive import assert_never
from ...model.layout import Field, Segment, Space
from ...model.message import BitRun, Direction, Message
from ...model.refusal import Refusal
from ...model.types import Encoding, Type
from ...semantics import dispatch
from ...semantics.bits import placed
from ...semantics.checksum import ChecksumPlan
from ...semantics.plan import (
    CheckAvailable,
    CheckChecksum,
    CheckCode,
    CheckConstant,
    CheckField,
    CheckMeaning,
    CheckNode,
    CheckParameter,
    ChooseFields,
    DecodingStep,
    EncodingStep,
    NeedParameter,
    ReadField,
    WriteChecksum,
    WriteCode,
    WriteField,
    WriteFixed,
    WriteParameter,
    message_plan,
)
from ..nested_source import Code, Value
from ..tables import Positions, checksum_table
from . import bits, text

PARTS = "{ id, data: d }"
"""What a function takes of a frame."""

Lines = Iterator[str]
Step = TypeVar("Step")


def constant(message: Message) -> Code:
    """The constant that a message is in its module."""
    return Code(f"{message.direction.value}_{message.command}")


def read_in(run: BitRun, message: Message) -> str:
    """The value of some bits in a frame of a message."""
    return _read(run, message.length)


def keys(message: Message) -> str:
    """The condition that a frame has the keys of a message; empty without a key."""
    plan = message_plan(message)
    return " && ".join(_has(accepted.key, accepted.values, message.length) for accepted in plan.keys)


def route(direction: Direction, of: dispatch.Route) -> Lines:
    """The statements that return the message of a frame of a route, or the error if it is none."""
    shortest = min(message.length for message in of.messages)
    yield from _decision(direction, of.then, (), shortest)


def _decision(
    direction: Direction, node: dispatch.DispatchNode, path: Sequence[dispatch.Select], shortest: int
) -> Lines:
    match node:
        case dispatch.Match():
            yield f"return {constant(node.message)};"
        case dispatch.Reject():
            yield f"return {_rejection(direction, node.reason, path, shortest)};"
        case dispatch.Select():
            after = (*path, node)
            yield f"switch ({_subject(node.subject, shortest)}) {{"
            for case in node.cases:
                yield from (f"  case {value}:" for value in _values(node, case.values))
                yield from _indented(_decision(direction, case.then, after, shortest))
            yield "}"
            yield from _decision(direction, node.otherwise, after, shortest)
        case _:
            assert_never(node)


def _rejection(direction: Direction, reason: Refusal, path: Sequence[dispatch.Select], shortest: int) -> str:
    """The error of a frame, explained by the decisions that lead to it."""
    if reason is Refusal.WRONG_LENGTH:
        lengths = [select for select in path if isinstance(select.subject, dispatch.Length)][-1]
        return f"wrongLength(frame, {text.printed(list(lengths.by_value))})"
    if reason is Refusal.UNKNOWN_CODE:
        codes = (_read(select.subject, shortest) for select in path if isinstance(select.subject, BitRun))
        return f"unknownCode(frame, {text.quoted(direction.value)}, [{', '.join(codes)}])"
    return "unusedBits(frame)"


def _subject(subject: dispatch.Discriminator, shortest: int) -> str:
    if isinstance(subject, dispatch.Length):
        return "d.length"
    if isinstance(subject, dispatch.MaskedId):
        return f"id & 0x{subject.mask:X}"
    return _read(subject, shortest)


def _values(select: dispatch.Select, values: Iterable[int]) -> Iterable[str]:
    run = select.subject
    return (_code(value, run.width) if isinstance(run, BitRun) else str(value) for value in values)


def _code(value: int, width: int) -> Code:
    """The value of a key."""
    return text.integer(value, width) if width > 8 else Code(f"0x{value:02X}")


def _has(run: BitRun, values: Sequence[int], length: int) -> str:
    """The condition that some bits of a frame have one of some values."""
    codes, value = [_code(value, run.width) for value in values], _read(run, length)
    return (
        f"{bits.in_parentheses(value)} === {codes[0]}"
        if len(codes) == 1
        else f"{text.printed(codes)}.includes({value})"
    )


def _read(run: BitRun, length: int) -> str:
    """The value of some bits in a frame of at least `length` data bytes."""
    return bits.read(run.space, run.segments, run.width, length)


class Functions:
    """Prints the functions of the messages of one edition.

    `checksums` are the definitions of checksums, each with the constant that computes it.
    """

    def __init__(self, tables: Positions) -> None:
        self._types = tables.types
        self.checksums: dict[str, str] = {}

    def check(self, message: Message) -> Lines:
        """The statements that reject a frame whatever the parameters are; none if there is no such check."""
        for step in _leading(message):
            yield from self._check(step, message.length)

    def read(self, message: Message) -> Lines:
        """The statements that return the message of a frame that is checked, and a node, under the parameters `p`."""
        plan = message_plan(message)
        steps = plan.decoding[len(_leading(message)) :]
        if plan.codes or steps:
            yield f"const {PARTS} = frame;"
        yield from self._decoding(message, steps, message.layout.fields)

    def write(self, message: Message) -> Lines:
        """The statements that return the frame of what is `given` under the parameters `p`."""
        yield from self._encoding(message, message_plan(message).encoding, message.layout.fields)

    def _decoding(self, message: Message, steps: Sequence[DecodingStep], present: Collection[Field]) -> Lines:
        """The statements of steps, of which those of fields that are not present are left out."""
        fields: list[Field] = []
        for number, step in enumerate(steps):
            match step:
                case ChooseFields():
                    yield from _choice(message, steps[number + 1 :], self._decoding)
                    return
                case CheckConstant() | CheckChecksum() | CheckParameter():
                    if step.field in present:
                        yield from self._check(step, message.length)
                case ReadField():
                    fields += [step.field] if step.field in present else []
                case _:
                    assert_never(step)
        plan = message_plan(message)
        exact: dict[str, Value] = {"__proto__": Code("EXACT")} if any(f.type.width > 53 for f in fields) else {}
        raws: dict[str, Value] = {f.name: Code(_raw(f, message.length)) for f in fields}
        values: dict[str, Value] = {f.name: Code(self._value(f)) for f in fields}
        code = f", {read_in(message.keys[0], message)}" if plan.codes else ""
        yield f"const raw = Object.freeze({text.printed({**exact, **raws})});"
        yield f"const values = Object.freeze({text.printed({**exact, **values})});"
        yield f"return new MessageResult(this, node, p, frame, raw, values{code});"

    def _check(self, step: CheckConstant | CheckChecksum | CheckParameter, length: int) -> Lines:
        field, function = step.field, "checkConstant"
        match step:
            case CheckConstant():
                wanted: str = text.integer(step.raw, field.type.width)
            case CheckChecksum():
                wanted, function = self._checksum(step.checksum, length), "checkChecksum"
            case CheckParameter():
                wanted = _required(field, step.parameter)
            case _:
                assert_never(step)
        for element in field.elements:
            yield f"{function}({_element(field, element.segments, length)}, {wanted}, {text.quoted(field.name)});"

    def _checksum(self, plan: ChecksumPlan, length: int) -> str:
        """The expression of the checksum of a frame."""
        definition = text.printed(checksum_table(plan))
        name = self.checksums.setdefault(definition, f"CHECKSUM_{len(self.checksums) + 1}")
        inputs = (
            str(part) if isinstance(part, int) else bits.read(part.space, part.segments, 8, length)
            for part in plan.inputs
        )
        return f"{name}([{', '.join(inputs)}])"

    def _value(self, field: Field) -> str:
        """The expression of the value of a field."""
        raw, own = f"raw.{field.name}", f"TYPES[{self._types[field.type]}]"
        each = "element" if field.is_array else raw
        scaled = "" if field.type.joined else _scaled(field.type, each)
        if scaled == each:
            return raw
        if field.is_array:
            return f"Object.freeze({raw}.map((element) => {scaled}))" if scaled else f"{own}.valueOfAll({raw}, p)"
        return scaled or f"{own}.value({raw}, p)"

    def _encoding(self, message: Message, steps: Sequence[EncodingStep], present: Collection[Field]) -> Lines:
        """The statements of steps, of which those of fields that are not present are left out."""
        frame = _Written(message)
        names: list[Value] = []
        after: list[str] = []
        for number, step in enumerate(steps):
            match step:
                case CheckAvailable() | CheckCode() | CheckNode() | NeedParameter():
                    yield from _precondition(message, step)
                case ChooseFields():
                    yield from _choice(message, steps[number + 1 :], self._encoding)
                    return
                case CheckField():
                    names += [step.field.name] if step.field in present else []
                case WriteCode() | WriteFixed() | WriteParameter() | WriteField():
                    if step.field is None or step.field in present:
                        frame.write(step)
                case WriteChecksum() | CheckMeaning():
                    after += self._ending(step, message.length)
                case _:
                    assert_never(step)
        yield f"{'const raw = ' if names else ''}given.raws({text.printed(names)});"
        yield from frame.constants
        if not after:
            yield f"return {frame.expression};"
            return
        yield f"const frame = {frame.expression};"
        yield f"const {PARTS} = frame;"
        yield from after
        yield "return frame;"

    def _ending(self, step: WriteChecksum | CheckMeaning, length: int) -> Lines:
        """What is done with the frame of all fields."""
        match step:
            case WriteChecksum():
                yield f"const checksum = {self._checksum(step.checksum, length)};"
                for s in step.field.elements[0].segments:
                    yield f"d[{s.byte}] |= {bits.written('checksum', step.field.type.width, s)};"
            case CheckMeaning():
                yield f"if ({' && '.join(_has(*condition, length) for condition in step.confusion.conditions)}) {{"
                yield f"  throw wrongMessage(this, {text.quoted(step.confusion.command)}, frame);"
                yield "}"
            case _:
                assert_never(step)


def _precondition(message: Message, step: CheckAvailable | CheckCode | CheckNode | NeedParameter) -> Lines:
    match step:
        case CheckAvailable():
            for name, values in step.only.items():
                yield f"given.checkAvailable({text.quoted(name)}, {text.printed(values)});"
        case CheckCode():
            codes = [_code(value, message.keys[0].width) for value in step.values]
            yield f"{'const code = ' if len(codes) > 1 else ''}given.codeOf({text.printed(codes)});"
        case CheckNode():
            yield f"given.checkNode({step.nodes[0]}, {step.nodes[-1]});"
        case NeedParameter():
            yield f"given.checkParameter({text.quoted(step.parameter)});"
        case _:
            assert_never(step)


class _Written:
    """The frame that an encoder writes; `constants` are the statements of what it writes beside fixed bits and fields."""

    def __init__(self, message: Message) -> None:
        plan = message_plan(message)
        self.constants: list[str] = []
        self._codes = plan.codes
        self._code = message.keys[0].value if message.keys else 0
        self._bytes: list[list[str]] = [[] for _ in range(message.length)]
        self._id: list[str] = []
        self._fixed = {Space.DATA: 0, Space.ID: 0}

    def write(self, step: WriteCode | WriteFixed | WriteParameter | WriteField) -> None:
        match step:
            case WriteCode():
                if self._codes:
                    self._write(step.key.space, step.key.segments, "code", step.key.width)
                else:
                    self._fixed[step.key.space] |= placed(step.key.segments, self._code)
            case WriteFixed():
                self._fixed[step.space] |= placed(step.segments, step.raw)
            case WriteParameter():
                name = f"constant{len(self.constants) + 1}"
                self.constants.append(f"const {name} = {_required(step.field, step.parameter)};")
                for element in step.field.elements:
                    self._write(step.field.space, element.segments, name, step.field.type.width)
            case WriteField():
                for i, element in enumerate(step.field.elements):
                    raw = f"raw.{step.field.name}" + (f"[{i}]" if step.field.is_array else "")
                    self._write(step.field.space, element.segments, raw, step.field.type.width)
            case _:
                assert_never(step)

    @property
    def expression(self) -> str:
        """The frame; all bits without a field are 0."""
        data = self._fixed[Space.DATA].to_bytes(len(self._bytes), "little")
        each = [Code(_combined(*pair)) for pair in zip(data, self._bytes, strict=True)]
        return f"given.frame({_combined(self._fixed[Space.ID], self._id)}, {text.printed(each)})"

    def _write(self, space: Space, segments: Iterable[Segment], raw: str, width: int) -> None:
        """Write the bits of an expression."""
        for s in segments:
            terms = self._id if space is Space.ID else self._bytes[s.byte]
            terms.append(bits.written(raw, width, s))


def _combined(fixed: int, terms: Sequence[str]) -> str:
    shown = [f"0x{fixed:02X}"] if fixed else []
    return " | ".join([*shown, *terms]) or "0"


def _leading(message: Message) -> Sequence[CheckConstant | CheckChecksum]:
    """The first checks, which no parameter decides on."""
    steps: list[CheckConstant | CheckChecksum] = []
    for step in message_plan(message).decoding:
        if not isinstance(step, (CheckConstant, CheckChecksum)):
            break
        steps.append(step)
    return steps


def _choice(
    message: Message, steps: Sequence[Step], statements: Callable[[Message, Sequence[Step], Collection[Field]], Lines]
) -> Lines:
    """The statements of the steps that follow for each variant of the fields, and for a missing parameter."""
    yield f"switch (p.{message.layout.parameter}) {{"
    for variant in message.layout.variants:
        *first, last = map(text.quoted, variant.values)
        yield from (f"  case {value}:" for value in first)
        yield f"  case {last}: {{"
        yield from _indented(statements(message, steps, variant.fields))
        yield "  }"
    yield "}"
    yield "throw this.undetermined();"


def _indented(lines: Iterable[str]) -> Lines:
    return (f"    {line}" for statement in lines for line in statement.split("\n"))


def _raw(field: Field, length: int) -> str:
    """The expression of the raw integer of a field, or of those of its elements."""
    reads = [_element(field, element.segments, length) for element in field.elements]
    return f"Object.freeze([{', '.join(reads)}])" if field.is_array else reads[0]


def _element(field: Field, segments: Sequence[Segment], length: int) -> str:
    is_signed = field.type.encoding is Encoding.SIGNED
    return bits.read(field.space, segments, field.type.width, length, is_signed)


def _required(field: Field, parameter: str) -> str:
    """The expression of the raw integer of a constant that is a parameter."""
    value = f"required(p, {text.quoted(parameter)}, {text.quoted(field.name)})"
    return f"BigInt({value})" if field.type.width > 53 else value


def _scaled(type_: Type, raw: str) -> str:
    """The value of a number in doubles, rounded once; empty if that takes more, or depends on a parameter."""
    linear = type_.linear.constant
    is_float = type_.encoding is Encoding.FLOAT
    if not type_.is_number or is_float or type_.no_values or linear is None or linear.times is not None:
        return ""
    if linear.is_identity:
        return raw
    factor, addend, divisor = linear.as_quotient
    largest = max(map(abs, type_.raw_limits)) * abs(factor) + abs(addend)
    if type_.width > 53 or max(largest, divisor) > text.EXACT:
        return ""
    dividend = raw if abs(factor) == 1 else f"{raw} * {abs(factor)}"
    if factor < 0:
        dividend = f"{addend} - {dividend}"
    elif addend:
        dividend += f" {'+' if addend > 0 else '-'} {abs(addend)}"
    if divisor == 1:
        return dividend
    return f"({dividend}) / {divisor}" if factor < 0 or addend else f"{dividend} / {divisor}"
