"""One change of an output folder for everything that can go wrong: files are changed, added and removed."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from canwright.output.paths import MANIFEST
from canwright.output.writer import Content, write
from canwright.project.loader import specification
from canwright.project.pipeline import generate

from ..spec_texts import MINIMAL

Tree = Mapping[str, bytes]

USER_FILES = {"mine.txt": b"mine\n", "docs/en/v1/commands/mine.md": b"mine\n"}
"""Files that the user put there."""


@contextmanager
def memory_folder() -> Iterator[Path]:
    """A folder in memory where the system has one: a thousand small trees keep a disk busy for minutes."""
    memory = Path("/dev/shm")
    with TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as folder:
        yield Path(folder)


def tree(out: Path) -> Tree:
    """The content of every file by its path, hidden ones included; of a link, its destination."""
    contents = {}
    for file in sorted(out.rglob("*")):
        if file.is_symlink():
            contents[file.relative_to(out).as_posix()] = str(file.readlink()).encode()
        elif file.is_file():
            contents[file.relative_to(out).as_posix()] = file.read_bytes()
    return contents


@dataclass(frozen=True)
class Scenario:
    """A folder with the output of the old spec and files of the user, and the run that generates from the new spec."""

    before: Path
    spec: Path
    old: Tree
    new: Tree
    content: Content

    def restore(self, out: Path) -> None:
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(self.before, out)

    def arguments(self, out: Path) -> list[str]:
        return ["generate", "--spec", str(self.spec), "--out", str(out), "--target", "docs", "--target", "python"]

    @property
    def replaced(self) -> list[str]:
        """Generated files that this run changes or removes."""
        generated = {*self.old} - {*USER_FILES, MANIFEST}
        return sorted(path for path in generated if self.old[path] != self.new.get(path))


def make_scenario(folder: Path) -> Scenario:
    before, after, spec = folder / "before", folder / "after", folder / "spec.yaml"
    for path, data in USER_FILES.items():
        (before / path).parent.mkdir(parents=True, exist_ok=True)
        (before / path).write_bytes(data)
    spec.write_text(MINIMAL, "utf-8")
    write(before, generate([specification(spec)], ["docs"], {}))
    spec.write_text(MINIMAL.replace("dim:", "fade:").replace("1..4", "1..5"), "utf-8")
    content = generate([specification(spec)], ["docs", "python"], {})
    shutil.copytree(before, after)
    changes = write(after, content)
    assert len(changes.removed) >= 2 and len(changes.written) >= 10 and changes.unchanged >= 1
    assert any(path.startswith("docs/") and path in tree(before) for path in changes.written)
    return Scenario(before, spec, tree(before), tree(after), content)
