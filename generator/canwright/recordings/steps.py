"""Steps: a frame after the requests before it, and what both mean in each edition."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.message import Direction
from ..semantics.bits import data_bits
from .checks import STRONG, Reason
from .scoring import Interpretation, Kind, Observation, reply_rule

MAX_OPEN = 4
"""The maximum number of requests of a node that wait for their replies."""


class Open(NamedTuple):
    """A request that waits for its reply; `is_certain` if its frame cannot be a reply too."""

    command: str
    is_certain: bool


Waiting = tuple[Open, ...]
"""The requests of a node that wait for their replies, the oldest first."""


class State:
    """The requests that wait, by edition, and the next steps by observation, and by direction if it is known."""

    __slots__ = ("steps", "waiting")

    def __init__(self, waiting: tuple[Waiting, ...]) -> None:
        self.waiting = waiting
        self.steps: dict[Observation | tuple[Observation, Direction], Step] = {}


class Meaning(NamedTuple):
    """What a frame is in an edition after the frames before it; `is_unrequested` for a reply without a request."""

    interpretation: Interpretation
    waiting: Waiting
    opened: Open | None = None
    unanswered: Open | None = None
    is_unrequested: bool = False


class Step:
    """An observation in a state: the meaning in each edition, and the state that follows."""

    def __init__(self, kind: Kind, meanings: Sequence[Meaning], then: State) -> None:
        self.kind = kind
        self.meanings = meanings
        self.then = then

    @cached_property
    def is_unexplained(self) -> bool:
        """Whether no edition has this frame."""
        return all(meaning.interpretation.points >= STRONG for meaning in self.meanings)

    @cached_property
    def is_request(self) -> bool:
        """Whether the frame is a request in all editions that have it."""
        having = [one.interpretation for one in self.meanings if one.interpretation.points < STRONG]
        return bool(having) and all(one.is_request for one in having)

    @cached_property
    def points(self) -> tuple[int, ...]:
        """The points against each edition. Requests have none, since hosts set reserved bits, and try codes."""
        if self.is_unexplained or self.is_request:
            return (0,) * len(self.meanings)
        return tuple(meaning.interpretation.points for meaning in self.meanings)

    @cached_property
    def costs(self) -> tuple[int, ...]:
        """The points without those against what a host may have sent."""
        found = zip(self.points, self.meanings, strict=True)
        return tuple(0 if meaning.interpretation.is_careless else points for points, meaning in found)

    @cached_property
    def best(self) -> int:
        """The editions with the fewest points, as a mask."""
        least = min(self.points)
        return sum(1 << i for i, points in enumerate(self.points) if points == least)


def meaning(
    edition: Edition,
    waiting: Waiting,
    interpretations: Sequence[Interpretation],
    direction: Direction | None,
    *,
    has_number: bool,
) -> Meaning:
    """The interpretation of a frame with the fewest points against it, after requests that wait for replies.

    After a request, what is not the same request again is its reply.
    """
    if direction is not None:
        interpretations = _of_direction(interpretations, direction)
    request = min((one for one in interpretations if one.is_request), key=_points, default=None)
    answers = [
        (one, open_)
        for one in interpretations
        if not one.is_request
        for open_ in waiting
        if edition.command(open_.command).reply is one.message
    ]
    is_regular = request is not None and not request.reasons
    if answers and (not is_regular or _is_like_a_reply(edition, request)):
        reply, answered = min(answers, key=lambda item: item[0].points)
        return Meaning(reply, tuple(other for other in waiting if other is not answered))
    if request is not None and not is_regular and len(interpretations) == 1:
        message = request.message
        assert message is not None
        if message.command in (open_.command for open_ in waiting) and (rule := reply_rule(edition, message)):
            text = f"{formatting.id_rule(message.id)} has a reply of {message.command}{rule}"
            return Meaning(Interpretation(message.name, message, (Reason(STRONG, text),)), waiting)
    best = request if is_regular else min(interpretations, key=_points_and_direction)
    assert best is not None
    message = best.message
    if message is None or best.points >= STRONG:
        return Meaning(best, waiting)
    if message.direction is Direction.REPLY:
        return Meaning(best, waiting, is_unrequested=edition.command(message.command).request is not None)
    reply_message = edition.command(message.command).reply
    if reply_message is None or (not has_number and reply_message.id.nodes is not None):
        return Meaning(best, waiting)
    opened = Open(message.command, not any(not one.is_request and not one.points for one in interpretations))
    replaced = next((open_ for open_ in waiting if open_.command == opened.command), None)
    others = tuple(open_ for open_ in waiting if open_ is not replaced)
    unanswered = replaced or (others[0] if len(others) >= MAX_OPEN else None)
    return Meaning(best, (*others[1 - MAX_OPEN :], opened), opened, unanswered)


def _points(interpretation: Interpretation) -> int:
    return interpretation.points


def _points_and_direction(interpretation: Interpretation) -> tuple[int, bool]:
    """Of a request and a reply with equal points, the request: those of a request say nothing about the edition."""
    return interpretation.points, not interpretation.is_request


def _of_direction(interpretations: Sequence[Interpretation], direction: Direction) -> Sequence[Interpretation]:
    """The interpretations in a direction that the log marks."""
    found = [one for one in interpretations if one.message is None or one.message.direction is direction]
    if found:
        return found
    other = interpretations[0]
    text = f"{other.kind} is marked as a {direction.value}"
    return [Interpretation(other.kind, None, (Reason(STRONG, text),))]


def _is_like_a_reply(edition: Edition, request: Interpretation | None) -> bool:
    """Whether a reply can equal the request: it is an echo, or the request has no reserved bit."""
    assert request is not None and request.message is not None
    message = request.message
    places = [(key.space, key.segments) for key in message.keys]
    places += [(f.space, e.segments) for f in message.layout.fields for e in f.elements]
    return edition.command(message.command).is_echoed or data_bits(places) == (1 << 8 * message.dlc) - 1
