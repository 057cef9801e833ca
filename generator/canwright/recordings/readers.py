"""Logs of any known format, recognized by their content: texts, binary files and captures; compressed or not."""

from __future__ import annotations

import bz2
import contextlib
import functools
import gzip
import io
import lzma
import re
import select
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast

from ..semantics.frame import CanFrame
from ..targets.columns.runtime._candump import RecordedFrame, read_line
from . import by_python_can, candump, line_forms, pcap, slcan, sqlite_table
from .log_frame import OVERLONG, Counts, LogError as LogError, LogFrame, SkippedPart
from .packages import MissingPackageError
from .split import joined
from .time_differences import since_start

STANDARD_INPUT = "-"
PAUSE = 0.05
"""The time in seconds after which a stream that has no more frames pauses."""
_AHEAD = 1000
_AHEAD_OF_STREAM = 8
"""How many frames are read before it is decided whether times that begin with 0 are differences."""
_PEEKED = 4096
_MAX_LINE = 4096
"""The maximum number of characters of a line. The longest lines of CAN FD frames have a few hundred."""
_SKIPPED = 1 << 16
"""The number of characters of a longer line that are skipped at once."""
_SHOWN = 80
_COMPRESSED: dict[bytes, Callable[[BinaryIO], object]] = {
    b"\x1f\x8b": gzip.open,
    b"BZh": bz2.open,
    b"\xfd7zXZ\x00": lzma.open,
}
_MF4 = functools.partial(by_python_can.read_bytes, "mf4")
_BINARY: dict[bytes, Callable[[BinaryIO, Counts], Iterator[LogFrame]]] = {
    b"LOGG": functools.partial(by_python_can.read_bytes, "blf"),
    b"MDF ": _MF4,
    b"UnFinMF ": _MF4,
    sqlite_table.MAGIC: sqlite_table.read,
    **dict.fromkeys(pcap.MAGICS, pcap.read),
}
_SEEKING = {b"MDF ": "MF4", b"UnFinMF ": "MF4", sqlite_table.MAGIC: "a database"}
"""What is read at many places, so that it cannot be a stream."""
_MARKED = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
TEXTS = {
    "candump": candump.read,
    "slcan": slcan.read,
    **{name: line_forms.reader(form) for name, form in line_forms.FORMS.items()},
}
_AS_LINES = "write each frame as a line `(1700000000.000000) can0 141#9A00000000000000`"
_FOREIGN = {
    re.compile(r"header:\s+stamp:|(?:.*\n){0,12}is_rtr:"): "`ros2 topic echo` prints this; record the bus with "
    f"`candump -l`, or {_AS_LINES} (`id` and `data` are decimal)",
    re.compile(r"# Logger type:|Timestamp;Type;ID;Data"): f"a logger such as CL2000 writes this; {_AS_LINES}",
    re.compile("TimestampEpoch;"): f"mdf2csv writes this; read the MF4 file that it converts, or {_AS_LINES}",
}
"""Texts that are not read, with the way to convert them."""
_ID_AND_BYTES = re.compile(
    r"\s*(?:0x)?(?P<id>[\da-f]{3}|[\da-f]{8})\s*[#:,\s]\s*(?P<data>(?:(?:0x)?[\da-f]{2}[,\s]*)*)",
    re.ASCII | re.IGNORECASE,
)
"""An id and bytes with any spaces, commas and prefixes between them."""


class Log:
    """The frames of a log, once, in their order. `counts` has what was skipped so far, and at the end the frames.

    `on_wait` is called with 0 before each read of a stream, which may have to wait for the next frames, and again at
    each PAUSE with the time in seconds since then; `waited` is the time that these reads have taken. A log that
    `is_followed` has no end. Its times are added up if they are known or seen to be differences. The
    channels of one that `is_split` are buses again. If it `is_ended` by the user, it ends where it is read next.
    """

    def __init__(
        self,
        source: BinaryIO,
        name: str,
        *,
        is_followed: bool = False,
        has_differences: bool = False,
        is_split: bool = False,
    ) -> None:
        self.counts = Counts()
        self.name = name
        self.on_wait: Callable[[float], object] = lambda _: None
        self.waited = 0.0
        self.is_followed = is_followed
        self.is_ended = False
        self._source = source
        self.has_differences = has_differences
        self.is_split = is_split

    @property
    def is_file(self) -> bool:
        """Whether the log is a regular file with an end, so that it can be read again by its name."""
        return not self.is_followed and Path(self.name).is_file()

    def __iter__(self) -> Iterator[LogFrame]:
        """Raises LogError and OSError."""
        return (recorded for recorded in self.with_pauses() if recorded is not None)

    def with_pauses(self) -> Iterator[LogFrame | None]:
        """The frames; of a bus also None at each PAUSE without a frame. Raises LogError and OSError."""
        frames = 0
        try:
            read = self.recorded()
            for recorded in joined(filter(None, read)) if self.is_split else read:
                if recorded is not None:
                    frames += 1
                    if recorded.frame.remote:
                        self.counts.remote += 1
                yield recorded
                if self.is_ended:
                    break
        except MissingPackageError as error:
            raise LogError(str(error)) from None
        except (EOFError, zlib.error, lzma.LZMAError, OSError) as error:
            if isinstance(error, OSError) and error.errno is not None:  # of the system, not of what is compressed
                raise
            self.counts.skip(SkippedPart.TRUNCATED, 0, str(error))
        finally:
            self.counts.frames = frames
        errors = self.counts.skipped[SkippedPart.ERROR]
        if errors and not self.counts.frames and not self.is_ended:
            raise LogError(
                f"{self.name} has {errors} error frames and no frames; check that the bit rate is that of the nodes, and the "
                "wiring, the termination and the supply of the bus"
            )
        if not self.counts.frames and not self.is_ended:
            raise LogError(
                f"{self.name} has no frames{_found(self.counts)}; record it with `candump -l`, or as "
                "ASC, BLF, TRC, MF4, CSV or pcap"
            )

    def recorded(self) -> Iterator[LogFrame | None]:
        """The frames, and `counts` of what is skipped; None at a pause that the reader can announce."""
        source = self._source if self.is_file else cast("BinaryIO", _Stream(self._source, self))
        ahead = _AHEAD if self.is_file else _AHEAD_OF_STREAM
        return _read(_buffered(source), self.counts, ahead, self.has_differences)


