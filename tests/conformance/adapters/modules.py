"""Import of generated packages, of which several versions are in one process."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType


def load(folder: Path, *names: str) -> Sequence[ModuleType]:
    """Modules of one package in a folder, freshly imported."""
    package = names[0].partition(".")[0]
    kept = {name: sys.modules.pop(name) for name in _modules(package)}
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    try:
        return [importlib.import_module(name) for name in names]
    finally:
        sys.path.remove(str(folder))
        for name in _modules(package):
            del sys.modules[name]
        sys.modules.update(kept)


def _modules(package: str) -> Sequence[str]:
    return [name for name in sys.modules if name.partition(".")[0] == package]
