"""Texts of the documents, by language."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from ...templating import resources
from ...templating.data_files import read_data


@functools.cache
def labels() -> Mapping[str, Mapping[str, str]]:
    """The texts of every language by name."""
    return read_data(resources.TEMPLATES / "handover/labels.yaml")  # type: ignore[no-any-return]
