"""Logs in blocks of frames: text of candump (`-l`, `-L`, with or without `-x`) and BLF.

Memory does not grow with the log. Lines and objects of one form are read together; other lines one by one. What is no
data frame of classic CAN is counted and skipped.
"""

from __future__ import annotations

import contextlib
import re
import struct
import zlib
from collections import Counter
from collections.abc import Generator, Iterator
from dataclasses import replace
from datetime import datetime, timezone
from enum import IntEnum
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ._columns import Array, Direction, Frames, Kind

BLOCK = 1 << 21
"""The number of bytes of text that are read at once."""
MAX_LINE = 4096
"""The maximum number of bytes of a line that continues in the next block. Longer lines are no data frames."""


class Mark(IntEnum):
    """The mark of a log at a frame, in place of its direction."""

    RECEIVED = 0
    SENT = 1
    NONE = 2


class Log:
    """The frames of a log in blocks, in the order of the log. `skipped` counts everything else by what it is.

    `received` is the direction of the frames that the recorder received: `Direction.REPLY` if the host recorded the log,
    `Direction.REQUEST` if a node did. Those that it sent have the other direction. By default, and without marks, the
    direction is unknown: the marks of a listener, which only receives, say nothing.
    """

    def __init__(self, path: str | Path, *, received: Direction = Direction.UNKNOWN, block: int = BLOCK) -> None:
        self.skipped: Counter[str] = Counter()
        self._path, self._block = Path(path), block
        unknown = Direction.UNKNOWN
        sent = unknown if received is unknown else Direction(1 - received)
        self._of_mark = np.array([received, sent, unknown], np.uint8)
        self._buses: dict[str, int] = {}

    def __iter__(self) -> Iterator[Frames]:
        """Raises OSError, and ValueError for a BLF log that cannot be read."""
        with self._path.open("rb") as source:
            is_blf = source.read(4) == b"LOGG"
            source.seek(0)
            for one in _Blf(source, self).blocks() if is_blf else self._text(source):
                yield replace(one, direction=self._of_mark[one.direction], buses=tuple(self._buses))

    def bus(self, name: str) -> int:
        """The number of a bus."""
        return self._buses.setdefault(name, len(self._buses))

    def _text(self, source: BinaryIO) -> Iterator[Frames]:
        rest, is_overlong = b"", False
        while read := source.read(self._block):
            if is_overlong:
                end = read.find(b"\n") + 1
                if not end:
                    continue
                read, is_overlong = read[end:], False
            text = rest + read
            end = text.rfind(b"\n") + 1
            text, rest = text[:end], text[end:]
            if len(rest) > MAX_LINE:
                self.skipped["lines of no data frame"] += 1
                rest, is_overlong = b"", True
            if text:
                yield _Text(text, self).frames()
        if rest:
            yield _Text(rest, self).frames()


_LINE = re.compile(
    rb"\((?P<seconds>\d{1,10})\.(?P<fraction>\d{1,9})\) +(?P<bus>[^\s#]+) +(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#"
    rb"(?P<data>(?:[0-9A-Fa-f]{2}){0,8}|[Rr]\d?)(?: +(?P<mark>[RT]))?\s*"
)
_MARKS = {b"R": Mark.RECEIVED, b"T": Mark.SENT, None: Mark.NONE}
_ERROR_BIT = 0x20000000
_FORMS = 16
"""So many forms of lines of one length are read together; lines of further forms are read one by one."""
_INVALID = 0xFFFF


def _pairs(digits: str, base: int) -> NDArray[np.uint16]:
    """The number that each two ASCII digits are, by their bytes as a little-endian integer."""
    table = np.full(1 << 16, _INVALID, np.uint16)
    for high in digits:
        for low in digits:
            table[ord(high) | ord(low) << 8] = int(high + low, base)
    return table


_HEX = _pairs("0123456789ABCDEFabcdef", 16)
_DECIMAL = _pairs("0123456789", 10)


