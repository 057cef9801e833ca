"""Families that cannot be the name of an npm package."""

from __future__ import annotations

from collections.abc import Iterator

from ...model.edition import Edition
from ..base import NameProblem

NODE_MODULES = frozenset(
    """assert async_hooks buffer child_process cluster console constants crypto dgram diagnostics_channel dns domain
    events fs http http2 https inspector module net os path perf_hooks process punycode querystring readline repl stream
    string_decoder sys timers tls trace_events tty url util v8 vm wasi worker_threads zlib""".split()  # noqa: SIM905
)
"""Modules of Node: an import of this name never finds a package."""
RESERVED = frozenset({"node_modules"})


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The name of the family, if npm reserves it."""
    if edition.family in NODE_MODULES or edition.family in RESERVED:
        text = f"the npm package cannot have the name `{edition.family}`, which Node uses itself"
        yield NameProblem(("family",), text, f"choose another name, for example {edition.family}_protocol")
