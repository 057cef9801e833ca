"""The Jinja2 environment, set once for every target."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import jinja2

from . import resources


def environment(target: str, filters: Mapping[str, Callable[..., object]]) -> jinja2.Environment:
    """An environment for the templates of one target.

    An undefined name is an error. Nothing is escaped on its own: each target passes the filters that make text of a
    spec safe in its language, and its templates put every such text through one of them.
    """
    env = jinja2.Environment(
        loader=jinja2.FileSystemLoader(resources.TEMPLATES / target, encoding="utf-8"),
        undefined=jinja2.StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    env.filters.update(filters)
    return env
