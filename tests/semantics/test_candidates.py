"""The messages that a recorded frame can be."""

from __future__ import annotations

import random
import tracemalloc

import pytest
from canwright.project.loader import specification
from canwright.semantics.candidates import Candidates
from canwright.semantics.frame import CanFrame

from ..spec_texts import SPECS, called

MOTOR = next(specification(file).edition for file in SPECS if called(file) == "mwd_motor/v2.36-2025-03")


def test_memory_does_not_grow_with_random_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("canwright.semantics.candidates.MAX_KNOWN", 1 << 6)
    chance, candidates = random.Random(1), Candidates(MOTOR)
    sizes = []
    for _ in range(2):
        tracemalloc.start()
        for number in range(4000):
            candidates.of(CanFrame(0x141 + number % 16, chance.randbytes(8)))
        sizes.append(tracemalloc.get_traced_memory()[0])
        tracemalloc.stop()
    assert sizes[-1] < 200_000, sizes
