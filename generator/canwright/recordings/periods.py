"""The gaps between the frames of a message that has a period or a time-out."""

from __future__ import annotations

from fractions import Fraction

from ..model.sending import Sending

_NS = 1_000_000
"""Nanoseconds in a millisecond."""
_LATE = Fraction(3, 2)
"""A gap of more periods contains a late or missing frame: clocks and busy buses delay a frame by less than half a period."""


class Periods:
    """Counts gaps between frames; times are in ns.

    A gap of more than one and a half periods is `late`; `missing` are the frames that would have fit into late gaps.
    `timeouts` are gaps of more than the time-out. `longest` is the longest gap, `before` the number of the frame after it; None at
    the end of the log.
    """

    def __init__(self, sending: Sending) -> None:
        self.sending = sending
        self.late = 0
        self.missing = 0
        self.timeouts = 0
        self.longest = 0
        self.before: int | None = None
        self._last: int | None = None

    def add(self, number: int | None, time: int) -> None:
        """Counts the gap before a frame; without a number, that before the end of the log."""
        gap = 0 if self._last is None else time - self._last
        self._last = time
        every, timeout = self.sending.every_ms, self.sending.timeout_ms
        if every is not None and gap > _LATE * every * _NS:
            self.late += 1
            self.missing += round(gap / (every * _NS)) - 1
        self.timeouts += timeout is not None and gap > timeout * _NS
        if gap > self.longest:
            self.longest, self.before = gap, number
