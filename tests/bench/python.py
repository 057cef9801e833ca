"""Speed of the generated Python package, beside cantools: `python -m tests.bench.python`.

cantools decodes with one message for each reply, built from the model: no multiplexer, one look-up by the code, and only
the signals of that message. This is its fastest form, and it relies on the caller to choose the message. Encoding is
strict on both sides: values are in units, and a value out of range is rejected.

What cantools cannot do is compared with `by_hand`: a frozen class with slots for one reply, and functions that check what
the package checks.

Both sides run in turns of a few milliseconds of process time. A figure is the median of the ratios of two turns.
"""

from __future__ import annotations

import gc
import importlib
import math
import sys
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import partial
from operator import attrgetter
from statistics import median
from typing import Any

from cantools.database.can import Message as CanMessage, Signal
from cantools.database.conversion import BaseConversion
from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Direction, Message
from canwright.model.types import Encoding, Order, Type
from canwright.project.loader import specification
from canwright.semantics.decoder import linear_of

from ..spec_texts import ROOT
from . import by_hand
from .bars import Measure, report

PACKAGE = ROOT / "generated/python"
SPECS = ROOT / "spec/mwd_motor"
PARAMETERS = {"series": "MG", "encoder_bits": "18"}

TURNS = 201
TURN_SECONDS = 0.004

Work = Callable[[], object]


def main() -> int:
    sys.path.insert(0, str(PACKAGE))
    return report([*_compared_with_cantools(), *_compared_with_code_by_hand(), *_within_the_package()])


def ratio(first: Work, second: Work) -> float:
    """The time of one piece of work in relation to another."""
    counts = [max(1, round(TURN_SECONDS / _seconds(work, 10))) for work in (first, second)]
    return median(_seconds(first, counts[0]) / _seconds(second, counts[1]) for _ in range(TURNS))


def _seconds(work: Work, count: int) -> float:
    """Process time of one repetition."""
    gc.collect(0)
    start = time.process_time_ns()
    for _ in range(count):
        work()
    return max(time.process_time_ns() - start, 1) / count / 1e9


def _compared_with_cantools() -> Iterable[Measure]:
    v2_35: Any = importlib.import_module("mwd_motor.v2_35")
    item = specification(SPECS / "v2.35.yaml")
    assert item.frames is not None
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=18)
    peers = {m.keys[0].value: can_message(m) for m in item.edition.messages(Direction.REPLY) if m.identifying_codes}
    golden = {
        frame.command: frame
        for frame in item.frames.frames
        if frame.direction is Direction.REPLY
        and not frame.decode_only
        and _agree(frame.parameters)
        and frame.data[0] in peers
    }
    frames = [(frame.id, frame.data) for frame in golden.values()]
    with_fields = [(*frame, _reader(v2_35.decode_reply(*frame, known).fields())) for frame in frames]

    for can_id, data in frames:
        _check_peer(v2_35.decode_reply(can_id, data, known), peers[data[0]].decode(data, decode_choices=False))

    def decode() -> None:
        for can_id, data in frames:
            v2_35.decode_reply(can_id, data, known)

    def decode_values() -> None:
        for can_id, data, read in with_fields:
            read(v2_35.decode_reply(can_id, data, known))

    def decode_with_cantools() -> None:
        for _, data in frames:
            peers[data[0]].decode(data)

    yield Measure(
        "decode a mix of replies, speed relative to cantools", ratio(decode_with_cantools, decode), at_least=2.7
    )
    yield Measure(
        "decode and read all values, speed relative to cantools",
        ratio(decode_with_cantools, decode_values),
        at_least=1.4,
    )
    move, torque = v2_35.MoveToAngleAtSpeedRequest, v2_35.SetTorqueRequest
    yield from (
        Measure(
            f"encode 0x{code:02X} from values, speed relative to cantools",
            _encoding(item.edition, code, ours, values),
            at_least=bar,
        )
        for code, bar, ours, values in (
            (0xA4, 4.5, lambda: move(node=1, max_speed=120, angle=90.5).encode(), {"max_speed": 120, "angle": 90.5}),
            (0xA1, 3.5, lambda: torque(node=1, iq=2.5, parameters=known).encode(), {"iq": 2.5}),
        )
    )


