"""Examples of commands: the golden frames, or else the values, that show a command best, for every language."""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from ..model.edition import Edition
from ..model.golden_frames import GoldenFrame, GoldenFrames, RawValue
from ..model.layout import Field
from ..model.message import Command, Direction, Message
from ..model.types import Assignment, Type
from ..semantics.decoder import Decoder, Rejection
from ..semantics.encoder import Encoder
from ..semantics.exchange import check_reply
from ..semantics.frame import can_frame, has_usual_code
from ..semantics.valid_raws import RawInterval, valid_raws
from .base import EditionInput, WorkedExchange

MAX_TRIED = 12
"""Most frames of a direction that are tried as half of an exchange."""


def is_usual(message: Message | None, frame: GoldenFrame) -> bool:
    """Whether an encoder writes a frame of a message without an explicit code."""
    return message is not None and not frame.decode_only and has_usual_code(message, can_frame(frame))


class CommandExamples(NamedTuple):
    """The golden frames of a command to show, best first, and the exchange for its program; None without any frame."""

    requests: Sequence[GoldenFrame]
    replies: Sequence[GoldenFrame]
    exchange: WorkedExchange | None


class Examples:
    """Chooses examples of the commands of an edition from its golden frames, if it has any."""

    def __init__(self, edition: Edition, golden: GoldenFrames | None) -> None:
        self._edition, self._golden = edition, golden
        self._decoder = Decoder(edition)

    def select(self, command: Command) -> CommandExamples:
        """The best frames of a command, and the best exchange: with typical values, and a reply to the request."""
        requests, replies = (self._ranked(command, direction) for direction in Direction)
        exchange = self._best(command, requests[:MAX_TRIED], replies[:MAX_TRIED])
        return CommandExamples(
            list(_shown(command.request, requests, exchange and exchange.request)),
            [] if command.is_echoed and requests else list(_shown(command.reply, replies, exchange and exchange.reply)),
            exchange,
        )

    def answered(self, command: Command) -> Iterator[WorkedExchange]:
        """Every golden request with every golden reply that answers it, in the order of the file.

        Both are frames that an encoder writes, for a node with the same parameters.
        """
        sides = (self._frames(command, direction) for direction in Direction)
        requests, replies = (
            [frame for frame in side if is_usual(command.message(frame.direction), frame)] for side in sides
        )
        for request, reply in itertools.product(requests, replies):
            if self._answers(request, reply):
                yield _worked(command, request, reply, is_answered=True)

    def simplest(self, command: Command) -> WorkedExchange | None:
        """An exchange with the first node and the valid raw integers next to 0, without golden frames.

        None without a request or a reply, and where these raw integers are invalid or the reply does not answer.
        """
        nodes = next((message.id.nodes for message in command.messages if message.id.nodes), range(1))
        request, reply = (self._simplest(command.message(direction), nodes[0]) for direction in Direction)
        if request is None or reply is None or not self._answers(request, reply):
            return None
        return WorkedExchange(command, request, reply, self.usual_parameters, is_answered=True)

    @functools.cached_property
    def usual_parameters(self) -> Assignment:
        """The parameters of most golden frames, of those with most parameters; without any, the first values."""
        usable = (frame for frame in self._golden.frames if not frame.decode_only) if self._golden else ()
        given = Counter(tuple(sorted(frame.parameters.items())) for frame in usable)
        if given:
            most = max(given, key=lambda pairs: (len(pairs), given[pairs]))
            return dict(most)
        return {p.name: p.values[0].name if p.values else p.minimum or Fraction(1) for p in self._edition.parameters}

    def _frames(self, command: Command, direction: Direction) -> Sequence[GoldenFrame]:
        """The golden frames of one direction of a command."""
        return self._golden.of_command.get((command.name, direction), ()) if self._golden else ()

    def _ranked(self, command: Command, direction: Direction) -> Sequence[GoldenFrame]:
        """The frames of one direction that an encoder writes, those with typical values first."""
        message = command.message(direction)
        if message is None:
            return ()
        frames = self._frames(command, direction)
        usual = [frame for frame in frames if is_usual(message, frame)] or frames
        return sorted(usual, key=lambda frame: _rank(message, frame))

    def _best(
        self, command: Command, requests: Sequence[GoldenFrame], replies: Sequence[GoldenFrame]
    ) -> WorkedExchange | None:
        """A request with the reply that answers it if there is one, else the first of both."""
        places = itertools.product(range(len(requests)), range(len(replies)))
        for i, j in sorted(places, key=lambda place: (sum(place), place)):
            if self._answers(requests[i], replies[j]):
                return _worked(command, requests[i], replies[j], is_answered=True)
        request = next(iter(requests), None)
        reply = next((frame for frame in replies if request is None or _agree(request, frame)), None)
        return _worked(command, request, reply, is_answered=False) if request or reply else None

    def _answers(self, request: GoldenFrame, reply: GoldenFrame) -> bool:
        """Whether a reply answers a request, under parameters that agree."""
        sent, answer = can_frame(request), can_frame(reply)
        known = {**request.parameters, **reply.parameters}
        return _agree(request, reply) and not isinstance(check_reply(self._decoder, sent, answer, known), Rejection)

    def _simplest(self, message: Message | None, node: int) -> GoldenFrame | None:
        variant = message.layout.variant(self.usual_parameters) if message else None
        if message is None or variant is None:
            return None
        raws: dict[str, RawValue] = {f.name: _simplest_raw(f, node, self.usual_parameters) for f in variant.given}
        node_of_id = None if message.id.nodes is None else node
        frame = Encoder(self.usual_parameters).encode_raws(message, node_of_id, raws)
        if isinstance(frame, Rejection):
            return None
        return GoldenFrame(
            source="",
            direction=message.direction,
            command=message.command,
            id=frame.id,
            extended=frame.extended,
            remote=frame.remote,
            node=node_of_id,
            data=frame.data,
            raw=raws,
        )


