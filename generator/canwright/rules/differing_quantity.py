"""All types of a quantity have one unit and scale, or a reason in `differs`."""

from __future__ import annotations

from ..model import formatting
from ..model.types import Type
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    first: dict[str, Type] = {}
    for type_ in subject.edition.types:
        if type_.unit is None or type_.enum or type_.flags or any(type_.differs.values()):
            continue
        first_type = first.setdefault(type_.unit.quantity, type_)
        if (first_type.unit, first_type.linear) != (type_.unit, type_.linear):
            own, expected = _resolution(type_), _resolution(first_type)
            text = f"`{type_.name}` has a resolution of {own}, but `{first_type.name}` of {expected}"
            yield Finding(
                type_.path,
                text,
                f"the quantity of both is {type_.unit.quantity}; check the scales, or give the reason in `differs`",
                key=True,
            )


def _resolution(type_: Type) -> str:
    return formatting.with_cases(formatting.scale(type_))
