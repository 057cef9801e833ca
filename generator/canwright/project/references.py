"""References to editions: a file, a git revision of a file, or an edition of the spec folder."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

from ..diagnostics.diagnostic import nearest
from .loader import Loaded, load, spec_files


class UnknownEditionError(Exception):
    """An unknown edition."""


def find(reference: str, folder: Path, *, golden: bool = True) -> Loaded:
    """The edition of a reference: `my.yaml`, `HEAD~1:spec/lamp/v1.yaml`, or `v1` or `lamp/v1` below `folder`.

    Golden frames beside a file are loaded and checked, unless `golden` is False; those of a revision are not loaded.
    Raises UnknownEditionError, SpecError and OSError.
    """
    file = Path(reference)
    if file.is_file():
        return load(file, golden=golden)
    revision, colon, path = reference.partition(":")
    if colon and revision and path:
        return _from_git(reference, revision, path)
    known = {name: f for f in spec_files(folder) for name in (f.stem, f"{f.parent.name}/{f.stem}")}
    same_name = [f for f in spec_files(folder) if f.stem == reference]
    if len(same_name) > 1:
        names = ", ".join(f"`{f.parent.name}/{f.stem}`" for f in same_name)
        raise UnknownEditionError(f"`{reference}` is ambiguous; write the family, too: {names}")
    if reference in known:
        return load(known[reference], golden=golden)
    hint = nearest(reference, known) or "write a file, an edition, or REVISION:FILE"
    raise UnknownEditionError(f"there is no file and no edition `{reference}`; {hint}")


def _from_git(reference: str, revision: str, path: str) -> Loaded:
    if revision.startswith("-"):
        raise UnknownEditionError(f"`{revision}` is not a revision; write, for example, HEAD~1")
    here = path if path.startswith(("/", "./", "../")) else f"./{path}"
    try:
        run = subprocess.run(["git", "cat-file", "blob", f"{revision}:{here}"], capture_output=True, check=False)
    except FileNotFoundError:
        raise UnknownEditionError(f"`{reference}` requires git, which is not installed; install it") from None
    if run.returncode:
        reason = run.stderr.decode("utf-8", "replace").strip().removeprefix("fatal: ").split("\n")[0]
        raise UnknownEditionError(f"git has no `{reference}`: {reason}")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "spec.yaml"
        file.write_bytes(run.stdout)
        return load(file, reference)
