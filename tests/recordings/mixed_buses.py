"""Simulated buses of motors of all four editions, with the true edition of each frame.

Written from the manuals with `struct`, without the code under test, and with values that motors report: 44 to 52 V, 25 to
60 °C, currents that are not 0. A log has requests and replies, or replies only, as of a recorder that does not see
its own frames; with the marks of candump, or without.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

V235, V235B, V236A, V236C = EDITIONS = ("v2.35", "v2.35-2024-02", "v2.36-2024-11", "v2.36-2025-03")
START = 1_700_000_000_000_000
"""The time of the first request in microseconds."""


@dataclass(frozen=True)
class Motor:
    """A motor, and the requests that the host sends it, by name; `since` and `until` are numbers of rounds."""

    node: int
    edition: str
    mix: Sequence[str] = ("status", "torque", "feedback")
    first: Sequence[str] = ("on",)
    """The requests of the first rounds, before the mix is repeated."""
    bus: str = "can0"
    since: int = 0
    until: int = 1 << 60
    every: int = 1
    """The host asks in one of so many rounds."""


@dataclass(frozen=True)
class Frame:
    """A frame with its truth: the motor that sends or receives it, and the voltage that it reports."""

    time: int
    bus: str
    id: int
    data: bytes
    is_request: bool
    motor: Motor
    voltage: float | None = None
    is_damaged: bool = False

    def line(self, mark: str = "") -> str:
        data = f"{self.id:03X}#{self.data.hex().upper()}"
        return f"({self.time // 10**6}.{self.time % 10**6:06}) {self.bus} {data}{mark and ' ' + mark}\n"


Exchange = tuple[bytes, bytes, float | None]
"""The data of a request and of its reply, and the voltage in the reply."""


def _same(code: int, *rest: bytes) -> Exchange:
    data = (bytes([code]) + b"".join(rest)).ljust(8, b"\0")
    return data, data, None


def _read(code: int, reply: bytes, index: bytes = b"") -> Exchange:
    head = bytes([code]) + index
    return head.ljust(8, b"\0"), (head + reply).ljust(8, b"\0"), None


def _feedback(rng: random.Random) -> bytes:
    """Temperature, torque current, speed and encoder."""
    current, speed = rng.choice((-1, 1)) * rng.randint(20, 1500), rng.randint(-900, 900)
    return struct.pack("<bhhH", rng.randint(25, 60), current, speed, rng.randrange(1 << 14))


def _status(edition: str, rng: random.Random) -> tuple[bytes, float]:
    """The reply to a request for the status: the older edition has 0.1 V and no current."""
    volts = rng.uniform(44, 52)
    if edition == V235:
        raw = round(volts * 10)
        return struct.pack("<bxHxxB", rng.randint(25, 60), raw, 0), raw / 10
    raw, current = round(volts * 100), rng.randint(-900, 900)
    return struct.pack("<bhhBB", rng.randint(25, 60), raw, current, 0, 0), raw / 100


def _asked_status(code: int) -> Callable[[str, random.Random], Exchange]:
    def exchange(edition: str, rng: random.Random) -> Exchange:
        data, volts = _status(edition, rng)
        answered = 0x9A if edition == V235 else code  # as that manual prints it
        return bytes([code]).ljust(8, b"\0"), bytes([answered]) + data, volts

    return exchange


def _speed(edition: str, rng: random.Random) -> Exchange:
    limit = rng.randint(100, 1500) if edition.startswith("v2.36") else 0
    request = struct.pack("<BxhI", 0xA2, limit, rng.randrange(90_000))
    return request, b"\xa2" + _feedback(rng), None


def _motion(code: int, layout: str, *spans: tuple[int, int]) -> Callable[[str, random.Random], Exchange]:
    def exchange(_: str, rng: random.Random) -> Exchange:
        request = struct.pack(layout, code, *(rng.randint(*span) for span in spans))
        return request, bytes([code]) + _feedback(rng), None

    return exchange


def _phases(_: str, rng: random.Random) -> Exchange:
    phases = [rng.randint(-400, 400) for _ in range(3)]
    return _read(0x9D, struct.pack("<bhhh", rng.randint(25, 60), *phases))


def _gains(rng: random.Random) -> bytes:
    return struct.pack("<HHH", *(rng.randint(1, 900) for _ in range(3)))


REQUESTS: dict[str, Callable[[str, random.Random], Exchange]] = {
    "on": lambda _, rng: _same(0x88),
    "off": lambda _, rng: _same(0x80),
    "stop": lambda _, rng: _same(0x81),
    "status": _asked_status(0x9A),
    "clear": _asked_status(0x9B),
    "feedback": lambda _, rng: _read(0x9C, _feedback(rng)),
    "phases": _phases,
    "torque": _motion(0xA1, "<Bxxxhxx", (-1500, 1500)),
    "speed": _speed,
    "angle": _motion(0xA4, "<BxHi", (1, 700), (-90_000, 90_000)),
    "turn": _motion(0xA7, "<Bxxxi", (-9_000, 9_000)),
    "encoder": lambda _, rng: _read(0x90, struct.pack("<xHHH", *(rng.randrange(1 << 14) for _ in range(3)))),
    "multi_turn": lambda _, rng: _read(0x92, rng.randint(-(10**6), 10**6).to_bytes(7, "little", signed=True)),
    "at_zero": lambda _, rng: _read(0x92, bytes(7)),
    "single_turn": lambda _, rng: _read(0x94, struct.pack("<xxxI", rng.randrange(36_000))),
    "read_pid": lambda _, rng: _read(0x30, b"\0" + bytes(rng.randint(1, 200) for _ in range(6))),
    "write_pid": lambda _, rng: _same(0x31, b"\0", bytes(rng.randint(1, 200) for _ in range(6))),
    "acceleration": lambda _, rng: _read(0x33, struct.pack("<xxxi", rng.randint(1, 9_000))),
    "brake": lambda _, rng: _read(0x8C, b"", bytes([rng.randint(0, 1)])),
    "speed_with_limit": _motion(0xAD, "<Bxhi", (1, 1500), (-90_000, 90_000)),
    "limits": lambda _, rng: _read(0xB0, struct.pack("<xxi", rng.randint(100, 90_000)), b"\x0e"),
    "gains": lambda _, rng: _read(0xC0, _gains(rng), bytes([rng.choice((0x0A, 0x0B, 0x0C))])),
    "current_ramp": lambda _, rng: _read(0xC0, struct.pack("<xxi", rng.randint(1, 9_000)), b"\x24"),
    "lower_angle": lambda _, rng: _read(0xC0, struct.pack("<xxi", rng.randint(-9_000, 0)), b"\x23"),
}
COMMON = (
    "on",
    "stop",
    "status",
    "feedback",
    "torque",
    "speed",
    "angle",
    "turn",
    "encoder",
    "multi_turn",
    "single_turn",
)
OWN = {
    V235: ("read_pid", "write_pid", "acceleration"),
    V235B: ("brake", "limits", "speed_with_limit", "phases", "clear"),
    V236A: ("gains", "current_ramp", "brake", "phases", "clear"),
    V236C: ("gains", "lower_angle", "brake", "phases", "clear"),
}
"""Requests with which a log identifies its edition; with `COMMON` alone, both editions of v2.36 fit."""


def frames(motors: Iterable[Motor], rounds: int, seed: int) -> Iterator[Frame]:
    """The frames of some rounds: in each, the host asks all motors, one after the other."""
    rng, time = random.Random(seed), START
    asked: dict[Motor, int] = {}
    listed = list(motors)
    for number in range(rounds):
        for motor in listed:
            if not motor.since <= number < motor.until or number % motor.every:
                continue
            turn = asked[motor] = asked.get(motor, -1) + 1
            rest = turn - len(motor.first)
            name = motor.first[turn] if rest < 0 else motor.mix[rest % len(motor.mix)]
            request, reply, voltage = REQUESTS[name](motor.edition, rng)
            from_ = 0x180 if motor.edition.startswith("v2.36") else 0x140
            yield Frame(time, motor.bus, 0x140 + motor.node, request, True, motor)
            time += rng.randint(130, 250)
            yield Frame(time, motor.bus, from_ + motor.node, reply, False, motor, voltage)
            time += rng.randint(130, 900)


def replies(log: Iterable[Frame]) -> list[Frame]:
    """What a recorder has that does not see its own requests."""
    return [frame for frame in log if not frame.is_request]


def dirty(log: Iterable[Frame], seed: int) -> list[Frame]:
    """A log of a host that does not clear its buffer: bytes that are 0 in a request have the values of earlier ones.

    A reply with the same data as its request has the same bytes.
    """
    buffer, changed, asked = random.Random(seed).randbytes(8), [], b""
    for frame in log:
        if frame.is_request:
            asked = frame.data
            buffer = asked[:1] + bytes(new or old for new, old in zip(asked[1:], buffer[1:], strict=True))
        data = buffer if frame.is_request or frame.data == asked else frame.data
        changed.append(replace(frame, data=data))
    return changed


def damaged(log: Iterable[Frame], share: float, seed: int, *, ids: bool = False) -> list[Frame]:
    """A log in which a share of the frames has a flipped bit, in the data or in the id."""
    rng, changed = random.Random(seed), []
    for frame in log:
        if rng.random() < share:
            if ids:
                frame = replace(frame, id=frame.id ^ 1 << rng.randrange(5), is_damaged=True)
            else:
                word = int.from_bytes(frame.data, "little") ^ 1 << rng.randrange(64)
                frame = replace(frame, data=word.to_bytes(8, "little"), is_damaged=True)
        changed.append(frame)
    return changed


def text(log: Iterable[Frame], marks: str = "") -> str:
    """A log of candump, without marks, with R at each frame, or with R and T."""
    return "".join(frame.line({"": "", "R": "R", "RT": "T" if frame.is_request else "R"}[marks]) for frame in log)
