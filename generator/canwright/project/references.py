"""References to editions: a file, a revision of a file in git, or an edition of the spec folder."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

from ..diagnostics.diagnostic import nearest
from .loader import Loaded, load, spec_files


class UnknownEditionError(Exception):
    """The edition is unknown; the message suggests others."""


def find(reference: str, folder: Path, *, golden: bool = True) -> Loaded:
    """The edition of a reference: `my.yaml`, `HEAD~1:spec/lamp/v1.yaml`, or `v1` and `lamp/v1` in `folder`.

    With `golden`, the golden frames in the same folder are loaded and checked too, except those of a revision.
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
        raise UnknownEditionError(f"`{reference}` is ambiguous: {names}; add the family")
    if reference in known:
        return load(known[reference], golden=golden)
    hint = nearest(reference, known) or "give a file, an edition, or REVISION:FILE"
    raise UnknownEditionError(f"there is no file or edition `{reference}`; {hint}")


def _from_git(reference: str, revision: str, path: str) -> Loaded:
    if revision.startswith("-"):
        raise UnknownEditionError(f"`{revision}` is not a revision; give a commit, a branch or a tag")
    here = path if path.startswith(("/", "./", "../")) else f"./{path}"
    try:
        run = subprocess.run(["git", "cat-file", "blob", f"{revision}:{here}"], capture_output=True, check=False)
    except FileNotFoundError:
        raise UnknownEditionError(f"git is needed to read `{reference}`; install it") from None
    if run.returncode:
        reason = run.stderr.decode("utf-8", "replace").strip().removeprefix("fatal: ").split("\n")[0]
        raise UnknownEditionError(f"git cannot find `{reference}`: {reason}")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "spec.yaml"
        file.write_bytes(run.stdout)
        return load(file, reference)
