"""The valid raw integers of a type, as C conditions on `raw`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Bound, ByParameter, Encoding, Linear, Range, Type
from ...semantics.floats import bits_of, float_of
from ...semantics.valid_raws import (
    FiniteFloats,
    FlagBits,
    NamedRaws,
    RawInterval,
    ValidRaws,
    merged,
    valid_raws,
    width_limits,
)
from ..base import NameProblem
from .choices import Choice, choose, parameter_access
from .expressions import INT64, UINT64, Integer, integer, joined, raw_of
from .names import Names

RATIO_LIMIT = 1 << 30
"""The limit of factors whose product with a ratio fits into 64 bits."""

GREATEST = {32: Fraction(float.fromhex("0x1.fffffep+127")), 64: Fraction(float.fromhex("0x1.fffffffffffffp+1023"))}


class Condition(NamedTuple):
    """A condition on a raw integer."""

    expression: str
    uses_parameters: bool


ALWAYS = Condition("true", uses_parameters=False)


def valid(names: Names, type_: Type) -> Choice[Condition] | None:
    """The condition for valid raw integers; None if all are valid."""
    by = _unscaled(type_) if type_.encoding is Encoding.FLOAT else valid_raws(type_)
    choice = choose(names, by, lambda raws: _condition(type_, raws), _condition(type_, width_limits(type_)))
    return None if choice.subject is None and choice.otherwise == ALWAYS else choice


def _condition(type_: Type, raws: ValidRaws | None) -> Condition:
    """The condition for a valid raw integer, without the limits of its C type."""
    kind = integer(type_)
    if isinstance(raws, RawInterval):
        return _within(kind, raws)
    terms: list[str] = []
    if isinstance(raws, NamedRaws):
        terms = [joined("||", [within_run(kind, run) for run in raws.runs])]
    elif isinstance(raws, FlagBits):
        unnamed = ((1 << kind.width) - 1) & ~raws.mask
        source = f"({kind.unsigned.name})raw" if kind.signed else "raw"
        terms = [f"({source} & {kind.bits(unnamed)}) == 0u"] if unnamed else []
    elif raws is not None and raws.scaled is not None:
        for bound, sign, is_low in ((raws.scaled.low, ">=", True), (raws.scaled.high, "<=", False)):
            order = kind.bits(_order(type_.width, bound.constant, up=is_low))
            terms.append(f"canwright_order{type_.width}(raw.bits) {sign} {order}")
    nan = [is_nan(type_, "raw")] if type_.no_values else []
    return Condition(joined("||", [joined("&&", terms), *nan]), uses_parameters=False) if terms else ALWAYS


def _within(kind: Integer, raws: RawInterval) -> Condition:
    """The condition for a number within its limits, or for a raw integer without a value."""
    bounds = ((raws.low_bound, True), (raws.high_bound, False))
    dependent = [joined("||", _dependent(kind, bound, is_low)) for bound, is_low in bounds if bound is not None]
    numbers = [] if dependent else [range(raws.low, raws.high + 1)]
    runs = merged((*numbers, *raws.no_values))
    terms = [joined("&&", _between(kind, run.start, run.stop - 1)) for run in runs]
    if dependent:
        terms.insert(0, joined("&&", [*_between(kind, raws.low, raws.high), *dependent]))
    return ALWAYS if "" in terms else Condition(joined("||", terms), uses_parameters=bool(dependent))


def has_value(type_: Type) -> str:
    """The condition for a raw integer that is a number, whatever its range; empty if all are."""
    kind = integer(type_)
    if type_.no_values and type_.encoding is Encoding.FLOAT:
        return f"!({is_nan(type_, 'raw')})"
    named = [joined("&&", _between(kind, run[0], run[-1])) for run in merged(n.raws for n in type_.no_values)]
    return f"!({joined('||', named)})" if named else ""


def is_nan(type_: Type, subject: str) -> str:
    """The condition for NaN in a member or an argument."""
    kind, bits = integer(type_), type_.no_values[0].raws
    return f"({raw_of(type_, subject)} & {kind.bits(bits[-1])}) >= {kind.bits(bits[0])}"


def constant_limits(type_: Type) -> tuple[int, int]:
    """The smallest and largest raw integer, without limits that depend on a parameter."""
    raws = valid_raws(type_).constant
    return (raws.low, raws.high) if isinstance(raws, RawInterval) else type_.number_limits


def has_constant_limits(type_: Type) -> bool:
    """True if the valid raw integers do not depend on a parameter."""
    return valid_raws(type_).parameter is None and not _dependent_bounds(type_)


def problems(edition: Edition) -> Iterator[NameProblem]:
    """Ranges that cannot be checked with 64-bit integers."""
    for type_ in edition.types:
        path: DocumentPath = (*type_.path, "raw_range")
        bounds, two = _dependent_bounds(type_), {type_.linear.parameter, valid_raws(type_).parameter} - {None}
        if type_.encoding is Encoding.FLOAT and (bounds or len(two) > 1):
            text = "C has no check for a range of floats that depends on this"
            yield NameProblem(path, text, "use the parameter that the scale depends on")
        elif any(abs(factor) >= RATIO_LIMIT for bound in bounds for factor in _factors(bound)):
            text = "these factors are too large for a check with 64-bit integers in C"
            yield NameProblem(path, text, "use smaller ones")


def _dependent_bounds(type_: Type) -> list[Bound]:
    """The ends of ranges that depend on a number parameter."""
    every = [raws for _, raws in valid_raws(type_).distinct()]
    ends = [end for raws in every if isinstance(raws, RawInterval) for end in (raws.low_bound, raws.high_bound) if end]
    spans = [raws.scaled for raws in every if isinstance(raws, FiniteFloats) and raws.scaled]
    return ends + [end for span in spans for end in (span.low, span.high) if end.parameter]


def _between(kind: Integer, low: int, high: int) -> list[str]:
    least, most = kind.limits
    result = [f"raw >= {kind.literal(low)}"] if low > least else []
    return result + ([f"raw <= {kind.literal(high)}"] if high < most else [])


def within_run(kind: Integer, run: range) -> str:
    """The condition for one of some consecutive raw integers."""
    if len(run) == 1:
        return f"raw == {kind.literal(run[0])}"
    return joined("&&", _between(kind, run[0], run[-1]) or ["true"])


def _factors(bound: Bound) -> tuple[int, int, int]:
    """Factor, addend and divisor: the bound is `(factor * parameter + addend) / divisor`."""
    return Linear(bound.coefficient, bound.constant).as_quotient


def _dependent(kind: Integer, bound: Bound, is_low: bool) -> Sequence[str]:
    """The conditions of which one must be true for an end that depends on a parameter."""
    ratio = parameter_access(bound.parameter or "")
    function, sign = ("canwright_ceiling", ">=") if is_low else ("canwright_floor", "<=")
    limit = f"{function}(&{ratio}, {', '.join(INT64.literal(n) for n in _factors(bound))})"
    if kind != UINT64:
        within = f"(int64_t)raw {sign} {limit}" if kind != INT64 else f"raw {sign} {limit}"
    elif is_low:
        within = joined("||", ["raw > (uint64_t)INT64_MAX", f"(int64_t)raw >= {limit}"])
    else:
        within = joined("&&", ["raw <= (uint64_t)INT64_MAX", f"(int64_t)raw <= {limit}"])
    return f"{ratio}.denominator == 0u", within


def _unscaled(type_: Type) -> ByParameter[ValidRaws]:
    """The valid floats with ranges without the scale; those of the spec apply to the scaled value."""
    return type_.linear.combined(valid_raws(type_), _floats)


def _floats(linear: Linear | None, raws: ValidRaws | None) -> ValidRaws:
    limits = raws.scaled if isinstance(raws, FiniteFloats) else None
    if limits is None or linear is None:
        return FiniteFloats(None)
    ends = [(end.constant - linear.offset) / linear.scale for end in (limits.low, limits.high)]
    return FiniteFloats(Range(Bound(min(ends)), Bound(max(ends))))


def _order(width: int, bound: Fraction, up: bool) -> int:
    """The order of the float that is nearest to a bound and within it; both zeros are within a bound of zero."""
    sign = 1 << (width - 1)
    if bound == 0:
        return sign - 1 if up else sign
    bits = bits_of(width, float(max(-GREATEST[width], min(GREATEST[width], bound))))
    order = (2 * sign - 1) ^ bits if bits & sign else bits | sign
    while (_number(width, order) < bound) if up else (_number(width, order) > bound):
        order += 1 if up else -1
    return order


def _number(width: int, order: int) -> Fraction:
    sign = 1 << (width - 1)
    return Fraction(float_of(width, order & ~sign if order & sign else (2 * sign - 1) ^ order))
