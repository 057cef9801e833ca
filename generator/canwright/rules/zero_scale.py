"""A scale is not zero."""

from __future__ import annotations

from ..model import Edition
from .rule import Found


def check(edition: Edition) -> Found:
    for type_ in edition.types:
        if any(linear is not None and linear.scale == 0 for _, linear in type_.linear.distinct()):
            yield (
                (*type_.path, "scale"),
                "a scale of zero makes every value the same",
                "write `none` if there is no scale",
            )