class _Stream(io.RawIOBase):
    """The source of a log that announces each read, and each pause."""

    def __init__(self, source: BinaryIO, log: Log) -> None:
        self._source, self._log = source, log

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        log, start, content = self._log, time.monotonic(), b""
        log.on_wait(0)
        while not log.is_ended:
            if self._is_ready():
                content = self._source.read1(len(buffer))  # type: ignore[attr-defined]
                if content or not log.is_followed:
                    break
                time.sleep(PAUSE)
            log.on_wait(time.monotonic() - start)
        log.waited += time.monotonic() - start
        buffer[: len(content)] = content
        return len(content)

    def _is_ready(self) -> bool:
        """Whether a read does not wait; true also for what cannot be asked."""
        try:
            return bool(select.select([self._source], [], [], PAUSE)[0])
        except (OSError, ValueError):
            return True


@contextlib.contextmanager
def open_log(
    name: str, *, is_followed: bool = False, has_differences: bool = False, is_split: bool = False
) -> Iterator[Log]:
    """A log in a file, or in the standard input for `-`. Raises OSError."""
    if name == STANDARD_INPUT:
        yield Log(sys.stdin.buffer, "the standard input", has_differences=has_differences, is_split=is_split)
        return
    with Path(name).open("rb") as source:
        yield Log(source, name, is_followed=is_followed, has_differences=has_differences, is_split=is_split)


def _found(counts: Counts) -> str:
    lines = [line for lines in counts.examples.values() for line in lines]
    if not lines:
        return ""
    number, text = min(lines)
    parts = ", ".join(f"{count} {part.value}" for part, count in counts.skipped.items())
    return f" (line {number}: `{text}`)" if number else f" ({text or parts})"


def _buffered(source: BinaryIO) -> io.BufferedReader:
    return source if isinstance(source, io.BufferedReader) else io.BufferedReader(cast("io.RawIOBase", source))


def _read(source: io.BufferedReader, counts: Counts, ahead: int, are_differences: bool) -> Iterator[LogFrame]:
    """The frames of a log in the format that its first bytes have, or those of the log that is compressed in it."""
    start = source.peek(_PEEKED)[:_PEEKED]
    opened = next((opened for magic, opened in _COMPRESSED.items() if start.startswith(magic)), None)
    if opened is None:
        return _frames(source, start, counts, ahead, are_differences)
    unpacked = _buffered(cast("BinaryIO", opened(source)))
    start = unpacked.peek(_PEEKED)[:_PEEKED]
    if start.startswith((*_COMPRESSED, *_SEEKING)):
        raise LogError("a compressed log contains another compressed file, MF4 or a database; decompress it first")
    return _frames(unpacked, start, counts, ahead, are_differences)


def _frames(
    source: io.BufferedReader, start: bytes, counts: Counts, ahead: int, are_differences: bool
) -> Iterator[LogFrame]:
    for magic, read in _BINARY.items():
        if start.startswith(magic):
            if magic in _SEEKING and not source.seekable():
                raise LogError(f"{_SEEKING[magic]} cannot be read from a stream; give the name of the file")
            return read(source, counts)
    encoding = next((name for mark, name in _MARKED.items() if start.startswith(mark)), _unmarked(start))
    lines = _lines(io.TextIOWrapper(source, encoding, errors="replace"))
    form = _form_of(start.decode(encoding, "replace").lstrip("\ufeff"))
    frames = TEXTS[form](lines, counts)
    return since_start(frames, counts, ahead if form == "candump" else 0, are_differences=are_differences)


def _lines(text: io.TextIOWrapper) -> Iterator[str]:
    """The lines of a text. Of a line that is too long to be one of a log, only the start is kept, as a damaged line."""
    while line := text.readline(_MAX_LINE):
        if len(line) == _MAX_LINE and not line.endswith("\n"):
            rest = line
            while rest and not rest.endswith("\n"):
                rest = text.readline(_SKIPPED)
            line = f"{OVERLONG}{line[:_SHOWN]}\n"
        yield line


def _unmarked(start: bytes) -> str:
    """The encoding of a text without a mark: every other byte of ASCII in UTF-16 is 0."""
    return "utf-16-le" if start[1:4:2] == b"\0\0" else "utf-16-be" if start[0:4:2] == b"\0\0" else "utf-8"


def _form_of(start: str) -> str:
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
