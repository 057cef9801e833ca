"""Golden frames that show a command best: few, with typical values, and a reply that answers the request."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, GoldenFrames
from ...model.layout import Field
from ...model.message import Command, Direction, Message
from ...model.types import Type
from ...semantics.decoder import Decoder, Rejection
from ...semantics.exchange import check_reply
from ...semantics.frame import CanFrame
from ..base import WorkedExchange

MAX_TRIED = 12
"""Most frames of a direction that are tried as half of an exchange."""


class Chosen(NamedTuple):
    """The frames of a command to show, best first, and the exchange for its program; None without any frame."""

    requests: Sequence[GoldenFrame]
    replies: Sequence[GoldenFrame]
    exchange: WorkedExchange | None


class Choice:
    """Chooses golden frames of the commands of an edition."""

    def __init__(self, edition: Edition, golden: GoldenFrames | None) -> None:
        self._golden = golden
        self._decoder = Decoder(edition)

    def select(self, command: Command) -> Chosen:
        """The frames of a command."""
        requests, replies = (self._ranked(command, direction) for direction in Direction)
        exchange = self._exchange(command, requests[:MAX_TRIED], replies[:MAX_TRIED])
        return Chosen(
            list(_shown(command.request, requests, exchange and exchange.request)),
            [] if command.is_echoed and requests else list(_shown(command.reply, replies, exchange and exchange.reply)),
            exchange,
        )

    def _ranked(self, command: Command, direction: Direction) -> Sequence[GoldenFrame]:
        """The frames of one direction that an encoder writes, those with typical values first."""
        message = command.message(direction)
        if self._golden is None or message is None:
            return ()
        found = self._golden.of_command.get((command.name, direction), [])
        usual = [frame for frame in found if not frame.decode_only] or found
        return sorted(usual, key=lambda frame: _rank(message, frame))

    def _exchange(
        self, command: Command, requests: Sequence[GoldenFrame], replies: Sequence[GoldenFrame]
    ) -> WorkedExchange | None:
        """A request with the reply that answers it if there is one, else the first of both."""
        places = itertools.product(range(len(requests)), range(len(replies)))
        for i, j in sorted(places, key=lambda place: (sum(place), place)):
            request, reply = requests[i], replies[j]
            if _agree(request, reply) and self._answers(request, reply):
                return _worked(command, request, reply, True)
        asked = next(iter(requests), None)
        answer = next((one for one in replies if asked is None or _agree(asked, one)), None)
        return _worked(command, asked, answer, False) if asked or answer else None

    def _answers(self, request: GoldenFrame, reply: GoldenFrame) -> bool:
        frames = (CanFrame(one.id, one.data, one.extended, one.remote) for one in (request, reply))
        return not isinstance(check_reply(self._decoder, *frames), Rejection)


def _worked(
    command: Command, request: GoldenFrame | None, reply: GoldenFrame | None, is_answered: bool
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
    spans = [span for _, span in type_.raw_range.distinct() if span is not None and span.is_constant]
    limits: list[int | Fraction] = [
        *type_.raw_limits,
        *(end.constant for span in spans for end in (span.low, span.high)),
    ]
    return frozenset(near for limit in limits for near in range(math.ceil(limit - 1), math.floor(limit + 1) + 1))


def _shown(message: Message | None, frames: Sequence[GoldenFrame], first: GoldenFrame | None) -> Iterator[GoldenFrame]:
    """The frame of the exchange, then the best of each other variant, and the best with a negative value."""
    if message is None or not frames:
        return
    first = first or frames[0]
    yield first
    variants, seen = message.layout.variants, {_variant(message, first)}
    rest = [frame for frame in frames if frame.data != first.data]
    for frame in rest:
        if len(variants) > 1 and _variant(message, frame) not in seen:
            seen.add(_variant(message, frame))
            yield frame
    if not _is_negative(first):
        typical = (frame for frame in rest if _is_negative(frame) and not _extremes(message, frame))
        yield from itertools.islice(typical, 1)


def _variant(message: Message, frame: GoldenFrame) -> frozenset[str]:
    return frozenset(frame.raw)


def _is_negative(frame: GoldenFrame) -> bool:
    return any(raw < 0 for listed in frame.raw.values() for raw in _list(listed))
