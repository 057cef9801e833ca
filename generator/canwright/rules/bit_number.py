"""The position of a big-endian field or selector of less than a byte has the number of a bit."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import EditionSpec, FieldSpec, Selector
from ..model.layout import Space
from ..model.types import Order
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for path, part in _positioned(subject.spec, ()):
        width, order = _format(subject.spec, part)
        if width < 8 and order is Order.BIG and part.at.space is Space.DATA and part.at.bit is None:
            name = f"`{path[-1]}`" if isinstance(part, FieldSpec) else "this selector"
            text = f"{name} is big-endian and at byte {part.at.byte}, without a bit number: it starts at bit 7, the highest"
            yield Finding((*path, "at"), text, _hint(part, width))


def _positioned(part: object, path: DocumentPath) -> Iterator[tuple[DocumentPath, FieldSpec | Selector]]:
    """All fields and selectors of a spec, as they are written, with their paths."""
    if isinstance(part, FieldSpec | Selector):
        yield path, part
    elif dataclasses.is_dataclass(part):
        for key in dataclasses.fields(part):
            yield from _positioned(getattr(part, key.name), (*path, key.name))
    elif isinstance(part, Mapping):
        for name, inner in part.items():
            yield from _positioned(inner, (*path, name))
    elif isinstance(part, list | tuple):
        for i, inner in enumerate(part):
            yield from _positioned(inner, (*path, i))


def _format(spec: EditionSpec, part: FieldSpec | Selector) -> tuple[int, Order]:
    """Width and byte order; a field without a known type has the width of one that is not checked."""
    written = spec.types.get(part.type or "") if isinstance(part, FieldSpec) and part.raw is None else part
    raw = written.raw if written else None
    return raw[1] if raw else 8, (written and written.byte_order) or spec.byte_order


def _hint(part: FieldSpec | Selector, width: int) -> str:
    byte, count = part.at.byte, len(part.array or ()) if isinstance(part, FieldSpec) else 0
    if count:
        return f"write at: {byte}.7 if the first element is the highest; otherwise {byte}.0 and `byte_order: little`"
    if width == 1:
        return f"write at: {byte}.7 for the highest bit of the byte, or {byte}.0 for the lowest"
    return f"write at: {byte}.7 for bits {8 - width} to 7 of the byte, or {byte}.{width - 1} for bits 0 to {width - 1}"
