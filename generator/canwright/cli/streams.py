"""The standard streams, made safe: closed ones, and encodings that lack characters. Imports little, to be fast."""

from __future__ import annotations

import codecs
import os
import sys


def prepare_streams() -> None:
    """Replaces closed standard streams by the null device, and escapes characters that an encoding lacks."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:  # closed; a file opened later must not become this stream
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: PTH123, SIM115
    codecs.register_error("canwright.escaped", _escaped)
    for stream in (sys.stdout, sys.stderr):
        if reconfigure := getattr(stream, "reconfigure", None):
            reconfigure(errors="canwright.escaped")


def _escaped(error: UnicodeError) -> tuple[str, int]:
    """Characters that an encoding lacks, as in JSON: `\\u8BBE`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    units = error.object[error.start : error.end].encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i : i + 2].hex()}" for i in range(0, len(units), 2)), error.end