def _encoding(edition: Edition, code: int, ours: Callable[[], bytes], values: Mapping[str, float]) -> float:
    """The speed of encoding values, relative to cantools."""
    message = next(m for m in edition.messages(Direction.REQUEST) if m.keys and m.keys[0].value == code)
    peer = can_message(message)
    filled = {signal.name: values.get(signal.name, code if signal.name == SELECTOR else 0) for signal in peer.signals}
    assert ours() == peer.encode(filled, strict=True)
    return ratio(lambda: peer.encode(filled, strict=True), ours)


def _compared_with_code_by_hand() -> Iterable[Measure]:
    v2_35, nodes = (importlib.import_module(f"mwd_motor.{name}") for name in ("v2_35", "nodes"))
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=18)
    request = v2_35.SetTorqueRequest(node=1, iq=2.5, parameters=known)
    reply = bytes.fromhex("A1 32 9B 00 F4 01 00 40")
    bus = nodes.Nodes([nodes.Node(v2_35, 1, known)])

    def values() -> dict[str, float]:
        return {"temperature": 50, "iq": 2.5, "speed": 100, "encoder": 90}

    ours = v2_35.SetTorqueReply(node=1, parameters=known, **values())
    theirs = by_hand.TorqueReply.of(1, **values())
    assert (ours.encode(), ours.iq) == (theirs.data(), theirs.iq)
    decoded = v2_35.decode_answer(request, 0x141, reply, known)
    assert (decoded.iq, decoded.speed) == (by_hand.decode(0x141, reply).iq, by_hand.decode(0x141, reply).speed)

    for name, asked in (("a request", request), ("a class of requests", v2_35.SetTorqueRequest)):
        yield Measure(
            f"`decode_answer` of {name}, time relative to `decode_reply`",
            ratio(
                partial(v2_35.decode_answer, asked, 0x141, reply, known),
                partial(v2_35.decode_reply, 0x141, reply, known),
            ),
            at_most=2,
        )
    refused = {
        "a foreign id": (0x300, reply),
        "another code": (0x141, b"\xff" + reply[1:]),
        "another length": (0x141, reply[:7]),
    }
    for name, frame in refused.items():
        yield Measure(
            f"refuse {name}, time relative to code by hand",
            ratio(_refusing(v2_35.decode_reply, *frame), _refusing(by_hand.decode, *frame)),
            at_most=3,
        )
    for name, can_id in (("a foreign id", 0x300), ("another node", 0x142)):
        yield Measure(
            f"refuse {name} by `Nodes`, time relative to code by hand",
            ratio(_refusing(bus.decode_reply, can_id, reply), _refusing(by_hand.decode, 0x300, reply)),
            at_most=3,
        )
    yield Measure(
        "make a reply from values, time relative to code by hand",
        ratio(
            lambda: v2_35.SetTorqueReply(node=1, parameters=known, **values()),
            lambda: by_hand.TorqueReply.of(1, **values()),
        ),
        at_most=3,
    )
    node = nodes.Node(v2_35, 1, known)
    yield Measure(
        "`Node.make`, time relative to the constructor",
        ratio(
            lambda: node.make(v2_35.SetTorqueRequest, iq=2.5),
            lambda: v2_35.SetTorqueRequest(node=1, iq=2.5, parameters=known),
        ),
        at_most=2,
    )


def _refusing(decode: Callable[[int, bytes], object], can_id: int, data: bytes) -> Work:
    """Decodes a frame that is refused, as a program that skips it does."""

    def work() -> None:
        try:
            decode(can_id, data)
        except ValueError:
            return
        raise AssertionError(f"0x{can_id:X} was decoded")

    return work


