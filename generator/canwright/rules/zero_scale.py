"""A scale is not zero."""

from __future__ import annotations

from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    for type_ in subject.edition.types:
        if any(linear is not None and linear.scale == 0 for _, linear in type_.linear.distinct()):
            text = "a scale of zero makes every value the same"
            yield Finding((*type_.path, "scale"), text, "write `none` if there is no scale")
