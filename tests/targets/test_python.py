"""The Python package beyond the golden frames: types, errors, names, and what a spec's text can do."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from canwright.load import described
from canwright.targets import python as target

from ..conformance.adapters.python import load
from ..spec_texts import MINIMAL, ROOT

SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"


def write(folder: Path, spec: Path) -> Path:
    for output in target.generate([described(spec)], {}):
        file = folder / output.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(output.text, "utf-8")
    return folder


@pytest.fixture(scope="module")
def v2_35(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    return load(write(tmp_path_factory.mktemp("python"), SPEC), described(SPEC).edition)


def test_mypy_strict_and_pyright_find_nothing(tmp_path: Path) -> None:
    write(tmp_path, SPEC)
    use = tmp_path / "use.py"
    use.write_text(
        "from mwd_motor.v2_35 import (MotionFeedback, Parameters, ReadEncoderReply, ReadEncoderRequest, Series,\n"
        "    SetTorqueRequest, decode_answer, decode_reply)\n"
        "known = Parameters(series=Series.MG, encoder_bits=18)\n"
        "request = SetTorqueRequest(node=1, iq=2.5, parameters=known)\n"
        "data: bytes = request.encode()\n"
        "reply = decode_reply(0x141, data, known)\n"
        "if isinstance(reply, MotionFeedback):\n"
        "    amperes: float = reply.iq\n"
        "answer: ReadEncoderReply = decode_answer(ReadEncoderRequest, 0x141, data, known)\n"
        "counts: int = answer.encoder_raw\n"
    )
    for command in (
        ("mypy", "--strict", "--no-incremental", "."),
        ("basedpyright", "--level", "error", "--pythonpath", sys.executable),
    ):
        (tmp_path / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict", "pythonVersion": "3.10"}')
        result = subprocess.run(
            [sys.executable, "-m", *command], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert result.returncode == 0, result.stdout + result.stderr


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
    with pytest.raises(AttributeError, match="has no attribute sped"):
        _ = reply.sped
    with pytest.raises(TypeError, match="needs power"):
        v2_35.SetSpeedReply(node=1, temperature=1, speed=1, encoder=1, parameters=known)
    with pytest.raises(AttributeError, match="has no iq"):
        v2_35.SetSpeedReply(node=1, temperature=1, power=1, iq=1, speed=1, encoder=1, parameters=known)


def test_decoding_and_encoding_back_is_lossless_even_out_of_range(v2_35: ModuleType) -> None:
    data = bytes.fromhex("A1000000C4090000")
    message = v2_35.decode_request(0x141, data, v2_35.Parameters(series=v2_35.Series.MG))
    assert message.iq_raw == 2500
    assert message.encode() == data


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
    for one in ("plain", quoted):
        about = f"    title: {one}\n    about: {one}\n    notes: [{one}]\n"
        spec.write_text(f"title: {one}\nabout: {one}\n" + MINIMAL.replace('    manual: "1"\n', about), "utf-8")
        folder = write(tmp_path / str(len(trees)), spec)
        trees.append(_without_strings(ast.parse((folder / "lamp/v1.py").read_text("utf-8"))))
    assert trees[0] == trees[1]


def _without_strings(tree: ast.AST) -> str:
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)
