"""Each end of a `range` is the value of a raw integer."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from ..language.edition import RangeBy
from ..model import formatting
from ..model.types import Encoding, Linear, Range, Type
from ..resolve.types import in_raw, whole_raws
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for type_ in subject.edition.types:
        written = subject.spec.types.get(type_.name)
        if written is not None and written.range is not None and type_.encoding is not Encoding.FLOAT:
            yield from islice(_findings(type_, written.range), 1)


def _findings(type_: Type, written: Range | RangeBy) -> Findings:
    for limits, linear in _cases(type_, written):
        exact = in_raw(limits, linear)
        raws = whole_raws(exact)
        if raws != exact and (not raws.is_constant or raws.low.constant <= raws.high.constant):
            ends = (limits.low, limits.high) if linear.scale > 0 else (limits.high, limits.low)
            end = ends[0] if raws.low != exact.low else ends[1]
            used = formatting.span(formatting.in_unit(raws, linear))
            text = f"{formatting.bound(end)} is between the values of two raw integers, so the range is {used}"
            yield Finding((*type_.path, "range"), text, f"write range: {used}, or raw_range: {formatting.span(raws)}")


def _cases(type_: Type, written: Range | RangeBy) -> Iterator[tuple[Range, Linear]]:
    """Each range with a scale that it is used with."""
    if isinstance(written, RangeBy):
        cases = [(limits, type_.linear.at({written.by: name})) for name, limits in written.by_value.items()]
    else:
        cases = [(written, linear) for _, linear in type_.linear.distinct()]
    for limits, linear in cases:
        if limits != "none" and linear is not None and linear.scale:
            yield limits, linear
