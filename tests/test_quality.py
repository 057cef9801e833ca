"""Types, style, complexity and the order of imports, with the tools that the test extra installs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from .spec_texts import ROOT

BIN = Path(sys.executable).parent
TOOLS = [("mypy",), ("ruff", "check"), ("ruff", "format", "--check"), ("lint-imports",)]


@pytest.mark.parametrize("command", TOOLS, ids=" ".join)
def test_tool_reports_nothing(command: tuple[str, ...]) -> None:
    tool, *arguments = command
    result = subprocess.run([BIN / tool, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
