"""The record of a successful `generate` or `check`, so that the same run with nothing to do is not computed again.

A record is used only if everything that the run depends on is the same: arguments, folder, environment, Python and the
installed packages, the files of canwright, the specs and golden frames, the manifest and every file of the output. All
files are compared by the digests of their content, not by their times. Where something cannot be determined, there is
no record; nor where a target of another package is installed, since it may read files that canwright does not know.

Imported before the other modules of a run, so that the record describes them as they were; imports little, and makes
no named tuples, to be fast.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Sequence
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

from ..output.manifest import is_intact, read_manifest
from ..output.paths import OutputError, content_of, digest, digest_of, digest_of_regular
from ..templating import resources

if TYPE_CHECKING:
    from ..output.writer import Content

RECORDED = ("generate", "check")
"""Commands whose runs are recorded."""

ENVIRONMENT = ("CANWRIGHT_MAX_SIZE", "NO_COLOR", "_CANWRIGHT_COMPLETE")
"""Variables that affect these commands; the last one is that of shell completion."""

MAX_RECORDS = 200

_MAX_SIZE = 1 << 20
"""Bytes of a record; a larger one is neither written nor read."""


class Printed:
    """What a run with nothing to do prints, on standard output and on standard error."""

    def __init__(self, out: str, error: str = "") -> None:
        self.out = out
        self.error = error


class _Record:
    def __init__(
        self,
        *,
        state: str,
        files: Sequence[str],
        folder: str,
        targets: Sequence[str],
        manifest: str,
        printed: Sequence[str],
    ) -> None:
        self.state = state
        self.files = files
        self.folder = folder
        self.targets = targets
        self.manifest = manifest
        self.printed = printed


class RunRecord:
    """The record of runs with these arguments in this folder; without arguments, nothing is recorded."""

    def __init__(self, arguments: Sequence[str] = ()) -> None:
        self._arguments = list(arguments)
        folder = cache_folder() if self._arguments and self._arguments[0] in RECORDED else None
        self._file = folder and folder / f"{_digest([str(Path.cwd()), sys.path, self._arguments])}.json"
        self._surroundings = self._surrounding_digest() if self._file else None
        self._files: Sequence[str] = ()
        self._state: str | None = None

    def printed(self) -> Printed | None:
        """What the run would print, if it is recorded and has nothing to do; else None."""
        record = _read(self._file) if self._file and self._surroundings else None
        if record is None or record.state != self._state_digest(record.files):
            return None
        folder = Path(record.folder)
        if self._arguments[0] == "generate" and not os.access(folder, os.W_OK):
            return None
        return Printed(*record.printed) if is_intact(folder, record.manifest, record.targets) else None

    def watch(self, files: Sequence[Path]) -> None:
        """Remembers the state of the files that the run is about to read."""
        self._files = [str(file) for file in files]
        self._state = self._state_digest(self._files)

    def save(self, folder: Path, content: Content, printed: Printed) -> None:
        """Records a successful run with this content, unless something that it depends on changed during the run."""
        if self._file is None or self._state is None:
            return
        self._surroundings = self._surrounding_digest()
        if self._state != self._state_digest(self._files):
            return
        try:
            manifest = digest(content.manifest_after(read_manifest(folder)).json_bytes())
        except (OSError, OutputError):
            return
        record = _Record(
            state=self._state,
            files=self._files,
            folder=str(folder),
            targets=content.targets,
            manifest=manifest,
            printed=[printed.out, printed.error],
        )
        _write(self._file, record)

    def _surrounding_digest(self) -> str | None:
        """The digest of what every run depends on; None if it cannot be determined."""
        if any(hasattr(finder, "find_distributions") for finder in sys.meta_path if finder is not PathFinder):
            return None
        try:
            variables = [os.environ.get(name) for name in ENVIRONMENT]
            python = [sys.version, list(sys.flags), sys.path]
            return _digest([self._arguments, str(Path.cwd()), variables, python, [*_packages()], [*_own_files()]])
        except (OSError, ValueError):
            return None

    def _state_digest(self, files: Sequence[str]) -> str | None:
        """The digest of what this run depends on besides its output; None if it cannot be determined."""
        try:
            present = [[file, os.path.realpath(file), digest_of(Path(file))] for file in files]
            return self._surroundings and _digest([self._surroundings, present, [*_names(Path("spec"))]])
        except (OSError, ValueError):
            return None


def cache_folder() -> Path | None:
    """The folder of records, by the convention of the system; None without a home folder."""
    if sys.platform == "win32":
        variable, default = "LOCALAPPDATA", "~/AppData/Local"
    elif sys.platform == "darwin":
        variable, default = "", "~/Library/Caches"
    else:
        variable, default = "XDG_CACHE_HOME", "~/.cache"
    folder = Path(os.environ.get(variable, ""))
    try:
        return (folder if folder.is_absolute() else Path(default).expanduser()) / "canwright"
    except RuntimeError:
        return None


def _digest(value: object) -> str:
    return digest(json.dumps(value).encode())


def _names(folder: Path) -> Iterator[object]:
    """The names in a folder and in its folders: they show a spec that was added."""
    if folder.is_dir():
        for path in sorted(folder.iterdir()):
            yield [path.name, sorted(file.name for file in path.iterdir()) if path.is_dir() else None]


def _packages() -> Iterator[object]:
    """The installed packages: their names with versions, and their entry points.

    Raises ValueError for a target of another package, and for packages in an archive.
    """
    for folder in (Path(path) for path in sys.path):
        if folder.is_file():
            raise ValueError(f"{folder} is an archive")
        for name in sorted(path.name for path in folder.iterdir()) if folder.is_dir() else ():
            if name.lower().endswith((".dist-info", "egg-info")):
                points = content_of(folder / name / "entry_points.txt") or b""
                if b"canwright.targets" in points and name.partition("-")[0] != "canwright":
                    raise ValueError(f"{name} has a target")
                yield [name, digest(points)]


def _own_files() -> Iterator[object]:
    """The modules, templates and data of canwright with their digests, without the examples of `explain`."""
    for top in (resources.PACKAGE, resources.TEMPLATES):
        for name, folders, files in os.walk(top):
            folder = Path(name)
            yield name
            folders[:] = sorted(
                subfolder
                for subfolder in folders
                if subfolder != "__pycache__"
                and folder / subfolder not in (resources.EXAMPLES, resources.CHANGE_EXAMPLES)
            )
            yield from ([file, digest_of_regular(f"{name}/{file}")] for file in sorted(files))
    data_files = (
        *(resources.UNITS, resources.SYNONYMS, resources.SCHEMA),
        *(resources.QUESTIONS, resources.QUICK_START, resources.NO_ANSWER),
    )
    yield from ([data.name, digest_of_regular(str(data))] for data in data_files)


def _read(file: Path) -> _Record | None:
    """A record; None without one, and if it is not exactly what was written."""
    try:
        if file.stat().st_size > _MAX_SIZE:
            return None
        expected, _, content = file.read_bytes().partition(b"\n")
        record = _Record(**json.loads(content))
        texts = (record.state, record.folder, record.manifest, *record.files, *record.targets, *record.printed)
        valid = digest(content).encode() == expected and all(isinstance(text, str) for text in texts)
        return record if valid and len(record.printed) == 2 else None
    except (OSError, ValueError, TypeError, RecursionError):
        return None


def _write(file: Path, record: _Record) -> None:
    """Replaces a record in one step, readable by its user only; without an error where that is impossible."""
    import tempfile

    content = json.dumps(vars(record)).encode()
    if len(content) > _MAX_SIZE // 2:
        return
    try:
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        descriptor, name = tempfile.mkstemp(dir=file.parent, suffix=".tmp")
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(digest(content).encode() + b"\n" + content)
        Path(name).replace(file)
        _remove_oldest(file.parent)
    except OSError:
        return


def _remove_oldest(folder: Path) -> None:
    records = sorted(folder.iterdir(), key=lambda record: record.stat().st_mtime)
    for record in records[:-MAX_RECORDS]:
        record.unlink(missing_ok=True)
