"""The format of a text, by its first lines."""

from __future__ import annotations

import re

from ..targets.columns.runtime._candump import RecordedFrame, read_line
from . import line_forms, slcan
from .log_frame import LogError

_AS_LINES = "write each frame as a line `(1700000000.000000) can0 141#9A00000000000000`"
_FOREIGN = {
    re.compile(r"header:\s+stamp:|(?:.*\n){0,12}is_rtr:"): "`ros2 topic echo` prints this; record the bus with "
    f"`candump -l`, or {_AS_LINES} (`id` and `data` are decimal)",
    re.compile(r"# Logger type:|Timestamp;Type;ID;Data"): f"a logger such as CL2000 writes this; {_AS_LINES}",
    re.compile("TimestampEpoch;"): f"mdf2csv writes this; read the MF4 file that it converts, or {_AS_LINES}",
}
"""Texts that are not read, with the way to convert them."""


def form_of(start: str) -> str:
    """The name of the format of a text that starts so. Raises LogError for a text that has to be converted."""
    lowered = start.lstrip().lower()
    for name, form in line_forms.FORMS.items():
        if lowered.startswith(form.starts):
            return name
    for pattern, conversion in _FOREIGN.items():
        if pattern.match(start):
            raise LogError(conversion)
    for line in start.splitlines():
        if isinstance(read_line(line), RecordedFrame):
            break
        written = line.strip()
        if slcan.FRAME.fullmatch(written):
            return "slcan"
        for name, listed in line_forms.FORMS.items():
            if listed.header is None and any(pattern.fullmatch(written) for pattern in listed.frames):
                return name
    return "candump"
