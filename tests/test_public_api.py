"""The public API: every name is there, and nothing is imported before it is used."""

from __future__ import annotations

import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import canwright
import pytest

from .spec_texts import MINIMAL


@pytest.mark.parametrize("name", canwright.__all__)
def test_every_public_name_exists_and_has_a_docstring(name: str) -> None:
    assert getattr(canwright, name).__doc__


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = canwright.nothing


def test_importing_canwright_imports_no_submodule() -> None:
    script = "import sys, canwright; print([name for name in sys.modules if name.startswith('canwright.')])"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_spec_is_loaded_and_generated(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    specification = canwright.load(tmp_path / "lamp.yaml")
    files = canwright.generate([specification], ["c"])
    assert b"lamp_v1_dim_request_encode" in files["c/include/lamp/v1.h"]
    assert {path.partition("/")[0] for path in canwright.generate([specification])} == {
        "c",
        "columns",
        "dbc",
        "docs",
        "javascript",
        "python",
        "wireshark",
    }


def test_a_spec_with_an_error_raises_its_findings(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("u16", "u99"), "utf-8")
    with pytest.raises(canwright.SpecError) as caught:
        canwright.load(tmp_path / "lamp.yaml")
    assert [finding.position.line for finding in caught.value.diagnostics] == [7]


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
    found = canwright.Encoder({}).encode_values(request, 1, {"level": value})
    assert (found.reason.value if isinstance(found, canwright.Rejection) else found.data.hex().upper()) == expected


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
    found = canwright.Encoder({}).encode_values(request, 1, values)
    assert (found.field if isinstance(found, canwright.Rejection) else found.data.hex()) == expected
