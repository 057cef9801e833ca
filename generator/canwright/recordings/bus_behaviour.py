"""How the host, the nodes and the recorder of a bus behave."""

from __future__ import annotations

from typing import NamedTuple

from ..model.message import Direction, Message

LOOKED_AHEAD = 1 << 12
"""The number of frames at the start of a log from which the behaviour is learned."""
COPIED_WITHIN = 3_000_000
"""The maximum time in ns from a frame to its copy: the host hands it to the driver, and later it is on the bus."""


class OldBits(NamedTuple):
    """A request whose reserved bits the host does not clear; `value` is what all of them contain, None if it varies."""

    request: Message
    value: int | None


class Behaviour(NamedTuple):
    """The behaviour on a bus.

    `is_marked` if marks distinguish requests and replies, but for the nodes that are `unmarked`: their frames are only
    received, as of another host. `copied` are the directions in which each frame is recorded twice. `reply_time` is the
    time in ns within which nine of ten replies come, None if unknown. `old_bits` are requests of a host that leaves old
    bytes in its transmit buffer. `only` is the direction of all frames, if the log lacks those of the other. `resolution`
    is that of the times in ns, by which a latency is uncertain. `repeated_after` is the time in ns after which each frame
    is recorded again, as by a second recorder; None if it is not. `slowest` is the longest time of a reply beyond the
    window, in a log with too few replies to learn from; None with more.
    """

    is_marked: bool = False
    unmarked: frozenset[int | None] = frozenset()
    copied: frozenset[Direction] = frozenset()
    reply_time: int | None = None
    old_bits: tuple[OldBits, ...] = ()
    only: Direction | None = None
    resolution: int = 1
    repeated_after: int | None = None
    slowest: int | None = None

    @property
    def certain(self) -> Behaviour:
        """What is known without a doubt: the marks, the copies, and old bits that do not vary."""
        old_bits = tuple(bits for bits in self.old_bits if bits.value is not None)
        return self._replace(reply_time=None, only=None, old_bits=old_bits, resolution=1, slowest=None)