class _Text:
    """Whole lines of candump."""

    def __init__(self, text: bytes, log: Log) -> None:
        self._text, self._log = text, log
        self._bytes = np.frombuffer(text, np.uint8)
        ends = np.flatnonzero(self._bytes == ord("\n"))
        if not text.endswith(b"\n"):
            ends = np.append(ends, len(text))
        self._starts = np.concatenate(([0], ends[:-1] + 1))
        self._lengths = ends - self._starts
        count = ends.size
        self._found = Frames(
            time=np.zeros(count, np.int64),
            bus=np.zeros(count, np.uint16),
            id=np.zeros(count, np.uint32),
            kind=np.zeros(count, np.uint8),
            length=np.zeros(count, np.uint8),
            data=np.zeros(count, "<u8"),
            direction=np.zeros(count, np.uint8),
        )
        self._valid = np.zeros(count, np.bool_)

    def frames(self) -> Frames:
        """The frames, in the order of their lines."""
        for length in np.flatnonzero(np.bincount(self._lengths)).tolist():
            rows = np.flatnonzero(self._lengths == length)
            for _ in range(_FORMS):
                if not rows.size:
                    break
                rows = self._read_alike(rows, length)
            for row in rows.tolist():
                self._read_line(row)
        return self._found if self._valid.all() else self._found.take(self._valid)

    def _line(self, row: int) -> bytes:
        start = int(self._starts[row])
        return self._text[start : start + int(self._lengths[row])]

    def _read_alike(self, rows: Array, length: int) -> Array:
        """Reads the first of some lines of one length, and all with its form and bus; returns the other lines."""
        first = int(rows[0])
        form = _LINE.fullmatch(self._line(first))
        if form is None or form["data"][:1] in (b"R", b"r") or len(form["id"]) == 8 or rows.size < 4:
            self._read_line(first)
            return rows[1:]
        lines = self._matrix(rows, length)
        fixed = np.array(
            [
                i
                for i in range(length)
                if not any(form.start(g) <= i < form.end(g) for g in ("seconds", "fraction", "id", "data"))
            ],
            np.intp,
        )
        same = lines[:, fixed] == np.frombuffer(self._line(first), np.uint8)[fixed]
        others = rows[:0]
        if not same.all():
            alike = same.all(axis=1)
            others, rows, lines = rows[~alike], rows[alike], lines[alike]
        seconds, valid = _number(lines[:, form.start("seconds") : form.end("seconds")])
        fraction, valid_fraction = _number(lines[:, form.start("fraction") : form.end("fraction")])
        valid &= valid_fraction
        digits = form.end("fraction") - form.start("fraction")
        padded = np.full((rows.size, 4), ord("0"), np.uint8)
        padded[:, 1:] = lines[:, form.start("id") : form.end("id")]
        ids = _HEX.take(padded.view("<u2"))
        data = _HEX.take(np.ascontiguousarray(lines[:, form.start("data") : form.end("data")]).view("<u2"))
        valid &= _valid(ids) & _valid(data)
        octets = np.zeros((rows.size, 8), np.uint8)
        octets[:, : data.shape[1]] = data
        found = self._found
        at = slice(None) if rows.size == found.id.size else rows
        found.time[at] = seconds * 1_000_000_000 + fraction * 10 ** (9 - digits)
        found.bus[at] = self._log.bus(form["bus"].decode("ascii", "replace"))
        found.id[at] = ids[:, 0].astype(np.uint32) << 8 | ids[:, 1]
        found.length[at] = data.shape[1]
        found.data[at] = octets.view("<u8")[:, 0]
        found.direction[at] = _MARKS[form["mark"]]
        self._valid[at] = valid
        if not valid.all():
            for row in rows[~valid].tolist():
                self._read_line(row)
        return others

    def _matrix(self, rows: Array, length: int) -> Array:
        """Lines of one length, one in each row."""
        if rows.size == self._starts.size and self._bytes.size == rows.size * (length + 1):
            return self._bytes.reshape(rows.size, length + 1)[:, :length]
        windows = np.lib.stride_tricks.sliding_window_view(self._bytes, length)
        return windows[self._starts[rows]]

    def _read_line(self, row: int) -> None:
        line = self._line(row)
        form = _LINE.fullmatch(line)
        if form is None:
            if line.strip():
                self._log.skipped["lines of no data frame"] += 1
            return
        found, id_ = self._found, int(form["id"], 16)
        if id_ & _ERROR_BIT:
            self._log.skipped["error frames"] += 1
            return
        is_remote = form["data"][:1] in (b"R", b"r")
        data = b"" if is_remote else bytes.fromhex(form["data"].decode("ascii"))
        found.time[row] = int(form["seconds"]) * 1_000_000_000 + int(form["fraction"].ljust(9, b"0"))
        found.bus[row] = self._log.bus(form["bus"].decode("ascii", "replace"))
        found.id[row] = id_
        found.kind[row] = Kind.EXTENDED * (len(form["id"]) == 8) | Kind.REMOTE * is_remote
        found.length[row] = len(data)
        found.data[row] = int.from_bytes(data, "little")
        found.direction[row] = _MARKS[form["mark"]]
        self._valid[row] = True


