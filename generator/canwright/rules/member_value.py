"""The values of an enum, named numbers and the bits of flags are distinct and fit the width of the type."""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from ..language import aliases
from ..model import formatting
from ..model.types import Member, Range, Type
from ..semantics.valid_raws import RawInterval, valid_raws
from .no_value import RESERVED
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    for type_ in subject.edition.types:
        low, high = type_.raw_limits
        yield from _members(type_, "enum", type_.enum, low, high)
        yield from _members(type_, "names", type_.names, low, high)
        yield from _no_numbers(type_)
        yield from _members(type_, "flags", type_.flags, 0, type_.width - 1)
    for name, written in subject.spec.types.items():
        limits = written.raw_range
        if not isinstance(limits, Range) or not limits.is_constant:
            continue
        for member, value in (written.enum or {}).items():
            number = value if isinstance(value, int) else value.value
            if not limits.low.constant <= number <= limits.high.constant:
                text = f"{number} is outside {formatting.span(limits)}, the raw range"
                yield Finding(("types", name, "enum", member), text, "check the value, and `raw_range`")


def _no_numbers(type_: Type) -> Findings:
    """Named numbers that are no number of the type under any parameters, or whose name has another meaning."""
    numbers = [valid for _, valid in valid_raws(type_).distinct() if isinstance(valid, RawInterval)]
    low, high = type_.raw_limits
    for member in type_.names if type_.is_number else ():
        path, no_value = (*type_.path, "names", member.name), type_.no_value(member.value)
        if member.name in RESERVED:
            text = f"`{member.name}` is reserved here: in golden frames, it is another value"
            yield Finding(path, text, "choose another name", key=True)
        elif member.name in [no_value.name for no_value in type_.no_values]:
            yield Finding(path, f"`{member.name}` is in `no_value` as well", "choose another name", key=True)
        elif no_value is not None:
            text = f"{member.value} has no value, since it is `{no_value.name}` of `no_value`"
            yield Finding(path, text, "keep it in `names` if it is a number, in `no_value` if not")
        elif low <= member.value <= high and not any(valid.low <= member.value <= valid.high for valid in numbers):
            yield Finding(
                path, f"{member.value} is outside the range of this type", "widen the range, or write it in `no_value`"
            )


def _members(type_: Type, key: str, members: tuple[Member, ...], low: int, high: int) -> Findings:
    first: dict[int, str] = {}
    for member in members:
        path: DocumentPath = (*type_.path, key, member.name)
        if member.value in first:
            text = f"`{member.name}` and `{first[member.value]}` are both {member.value}"
            related = RelatedItem((*type_.path, key, first[member.value]), f"`{first[member.value]}`", key=True)
            yield Finding(path, text, "give each a different value", related=(related,))
        elif not low <= member.value <= high:
            what = "bit " if key == "flags" else ""
            text = (
                f"{what}{member.value} is outside {low}..{high}, the limits of {formatting.counted(type_.width, 'bit')}"
            )
            mask = aliases.limit(member.value, ("flags",))
            bits = f"bits count from 0{f'; {mask}' if mask else ''}" if key == "flags" else ""
            yield Finding(path, text, bits or "check the value, and the sign and width in `raw`")
        first.setdefault(member.value, member.name)
