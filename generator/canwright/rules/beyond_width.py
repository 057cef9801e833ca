"""A range, a constant and what an index names lie within what the bits hold."""

from __future__ import annotations

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import ReservedRole
from ..model.types import Encoding, Range, Type
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    yield from _ranges(subject)
    yield from _plausible(subject.edition)
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
            part = next((end for end in ends if end.denominator != 1), None) if key == "raw_range" else None
            if limits.is_constant and ends[0] > ends[1]:
                text = "no raw integer has a value in this range"
                yield Finding((*type_.path, key), text, "check the range, and `scale` and `offset`")
            elif part is not None:
                text = f"{formatting.exact(part)} is no raw integer"
                yield Finding((*type_.path, key), text, "write whole numbers, or `range` for values in the unit")
            elif any(end < low or end > high for end in ends) or _is_never_within(limits, low):
                text = f"the raw range {formatting.span(limits)} is not within {low}..{high}, all that {type_.width} bits hold"
                hint = "check the range, and sign and width in `raw`"
                yield Finding((*type_.path, key), text, hint if limits.is_constant else f"{hint}, `scale` and `offset`")


def _is_never_within(limits: Range, lowest: int) -> bool:
    """Whether a range from minus to plus a number, -size..size, leaves the bits whatever the number is, other than 0."""
    low, high = limits.low, limits.high
    return low.coefficient < 0 < high.coefficient and low.constant == high.constant <= lowest


def _plausible(edition: Edition) -> Found:
    """Plausible values that no raw integer has."""
    for type_ in edition.types:
        wanted = type_.plausible
        lines = [line for _, line in type_.linear.distinct() if line is not None]
        if wanted is None or type_.encoding is Encoding.FLOAT or not lines or any(line.times for line in lines):
            continue
        limits = type_.raw_range.constant
        ends = (limits.low.constant, limits.high.constant) if limits and limits.is_constant else type_.raw_limits
        there = [raw * line.scale + line.offset for line in lines for raw in ends]
        if max(there) < wanted.low.constant or min(there) > wanted.high.constant:
            holds = f"{type_.width} bits hold" if ends == type_.raw_limits else "the range of this type is"
            text = f"{holds} {formatting.exact(min(there))}..{formatting.exact(max(there))}, nothing of this range"
            yield Finding((*type_.path, "plausible"), text, "check the range, and `scale` and `offset`")


def _constants(edition: Edition) -> Found:
    fields = {f.path: f for m in edition.all_messages() for f in m.layout.fields if f.fixed is not None}
    for field in fields.values():
        low, high = field.type.raw_limits
        is_reserved = isinstance(field.role, ReservedRole)
        key, what = ("reserved", "what is reserved") if is_reserved else ("constant", "the constant")
        if field.fixed is not None and not low <= field.fixed <= high:
            text = f"{field.fixed} is not within {low}..{high}, all that {field.type.width} bits hold"
            yield Finding((*field.path, key), text, f"check {what}, and sign and width of the field")
        elif field.type.enum and field.fixed not in (values := {m.value: m.name for m in field.type.enum}):
            there = ", ".join(f"{value} is {name}" for value, name in values.items())
            text = f"no name of `{field.type.name}` has the value {field.fixed}"
            yield Finding((*field.path, key), text, f"{there}; or write `raw` in place of `type`")
        elif field.fixed is not None and not field.type.enum and (limits := _forbidding(field.type, field.fixed)):
            text = f"{field.fixed} is not within {formatting.span(limits)}, the raw range of `{field.type.name}`"
            yield Finding((*field.path, key), text, f"check {what}, or write `raw` in place of `type`")


def _forbidding(type_: Type, raw: int) -> Range | None:
    """The raw range that a raw integer is not in, if that is so whatever the parameters are."""
    if type_.encoding is Encoding.FLOAT:
        return None
    limits = [one for _, one in type_.raw_range.distinct()]
    beyond = (one and one.is_constant and not one.low.constant <= raw <= one.high.constant for one in limits)
    return limits[0] if limits and all(beyond) else None
