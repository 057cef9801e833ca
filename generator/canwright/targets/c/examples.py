"""Examples: a host and a node that exchange the golden frames of a few commands, and a program for one command."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, RawValue
from ...model.layout import Field
from ...model.message import Command, Message
from ...model.types import Assignment
from ...semantics.exchange import is_read
from ..base import EditionInput, WorkedExchange
from ..examples import Examples
from .choices import parameter_literal
from .expressions import braces, call, integer, raw_of, stored_literal
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


class SideView:
    """One direction of a command: the raw integers to send, and how received fields are printed."""

    def __init__(self, view: EditionView, message: Message, golden: GoldenFrame, known: Assignment) -> None:
        numbers = [(field, literals(field, golden.raw.get(field.name, 0))) for field in _fields(message, known)]
        self.message = view.message(message)
        self.initializers = [f".{member(f.name)} = {initializer(f, texts.values())}" for f, texts in numbers]
        self.assignments = [f".{number} = {text}" for _, texts in numbers for number, text in texts.items()]
        """The same raw integers for languages without designated initializers."""
        self.shown = [
            ShownView(f.name + index, number, raw_of(f.type, number), f"value_{place}{f.name}", view.of_type[f.type])
            for f, texts in numbers
            for i, number in enumerate(texts)
            for index, place in ([(f"[{i}]", f"{i}_")] if f.is_array else [("", "")])
        ]


class ExchangeView(NamedTuple):
    node: int
    request: SideView
    reply: SideView


class ExampleView:
    """The example of an edition: the first commands with different replies, with golden frames if any."""

    def __init__(self, specification: EditionInput, view: EditionView) -> None:
        edition, examples = specification.edition, Examples(specification.edition, specification.frames)
        known = examples.usual_parameters
        commands = list(_commands(edition, known))
        golden = (
            next((e for e in examples.answered(command) if e.parameters.items() <= known.items()), None)
            for command in commands
        )
        worked = list(filter(None, golden)) or list(filter(None, map(examples.simplest, commands)))
        reads = [exchange for exchange in worked if is_read(edition, exchange.command)]
        reads.sort(key=lambda exchange: exchange.command.entry is not None)  # those of measured values first
        self.file = f"{edition.family}_{edition.identifier}"
        self.parameters = _parameters(view, edition, known)
        self.exchanges = list(itertools.islice(_exchanges(view, worked, known), COMMANDS))
        self.on_bus = next(iter((*_exchanges(view, reads, known), *self.exchanges)), None)
        """The exchange that programs for a bus show: one without effects, if there is one."""
        rates = [mode.default_kbps or mode.bit_rates_kbps[0] for mode in edition.bus.modes]
        self.bit_rate_kbps = next(iter(rates), None)
        """A bit rate of the bus; None if the spec states none."""
        rate = self.bit_rate_kbps or 500
        self.twai_timing = f"{rate}KBITS" if rate in (25, 50, 100, 125, 250, 500, 800) else "1MBITS" * (rate == 1000)
        """What the bit rate is called in the driver of the ESP32's controller; empty if it does not have it."""
        self.types = [field.type_ for exchange in self.exchanges for field in exchange.reply.shown]
        """The types of printed fields."""
        sides = (side for exchange in self.exchanges for side in (exchange.request, exchange.reply))
        self.uses_parameters = any(side.message.takes_parameters for side in sides) or any(
            type_.double.to_parameters for type_ in self.types if type_.double is not None
        )


def _commands(edition: Edition, known: Assignment) -> Iterator[Command]:
    """The commands with fields in a reply of their own from the addressed node."""
    for command in (command for command in edition.commands if command.available(known) and not command.from_each):
        if command.reply and command.reply.command == command.name and command.reply.layout.fields:
            yield command


def _exchanges(view: EditionView, worked: Iterable[WorkedExchange], known: Assignment) -> Iterator[ExchangeView]:
    """The exchanges with different replies."""
    layouts: set[str] = set()
    for command, request, reply, _, _ in worked:
        asked, answer = command.request, command.reply
        if asked and answer and request and reply and answer.layout.name not in layouts:
            layouts.add(answer.layout.name)
            sides = SideView(view, asked, request, known), SideView(view, answer, reply, known)
            yield ExchangeView(request.node or 0, *sides)


def _fields(message: Message, known: Assignment) -> Sequence[Field]:
    variant = message.layout.variant(known)
    return variant.given if variant else ()


def _parameters(view: EditionView, edition: Edition, known: Assignment) -> list[str]:
    """The initializers of the known parameters."""
    return [
        f".{member(parameter.name)} = {parameter_literal(view.names, parameter, known[parameter.name])}"
        for parameter in edition.parameters
        if parameter.name in known
    ]


class CommandExample:
    """A program that encodes a request, decodes a reply, or both; the other is None.

    Calls return a status, except for those that print.
    """

    def __init__(self, edition: Edition, worked: WorkedExchange) -> None:
        command, request, reply, known, is_answered = worked
        self.e = e = edition_view(edition)
        self.parameters = _parameters(e, edition, known)
        self.request: MessageView | None = None
        self.reply: MessageView | None = None
        self.print_request = self.print_reply = ""
        self.initializers: list[str] = []
        """Those of the request's raw integers without a unit."""
        self.request_calls: list[str] = []
        self.reply_calls: list[str] = []
        if command.request and request:
            self.request, self.request_text = e.message(command.request), formatting.sent(request)
            for field in _fields(command.request, known):
                calls = list(_conversions(e, field, request))
                self.request_calls += calls
                self.initializers += [] if calls else [_named_initializer(e, field, request.raw.get(field.name, 0))]
            self.request_calls.append(self.request.encode("&frame", f"{request.node}u", "&request", "&parameters"))
            self.print_request = e.directions[0].print(e, "&frame")
        if command.reply and reply:
            self.reply, self.reply_text = e.message(command.reply), formatting.sent(reply)
            self.received = list(_received(self.reply, reply))
            """The initializers of its frame."""
            asked = "&frame", "&received", "&parameters" if e.check_reply_parameters else ""
            self.reply_calls += [call(f"{e.prefix}check_reply", *asked)] if is_answered else []
            self.reply_calls.append(self.reply.decode("&reply", "&node", "&received", "&parameters"))
            self.print_reply = e.directions[1].print(e, "&received")
        self.calls = self.request_calls + self.reply_calls
        self.uses_parameters = any(
            "&parameters" in text for text in (*self.calls, self.print_request, self.print_reply)
        )
        self.uses_floats = len(self.request_calls) > 1


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
        yield f".data = {braces(*(f'0x{byte:02X}u' for byte in golden.data))}"
