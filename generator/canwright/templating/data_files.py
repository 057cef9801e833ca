"""YAML files of canwright itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_data(file: Path) -> Any:
    """The content of a file that is known to be valid."""
    return yaml.load(file.read_text("utf-8"), Loader=_LOADER)
