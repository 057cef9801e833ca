"""Resolver of parameters."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from operator import or_
from typing import NamedTuple

from ..diagnostics.diagnostic import DocumentPath
from ..language import edition as schema
from ..language.notation import last_id
from ..model import formatting
from ..model.layout import ParameterRole
from ..model.message import Address, Command, Direction, Message
from ..model.types import Parameter, ParameterValue
from .report import Report
from .titles import implied_title, titled


def resolve_parameters(written: Mapping[str, schema.ParameterSpec], languages: Sequence[str]) -> dict[str, Parameter]:
    return {
        name: Parameter(
            name=name,
            values=tuple(_values(spec, languages)),
            minimum=spec.number.min if spec.number else None,
            maximum=spec.number.max if spec.number else None,
            title=titled(spec.title, name),
            about=spec.about,
        )
        for name, spec in written.items()
    }


def _values(spec: schema.ParameterSpec, languages: Sequence[str]) -> list[ParameterValue]:
    if isinstance(spec.values, dict):
        return [
            ParameterValue(name=name, number=None, title=titled(value.title, name), about=value.about)
            for name, value in spec.values.items()
        ]
    return [
        ParameterValue(
            name=str(value),
            number=value if isinstance(value, int) else None,
            title=implied_title(str(value), languages),
            about=dict.fromkeys(languages, ""),
        )
        for value in spec.values or ()
    ]


class _Use(NamedTuple):
    """A use of a parameter in an id or a constant: the largest value that fits."""

    parameter: str
    path: DocumentPath
    largest: int


def with_limits_of_ids(
    report: Report,
    spec: schema.EditionSpec,
    parameters: Mapping[str, Parameter],
    addresses: Iterable[Address],
    commands: Iterable[Command],
) -> tuple[Parameter, ...]:
    """The parameters; those in ids and constants are whole numbers that fit there."""
    messages = [m for c in commands for m in c.messages if m.command == c.name]
    largest: dict[str, int] = {}
    for use in (*_in_addresses(spec, addresses, messages), *_in_constants(messages)):
        parameter, written = parameters[use.parameter], spec.parameters[use.parameter].number
        at: DocumentPath = ("parameters", use.parameter, "number")
        if parameter.is_choice:
            text = f"`{use.parameter}` is a choice among values, not a `number`, so it cannot be in an id or a constant"
            report.finding(use.path, "parameter-kind", text, "use a parameter with `number`")
        elif written and written.max is not None and written.max > use.largest:
            text = (
                f"`{use.parameter}` can be {formatting.exact(written.max)}, but this has room for {use.largest} at most"
            )
            report.finding(use.path, "id-space", text, f"write max: {use.largest} or less in `number` of the parameter")
        elif written and written.min is not None and written.min < 0:
            text = f"`{use.parameter}` is in an id or a constant, so it cannot be negative"
            report.finding((*at, "min"), "parameter-kind", text, "write 0 or more, or remove it")
        largest[use.parameter] = min(use.largest, largest.get(use.parameter, use.largest))
    return tuple(
        dataclasses.replace(
            p,
            whole=True,
            minimum=Fraction(math.ceil(p.minimum or 0)),
            maximum=Fraction(largest[name] if p.maximum is None else math.floor(p.maximum)),
        )
        if name in largest
        else p
        for name, p in parameters.items()
    )


def _in_addresses(
    spec: schema.EditionSpec, addresses: Iterable[Address], messages: Sequence[Message]
) -> Iterator[_Use]:
    for address in addresses:
        for direction in Direction:
            rule = address.rule(direction)
            if rule.parameter is None:
                continue
            both = spec.addresses[address.name].id is not None
            filled = reduce(or_, (m.id_mask for m in messages if m.id == rule), 0)
            above = filled & -(rule.parameter_step & -rule.parameter_step)
            last = (above & -above) - 1 if above else last_id(rule.extended)
            largest = (last - rule.highest) // rule.parameter_step
            yield _Use(rule.parameter, (*address.path, "id" if both else direction.value), max(largest, 0))


def _in_constants(messages: Iterable[Message]) -> Iterator[_Use]:
    fields = {field.path: field for message in messages for field in message.layout.fields}
    for path, field in fields.items():
        if isinstance(field.role, ParameterRole):
            yield _Use(field.role.parameter, (*path, field.role.key), field.type.raw_limits[1])
