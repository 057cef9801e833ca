"""Layouts as structs with the functions that check, pack and unpack them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from ...model.edition import Edition
from ...model.exhaustive import assert_never
from ...model.formatting import english
from ...model.golden_frames import RawValue
from ...model.layout import Field, Layout, Variant
from ...model.message import Message
from ...model.types import Encoding, Type
from ...semantics.plan import (
    CheckChecksum,
    CheckConstant,
    CheckField,
    CheckParameter,
    ChooseFields,
    DecodingStep,
    EncodingStep,
    ReadField,
    message_plan,
)
from . import bits
from .checksums import ChecksumView
from .choices import Branch, parameter_access, whole
from .expressions import Integer, braces, integer, joined, operand, raw_of, stored_literal, working
from .names import Names, member
from .text import errata, field_facts, heading, literal, with_deprecation
from .types import TypeView
from .validity import is_nan

T = TypeVar("T")
Types = Mapping[Type, TypeView]
"""The types that fields use."""


class Place(NamedTuple):
    """A member, or an element of one, and its bytes in the struct.

    They are those with integers aligned to their size, and as negative numbers those without padding.
    """

    name: str
    bytes: frozenset[int]


class MemberView(NamedTuple):
    kind: str
    name: str
    doc: str


@dataclass(frozen=True, kw_only=True)
class Body(Generic[T]):
    """Steps of all variants of a layout, before or after those of each case of a `switch` over `subject`."""

    before: tuple[T, ...]
    subject: str | None
    cases: tuple[Branch[tuple[T, ...]], ...]
    after: tuple[T, ...]

    @property
    def steps(self) -> list[T]:
        return [*self.before, *(step for case in self.cases for step in case.value), *self.after]


class FieldCheck(NamedTuple):
    """A condition under which a field is rejected, and the status; checked for each of the `elements` of an array."""

    field: str
    condition: str
    status: str
    elements: int
    uses_parameters: bool


class FieldRead(NamedTuple):
    """The value of a member; for a constant field, the condition under which the frame is rejected."""

    member: str = ""
    value: str = ""
    constant_differs: str = ""


class FieldShow(NamedTuple):
    """The string literal before the value of a field, and the call that prints it."""

    label: str
    call: str
    uses_parameters: bool


class LayoutView:
    """A struct and its functions. Without members there is no struct, without fields there are no functions."""

    def __init__(self, names: Names, edition: Edition, layout: Layout, types: Types) -> None:
        messages = edition.of_layout(layout)
        plan = message_plan(messages[0])
        shared = {byte for message in messages for byte in bits.key_bytes(message.keys)}
        members = {f.name: member(f.name) for f in layout.fields}
        facts = errata(edition, layout.path) if layout.shared else []
        stored = [f for f in layout.fields if f.is_given]
        self.name = names.lower(layout.name)
        self.title = heading(layout)
        self.doc = [text for text in (english(layout.about), *facts) if text]
        self.code = code_member(messages)
        """The member with the code; None unless a message of the layout can have several."""
        self.members = [_member(edition, layout, f, types[f.type]) for f in stored]
        self.members += [self.code.member] if self.code else []
        self.has_values = bool(stored)
        """True if there are members besides the code."""
        self.places = list(_places(stored, self.code))
        self.has_fields = bool(layout.fields)
        self.chooses = layout.parameter is not None
        """True if a parameter decides which fields exist."""
        parametric = {
            step.field: whole(edition, step.parameter) for step in plan.decoding if isinstance(step, CheckParameter)
        }
        self.constants = [(known, f"{bits.constant_read(f)} != {known.value}") for f, known in parametric.items()]
        """The constants that are parameters, each with the condition for a frame with another value."""
        self.depends = self.chooses or bool(parametric)
        """True if packing and unpacking need the parameters; they return a status then."""
        values = {f.name: known.value for f, known in parametric.items()}
        self.check = _ordered_body(names, layout, lambda variant: _checks(names, plan.encoding, variant, types))
        self.pack = _body(names, layout, lambda variant: bits.write_fields(variant.fields, members, shared, values))
        self.counters = [
            (names.lower(layout.name, f.name), f.name, integer(f.type), f.counter) for f in stored if f.counter
        ]
        """The name of the functions of each counter, its field, its C type, and the ends of its range."""
        self.checksum = ChecksumView(names, plan.checksum) if plan.checksum else None
        self.unpack = _body(names, layout, lambda variant: _reads(plan.decoding, variant))
        self.show = _ordered_body(names, layout, lambda variant: _shows(variant, types))
        self.show_parameters = self.chooses or any(step.uses_parameters for step in self.show.steps)
        self.has_check = self.has_values and (bool(self.check.steps) or self.chooses)
        self.check_parameters = self.chooses or any(check.uses_parameters for check in self.check.steps)
        self.has_arrays = any(check.elements for check in self.check.steps)
        self.takes_parameters = self.depends or self.check_parameters
        """True if checking and packing a message needs the parameters."""


class CodeMember(NamedTuple):
    """The member with the code of a message that can have several: 0 for the usual one.

    A code of 0 that is not the usual one is the bit above the largest code.
    """

    member: MemberView
    kind: Integer

    def stored(self, message: Message, code: int | None) -> str:
        """The literal of the member for a code of a message; None is the usual one."""
        number = 1 << message.keys[0].width if code == 0 and message.keys[0].value else code or 0
        return f"0x{number:02X}u" if number else "0u"

    def choice(self, message: Message) -> CodeChoice | None:
        """How a message uses it; None if it has one code at most."""
        codes = message_plan(message).codes
        if not codes:
            return None
        key, number = message.keys[0], working(message.keys[0].width + 1)
        read, zero = operand(bits.key_value(key)), 1 << key.width
        given = "UINT64_C(0x{:X})".format if number.width > 32 else "0x{:02X}u".format
        further = [given(code or zero) for code in codes[1:]]
        can_be_0 = 0 in codes[1:]
        return CodeChoice(
            read=f"({self.kind.name})({read} | ({read} == 0u ? {given(zero)} : 0u))"
            if can_be_0
            else f"({self.kind.name}){read}",
            kind=number.name,
            value=f"message->{FRAME_CODE} != 0u ? ({number.name})message->{FRAME_CODE} : {given(codes[0])}",
            refused=joined("&&", [f"code != {literal}" for literal in (given(codes[0]), *further)]),
            sent=f"({working(key.width).name})(code & {given(zero - 1)})" if can_be_0 else "code",
        )


class CodeChoice(NamedTuple):
    """The expression that reads the member from a frame; of a variable `code`, its type, its value, the condition under
    which it is refused, and the expression of the code that is sent."""

    read: str
    kind: str
    value: str
    refused: str
    sent: str


FRAME_CODE = "frame_code"
"""The name of the member with the code, which no field has."""


def code_member(messages: Iterable[Message]) -> CodeMember | None:
    """The member with the code of messages of one layout; None if each has one code at most."""
    several = {message: message_plan(message).codes for message in messages if message_plan(message).codes}
    if not several:
        return None
    needed = max(message.keys[0].width + (0 in codes[1:]) for message, codes in several.items())
    kind = Integer(next(width for width in (8, 16, 32, 64) if width >= needed), signed=False)
    facts = [
        f"{m.direction.value} of {m.command}: {' or '.join(_code_text(m, c) for c in codes)}"
        for m, codes in several.items()
    ]
    doc = f"The code, as it came or as it is to be sent; 0 is the usual one. {'; '.join(facts)}."
    return CodeMember(MemberView(kind.name, FRAME_CODE, doc), kind)


def _code_text(message: Message, code: int) -> str:
    """A code; with the number that stands for it, if that differs."""
    is_other_0 = code == 0 and message.keys[0].value != 0
    return f"0x{code:02X} (as 0x{1 << message.keys[0].width:X})" if is_other_0 else f"0x{code:02X}"


def _member(edition: Edition, layout: Layout, field: Field, type_: TypeView) -> MemberView:
    length = f"[{len(field.elements)}]" if field.is_array else ""
    low_bits = any(message.has_low_bits_of_node for message in edition.of_layout(layout))
    facts = field_facts(field, layout.parameter, type_.use, type_.facts, low_bits=low_bits)
    doc = with_deprecation(facts, field.deprecated)
    return MemberView(type_.kind, member(field.name) + length, doc)


def numbers(field: Field) -> list[str]:
    """The numbers that a member has: itself, or each element of an array."""
    name = member(field.name)
    return [f"{name}[{number}]" for number in range(len(field.elements))] if field.is_array else [name]


def _places(fields: Iterable[Field], code: CodeMember | None) -> Iterator[Place]:
    end = packed = 0
    stored = [(raw_of(f.type, number), integer(f.type).width // 8) for f in fields for number in numbers(f)]
    for name, size in (*stored, *([(FRAME_CODE, code.kind.width // 8)] if code else [])):
        start = -(-end // size) * size
        end, packed = start + size, packed - size
        yield Place(name, frozenset((*range(start, end), *range(packed, packed + size))))


def _body(names: Names, layout: Layout, steps: Callable[[Variant], Iterable[T]]) -> Body[T]:
    """The steps of all variants; shared steps are executed first."""
    variants = [tuple(steps(variant)) for variant in layout.variants]
    if layout.parameter is None:
        return Body(before=variants[0], subject=None, cases=(), after=())
    shared = tuple(step for step in variants[0] if all(step in steps_ for steps_ in variants))
    rest = [tuple(step for step in every if step not in shared) for every in variants]
    return Body(before=shared, subject=parameter_access(layout.parameter), cases=_cases(names, layout, rest), after=())


def _ordered_body(names: Names, layout: Layout, steps: Callable[[Variant], Iterable[T]]) -> Body[T]:
    """The steps of all variants in their order, after the decision whether the parameter is known."""
    if layout.parameter is None:
        return _body(names, layout, steps)
    variants = [tuple(steps(variant)) for variant in layout.variants]
    last = itertools.takewhile(lambda same: len(set(same)) == 1, zip(*map(reversed, variants), strict=False))
    after = tuple(same[0] for same in last)[::-1]
    rest = [every[: len(every) - len(after)] for every in variants]
    return Body(before=(), subject=parameter_access(layout.parameter), cases=_cases(names, layout, rest), after=after)


def _cases(names: Names, layout: Layout, steps: Iterable[tuple[T, ...]]) -> tuple[Branch[tuple[T, ...]], ...]:
    labels = (tuple(names.upper(layout.parameter or "", value) for value in v.values) for v in layout.variants)
    return tuple(Branch(values, body) for values, body in zip(labels, steps, strict=True))


def _reads(steps: Sequence[DecodingStep], variant: Variant) -> Iterator[FieldRead]:
    for step in steps:
        match step:
            case CheckConstant():
                if step.field.only and step.field in variant.fields:
                    yield FieldRead(constant_differs=bits.constant_differs(step))
            case ReadField():
                for number, element in zip(numbers(step.field), step.field.elements, strict=True):
                    value = bits.read_field(step.field, element.segments) if step.field in variant.fields else "0"
                    yield FieldRead(member=raw_of(step.field.type, number), value=value)
            case CheckChecksum() | ChooseFields() | CheckParameter():
                pass  # `checksum`, `chooses` and `constants` of the layout
            case _:
                assert_never(step)


def _shows(variant: Variant, types: Types) -> Iterator[FieldShow]:
    for field in variant.fields:
        if not field.is_given:
            continue
        type_ = types[field.type]
        given = type_.show.formulas.uses_parameters
        if type_.joined is not None:
            call = f"{type_.name}_write(printer, message->{member(field.name)});"
            yield FieldShow(literal(f" {field.name}="), call, given)
            continue
        for number, element in enumerate(field.elements):
            index, place = (f"[{element.index}]", f"[{number}]") if field.is_array else ("", "")
            raw = f"message->{member(field.name)}{place}"
            call = f"{type_.name}_write(printer, {raw}{', parameters' if given else ''});"
            yield FieldShow(literal(f" {field.name}{index}="), call, given)


def _checks(names: Names, steps: Sequence[EncodingStep], variant: Variant, types: Types) -> Iterator[FieldCheck]:
    """One check for each field and reason. A field that a variant lacks must be 0, since it is not sent."""
    for field in (step.field for step in steps if isinstance(step, CheckField)):
        item = f"message->{member(field.name)}" + ("[i]" if field.is_array else "")
        raw = raw_of(field.type, item)
        if field not in variant.fields:
            yield _check(names, field, f"{raw} != 0", "OUT_OF_RANGE")
            continue
        if field.type.encoding is Encoding.FLOAT:
            refused = [f"!canwright_is_finite{field.type.width}({raw})"]
            refused += [f"!({is_nan(field.type, item)})"] if field.type.no_values else []
            yield _check(names, field, joined("&&", refused), "NOT_FINITE")
        type_ = types[field.type]
        if type_.valid is not None:
            known = type_.valid.uses_parameters
            call = f"{type_.name}_valid({item}{', parameters' if known else ''})"
            yield _check(names, field, f"!{call}", "OUT_OF_RANGE", uses_parameters=known)


def _check(names: Names, field: Field, condition: str, status: str, *, uses_parameters: bool = False) -> FieldCheck:
    elements = len(field.elements) if field.is_array else 0
    return FieldCheck(names.upper("field", field.name), condition, status, elements, uses_parameters)


def literals(field: Field, raw: RawValue) -> dict[str, str]:
    """The literal of each number that a member has; a single raw integer is that of all elements."""
    raws = raw if isinstance(raw, list) else [raw] * len(field.elements)
    return dict(zip(numbers(field), (stored_literal(field.type, raw) for raw in raws), strict=True))


def initializer(field: Field, texts: Iterable[str]) -> str:
    """The initializer of a member with these literals."""
    return braces(*texts) if field.is_array else ", ".join(texts)
