"""New files beside those of the user: all of them or none, and never in place of an existing one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path


def write_new(files: Mapping[Path, str]) -> None:
    """Writes files that do not exist. Raises OSError, FileExistsError for an existing file, with nothing written."""
    folders = [folder for file in files for folder in reversed(file.parents) if not folder.exists()]
    made: list[Path] = []
    created: list[Path] = []
    try:
        for folder in dict.fromkeys(folders):
            folder.mkdir()
            made.append(folder)
        for file, text in files.items():
            with file.open("x", encoding="utf-8", newline="\n") as stream:
                created.append(file)
                stream.write(text)
    except BaseException:
        for file in created:
            file.unlink()
        for folder in reversed(made):
            folder.rmdir()
        raise
