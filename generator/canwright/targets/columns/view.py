"""The module of an edition, as its template needs it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.exhaustive import assert_never
from ...model.joined import JoinedText
from ...model.layout import Field, Layout
from ...model.message import BitRun, Direction, KeyRole, Message
from ...model.types import Encoding, Linear, Type
from ...semantics import dispatch
from ...semantics.plan import (
    CheckChecksum,
    CheckConstant,
    CheckParameter,
    ChooseFields,
    ReadField,
    message_plan,
)
from ..base import header
from ..python_source import english, literal, member_name, tuple_of
from ..tables import Positions
from .bits import FrameReads

FRAME_COLUMNS = ("time", "bus", "node", "direction", "command", "code")
"""The columns that every table has."""


class Columns(NamedTuple):
    """The columns of a field: its value, and its raw integers."""

    value: str
    raw: str


def columns_of(layout: Layout, frame_columns: Iterable[str] = FRAME_COLUMNS) -> Mapping[Field, Columns]:
    """The columns of each field. A name that is taken has `_` appended: those of the frame come first, then values."""
    taken = set(frame_columns)
    fields = layout.given
    values = [free_name(field.name, taken) for field in fields]
    raws = [free_name(f"{field.name}_raw", taken) for field in fields]
    return {field: Columns(*names) for field, *names in zip(fields, values, raws, strict=True)}


def tables_of(edition: Edition) -> Mapping[Layout, str]:
    """The name of the table of each layout."""
    taken: set[str] = set()
    return {m: free_name(m.name, taken) for m in dict.fromkeys(message.layout for message in edition.all_messages())}


def free_name(name: str, taken: set[str]) -> str:
    """A name with as many `_` appended as it takes to differ from all others."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


