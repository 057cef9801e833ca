"""The adapters, by the name of what they drive."""

from __future__ import annotations

from collections.abc import Mapping

from canwright.conformance.adapter import Adapter
from canwright.conformance.dbc import DbcAdapter
from canwright.conformance.python import PythonAdapter

from .c import CAdapter
from .columns import ColumnsAdapter
from .cxx import CxxAdapter
from .docs import DocsAdapter
from .javascript import JavaScriptAdapter
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
