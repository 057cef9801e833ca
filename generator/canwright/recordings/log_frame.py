"""A frame as a log has it, and the count of everything in a log that is not one."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from ..model.layout import MAX_DATA_BYTES
from ..model.metadata import FrameFormat
from ..semantics.frame import CanFrame
from ..targets.columns.runtime._candump import MAX_ID, MAX_SECONDS, SkippedPart as SkippedPart

new_tuple = tuple.__new__
"""Makes a NamedTuple in half of the time."""
FD_LENGTHS = dict(zip(range(9, 16), (12, 16, 20, 24, 32, 48, 64), strict=True))
"""The data bytes of frames of CAN FD, by the codes of the length that are not the number itself."""
MAX_CLASSIC_BYTES = FrameFormat.CLASSIC.max_data_bytes
"""The data bytes of a classic frame whose code of the length is greater."""
_MAX_TIME = (MAX_SECONDS + 1) * 1_000_000_000


class LogError(Exception):
    """A log that cannot be read; the message states why and what to do."""


class Mark(str, Enum):
    """The mark of a log at a frame: sent by the recorder itself, or received by it."""

    SENT = "Tx"
    RECEIVED = "Rx"


MARKS = {"R": Mark.RECEIVED, "T": Mark.SENT}
"""The marks by their letters."""


class LogFrame(NamedTuple):
    """A frame of a log; `time` in nanoseconds since the epoch or the start of the log, `bus` as the log names it."""

    time: int | None
    bus: str
    frame: CanFrame
    mark: Mark | None


def nanoseconds(seconds: float) -> int:
    """A time of a float of seconds, which since the epoch is exact to less than a microsecond."""
    return round(seconds * 1e6) * 1_000


def log_frame(
    time: int | None, bus: str, id_: int, data: bytes, mark: Mark | None, *, extended: bool, remote: bool = False
) -> LogFrame | SkippedPart:
    """A frame whose id, length and time a log can have; a time of more than 64 bits is unknown."""
    if not 0 <= id_ <= MAX_ID[extended]:
        return SkippedPart.MALFORMED
    if len(data) > MAX_DATA_BYTES:
        return SkippedPart.XL
    known = None if time is None or abs(time) >= _MAX_TIME else time
    return LogFrame(known, bus, CanFrame(id_, data, extended, remote), mark)


OVERLONG = "\ufffd"
"""What stands at the start of a line that was too long: no format has such a line."""
EXAMPLES = 3
"""How many lines of each part are kept to be shown."""


@dataclass
class Counts:
    """The frames of a log, and everything else in it, as far as it has been read."""

    frames: int = 0
    remote: int = 0
    untimed: int = 0
    """The frames whose time is not of a known form, or of more than 64 bits."""
    first_untimed: tuple[int, str] = 0, ""
    """Number and text of the line of the first of them."""
    has_differences: bool = False
    """Whether the times were differences, and have been added up."""
    skipped: Counter[SkippedPart] = field(default_factory=Counter)
    examples: dict[SkippedPart, list[tuple[int, str]]] = field(default_factory=dict)
    """Number and text of the first lines of each part."""

    def lacks_time(self, number: int, text: str) -> None:
        """Counts a frame whose time cannot be read."""
        self.untimed += 1
        if self.untimed == 1:
            self.first_untimed = number, text.strip()[:80]

    def skip(self, part: SkippedPart, number: int = 0, text: str = "") -> None:
        """Counts what is no frame; `number` is that of its line, 0 in a binary log."""
        self.skipped[part] += 1
        kept = self.examples.setdefault(part, [])
        if len(kept) < EXAMPLES:
            kept.append((number, text.strip()[:80]))
