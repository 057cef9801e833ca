"""Work grows with the commands and no faster: reading and checking a spec, and every target."""

from __future__ import annotations

import cProfile
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec

import pytest
from canwright.project.loader import specification
from canwright.project.pipeline import generate
from canwright.rules.bit_patterns import Known, pairs
from canwright.targets.base import EditionInput
from canwright.targets.registry import default_targets
from hypothesis import given, strategies as st

from ..bench.generate import multiplied

P = ParamSpec("P")

TIMES = (3, 6, 9)
MOST = 1.05
"""How much more the third three times the commands may take than the second three."""


def calls(work: Callable[P, object], *arguments: P.args, **named: P.kwargs) -> int:
    """How many functions are called on the way: what time tells, and the same in every run."""
    profile = cProfile.Profile()
    profile.runcall(work, *arguments, **named)
    return sum(entry.callcount for entry in profile.getstats())


@pytest.fixture(scope="module")
def specs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("specs")
    files = [multiplied(folder, times) for times in TIMES]
    specification(files[0])
    return files


@pytest.fixture(scope="module")
def read(specs: list[Path]) -> list[EditionInput]:
    return [specification(spec) for spec in specs]


def test_calls_to_load_a_spec_grow_linearly_with_its_commands(specs: list[Path]) -> None:
    few, more, most = (calls(specification, spec) for spec in specs)
    assert most - more < MOST * (more - few)


@pytest.mark.parametrize("target", default_targets())
def test_a_target_grows_with_the_commands(target: str, read: list[EditionInput]) -> None:
    generate(read[:1], [target], {})
    few, more, most = (calls(generate, [edition], [target], {}) for edition in read)
    assert most - more < MOST * (more - few)


@given(st.lists(st.tuples(st.integers(0, 15), st.integers(0, 15)), max_size=12))
def test_pairs_are_all_patterns_that_some_bits_match(bits: list[tuple[int, int]]) -> None:
    known = [Known(mask, value & mask) for mask, value in bits]
    expected = [
        (i, j)
        for i, first in enumerate(known)
        for j, second in enumerate(known[:i])
        if not (first.value ^ second.value) & first.mask & second.mask
    ]
    assert list(pairs(known)) == expected
