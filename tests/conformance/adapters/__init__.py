"""One adapter a target."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from canwright.targets.base import Described

from ..adapter import Adapter
from . import c, dbc, docs, python

ADAPTERS: Mapping[str, Callable[[Described, Path], Adapter]] = {
    "c": c.adapter,
    "python": python.adapter,
    "dbc": dbc.adapter,
    "docs": docs.adapter,
}
