"""All types of a quantity have one unit and scale, or a reason in `differs`."""

from __future__ import annotations

from ..model import formatting
from ..model.types import Type
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    first: dict[str, Type] = {}
    first_scaled: dict[str, Type] = {}
    for type_ in subject.edition.types:
        if type_.unit is None or type_.enum or type_.flags or any(type_.differs.values()):
            continue
        quantity = type_.unit.quantity
        earlier = first.setdefault(quantity, type_)
        if earlier.unit is not None and earlier.unit != type_.unit:
            text = f"`{type_.name}` is in {type_.unit.symbol}, but `{earlier.name}` in {earlier.unit.symbol}"
            yield Finding(type_.path, text, _hint(quantity, "units"), key=True)
        elif not type_.is_bare_float:
            earlier = first_scaled.setdefault(quantity, type_)
            if earlier.linear != type_.linear:
                own, expected = _resolution(type_), _resolution(earlier)
                text = f"`{type_.name}` has a resolution of {own}, but `{earlier.name}` of {expected}"
                yield Finding(type_.path, text, _hint(quantity, "scales"), key=True)


def _hint(quantity: str, checked: str) -> str:
    return f"the quantity of both is {quantity}; check the {checked}, or give the reason in `differs`"


def _resolution(type_: Type) -> str:
    return formatting.with_cases(formatting.scale(type_))
