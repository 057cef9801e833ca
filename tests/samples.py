"""Cases that always run, and those that run with `-m exhaustive` only."""

from collections.abc import Sequence

import pytest


def sampled(cases: Sequence[object], step: int) -> list[object]:
    """Each STEPth case always runs; the others are marked as exhaustive."""
    return [case if n % step == 0 else pytest.param(case, marks=pytest.mark.exhaustive) for n, case in enumerate(cases)]
