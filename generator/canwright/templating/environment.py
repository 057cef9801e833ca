"""The Jinja2 environment, set once for every target."""

from __future__ import annotations

import functools
import pickle
import sys
from collections.abc import Callable, Mapping
from importlib.util import cache_from_source
from pathlib import Path

import jinja2
from jinja2.bccache import Bucket

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
        bytecode_cache=_CompiledTemplates(folder),
    )


class _CompiledTemplates(jinja2.FileSystemBytecodeCache):
    """Keeps compiled templates where Python keeps the compiled modules of a folder, and as it does.

    Neither options nor filters are part of a template, so this module's own text is of the key; no filter of canwright
    is applied to a constant, which Jinja2 would work out while it compiles.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(str(Path(cache_from_source(str(folder / "template.py"))).parent), "%s.jinja")

    def get_source_checksum(self, source: str) -> str:
        return super().get_source_checksum(_OPTIONS + source)

    def load_bytecode(self, bucket: Bucket) -> None:
        try:
            super().load_bytecode(bucket)
        except (OSError, EOFError, pickle.UnpicklingError):
            bucket.reset()

    def dump_bytecode(self, bucket: Bucket) -> None:
        if sys.dont_write_bytecode:
            return
        try:
            Path(self.directory).mkdir(parents=True, exist_ok=True)
            super().dump_bytecode(bucket)
        except OSError:
            return


_OPTIONS = Path(__file__).read_text("utf-8")
