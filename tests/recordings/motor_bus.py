"""A bus of v2.35 motors with its timing, written from the manual as literal bytes, without a spec or an encoder.

The host may leave old bytes in its transmit buffer, its recorder may log each of its frames twice, and motors may be slow.
A frame occupies the bus for its length; a host that waits repeats or gives up after its time-out.
"""

from __future__ import annotations

import heapq
import itertools
import random
from dataclasses import dataclass

from canwright.model.message import Direction
from canwright.recordings.log_frame import LogFrame
from canwright.semantics.frame import CanFrame

from .traffic import Sent

MS = 1_000_000
FRAME = 125_000
"""The time of a frame of 8 bytes at 1 Mbit/s with some stuff bits, in ns."""

# The bytes that a request sets, by code; the others are NULL in the manual.
REQUESTS: dict[int, tuple[int, ...]] = {
    **dict.fromkeys((0x80, 0x88, 0x81, 0x30, 0x33, 0x90, 0x92, 0x94, 0x9A, 0x9B, 0x9C, 0x9D), ()),
    **dict.fromkeys((0xA2, 0xA3, 0xA7, 0x34), (4, 5, 6, 7)),
    **dict.fromkeys((0xA4, 0xA8), (2, 3, 4, 5, 6, 7)),
    0xA1: (4, 5),
    0xA6: (1, 2, 3, 4, 5, 6, 7),
    0x31: (2, 3, 4, 5, 6, 7),
}
ECHOED = (0x80, 0x88, 0x81, 0x31, 0x34)
READS = (0x30, 0x33, 0x90, 0x92, 0x94, 0x9A, 0x9C, 0x9D)
BROADCAST = 0x280
LATE = (8 * MS, 12 * MS)
MIXES = ("control", "polling", "mixed")
"""Control: 0xA1 to all motors, in cycles. Polling: one read after the other. Mixed: any command, broadcasts too."""


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """What happens on the bus. Times in ns; `lost`, `late`, `reordered` and `not_recorded` are shares."""

    buffer: str = "clean"
    """`clean`, or where old bytes come from: `requests`, `replies` (one buffer for both), or `random` ones."""
    is_doubled: bool = False
    latency: tuple[int, int] = (50_000, 250_000)
    lost: float = 0.0
    late: float = 0.0
    """Replies after LATE; the host waits for them if it `waits`."""
    waits: bool = True
    reordered: float = 0.0
    """Frames that the recorder wrote before the one that was sent before them, with their times."""
    retries: int = 0
    not_recorded: float = 0.0
    pause: tuple[int, int] = (10_000, 1 * MS)
    """Between two exchanges; of the mix control, after the slowest reply of a cycle."""


