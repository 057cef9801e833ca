"""The manifest of an output folder: the generated files with their digests, and the editions of each target."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from .paths import (
    LOCK,
    MANIFEST,
    STAGING,
    OutputError,
    content_of,
    digest,
    digest_of_regular,
    is_safe,
    refuse_obstacles,
    regular_files,
)

_MAX_SIZE = 64 * 1024 * 1024
"""Bytes; about a hundred times the largest known manifest."""

_DIGEST = "[0-9a-f]{64}"


class Manifest:
    """Editions by target, and digests by path. No named tuple, since a run with nothing to do imports this to be fast."""

    def __init__(self, *, editions: Mapping[str, Sequence[str]], files: Mapping[str, str]) -> None:
        self.editions = editions
        self.files = files

    def json_bytes(self) -> bytes:
        return json.dumps(vars(self), indent=1, ensure_ascii=False).encode() + b"\n"


def damaged(out: Path, path: str, reason: object) -> OutputError:
    """The error for a file with content that canwright did not write."""
    remedy = f"remove {(out / STAGING).as_posix()}, left by an interrupted run, and run again"
    if path == MANIFEST:
        remedy = "restore it from version control, or generate into an empty folder"
    return OutputError(f"{(out / path).as_posix()} is damaged: {reason}; {remedy}")


def read_manifest(out: Path, path: str = MANIFEST) -> Manifest:
    """The manifest of a folder, empty without one. Raises OutputError if it is damaged, since it is untrusted."""
    refuse_obstacles(out, path)
    file = out / path
    if not file.exists():
        return Manifest(editions={}, files={})
    try:
        if file.stat().st_size > _MAX_SIZE:
            raise ValueError(f"it is larger than {_MAX_SIZE} bytes")
        return _validated(json.loads(file.read_bytes()))
    except (ValueError, RecursionError) as error:
        raise damaged(out, path, error) from None


def is_intact(out: Path, expected: str, targets: Sequence[str]) -> bool:
    """Whether a folder has the manifest with this digest and the files of `targets` as that lists them.

    False also while a run is writing or was interrupted, and where a link or a folder is in the place of a file.
    """
    try:
        content = content_of(out / MANIFEST)
        if content is None or digest(content) != expected or (out / LOCK).exists() or (out / STAGING).exists():
            return False
        refuse_obstacles(out, MANIFEST)
        files = json.loads(content)["files"]  # canwright wrote it: it has the expected digest
        files = {path: value for path, value in files.items() if path.partition("/")[0] in targets}
        folders = [target for target in targets if not (out / target).is_symlink()]
        present = {path for target in folders for path in regular_files(out, target)}
        return files.keys() <= present and all(digest_of_regular(f"{out}/{path}") == files[path] for path in files)
    except (OSError, ValueError, RecursionError, OutputError):
        return False


def _validated(content: object) -> Manifest:
    if not isinstance(content, dict) or content.keys() != {"editions", "files"}:
        raise ValueError("it is not an object with the keys `editions` and `files`")
    manifest = Manifest(**content)
    for kind, entries in content.items():
        if not isinstance(entries, dict):
            raise ValueError(f"`{kind}` is not an object")
    for target, editions in manifest.editions.items():
        if not isinstance(editions, list) or not all(isinstance(name, str) for name in editions):
            raise ValueError(f"the editions of {ascii(target)[:80]} are not a list of names")
        if not all(name.isprintable() for name in (target, *editions)):
            raise ValueError(f"the editions of {ascii(target)[:80]} contain an invisible character")
    for path, expected in manifest.files.items():
        if not is_safe(path):
            raise ValueError(f"{ascii(path)[:80]} is not a path inside the folder")
        if not isinstance(expected, str) or not re.fullmatch(_DIGEST, expected):
            raise ValueError(f"{ascii(path)[:80]} has no SHA-256 digest")
    return manifest
