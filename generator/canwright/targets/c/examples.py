"""Examples: a host and a node that exchange the golden frames of a few commands, and a program for one command."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, RawValue
from ...model.layout import Field
from ...model.message import Command, Direction, Message
from ...model.types import Assignment
from ...semantics.exchange import is_read
from ...semantics.plan import value_fields
from ..base import EditionInput, WorkedExchange
from ..examples import Examples
from .choices import parameter_literal
from .expressions import call, integer, raw_of, stored_literal
from .layouts import initializer, literals
from .messages import MessageView
from .names import member
from .types import TypeView
from .view import EditionView, edition_view

COMMANDS = 4


class ShownView(NamedTuple):
    """A field or an element of an array, and how it is printed: as name or value of `type_`, else as bits.

    `raw` is the integer in the member.
    """

    label: str
    member: str
    raw: str
    variable: str
    type_: TypeView


class SideView(NamedTuple):
    """One direction of a command: the raw integers to send, and how received fields are printed.

    `assignments` are the same raw integers for languages without designated initializers.
    """

    message: MessageView
    initializers: tuple[str, ...]
    assignments: tuple[str, ...]
    shown: tuple[ShownView, ...]


class ExchangeView(NamedTuple):
    node: int
    request: SideView
    reply: SideView


class ExampleView(NamedTuple):
    file: str
    parameters: tuple[str, ...]
    exchanges: tuple[ExchangeView, ...]
    on_bus: ExchangeView | None
    """The exchange that programs for a bus show: one without effects, if there is one."""
    bit_rate_kbps: int | None
    """A bit rate of the bus; None if the spec states none."""

    @property
    def twai_timing(self) -> str:
        """What the bit rate is called in the driver of the ESP32's controller; empty if it does not have it."""
        rate = self.bit_rate_kbps or 500
        return f"{rate}KBITS" if rate in (25, 50, 100, 125, 250, 500, 800) else "1MBITS" * (rate == 1000)

    @property
    def uses_parameters(self) -> bool:
        frames = [side.message for exchange in self.exchanges for side in (exchange.request, exchange.reply)]
        values = [t.double for t in self.types if t.double is not None]
        return any(f.takes_parameters for f in frames) or any(v.to_parameters for v in values)

    @property
    def types(self) -> list[TypeView]:
        """The types of printed fields."""
        return [field.type_ for exchange in self.exchanges for field in exchange.reply.shown]


class CommandExampleView(NamedTuple):
    """A program that encodes a request, decodes a reply, or both; the other is None.

    `initializers` are those of the request's raw integers without a unit, `received` are those of the frame of the reply.
    Calls return a status, except for those that print.
    """

    e: EditionView
    parameters: tuple[str, ...]
    request: MessageView | None
    reply: MessageView | None
    initializers: tuple[str, ...]
    received: tuple[str, ...]
    request_calls: tuple[str, ...]
    reply_calls: tuple[str, ...]
    print_request: str
    print_reply: str
    request_text: str
    reply_text: str

    @property
    def calls(self) -> tuple[str, ...]:
        return self.request_calls + self.reply_calls

    @property
    def uses_parameters(self) -> bool:
        return any("&parameters" in text for text in (*self.calls, self.print_request, self.print_reply))

    @property
    def uses_floats(self) -> bool:
        return len(self.request_calls) > 1


def example(specification: EditionInput, view: EditionView) -> ExampleView:
    """The example of an edition: the first commands with different replies, with golden frames if any."""
    edition, examples = specification.edition, Examples(specification.edition, specification.frames)
    known = examples.usual_parameters
    commands = list(_commands(edition, known))
    golden = (
        next((e for e in examples.answered(command) if e.parameters.items() <= known.items()), None)
        for command in commands
    )
    worked = list(filter(None, golden)) or list(filter(None, map(examples.simplest, commands)))
    exchanges = tuple(itertools.islice(_exchanges(view, worked, known), COMMANDS))
    reads = [exchange for exchange in worked if is_read(edition, exchange.command)]
    reads.sort(key=lambda exchange: exchange.command.entry is not None)  # those of measured values first
    rates = [mode.default_kbps or mode.bit_rates_kbps[0] for mode in edition.bus.modes]
    return ExampleView(
        f"{edition.family}_{edition.identifier}",
        tuple(_parameters(view, edition, known)),
        exchanges,
        next(iter((*_exchanges(view, reads, known), *exchanges)), None),
        next(iter(rates), None),
    )


def _commands(edition: Edition, known: Assignment) -> Iterator[Command]:
    """The commands with fields in a reply of their own from the addressed node."""
    for command in edition.commands:
        reply = command.reply
        if reply is None or reply.command != command.name or not reply.layout.fields or command.from_each:
            continue
        if command.available(known):
            yield command


def _exchanges(view: EditionView, worked: Iterable[WorkedExchange], known: Assignment) -> Iterator[ExchangeView]:
    """The exchanges with different replies."""
    layouts: set[str] = set()
    for command, request, reply, _, _ in worked:
        asked, answer = command.request, command.reply
        if asked and answer and request and reply and answer.layout.name not in layouts:
            layouts.add(answer.layout.name)
            yield ExchangeView(
                node=request.node or 0,
                request=_side(view, asked, request, known),
                reply=_side(view, answer, reply, known),
            )


