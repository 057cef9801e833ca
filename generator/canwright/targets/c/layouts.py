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
from ...model.layout import Field, Layout, Space, Variant
from ...model.message import Message
from ...model.types import Type
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
from .choices import Branch, Whole, parameter_access
from .expressions import Integer, braces, integer, joined, operand, raw_of, smallest, stored_literal, working
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


@dataclass(frozen=True)
class Body(Generic[T]):
    """Steps of all variants of a layout, before or after those of each case of a `switch` over `subject`."""

    before: Sequence[T]
    subject: str | None = None
    cases: Sequence[Branch[Sequence[T]]] = ()
    after: Sequence[T] = ()

    @property
    def steps(self) -> list[T]:
        return [*self.before, *(step for case in self.cases for step in case.value), *self.after]


class FieldCheck(NamedTuple):
    """A condition under which a field is rejected, and the status; checked for each of the `elements` of an array."""

    field: str
    condition: str
    status: str
    elements: int
    uses_parameters: bool = False


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
        shared = {s.byte for m in messages for key in m.keys if key.space is Space.DATA for s in key.segments}
        facts = errata(edition, layout.path) if layout.shared else []
        stored = layout.given
        self.name = names.lower(layout.name)
        self.title = heading(layout)
        self.doc = [text for text in (english(layout.about), *facts) if text]
        several = [message for message in messages if message_plan(message).codes]
        self.code = CodeMember(several) if several else None
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
            step.field: Whole(edition, step.parameter) for step in plan.decoding if isinstance(step, CheckParameter)
        }
        self.constants = [(known, f"{bits.constant_read(f)} != {known.value}") for f, known in parametric.items()]
        """The constants that are parameters, each with the condition for a frame with another value."""
        self.depends = self.chooses or bool(parametric)
        """True if packing and unpacking need the parameters; they return a status then."""
        values = {f: known.value for f, known in parametric.items()}
        self.check = _body(names, layout, lambda variant: _checks(names, plan.encoding, variant, types), in_order=True)
        self.pack = _body(
            names, layout, lambda variant: bits.write_fields(plan.encoding, variant.fields, shared, values)
        )
        self.counters = [
            (names.lower(layout.name, f.name), f.name, integer(f.type), f.counter) for f in stored if f.counter
        ]
        """The name of the functions of each counter, its field, its C type, and the ends of its range."""
        self.checksum = ChecksumView(names, plan.checksum) if plan.checksum else None
        self.unpack = _body(names, layout, lambda variant: _reads(plan.decoding, variant))
        self.show = _body(names, layout, lambda variant: _shows(variant, types), in_order=True)
        self.show_parameters = self.chooses or any(step.uses_parameters for step in self.show.steps)
        self.has_check = self.has_values and (bool(self.check.steps) or self.chooses)
        self.check_parameters = self.chooses or any(check.uses_parameters for check in self.check.steps)
        self.has_arrays = any(check.elements for check in self.check.steps)
        self.takes_parameters = self.depends or self.check_parameters
        """True if checking and packing a message needs the parameters."""


FRAME_CODE = "frame_code"
"""The name of the member with the code, which no field has."""


class CodeMember:
    """The member with the code of messages of one layout that can have several: 0 for the usual one.

    A code of 0 that is not the usual one is the bit above the largest code.
    """

    def __init__(self, messages: Sequence[Message]) -> None:
        several = {message: message_plan(message).codes for message in messages}
        needed = max(message.keys[0].width + (0 in codes[1:]) for message, codes in several.items())
        self.kind = smallest(needed, False)
        facts = (
            f"{m.direction.value} of {m.command}: {' or '.join(_code_text(m, c) for c in codes)}"
            for m, codes in several.items()
        )
        doc = f"The code, as it came or as it is to be sent; 0 is the usual one. {'; '.join(facts)}."
        self.member = MemberView(self.kind.name, FRAME_CODE, doc)

    def stored(self, message: Message, code: int | None) -> str:
        """The literal of the member for a code of a message; None is the usual one."""
        number = 1 << message.keys[0].width if code == 0 and message.keys[0].value else code or 0
        return f"0x{number:02X}u" if number else "0u"


