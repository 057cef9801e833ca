"""Optional packages, and how to install a missing one."""

from __future__ import annotations

import importlib.util


class MissingPackageError(Exception):
    """A package that an output or a log needs is not installed; the message states how to install it."""


def require(package: str, project: str, purpose: str) -> None:
    """Raises MissingPackageError unless a package is installed; `project` is its name for pip."""
    if importlib.util.find_spec(package) is None:
        raise MissingPackageError(f"{purpose} needs {project}; run: pip install {project}")
