"""The public API: every name is there, and nothing is imported before it is used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import canwright
import pytest

from .spec_texts import MINIMAL


@pytest.mark.parametrize("name", canwright.__all__)
def test_every_name_is_there_and_documented(name: str) -> None:
    assert getattr(canwright, name).__doc__


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = canwright.nothing


def test_importing_it_imports_nothing_else() -> None:
    script = "import sys, canwright; print([name for name in sys.modules if name.startswith('canwright.')])"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_spec_is_loaded_and_generated(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    specification = canwright.load(tmp_path / "lamp.yaml")
    files = canwright.generate([specification], ["c"])
    assert b"lamp_v1_dim_request_encode" in files["c/include/lamp/v1.h"]
    assert {path.partition("/")[0] for path in canwright.generate([specification])} == {"c", "dbc", "docs", "python"}


def test_a_spec_with_an_error_raises_its_findings(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("u16", "u99"), "utf-8")
    with pytest.raises(canwright.SpecError) as caught:
        canwright.load(tmp_path / "lamp.yaml")
    assert [finding.position.line for finding in caught.value.diagnostics] == [7]
