"""Generation of the files of every target."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.types import Assignment
from ..output.writer import Content
from ..targets import registry
from ..targets.base import Specification


def generate(specifications: Sequence[Specification], targets: Sequence[str], set_parameters: Assignment) -> Content:
    """The files that `targets` generate from the editions, in memory.

    Raises TargetError, also where a target generates two files whose paths are equal, or are on some systems because
    they differ in upper case only.
    """
    files: dict[str, bytes] = {}
    paths: dict[str, str] = {}
    for target in targets:
        for output in registry.target(target).generate(specifications, set_parameters):
            path = f"{target}/{output.path}"
            other = paths.setdefault(path.casefold(), path)
            if path in files or other != path:
                what = f"two files {path}" if other == path else f"the files {other} and {path}"
                raise registry.TargetError(
                    f"the target `{target}` generates {what}; rename the item of the spec that they are named after"
                )
            files[path] = output.text.encode("utf-8")
    return Content(tuple(f"{d.edition.family} {d.edition.name}" for d in specifications), tuple(targets), files)
