"""A frame in a text that a user copied from the terminal or from a log of any form."""

from __future__ import annotations

import contextlib
import re

from ..semantics.frame import CanFrame
from .log_frame import Counts, LogError
from .readers import TEXTS

_ID_AND_BYTES = re.compile(
    r"\s*(?:0x)?(?P<id>[\da-f]{3}|[\da-f]{8})\s*[#:,\s]\s*(?P<data>(?:(?:0x)?[\da-f]{2}[,\s]*)*)",
    re.ASCII | re.IGNORECASE,
)
"""An id and bytes with any spaces, commas and prefixes between them."""


def pasted_frame(text: str) -> CanFrame | None:
    """The frame on a line of any form of a log, or of an id and bytes; None without one."""
    for read in TEXTS.values():
        with contextlib.suppress(LogError):
            for recorded in read([f"{text}\n"], Counts()):
                return recorded.frame
    match = _ID_AND_BYTES.fullmatch(text)
    if match is None:
        return None
    data = bytes.fromhex(match["data"].lower().replace("0x", "").replace(",", " "))
    frames = TEXTS["candump"]([f"{match['id']}#{data.hex()}\n"], Counts())
    return next((recorded.frame for recorded in frames), None)
