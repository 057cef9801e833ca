"""Generation of the files of every target."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from ..model.types import Assignment
from ..output.writer import Content
from ..targets import registry
from ..targets.base import EditionInput
from ..targets.options import NO_OPTIONS, Options


def generate(
    specifications: Sequence[EditionInput],
    targets: Sequence[str],
    set_parameters: Assignment,
    options: Mapping[str, Options] = MappingProxyType({}),
) -> Content:
    """The files that `targets` generate from the editions, in memory; `options` are those of each target.

    Raises TargetError, also where a target generates two files whose paths are equal, or are on some systems because
    they differ in upper case only.
    """
    files: dict[str, bytes] = {}
    paths: dict[str, str] = {}
    for target in targets:
        selected = options.get(target, NO_OPTIONS)
        for output in registry.target(target).generate(specifications, set_parameters, selected):
            path = f"{target}/{output.path}"
            first = paths.setdefault(path.casefold(), path)
            if path in files or first != path:
                what = f"two files {path}" if first == path else f"the files {first} and {path}"
                raise registry.TargetError(
                    f"the target `{target}` generates {what}; rename the item of the spec that they are named after"
                )
            files[path] = output.content
    return Content(tuple(f"{d.edition.family} {d.edition.name}" for d in specifications), tuple(targets), files)
