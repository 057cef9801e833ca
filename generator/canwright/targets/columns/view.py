"""The module of an edition, as its template needs it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, Union

from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import BitRun, Direction, KeyRole, Message
from ...model.types import Encoding, Linear, Type
from ...semantics import dispatch
from ..base import header
from ..python_source import english, literal, member_name, tuple_of
from .bits import FrameReads

FRAME_COLUMNS = ("time", "bus", "node", "direction", "command", "code")
"""The columns that every table has."""


@dataclass(frozen=True, kw_only=True)
class SelectView:
    """A decision: the expression of its subject."""

    read: str
    cases: tuple[tuple[tuple[str, ...], NodeView], ...]
    otherwise: NodeView


NodeView = Union[str, SelectView]  # noqa: UP007 - `NodeView` in `SelectView` is a forward reference


class Columns(NamedTuple):
    """The columns of a field: its value, and its raw integers."""

    value: str
    raw: str


def columns_of(layout: Layout) -> Mapping[Field, Columns]:
    """The columns of each field. A name that is taken has `_` appended: those of the frame come first, then values."""
    taken = set(FRAME_COLUMNS)
    fields = varying(layout)
    values = [_free(field.name, taken) for field in fields]
    raws = [_free(f"{field.name}_raw", taken) for field in fields]
    return {field: Columns(*names) for field, *names in zip(fields, values, raws, strict=True)}


def tables_of(edition: Edition) -> Mapping[Layout, str]:
    """The name of the table of each layout."""
    taken: set[str] = set()
    return {m: _free(m.name, taken) for m in dict.fromkeys(message.layout for message in edition.all_messages())}


def _free(name: str, taken: set[str]) -> str:
    """A name with as many `_` appended as it takes to differ from all others."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def module_view(edition: Edition) -> Mapping[str, object]:
    """What the template prints."""
    messages = list(edition.all_messages())
    tables = tables_of(edition)
    layouts = list(tables)
    numbers = {message: number for number, message in enumerate(messages)}
    codes = {command.name: command.code for command in edition.commands}
    reads = FrameReads.of(edition)
    return {
        "header": header(edition),
        "edition": edition,
        "title": english(edition.title),
        "parameters": edition.parameters,
        "types": edition.types,
        "reads": reads,
        "tables": tables,
        "messages": [
            (m, code_of(m, codes), layouts.index(m.layout), reads.key(m.node_in_data) if m.node_in_data else "")
            for m in messages
        ],
        "routes": {direction.value: route_views(edition, direction, numbers, reads) for direction in Direction},
    }


def code_of(message: Message, codes: Mapping[str, int | None]) -> int:
    """The code on the wire; that of the command for a message without one, and -1 if that has none."""
    own = next((key.value for key in message.keys if key.role is KeyRole.CODE), codes[message.command])
    return -1 if own is None else own


def constant_name(type_: Type) -> str:
    """The name of a type in the module; no other name there begins like it."""
    return f"_{member_name(type_.name)}"


def arguments(type_: Type) -> Sequence[str]:
    """The arguments of a `Type`."""
    linear = type_.linear
    if type_.is_plain or not type_.is_number:
        scale = "scale=PLAIN"
    else:
        cases = linear.cases.items() if linear.parameter else [("", linear.constant)]
        scale = "scale={" + ", ".join(f"{literal(name)}: {_scale(case)}" for name, case in cases) + "}"
    found = [scale]
    if type_.unit:
        found.append(f"unit={literal(type_.unit.symbol)}")
    if linear.parameter and type_.is_number:
        found.append(f"scale_by={literal(linear.parameter)}")
    if type_.encoding is Encoding.FLOAT:
        found.append("is_float=True")
    if type_.flags:
        found.append("is_flags=True")
    members = type_.enum or type_.flags
    if members:
        found.append("names={" + ", ".join(f"{m.value}: {literal(m.name)}" for m in members) + "}")
    return found


def _scale(linear: Linear | None) -> str:
    if linear is None:
        return "None"
    times = f", {literal(linear.times)}" if linear.times else ""
    return f"Scale({', '.join(map(str, linear.as_quotient))}{times})"


def varying(layout: Layout) -> Sequence[Field]:
    """The fields that have columns."""
    return [field for field in layout.fields if field.role.is_value]


def demanded(layout: Layout) -> Sequence[Field]:
    """The constants."""
    return [field for field in layout.fields if field.role.is_checked]


def fraction(number: Fraction | None) -> str:
    """An expression of a limit."""
    if number is None:
        return "None"
    return f"Fraction({number.numerator}, {number.denominator})"


def route_views(
    edition: Edition, direction: Direction, numbers: Mapping[Message, int], reads: FrameReads
) -> Sequence[tuple[dispatch.Route, NodeView]]:
    """The routes of one direction in the order in which they are tried, each with its tree."""
    routes = dispatch.dispatch_plan(edition, direction).routes
    return [(route, _node(route.then, numbers, reads)) for route in routes]


def _node(node: dispatch.DispatchNode, numbers: Mapping[Message, int], reads: FrameReads) -> NodeView:
    if isinstance(node, dispatch.Match):
        return str(numbers[node.message])
    if isinstance(node, dispatch.Reject):
        return f"Refusal.{node.reason.name}"
    form = "0x{:02X}" if isinstance(node.subject, BitRun) else "{}"
    cases = ((tuple(form.format(v) for v in case.values), _node(case.then, numbers, reads)) for case in node.cases)
    return SelectView(
        read=_subject(node.subject, reads), cases=tuple(cases), otherwise=_node(node.otherwise, numbers, reads)
    )


def _subject(subject: dispatch.Discriminator, reads: FrameReads) -> str:
    if isinstance(subject, dispatch.Length):
        return "lengths"
    if isinstance(subject, dispatch.MaskedId):
        return f"ids & 0x{subject.mask:X}"
    return reads.key(subject)


def kinds(route: dispatch.Route) -> str:
    """The expression of the kind of frame of a route."""
    found = ["Kind.EXTENDED"] * route.rule.extended + ["Kind.REMOTE"] * route.remote
    return " | ".join(found)


def literals(texts: Iterable[str]) -> str:
    """The expression of a tuple of texts."""
    return tuple_of(map(literal, texts))
