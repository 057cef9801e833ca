"""Resolver of parameters."""

from __future__ import annotations

from collections.abc import Mapping

from ..diagnostics.diagnostic import DocumentPath
from ..language import edition as schema
from ..model.types import Parameter, ParameterValue
from .context import Context


def resolve_parameters(context: Context, written: Mapping[str, schema.ParameterSpec]) -> dict[str, Parameter]:
    result = {}
    for name, spec in written.items():
        path: DocumentPath = ("parameters", name)
        if (spec.values is None) == (spec.number is None):
            both = spec.values is not None
            text = f"`{name}` has both `values` and `number`" if both else f"`{name}` has neither `values` nor `number`"
            hint = "keep one" if both else "write values: [A, B] for a choice, or number: {} for a number"
            context.report(path, "parameter-kind", text, hint, key=True)
        values: tuple[ParameterValue, ...] = ()
        if isinstance(spec.values, list):
            values = tuple(
                ParameterValue(
                    name=str(n),
                    number=n if isinstance(n, int) else None,
                    title=context.title(path, None, str(n)),
                    about=context.text(path, None),
                )
                for n in spec.values
            )
        elif spec.values is not None:
            values = tuple(
                ParameterValue(
                    name=n,
                    number=None,
                    title=context.title(at, v.title, n),
                    about=context.text((*at, "about"), v.about),
                )
                for n, v in spec.values.items()
                for at in [(*path, "values", n)]
            )
        result[name] = Parameter(
            name=name,
            values=values,
            minimum=spec.number.min if spec.number else None,
            maximum=spec.number.max if spec.number else None,
            title=context.title(path, spec.title, name),
            about=context.text((*path, "about"), spec.about),
        )
    return result
