"""Resolver of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..language import edition as schema
from ..model.types import Parameter, ParameterValue
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
