"""Equal specs are loaded once in a process, which takes most of the time of commands that read recordings."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest
from canwright.project import loader

Contents = tuple[bytes | None, ...]

load = loader.load


@functools.cache
def loaded(file: Path, name: str | None, for_output: bool, contents: Contents) -> loader.Loaded:
    return load(file, name, for_output=for_output)


@pytest.fixture(autouse=True)
def load_equal_specs_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def load_once(file: Path, name: str | None = None, *, for_output: bool = True) -> loader.Loaded:
        files = (file, loader.frames_file(file))
        return loaded(file, name, for_output, tuple(path.read_bytes() if path.is_file() else None for path in files))

    monkeypatch.setattr(loader, "load", load_once)
