"""The frames that are missing or repeated according to the counter of a message."""

from __future__ import annotations

from ..model.layout import CounterRole


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
