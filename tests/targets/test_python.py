"""The Python package beyond the golden frames: types, errors, names, and what a spec's text can do."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from functools import partial
from pathlib import Path
from types import ModuleType

import pytest
from canwright.conformance.python import load
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.targets.python.target import PythonTarget
from canwright.targets.python.text import class_name

from ..spec_texts import MINIMAL, ROOT, SPECS

SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"


def write(folder: Path, spec: Path) -> Path:
    for output in PythonTarget().generate([specification(spec)], {}):
        file = folder / output.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(output.text, "utf-8")
    return folder


@pytest.fixture(scope="module")
def v2_35(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    return load(write(tmp_path_factory.mktemp("python"), SPEC), specification(SPEC).edition)


MATCH = """\
from typing_extensions import assert_never
from mwd_motor import v2_35
from mwd_motor.nodes import Node, Nodes

def dispatch(data: bytes, bus: Nodes[v2_35.AnyRequest, v2_35.AnyReply]) -> float:
    reply = v2_35.decode_reply(0x141, data)
    match reply:
        case v2_35.MotionFeedback():
            return reply.speed
        CASES
        case _:
            assert_never(reply)

def of_node(data: bytes) -> v2_35.AnyReply:
    return Node(v2_35, 1).decode_reply(0x141, data)
"""

CLIENT = """\
import can
from mwd_motor import v2_35
from mwd_motor.client import Client
from mwd_motor.nodes import Node

def ask(bus: can.BusABC) -> None:
    with Client(bus, [Node(v2_35, 1, known)], allow="motion") as client:
        speeds: list[int] = [outcome.get().speed for outcome in client.cycle([request])]
        assert speeds
        print(client.request(request).{field})
