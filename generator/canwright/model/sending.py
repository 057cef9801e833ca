"""When a frame is sent: the occasions, the nominal period and the time-out."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction


class Occasion(str, Enum):
    """An occasion on which a frame is sent."""

    CYCLIC = "cyclic"
    """Once per period."""
    ON_CHANGE = "on_change"
    """When a value in it changes."""
    ON_REQUEST = "on_request"
    """After a request: that of its command, or of another one."""
    EVENT = "event"
    """On an event in the device, for example at power-up."""


@dataclass(frozen=True, kw_only=True)
class Sending:
    """When a message is sent, as far as the manual states more than that it answers a request.

    `occasions` are in the order of `Occasion`; empty if only `timeout_ms` is known. `every_ms` is the nominal period of a
    cyclic frame. A receiver treats a silence of `timeout_ms` as a failure. Both are whole microseconds.
    """

    occasions: tuple[Occasion, ...]
    every_ms: Fraction | None
    timeout_ms: Fraction | None

    @property
    def is_unasked(self) -> bool:
        """Whether the frame is sent on other occasions than a request."""
        return any(occasion is not Occasion.ON_REQUEST for occasion in self.occasions)


def microseconds(milliseconds: Fraction) -> int:
    """A time of a frame in microseconds, exactly."""
    return int(milliseconds * 1000)
