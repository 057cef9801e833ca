"""Types, units and parameters of a spec, resolved."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeVar

from . import hints, resources, schema, source
from .context import Context
from .model import (
    IDENTITY,
    Bound,
    Dependent,
    Encoding,
    Linear,
    Member,
    Order,
    Parameter,
    ParameterValue,
    Path,
    Range,
    Type,
    Unit,
)
from .notation import Printed

T = TypeVar("T")


def read_units() -> tuple[source.Document, dict[str, Unit]]:
    """The unit vocabulary."""
    document, _ = source.read(resources.UNITS)
    if not isinstance(document.data, dict):
        raise TypeError(f"{document.name} is not a mapping of units")
    units = {name: Unit(name, e["symbol"], e["dbc"], e["quantity"], e["title"]) for name, e in document.data.items()}
    return document, units


def resolve_parameters(context: Context, written: Mapping[str, schema.ParameterSpec]) -> dict[str, Parameter]:
    result = {}
    for name, spec in written.items():
        path: Path = ("parameters", name)
        if (spec.values is None) == (spec.number is None):
            both = spec.values is not None
            text = f"`{name}` has both `values` and `number`" if both else f"`{name}` has neither `values` nor `number`"
            hint = "keep one" if both else "values: [A, B] is a choice, number: {} a number"
            context.report(path, "parameter-kind", text, hint, key=True)
        values: tuple[ParameterValue, ...] = ()
        if isinstance(spec.values, list):
            values = tuple(
                ParameterValue(str(n), n if isinstance(n, int) else None, context.title(path, None, str(n)))
                for n in spec.values
            )
        elif spec.values is not None:
            values = tuple(
                ParameterValue(n, None, context.title((*path, "values", n), v.title, n)) for n, v in spec.values.items()
            )
        result[name] = Parameter(
            name,
            values,
            spec.number.min if spec.number else None,
            spec.number.max if spec.number else None,
            context.title(path, spec.title, name),
            context.text((*path, "about"), spec.about),
        )
    return result


def resolve_types(
    context: Context, spec: schema.EditionSpec, units: Mapping[str, Unit], parameters: Mapping[str, Parameter]
) -> dict[str, Type]:
    return {
        name: _TypeResolver(context, spec.byte_order, units, parameters, ("types", name)).resolve(name, written)
        for name, written in spec.types.items()
    }


def bare_type(context: Context, raw: tuple[Encoding, int], order: Order, path: Path) -> Type:
    """The type of a field that names a raw format only: a number without scale, unit or range."""
    encoding, width = raw
    letter = {Encoding.UNSIGNED: "u", Encoding.SIGNED: "i", Encoding.FLOAT: "f"}[encoding]
    empty = context.text(path, None)
    always = Dependent.always
    return Type(
        f"{letter}{width}",
        width,
        encoding,
        order,
        None,
        always(IDENTITY),
        always(None),
        (),
        (),
        None,
        empty,
        empty,
        path,
    )


@dataclass
class _TypeResolver:
    context: Context
    order: Order
    units: Mapping[str, Unit]
    parameters: Mapping[str, Parameter]
    path: Path

    def resolve(self, name: str, spec: schema.Type) -> Type:
        encoding, width = spec.raw
        linear = self._linear(spec)
        return Type(
            name,
            width,
            encoding,
            spec.byte_order or self.order,
            self._unit(spec.unit),
            linear,
            self._raw_range(spec, linear),
            tuple(self._member(("enum", n), n, m) for n, m in (spec.enum or {}).items()),
            tuple(self._member(("flags", n), n, f) for n, f in (spec.flags or {}).items()),
            self._spans("plausible", spec.plausible).constant,
            self.context.title(self.path, spec.title, name),
            self.context.text((*self.path, "about"), spec.about),
            self.path,
        )

    def _unit(self, name: str | None) -> Unit | None:
        if name is not None and name not in self.units:
            text, hint = f"there is no unit `{name}`", hints.unit(name, self.units)
            self.context.report((*self.path, "unit"), "unknown-reference", text, hint)
        return self.units.get(name or "")

    def _member(self, at: Path, name: str, written: int | schema.Member | schema.Flag) -> Member:
        title = None if isinstance(written, int) else written.title
        value = (
            written
            if isinstance(written, int)
            else written.value
            if isinstance(written, schema.Member)
            else written.bit
        )
        return Member(name, value, self.context.title((*self.path, *at), title, name))

    def _linear(self, spec: schema.Type) -> Dependent[Linear]:
        scale, offset = self._scale(spec.scale), self._offset(spec.offset)
        if scale.parameter and offset.parameter not in (None, scale.parameter):
            self.context.report(
                (*self.path, "offset"),
                "two-parameters",
                "scale and offset depend on two parameters",
                "let both name one parameter",
            )
            offset = Dependent.always(Fraction(0))
        by = scale.parameter or offset.parameter
        if by is None:
            return Dependent.always(_linear_of(scale.constant, offset.constant))
        names = scale.cases if scale.parameter else offset.cases
        return Dependent(by, None, {n: _linear_of(scale.at({by: n}), offset.at({by: n})) for n in names})

    def _scale(self, written: schema.Scale | None) -> Dependent[Printed]:
        if isinstance(written, schema.ScaleBy):
            return Dependent(written.by, None, self._cases("scale", written.by, written.__pydantic_extra__))
        return Dependent.always(Printed(Fraction(1), "") if written is None else _none_or(written))

    def _offset(self, written: Fraction | schema.OffsetBy | None) -> Dependent[Fraction]:
        if isinstance(written, schema.OffsetBy):
            return Dependent(written.by, None, self._cases("offset", written.by, written.__pydantic_extra__))
        return Dependent.always(written or Fraction(0))

    def _cases(self, key: str, parameter_name: str, written: Mapping[str, Literal["none"] | T]) -> dict[str, T | None]:
        """One entry for every value of the parameter, in the parameter's order; findings for what is amiss."""
        path = (*self.path, key)
        parameter = self.context.find((*path, "by"), "parameter", parameter_name, self.parameters)
        if parameter is None:
            return {}
        if not parameter.is_choice and self.context.is_amiss(("parameters", parameter_name)):
            return {}
        if not parameter.is_choice:
            text = f"`{parameter_name}` has no `values`, so `{key}` cannot depend on them"
            self.context.report((*path, "by"), "parameter-kind", text, "give it `values`, or write a range like 0..2*N")
            return {}
        known = {value.name: value for value in parameter.values}
        for name in written:
            self.context.find((*path, name), f"value of `{parameter_name}`:", name, known, key=True)
        missing = [name for name in known if name not in written]
        if len(missing) > len(set(written) - set(known)):
            hint = "write `none` where the manual gives none"
            text = f"`{key}` says nothing for {', '.join(missing)}"
            self.context.report(path, "incomplete-choice", text, hint, key=True)
        return {name: _none_or(written[name]) for name in known if name in written}

    def _raw_range(self, spec: schema.Type, linear: Dependent[Linear]) -> Dependent[Range]:
        if spec.raw_range is not None and spec.range is not None:
            self.context.report(
                (*self.path, "range"), "two-ranges", "both `range` and `raw_range` are given", "keep one"
            )
        raw = self._spans("raw_range", spec.raw_range)
        if spec.range is None:
            return raw
        if spec.scale == "none":
            text = "`range` is in the unit, and without a scale no value is"
            self.context.report((*self.path, "range"), "two-ranges", text, "write `raw_range`", key=True)
            return raw
        span = self._spans("range", spec.range)
        if spec.raw[0] is Encoding.FLOAT:
            return span
        if linear.parameter is not None and span.parameter not in (None, linear.parameter):
            self.context.report(
                (*self.path, "range"),
                "two-parameters",
                "scale and range depend on two parameters",
                "let both name one parameter",
            )
            return raw
        by = linear.parameter or span.parameter
        if by is None:
            return Dependent.always(_raw_of(span.constant, linear.constant))
        names = linear.cases if linear.parameter else span.cases
        return Dependent(by, None, {n: _raw_of(span.at({by: n}), linear.at({by: n})) for n in names})

    def _spans(self, key: str, written: Range | schema.RangeBy | None) -> Dependent[Range]:
        if isinstance(written, schema.RangeBy):
            return Dependent(written.by, None, self._cases(key, written.by, written.__pydantic_extra__))
        if written is not None:
            for bound in (written.low, written.high):
                if bound.parameter is not None:
                    self.context.find((*self.path, key), "parameter", bound.parameter, self.parameters)
        return Dependent.always(written)


def _none_or(value: Literal["none"] | T) -> T | None:
    return None if value == "none" else value


def _linear_of(scale: Printed | None, offset: Fraction | None) -> Linear | None:
    return None if scale is None or offset is None else Linear(scale.value, offset, scale.text)


def _raw_of(span: Range | None, linear: Linear | None) -> Range | None:
    """The raw integers whose values lie in a range of values."""
    if span is None or linear is None or linear.scale == 0:
        return None

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
