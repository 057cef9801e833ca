"""When a frame is sent: what the keys of a message imply, and which of them contradict each other."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Protocol

from ..model.message import Direction
from ..model.sending import Occasion, Sending
from .concept import Problem

TIMES = ("every_ms", "timeout_ms")
RULE = "sending"


class Keys(Protocol):
    """The keys of a message about when it is sent."""

    @property
    def every_ms(self) -> Fraction | None: ...
    @property
    def timeout_ms(self) -> Fraction | None: ...
    @property
    def sent(self) -> list[Occasion] | None: ...


def sending_of(written: Keys, *, answers: bool) -> Sending | None:
    """When a message is sent; None if nothing is stated. `answers` if it is the reply to a request."""
    implied = {Occasion.ON_REQUEST} if answers else set()
    cyclic = set() if written.every_ms is None else {Occasion.CYCLIC}
    occasions = implied | cyclic if written.sent is None else set(written.sent)
    if written.timeout_ms is None and occasions == implied:
        return None
    return Sending(
        occasions=tuple(occasion for occasion in Occasion if occasion in occasions),
        every_ms=written.every_ms,
        timeout_ms=written.timeout_ms,
    )


def sending_problems(written: Keys, direction: Direction, *, answers: bool) -> Iterator[Problem]:
    """Findings about the keys of a message."""
    yield from _problems_of_times(written, direction)
    sent = written.sent or []
    if written.sent is not None:
        yield from _problems_of_occasions(sent, written, direction, answers=answers)
    sending = sending_of(written, answers=answers)
    if written.timeout_ms is not None and sending and sending.occasions == (Occasion.ON_REQUEST,):
        text = "a frame that is sent on request only has no silence to notice"
        hint = "write `reply_within_ms` of the command, or `every_ms` of the frame"
        yield Problem((direction.value, "timeout_ms"), RULE, text, hint)


def _problems_of_times(written: Keys, direction: Direction) -> Iterator[Problem]:
    for key in TIMES:
        time = getattr(written, key)
        if time is not None and (time <= 0 or (time * 1000).denominator != 1):
            text = f"`{key}` must be above 0 and a whole number of microseconds"
            yield Problem((direction.value, key), RULE, text, "write, for example, 100 or 2.5", key=False)
    every, timeout = written.every_ms, written.timeout_ms
    if every is not None and timeout is not None and timeout <= every:
        text = "the time-out is no longer than the period, so that every frame is late"
        hint = "`timeout_ms` must exceed `every_ms`"
        yield Problem((direction.value, "timeout_ms"), RULE, text, hint, key=False)


def _problems_of_occasions(
    sent: list[Occasion], written: Keys, direction: Direction, *, answers: bool
) -> Iterator[Problem]:
    path = (direction.value, "sent")
    repeated = next((occasion for i, occasion in enumerate(sent) if occasion in sent[:i]), None)
    if repeated is not None:
        yield Problem(path, RULE, f"`{repeated.value}` is repeated", "remove one", key=False)
    if direction is Direction.REQUEST and Occasion.ON_REQUEST in sent:
        text = "the host sends requests, so a request is not sent on request"
        hint = "remove `on_request`, or describe the frame as a reply with `request: none`"
        yield Problem(path, RULE, text, hint, key=False)
    if answers and Occasion.ON_REQUEST not in sent:
        text = "the reply to a request is sent on request"
        yield Problem(path, RULE, text, "add `on_request`, or write `request: none`", key=False)
    if written.every_ms is not None and Occasion.CYCLIC not in sent:
        yield Problem(path, RULE, "a frame with `every_ms` is cyclic", "add `cyclic`, or remove `every_ms`", key=False)
