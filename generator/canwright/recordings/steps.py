"""Steps: a frame after the requests before it, and what both mean in each edition."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from functools import cached_property
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.message import Direction
from ..semantics.exchange import repeats_request
from ..semantics.plan import message_plan
from .checks import STRONG, Reason
from .scoring import Interpretation, Observation, ScoredClass, reply_rule

MAX_OPEN = 4
"""The maximum number of requests of a node that wait for their replies."""


class Repetition(Enum):
    """The place of a frame among equal ones of a node, one soon after the other."""

    SECOND = "second"
    """A copy of a request, or a reply with its bytes."""
    THIRD = "third"
    """A reply with the bytes of a request and of its copy, or the request again."""


class Open(NamedTuple):
    """A request that waits for its replies; `is_certain` if its frame cannot be a reply too, `is_answered` after a reply."""

    command: str
    is_certain: bool
    is_answered: bool = False


Waiting = tuple[Open, ...]
"""The requests of a node that wait for their replies, the oldest first."""


Arrived = Observation | tuple[Observation, Direction | None, Repetition | None]
"""A frame, with its direction if it is known, and its place among equal frames."""


class State:
    """The requests that wait, by edition, and the next steps by what arrives."""

    __slots__ = ("steps", "waiting")

    def __init__(self, waiting: tuple[Waiting, ...]) -> None:
        self.waiting = waiting
        self.steps: dict[Arrived, Step] = {}


class Meaning(NamedTuple):
    """What a frame is in an edition after the frames before it; `is_unrequested` for a reply without a request."""

    interpretation: Interpretation
    waiting: Waiting
    opened: Open | None = None
    unanswered: Open | None = None
    is_unrequested: bool = False


class Step:
    """An observation in a state: the meaning in each edition, and the state that follows."""

    def __init__(self, kind: ScoredClass, meanings: Sequence[Meaning], then: State) -> None:
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
        having = [meaning.interpretation for meaning in self.meanings if meaning.interpretation.points < STRONG]
        return bool(having) and all(meaning.is_request for meaning in having)

    @cached_property
    def points(self) -> tuple[int, ...]:
        """The points against each edition. Requests have none, since hosts set reserved bits, and try codes."""
        if self.is_unexplained or self.is_request:
            return (0,) * len(self.meanings)
        return tuple(meaning.interpretation.points for meaning in self.meanings)

    @cached_property
    def costs(self) -> tuple[int, ...]:
        """The points without those against what a host may have sent."""
        pairs = zip(self.points, self.meanings, strict=True)
        return tuple(0 if meaning.interpretation.is_careless else points for points, meaning in pairs)

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
    repetition: Repetition | None,
    *,
    has_number: bool,
) -> Meaning:
    """The interpretation of a frame with the fewest points against it, after requests that wait for replies.

    After a request, what is not the same request again is its reply.
    """
    repeated = repetition and _repeated(edition, waiting, interpretations, direction, repetition)
    if repeated:
        return repeated
    if direction is not None:
        interpretations = _of_direction(interpretations, direction)
    request = min((each for each in interpretations if each.is_request), key=_points, default=None)
    answers = [
        (each, open_)
        for each in interpretations
        if not each.is_request
        for open_ in waiting
        if any(reply.message is each.message for reply in edition.command(open_.command).replies)
    ]
    is_regular = request is not None and (
        not request.reasons or (bool(answers) and all(_reserves_too(request, reply) for reply, _ in answers))
    )
    if answers and (not is_regular or _is_like_a_reply(edition, request)):
        reply, answered = min(answers, key=lambda item: item[0].points)
        remaining = tuple(open_ for open_ in waiting if open_ is not answered)
        has_further = edition.command(answered.command).has_several_frames
        return Meaning(reply, (*remaining, answered._replace(is_answered=True)) if has_further else remaining)
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
        return Meaning(best, waiting, is_unrequested=edition.command(message.command).only_answers)
    reply_message = edition.command(message.command).reply
    if reply_message is None or (not has_number and reply_message.id.nodes is not None):
        return Meaning(best, waiting)
    opened = Open(message.command, not any(not each.is_request and not each.points for each in interpretations))
    replaced = next((open_ for open_ in waiting if open_.command == opened.command), None)
    kept = tuple(open_ for open_ in waiting if open_ is not replaced)
    unanswered = replaced or (kept[0] if len(kept) >= MAX_OPEN else None)
    if unanswered is not None and unanswered.is_answered:
        unanswered = None
    return Meaning(best, (*kept[1 - MAX_OPEN :], opened), opened, unanswered)


def _repeated(
    edition: Edition,
    waiting: Waiting,
    interpretations: Sequence[Interpretation],
    direction: Direction | None,
    repetition: Repetition,
) -> Meaning | None:
    """What a frame with the bytes of an open request is: its reply, or a copy of it; None if neither.

    It may be the copy of a request whose reply has the same bytes, so that the request waits further.
    """
    request = min((each for each in interpretations if each.is_request), key=_points, default=None)
    open_ = next((o for o in waiting if request and request.message and o.command == request.message.command), None)
    if request is None or open_ is None:
        return None
    replies = edition.command(open_.command).replies
    equal = [i for i in interpretations if not i.points and any(reply.message is i.message for reply in replies)]
    is_likely = direction is Direction.REPLY or (direction is None and repeats_request(edition.command(open_.command)))
    if equal and is_likely:
        kept = () if open_.is_answered else (open_._replace(is_answered=True),)
        return Meaning(equal[0], (*(each for each in waiting if each is not open_), *kept))
    return Meaning(request, waiting) if repetition is Repetition.SECOND else None


def _points(interpretation: Interpretation) -> int:
    return interpretation.points


def _points_and_direction(interpretation: Interpretation) -> tuple[int, bool]:
    """Of a request and a reply with equal points, the request: those of a request say nothing about the edition."""
    return interpretation.points, not interpretation.is_request


def _of_direction(interpretations: Sequence[Interpretation], direction: Direction) -> Sequence[Interpretation]:
    """The interpretations in a direction that the log marks."""
    having = [
        interpretation
        for interpretation in interpretations
        if interpretation.message is None or interpretation.message.direction is direction
    ]
    if having:
        return having
    first = interpretations[0]
    text = f"{first.kind} is marked as a {direction.value}"
    return [Interpretation(first.kind, None, (Reason(STRONG, text),))]


def _reserves_too(request: Interpretation, reply: Interpretation) -> bool:
    """Whether all that speaks against a request are bits that the reply reserves too, so that they decide nothing."""
    of_reply = [reason.byte for reason in reply.reasons]
    return all(reason.byte is not None and reason.byte in of_reply for reason in request.reasons)


def _is_like_a_reply(edition: Edition, request: Interpretation | None) -> bool:
    """Whether a reply can equal the request: it is an echo, or the request has no reserved bit."""
    assert request is not None and request.message is not None
    message = request.message
    return edition.command(message.command).is_echoed or not message_plan(message).reserved.mask
