"""Names of the generated package."""

from __future__ import annotations

SHARED = ("_columns.py", "arrow.py", "logs.py")
"""The modules of the runtime that are copied into the package of each family."""


def package_name(family: str) -> str:
    """The package of a family; it differs from that of the Python target, so that both can be installed."""
    return f"{family}_columns"
