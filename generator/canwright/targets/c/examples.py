"""The example of an edition: a host and a node in one program, with the golden frames of a few commands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame
from ...model.layout import Field
from ...model.message import Command, Direction, Message
from ...model.types import Encoding, Type
from ..base import EditionInput
from .names import Names, member
from .numbers import integer
from .types import TypeView
from .validity import constant_limits
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
        self._golden = specification.frames
        self._known = self._parameters()
        self._types = {t.name: t for t in view.types}
        self._frames = {f.name: f for command in view.commands for f in command.frames}

    def view(self) -> ExampleView:
        exchanges = list(self._exchanges(self._golden_pair)) or list(self._exchanges(self._plain_pair))
        file = f"{self._edition.family}_{self._edition.identifier}"
        return ExampleView(file, tuple(initializers(self._edition, self._names, self._known)), tuple(exchanges))

    def _parameters(self) -> dict[str, str]:
        """The parameters of most golden frames, of those with most parameters; without any, the first values."""
        usable = (f for f in self._golden.frames if not f.decode_only) if self._golden else ()
        given = Counter(tuple(sorted(f.parameters.items())) for f in usable)
        if given:
            most = max(given, key=lambda pairs: (len(pairs), given[pairs]))
            return {name: str(value) for name, value in most}
        return {p.name: p.values[0].name if p.values else str(p.minimum or 1) for p in self._edition.parameters}

    def _exchanges(self, pair: Callable[[Command], tuple[int, Raw, Raw] | None]) -> Iterator[ExchangeView]:
        shown: list[str] = []
        for command in self._edition.commands:
            request, reply = command.request, command.reply
            if request is None or reply is None or reply.command != command.name or len(shown) == COMMANDS:
                continue
            if command.from_each or not reply.layout.fields:
                continue
            found = pair(command) if command.available(self._known) and reply.layout.name not in shown else None
            if found is not None:
                node, sent, answered = found
                shown.append(reply.layout.name)
                yield ExchangeView(
                    command=command.name,
                    enumerator=self._names.command(command.name),
                    node=node,
                    request=self._side(request, sent),
                    reply=self._side(reply, answered),
                )

    def _golden_pair(self, command: Command) -> tuple[int, Raw, Raw] | None:
        """Node, and raw integers of request and reply, from golden frames with the known parameters."""
        for request in self._frames_of(command, Direction.REQUEST):
            for reply in self._frames_of(command, Direction.REPLY):
                echoes = not command.is_echoed or request.data == reply.data
                if echoes and (request.node == reply.node or (command.reply and command.reply.id.nodes is None)):
                    return request.node or 0, request.raw, reply.raw
        return None

    def _frames_of(self, command: Command, direction: Direction) -> list[GoldenFrame]:
        return [
            f
            for f in (self._golden.of_command.get((command.name, direction), ()) if self._golden else ())
            if not f.decode_only
            and all(self._known.get(name) == value for name, value in formatting.parameter_values(f.parameters).items())
        ]

    def _plain_pair(self, command: Command) -> tuple[int, Raw, Raw] | None:
        """The first node, and the valid raw integers nearest to 0."""
        request, reply = command.request, command.reply
        if request is None or reply is None:
            return None
        nodes = request.id.nodes or (0,)
        return nodes[0], self._plain(request), self._plain(reply)

    def _plain(self, message: Message) -> Raw:
        return {
            f.name: [_plain_raw(f.type)] * len(f.elements) if f.is_array else _plain_raw(f.type)
            for f in message.layout.fields
        }

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


def initializers(edition: Edition, names: Names, known: Mapping[str, str]) -> Iterator[str]:
    """The initializers of the known parameters."""
    for parameter in edition.parameters:
        value = known.get(parameter.name)
        if value is not None and parameter.is_choice:
            yield f".{member(parameter.name)} = {names.upper(parameter.name, value)}"
        elif value is not None:
            number = Fraction(value)
            yield f".{member(parameter.name)} = {{{number.numerator}, {number.denominator}u}}"


def _plain_raw(type_: Type) -> int:
    if type_.enum:
        return type_.enum[0].value
    low, high = constant_limits(type_)
    return 0 if type_.encoding is Encoding.FLOAT else max(low, min(high, 0))


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
