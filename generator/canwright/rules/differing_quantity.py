"""Types of one quantity have one unit and one scale, or say why not."""

from __future__ import annotations

from ..model import formatting
from ..model.types import Type
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    first: dict[str, Type] = {}
    for type_ in subject.edition.types:
        written = subject.spec.types.get(type_.name)
        if type_.unit is None or type_.enum or type_.flags or written is None or written.differs is not None:
            continue
        like = first.setdefault(type_.unit.quantity, type_)
        if (like.unit, like.linear) != (type_.unit, type_.linear):
            text = f"`{type_.name}` has {_step(type_)} a step, `{like.name}` {_step(like)}: two scales of {type_.unit.quantity}"
            yield Finding(type_.path, text, "if that is right, say why in `differs`", key=True)


def _step(type_: Type) -> str:
    return ", ".join(f"{step} ({names})" if names else step for names, step in formatting.scale(type_))
