"""Raw integers without a value are outside the numbers of their type, and each has one name."""

from __future__ import annotations

from ..model import formatting
from ..model.types import Type
from ..semantics.valid_raws import RawInterval, valid_raws, width_limits
from .rule import CheckInput, Finding, Findings

RESERVED = ("none", "nan", "inf")
"""Words of golden frames for other things."""


def check(subject: CheckInput) -> Findings:
    for type_ in subject.edition.types:
        if type_.no_values and type_.joined is not None:
            text = "`no_value` is for integers, but this type is a text or has decimal digits"
            yield Finding((*type_.path, "no_value"), text, "remove it, or write u or i in `raw`", key=True)
        elif type_.is_number:
            yield from _names(type_)


def _names(type_: Type) -> Findings:
    (least, most), taken = type_.raw_limits, dict[str, range]()
    for no_value in type_.no_values:
        path, raws = (*type_.path, "no_value", no_value.name), no_value.raws
        shared = next((name for name, used in taken.items() if _overlap(raws, used)), None)
        taken[no_value.name] = raws
        if no_value.name in RESERVED:
            text = f"`{no_value.name}` is reserved here: in golden frames, it is another value"
            yield Finding(path, text, "choose another name", key=True)
        elif raws[0] < least or raws[-1] > most:
            bits = formatting.counted(type_.width, "bit")
            text = f"{formatting.raws(raws)} is outside {least}..{most}, the limits of {bits}"
            hint = "check the raw integers, and the sign and width in `raw`"
            if raws[-1] > most and raws[-1] < 1 << type_.width:
                signed = range(raws.start - (1 << type_.width), raws.stop - (1 << type_.width))
                hint = f"write {formatting.raws(signed)}, since the type is signed"
            yield Finding(path, text, hint)
        elif shared is not None:
            text = f"`{no_value.name}` and `{shared}` have raw integers in common"
            yield Finding(path, text, "give each raw integer one name")
        elif number := _number_among(type_, raws):
            text = f"{formatting.raws(raws)} is among the numbers {number.start}..{number.stop - 1} of this type"
            yield Finding(
                path, text, "write a `raw_range` of the numbers, without parameters; or check the raw integers"
            )
    if least <= type_.number_limits[1] < type_.number_limits[0] <= most + 1:
        yield Finding((*type_.path, "no_value"), "no raw integer is left for a number", "write `enum`", key=True)


def _overlap(first: range, second: range) -> bool:
    return first.start < second.stop and second.start < first.stop


def _number_among(type_: Type, raws: range) -> range | None:
    """The numbers of a type, under some parameters, that some raw integers are among; None if they are outside."""
    valid = valid_raws(type_)
    known = [v for _, v in valid.distinct()] + ([width_limits(type_)] if valid.parameter else [])
    numbers = (range(v.low, v.high + 1) for v in known if isinstance(v, RawInterval))
    return next((interval for interval in numbers if _overlap(raws, interval)), None)
