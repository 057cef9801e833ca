"""A scale is not 0."""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for type_ in subject.edition.types:
        if any(linear is not None and linear.scale == 0 for _, linear in type_.linear.distinct()):
            text = "a scale of 0 makes all values equal"
            yield Finding((*type_.path, "scale"), text, "write `none` if there is no scale")
