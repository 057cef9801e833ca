"""The Jinja2 environment, with the same options for every target."""

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

    An undefined name is an error. Nothing is escaped automatically. Spec text is untrusted: each target passes filters
    that escape it for its language, and its templates apply one of them to every such text.
    """
    env = _environment(resources.TEMPLATES / target)
    env.filters.update(filters)
    return env


@functools.cache
def _environment(folder: Path) -> jinja2.Environment:
    """Cached, so that templates are compiled once; Jinja2 detects changed templates."""
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
    """Stores compiled templates in the folder of Python's compiled modules, under the same rules.

    Options are not part of a template, so the key contains the text of this module. Filters are not part of it either:
    Jinja2 would apply them to constants during compilation, but no template of canwright does so.
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