def _side(view: EditionView, message: Message, golden: GoldenFrame, known: Assignment) -> SideView:
    numbers = [(field, literals(field, golden.raw.get(field.name, 0))) for field in _fields(message, known)]
    return SideView(
        message=view.message(message),
        initializers=tuple(f".{member(f.name)} = {initializer(f, texts.values())}" for f, texts in numbers),
        assignments=tuple(f".{number} = {text}" for _, texts in numbers for number, text in texts.items()),
        shown=tuple(
            ShownView(label, number, raw_of(field.type, number), f"value_{place}{field.name}", view.of_type[field.type])
            for field, texts in numbers
            for label, number, place in _labels(field, texts)
        ),
    )


def _labels(field: Field, numbers: Iterable[str]) -> Iterator[tuple[str, str, str]]:
    """The label of each number that a member has, the number, and a part of the name of a variable."""
    for i, number in enumerate(numbers):
        yield (f"{field.name}[{i}]", number, f"{i}_") if field.is_array else (field.name, number, "")


def _fields(message: Message, known: Assignment) -> list[Field]:
    variant = message.layout.variant(known)
    return list(value_fields(variant.fields if variant else ()).values())


def _parameters(view: EditionView, edition: Edition, known: Assignment) -> Iterator[str]:
    """The initializers of the known parameters."""
    for parameter in edition.parameters:
        if parameter.name in known:
            yield f".{member(parameter.name)} = {parameter_literal(view.names, parameter, known[parameter.name])}"


def command_example(edition: Edition, worked: WorkedExchange) -> CommandExampleView:
    """The program for a command with these golden frames."""
    command, request, reply, known, is_answered = worked
    e = edition_view(edition)
    asked = e.message(command.request) if command.request and request else None
    answer = e.message(command.reply) if command.reply and reply else None
    initializers, request_calls, reply_calls = [], [], []
    if asked and request and command.request:
        for field in _fields(command.request, known):
            calls = list(_conversions(e, field, request))
            request_calls += calls
            initializers += [] if calls else [_named_initializer(e, field, request.raw.get(field.name, 0))]
        request_calls.append(asked.encode("&frame", f"{request.node}u", "&request", "&parameters"))
    if answer and reply:
        reply_calls = (
            [call(f"{e.prefix}check_reply", "&frame", "&received", "&parameters" if e.check_reply_parameters else "")]
            if is_answered
            else []
        )
        reply_calls.append(answer.decode("&reply", "&node", "&received", "&parameters"))
    return CommandExampleView(
        e=e,
        parameters=tuple(_parameters(e, edition, known)),
        request=asked,
        reply=answer,
        initializers=tuple(initializers),
        received=tuple(_received(answer, reply)) if answer and reply else (),
        request_calls=tuple(request_calls),
        reply_calls=tuple(reply_calls),
        print_request=e.direction(Direction.REQUEST).print(e, "&frame") if asked else "",
        print_reply=e.direction(Direction.REPLY).print(e, "&received") if answer else "",
        request_text=formatting.sent(request) if request else "",
        reply_text=formatting.sent(reply) if reply else "",
    )


def _named_initializer(e: EditionView, field: Field, raw: RawValue) -> str:
    """The initializer of raw integers, with the names of an enum, and flags in hexadecimal."""
    stem = e.names.type_stem(field.type)
    names = {m.value: e.names.upper(stem, m.name) for m in reversed(field.type.enum)}

    def written(number: int) -> str:
        return integer(field.type).bits(number) if field.type.flags else stored_literal(field.type, number)

    texts = (names.get(number) or written(number) for number in (raw if isinstance(raw, list) else [raw]))
    return f".{member(field.name)} = {initializer(field, texts)}"


def _conversions(e: EditionView, field: Field, golden: GoldenFrame) -> Iterator[str]:
    """The call that converts a value; one for each element of an array."""
    view, value = e.of_type[field.type], golden.values.get(field.name)
    numbers = [number for number in (value if isinstance(value, list) else [value]) if isinstance(number, Fraction)]
    if field.type.is_plain or view.double is None:
        return
    for i, number in enumerate(numbers):
        where = f"&request.{member(field.name)}" + (f"[{i}]" if field.is_array else "")
        parameters = "&parameters" if view.double.from_parameters else ""
        yield call(f"{view.name}_from_double", where, repr(float(number)), parameters)


def _received(message: MessageView, golden: GoldenFrame) -> Iterator[str]:
    marks = ["CANWRIGHT_EXTENDED"] * golden.extended + ["CANWRIGHT_REMOTE"] * golden.remote
    yield f".id = {' | '.join([f'0x{golden.id:X}u', *marks])}"
    yield f".dlc = {message.dlc if golden.remote else len(golden.data)}u"
    if golden.data:
        yield f".data = {{{', '.join(f'0x{byte:02X}u' for byte in golden.data)}}}"
