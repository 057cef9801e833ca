"""Resolver of types and units."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeVar

from ..diagnostics.diagnostic import DocumentPath
from ..document.document import Document, read_document
from ..language import edition as schema, suggestions
from ..language.notation import Multiple
from ..model.deprecation import Deprecation
from ..model.types import IDENTITY, Bound, ByParameter, Encoding, Linear, Member, Order, Parameter, Range, Type, Unit
from ..templating import resources
from .context import Context

T = TypeVar("T")


@functools.cache
def read_units() -> tuple[Document, dict[str, Unit]]:
    """The units of units.yaml, with their document."""
    document, _ = read_document(resources.UNITS)
    if not isinstance(document.data, dict):
        raise TypeError(f"{document.name} is not a mapping of units")
    units = {
        name: Unit(name=name, symbol=e["symbol"], dbc=e["dbc"], quantity=e["quantity"], title=e["title"])
        for name, e in document.data.items()
    }
    return document, units


def resolve_types(
    context: Context, spec: schema.EditionSpec, units: Mapping[str, Unit], parameters: Mapping[str, Parameter]
) -> dict[str, Type]:
    return {
        name: _TypeResolver(context, spec.byte_order, units, parameters, spec.effects, ("types", name)).resolve(
            name, written
        )
        for name, written in spec.types.items()
    }


def bare_type(context: Context, raw: tuple[Encoding, int], order: Order, path: DocumentPath) -> Type:
    """The type of a field with only a raw format: a number without scale, unit or range."""
    encoding, width = raw
    letter = {Encoding.UNSIGNED: "u", Encoding.SIGNED: "i", Encoding.FLOAT: "f"}[encoding]
    empty = context.text(path, None)
    always = ByParameter.always
    return Type(
        name=f"{letter}{width}",
        width=width,
        encoding=encoding,
        order=order,
        unit=None,
        linear=always(IDENTITY),
        raw_range=always(None),
        enum=(),
        flags=(),
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
    context: Context
    order: Order
    units: Mapping[str, Unit]
    parameters: Mapping[str, Parameter]
    effects: Mapping[str, schema.EffectSpec]
    path: DocumentPath

    def resolve(self, name: str, spec: schema.TypeSpec) -> Type:
        encoding, width = spec.raw
        linear = self._linear(spec)
        return Type(
            name=name,
            width=width,
            encoding=encoding,
            order=spec.byte_order or self.order,
            unit=self._unit(spec.unit),
            linear=linear,
            raw_range=self._raw_range(spec, linear),
            enum=tuple(self._member(("enum", n), n, m) for n, m in (spec.enum or {}).items()),
            flags=tuple(self._member(("flags", n), n, f) for n, f in (spec.flags or {}).items()),
            plausible=self._plausible(spec, linear),
            title=self.context.title(self.path, spec.title, name),
            about=self.context.text((*self.path, "about"), spec.about),
            differs=self.context.text((*self.path, "differs"), spec.differs),
            path=self.path,
        )

    def _unit(self, name: str | None) -> Unit | None:
        if name is not None and name not in self.units:
            text, hint = f"there is no unit `{name}`", suggestions.unit(name, self.units)
            self.context.report((*self.path, "unit"), "unknown-reference", text, hint)
        return self.units.get(name or "")

    def _member(self, at: DocumentPath, name: str, written: int | schema.MemberSpec | schema.FlagSpec) -> Member:
        path = (*self.path, *at)
        if isinstance(written, int):
            return Member(
                name=name,
                renamed_from=None,
                deprecated=None,
                value=written,
                without_effects=(),
                title=self.context.title(path, None, name),
                about=self.context.text(path, None),
            )
        value = written.value if isinstance(written, schema.MemberSpec) else written.bit
        title = self.context.title(path, written.title, name)
        return Member(
            name=name,
            renamed_from=written.renamed_from,
            deprecated=deprecation(written.deprecated),
            value=value,
            without_effects=self._without_effects(path, written),
            title=title,
            about=self.context.text((*path, "about"), written.about),
        )

    def _without_effects(self, path: DocumentPath, written: schema.MemberSpec | schema.FlagSpec) -> tuple[str, ...]:
        names = written.without_effects if isinstance(written, schema.MemberSpec) else []
        found = (
            self.context.find((*path, "without_effects", i), "effect", n, self.effects) for i, n in enumerate(names)
        )
        return tuple(name for name, effect in zip(names, found, strict=True) if effect is not None)

    def _linear(self, spec: schema.TypeSpec) -> ByParameter[Linear]:
        scale = self._multiples("scale", 1 if spec.scale is None else spec.scale)
        offset = self._multiples("offset", 0 if spec.offset is None else spec.offset)
        if scale.parameter and offset.parameter not in (None, scale.parameter):
            self.context.report(
                (*self.path, "offset"),
                "two-parameters",
                "scale and offset depend on two parameters",
                "use one parameter for both",
            )
            offset = ByParameter.always(_number(0))
        by = scale.parameter or offset.parameter
        if by is None:
            return ByParameter.always(self._line(scale.constant, offset.constant))
        names = scale.cases if scale.parameter else offset.cases
        return ByParameter(
            parameter=by, constant=None, cases={n: self._line(scale.at({by: n}), offset.at({by: n})) for n in names}
        )

    def _line(self, scale: Multiple | None, offset: Multiple | None) -> Linear | None:
        """Scale and offset as one conversion; None if one is unknown or invalid, or if they are incompatible."""
        known = {None, *(name for name, parameter in self.parameters.items() if not parameter.is_choice)}
        if scale is None or offset is None or not {scale.parameter, offset.parameter} <= known:
            return None
        if offset.value and offset.parameter != scale.parameter:
            text = "scale and offset are not multiples of one parameter"
            by = scale.parameter or offset.parameter
            self.context.report((*self.path, "offset"), "two-parameters", text, f"write both as NUMBER*{by}")
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

    def _need_number(self, at: DocumentPath, name: str | None) -> None:
        """Reports a factor that is not a known number parameter."""
        if name is None:
            return
        factor = self.context.find((*self.path, *at), "parameter", name, self.parameters)
        if factor is not None and factor.is_choice and not self.context.is_invalid(("parameters", factor.name)):
            text = f"`{name}` is a choice among values, not a `number`, so it cannot be a factor"
            self.context.report((*self.path, *at), "parameter-kind", text, f"write {{by: {name}, …}} with its values")

    def _cases(self, key: str, parameter_name: str, written: Mapping[str, Literal["none"] | T]) -> dict[str, T | None]:
        """One entry for each value of a parameter, in the order of the parameter."""
        path = (*self.path, key)
        parameter = self.context.find((*path, "by"), "parameter", parameter_name, self.parameters)
        if parameter is None:
            return {}
        if not parameter.is_choice and self.context.is_invalid(("parameters", parameter_name)):
            return {}
        if not parameter.is_choice:
            text = f"`{parameter_name}` has no `values`, so `{key}` cannot depend on them"
            self.context.report(
                (*path, "by"),
                "parameter-kind",
                text,
                f"use a parameter with `values`, or write a multiple, for example 2*{parameter_name}",
            )
            return {}
        known = {value.name: value for value in parameter.values}
        for name in written:
            self.context.find((*path, name), f"value of `{parameter_name}`:", name, known, key=True)
        missing = [name for name in known if name not in written]
        if len(missing) > len(set(written) - set(known)):
            hint = "add them; write `none` if the manual states no value"
            text = f"`{key}` has no value for {', '.join(missing)}"
            self.context.report(path, "incomplete-choice", text, hint, key=True)
        return {name: _none_or(written[name]) for name in known if name in written}

    def _raw_range(self, spec: schema.TypeSpec, linear: ByParameter[Linear]) -> ByParameter[Range]:
        if spec.raw_range is not None and spec.range is not None:
            self.context.report(
                (*self.path, "range"), "two-ranges", "there are both `range` and `raw_range`", "keep one"
            )
        if spec.raw_range is not None and spec.raw[0] is Encoding.FLOAT:
            text = "`raw_range` is in raw integers, but this is a float"
            self.context.report((*self.path, "raw_range"), "two-ranges", text, "write `range`", key=True)
        for key in ("offset", "plausible") if spec.scale == "none" else ():
            if getattr(spec, key) is not None:
                text = f"`{key}` is in the unit, but there is no scale"
                self.context.report((*self.path, key), "two-ranges", text, "remove it, or write a scale", key=True)
        raw = self._spans("raw_range", spec.raw_range)
        times = any(line.times for _, line in linear.distinct() if line is not None)
        if times and spec.raw[0] is Encoding.FLOAT:
            text = "the scale of a float cannot be a multiple of a parameter"
            self.context.report((*self.path, "scale"), "parameter-kind", text, "omit `scale`, or write a number")
        if times and any(not limits.is_constant for _, limits in raw.distinct() if limits is not None):
            text = "both scale and raw range depend on number parameters"
            hint = "write `raw_range` in integers, or `range` in multiples of the parameter of the scale"
            self.context.report((*self.path, "raw_range"), "two-parameters", text, hint)
            return ByParameter.always(None)
        if spec.range is None:
            return raw
        if spec.scale == "none":
            text = "`range` is in the unit, but there is no scale"
            self.context.report(
                (*self.path, "range"), "two-ranges", text, "write `raw_range` in raw integers", key=True
            )
            return raw
        span = self._spans("range", spec.range)
        if spec.raw[0] is Encoding.FLOAT:
            return span
        if linear.parameter is not None and span.parameter not in (None, linear.parameter):
            self.context.report(
                (*self.path, "range"),
                "two-parameters",
                "scale and range depend on two parameters",
                "use one parameter for both",
            )
            return raw
        by = linear.parameter or span.parameter
        names = linear.cases if linear.parameter else span.cases
        cases = {n: (span.at({by or "": n}), linear.at({by or "": n})) for n in names or [""]}
        if not all(self._is_like_scale(limits, line) for limits, line in cases.values()):
            return raw
        raw_cases = {name: _raw_of(*pair) for name, pair in cases.items()}
        return (
            ByParameter.always(raw_cases[""])
            if by is None
            else ByParameter(parameter=by, constant=None, cases=raw_cases)
        )

    def _is_like_scale(self, limits: Range | None, line: Linear | None) -> bool:
        """Whether a range is a multiple of the same parameter as the scale; reports it if not."""
        if limits is None or line is None or line.times is None:
            return True
        ends = (limits.low, limits.high)
        if any(end.constant or end.parameter not in (None, line.times) for end in ends):
            text = f"the scale is a multiple of `{line.times}`, but this range is not"
            hint = f"write, for example, -{line.times}..{line.times}, or write `raw_range`"
            self.context.report((*self.path, "range"), "two-parameters", text, hint)
        elif limits.low.coefficient > limits.high.coefficient:
            text = "the range is empty: its low end is above its high end"
            self.context.report((*self.path, "range"), "value", text, f"check both ends; `{line.times}` is positive")
        else:
            return True
        return False

    def _plausible(self, spec: schema.TypeSpec, linear: ByParameter[Linear]) -> Range | None:
        plausible = self._spans("plausible", spec.plausible).constant
        times = any(line.times for _, line in linear.distinct() if line is not None)
        if plausible is None or (plausible.is_constant and not times):
            return plausible
        text = "`plausible` depends on a number parameter, which is not in any frame"
        self.context.report(
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


def _none_or(value: Literal["none"] | T) -> T | None:
    return None if value == "none" else value


def _number(value: int) -> Multiple:
    """A default multiple: a number without notation."""
    return Multiple(Fraction(value), None, "")


def _raw_of(span: Range | None, linear: Linear | None) -> Range | None:
    """The raw integers of a range of values; a parameter that is a factor of scale and range cancels."""
    if span is None or linear is None or linear.scale == 0:
        return None
    if linear.times is not None:
        span = Range(Bound(span.low.coefficient), Bound(span.high.coefficient))

    def raw(bound: Bound) -> Bound:
        return Bound((bound.constant - linear.offset) / linear.scale, bound.coefficient / linear.scale, bound.parameter)

    low, high = raw(span.low), raw(span.high)
    if linear.scale < 0:
        low, high = high, low
    if low.parameter is None:
        low = Bound(Fraction(math.ceil(low.constant)))
    if high.parameter is None:
        high = Bound(Fraction(math.floor(high.constant)))
    return Range(low, high)
