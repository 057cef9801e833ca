"""The example of an edition: a host and a node in one program, with the golden frames of a few commands."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Field
from ...model.message import Command, Message
from ...model.types import Assignment
from ..base import EditionInput, WorkedExchange
from ..examples import Examples
from .names import Names, member
from .numbers import integer
from .types import TypeView
from .view import EditionView, FrameView

COMMANDS = 4
Raw = Mapping[str, int | list[int]]


class ShownView(NamedTuple):
    """A field or an element of an array, and how it is printed: as name or value of `type_`, else as bits."""

    label: str
    member: str
    variable: str
    type_: TypeView


class SideView(NamedTuple):
    """One direction of a command: the values to send, and how received fields are printed.

    `values` are designated initializers, `assignments` are the same values for languages without them.
    """

    frame: FrameView
    values: tuple[str, ...]
    assignments: tuple[str, ...]
    shown: tuple[ShownView, ...]


class ExchangeView(NamedTuple):
    command: str
    enumerator: str
    node: int
    request: SideView
    reply: SideView


class ExampleView(NamedTuple):
    file: str
    parameters: tuple[str, ...]
    exchanges: tuple[ExchangeView, ...]

    @property
    def shows_names(self) -> bool:
        return any(t.is_enum for t in self._shown)

    @property
    def shows_values(self) -> bool:
        return any(t.double for t in self._shown)

    @property
    def shows_bits(self) -> bool:
        return any(not t.double and not t.is_enum for t in self._shown)

    @property
    def uses_parameters(self) -> bool:
        frames = [frame for one in self.exchanges for frame in (one.request.frame, one.reply.frame)]
        values = [t.double for t in self._shown if t.double is not None]
        return any(f.takes_parameters for f in frames) or any(v.to_parameters for v in values)

    @property
    def _shown(self) -> list[TypeView]:
        return [s.type_ for one in self.exchanges for s in one.reply.shown]


def example(specification: EditionInput, view: EditionView) -> ExampleView:
    """The example of an edition: the first commands with different replies, with golden frames if any."""
    return _Example(specification, view).view()


class _Example:
    def __init__(self, specification: EditionInput, view: EditionView) -> None:
        self._edition = specification.edition
        self._view = view
        self._names = Names(specification.edition)
        self._examples = Examples(specification.edition, specification.frames)
        self._known = self._examples.usual_parameters
        self._types = {t.name: t for t in view.types}
        self._frames = {f.name: f for command in view.commands for f in command.frames}

    def view(self) -> ExampleView:
        exchanges = list(self._exchanges(self._golden())) or list(self._exchanges(self._simplest()))
        file = f"{self._edition.family}_{self._edition.identifier}"
        return ExampleView(file, tuple(initializers(self._edition, self._names, self._known)), tuple(exchanges))

    def _exchanges(self, worked: Iterable[WorkedExchange]) -> Iterator[ExchangeView]:
        """The first exchanges with different replies."""
        layouts: set[str] = set()
        for exchange in worked:
            command, request, reply = exchange.command, exchange.command.request, exchange.command.reply
            if request is None or reply is None or len(layouts) == COMMANDS or reply.layout.name in layouts:
                continue
            layouts.add(reply.layout.name)
            yield ExchangeView(
                command=command.name,
                enumerator=self._names.command(command.name),
                node=(exchange.request and exchange.request.node) or 0,
                request=self._side(request, exchange.request.raw if exchange.request else {}),
                reply=self._side(reply, exchange.reply.raw if exchange.reply else {}),
            )

    def _golden(self) -> Iterator[WorkedExchange]:
        """Golden exchanges with the known parameters."""
        for command in self._commands():
            of_node = (e for e in self._examples.answered(command) if e.parameters.items() <= self._known.items())
            yield from itertools.islice(of_node, 1)

    def _simplest(self) -> Iterator[WorkedExchange]:
        """Exchanges without golden frames."""
        return filter(None, map(self._examples.simplest, self._commands()))

    def _commands(self) -> Iterator[Command]:
        """The commands with fields in a reply of their own from the addressed node."""
        for command in self._edition.commands:
            reply = command.reply
            if reply is None or reply.command != command.name or not reply.layout.fields or command.from_each:
                continue
            if command.available(self._known):
                yield command

    def _side(self, message: Message, raw: Raw) -> SideView:
        variant = message.layout.variant(self._known)
        fields = [f for f in variant.fields if f.role.is_value] if variant else []
        values = [f".{member(f.name)} = {_initializer(f, raw.get(f.name, 0))}" for f in fields]
        return SideView(
            frame=self._frames[self._names.lower(message.name)],
            values=tuple(values),
            assignments=tuple(text for f in fields for text in _assignments(f, raw.get(f.name, 0))),
            shown=tuple(self._shown(fields)),
        )

    def _shown(self, fields: list[Field]) -> Iterator[ShownView]:
        for field in fields:
            type_ = self._types[self._names.lower(self._names.type_stem(field.type))]
            if not field.is_array:
                yield ShownView(field.name, member(field.name), f"value_{field.name}", type_)
                continue
            for i in range(len(field.elements)):
                yield ShownView(f"{field.name}[{i}]", f"{member(field.name)}[{i}]", f"value_{i}_{field.name}", type_)


def initializers(edition: Edition, names: Names, known: Assignment) -> Iterator[str]:
    """The initializers of the known parameters."""
    for parameter in edition.parameters:
        value = known.get(parameter.name)
        if value is not None and parameter.is_choice:
            yield f".{member(parameter.name)} = {names.upper(parameter.name, str(value))}"
        elif value is not None:
            number = Fraction(value)
            yield f".{member(parameter.name)} = {{{number.numerator}, {number.denominator}u}}"


def _initializer(field: Field, raw: int | list[int]) -> str:
    kind = integer(field.type)
    if isinstance(raw, list):
        return "{" + ", ".join(kind.literal(number) for number in raw) + "}"
    return kind.literal(raw)


def _assignments(field: Field, raw: int | list[int]) -> Iterator[str]:
    kind = integer(field.type)
    if isinstance(raw, list):
        yield from (f".{member(field.name)}[{i}] = {kind.literal(number)}" for i, number in enumerate(raw))
    else:
        yield f".{member(field.name)} = {kind.literal(raw)}"
