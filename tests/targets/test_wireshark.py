"""The generated dissector without Wireshark: directions of simulated traffic, settings as texts, numbers."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.recordings.log_frame import LogFrame
from canwright.semantics.frame import CanFrame
from canwright.targets.wireshark import text
from canwright.targets.wireshark.family import Filters
from lupa import lua52, lua54

from ..recordings import motor_bus
from ..recordings.traffic import MIXES, Loss, Sent, Traffic, with_marks
from ..samples import sampled
from ..spec_texts import ROOT
from .dissector import decoder, judge

BARS = {Loss(0.01): 0.1, Loss(0.1, has_retries=True): 0.3}
"""The allowed share of wrong directions without marks, in percent."""


def wrong(spec: str, log: Sequence[Sent], *, stated: bool = False) -> float:
    """The share of wrong directions in percent; of those that are `stated`, not only assumed."""
    judged = zip(judge(_edition(spec), [sent.recorded for sent in log]), log, strict=True)
    count: int = sum(
        result.direction != sent.direction.value and not (stated and result.rule == "assumed")
        for result, sent in judged
    )
    return 100 * count / len(log)


@pytest.mark.parametrize("spec", ["spec/mwd_motor/v2.35.yaml", "tests/specs/joint/v1.yaml"])
@pytest.mark.parametrize("loss", BARS, ids=str)
def test_directions_without_marks(spec: str, loss: Loss) -> None:
    shares = [wrong(spec, Traffic(_edition(spec), mix, 1, loss=loss).frames(700)) for mix in MIXES]
    assert max(shares) <= BARS[loss], shares


@pytest.mark.parametrize(("name", "mix"), sampled([*itertools.product(motor_bus.SITUATIONS, motor_bus.MIXES)], 2))
def test_hosts_recorders_and_motors_of_any_behaviour(name: str, mix: str) -> None:
    """Nothing is learned of them, so their frames can be wrong; but then their direction is only assumed."""
    log = motor_bus.MotorBus(mix, motor_bus.SITUATIONS[name], 1).frames(800)
    is_hard = mix == "mixed" and ("doubled" in name or "reordered" in name)
    assert wrong("spec/mwd_motor/v2.35.yaml", log, stated=True) <= (8 if is_hard else 0.1)


@pytest.mark.parametrize("mix", motor_bus.MIXES)
def test_few_directions_of_a_usual_bus_are_only_assumed(mix: str) -> None:
    """Those of requests without reply, and none is wrong."""
    log = motor_bus.MotorBus(mix, motor_bus.SITUATIONS["clean, 1 % lost"], 1).frames(800)
    judged = judge(_edition("spec/mwd_motor/v2.35.yaml"), [sent.recorded for sent in log])
    assert sum(result.rule == "assumed" for result in judged) <= len(log) / 100
    assert wrong("spec/mwd_motor/v2.35.yaml", log) == 0


def test_directions_with_marks_once_a_node_has_both() -> None:
    spec = "spec/mwd_motor/v2.35.yaml"
    log = with_marks(
        Traffic(_edition(spec), "mixed", 1, loss=Loss(0.1, has_retries=True, not_recorded=0.1)).frames(500)
    )
    judged = judge(_edition(spec), [sent.recorded for sent in log])
    marked = [(result, sent) for result, sent in zip(judged, log, strict=True) if result.rule == "mark"]
    assert len(marked) > len(log) - 40
    assert all(result.direction == sent.direction.value for result, sent in marked)


def test_requests_and_latencies_are_those_of_the_recordings() -> None:
    spec = "spec/mwd_motor/v2.35.yaml"
    log = [sent.recorded for sent in Traffic(_edition(spec), "mixed", 2).frames(300)]
    wanted = [(result.request, result.latency, result.node) for result in Directions({}, _edition(spec)).classify(log)]
    actual = [
        (result.request, result.latency and int(result.latency), result.node) for result in judge(_edition(spec), log)
    ]
    assert actual == wanted
    assert sum(request is not None for request, _, _ in wanted) > 200


NODES_IN_DATA = (
    *((0x7E5, "100000 05 00000000", 5, None), (0x7E5, "100000 07 00000000", 7, None)),  # both are open at once
    *((0x407, "1000000000000001", 7, 1), (0x405, "1000000000000001", 5, 0)),
    *((0x7E6, "11 25 000000000000", 37, None), (0x7E4, "11 50 000002010000", 37, 4)),  # the low four bits of 37
    (0x7E4, "11 50 000002010000", None, None),
)


def test_the_node_in_the_data() -> None:
    """It distinguishes requests to one id; the low bits in a reply are those of the node of the request."""
    log = [
        LogFrame(i * 100_000, "", CanFrame(can_id, bytes.fromhex(data)), None)
        for i, (can_id, data, *_) in enumerate(NODES_IN_DATA)
    ]
    judged = judge(_edition("tests/specs/valve/v1.yaml"), log)
    actual = [(result.node, result.request) for result in judged]
    assert actual == [(node, request) for *_, node, request in NODES_IN_DATA]


def _edition(spec: str) -> Edition:
    return specification(ROOT / spec).edition


@pytest.mark.parametrize("given", ['"', "\\", "\n", "]]--", "\0", "电流 °C", "\u202e"])
def test_a_text_is_a_literal(given: str) -> None:
    literal = text.quoted(given)
    assert literal.isascii()
    for runtime in (lua52.LuaRuntime, lua54.LuaRuntime):
        assert runtime().eval(literal) == given


@pytest.mark.parametrize(
    ("given", "wanted"), [("3.5", Fraction(7, 2)), ("-2", -2), ("1/3", Fraction(1, 3)), ("0.25", 0.25)]
)
def test_number_parameters(given: str, wanted: Fraction) -> None:
    number = decoder(_edition("tests/specs/arm/v1.yaml")).codec.rational(given)
    assert Fraction(int(number.numerator), int(number.denominator)) == wanted


@pytest.mark.parametrize("given", ["", "x", "1/0", "1e5", "1 2", "nan"])
def test_texts_that_are_no_numbers(given: str) -> None:
    assert decoder(_edition("tests/specs/arm/v1.yaml")).codec.rational(given) is None


def test_a_field_has_one_kind_in_all_editions() -> None:
    editions = [_edition(f"spec/mwd_motor/{name}.yaml") for name in ("v2.35", "v2.36-2025-03")]
    fields: list[Any] = list(Filters(editions).fields)
    kinds = {field["name"]: field["kind"] for field in fields}
    assert kinds["voltage"] == "double" and kinds["motor_state"] == "uint32" and kinds["iq"] == "double"


def test_numbers_have_their_names_beside_the_value() -> None:
    lua = decoder(_edition("tests/specs/pump/v1.yaml"))
    message = lua.message(Direction.REQUEST, "set_duty")
    names = {"000186A0": "full", "FFFE7960": "backwards", "00000000": "still", "00000001": None}
    for data, name in names.items():
        frame = lua.frame(CanFrame(0, bytes.fromhex(data), True, False))
        (item,) = lua.codec.decode(message, frame, lua.parameters({})).values()
        assert (item.name_of_number, item.value) == (
            name,
            int.from_bytes(bytes.fromhex(data), "big", signed=True) / 100000,
        )
