"""A type is a number with its scale and range, an enum of integers, or flags of bits: one of them."""

from __future__ import annotations

from ..model.types import Encoding
from .rule import Finding, Found, Subject

_OF_NUMBERS = ("unit", "scale", "offset", "range", "plausible", "raw_range")


def check(subject: Subject) -> Found:
    for name, written in subject.spec.types.items():
        kinds = [key for key in ("enum", "flags") if getattr(written, key) is not None]
        if not kinds:
            continue
        kind = kinds[0]
        if written.raw[0] is Encoding.FLOAT:
            text = f"`{kind}` names integers, and this is a float"
            yield Finding(("types", name, "raw"), text, "write u or i with the width, like u8")
        for key in kinds[1:]:
            text = "a type has an `enum` or `flags`, not both"
            yield Finding(("types", name, key), text, "make two types, for two fields that share no bit", key=True)
        for key in _OF_NUMBERS:
            if getattr(written, key) is not None and (key != "raw_range" or kind == "flags"):
                text = f"the values of this type are names, so `{key}` says nothing"
                yield Finding(("types", name, key), text, f"take out `{key}`, or `{kind}`", key=True)
