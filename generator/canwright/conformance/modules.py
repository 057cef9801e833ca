"""Import of generated packages, of which several versions are in one process."""

from __future__ import annotations

import contextlib
import importlib
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import ModuleType


def load(folder: Path, *names: str) -> Sequence[ModuleType]:
    """Modules of one package in a folder, freshly imported."""
    with importable(folder, names[0].partition(".")[0]):
        return [importlib.import_module(name) for name in names]


@contextlib.contextmanager
def importable(folder: Path, package: str) -> Iterator[None]:
    """Lets a package in a folder be freshly imported, also by other files."""
    with without_modules(package):
        sys.path.insert(0, str(folder))
        importlib.invalidate_caches()
        try:
            yield
        finally:
            sys.path.remove(str(folder))


@contextlib.contextmanager
def without_modules(package: str) -> Iterator[None]:
    """Hides the imported modules of a package, so that it can be imported again; restores them at the end."""
    kept = {name: sys.modules.pop(name) for name in _modules(package)}
    try:
        yield
    finally:
        for name in _modules(package):
            del sys.modules[name]
        sys.modules.update(kept)


def _modules(package: str) -> Sequence[str]:
    return [name for name in sys.modules if name.partition(".")[0] == package]
