"""Generation of the files of every target."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model.types import Assignment
from ..output.writer import Content
from ..targets import registry
from ..targets.base import EVERYTHING, EditionInput, Options, Output, Target, TargetWithOptions


def generate(
    specifications: Sequence[EditionInput],
    targets: Sequence[str],
    set_parameters: Assignment,
    options: Options = EVERYTHING,
) -> Content:
    """The files that `targets` generate from the editions, in memory.

    `options` affect a TargetWithOptions. Raises TargetError, also where a target generates two files whose paths are equal, or are on some systems because
    they differ in upper case only.
    """
    files: dict[str, bytes] = {}
    paths: dict[str, str] = {}
    for target in targets:
        for output in _outputs(registry.target(target), specifications, set_parameters, options):
            path = f"{target}/{output.path}"
            other = paths.setdefault(path.casefold(), path)
            if path in files or other != path:
                what = f"two files {path}" if other == path else f"the files {other} and {path}"
                raise registry.TargetError(
                    f"the target `{target}` generates {what}; rename the item of the spec that they are named after"
                )
            files[path] = output.text.encode("utf-8")
    return Content(tuple(f"{d.edition.family} {d.edition.name}" for d in specifications), tuple(targets), files)


def _outputs(
    target: Target, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
) -> Iterator[Output]:
    if isinstance(target, TargetWithOptions):
        return target.generate(specifications, set_parameters, options)
    return target.generate(specifications, set_parameters)
