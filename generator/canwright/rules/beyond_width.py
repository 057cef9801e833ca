"""Ranges and constants fit the width of their type."""

from __future__ import annotations

from ..model import formatting
from ..model.edition import Edition
from ..model.types import Encoding, Range, Type
from ..semantics.plan import message_plan
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    yield from _ranges(subject)
    yield from _plausible(subject.edition)
    yield from _constants(subject.edition)


def _ranges(subject: CheckInput) -> Findings:
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
                text = "no raw integer has a value within this range"
                yield Finding((*type_.path, key), text, "check the range, and `scale` and `offset`")
            elif part is not None:
                text = f"{formatting.exact(part)} is not a raw integer"
                yield Finding((*type_.path, key), text, "write whole numbers, or `range` for values in the unit")
            elif any(end < low or end > high for end in ends) or _is_never_within(limits, low):
                bits = formatting.counted(type_.width, "bit")
                text = f"the raw range {formatting.span(limits)} exceeds {low}..{high}, the limits of {bits}"
                yield Finding((*type_.path, key), text, _hint(type_, limits, key))


def _hint(type_: Type, limits: Range, key: str) -> str:
    """What to write; also `raw_range`, if the limits of `range` are raw integers that fit."""
    hint = "check the range, and the sign and width in `raw`"
    if not limits.is_constant:
        return f"{hint}, `scale` and `offset`"
    low, high = type_.raw_limits
    for _, line in type_.linear.distinct() if key == "range" else ():
        values = formatting.in_unit(limits, line) if line is not None and line.times is None else limits
        ends = values.low.constant, values.high.constant
        if all(end.denominator == 1 and low <= end <= high for end in ends):
            return f"{hint}; for raw integers, write raw_range: {formatting.span(values)}"
    return hint


def _is_never_within(limits: Range, lowest: int) -> bool:
    """Whether a range such as -size..size exceeds the limits of the type for every number except 0."""
    low, high = limits.low, limits.high
    return low.coefficient < 0 < high.coefficient and low.constant == high.constant <= lowest


def _plausible(edition: Edition) -> Findings:
    """Findings about plausible values that no raw integer has."""
    for type_ in edition.types:
        wanted = type_.plausible
        lines = [line for _, line in type_.linear.distinct() if line is not None]
        if wanted is None or type_.encoding is Encoding.FLOAT or not lines or any(line.times for line in lines):
            continue
        limits = type_.raw_range.constant
        ends = (limits.low.constant, limits.high.constant) if limits and limits.is_constant else type_.number_limits
        values = [raw * line.scale + line.offset for line in lines for raw in ends]
        if max(values) < wanted.low.constant or min(values) > wanted.high.constant:
            limit = (
                f"a width of {formatting.counted(type_.width, 'bit')}"
                if ends == type_.number_limits
                else "the raw range"
            )
            allowed = f"{formatting.exact(min(values))}..{formatting.exact(max(values))}"
            text = f"no value is within this range; {limit} allows {allowed}"
            yield Finding((*type_.path, "plausible"), text, "check the range, and `scale` and `offset`")


def _constants(edition: Edition) -> Findings:
    fields = {f.path: (f, raw) for m in edition.all_messages() for f, raw in message_plan(m).sent.items()}
    for field, raw in fields.values():
        low, high = field.type.raw_limits
        what = f"`{field.role.key}`"
        if not low <= raw <= high:
            text = f"{raw} is outside {low}..{high}, the limits of {formatting.counted(field.type.width, 'bit')}"
            yield Finding((*field.path, field.role.key), text, f"check {what}, and the sign and width of the field")
        elif field.type.enum and raw not in (values := {m.value: m.name for m in field.type.enum}):
            names = ", ".join(f"{value} is {name}" for value, name in values.items())
            text = f"`{field.type.name}` has no name for the value {raw}"
            yield Finding((*field.path, field.role.key), text, f"{names}; or write `raw` instead of `type`")
        elif not field.type.enum and (limits := _forbidding(field.type, raw)):
            text = f"{raw} is outside {formatting.span(limits)}, the raw range of `{field.type.name}`"
            yield Finding((*field.path, field.role.key), text, f"check {what}, or write `raw` instead of `type`")


def _forbidding(type_: Type, raw: int) -> Range | None:
    """A raw range without the raw integer, if it is out of range under all parameters; else None."""
    if type_.encoding is Encoding.FLOAT or type_.no_value(raw):
        return None
    limits = [limit for _, limit in type_.raw_range.distinct()]
    beyond = (limit and limit.is_constant and not limit.low.constant <= raw <= limit.high.constant for limit in limits)
    return limits[0] if limits and all(beyond) else None
