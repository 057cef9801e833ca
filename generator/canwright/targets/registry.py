"""The installed targets: those of canwright and of other packages."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..model.edition import Edition
from .base import Target
from .options import OptionError, Options, TargetOption

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "canwright.targets"
OWN_DISTRIBUTION = "canwright"


class TargetError(Exception):
    """A target that is not installed or cannot be loaded; the message names the package and what to do."""


def entry_points() -> Sequence[EntryPoint]:
    """The entry points of all installed packages, as they register them."""
    from importlib.metadata import (
        entry_points,  # many commands need no targets, and this takes as long as loading a spec
    )

    return tuple(entry_points(group=GROUP))


@functools.cache
def _installed() -> dict[str, EntryPoint]:
    """The entry points by name, sorted. Raises TargetError where two packages register one name."""
    points: dict[str, EntryPoint] = {}
    for point in sorted(entry_points(), key=lambda point: (point.name, point.value)):
        first = points.setdefault(point.name, point)
        if first.value != point.value:
            raise TargetError(
                f"{_package(first)} and {_package(point)} both register the target `{point.name}`; uninstall one of them"
            )
    return points


def _package(point: EntryPoint) -> str:
    return f"the package {point.dist.name}" if point.dist else f"`{point.value}`"


def target_names() -> Sequence[str]:
    """The names of all installed targets, sorted; loads none of them. Raises TargetError."""
    return tuple(_installed())


def default_targets() -> Sequence[str]:
    """The names of the targets of a run that names none, sorted. Raises TargetError."""
    return tuple(name for name in target_names() if target(name).is_default)


@functools.cache
def target(name: str) -> Target:
    """An installed target by its name. Raises TargetError."""
    point = _installed().get(name)
    if point is None:
        raise TargetError(f"there is no target `{name}`; installed are: {', '.join(_installed()) or 'none'}")
    try:
        loaded = point.load()
    except (Exception, SystemExit) as error:  # code of another package
        reason = f"it exits with {error.code}" if isinstance(error, SystemExit) else error
        raise TargetError(f"the target `{name}` of {_package(point)} cannot be loaded: {reason}") from error
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


def declared_options() -> Mapping[str, Sequence[tuple[str, TargetOption[Any]]]]:
    """The options of all installed targets by name, each with the targets that have an option of that name.

    Raises TargetError.
    """
    declared: dict[str, list[tuple[str, TargetOption[Any]]]] = {}
    for name in target_names():
        for option in target(name).options:
            declared.setdefault(option.name, []).append((name, option))
    return declared


def selected_options(
    names: Sequence[str], texts: Mapping[str, str], editions: Sequence[Edition]
) -> Mapping[str, Options]:
    """The options of each of these targets, from the texts of options by name.

    Raises OptionError for a text that one of the targets cannot use, and TargetError.
    """
    declared = declared_options()
    values: dict[str, dict[TargetOption[Any], object]] = {name: {} for name in names}
    for name, text in texts.items():
        owners = dict(declared.get(name, ()))
        if not owners:
            raise OptionError(f"no target has the option --{name}")
        if not owners.keys() >= set(names):
            raise OptionError(
                f"--{name} affects only the target {' and '.join(owners)}; add --target {next(iter(owners))}"
            )
        for target_name in names:
            try:
                values[target_name][owners[target_name]] = owners[target_name].parse(text, editions)
            except ValueError as error:
                raise OptionError(f"--{name} {text}: {error}") from None
    return {name: Options(values[name]) for name in names}