"""


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(
            ("mypy", "--strict", "--warn-unreachable", "--no-incremental", "."),
            marks=pytest.mark.interop("mypy"),
        ),
        pytest.param(
            ("basedpyright", "--level", "error", "--pythonpath", sys.executable),
            marks=pytest.mark.interop("basedpyright"),
        ),
    ],
    ids=lambda command: command[0],
)
def test_type_checkers_find_a_missing_case_and_nothing_else(command: tuple[str, ...], tmp_path: Path) -> None:
    write(tmp_path, SPEC)
    use = tmp_path / "use.py"
    use.write_text(
        "from typing import Literal\n"
        "from mwd_motor.v2_35 import (CodecError, MotionFeedback, Parameters, Refusal, Reply, ReadEncoderReply, ReadEncoderRequest, Series,\n"
        "    SetTorqueRequest, decode_answer, decode_reply)\n"
        "known = Parameters(series=Series.MG, encoder_bits=18)\n"
        "request = SetTorqueRequest(node=1, iq=2.5, parameters=known)\n"
        "data: bytes = request.encode()\n"
        "reply = decode_reply(0x141, data, known)\n"
        "if isinstance(reply, MotionFeedback):\n"
        "    amperes: float = reply.iq\n"
        "answer: ReadEncoderReply = decode_answer(ReadEncoderRequest, 0x141, data, known)\n"
        "counts: int = answer.encoder_raw\n"
        "assert isinstance(answer, Reply)\n"
        "try:\n"
        "    SetTorqueRequest(node=1, iq=40, parameters=known)\n"
        "except CodecError as error:\n"
        "    out: bool = error.refusal is Refusal.OUT_OF_RANGE\n"
        "changed: SetTorqueRequest = request.replace(iq=1)\n"
        "bits: Literal[14, 15, 18] | None = known.encoder_bits\n"
        "unit: str = SetTorqueRequest.TYPES['iq'].unit\n"
        "match request:\n"
        "    case SetTorqueRequest(current):\n"
        "        value: float = current\n" + CLIENT.format(field="speed")
    )
    (tmp_path / "wrong.py").write_text("from use import request, known\n" + CLIENT.format(field="sped"))
    replies = [m for m in specification(SPEC).edition.messages(Direction.REPLY) if m.identifying_codes or not m.keys]
    names = [class_name(m.name) for m in replies if m.layout.name != "motion_feedback"]
    for name, cases in (("complete", names), ("incomplete", names[1:])):
        listed = " | ".join(f"v2_35.{reply}()" for reply in cases)
        (tmp_path / f"{name}.py").write_text(MATCH.replace("CASES", f"case {listed}: return 0"))
    (tmp_path / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict", "pythonVersion": "3.10"}')
    result = subprocess.run([sys.executable, "-m", *command], cwd=tmp_path, capture_output=True, text=True, check=False)
    errors = [line for line in result.stdout.splitlines() if " error: " in line]
    misuses = [line for line in errors if "wrong.py:11" in line]
    errors = [line for line in errors if line not in misuses]
    assert len(errors) == 1, result.stdout + result.stderr
    assert "incomplete.py:12" in errors[0] and "assert_never" in errors[0] and names[0] in result.stdout
    assert "sped" in "".join(misuses)


def test_a_constructor_says_field_value_and_range(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MG)
    with pytest.raises(ValueError) as caught:
        v2_35.SetTorqueRequest(node=1, iq=40, parameters=known)
    assert str(caught.value) == "iq=40 A is out of range -33.0..33.0 A (raw -2048..2048)"
    with pytest.raises(ValueError, match=r"there is no node 33; nodes are 1\.\.32"):
        v2_35.MotorOffRequest(node=33)
    with pytest.raises(ValueError, match=r"iq depends on series, which is not given"):
        v2_35.SetTorqueRequest(node=1, iq=1)
    with pytest.raises(ValueError, match=r"iq has no scale here; use iq_raw"):
        v2_35.SetTorqueRequest(node=1, iq=1, parameters=v2_35.Parameters(series=v2_35.Series.MH))


def test_a_field_of_another_series_is_absent(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MS, encoder_bits=15)
    reply = v2_35.decode_reply(0x141, bytes.fromhex("A2196400F4010040"), known)
    assert (reply.power, reply.speed, reply.temperature) == (100, 500, 25)
    with pytest.raises(AttributeError, match="it has temperature, power, speed, encoder"):
        _ = reply.iq
    with pytest.raises(AttributeError, match="has no attribute 'sped'"):
        _ = reply.sped
    with pytest.raises(TypeError, match="needs power"):
        v2_35.SetSpeedReply(node=1, temperature=1, speed=1, encoder=1, parameters=known)
    with pytest.raises(AttributeError, match="has no iq"):
        v2_35.SetSpeedReply(node=1, temperature=1, power=1, iq=1, speed=1, encoder=1, parameters=known)


def test_decoding_and_encoding_back_is_lossless_even_out_of_range(v2_35: ModuleType) -> None:
    data = bytes.fromhex("A1000000C4090000")
    message = v2_35.decode_request(0x141, data, v2_35.Parameters(series=v2_35.Series.MG))
    assert message.iq_raw == 2500
    assert message.encode_unchecked() == data


def test_a_value_out_of_range_is_named(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=14)
    reply = v2_35.decode_reply(0x141, bytes.fromhex("A1 32 9B 00 F4 01 00 80"), known)
    expected = {"encoder": "encoder=raw 32768 is out of range 0.0..359.97802734375 deg (raw 0..16383)"}
    assert reply.out_of_range() == expected
    assert "encoder=720.0, out_of_range=('encoder',), parameters=" in repr(reply)
    assert list(v2_35.decode_reply(0x141, bytes.fromhex("A1 32 88 13 F4 01 00 00"), known).out_of_range()) == ["iq"]
    assert reply.replace(encoder=180).out_of_range() == {}
    assert "out_of_range" not in repr(reply.replace(encoder=180))


@pytest.mark.parametrize(
    ("angle", "raw"), [(0.29, 29), (-0.29, -29), (0.57, 57), (1.005, 100), (0.005, 1), (-0.005, -1), (359.99, 35999)]
)
def test_values_round_to_the_nearest_raw_integer(v2_35: ModuleType, angle: float, raw: int) -> None:
    assert v2_35.MoveToAngleRequest(node=1, angle=angle).angle_raw == raw


@pytest.mark.parametrize(("value", "raw"), [(0.5, 1), (-0.5, -1), (2.5, 3), (-2.5, -3), (0.49999999999999994, 0)])
def test_ties_go_away_from_zero(v2_35: ModuleType, value: float, raw: int) -> None:
    request = v2_35.WriteAccelerationRamRequest(node=1, acceleration=value)
    assert request.acceleration_raw == raw


def test_messages_read_well_and_compare(v2_35: ModuleType) -> None:
    request = v2_35.MoveToAngleAtSpeedRequest(node=20, max_speed=120, angle=-180)
    assert repr(request) == "MoveToAngleAtSpeedRequest(node=20, max_speed=120, angle=-180.0)"
    assert request == v2_35.decode_request(request.can_id, request.encode())
    assert len({request, v2_35.decode_request(request.can_id, request.encode())}) == 1
    assert request != v2_35.MoveToAngleAtSpeedRequest(node=20, max_speed=120, angle=180)
    answer = v2_35.decode_answer(v2_35.ClearErrorsRequest, 0x141, bytes.fromhex("9A1900F000000009"))
    assert repr(answer.errors) == repr(v2_35.ErrorFlags.LOW_VOLTAGE | v2_35.ErrorFlags.OVER_TEMPERATURE)


def test_equal_messages_have_equal_values_and_limits(v2_35: ModuleType) -> None:
    """A parameter on which nothing of a message depends does not matter; one of its values is not that of another."""
    series = v2_35.Series
    make = partial(v2_35.SetTorqueRequest.from_raw, node=1, iq=155)
    known = [v2_35.Parameters(series=series.MG), v2_35.Parameters(series=series.MF), v2_35.UNKNOWN]
    messages = [make(parameters=parameters) for parameters in known]
    assert len(set(messages)) == 3 and messages[0] != messages[1] != messages[2] != messages[0]
    same = make(parameters=v2_35.Parameters(series=series.MG, encoder_bits=18))
    assert same == messages[0] and hash(same) == hash(messages[0])
    assert same.replace(parameters=known[1]) == messages[1]
    data = bytes.fromhex("A0190000F4010040")
    limits = [v2_35.Parameters(series=series.MS, encoder_bits=bits) for bits in (14, 15)]
    assert v2_35.decode_reply(0x141, data, limits[0]) != v2_35.decode_reply(0x141, data, limits[1])
    assert v2_35.decode_request(0x141, bytes([0x80, *bytes(7)]), known[0]) == v2_35.MotorOffRequest(node=1)


def test_a_message_shows_the_parameters_on_which_it_depends(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MS, encoder_bits=15, gear_ratio=10)
    assert repr(known) == "Parameters(series=Series.MS, encoder_bits=15, gear_ratio=10)"
    assert repr(v2_35.UNKNOWN) == "Parameters()"
    reply = v2_35.decode_reply(0x141, bytes.fromhex("A0190000F4010040"), known)
    assert repr(reply).endswith(", parameters=Parameters(series=Series.MS, encoder_bits=15))")
    request = v2_35.decode_request(0x141, bytes.fromhex("A1000000C4090000"), v2_35.Parameters(encoder_bits=15))
    assert repr(request) == "SetTorqueRequest(node=1, iq_raw=2500, out_of_range=('iq',))"


def test_a_pattern_by_position_matches_whatever_the_parameters_are(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=18)
    match v2_35.decode_reply(0x141, bytes.fromhex("A1190000F4010040"), known):
        case v2_35.MotionFeedback(temperature, speed, encoder):
            assert (temperature, speed, encoder) == (25, 500, 90)
        case unmatched:
            raise AssertionError(unmatched)


def test_flags_without_a_name_are_kept_and_shown(v2_35: ModuleType) -> None:
    named = v2_35.ErrorFlags.LOW_VOLTAGE | v2_35.ErrorFlags.OVER_TEMPERATURE
    reply = v2_35.decode_reply(0x141, bytes.fromhex("9A1900F0000000F9"))
    assert reply.errors == reply.errors_raw == 0xF9 and reply.errors & named == named
    assert "LOW_VOLTAGE" in repr(reply.errors) and "240" in repr(reply.errors)
    assert reply.encode_unchecked()[7] == 0xF9
    with pytest.raises(v2_35.CodecError, match="errors=0xF9 sets bits without a name; the named ones are 0x9"):
        reply.encode()


HOSTILE = (
    '""" + __import__("os").system("x") + """',
    "back\\slash \\N{BULLET} \\u202e",
    "quotes ' \" ''' end",
    "{{ 7 * 7 }} {% raw %} {# #}",
    "new\\nline\\r",
    "# */ // --> <script>",
)


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_stay_texts(tmp_path: Path, text: str) -> None:
    quoted = "'" + text.replace("'", "''") + "'"
    spec = tmp_path / "spec.yaml"
    trees: list[str] = []
    for written in ("plain", quoted):
        about = f"    title: {written}\n    about: {written}\n    notes: [{written}]\n"
        spec.write_text(f"title: {written}\nabout: {written}\n" + MINIMAL.replace('    manual: "1"\n', about), "utf-8")
        folder = write(tmp_path / str(len(trees)), spec)
        trees.append(_without_strings(ast.parse((folder / "lamp/v1.py").read_text("utf-8"))))
    assert trees[0] == trees[1]


def test_an_edition_that_says_no_more_than_its_title_has_a_docstring_of_one_line(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(f"title: Desk lamps\n{MINIMAL}", "utf-8")
    written = (write(tmp_path, spec) / "lamp/v1.py").read_text("utf-8")
    assert written.splitlines()[1:3] == ['"""lamp v1: Desk lamps"""', ""]


def _without_strings(tree: ast.AST) -> str:
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)


def test_ruff_finds_nothing_unused_or_undefined(tmp_path: Path) -> None:
    for spec in SPECS:
        write(tmp_path / spec.parent.name, spec)
    command = (sys.executable, "-m", "ruff", "check", "--isolated", "--select", "F", str(tmp_path))
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_a_parameter_that_cannot_be_is_refused(v2_35: ModuleType, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="encoder_bits=16 is none of 14, 15, 18; leave it out when it is not known"):
        v2_35.Parameters(encoder_bits=16)
    with pytest.raises(ValueError, match="series='XX' is none of MS, MF, MH, MG"):
        v2_35.Parameters(series="XX")
    assert v2_35.Parameters(series="MG").series == v2_35.Series.MG
    spec = tmp_path / "spec.yaml"
    spec.write_text(MINIMAL + "parameters: {size: {number: {min: 1/2, max: 8}}}\n", "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    assert (lamp.Parameters(size=0.5).size, lamp.Parameters(size=8).size) == (0.5, 8)
    for wrong in (0, 9, -1):
        with pytest.raises(ValueError, match=f"size={wrong} has to be at least 1/2 and at most 8"):
            lamp.Parameters(size=wrong)
    with pytest.raises(ValueError, match="size=nan is not a finite number"):
        lamp.Parameters(size=float("nan"))
    with pytest.raises(TypeError, match="size='4' is no number"):
        lamp.Parameters(size="4")
    for large in (10**400, Fraction(10) ** 400, -(Fraction(10) ** 5000)):
        with pytest.raises(ValueError, match="size is larger than any float"):
            lamp.Parameters(size=large)


def test_an_id_of_the_other_format_is_named(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text(MINIMAL.replace("nodes: 1..4", "nodes: 1..4, extended: true"), "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    data = bytes([0x10, 0, 1, 0, 0, 0, 0, 0])
    said = "no request has the id 0x101; with extended=True there is one"
    with pytest.raises(lamp.CodecError, match=f"^{said}$") as refused:
        lamp.decode_request(0x101, data)
    assert refused.value.refusal is lamp.Refusal.UNKNOWN_ID
    assert lamp.decode_request(0x101, data, extended=True).node == 1
    with pytest.raises(
        lamp.CodecError, match=r"^no reply has the remote id 0x101; with extended=True, remote=False there"
    ):
        lamp.decode_reply(0x101, data, remote=True)
    with pytest.raises(lamp.CodecError, match=r"^no request has the 29-bit id 0x100$"):
        lamp.decode_request(0x100, data, extended=True)


ENUM_AND_FLAGS = MINIMAL.replace(
    'level: {raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}',
    "level: {raw: u8, enum: {dim: 0, bright: 1}}\n  faults: {raw: u8, flags: {hot: 0}}",
).replace("level: {at: 2, type: level}", "level: {at: 2, type: level}, faults: {at: 3, type: faults}")


NAMES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100}}
types:
  power: {raw: u16, unit: "%", scale: 0.1, range: 0..100, names: {stopped: 0, maximum: 1000}, no_value: {lost: 0xFFFF}}
  steps: {raw: u8, names: {few: 3}}
commands:
  dim: {request: {power: {at: 0, type: power}, steps: {at: 2, type: steps, array: 1..3}}, reply: none}
"""
"""10 % are raw 100 = 0x64, 100 % are raw 1000 = 0x03E8."""