class CodeChoice:
    """How a message with several codes uses the member."""

    def __init__(self, message: Message, stored: Integer) -> None:
        key, number, codes = message.keys[0], working(message.keys[0].width + 1), message_plan(message).codes
        read, zero = operand(bits.key_value(key)), 1 << key.width
        given = "UINT64_C(0x{:X})".format if number.width > 32 else "0x{:02X}u".format
        every = [given(codes[0]), *(given(code or zero) for code in codes[1:])]
        can_be_0 = 0 in codes[1:]
        self.read = f"({stored.name})" + (f"({read} | ({read} == 0u ? {given(zero)} : 0u))" if can_be_0 else read)
        """The value of the member in a frame."""
        self.kind = number.name
        """The type of the variable `code`."""
        self.value = f"message->{FRAME_CODE} != 0u ? ({number.name})message->{FRAME_CODE} : {every[0]}"
        self.refused = joined("&&", [f"code != {literal}" for literal in every])
        """The condition under which it is rejected."""
        self.sent = f"({working(key.width).name})(code & {given(zero - 1)})" if can_be_0 else "code"
        """The code that is sent."""


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


def _body(names: Names, layout: Layout, steps: Callable[[Variant], Iterable[T]], *, in_order: bool = False) -> Body[T]:
    """The steps of all variants; shared steps are executed first.

    Steps that stay `in_order` follow the decision whether the parameter is known; shared ones at the end are executed last.
    """
    variants = [tuple(steps(variant)) for variant in layout.variants]
    if layout.parameter is None:
        return Body(variants[0])
    before: tuple[T, ...] = ()
    after: tuple[T, ...] = ()
    if in_order:
        last = itertools.takewhile(lambda same: len(set(same)) == 1, zip(*map(reversed, variants), strict=False))
        after = tuple(same[0] for same in last)[::-1]
        variants = [every[: len(every) - len(after)] for every in variants]
    else:
        before = tuple(step for step in variants[0] if all(step in every for every in variants))
        variants = [tuple(step for step in every if step not in before) for every in variants]
    labels = (tuple(names.upper(layout.parameter, value) for value in v.values) for v in layout.variants)
    return Body(before, parameter_access(layout.parameter), list(map(Branch, labels, variants)), after)


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
                pass  # `checks` of the message, `chooses` and `constants` of the layout
            case _:
                assert_never(step)


def _shows(variant: Variant, types: Types) -> Iterator[FieldShow]:
    for field in variant.given:
        type_ = types[field.type]
        given = type_.show.formulas.uses_parameters
        is_one = type_.joined is not None or not field.is_array
        places = enumerate(element.index for element in field.elements)
        for index, place in [("", "")] if is_one else [(f"[{index}]", f"[{number}]") for number, index in places]:
            raw = f"message->{member(field.name)}{place}"
            call = f"{type_.name}_write(printer, {raw}{', parameters' if given else ''});"
            yield FieldShow(literal(f" {field.name}{index}="), call, given)


def _checks(names: Names, steps: Sequence[EncodingStep], variant: Variant, types: Types) -> Iterator[FieldCheck]:
    """One check for each field and reason. A field that a variant lacks must be 0, since it is not sent."""
    for field in (step.field for step in steps if isinstance(step, CheckField)):
        item, elements = (
            (f"{member(field.name)}[i]", len(field.elements)) if field.is_array else (member(field.name), 0)
        )
        name, item, type_ = names.upper("field", field.name), f"message->{item}", types[field.type]
        raw = raw_of(field.type, item)
        if field not in variant.fields:
            yield FieldCheck(name, f"{raw} != 0", "OUT_OF_RANGE", elements)
            continue
        if type_.is_float:
            refused = [f"!canwright_is_finite{field.type.width}({raw})"]
            refused += [f"!({is_nan(field.type, item)})"] if field.type.no_values else []
            yield FieldCheck(name, joined("&&", refused), "NOT_FINITE", elements)
        if type_.valid is not None:
            call = f"{type_.name}_valid({item}{', parameters' if type_.valid.uses_parameters else ''})"
            yield FieldCheck(name, f"!{call}", "OUT_OF_RANGE", elements, type_.valid.uses_parameters)


def literals(field: Field, raw: RawValue) -> dict[str, str]:
    """The literal of each number that a member has; a single raw integer is that of all elements."""
    raws = raw if isinstance(raw, list) else [raw] * len(field.elements)
    return dict(zip(numbers(field), (stored_literal(field.type, raw) for raw in raws), strict=True))


def initializer(field: Field, texts: Iterable[str]) -> str:
    """The initializer of a member with these literals."""
    return braces(*texts) if field.is_array else ", ".join(texts)
