"""The example of a command: a program that encodes its request and decodes its reply."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, Value
from ...model.layout import Field
from ...model.message import Direction, Message
from ..base import WorkedExchange
from .examples import initializers
from .names import Names, member
from .numbers import integer
from .types import TypeView
from .view import DirectionView, EditionView, FrameView, edition_view


class CallView(NamedTuple):
    """A call that returns a status."""

    function: str
    arguments: tuple[str, ...]


class SentView(NamedTuple):
    """A request; `struct` is empty if it has no fields, `initializers` are those of raw integers without a unit."""

    struct: str
    initializers: tuple[str, ...]
    calls: tuple[CallView, ...]
    print: CallView
    text: str


class ReceivedView(NamedTuple):
    """A reply with the initializer of its frame; `struct` is empty if it has no fields."""

    struct: str
    has_node: bool
    id: str
    length: int
    data: tuple[str, ...]
    calls: tuple[CallView, ...]
    print: CallView
    text: str


class CommandExampleView(NamedTuple):
    e: EditionView
    parameters: tuple[str, ...]
    request: SentView | None
    reply: ReceivedView | None

    @property
    def uses_parameters(self) -> bool:
        calls = [call for side in (self.request, self.reply) if side for call in (*side.calls, side.print)]
        return any("&parameters" in call.arguments for call in calls)

    @property
    def uses_floats(self) -> bool:
        return self.request is not None and len(self.request.calls) > 1


class _Edition(NamedTuple):
    """What the examples of an edition have in common."""

    view: EditionView
    names: Names
    types: Mapping[str, TypeView]
    frames: Mapping[str, FrameView]
    directions: Mapping[str, DirectionView]


@functools.lru_cache(maxsize=4)
def _edition(edition: Edition) -> _Edition:
    view = edition_view(edition)
    return _Edition(
        view,
        Names(edition),
        {t.name: t for t in view.types},
        {f.name: f for command in view.commands for f in command.frames},
        {d.word: d for d in view.directions},
    )


def command_example(edition: Edition, worked: WorkedExchange) -> CommandExampleView:
    """The example with these golden frames."""
    of, command = _edition(edition), worked.command
    asked, answer = worked.request, worked.reply
    return CommandExampleView(
        e=of.view,
        parameters=tuple(initializers(edition, of.names, formatting.parameter_values(worked.parameters))),
        request=_sent(of, command.request, asked, formatting.parameter_values(worked.parameters))
        if command.request and asked
        else None,
        reply=_received(of, command.reply, answer, worked.is_answered) if command.reply and answer else None,
    )


def _print(of: _Edition, direction: Direction, frame: str) -> CallView:
    shows = of.directions[direction.value].show_parameters
    arguments = ("text", "sizeof text", frame, "&parameters" if shows else "")
    return CallView(f"{of.view.prefix}print_{direction.value}", arguments)


def _sent(of: _Edition, message: Message, golden: GoldenFrame, parameters: Mapping[str, str]) -> SentView:
    variant, frame = message.layout.variant(parameters), of.frames[of.names.lower(message.name)]
    fields = [f for f in variant.fields if f.role.is_value] if variant else []
    listed: list[str] = []
    calls: list[CallView] = []
    for field in fields:
        raw, value = golden.raw.get(field.name, 0), golden.values.get(field.name)
        converted = list(_conversions(of, field, value))
        calls += converted
        if not converted:
            literals = [_literal(of, field, one) for one in (raw if isinstance(raw, list) else [raw])]
            listed.append(
                f".{member(field.name)} = " + (f"{{{', '.join(literals)}}}" if field.is_array else literals[0])
            )
    encode = CallView(
        f"{frame.name}_encode",
        (
            "&frame",
            f"{golden.node}u" if frame.message.pattern.rule.has_nodes else "",
            "&request" if frame.struct else "",
            "&parameters" if frame.takes_parameters else "",
        ),
    )
    printed = _print(of, Direction.REQUEST, "&frame")
    return SentView(frame.struct, tuple(listed), (*calls, encode), printed, formatting.sent(golden))


def _literal(of: _Edition, field: Field, raw: int) -> str:
    name = next((m.name for m in field.type.enum if m.value == raw), None)
    if name is not None:
        return of.names.upper(of.names.type_stem(field.type), name)
    return integer(field.type).bits(raw) if field.type.flags else integer(field.type).literal(raw)


def _conversions(of: _Edition, field: Field, value: Value | None) -> Iterator[CallView]:
    """The call that converts a value; one for each element of an array."""
    view = of.types[of.names.lower(of.names.type_stem(field.type))]
    values = value if isinstance(value, list) else [value]
    if field.type.is_plain or view.double is None or not all(isinstance(one, Fraction) for one in values):
        return
    parameters = "&parameters" if view.double.from_parameters else ""
    for i, one in enumerate(values):
        where = f"&request.{member(field.name)}" + (f"[{i}]" if field.is_array else "")
        yield CallView(f"{view.name}_from_double", (where, repr(float(Fraction(one or 0))), parameters))


def _received(of: _Edition, message: Message, golden: GoldenFrame, is_answered: bool) -> ReceivedView:
    frame = of.frames[of.names.lower(message.name)]
    marks = ["CANWRIGHT_EXTENDED"] * golden.extended + ["CANWRIGHT_REMOTE"] * golden.remote
    has_node = frame.message.has_node
    decode = CallView(
        f"{frame.name}_decode",
        (
            "&reply" if frame.struct else "",
            "&node" if has_node else "",
            "&received",
            "&parameters" if frame.layout.depends else "",
        ),
    )
    check = CallView(f"{of.view.prefix}check_reply", ("&frame", "&received"))
    return ReceivedView(
        frame.struct,
        has_node,
        " | ".join([f"0x{golden.id:X}u", *marks]),
        message.dlc if golden.remote else len(golden.data),
        tuple(f"0x{byte:02X}u" for byte in golden.data),
        (check, decode) if is_answered else (decode,),
        _print(of, Direction.REPLY, "&received"),
        formatting.sent(golden),
    )
