"""Bindings and documents from one YAML description of a CAN protocol.

The public API: load a spec, read its model, decode and encode frames, generate, and write a target. Everything else may
change between minor versions. Names are imported when they are first used, so that the command line starts quickly.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from decimal import Decimal
    from fractions import Fraction

    from .api.codec import Decoder, Encoder
    from .diagnostics.diagnostic import Diagnostic, DocumentPath, Position, Severity, SpecError
    from .model.edition import Edition
    from .model.layout import Field, Layout
    from .model.message import Command, Direction, Message
    from .model.refusal import Refusal
    from .model.types import Assignment, Type
    from .semantics.decoder import Decoded, Identified, Rejection
    from .semantics.frame import CanFrame
    from .targets.base import BinaryOutput, EditionInput, NameProblem, Output, Target
    from .targets.options import Options, TargetOption

__version__ = "0.1.0"

__all__ = [
    "Assignment",
    "BinaryOutput",
    "CanFrame",
    "Command",
    "Decoded",
    "Decoder",
    "Diagnostic",
    "Direction",
    "DocumentPath",
    "Edition",
    "EditionInput",
    "Encoder",
    "Field",
    "Identified",
    "Layout",
    "Message",
    "NameProblem",
    "Options",
    "Output",
    "Position",
    "Refusal",
    "Rejection",
    "Severity",
    "SpecError",
    "Target",
    "TargetOption",
    "Type",
    "generate",
    "load",
]

_MODULES: Mapping[str, Sequence[str]] = {
    "api.codec": ("Decoder", "Encoder"),
    "diagnostics.diagnostic": ("Diagnostic", "DocumentPath", "Position", "Severity", "SpecError"),
    "model.edition": ("Edition",),
    "model.layout": ("Field", "Layout"),
    "model.message": ("Command", "Direction", "Message"),
    "model.refusal": ("Refusal",),
    "model.types": ("Assignment", "Type"),
    "semantics.decoder": ("Decoded", "Identified", "Rejection"),
    "semantics.frame": ("CanFrame",),
    "targets.base": ("BinaryOutput", "NameProblem", "Output", "EditionInput", "Target"),
    "targets.options": ("Options", "TargetOption"),
}


def load(file: str | os.PathLike[str], *, for_output: bool = True) -> EditionInput:
    """The edition in a spec file, with the golden frames beside it where there are any.

    Without `for_output`, it has no golden frames, and names are not compared with those that targets can use: it is not for
    `generate`, but decodes and encodes, in half the time. Raises SpecError with all findings when one of them is an error, and OSError.
    """
    from pathlib import Path

    from .project.loader import specification

    return specification(Path(file), for_output=for_output)


def generate(
    specifications: Sequence[EditionInput],
    targets: Sequence[str] | None = None,
    parameters: Mapping[str, str | int | float | Decimal | Fraction] | None = None,
    options: Mapping[str, str] | None = None,
) -> Mapping[str, bytes]:
    """The generated files by path, such as `c/include/lamp/v1.h`; writes nothing.

    `targets` are names of installed targets, by default those that `canwright generate` takes. `parameters` are fixed in the
    output of targets that can do this; each must be one of an edition, with a value that it can have there. `options` are
    options of the targets, as on the command line without `--`. Raises ValueError for an invalid parameter or option.
    """
    from .project import pipeline
    from .resolve.number_parameters import assignment
    from .targets.registry import default_targets, selected_options

    editions = [item.edition for item in specifications]
    names = default_targets() if targets is None else targets
    selected = selected_options(names, options or {}, editions)
    return pipeline.generate(specifications, names, assignment(editions, parameters or {}), selected).files


def __getattr__(name: str) -> object:
    for module, names in _MODULES.items():
        if name in names:
            return getattr(import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
