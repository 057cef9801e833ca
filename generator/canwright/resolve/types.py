"""Resolver of types and units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeVar

from ..diagnostics.diagnostic import DocumentPath
from ..language import edition as schema
from ..language.notation import Multiple, RawFormat
from ..language.units import read_units
from ..model.deprecation import Deprecation
from ..model.joined import JoinedDigits, JoinedText
from ..model.types import (
    IDENTITY,
    Bound,
    ByParameter,
    Encoding,
    Linear,
    Member,
    NoValue,
    Order,
    Parameter,
    Range,
    Type,
    factors,
)
from .report import Report
from .titles import implied_title, titled

T = TypeVar("T")


def resolve_types(report: Report, spec: schema.EditionSpec, parameters: Mapping[str, Parameter]) -> dict[str, Type]:
    return {
        name: _TypeResolver(report, spec, parameters, ("types", name)).resolve(name, written)
        for name, written in spec.types.items()
    }


_DIGIT = Range(Bound(Fraction(0)), Bound(Fraction(9)))


def bare_type(raw: RawFormat, order: Order, languages: Sequence[str], path: DocumentPath) -> Type:
    """The type of a field with only a raw format: a number without scale, unit or range."""
    encoding, width, joined = raw
    letter = {Encoding.UNSIGNED: "u", Encoding.SIGNED: "i", Encoding.FLOAT: "f"}[encoding]
    name = joined.format if joined else f"{letter}{width}"
    empty = dict.fromkeys(languages, "")
    always = ByParameter.always
    return Type(
        name=name,
        width=width,
        encoding=encoding,
        order=order,
        unit=None,
        linear=always(IDENTITY),
        raw_range=always(_DIGIT if isinstance(joined, JoinedDigits) else None),
        joined=joined,
        enum=(),
        flags=(),
        no_values=(),
        names=(),
        plausible=None,
        title=empty,
        about=empty,
        differs=empty,
        path=path,
    )


def deprecation(written: schema.DeprecatedSpec | None) -> Deprecation | None:
    return Deprecation(since=written.since, until=written.until) if written else None


@dataclass
class _TypeResolver:
    report: Report
    edition: schema.EditionSpec
    parameters: Mapping[str, Parameter]
    path: DocumentPath

    def resolve(self, name: str, spec: schema.TypeSpec) -> Type:
        encoding, width, joined = spec.raw
        linear = self._linear(spec)
        if isinstance(joined, JoinedText):
            joined = JoinedText(joined.count, joined.codec, spec.padding or 0)
        raw_range = self._raw_range(spec, linear)
        return Type(
            name=name,
            width=width,
            encoding=encoding,
            order=spec.byte_order or self.edition.byte_order,
            unit=read_units()[1][spec.unit] if spec.unit is not None else None,
            linear=linear,
            raw_range=ByParameter.always(_DIGIT) if isinstance(joined, JoinedDigits) else raw_range,
            joined=joined,
            enum=tuple(self._member(*member) for member in (spec.enum or {}).items()),
            flags=tuple(self._member(*flag) for flag in (spec.flags or {}).items()),
            no_values=tuple(self._no_value(width, *no_value) for no_value in (spec.no_value or {}).items()),
            names=tuple(self._member(*named) for named in (spec.names or {}).items()),
            plausible=self._plausible(spec, linear),
            title=titled(spec.title, name),
            about=spec.about,
            differs=spec.differs,
            path=self.path,
        )

    def _member(self, name: str, written: int | schema.NameSpec | schema.FlagSpec) -> Member:
        if isinstance(written, int):
            return Member(
                name=name,
                renamed_from=None,
                deprecated=None,
                value=written,
                without_effects=(),
                title=implied_title(name, self.edition.languages),
                about=dict.fromkeys(self.edition.languages, ""),
            )
        exempt = written.without_effects if isinstance(written, schema.MemberSpec) else ()
        return Member(
            name=name,
            renamed_from=written.renamed_from,
            deprecated=deprecation(written.deprecated),
            value=written.bit if isinstance(written, schema.FlagSpec) else written.value,
            without_effects=tuple(exempt),
            title=titled(written.title, name),
            about=written.about,
        )

    def _no_value(self, width: int, name: str, written: range | Literal["nan"] | schema.NoValueSpec) -> NoValue:
        spec = written if isinstance(written, schema.NoValueSpec) else None
        raws = written.raw if isinstance(written, schema.NoValueSpec) else written
        is_nan = raws == "nan"
        if raws == "nan":
            raws = range(INFINITY[width] + 1, 1 << width - 1)
        return NoValue(
            name=name,
            renamed_from=spec.renamed_from if spec else None,
            deprecated=deprecation(spec.deprecated) if spec else None,
            value=raws[-1],
            raws=raws,
            is_nan=is_nan,
            without_effects=(),
            title=titled(spec.title, name) if spec else implied_title(name, self.edition.languages),
            about=spec.about if spec else dict.fromkeys(self.edition.languages, ""),
        )

    def _linear(self, spec: schema.TypeSpec) -> ByParameter[Linear]:
        scale = self._multiples("scale", 1 if spec.scale is None else spec.scale)
        offset = self._multiples("offset", 0 if spec.offset is None else spec.offset)
        if scale.parameter and offset.parameter not in (None, scale.parameter):
            self.report.finding(
                (*self.path, "offset"),
                "two-parameters",
                "scale and offset depend on two parameters",
                "use one parameter for both",
            )
            offset = ByParameter.always(_number(0))
        return scale.combined(offset, self._line)

    def _line(self, scale: Multiple | None, offset: Multiple | None) -> Linear | None:
        """Scale and offset as one conversion; None if one is unknown or invalid, or if they are incompatible."""
        if scale is None or offset is None:
            return None
        names = {name for part in (scale, offset) if part.parameter for name in factors(part.parameter).names}
        if any(self.parameters[name].is_choice for name in names):
            return None
        if offset.value and offset.parameter != scale.parameter:
            text = "scale and offset are not multiples of one parameter"
            by = scale.parameter or offset.parameter
            self.report.finding((*self.path, "offset"), "two-parameters", text, f"write both as NUMBER*{by}")
            return None
        return Linear(scale.value, offset.value, scale.parameter, scale.text)

    def _multiples(
        self, key: str, written: int | Literal["none"] | Multiple | schema.ScaleBy | schema.OffsetBy
    ) -> ByParameter[Multiple]:
        if isinstance(written, (schema.ScaleBy, schema.OffsetBy)):
            cases = self._cases(key, written.by, written.by_value)
            for name, case in cases.items():
                self._need_number((key, name), case.parameter if case else None)
            return ByParameter(parameter=written.by, constant=None, cases=cases)
        if isinstance(written, Multiple):
            self._need_number((key,), written.parameter)
        return ByParameter.always(_number(written) if isinstance(written, int) else _none_or(written))

    def _need_number(self, at: DocumentPath, times: str | None) -> None:
        """Reports a factor that is not a number parameter."""
        for name in factors(times).names if times else ():
            if not self.parameters[name].is_choice:
                continue
            text = f"`{name}` is a choice among values, not a `number`, so it cannot be a factor"
            self.report.finding((*self.path, *at), "parameter-kind", text, f"write {{by: {name}, …}} with its values")

    def _cases(self, key: str, parameter_name: str, written: Mapping[str, Literal["none"] | T]) -> dict[str, T | None]:
        """One entry for each value of a parameter, in the order of the parameter."""
        path = (*self.path, key)
        parameter = self.parameters[parameter_name]
        if not parameter.is_choice:
            text = f"`{parameter_name}` has no `values`, so `{key}` cannot depend on them"
            self.report.finding(
                (*path, "by"),
                "parameter-kind",
                text,
                f"use a parameter with `values`, or write a multiple, for example 2*{parameter_name}",
            )
            return {}
        missing = [value.name for value in parameter.values if value.name not in written]
        if missing:
            hint = "add them; write `none` if the manual states no value"
            text = f"`{key}` has no value for {', '.join(missing)}"
            self.report.finding(path, "incomplete-choice", text, hint, key=True)
        return {value.name: _none_or(written[value.name]) for value in parameter.values if value.name in written}

    def _raw_range(self, spec: schema.TypeSpec, linear: ByParameter[Linear]) -> ByParameter[Range]:
        raw = self._spans("raw_range", spec.raw_range)
        times = any(line.times for _, line in linear.distinct() if line is not None)
        if times and spec.raw[0] is Encoding.FLOAT:
            text = "the scale of a float cannot be a multiple of a parameter"
            self.report.finding((*self.path, "scale"), "parameter-kind", text, "omit `scale`, or write a number")
        if times and any(not limits.is_constant for _, limits in raw.distinct() if limits is not None):
            text = "both scale and raw range depend on number parameters"
            hint = "write `raw_range` in integers, or `range` in multiples of the parameter of the scale"
            self.report.finding((*self.path, "raw_range"), "two-parameters", text, hint)
            return ByParameter.always(None)
        if spec.range is None:
            return raw
        span = self._spans("range", spec.range)
        if spec.raw[0] is Encoding.FLOAT:
            return span
        if linear.parameter is not None and span.parameter not in (None, linear.parameter):
            self.report.finding(
                (*self.path, "range"),
                "two-parameters",
                "scale and range depend on two parameters",
                "use one parameter for both",
            )
            return raw
        if not all(is_like_scale for _, is_like_scale in linear.combined(span, self._is_like_scale).named):
            return raw
        return linear.combined(span, _raw_of)

    def _is_like_scale(self, line: Linear | None, limits: Range | None) -> bool:
        """Whether a range is a multiple of the same parameter as the scale; reports it if not."""
        if limits is None or line is None or line.times is None:
            return True
        ends = (limits.low, limits.high)
        if any(end.constant or end.parameter not in (None, line.times) for end in ends):
            text = f"the scale is a multiple of `{line.times}`, but this range is not"
            hint = "write `raw_range`"
            if line.times.isidentifier():
                hint = f"write, for example, -{line.times}..{line.times}, or {hint}"
            self.report.finding((*self.path, "range"), "two-parameters", text, hint)
        elif limits.low.coefficient > limits.high.coefficient:
            text = "the range is empty: its low end is above its high end"
            self.report.finding((*self.path, "range"), "value", text, f"check both ends; `{line.times}` is positive")
        else:
            return True
        return False

    def _plausible(self, spec: schema.TypeSpec, linear: ByParameter[Linear]) -> Range | None:
        plausible = self._spans("plausible", spec.plausible).constant
        times = any(line.times for _, line in linear.distinct() if line is not None)
        if plausible is None or (plausible.is_constant and not times):
            return plausible
        text = "`plausible` depends on a number parameter, which is not in any frame"
        self.report.finding(
            (*self.path, "plausible"), "parameter-kind", text, "write numbers and a constant scale, or remove it"
        )
        return None

    def _spans(self, key: str, written: Range | schema.RangeBy | None) -> ByParameter[Range]:
        if isinstance(written, schema.RangeBy):
            cases = self._cases(key, written.by, written.by_value)
            for name, case in cases.items():
                self._need_numbers((key, name), case)
            return ByParameter(parameter=written.by, constant=None, cases=cases)
        self._need_numbers((key,), written)
        return ByParameter.always(written)

    def _need_numbers(self, at: DocumentPath, limits: Range | None) -> None:
        for name in dict.fromkeys((limits.low.parameter, limits.high.parameter) if limits else ()):
            self._need_number(at, name)


INFINITY = {32: 0xFF << 23, 64: 0x7FF << 52}
"""The bit pattern of infinity by width; those above, without the sign, are NaN."""


def _none_or(value: Literal["none"] | T) -> T | None:
    return None if value == "none" else value


def _number(value: int) -> Multiple:
    """A default multiple: a number without notation."""
    return Multiple(Fraction(value), None, "")


def _raw_of(linear: Linear | None, span: Range | None) -> Range | None:
    """The raw integers of a range of values."""
    if span is None or linear is None or linear.scale == 0:
        return None
    return whole_raws(in_raw(span, linear))


def whole_raws(raw: Range) -> Range:
    """The integers within a range; an end that depends on a parameter is not rounded."""
    return Range(_rounded(raw.low, math.ceil), _rounded(raw.high, math.floor))


def _rounded(end: Bound, to_integer: Callable[[Fraction], int]) -> Bound:
    """An end of a range of raw integers, as an integer if it is constant."""
    return Bound(Fraction(to_integer(end.constant))) if end.parameter is None else end


def in_raw(span: Range, linear: Linear) -> Range:
    """A range of values in multiples of a resolution above or below 0, not rounded.

    A parameter that is a factor of scale and range cancels.
    """
    if linear.times is not None:
        span = Range(Bound(span.low.coefficient), Bound(span.high.coefficient))

    def raw(bound: Bound) -> Bound:
        return Bound((bound.constant - linear.offset) / linear.scale, bound.coefficient / linear.scale, bound.parameter)

    low, high = raw(span.low), raw(span.high)
    return Range(low, high) if linear.scale > 0 else Range(high, low)
