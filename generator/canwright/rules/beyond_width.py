"""A range, a constant and what an index names lie within what the bits hold."""

from __future__ import annotations

from .. import words
from ..model import Edition, Encoding
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    yield from _ranges(subject)
    yield from _constants(subject.edition)


def _ranges(subject: Subject) -> Found:
    for type_ in subject.edition.types:
        if type_.encoding is Encoding.FLOAT:
            continue
        low, high = type_.raw_limits
        written = subject.spec.types.get(type_.name)
        key = "range" if written and written.range is not None else "raw_range"
        for _, limits in type_.raw_range.distinct():
            if limits is None:
                continue
            ends = [end.constant for end in (limits.low, limits.high) if end.parameter is None]
            if any(end < low or end > high for end in ends):
                text = (
                    f"the raw range {words.span(limits)} is not within {low}..{high}, all that {type_.width} bits hold"
                )
                yield Finding((*type_.path, key), text, "check the range, and sign and width in `raw`")


def _constants(edition: Edition) -> Found:
    fields = {f.path: f for m in edition.all_messages() for f in m.layout.fields if f.constant is not None}
    for field in fields.values():
        low, high = field.type.raw_limits
        key, what = ("constant", "the constant") if field.checked else ("reserved", "what is reserved")
        if field.constant is not None and not low <= field.constant <= high:
            text = f"{field.constant} is not within {low}..{high}, all that {field.type.width} bits hold"
            yield Finding((*field.path, key), text, f"check {what}, and sign and width of the field")
        elif field.type.enum and field.constant not in (values := {m.value: m.name for m in field.type.enum}):
            there = ", ".join(f"{value} is {name}" for value, name in values.items())
            text = f"no name of `{field.type.name}` has the value {field.constant}"
            yield Finding((*field.path, key), text, f"{there}; or write `raw` in place of `type`")
