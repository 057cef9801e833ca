"""No code assumes a number of data bytes: golden frames of 24 bytes through every target."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ..spec_texts import ROOT
from .adapters import ADAPTERS


@pytest.mark.parametrize("target", ADAPTERS)
def test_golden_frames_of_24_bytes(target: str) -> None:
    command = [sys.executable, "-m", "tests.conformance.long_frames", target]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