def readme_exchange(
    specifications: Iterable[EditionInput], is_usable: Callable[[Edition, WorkedExchange], bool]
) -> tuple[Edition, WorkedExchange] | None:
    """The first usable golden exchange with values in both directions; the first usable one if there is none."""
    first: tuple[Edition, WorkedExchange] | None = None
    for item in specifications:
        examples = Examples(*item)
        for command in item.edition.commands:
            usable = (exchange for exchange in examples.answered(command) if is_usable(item.edition, exchange))
            for exchange in itertools.islice(usable, 1):
                first = first or (item.edition, exchange)
                if exchange.request and exchange.request.values:
                    return item.edition, exchange
    return first


def _simplest_raw(field: Field, node: int, parameters: Assignment) -> RawValue:
    """The node or its low bits in a field for it, the first name of an enum, else the valid raw integer next to 0."""
    valid = valid_raws(field.type).at(parameters)
    raw = field.type.enum[0].value if field.type.enum else 0
    if field.is_node:
        raw = node & (1 << field.type.width) - 1
    elif isinstance(valid, RawInterval):
        raw = max(valid.low, min(valid.high, 0))
    return [raw] * len(field.elements) if field.is_array else raw


def _worked(
    command: Command, request: GoldenFrame | None, reply: GoldenFrame | None, *, is_answered: bool
) -> WorkedExchange:
    parameters = {n: v for frame in (request, reply) if frame for n, v in frame.parameters.items()}
    return WorkedExchange(command, request, reply, parameters, is_answered)


def _agree(request: GoldenFrame, reply: GoldenFrame) -> bool:
    return all(reply.parameters.get(name, value) == value for name, value in request.parameters.items())


def _rank(message: Message, frame: GoldenFrame) -> tuple[int, ...]:
    """Smaller for a better example: every value known, none of them 0, none at a limit, all parameters known."""
    raws = list(_raws(message, frame))
    return (
        sum(value == "none" for value in frame.values.values()) + len(frame.raw.keys() - frame.values.keys()),
        sum(raw == 0 and field.type.is_number for field, raw in raws),
        _extremes(message, frame),
        -len(frame.values),
        frame.node != 1,
    )


def _raws(message: Message, frame: GoldenFrame) -> Iterator[tuple[Field, int]]:
    """The raw integers of a frame with their fields."""
    fields = {field.name: field for field in message.layout.fields}
    for name, listed in frame.raw.items():
        if name in fields:
            yield from ((fields[name], raw) for raw in _list(listed))


def _extremes(message: Message, frame: GoldenFrame) -> int:
    """The number of numbers next to a limit or to 0."""
    return sum(_is_extreme(field, raw) for field, raw in _raws(message, frame))


def _list(raw: int | list[int]) -> list[int]:
    return raw if isinstance(raw, list) else [raw]


def _is_extreme(field: Field, raw: int) -> bool:
    """Whether a number is next to a limit of its type, or next to 0."""
    return field.type.is_number and (abs(raw) <= 1 or raw in _next_to_limits(field.type))


@functools.lru_cache(maxsize=1 << 12)
def _next_to_limits(type_: Type) -> frozenset[int]:
    """The raw integers that are at most 1 away from a limit of a type."""
    valid = [raws for _, raws in valid_raws(type_).distinct() if isinstance(raws, RawInterval)]
    limits = {*type_.raw_limits, *type_.number_limits, *(end for raws in valid for end in (raws.low, raws.high))}
    return frozenset(near for limit in limits for near in range(limit - 1, limit + 2))


def _shown(message: Message | None, frames: Sequence[GoldenFrame], first: GoldenFrame | None) -> Iterator[GoldenFrame]:
    """The frame of the exchange, then the best of each other variant, and the best with a negative value."""
    if message is None or not frames:
        return
    first = first or frames[0]
    rest = [frame for frame in frames if frame.data != first.data]
    shown = {_variant(message, first): first}
    if len(message.layout.variants) > 1:
        for frame in rest:
            shown.setdefault(_variant(message, frame), frame)
    yield from shown.values()
    if not any(map(_is_negative, shown.values())):
        typical = (frame for frame in rest if _is_negative(frame) and not _extremes(message, frame))
        yield from itertools.islice(typical, 1)


def _variant(message: Message, frame: GoldenFrame) -> frozenset[str]:
    return frozenset(frame.raw)


def _is_negative(frame: GoldenFrame) -> bool:
    return any(raw < 0 for listed in frame.raw.values() for raw in _list(listed))
