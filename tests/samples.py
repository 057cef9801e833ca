"""Cases that always run, and those that run with `-m exhaustive` only."""

from collections.abc import Sequence

import pytest


def sampled(cases: Sequence[object], step: int) -> list[object]:
    """Each STEPth case always runs; the others are marked as exhaustive."""
    values = [case if isinstance(case, tuple) else (case,) for case in cases]
    return [pytest.param(*value, marks=[pytest.mark.exhaustive] if n % step else []) for n, value in enumerate(values)]
