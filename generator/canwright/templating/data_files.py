"""YAML files of canwright itself."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import yaml

from . import resources

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@functools.cache
def read_data(file: Path) -> Any:
    """The content of a file that is known to be valid."""
    return yaml.load(file.read_text("utf-8"), Loader=_LOADER)


def template_texts(path: str) -> Any:
    """The texts of a file of `templates/`, by language and name."""
    return read_data(resources.TEMPLATES / path)
