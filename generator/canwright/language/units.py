"""The units of units.yaml."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from ..document.document import Document, read_document
from ..model.types import Unit
from ..templating import resources


@functools.cache
def read_units() -> tuple[Document, Mapping[str, Unit]]:
    """The units of units.yaml, with their document."""
    document, _ = read_document(resources.UNITS)
    if not isinstance(document.data, dict):
        raise TypeError(f"{document.name} is not a mapping of units")
    units = {
        name: Unit(name=name, symbol=e["symbol"], dbc=e["dbc"], quantity=e["quantity"], title=e["title"])
        for name, e in document.data.items()
    }
    return document, units
