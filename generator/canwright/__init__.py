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
    from .diagnostics.diagnostic import Diagnostic, DocumentPath, Position, Severity, SpecError
    from .model.edition import Edition
    from .model.layout import Field, Layout
    from .model.message import Command, Direction, Message
    from .model.refusal import Refusal
    from .model.types import Assignment, Type
    from .semantics.decoder import Decoded, Decoder, Rejection
    from .semantics.encoder import Encoder
    from .semantics.exchange import check_reply
    from .semantics.frame import CanFrame
    from .targets.base import EditionInput, NameProblem, Options, Output, Target, TargetWithOptions

__version__ = "0.1.0"

__all__ = [
    "Assignment",
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
    "TargetWithOptions",
    "Type",
    "check_reply",
    "generate",
    "load",
]

_MODULES: Mapping[str, Sequence[str]] = {
    "diagnostics.diagnostic": ("Diagnostic", "DocumentPath", "Position", "Severity", "SpecError"),
    "model.edition": ("Edition",),
    "model.layout": ("Field", "Layout"),
    "model.message": ("Command", "Direction", "Message"),
    "model.refusal": ("Refusal",),
    "model.types": ("Assignment", "Type"),
    "semantics.decoder": ("Decoded", "Decoder", "Rejection"),
    "semantics.encoder": ("Encoder",),
    "semantics.exchange": ("check_reply",),
    "semantics.frame": ("CanFrame",),
    "targets.base": ("NameProblem", "Options", "Output", "EditionInput", "Target", "TargetWithOptions"),
}


def load(file: str | os.PathLike[str]) -> EditionInput:
    """The edition in a spec file, with the golden frames beside it where there are any.

    Raises SpecError with all findings when one of them is an error, and OSError.
    """
    from pathlib import Path

    from .project.loader import specification

    return specification(Path(file))


def generate(
    specifications: Sequence[EditionInput],
    targets: Sequence[str] | None = None,
    parameters: Assignment | None = None,
    options: Options | None = None,
) -> Mapping[str, bytes]:
    """The generated files by path, such as `c/include/lamp/v1.h`; writes nothing.

    `targets` are names of installed targets, all of them by default; `parameters` are values to fix in targets that can;
    `options` select nodes and the language of comments in a TargetWithOptions.
    """
    from .project import pipeline
    from .targets.base import Options
    from .targets.registry import target_names

    names = target_names() if targets is None else targets
    return pipeline.generate(specifications, names, parameters or {}, options or Options()).files


def __getattr__(name: str) -> object:
    for module, names in _MODULES.items():
        if name in names:
            return getattr(import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
