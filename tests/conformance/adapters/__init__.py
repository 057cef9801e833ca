"""The adapters, by the name of what they drive."""

from __future__ import annotations

from collections.abc import Mapping

from ..adapter import Adapter
from .c import CAdapter
from .columns import ColumnsAdapter
from .cxx import CxxAdapter
from .dbc import DbcAdapter
from .docs import DocsAdapter
from .javascript import JavaScriptAdapter
from .python import PythonAdapter
from .reference import ReferenceAdapter
from .wireshark import WiresharkAdapter

ADAPTERS: Mapping[str, type[Adapter]] = {
    adapter.name: adapter
    for adapter in (
        ReferenceAdapter,
        CAdapter,
        CxxAdapter,
        PythonAdapter,
        JavaScriptAdapter,
        DbcAdapter,
        DocsAdapter,
        WiresharkAdapter,
        ColumnsAdapter,
    )
}