class ModuleView:
    """What the template prints."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition
        self.header = header(edition)
        self.title = english(edition.title)
        self.tables = tables_of(edition)
        self.reads = FrameReads.of(edition)
        self.routes = {d.value: dispatch.dispatch_plan(edition, d).routes for d in Direction}
        self._positions = Positions(edition)
        self._codes = {command.name: command.code for command in edition.commands}

    @property
    def messages(self) -> Iterator[tuple[Message, str, int, str]]:
        """The messages, each with its code, the position of its layout, and the expression of the node in its data."""
        for message in self._positions.messages:
            code, node = self._code(message), message.node_in_data
            shown = "-1" if code is None else f"0x{code:02X}"
            yield message, shown, self._positions.layouts[message.layout], self.reads.key(node) if node else ""

    def _code(self, message: Message) -> int | None:
        """The code on the wire; that of the command for a message without one."""
        keys = (key.value for key in message.keys if key.role is KeyRole.CODE)
        return next(keys, self._codes[message.command])

    def facts(self, message: Message) -> str:
        """The arguments about when a message is sent, and about its frames; empty if nothing is stated."""
        of, sequence = message.sending, message.sequence
        frames = f", frames=({literal(sequence.field)}, {sequence.numbers})" if sequence else ""
        if of is None:
            return frames
        times = {"every_ms": of.every_ms, "timeout_ms": of.timeout_ms}
        stated = [f"sent={tuple_of(literal(o.value) for o in of.occasions)}"] if of.occasions else []
        stated += [f"{name}={float(time)}" for name, time in times.items() if time is not None]
        return "".join(f", {argument}" for argument in stated) + frames

    def constants(self, layout: Layout) -> Iterator[CheckConstant | CheckParameter]:
        """The constants of a layout, which a reader checks."""
        for step in message_plan(self.edition.of_layout(layout)[0]).decoding:
            match step:
                case CheckConstant() | CheckParameter():
                    yield step
                case CheckChecksum() | ChooseFields() | ReadField():
                    pass  # `checksum`, and the fields with what selects them
                case _:
                    assert_never(step)

    def checksum(self, layout: Layout) -> Sequence[str]:
        """The arguments of the `Checksum` of a layout; none without one."""
        step = message_plan(self.edition.of_layout(layout)[0]).checksum
        if step is None:
            return ()
        plan = step.checksum
        inputs = (f"0x{part:02X}" if isinstance(part, int) else self.reads.byte(part) for part in plan.inputs)
        numbers = {"poly": plan.poly, "init": plan.init, "xor_out": plan.xor_out}
        return (
            f"lambda words, ids: {self.reads.field(step.field)}",
            f"lambda words, ids: {tuple_of(inputs)}",
            literal(plan.arithmetic.value),
            str(plan.width),
            *(f"{name}=0x{number:X}" for name, number in numbers.items() if number),
            *["reflected=True"] * plan.is_reflected,
            *[f"shift={plan.shift}"] * bool(plan.shift),
        )

    def leaf(self, node: dispatch.DispatchNode) -> str:
        """The position of a message, or a refusal; empty for a decision."""
        if isinstance(node, dispatch.Match):
            return str(self._positions.messages[node.message])
        return f"Refusal.{node.reason.name}" if isinstance(node, dispatch.Reject) else ""

    def subject(self, subject: dispatch.Discriminator) -> str:
        """The expression of what a decision depends on."""
        if isinstance(subject, dispatch.Length):
            return "lengths"
        return f"ids & 0x{subject.mask:X}" if isinstance(subject, dispatch.MaskedId) else self.reads.key(subject)


def case_value(value: int, subject: dispatch.Discriminator) -> str:
    """The value of a decision."""
    return f"0x{value:02X}" if isinstance(subject, BitRun) else str(value)


def constant_name(type_: Type) -> str:
    """The name of a type in the module; no other name there begins like it."""
    return f"_{member_name(type_.name)}"


def arguments(type_: Type) -> Sequence[str]:
    """The arguments of a `Type`."""
    linear = type_.linear
    if type_.is_plain or not type_.is_number:
        scale = "scale=PLAIN"
    else:
        scale = "scale={" + ", ".join(f"{literal(name)}: {_scale(case)}" for name, case in linear.named) + "}"
    listed = [scale]
    if type_.unit:
        listed.append(f"unit={literal(type_.unit.symbol)}")
    if linear.parameter and type_.is_number:
        listed.append(f"scale_by={literal(linear.parameter)}")
    if type_.encoding is Encoding.FLOAT:
        listed.append("is_float=True")
    if type_.enum or type_.flags:
        listed.append("is_flags=True" if type_.flags else "is_enum=True")
    if isinstance(type_.joined, JoinedText):
        listed.append(f"text=({literal(type_.joined.codec)}, {type_.joined.padding})")
    elif type_.joined is not None:
        listed.append("is_digits=True")
    members = type_.enum or type_.flags or type_.names
    if members:
        listed.append("names={" + ", ".join(f"{m.value}: {literal(m.name)}" for m in members) + "}")
    if type_.no_values:
        names = (f"{literal(n.name)}: ({n.raws[0]}, {n.raws[-1]})" for n in type_.no_values)
        listed.append("no_values={" + ", ".join(names) + "}")
    return listed


def _scale(linear: Linear | None) -> str:
    if linear is None:
        return "None"
    times = f", {literal(linear.times)}" if linear.times else ""
    return f"Scale({', '.join(map(str, linear.as_quotient))}{times})"


def fraction(number: Fraction | None) -> str:
    """An expression of a limit."""
    if number is None:
        return "None"
    return f"Fraction({number.numerator}, {number.denominator})"


def kinds(route: dispatch.Route) -> str:
    """The expression of the kind of frame of a route."""
    flags = ["Kind.EXTENDED"] * route.rule.extended + ["Kind.REMOTE"] * route.remote
    return " | ".join(flags)


def literals(texts: Iterable[str]) -> str:
    """The expression of a tuple of texts."""
    return tuple_of(map(literal, texts))
