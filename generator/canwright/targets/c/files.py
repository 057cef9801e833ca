"""Names of generated headers."""

from __future__ import annotations

SHARED = ("canwright.h", "canwright_exact.h", "canwright_float.h", "canwright_print.h", "canwright_selftest.h")
"""The headers that are the same for every protocol."""

SHARED_CXX = ("canwright.hpp",)
"""Those of C++."""

PARTS = ("", "_float", "_print")
"""The endings of the names of the headers of an edition."""
