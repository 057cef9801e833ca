"""When the frames of an id are sent: the attributes that tools read, and the sentences of comments."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import formatting
from ...model.sending import Occasion, Sending
from .comments import Comments
from .frames import Frame

SEND_TYPES = ("Cyclic", "Event")
"""The values of GenMsgSendType that every file defines."""
_NAMES = {
    Occasion.CYCLIC: "Cyclic",
    Occasion.ON_CHANGE: "OnChange",
    Occasion.ON_REQUEST: "OnRequest",
    Occasion.EVENT: "Event",
}


def attributes(frame: Frame) -> tuple[str, int]:
    """GenMsgSendType and GenMsgCycleTime of a frame: an attribute is one for all messages of its id.

    The type of several occasions is `CyclicAndOnChange`. A period that is no whole number of milliseconds is left out.
    """
    sending = _common(frame)
    if sending is None:
        return "", 0
    every = sending.every_ms
    cycle = int(every) if every is not None and every.denominator == 1 else 0
    return "And".join(_NAMES[occasion] for occasion in sending.occasions), cycle


def sentences(frame: Frame, comments: Comments) -> Iterator[str]:
    """When the frame is sent; by command if its messages differ."""
    words = formatting.words_of(formatting.SendingWords, comments.texts, "sending")
    common = _common(frame)
    if common is not None:
        yield comments.fixed("sent", when=formatting.sending(common, words))
        return
    for command, sending in {part.command.name: part.message.sending for part in frame.parts}.items():
        if sending is not None:
            yield comments.labelled(command, formatting.sending(sending, words))


def _common(frame: Frame) -> Sending | None:
    """What is stated of every message of the id."""
    distinct = {part.message.sending for part in frame.parts}
    return next(iter(distinct)) if len(distinct) == 1 and not frame.hidden else None
