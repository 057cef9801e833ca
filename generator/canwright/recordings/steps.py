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
from .bus_behaviour import COPIED_WITHIN
from .checks import STRONG, Reason
from .log_frame import LogFrame
from .scoring import Interpretation, Observation, ScoredClass, reply_rule

MAX_OPEN = 4
"""The maximum number of requests of a node that wait for their replies."""


class Repetition(Enum):
    """The place of a frame among equal ones of a node, one soon after the other."""

    SECOND = "second"
    """A copy of a request, or a reply with its bytes."""
    THIRD = "third"
    """A reply with the bytes of a request and of its copy, or the request again."""


class Repetitions:
    """Finds equal frames of a node, one soon after the other."""

    def __init__(self) -> None:
        self._latest: LogFrame | None = None
        self._equal = 0
        """The number of frames before the latest that it repeats."""

    def place(self, recorded: LogFrame, kind: ScoredClass) -> Repetition | None:
        """The place of the next frame of the node."""
        before, self._latest = self._latest, recorded
        if before is None or not kind.is_same(recorded.frame, before.frame):
            self._equal = 0
            return None
        is_soon = (
            recorded.time is not None and before.time is not None and 0 <= recorded.time - before.time <= COPIED_WITHIN
        )
        self._equal = self._equal + 1 if is_soon else 0
        if not self._equal:
            return None
        return Repetition.SECOND if self._equal % 2 else Repetition.THIRD


class Open(NamedTuple):
    """A request that waits for its replies; `is_certain` if its frame cannot be a reply too, `is_answered` after a reply."""

    command: str
    is_certain: bool
    is_answered: bool = False


Waiting = tuple[Open, ...]
"""The requests of a node that wait for their replies, the oldest first."""


Arrived = Observation | tuple[Observation, Direction | None, Repetition | None]
"""A frame, with its direction if it is known, and its place among equal frames."""


class Circumstances(NamedTuple):
    """What is known of a frame beside its bytes; `has_number` if its node is known."""

    direction: Direction | None
    repetition: Repetition | None
    has_number: bool


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
    edition: Edition, waiting: Waiting, interpretations: Sequence[Interpretation], circumstances: Circumstances
) -> Meaning:
    """The interpretation of a frame with the fewest points against it, after requests that wait for replies.

    After a request, what is not the same request again is its reply.
    """
    direction, repetition, has_number = circumstances
    request = min((each for each in interpretations if each.is_request), key=_points, default=None)
    answers = [
        _Answer(each, open_)
        for each in interpretations
        if not each.is_request
        for open_ in waiting
        if any(reply.message is each.message for reply in edition.command(open_.command).replies)
    ]
    if request is not None and repetition is not None:
        repeated = _repeated(edition, waiting, request, answers, circumstances)
        if repeated is not None:
            return repeated
    if direction is not None:
        interpretations = _of_direction(interpretations, direction)
        request, answers = (request, []) if direction is Direction.REQUEST else (None, answers)
    regular = request if request is not None and _is_regular(request, answers) else None
    if answers and (regular is None or _is_like_a_reply(edition, regular)):
        return _answering(edition, waiting, answers)
    best = regular or min(interpretations, key=_points_and_direction)
    if regular is None and best is request and len(interpretations) == 1:
        best = _with_the_id_of_requests(edition, waiting, best)
    if best.message is None or best.points >= STRONG:
        return Meaning(best, waiting)
    command = edition.command(best.message.command)
    if not best.is_request:
        return Meaning(best, waiting, is_unrequested=command.only_answers)
    if command.reply is None or (not has_number and command.reply.id.nodes is not None):
        return Meaning(best, waiting)
    is_certain = not any(not each.is_request and not each.points for each in interpretations)
    return _opening(waiting, best, Open(command.name, is_certain))


class _Answer(NamedTuple):
    """A reply that a frame can be, and the request that it answers."""

    reply: Interpretation
    asked: Open


def _repeated(
    edition: Edition,
    waiting: Waiting,
    request: Interpretation,
    answers: Sequence[_Answer],
    circumstances: Circumstances,
) -> Meaning | None:
    """What a frame with the bytes of an open request is: its reply, or a copy of it; None if neither.

    It may be the copy of a request whose reply has the same bytes, so that the request waits further.
    """
    assert request.message is not None
    command = edition.command(request.message.command)
    asked = next((each for each in waiting if each.command == command.name), None)
    if asked is None:
        return None
    equal = next((answer.reply for answer in answers if answer.asked is asked and not answer.reply.points), None)
    direction = circumstances.direction
    if equal and (repeats_request(command) if direction is None else direction is Direction.REPLY):
        kept = () if asked.is_answered else (asked._replace(is_answered=True),)
        return Meaning(equal, (*(each for each in waiting if each is not asked), *kept))
    return Meaning(request, waiting) if circumstances.repetition is Repetition.SECOND else None


def _answering(edition: Edition, waiting: Waiting, answers: Sequence[_Answer]) -> Meaning:
    """The best of the replies, with which its request waits no longer, or for further ones."""
    reply, asked = min(answers, key=lambda answer: answer.reply.points)
    further = (asked._replace(is_answered=True),) if edition.command(asked.command).has_several_frames else ()
    return Meaning(reply, (*(each for each in waiting if each is not asked), *further))


def _opening(waiting: Waiting, request: Interpretation, opened: Open) -> Meaning:
    """A request that waits for its replies; that of the same command, or the oldest of too many, waits no longer."""
    replaced = next((each for each in waiting if each.command == opened.command), None)
    kept = tuple(each for each in waiting if each is not replaced)
    ended = replaced or (kept[0] if len(kept) >= MAX_OPEN else None)
    unanswered = None if ended is None or ended.is_answered else ended
    return Meaning(request, (*kept[1 - MAX_OPEN :], opened), opened, unanswered)


def _with_the_id_of_requests(edition: Edition, waiting: Waiting, best: Interpretation) -> Interpretation:
    """Against a request with reasons against it: it can be the reply to one before, but has another id."""
    assert best.message is not None
    command, rule = best.message.command, reply_rule(edition, best.message)
    if not rule or all(each.command != command for each in waiting):
        return best
    text = f"{formatting.id_rule(best.message.id)} has a reply of {command}{rule}"
    return Interpretation(best.message.name, best.message, (Reason(STRONG, text),))


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


def _is_regular(request: Interpretation, answers: Sequence[_Answer]) -> bool:
    """Whether nothing speaks against a request but bits that the replies reserve too, so that they decide nothing."""
    undecided = [{reason.byte for reason in answer.reply.reasons} for answer in answers]
    return not request.reasons or (
        bool(undecided)
        and all(reason.byte is not None and reason.byte in own for reason in request.reasons for own in undecided)
    )


def _is_like_a_reply(edition: Edition, request: Interpretation) -> bool:
    """Whether a reply to a request has its bytes whenever it comes: it is an echo, or the request has no reserved bit."""
    assert request.message is not None
    message = request.message
    return edition.command(message.command).is_echoed or not message_plan(message).reserved.mask
