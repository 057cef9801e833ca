"""Types and parameters as declarations of a generated module."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ...model.edition import Edition
from ...model.joined import JoinedText
from ...model.types import Bound, Encoding, Linear, Parameter, Range, Type, factors
from . import code, docstrings, text
from .imports import Imports


def parameter_key(parameter: Parameter, value: str) -> str:
    """A parameter value as a key: a member of its enum, or a number."""
    if parameter.is_numeric:
        return value
    return f"{text.class_name(parameter.name)}.{text.member_name(value)}"


def type_views(edition: Edition, imports: Imports) -> dict[str, TypeView]:
    """The types of the edition by name, without those of numbers that are always constant."""
    parameters = {p.name: p for p in edition.parameters}
    stored = {field.type.name for message in edition.all_messages() for field in message.layout.given}
    return {t.name: TypeView(t, parameters, imports) for t in edition.types if not t.is_number or t.name in stored}


class TypeView:
    """A type of the edition: a `Number` or `Float`, or an `enum` class."""

    def __init__(self, type_: Type, parameters: Mapping[str, Parameter], imports: Imports) -> None:
        self.enum = enum = text.class_name(type_.name) if type_.enum or type_.flags else ""
        """The name of the class; empty for a number."""
        self.constant = f"_{enum}" if enum else text.member_name(type_.name)
        """The name of the object that converts between raw integers and values."""
        self.meaning = docstrings.of_type(type_)
        """Unit, resolution and range in a sentence."""
        self.python = f"{enum} | int" if type_.enum else enum or _python(type_)
        """The type of a value."""
        made: list[code.Code]
        if type_.flags:
            kind, made = "FlagsType", [enum, f"0x{sum(1 << m.value for m in type_.flags):X}"]
        elif type_.enum:
            kind, made = "EnumType", [enum]
        else:
            kind = "Float" if type_.encoding is Encoding.FLOAT else "Integer" if type_.is_plain else "Number"
            made = _arguments(type_, parameters, imports)
        if type_.no_values:
            names = (f"{text.literal(n.name)}: ({n.raws[0]}, {n.raws[-1]})" for n in type_.no_values)
            made = [code.call(imports.use(kind), made), code.dict_of(names)]
            kind = f"Optional{kind}"
        self.declaration = code.call(imports.use(kind), made, f"{self.constant} = ")
        """The statement that makes that object."""


def _python(type_: Type) -> str:
    if isinstance(type_.joined, JoinedText):
        return "str"
    return ("int" if type_.is_plain else "float") + (" | None" if type_.no_values else "")


def _arguments(type_: Type, parameters: Mapping[str, Parameter], imports: Imports) -> list[code.Code]:
    """The arguments of a `Number` or `Float`."""
    is_float = type_.encoding is Encoding.FLOAT
    arguments: list[code.Code] = [str(type_.width)] if is_float else [str(limit) for limit in type_.number_limits]
    if type_.unit:
        arguments.append(text.literal(type_.unit.name))
    linear, span = type_.linear, type_.raw_range
    if linear.parameter is not None:
        cases = (
            f"{parameter_key(parameters[linear.parameter], n)}: {_scale(c, imports)}" for n, c in linear.cases.items()
        )
        arguments += [code.dict_of(cases, "scale="), f"scale_by={text.literal(text.attribute(linear.parameter))}"]
    elif linear.constant is None or not linear.constant.is_identity:
        arguments.append(f"scale={_scale(linear.constant, imports)}")
    arguments += _times(type_, parameters)
    if span.parameter is not None:
        limits = (
            _limits(r, imports, f"{parameter_key(parameters[span.parameter], n)}: ") for n, r in span.cases.items()
        )
        arguments += [code.dict_of(limits, "limits="), f"limits_by={text.literal(text.attribute(span.parameter))}"]
    elif span.constant is not None:
        arguments.append(_limits(span.constant, imports, "limits="))
    if type_.names:
        arguments.append(code.dict_of((f"{text.literal(m.name)}: {m.value}" for m in type_.names), "names="))
    return arguments


def _scale(linear: Linear | None, imports: Imports) -> str:
    if linear is None:
        return "None"
    return f"({linear.scale.numerator}, {linear.scale.denominator}, {exact(linear.offset, imports)})"


def _times(type_: Type, parameters: Mapping[str, Parameter]) -> list[code.Code]:
    """The argument `times`: the number parameter that multiplies the scale, or one for each case that has one."""
    linear = type_.linear
    if linear.parameter is None:
        times = linear.constant.times if linear.constant else None
        return [f"times={text.literal(_factor(times))}"] if times else []
    by = parameters[linear.parameter]
    cases = [(name, case.times) for name, case in linear.cases.items() if case is not None and case.times is not None]
    items = (f"{parameter_key(by, name)}: {text.literal(_factor(times))}" for name, times in cases)
    return [code.dict_of(items, "times=")] if cases else []


def _factor(times: str) -> str:
    """A factor with the attributes of its parameters."""
    above, below = (tuple(map(text.attribute, names)) for names in factors(times))
    return "*".join(above) + "".join(f"/{name}" for name in below)


def _limits(span: Range | None, imports: Imports, before: str) -> code.Code:
    if span is None:
        return f"{before}None"
    return code.tuple_of((_bound(span.low, imports), _bound(span.high, imports)), before)


def _bound(bound: Bound, imports: Imports) -> str:
    arguments = [exact(bound.constant, imports)]
    if bound.parameter is not None:
        arguments += [exact(bound.coefficient, imports), text.literal(text.attribute(bound.parameter))]
    return f"{imports.use('Bound')}({', '.join(arguments)})"


def exact(number: Fraction, imports: Imports) -> str:
    """A number as an exact expression."""
    if number.denominator == 1:
        return str(number.numerator)
    return f"{imports.use('Fraction')}({number.numerator}, {number.denominator})"


def inline_value(type_: Type, raw: str) -> str | None:
    """The value as an expression of the raw integer, rounded once; None where the scale is not constant."""
    linear = type_.linear.constant
    varies = type_.linear.parameter is not None or linear is None or linear.times
    if varies or linear is None or type_.encoding is Encoding.FLOAT or type_.no_values:
        return None
    if linear.is_identity:
        return raw
    factor, addend, divisor = linear.as_quotient
    dividend = raw if factor == 1 else f"{raw} * {factor}"
    if addend:
        dividend = f"{dividend} {'+' if addend > 0 else '-'} {abs(addend)}"
        return f"float({dividend})" if divisor == 1 else f"({dividend}) / {divisor}"
    return f"{dividend} / {divisor}"


class ParameterView:
    """A field of `Parameters`."""

    def __init__(self, parameter: Parameter, imports: Imports) -> None:
        name, use = text.attribute(parameter.name), imports.use
        values = [parameter_key(parameter, value.name) for value in parameter.values]
        given = [f"self.{name}", text.literal(name)]
        self.declaration: code.Code
        if parameter.is_choice:
            self.check = code.call(use("check_choice"), (*given, *values))
            self.declaration = f"{name}: {text.class_name(parameter.name)} | None = None"
            if parameter.is_numeric:
                self.declaration = code.Items(f"{name}: {use('Literal')}[", tuple(values), "] | None = None")
        else:
            self.declaration = f"{name}: {use('Real')} | None = None"
            limits = (_limit(parameter.minimum, imports), _limit(parameter.maximum, imports))
            self.check = code.call(use("check_number"), (*given, *limits, *["is_whole=True"] * parameter.whole))
        """The statement that checks its value."""
        self.doc = docstrings.of_parameter(parameter)


def _limit(limit: Fraction | None, imports: Imports) -> str:
    return "None" if limit is None else exact(limit, imports)
