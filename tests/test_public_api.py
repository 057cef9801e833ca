"""The public API: every name is there, and nothing is imported before it is used."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import canwright
import pytest
from canwright.targets.registry import default_targets

from .spec_texts import MINIMAL, ROOT


@pytest.mark.parametrize("name", canwright.__all__)
def test_public_name_exists_with_a_docstring(name: str) -> None:
    assert getattr(canwright, name).__doc__


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = canwright.nothing


def test_import_of_canwright_imports_no_other_module() -> None:
    script = "import sys, canwright; print([name for name in sys.modules if name.startswith('canwright.')])"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_spec_is_loaded_and_generated(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    specification = canwright.load(tmp_path / "lamp.yaml")
    files = canwright.generate([specification], ["c"])
    assert b"lamp_v1_dim_request_encode" in files["c/include/lamp/v1.h"]
    assert {path.partition("/")[0] for path in canwright.generate([specification])} == set(default_targets())


def test_options_of_targets_are_texts_as_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    specification = canwright.load(tmp_path / "lamp.yaml")
    assert "dbc/lamp-v1-command-node2.dbc" in canwright.generate([specification], ["dbc"], options={"nodes": "2"})
    for option, message in (
        ({"nodes": "9"}, "--nodes 9: lamp v1 has no node 9; its nodes are 1..4"),
        ({"speed": "9"}, "no target has the option --speed"),
    ):
        with pytest.raises(ValueError, match=re.escape(message)):
            canwright.generate([specification], ["dbc"], options=option)


def test_a_spec_with_an_error_raises_its_findings(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("u16", "u99"), "utf-8")
    with pytest.raises(canwright.SpecError) as caught:
        canwright.load(tmp_path / "lamp.yaml")
    assert [finding.position.line for finding in caught.value.diagnostics] == [7]


def test_decoding_needs_neither_golden_frames_nor_names_of_targets(tmp_path: Path) -> None:
    file, level = tmp_path / "lamp.yaml", "level: {at: 2, type: level}"
    file.with_name("lamp.frames.yaml").write_text("canwright: 1\n", "utf-8")
    file.write_text(MINIMAL, "utf-8")
    with pytest.raises(canwright.SpecError, match="missing-key"):
        canwright.load(file)
    file.write_text(MINIMAL.replace(level, f"{level}, level_raw: {{at: 4, raw: u8}}"), "utf-8")
    specification = canwright.load(file, for_output=False)
    assert specification.frames is None
    decoded = canwright.Decoder(specification.edition).decode(
        canwright.Direction.REQUEST, canwright.CanFrame(0x102, bytes.fromhex("10 00 7D 00 05 00 00 00"))
    )
    assert isinstance(decoded, canwright.Decoded)
    assert decoded.raws == {"level": 125, "level_raw": 5}
    file.with_name("lamp.frames.yaml").unlink()
    with pytest.raises(canwright.SpecError, match="name-collision"):
        canwright.load(file)


LAMP = (
    MINIMAL
    + """\
  mode: {code: 0x20, request: {mode: {at: 1, type: mode}, lit: {at: 2, type: lit}}, reply: none}
