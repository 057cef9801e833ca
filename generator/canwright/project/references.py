"""Editions as people name them: a file, a revision of a file in git, or an edition of the spec folder."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

from ..diagnostics.diagnostic import nearest
from .loader import Loaded, load, spec_files


class UnknownEditionError(Exception):
    """There is no such edition; the message says what there is."""


def find(reference: str, folder: Path, *, golden: bool = True) -> Loaded:
    """What `reference` names: `my.yaml`, `HEAD~1:spec/lamp/v1.yaml`, `v1` or `lamp/v1`, the last two below `folder`.

    Golden frames beside it come along, and have to fit, unless without `golden`; those of a revision never do.
    Raises UnknownEditionError, SpecError and OSError.
    """
    file = Path(reference)
    if file.is_file():
        return load(file, golden=golden)
    revision, colon, path = reference.partition(":")
    if colon and revision and path:
        return _from_git(reference, revision, path)
    known = {name: f for f in spec_files(folder) for name in (f.stem, f"{f.parent.name}/{f.stem}")}
    twice = [f for f in spec_files(folder) if f.stem == reference]
    if len(twice) > 1:
        names = ", ".join(f"`{f.parent.name}/{f.stem}`" for f in twice)
        raise UnknownEditionError(f"`{reference}` may be any of {names}; name the family as well")
    if reference in known:
        return load(known[reference], golden=golden)
    hint = nearest(reference, known) or "name a file, an edition, or REVISION:FILE"
    raise UnknownEditionError(f"there is no file and no edition `{reference}`; {hint}")


def _from_git(reference: str, revision: str, path: str) -> Loaded:
    if revision.startswith("-"):
        raise UnknownEditionError(f"`{revision}` is no revision")
    here = path if path.startswith(("/", "./", "../")) else f"./{path}"
    try:
        run = subprocess.run(["git", "cat-file", "blob", f"{revision}:{here}"], capture_output=True, check=False)
    except FileNotFoundError:
        raise UnknownEditionError(f"`{reference}` is a revision, and there is no git here; install it") from None
    if run.returncode:
        said = run.stderr.decode("utf-8", "replace").strip().removeprefix("fatal: ").split("\n")[0]
        raise UnknownEditionError(f"git has no `{reference}`: {said}")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "spec.yaml"
        file.write_bytes(run.stdout)
        return load(file, reference)
