"""Layouts as structs with the functions that check, pack and unpack them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field, Layout, Variant
from ...model.types import Encoding
from . import bits
from .choices import Branch, Choice
from .facts import errata, field_facts
from .names import Names, member
from .text import english
from .values import TypeView

Types = Mapping[str, TypeView]
"""The types that fields use, by their name in C."""


class MemberView(NamedTuple):
    kind: str
    name: str
    doc: str


class Body(NamedTuple):
    """Statements that always run, then those that the layout's parameter decides."""

    lines: tuple[str, ...]
    choice: Choice | None


class LayoutView(NamedTuple):
    """A struct and its functions. Without members there is no struct, without fields there are no functions.

    Where a parameter decides which fields there are, `depends` is true, and packing and unpacking return a status.
    """

    name: str
    title: str
    doc: tuple[str, ...]
    members: tuple[MemberView, ...]
    has_fields: bool
    depends: bool
    check: Body | None
    check_parameters: bool
    check_index: bool
    pack: Body
    unpack: Body

    @property
    def takes_parameters(self) -> bool:
        """True when a message cannot be checked and packed without the parameters."""
        return self.depends or self.check_parameters


def layout_view(names: Names, edition: Edition, layout: Layout, types: Types) -> LayoutView:
    shared = {byte for message in edition.of_layout(layout) for byte in bits.key_bytes(message.keys)}
    check = _check(names, layout, types)
    facts = errata(edition, layout.path) if layout.shared else []
    return LayoutView(
        names.lower(layout.name),
        english(layout.title) + (f" ({layout.manual})" if layout.manual else ""),
        tuple(text for text in (english(layout.about), *facts) if text),
        tuple(_member(names, layout, f, types) for f in layout.fields if f.fixed is None),
        bool(layout.fields),
        layout.parameter is not None,
        check,
        check is not None and _mentions(check, "parameters->", ", parameters)"),
        check is not None and _mentions(check, "[i]"),
        _by_variant(names, layout, lambda variant: _packed(layout, variant, shared)),
        _by_variant(names, layout, lambda variant: list(_unpacked(layout, variant))),
    )


def _member(names: Names, layout: Layout, field: Field, types: Types) -> MemberView:
    type_ = types[names.lower(field.type.name)]
    length = f"[{len(field.elements)}]" if field.is_array else ""
    return MemberView(type_.kind, member(field.name) + length, field_facts(field, layout.parameter, type_.facts))


def _by_variant(names: Names, layout: Layout, lines: Callable[[Variant], list[str]]) -> Body:
    """What every variant has comes first, and a choice has the rest."""
    made = [lines(variant) for variant in layout.variants]
    if layout.parameter is None:
        return Body(tuple(made[0]), None)
    always = [line for line in made[0] if all(line in other for other in made)]
    branches = tuple(
        Branch(
            tuple(names.upper(layout.parameter, value) for value in variant.values),
            (*(line for line in every if line not in always), "break;"),
        )
        for variant, every in zip(layout.variants, made, strict=True)
    )
    subject = f"parameters->{member(layout.parameter)}"
    return Body(tuple(always), Choice(subject, branches, ("return CANWRIGHT_MISSING_PARAMETER;",)))


def _packed(layout: Layout, variant: Variant, shared: set[int]) -> list[str]:
    members = {f.name: member(f.name) for f in layout.fields}
    lines = [f"frame->id |= {term};" for term in bits.write_id(variant.fields, members)]
    return lines + list(bits.write_bytes(variant.fields, members, shared))


def _unpacked(layout: Layout, variant: Variant) -> Iterator[str]:
    for field in layout.fields:
        if field.demanded is not None and field.only and field in variant.fields:
            other = " || ".join(c.replace(" == ", " != ") for c in bits.constant_holds(field))
            yield f"if ({other}) {{\n    return CANWRIGHT_WRONG_CONSTANT;\n}}"
        elif field.fixed is None:
            for number, element in enumerate(field.elements):
                raw = bits.read_field(field, element.segments) if field in variant.fields else "0"
                yield f"message->{member(field.name)}{f'[{number}]' if field.is_array else ''} = {raw};"


def _check(names: Names, layout: Layout, types: Types) -> Body | None:
    body = _by_variant(names, layout, lambda variant: list(_checked(names, layout, variant, types)))
    return body if body.lines or body.choice else None


def _checked(names: Names, layout: Layout, variant: Variant, types: Types) -> Iterator[str]:
    """One statement a field and reason. A field that is not there must be 0, or it would be lost without a word."""
    for field in layout.fields:
        if field.fixed is not None:
            continue
        item = f"message->{member(field.name)}" + ("[i]" if field.is_array else "")
        if field not in variant.fields:
            yield _refusal(names, field, f"{item} != 0", "OUT_OF_RANGE")
            continue
        if field.type.encoding is Encoding.FLOAT:
            yield _refusal(names, field, f"!canwright_is_finite{field.type.width}({item})", "NOT_FINITE")
        type_ = types[names.lower(field.type.name)]
        if type_.valid is not None:
            arguments = f"{item}, parameters" if type_.valid.uses_parameters else item
            yield _refusal(names, field, f"!{type_.name}_valid({arguments})", "OUT_OF_RANGE")


def _refusal(names: Names, field: Field, condition: str, status: str) -> str:
    lines = [
        f"if ({condition}) {{",
        f"    *field = {names.upper('field', field.name)};",
        f"    return CANWRIGHT_{status};",
        "}",
    ]
    if field.is_array:
        count = len(field.elements)
        lines = [f"for (i = 0u; i < {count}u; i++) {{", *(f"    {line}" for line in lines), "}"]
    return "\n".join(lines)


def _mentions(body: Body, *texts: str) -> bool:
    lines: list[str] = list(body.lines)
    if body.choice:
        lines += [body.choice.subject or "", *(line for branch in body.choice.branches for line in branch.lines)]
    return any(text in line for line in lines for text in texts)


def fields_named(layouts: Sequence[Layout]) -> list[str]:
    """The names of all fields that are members of some struct, in order, each once."""
    return list(dict.fromkeys(f.name for layout in layouts for f in layout.fields if f.fixed is None))