"""
)


@pytest.fixture
def lamp(tmp_path: Path) -> canwright.Edition:
    types = "types:\n  mode: {raw: u8, enum: {day: 0, night: 1}}\n  lit: {raw: u8, flags: {left: 0, right: 1}}\n"
    (tmp_path / "lamp.yaml").write_text(LAMP.replace("types:\n", types), "utf-8")
    return canwright.load(tmp_path / "lamp.yaml").edition


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (12.5, "10007D0000000000"),
        (12, "1000780000000000"),
        (Decimal("12.5"), "10007D0000000000"),
        (Fraction(1, 4), "1000030000000000"),
        (float("nan"), "not_finite"),
        (float("-inf"), "not_finite"),
        (100.1, "out_of_range"),
    ],
)
def test_numbers_of_every_kind_are_encoded(lamp: canwright.Edition, value: Any, expected: str) -> None:
    request = lamp.command("dim").request
    assert request is not None
    encoded = canwright.Encoder(lamp).encode_values(request, 1, {"level": value})
    assert (
        encoded.reason.value if isinstance(encoded, canwright.Rejection) else encoded.data.hex().upper()
    ) == expected


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"mode": "night", "lit": ["left", "right"]}, "2001030000000000"),
        ({"mode": "night", "lit": ["left", "left"]}, "2001010000000000"),
        ({"mode": "dusk", "lit": []}, "mode"),
        ({"mode": "day", "lit": ["top"]}, "lit"),
    ],
)
def test_names_are_encoded(lamp: canwright.Edition, values: dict[str, Any], expected: str) -> None:
    request = lamp.command("mode").request
    assert request is not None
    encoded = canwright.Encoder(lamp).encode_values(request, 1, values)
    assert (encoded.field if isinstance(encoded, canwright.Rejection) else encoded.data.hex()) == expected


def test_a_request_that_the_node_lacks_is_rejected() -> None:
    edition = canwright.load(ROOT / "spec/mwd_motor/v2.35.yaml").edition
    request = edition.command("set_power").request
    assert request is not None
    rejected = canwright.Encoder(edition, {"series": "MF"}).encode_values(request, 1, {"power": 100})
    assert isinstance(rejected, canwright.Rejection)
    assert rejected.reason is canwright.Refusal.NOT_AVAILABLE


ARM = ROOT / "tests/specs/arm/v1.yaml"
"""Its position has a scale that is a multiple of the parameter `p_max`; its current has one for each `winding`."""
POSITION = canwright.CanFrame(0x101, bytes.fromhex("00 FF FF 00 00 00 00 00"))


def position(parameters: Mapping[str, Any] | None = None) -> object:
    """The position that a reply reports, which has the last raw integer."""
    decoded = canwright.Decoder(canwright.load(ARM).edition, parameters).decode(canwright.Direction.REPLY, POSITION)
    assert isinstance(decoded, canwright.Decoded)
    return decoded.values["position"]


@pytest.mark.parametrize("value", [12.5, "12.5", "25/2", Decimal("12.5"), Fraction(25, 2)])
def test_parameters_of_a_decoder_are_numbers_or_text(value: Any) -> None:
    assert position({"p_max": value}) == Fraction(25, 2)


def test_value_without_its_parameter_is_none() -> None:
    assert position() is None


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"p_maks": 1}, "`p_maks` is not a parameter; did you mean `p_max`?"),
        ({"winding": "round"}, "`winding` is not `round`; use one of: star, delta, open"),
        ({"p_max": 1000}, "`p_max` must be at most 100"),
        ({"p_max": float("nan")}, "`NaN` is not a number; write"),
        ({"p_max": 1e-7}, "`p_max` must be at least 0.1"),
    ],
)
def test_invalid_parameters_are_rejected_with_a_sentence(parameters: dict[str, Any], message: str) -> None:
    specification = canwright.load(ARM)
    for call in (
        lambda: canwright.Decoder(specification.edition, parameters),
        lambda: canwright.Encoder(specification.edition, parameters),
        lambda: canwright.generate([specification], ["dbc"], parameters),
    ):
        with pytest.raises(ValueError, match=re.escape(message)):
            call()


def test_decoder_and_encoder_take_the_same_arguments() -> None:
    assert inspect.signature(canwright.Decoder) == inspect.signature(canwright.Encoder)


def test_encoder_and_decoder_agree_under_parameters() -> None:
    edition = canwright.load(ARM).edition
    message = edition.command("limit").request
    assert message is not None
    frame = canwright.Encoder(edition, {"t_max": 10}).encode_values(message, 1, {"peak": 5})
    assert isinstance(frame, canwright.CanFrame)
    decoder = canwright.Decoder(edition, {"t_max": "10"})
    decoded = decoder.decode_as(message, frame)
    assert isinstance(decoded, canwright.Decoded)
    assert decoded.raws["peak"] == 500
    assert decoded.values["peak"] == 5
    answer = decoder.check_reply(frame, frame)
    assert isinstance(answer, canwright.Identified)
    assert (answer.message, answer.node) == (edition.command("limit").reply, 1)
    without = canwright.Encoder(edition).encode_values(message, 1, {"peak": 5})
    assert isinstance(without, canwright.Rejection)
    assert (without.reason, without.field) == (canwright.Refusal.MISSING_PARAMETER, "peak")