def _within_the_package() -> Iterable[Measure]:
    names = ("v2_35", "v2_36_2024_11", "nodes")
    v2_35, v2_36, nodes = (importlib.import_module(f"mwd_motor.{name}") for name in names)
    known = v2_36.Parameters(series=v2_36.Series.MG, encoder_bits=16)
    plain, nested = bytes.fromhex("9A 32 60 09 96 00 00 00"), bytes.fromhex("C0 0A 10 00 20 00 30 00")
    yield Measure(
        "reply with a second selector, time relative to a plain reply",
        ratio(lambda: v2_36.decode_reply(0x181, nested, known), lambda: v2_36.decode_reply(0x181, plain, known)),
        at_most=1.5,
    )
    bus = nodes.Nodes([nodes.Node(v2_36, 1, known), nodes.Node(v2_35, 2)])
    yield Measure(
        "`Nodes` with two editions, time relative to one module",
        ratio(lambda: bus.decode_reply(0x181, plain), lambda: v2_36.decode_reply(0x181, plain, known)),
        at_most=1.6,
    )
    feedback = bytes.fromhex("A1 32 9B 00 F4 01 00 40")
    first, second = (v2_36.decode_reply(0x181, feedback, known) for _ in range(2))
    yield Measure(
        "`==` of equal messages, time relative to one decode",
        ratio(lambda: first == second, lambda: v2_36.decode_reply(0x181, feedback, known)),
        at_most=0.5,
    )


def _check_peer(message: Any, decoded: Any) -> None:
    """Both sides read the same values."""
    ours = {name: getattr(message, name) for name in message.fields()}
    assert decoded.keys() == ours.keys()
    assert all(math.isclose(value, decoded[name]) for name, value in ours.items())


def _reader(fields: Iterable[str]) -> Callable[[object], object]:
    """The function that reads all values of a message; its class if there are none."""
    names = tuple(fields)
    return attrgetter(*names) if names else type


def _agree(parameters: Mapping[str, int | str | Fraction]) -> bool:
    return all(str(value) == PARAMETERS.get(name, str(value)) for name, value in parameters.items())


SELECTOR = "selector"
"""The signal of the code."""


def can_message(message: Message) -> CanMessage:
    """A message of cantools with the fields of a message of the model; a request has a signal for its code too."""
    variant = message.layout.variant(PARAMETERS)
    assert variant is not None
    signals = [signal for field in variant.fields for signal in _signals(field)]
    if message.keys and message.direction is Direction.REQUEST:
        signals.append(Signal(SELECTOR, message.keys[0].segments[0].byte * 8, message.keys[0].width))
    return CanMessage(message.id.base, message.name, message.dlc, signals, strict=True)


def _signals(field: Field) -> Iterable[Signal]:
    """A signal for each element of a field."""
    type_ = field.type
    assert type_.order is Order.LITTLE
    limits = type_.raw_range.at(PARAMETERS)
    low, high = (limits.low.constant, limits.high.constant) if limits else type_.raw_limits
    for element in field.elements:
        name = field.name if element.index is None else f"{field.name}_{element.index}"
        conversion = _conversion(type_)
        yield Signal(
            name,
            element.segments[0].byte * 8 + element.segments[0].low,
            type_.width,
            is_signed=type_.encoding is Encoding.SIGNED,
            conversion=conversion,
            minimum=_number(conversion, low),
            maximum=_number(conversion, high),
        )


def _number(conversion: BaseConversion, raw: int | Fraction) -> float:
    """The value of a raw integer."""
    value = conversion.raw_to_scaled(int(raw), decode_choices=False)
    assert isinstance(value, int | float)
    return value


def _conversion(type_: Type) -> BaseConversion:
    linear = linear_of(type_, PARAMETERS)
    scale, offset = (linear.scale, linear.offset) if linear else (1, 0)
    return BaseConversion.factory(
        scale=int(scale) if scale == int(scale) else float(scale),
        offset=int(offset) if offset == int(offset) else float(offset),
        choices=OrderedDict((member.value, member.name) for member in type_.enum) or None,
    )


if __name__ == "__main__":
    sys.exit(main())