def test_numbers_have_names_beside_their_values(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(NAMES, "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    dim = lamp.DimRequest(power="maximum", steps=["few", 4, 3])
    assert dim.encode() == bytes.fromhex("E8 03 03 04 03 00 00 00")
    assert dim == lamp.DimRequest(power=100, steps=[3, 4, "few"])
    assert dim.values() == {"power": 100.0, "steps": (3, 4, 3)}
    assert dim.names() == {"power": "maximum", "steps": ("few", None, "few")}
    assert (dim.no_values(), repr(dim)) == ({}, "DimRequest(power=100.0, steps=(3, 4, 3))")
    plain = lamp.decode_request(0x100, bytes.fromhex("64 00 01 02 04 00 00 00"))
    assert (plain.values(), plain.names()) == ({"power": 10.0, "steps": (1, 2, 4)}, {})
    lost = lamp.DimRequest(power="lost", steps=[0, 0, 0])
    assert (lost.values()["power"], lost.names(), lost.no_values()) == (None, {}, {"power": "lost"})
    assert lamp.DimRequest.TYPES["power"].names == {"stopped": 0, "maximum": 1000}
    doc = lamp.DimRequest.power.__doc__
    assert doc and "names: stopped (raw 0), maximum (raw 1000)" in " ".join(doc.split())
    for given, names in (
        ({"power": "off", "steps": [3, 3, 3]}, "stopped, maximum, lost"),
        ({"power": 0, "steps": ["on", 3, 3]}, "few"),
    ):
        with pytest.raises(lamp.CodecError, match=f"is no number and none of the names {names}$") as error:
            lamp.DimRequest(**given)
        assert error.value.refusal is lamp.Refusal.OUT_OF_RANGE


def test_type_checkers_know_which_numbers_have_names(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    text = NAMES.replace(", array: 1..3}", "}, other: {at: 3, type: other}").replace(
        "types:", "types:\n  other: {raw: u8}"
    )
    spec.write_text(text, "utf-8")
    (tmp_path / "program.py").write_text(
        "from lamp.v1 import DimRequest\n"
        'power: float | None = DimRequest(power="maximum", steps="few", other=1).power\n'
        'DimRequest(power=None, steps=1, other="few")\n',
        "utf-8",
    )
    write(tmp_path, spec)
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "program.py"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False).stdout
    assert said.count("error:") == 1 and 'program.py:3: error: Argument "other"' in said


@pytest.mark.parametrize("wrong", [0.5, "dim", None])
def test_a_value_that_is_no_integer_is_shown_unchanged(wrong: object, tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(ENUM_AND_FLAGS, "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    for field in ("level", "faults"):
        with pytest.raises(TypeError, match=f"^{field}={wrong!r} is no integer$"):
            lamp.DimRequest(node=1, **{"level": 0, "faults": 0, field: wrong})
    if wrong is not None:
        with pytest.raises(TypeError, match=f"^node={wrong!r} is no integer$"):
            lamp.DimRequest(node=wrong, level=0, faults=0)


def test_one_value_in_place_of_an_array_is_named(v2_35: ModuleType) -> None:
    message = v2_35.BroadcastTorqueRequest(iq=(1, 2, 3, 4))
    for make in (v2_35.BroadcastTorqueRequest, v2_35.BroadcastTorqueRequest.from_raw, message.replace):
        for wrong in (1, None):
            with pytest.raises(TypeError, match=f"^iq={wrong} is no array; it needs 4 elements$"):
                make(iq=wrong)


def test_what_is_no_number_is_refused_and_what_is_too_large_is_out_of_range(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MG)
    for wrong in ("2.5", None, [1]):
        with pytest.raises(TypeError, match=r"iq=.* is no number"):
            v2_35.SetTorqueRequest(node=1, iq=wrong, parameters=known)
    for large in (10**400, Fraction(10**400), 1e308):
        with pytest.raises(v2_35.CodecError, match="out of range") as caught:
            v2_35.SetTorqueRequest(node=1, iq=large, parameters=known)
        assert caught.value.refusal is v2_35.Refusal.OUT_OF_RANGE
    with pytest.raises(TypeError):
        v2_35.MotorOffRequest(node=1.5)
    with pytest.raises(TypeError):
        v2_35.SetTorqueRequest.from_raw(node=1, iq=1.5)


def test_a_shared_layout_is_no_frame_of_its_own(v2_35: ModuleType) -> None:
    known = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=14)
    values = {"temperature": 1, "iq": 1, "speed": 1, "encoder": 1}
    for make in (v2_35.MotionFeedback, v2_35.MotionFeedback.from_raw):
        with pytest.raises(
            TypeError, match="MotionFeedback is only a base class; use the class of a request or a reply"
        ):
            make(node=1, parameters=known, **values)


def test_messages_and_errors_go_from_process_to_process(tmp_path: Path) -> None:
    program = (
        "import copy, pickle\n"
        "from mwd_motor.v2_35 import CodecError, MoveToAngleRequest\n"
        "request = MoveToAngleRequest(node=1, angle=90)\n"
        "assert copy.deepcopy(request) == pickle.loads(pickle.dumps(request)) == request\n"
        "try:\n"
        "    MoveToAngleRequest(node=1, angle=1e9)\n"
        "except CodecError as error:\n"
        "    again = pickle.loads(pickle.dumps(error))\n"
        "    assert (str(again), again.refusal, again.field) == (str(error), error.refusal, 'angle')\n"
    )
    folder = write(tmp_path, SPEC)
    result = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_facts_for_tools_stand_on_every_class(v2_35: ModuleType) -> None:
    assert v2_35.SetTorqueRequest.ONLY == {"series": (v2_35.Series.MF, v2_35.Series.MH, v2_35.Series.MG)}
    assert v2_35.SetTorqueRequest.EFFECTS == ("moves",)
    for message in (v2_35.ReadEncoderRequest, v2_35.SetTorqueReply, v2_35.Message):
        assert (message.ONLY, message.EFFECTS) == ({}, ())


def test_a_request_that_the_node_lacks_is_refused(v2_35: ModuleType) -> None:
    """By every way to make one; a frame of another sender is decoded."""
    lacking, unknown = v2_35.Parameters(series=v2_35.Series.MF), v2_35.Parameters(encoder_bits=18)
    request, codec = v2_35.SetPowerRequest, v2_35.CodecError
    decoded = v2_35.decode_request(0x141, bytes.fromhex("A0000000C8000000"), lacking)
    ways: list[Callable[[], object]] = [
        lambda: request(node=1, power=200, parameters=lacking),
        lambda: request.from_raw(node=1, power=200, parameters=lacking),
        lambda: request(node=1, power=200).replace(parameters=lacking),
        lambda: request(node=99, power=200, parameters=lacking),  # the command is checked first, then the node
        decoded.encode,
        decoded.check,
    ]
    for way in ways:
        with pytest.raises(codec, match=r"available with series=Series\.MS, not Series\.MF") as caught:
            way()
        assert caught.value.refusal is v2_35.Refusal.NOT_AVAILABLE
    assert decoded.power == 200
    assert decoded.encode_unchecked() == bytes.fromhex("A0000000C8000000")
    assert request.from_raw(node=1, power=200, parameters=unknown).encode() == decoded.encode_unchecked()


def test_a_request_without_fields_that_the_node_lacks_is_refused(tmp_path: Path) -> None:
    text = MINIMAL.replace("types:", "parameters: {kind: {values: [a, b]}}\ntypes:")
    spec = tmp_path / "lamp.yaml"
    spec.write_text(text + '  stop: {code: 9, manual: "2", only: {kind: [a]}, request: {}, reply: none}\n', "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    lacking = lamp.Parameters(kind=lamp.Kind.B)
    ways: list[Callable[[], object]] = [
        lambda: lamp.StopRequest(node=1, parameters=lacking),
        lambda: lamp.StopRequest.from_raw(node=1, parameters=lacking),
        lambda: lamp.StopRequest(node=1).replace(parameters=lacking),
        lambda: lamp.decode_request(0x101, bytes((9, 0, 0, 0, 0, 0, 0, 0)), lacking).encode(),
    ]
    for way in ways:
        with pytest.raises(lamp.CodecError, match=r"available with kind=Kind\.A, not Kind\.B"):
            way()
    assert lamp.StopRequest(node=1, parameters=lamp.Parameters(kind=lamp.Kind.A)).encode()[0] == 9


def test_an_id_of_the_other_length_is_told(tmp_path: Path) -> None:
    """Ids of 29 bits look like those of 11 to who forgets to say which they are."""
    spec = ROOT / "tests/specs/cells/v1.yaml"
    cells = load(write(tmp_path, spec), specification(spec).edition)
    with pytest.raises(cells.CodecError, match=r"no reply has the id 0x14B; with extended=True there is one"):
        cells.decode_reply(0x14B, bytes(8))
    with pytest.raises(cells.CodecError, match=r"no reply has the id 0x14A$"):
        cells.decode_reply(0x14A, bytes(8))
    assert cells.decode_reply(0x14B, bytes(8), extended=True).node == 3


NAMED_LIKE_PYTHON = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100}}
selector: {at: 0, raw: u8}
parameters: {type: {values: [old, new]}, float: {number: {}}, class: {number: {}}}
types:
  level: {raw: u16, scale: {by: type, old: 0.1, new: 1*float}, raw_range: {by: type, old: 0..9, new: 0..16}}
  limit: {raw: u16, range: 0..2*class}
commands:
  dim:
    code: 0x10
    request:
      level: {at: 2, type: level, only: {type: [old]}}
      glow: {at: 2, type: level, only: {type: [new]}}
      limit: {at: 4, type: limit}
    reply: none
"""


def test_parameters_may_be_named_like_words_of_python(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(NAMED_LIKE_PYTHON, "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    old = lamp.DimRequest(level=0.5, limit=1, parameters=lamp.Parameters(type=lamp.Type.OLD))
    assert old.encode() == bytes.fromhex("10 00 05 00 01 00 00 00")
    new = lamp.Parameters(type=lamp.Type.NEW, float_=4, class_=8)
    read = lamp.decode_request(0x100, bytes.fromhex("10 00 05 00 00 00 00 00"), new)
    assert (read.fields(), read.glow) == (("glow", "limit"), 20.0)
    with pytest.raises(lamp.CodecError, match=r"limit=17 is out of range 0\.\.16"):
        lamp.DimRequest(glow=20, limit=17, parameters=new)
    with pytest.raises(lamp.CodecError, match=r"pass Parameters\(type=\.\.\.\)"):
        lamp.decode_request(0x100, bytes.fromhex("10 00 05 00 00 00 00 00"))


def test_raw_integers_need_no_parameters(v2_35: ModuleType) -> None:
    request = v2_35.SetTorqueRequest.from_raw(node=1, iq=5)
    assert (request.parameters, request.encode()[4]) == (v2_35.UNKNOWN, 5)
    assert repr(request) == "SetTorqueRequest(node=1, iq_raw=5)"


def test_a_field_that_does_not_exist_under_the_parameters_is_absent_everywhere(v2_35: ModuleType) -> None:
    motor = v2_35.Parameters(series=v2_35.Series.MG, encoder_bits=18)
    reply = v2_35.decode_reply(0x141, bytes.fromhex("A1 32 9B 00 F4 01 00 80"), motor)
    raw = {"node": 1, "parameters": motor, **reply.raw()}
    for attempt, given in (
        (partial(getattr, reply, "power"), {}),
        (reply.replace, {"power": 3}),
        (reply.from_raw, {**raw, "power": 3}),
        (v2_35.SetTorqueReply, {**raw, "iq": None, "power": 3}),
    ):
        with pytest.raises(v2_35.FieldAbsent, match="SetTorqueReply has no power under"):
            attempt(**given)
    with pytest.raises(v2_35.FieldAbsent, match="SetTorqueReply has no iq under"):
        reply.replace(parameters=v2_35.Parameters(series=v2_35.Series.MS))


def test_an_array_of_enums_or_flags(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    array = "level: {at: 2, type: level, array: 1..2}, faults: {at: 4, type: faults, array: 1..2}"
    spec.write_text(
        ENUM_AND_FLAGS.replace("level: {at: 2, type: level}, faults: {at: 3, type: faults}", array), "utf-8"
    )
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    request = lamp.DimRequest(node=1, level=(0, lamp.Level.BRIGHT), faults=(lamp.Faults.HOT, 0))
    assert request.encode() == bytes.fromhex("10 00 00 01 01 00 00 00")
    assert (request.level, request.faults) == ((lamp.Level.DIM, lamp.Level.BRIGHT), (lamp.Faults.HOT, lamp.Faults(0)))
    with pytest.raises(lamp.CodecError, match="level=2 is none of the values 0, 1"):
        lamp.DimRequest(node=1, level=(0, 2), faults=(0, 0))
