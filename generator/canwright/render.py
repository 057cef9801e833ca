"""The Jinja2 environment, set once for every target."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path

import jinja2

from . import resources


def environment(target: str, filters: Mapping[str, Callable[..., object]]) -> jinja2.Environment:
    """An environment for the templates of one target.

    An undefined name is an error. Nothing is escaped on its own: each target passes the filters that make text of a
    spec safe in its language, and its templates put every such text through one of them.
    """
    env = _environment(resources.TEMPLATES / target)
    env.filters.update(filters)
    return env


@functools.cache
def _environment(folder: Path) -> jinja2.Environment:
    """Kept, so that templates are compiled once; Jinja2 notices one that changes."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder, encoding="utf-8"),
        undefined=jinja2.StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
