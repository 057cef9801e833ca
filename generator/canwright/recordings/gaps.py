"""The gaps between the frames of a message that has a period or a time-out, or a counter."""

from __future__ import annotations

from fractions import Fraction

from ..model.layout import CounterRole
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


class CounterGaps:
    """Counts gaps between the values of a counter, one in each frame.

    `missing` are the frames that the gaps lack; a multiple of the length of the counter cannot be noticed. `repeated` are frames
    with the value of the frame before, `invalid` those with a value outside the counter, which are left out otherwise.
    """

    def __init__(self, role: CounterRole) -> None:
        self.role = role
        self.gaps = 0
        self.missing = 0
        self.repeated = 0
        self.invalid = 0
        self._last: int | None = None

    @property
    def is_regular(self) -> bool:
        """Whether each frame had the value after that of the frame before."""
        return not (self.gaps or self.repeated or self.invalid)

    def add(self, value: int) -> None:
        """Counts the value of the next frame."""
        first, last = self.role.first, self.role.last
        if not first <= value <= last:
            self.invalid += 1
            return
        if self._last is not None:
            steps = (value - self._last) % (last - first + 1)
            self.gaps += steps > 1
            self.missing += max(steps - 1, 0)
            self.repeated += steps == 0
        self._last = value
