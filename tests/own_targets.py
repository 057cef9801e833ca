"""Targets of other packages take no part in tests: they may reject specs, or write files that no test knows."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from unittest import mock

from canwright.targets import registry

COMMAND = "from tests.own_targets import hide; hide(); from canwright.__main__ import run; run()"
"""A program for `python -c` in the root of the project: `canwright` with its own targets."""


def own() -> list[EntryPoint]:
    """The entry points of canwright itself."""
    points = entry_points(group=registry.GROUP)
    return [point for point in points if point.dist and point.dist.name == registry.OWN_DISTRIBUTION]


def hide() -> None:
    """Makes this process ignore targets of other packages."""
    mock.patch.object(registry, "entry_points", own).start()
