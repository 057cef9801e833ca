"""The golden frames of an edition through one target, with the tools that are installed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..model.golden_frames import GoldenFrames
from ..targets.base import EditionInput
from . import c_selftest
from .adapter import Adapter
from .python import PythonAdapter
from .reference import ReferenceAdapter
from .runner import REASONS, Failure, Report, Runner

TARGETS = ("reference", "python", "dbc", "c")


class MissingToolError(Exception):
    """A target that cannot be asked; the message states what to install."""


def replay(target: str, item: EditionInput, frames: GoldenFrames, workdir: Path) -> Report:
    """Replays the golden frames through a target. Raises MissingToolError."""
    if target == "c":
        compiler = c_selftest.compiler()
        if compiler is None:
            raise MissingToolError("no C compiler found; install gcc or clang, or run: pip install ziglang")
        return c_selftest.replay(item, frames, compiler, workdir)
    kind = _adapter(target)
    try:
        adapter = kind.create(item, workdir)
    except Exception as error:  # of generated code
        report = Report(target, f"{item.edition.family} {item.edition.name}")
        report.failures.append(Failure(target, "load", None, f"raises {type(error).__name__}: {error}"))
        report.asked = report.failed = len(frames.entries)
        return report
    return Runner(item.edition, frames, adapter).run()


def reasons(target: str) -> Mapping[str, str]:
    """Why a target is not asked something, by the names in reports."""
    return {**REASONS, **(c_selftest.CANNOT if target == "c" else _adapter(target).cannot)}


def _adapter(target: str) -> type[Adapter]:
    if target == "reference":
        return ReferenceAdapter
    if target == "python":
        return PythonAdapter
    from .dbc import DbcAdapter  # cantools takes half a second to import

    return DbcAdapter
