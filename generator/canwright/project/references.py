"""References to editions: a file, standard input, a git revision, or an edition of the spec folder."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from ..diagnostics.diagnostic import nearest
from ..document.document import MAX_BYTES
from ..templating.resources import SPECS
from .loader import FRAMES_SUFFIX, Loaded, load, spec_files


class UnknownEditionError(Exception):
    """An unknown edition."""


STANDARD_INPUT = "-"


def find(reference: str, folder: Path, *, for_output: bool = True) -> Loaded:
    """The edition of a reference.

    It is `my.yaml`, `-` for standard input, `HEAD~1:spec/lamp/v1.yaml`, `:spec/lamp/v1.yaml` for the index of git, or
    `v1` or `lamp/v1` below `folder`, or else in the package. Golden frames beside a file are loaded and checked;
    other references have none. See `load` for `for_output`. Raises UnknownEditionError, SpecError and OSError.
    """
    if reference == STANDARD_INPUT:
        return _load_content(sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>")
    file = Path(reference)
    if file.is_file():
        return load(file, for_output=for_output)
    revision, colon, path = reference.partition(":")
    if colon and path:
        here = path if path.startswith(("/", "./", "../")) else f"./{path}"
        return _load_content(_git(reference, revision, "cat-file", "blob", f"{revision}:{here}"), reference)
    known: dict[str, Path] = {}
    for files in (spec_files(folder), spec_files(SPECS)):
        same_name = [f for f in files if f.stem == reference]
        if len(same_name) > 1:
            names = ", ".join(f"`{f.parent.name}/{f.stem}`" for f in same_name)
            raise UnknownEditionError(f"`{reference}` is ambiguous; write the family, too: {names}")
        named = {name: f for f in files for name in (f.stem, f"{f.parent.name}/{f.stem}")}
        if reference in named:
            return load(named[reference], for_output=for_output)
        known = named | known
    holding = next((name for name, f in known.items() if "/" in name and _is_of(f, reference)), None)
    if holding:
        hint = f"write `{holding}`, or rename that file to {reference}.yaml"
        raise UnknownEditionError(f"no file has the name of the edition `{reference}`; {hint}")
    hint = nearest(reference, known) or "write a file, an edition, or REVISION:FILE"
    raise UnknownEditionError(f"there is no file and no edition `{reference}`; {hint}")


def _is_of(file: Path, edition: str) -> bool:
    """Whether a file states that it describes this edition."""
    line = rf"^edition: *([\"']?){re.escape(edition)}\1 *(#.*)?$"
    with file.open(encoding="utf-8", errors="replace") as text:
        return re.search(line, text.read(MAX_BYTES), re.MULTILINE) is not None


@dataclass(frozen=True)
class FolderChanges:
    """The specs of a folder that differ from a git revision: in pairs, old first, and those added or removed since."""

    pairs: tuple[tuple[Loaded, Loaded], ...]
    added: tuple[Loaded, ...]
    removed: tuple[Loaded, ...]


def since(revision: str, folder: Path) -> FolderChanges:
    """The specs below `folder` that differ from those at a git revision, without golden frames.

    An edition whose file is renamed is paired by its name. Raises UnknownEditionError, SpecError and OSError.
    """
    before, after = _contents_at(revision, folder), {f.relative_to(folder).as_posix(): f for f in spec_files(folder)}
    same = {name for name in before.keys() & after.keys() if before[name] == after[name].read_bytes()}
    old = {
        name: _load_content(before[name], f"{revision}:{(folder / name).as_posix()}") for name in before.keys() - same
    }
    new = {name: load(after[name], for_output=False) for name in after.keys() - same}
    pairs = {name: name for name in old.keys() & new.keys() if _family(old[name]) == _family(new[name])}
    editions = {_edition(new[name]): name for name in sorted(new.keys() - pairs.keys())}
    for name in sorted(old.keys() - pairs.keys()):
        if renamed := editions.pop(_edition(old[name]), None):
            pairs[name] = renamed
    return FolderChanges(
        tuple((old[name], new[pairs[name]]) for name in sorted(pairs)),
        tuple(new[name] for name in sorted(new.keys() - set(pairs.values()))),
        tuple(old[name] for name in sorted(old.keys() - pairs.keys())),
    )


def _family(item: Loaded) -> str:
    return item.specification.edition.family


def _edition(item: Loaded) -> tuple[str, str]:
    return item.specification.edition.family, item.specification.edition.name


def _contents_at(revision: str, folder: Path) -> dict[str, bytes]:
    """The specs below a folder at a git revision, by their paths from it."""
    if not folder.is_dir():
        raise UnknownEditionError(f"there is no folder {folder.as_posix()}/; give the folder of the specs")
    in_folder = ("-C", str(folder))
    entries = _git(revision, revision, *in_folder, "ls-tree", "-r", "-z", revision).decode("utf-8", "surrogateescape")
    blobs = [entry.partition("\t")[::2] for entry in entries.split("\0") if entry.startswith("100")]
    blob_of = {name: facts.split()[2] for facts, name in blobs if PurePosixPath(name).match("*/*.yaml")}
    return {
        name: _git(revision, revision, *in_folder, "cat-file", "blob", blob)
        for name, blob in blob_of.items()
        if name.count("/") == 1 and not name.endswith(FRAMES_SUFFIX)
    }


def _git(reference: str, revision: str, *arguments: str) -> bytes:
    if revision.startswith("-"):
        raise UnknownEditionError(f"`{revision}` is not a revision; write, for example, HEAD~1")
    try:
        run = subprocess.run(["git", *arguments], capture_output=True, check=False)
    except FileNotFoundError:
        raise UnknownEditionError(f"`{reference}` requires git, which is not installed; install it") from None
    if run.returncode:
        reason = run.stderr.decode("utf-8", "replace").strip().removeprefix("fatal: ").split("\n")[0]
        raise UnknownEditionError(f"git has no `{reference}`: {reason}")
    return run.stdout


def _load_content(content: bytes, name: str) -> Loaded:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "spec.yaml"
        file.write_bytes(content)
        return load(file, name)
