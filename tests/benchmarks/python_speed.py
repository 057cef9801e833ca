"""How fast the Python package decodes, side by side with what else reads the same frame: `python -m tests.benchmarks.python_speed`.

Every figure is a ratio within one run, to `struct.unpack` of the same bytes.
"""

from __future__ import annotations

import importlib
import struct
import sys
import timeit
from collections.abc import Callable
from typing import Any, NamedTuple

import cantools

from ..spec_texts import ROOT

DATA = bytes.fromhex("A1326400F401E803")
ROUNDS = 100_000


class ByHand(NamedTuple):
    """What a careful engineer would write for one reply."""

    temperature: int
    iq: float
    speed: int
    encoder: int


def main() -> None:
    sys.path.insert(0, str(ROOT / "generated/python"))
    v2_35: Any = importlib.import_module("mwd_motor.v2_35")
    unpack = struct.Struct("<xbhhH").unpack
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=18)
    database: Any = cantools.database.load_file(ROOT / "generated/dbc/mwd_motor-v2.35-MG-reply-node1.dbc")
    message = database.get_message_by_frame_id(0x141)

    def by_hand() -> ByHand:
        temperature, iq, speed, encoder = unpack(DATA)
        return ByHand(temperature, iq * 33 / 2048, speed, encoder)

    def with_values() -> object:
        return v2_35.decode_reply(0x141, DATA, known).iq

    reply = v2_35.decode_reply(0x141, DATA, known)
    contestants: dict[str, Callable[[], object]] = {
        "struct.unpack": lambda: unpack(DATA),
        "by hand, one reply, named tuple": by_hand,
        "decode_reply": lambda: v2_35.decode_reply(0x141, DATA, known),
        "decode_reply and one value": with_values,
        "encode": reply.encode,
        "cantools decode": lambda: message.decode(DATA),
    }
    base = 0.0
    for name, contestant in contestants.items():
        seconds = min(timeit.repeat(contestant, number=ROUNDS, repeat=5)) / ROUNDS
        base = base or seconds
        print(f"{name:<34}{seconds * 1e6:8.2f} us {seconds / base:8.1f} x {1 / seconds:12,.0f} a second")


if __name__ == "__main__":
    main()
