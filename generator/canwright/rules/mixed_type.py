"""A type is either a number, an enum or flags."""

from __future__ import annotations

from ..model.types import Encoding
from .rule import CheckInput, Finding, Findings

_OF_NUMBERS = ("unit", "scale", "offset", "range", "plausible", "raw_range", "no_value", "names")
_HINTS = {
    "unit": "{}; named raw integers beside numbers are `no_value`",
    "no_value": "name these raw integers in `enum`, or {}",
    "names": "name these raw integers in `enum`, or {}",
}


def check(subject: CheckInput) -> Findings:
    for name, written in subject.spec.types.items():
        kinds = [key for key in ("enum", "flags") if getattr(written, key) is not None]
        if not kinds:
            continue
        kind = kinds[0]
        if written.raw[0] is Encoding.FLOAT:
            text = f"`{kind}` is for integers, but this type is a float"
            yield Finding(("types", name, "raw"), text, "write u or i with the width, like u8")
        for key in kinds[1:]:
            text = "a type has either `enum` or `flags`"
            yield Finding(("types", name, key), text, "define two types, for two fields", key=True)
        for key in _OF_NUMBERS:
            if getattr(written, key) is not None and (key != "raw_range" or kind == "flags"):
                text = f"`{key}` has no effect, because the values of this type are names"
                yield Finding(
                    ("types", name, key), text, _HINTS.get(key, "{}").format(f"remove `{key}` or `{kind}`"), key=True
                )