class MotorBus:
    """Traffic of one host and some motors. Equal seeds give equal traffic."""

    def __init__(self, mix: str, conditions: Conditions, seed: int, *, motors: int = 8, bus: str = "can0") -> None:
        self._mix, self._conditions, self._motors, self._bus = mix, conditions, motors, bus
        self._chance = random.Random(seed)
        self._buffer = bytearray(8 if conditions.buffer == "clean" else self._chance.randbytes(8))
        self._angles = [self._chance.randrange(36_000) for _ in range(motors)]
        self._log: list[tuple[int, CanFrame, Direction]] = []

    def frames(self, exchanges: int) -> list[Sent]:
        """The log of at least some exchanges."""
        clock = 1_700_000_000 * 1000 * MS
        while exchanges > 0:
            requests = self._next()
            exchanges -= len(requests)
            for _ in range(1 + self._conditions.retries):
                clock, answered = self._exchange(requests, clock)
                requests = [request for request in requests if request.id not in answered]
                if not requests or requests[0].id == BROADCAST:
                    break
                clock += self._conditions.latency[1] + self._chance.randint(MS // 2, 2 * MS)
            clock += self._chance.randint(*self._conditions.pause)
        log = sorted(self._log, key=lambda event: event[0])
        for at in range(1, len(log)) if self._conditions.reordered else ():
            if self._chance.random() < self._conditions.reordered:
                log[at - 1 : at + 1] = log[at], log[at - 1]
        return [self._logged(*event) for event in log if self._chance.random() >= self._conditions.not_recorded]

    def _next(self) -> list[CanFrame]:
        """The requests that the host sends next, one after the other."""
        chance = self._chance
        if self._mix == "control":
            return [self._request(motor, 0xA1) for motor in range(1, self._motors + 1)]
        if self._mix == "mixed" and chance.random() < 0.08:
            numbers = (chance.randint(-2000, 2000) for _ in range(4))
            data = b"".join(number.to_bytes(2, "little", signed=True) for number in numbers)
            if self._conditions.buffer != "clean":
                self._buffer[:] = data
            return [CanFrame(BROADCAST, data)]
        code = chance.choice(READS if self._mix == "polling" else [*REQUESTS])
        return [self._request(chance.randint(1, self._motors), code)]

    def _exchange(self, requests: list[CanFrame], time: int) -> tuple[int, set[int]]:
        """Sends requests and the replies to them as the bus is free. Returns the end, and the ids that replied."""
        numbers, answered = itertools.count(), set()
        wanted = [(time, next(numbers), frame, Direction.REQUEST) for frame in requests]
        while wanted:
            since, _, frame, direction = heapq.heappop(wanted)
            time = max(since, time) + FRAME
            if direction is Direction.REQUEST and self._conditions.is_doubled:
                self._log.append((since, frame, direction))  # as it is handed to the driver
            self._log.append((time, frame, direction))
            if direction is Direction.REPLY:
                answered.add(frame.id)
                if self._conditions.buffer == "replies":
                    self._buffer[:] = frame.data
                continue
            for motor in range(1, 5) if frame.id == BROADCAST else (frame.id - 0x140,):
                if self._chance.random() >= self._conditions.lost:
                    code = 0xA1 if frame.id == BROADCAST else frame.data[0]
                    reply = CanFrame(0x140 + motor, self._reply(motor, code, frame.data))
                    is_late = self._conditions.late and self._chance.random() < self._conditions.late
                    since = time + self._chance.randint(*(LATE if is_late else self._conditions.latency))
                    if is_late and not self._conditions.waits:
                        self._log.append((since, reply, Direction.REPLY))
                    else:
                        heapq.heappush(wanted, (since, next(numbers), reply, Direction.REPLY))
        return time, answered

    def _logged(self, time: int, frame: CanFrame, direction: Direction) -> Sent:
        return Sent(LogFrame(time // 1000 * 1000, self._bus, frame, None), direction)

    def _request(self, motor: int, code: int) -> CanFrame:
        """The host fills its buffer: all of it if it is clean, else only what the command uses."""
        buffer, kind = self._buffer, self._conditions.buffer
        if kind == "clean":
            buffer[:] = bytes(8)
        elif kind == "random":
            buffer[:] = self._chance.randbytes(8)
        buffer[0] = code
        for at, value in self._values(code).items():
            buffer[at] = value
        return CanFrame(0x140 + motor, bytes(buffer))

    def _values(self, code: int) -> dict[int, int]:
        chance = self._chance
        used = REQUESTS[code]
        number = chance.choice((0, chance.randint(-99, 99), chance.randint(-2048, 2048)))
        values = dict(zip(used, number.to_bytes(8, "little", signed=True), strict=False))
        if code in (0xA4, 0xA8, 0xA6):  # a limit of the speed, before the angle
            values |= dict(zip((2, 3), (360).to_bytes(2, "little"), strict=True))
            values |= dict(zip((4, 5, 6, 7), chance.randrange(36_000).to_bytes(4, "little"), strict=True))
        if code == 0xA6:
            values[1] = chance.randint(0, 1)
        if code == 0x31:
            values = dict(zip(used, (100, 100, 50, 40, 50, 50), strict=True))
        return values

    def _reply(self, motor: int, code: int, request: bytes) -> bytes:
        chance = self._chance
        self._angles[motor - 1] = angle = (self._angles[motor - 1] + chance.randint(-50, 50)) % 36_000
        encoder = angle * 65536 // 36_000
        temperature = 30 + motor
        if code in ECHOED:
            return request
        if code == 0x30:
            return bytes((code, 0, 100, 100, 50, 40, 50, 50))
        if code == 0x33:
            return bytes((code, 0, 0, 0)) + (1000).to_bytes(4, "little")
        if code == 0x90:
            return bytes((code, 0)) + b"".join(n.to_bytes(2, "little") for n in (encoder, encoder, 0))
        if code == 0x92:
            return bytes((code,)) + (angle + 36_000).to_bytes(7, "little", signed=True)
        if code == 0x94:
            return bytes((code, 0, 0, 0)) + angle.to_bytes(4, "little")
        if code in (0x9A, 0x9B):
            return bytes((0x9A, temperature, 0)) + (240).to_bytes(2, "little") + bytes(3)
        if code == 0x9D:
            phases = (chance.randint(-60, 60) for _ in range(3))
            return bytes((code, temperature)) + b"".join(n.to_bytes(2, "little", signed=True) for n in phases)
        current, speed = chance.randint(-200, 200), chance.choice((0, chance.randint(-300, 300)))
        numbers = current.to_bytes(2, "little", signed=True) + speed.to_bytes(2, "little", signed=True)
        return bytes((code, temperature)) + numbers + encoder.to_bytes(2, "little")


SLOW = (3 * MS, 5 * MS)
SITUATIONS: dict[str, Conditions] = {
    "clean": Conditions(),
    "clean, 1 % lost": Conditions(lost=0.01),
    "clean, 10 % lost": Conditions(lost=0.1),
    "clean, 10 %, retries": Conditions(lost=0.1, retries=3),
    "10 % not recorded": Conditions(not_recorded=0.1),
    "old requests": Conditions(buffer="requests"),
    "old requests, 10 %, retries": Conditions(buffer="requests", lost=0.1, retries=3),
    "old replies": Conditions(buffer="replies"),
    "random bytes": Conditions(buffer="random"),
    "doubled": Conditions(is_doubled=True),
    "doubled, 10 %, retries": Conditions(is_doubled=True, lost=0.1, retries=3),
    "doubled, old requests": Conditions(is_doubled=True, buffer="requests"),
    "slow": Conditions(latency=SLOW),
    "slow, 1 % lost": Conditions(latency=SLOW, lost=0.01),
    "slow, 10 %, retries": Conditions(latency=SLOW, lost=0.1, retries=3),
    "slow, old requests": Conditions(latency=SLOW, buffer="requests"),
    "slow, doubled": Conditions(latency=SLOW, is_doubled=True),
    "slow, random bytes": Conditions(latency=SLOW, buffer="random"),
    "10 % late": Conditions(late=0.1),
    "10 % late, not awaited": Conditions(late=0.1, waits=False),
    "3 % reordered": Conditions(reordered=0.03),
    "10 % late, 3 % reordered": Conditions(late=0.1, waits=False, reordered=0.03),
    "1 ms": Conditions(latency=(300_000, 1 * MS)),
}