def _number(digits: Array) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Decimal numbers of at most 10 digits, and whether they are numbers."""
    count, width = digits.shape
    padded = np.full((count, width + width % 2), ord("0"), np.uint8)
    padded[:, width % 2 :] = digits
    pairs = _DECIMAL.take(padded.view("<u2"))
    powers = 100.0 ** np.arange(pairs.shape[1] - 1, -1, -1)
    return (pairs @ powers).astype(np.int64), _valid(pairs)


def _valid(pairs: Array) -> NDArray[np.bool_]:
    """Which rows have digits only."""
    if not pairs.size or pairs.max() != _INVALID:
        return np.ones(len(pairs), np.bool_)
    valid: NDArray[np.bool_] = (pairs != _INVALID).all(axis=1)
    return valid


_OBJECT = struct.Struct("<4sHHLL")
"""Signature, size of the header, its version, size of the object, its type."""
_FILE_HEADER = struct.Struct("<4sL32x8H")
_MESSAGES = (1, 86)
_CONTAINER = 10
_TEN_MICROSECONDS = 1
_RECORD = [
    *(("signature", "S4"), ("header", "<u2"), ("version", "<u2"), ("size", "<u4"), ("type", "<u4")),
    *(("flags", "<u4"), ("client", "<u2"), ("object", "<u2"), ("time", "<u8")),
    *(("channel", "<u2"), ("state", "u1"), ("length", "u1"), ("id", "<u4"), ("data", "<u8")),
]
"""A CAN message with a header of version 1; one of type 86 has 8 bytes more."""
_RECORD_SIZE = 48
_BYTES = 3 << 20
"""So many bytes of the objects of a BLF log are read at once, or one container more."""
_EXTENDED, _REMOTE, _SENT = 0x80000000, 0x80, 0x01


class _Blf:
    """The objects of a BLF log, in its containers."""

    def __init__(self, source: BinaryIO, log: Log) -> None:
        self._source, self._log = source, log
        start = source.read(_FILE_HEADER.size)
        if len(start) < _FILE_HEADER.size:
            raise ValueError("the BLF log ends in its header")
        _, size, *date = _FILE_HEADER.unpack(start)
        source.seek(size)
        self._start = 0
        year, month, _, day, hour, minute, second, milliseconds = date
        with contextlib.suppress(ValueError):  # a log may have no date
            moment = datetime(year, month, day, hour, minute, second, tzinfo=timezone.utc)
            self._start = int(moment.timestamp()) * 1_000_000_000 + milliseconds * 1_000_000

    def blocks(self) -> Iterator[Frames]:
        """The frames of some containers at a time."""
        parts: list[bytes] = []
        size = 0
        for content in self._containers():
            parts.append(content)
            size += len(content)
            if size >= _BYTES:
                rest = yield from self._objects(b"".join(parts))
                parts, size = [rest], len(rest)
        rest = yield from self._objects(b"".join(parts))
        if len(rest) >= _OBJECT.size:
            self._log.skipped["truncated end"] += 1

    def _objects(self, objects: bytes) -> Generator[Frames, None, bytes]:
        """The frames of some objects, at most one block; returns the bytes of the last object if it is not complete."""
        runs: list[Array] = []
        position = 0
        while True:
            found = objects.find(b"LOBJ", position, position + 12)
            if found < 0 or found + _OBJECT.size > len(objects):
                break
            run, following = self._run(objects, found)
            if following > len(objects):
                break
            position = following
            if run is not None:
                runs.append(run)
        if runs:
            yield self._frames(runs[0] if len(runs) == 1 else np.concatenate([run[_USED] for run in runs]))
        return objects[position:]

    def _containers(self) -> Iterator[bytes]:
        """The objects in each container; those outside of containers as they are."""
        while True:
            head = self._source.read(_OBJECT.size)
            if len(head) < _OBJECT.size:
                return
            signature, _, _, size, kind = _OBJECT.unpack(head)
            if signature != b"LOBJ" or size < _OBJECT.size:
                raise ValueError("the BLF log has no object where one must be")
            body = self._source.read(size - _OBJECT.size)
            self._source.read(size % 4)
            if len(body) < size - _OBJECT.size:
                self._log.skipped["truncated end"] += 1
            if kind != _CONTAINER:
                yield head + body
                continue
            method = int.from_bytes(body[:2], "little")
            if method not in (0, 2):
                raise ValueError(f"the BLF log is compressed by the unknown method {method}")
            try:
                yield body[16:] if method == 0 else zlib.decompressobj().decompress(body[16:])
            except zlib.error:
                self._log.skipped["damaged containers"] += 1

    def _run(self, objects: bytes, position: int) -> tuple[Array | None, int]:
        """The messages from a position on that have the same form, and the position behind them."""
        _, _, version, size, kind = _OBJECT.unpack_from(objects, position)
        if size < _OBJECT.size:
            raise ValueError("the BLF log has an object without a size")
        if kind not in _MESSAGES or version != 1 or size < _RECORD_SIZE or size % 4:
            self._log.skipped[f"objects of type {kind}"] += 1
            return None, position + size
        most = (len(objects) - position) // size
        if not most:
            return None, position + size
        dtype = _dtype(size)
        records = np.frombuffer(objects, dtype, most, position)
        same = (records["signature"] == b"LOBJ") & (records["type"] == kind)
        same &= (records["size"] == size) & (records["version"] == 1)
        count = most if same.all() else int(np.argmin(same))
        return records[:count], position + count * size

    def _frames(self, found: Array) -> Frames:
        is_valid = found["length"] <= 8
        if not is_valid.all():
            self._log.skipped["messages with more than 8 bytes"] += int(np.count_nonzero(~is_valid))
            found = found[is_valid]
        ten = found["flags"] == _TEN_MICROSECONDS
        time = found["time"].astype(np.int64)
        time = np.where(ten, time * 10_000, time) + self._start
        remote = found["state"] & _REMOTE != 0
        extended = found["id"] & _EXTENDED != 0
        lengths = np.where(remote, 0, found["length"]).astype(np.uint8)
        counts = np.bincount(found["channel"])
        buses = np.zeros(counts.size, np.uint16)
        for channel in np.flatnonzero(counts).tolist():
            buses[channel] = self._log.bus(str(channel))
        return Frames(
            time=time,
            bus=buses[found["channel"]],
            id=(found["id"] & 0x1FFFFFFF).astype(np.uint32),
            kind=(extended * np.uint8(Kind.EXTENDED)) | (remote * np.uint8(Kind.REMOTE)),
            length=lengths,
            data=found["data"] & _USED_BITS[lengths],
            direction=np.where(found["state"] & _SENT, np.uint8(Mark.SENT), np.uint8(Mark.RECEIVED)),
        )


_USED = ["flags", "time", "channel", "state", "length", "id", "data"]
_USED_BITS = np.array([(1 << 8 * length) - 1 for length in range(9)], np.uint64)


def _dtype(size: int) -> np.dtype[Any]:
    """A message in an object of any size."""
    record = np.dtype(_RECORD)
    assert record.fields is not None and record.names is not None
    formats = [record.fields[name][0] for name in record.names]
    offsets = [record.fields[name][1] for name in record.names]
    layout: Any = {"names": record.names, "formats": formats, "offsets": offsets, "itemsize": size}
    dtype: np.dtype[Any] = np.dtype(layout)
    return dtype
