"""A `match` that decides about everything, which the type checker proves."""

from __future__ import annotations

from typing import NoReturn


def assert_never(value: NoReturn) -> NoReturn:
    """The last case: the type checker rejects it if another value can come here. `typing` has it from Python 3.11."""
    raise AssertionError(f"nothing decides about {value!r}")
