"""Types, style and the size of modules, with the tools that the test extra brings."""

from __future__ import annotations

import subprocess
import sys

import pytest

from .spec_texts import ROOT

MAX_LINES = 350


@pytest.mark.parametrize("command", [("mypy",), ("ruff", "check"), ("ruff", "format", "--check")], ids=" ".join)
def test_tool_has_nothing_to_say(command: tuple[str, ...]) -> None:
    result = subprocess.run([sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_modules_stay_small() -> None:
    for folder in ("generator", "tests"):
        for file in (ROOT / folder).rglob("*.py"):
            lines = len(file.read_text("utf-8").splitlines())
            assert lines <= MAX_LINES, f"{file.relative_to(ROOT)} has {lines} lines; it likely has two ideas in it"
