"""The installed targets: those of canwright and of other packages."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points

from .base import Target

GROUP = "canwright.targets"
OWN_DISTRIBUTION = "canwright"


class TargetError(Exception):
    """A target that is not installed or cannot be loaded; the message names the package and what to do."""


@functools.cache
def _installed() -> dict[str, EntryPoint]:
    """The entry points by name, sorted. Raises TargetError where two packages register one name."""
    found: dict[str, EntryPoint] = {}
    for point in sorted(entry_points(group=GROUP), key=lambda point: (point.name, point.value)):
        other = found.setdefault(point.name, point)
        if other.value != point.value:
            raise TargetError(
                f"{_package(other)} and {_package(point)} both register the target `{point.name}`; uninstall one of them"
            )
    return found


def _package(point: EntryPoint) -> str:
    return f"the package {point.dist.name}" if point.dist else f"`{point.value}`"


def target_names() -> Sequence[str]:
    """The names of all installed targets, sorted; loads none of them. Raises TargetError."""
    return tuple(_installed())


@functools.cache
def target(name: str) -> Target:
    """An installed target by its name. Raises TargetError."""
    point = _installed().get(name)
    if point is None:
        raise TargetError(f"there is no target `{name}`; installed are: {', '.join(_installed()) or 'none'}")
    try:
        loaded = point.load()
    except Exception as error:  # code of another package
        raise TargetError(f"the target `{name}` of {_package(point)} cannot be loaded: {error}") from error
    if not isinstance(loaded, Target):
        raise TargetError(
            f"the target `{name}` of {_package(point)} is not an instance of canwright.Target; "
            f"register an instance in the entry point group {GROUP}"
        )
    return loaded


def targets() -> Sequence[Target]:
    """All installed targets, in the order of their names. Raises TargetError."""
    return tuple(map(target, target_names()))


def own_targets() -> Sequence[Target]:
    """The targets of canwright itself, for output that must not depend on what else is installed."""
    return tuple(
        target(name) for name, point in _installed().items() if point.dist and point.dist.name == OWN_DISTRIBUTION
    )
