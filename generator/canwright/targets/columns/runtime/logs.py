"""Logs in blocks of frames: text of candump in all of its formats, and BLF.

Memory does not grow with the log. Lines and objects of one form are read together; other lines one by one. What is no
frame with a time is counted and skipped.
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

from ._candump import MAX_ID, MAX_SECONDS, SHORT, RecordedFrame, SkippedPart, read_line
from ._columns import Array, Direction, Frames, Kind

BLOCK = 1 << 21
"""The number of bytes of text that are read at once."""
MAX_LINE = 4096
"""The maximum number of bytes of a line that continues in the next block. Longer lines are no frames."""


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
                self.skipped[SkippedPart.MALFORMED.value] += 1
                rest, is_overlong = b"", True
            if text:
                yield _Text(text, self).frames()
        if rest:
            yield _Text(rest, self).frames()


_MARKS = {False: Mark.RECEIVED, True: Mark.SENT, None: Mark.NONE}
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
            data=np.zeros(0, "<u8"),
            direction=np.zeros(count, np.uint8),
        )
        self._words = np.zeros((count, 1), "<u8")
        """The data; more columns where a frame has more than 8 bytes."""
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
        found = replace(self._found, data=self._words if self._words.shape[1] > 1 else self._words[:, 0])
        return found if self._valid.all() else found.take(self._valid)

    def _room(self, length: int) -> int:
        """The integers of 64 bits for so many bytes, of which there is one for each frame."""
        words = max(1, -(-length // 8))
        if words > self._words.shape[1]:
            self._words = np.pad(self._words, ((0, 0), (0, words - self._words.shape[1])))
        return words

    def _line(self, row: int) -> str:
        """A line with its end."""
        start = int(self._starts[row])
        return self._text[start : start + int(self._lengths[row]) + 1].decode("utf-8", "replace")

    def _read_alike(self, rows: Array, length: int) -> Array:
        """Reads the first of some lines of one length, and all with its form and bus; returns the other lines."""
        first = int(rows[0])
        line = self._line(first)
        form, recorded = SHORT.fullmatch(line.rstrip()), read_line(line)
        if form is None or not isinstance(recorded, RecordedFrame) or not _is_regular(form) or rows.size < 4:
            self._read_line(first)
            return rows[1:]
        point, end = form["time"].index(".") + form.start("time"), form.end("time")
        digits = [(form.start("time"), point), (point + 1, end), form.span("id"), form.span("data")]
        lines = self._matrix(rows, length)
        fixed = np.setdiff1d(np.arange(length), np.concatenate([np.arange(*span) for span in digits]))
        same = lines[:, fixed] == np.frombuffer(line.encode(), np.uint8)[fixed]
        others = rows[:0]
        if not same.all():
            alike = same.all(axis=1)
            others, rows, lines = rows[~alike], rows[alike], lines[alike]
        columns = [lines[:, start:stop] for start, stop in digits]
        (seconds, valid), (fraction, valid_fraction) = map(_number, columns[:2])
        valid &= valid_fraction & (seconds <= MAX_SECONDS)
        padded = np.full((rows.size, 4), ord("0"), np.uint8)
        padded[:, 1:] = columns[2]
        ids = _HEX.take(padded.view("<u2"))
        data = _HEX.take(np.ascontiguousarray(columns[3]).view("<u2"))
        valid &= _valid(ids) & (ids[:, 0] <= MAX_ID[False] >> 8) & _valid(data)
        words = self._room(data.shape[1])
        octets = np.zeros((rows.size, 8 * words), np.uint8)
        octets[:, : data.shape[1]] = data
        found = self._found
        at = slice(None) if rows.size == found.id.size else rows
        found.time[at] = seconds * 1_000_000_000 + fraction * 10 ** (10 - end + point)
        found.bus[at] = self._log.bus(recorded.bus)
        found.id[at] = ids[:, 0].astype(np.uint32) << 8 | ids[:, 1]
        found.length[at] = data.shape[1]
        self._words[at, :words] = octets.view("<u8")
        found.direction[at] = _MARKS[recorded.is_sent]
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
        recorded, found = read_line(self._line(row)), self._found
        if isinstance(recorded, SkippedPart):
            self._log.skipped[recorded.value] += 1
        elif recorded.time is None:
            self._log.skipped["frames without a time"] += 1
        else:
            found.time[row] = recorded.time
            found.bus[row] = self._log.bus(recorded.bus)
            found.id[row] = recorded.id
            found.kind[row] = Kind.EXTENDED * recorded.extended | Kind.REMOTE * recorded.remote
            found.length[row] = len(recorded.data)
            words = self._room(len(recorded.data))
            self._words[row, :words] = np.frombuffer(recorded.data.ljust(8 * words, b"\0"), "<u8")
            found.direction[row] = _MARKS[recorded.is_sent]
            self._valid[row] = True


def _is_regular(form: re.Match[str]) -> bool:
    """Whether the digits of a line can be read in columns: ASCII, an 11-bit id, pairs of digits, and seconds with a fraction."""
    seconds, _, fraction = (form["time"] or "").partition(".")
    is_time = seconds.isdigit() and len(seconds) <= 10 and fraction.isdigit() and len(fraction) <= 9
    is_data = len(form["id"]) == 3 and not set(form["data"]) & set(".Rr")
    return is_time and is_data and form.string.isascii()


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
_LEAST_SIZES = {1: 48, 86: 48, 100: 116, 101: 72}
"""The sizes of objects with a message by their type: of classic CAN, and two of CAN FD, the last of which ends with its data."""
_FD_MESSAGE, _FD_MESSAGE_64 = 100, 101
_CONTAINER = 10
_TEN_MICROSECONDS = 1
_RECORD = [
    *(("signature", "S4"), ("header", "<u2"), ("version", "<u2"), ("size", "<u4"), ("type", "<u4")),
    *(("flags", "<u4"), ("client", "<u2"), ("object", "<u2"), ("time", "<u8")),
    *(("channel", "<u2"), ("state", "u1"), ("length", "u1"), ("id", "<u4"), ("data", "<u8")),
]
"""A CAN message with a header of version 1; one of type 86 has 8 bytes more."""
_FD_CONTENT = {
    _FD_MESSAGE: {"channel": ("<u2", 32), "state": ("u1", 34), "length": ("u1", 46), "id": ("<u4", 36)},
    _FD_MESSAGE_64: {
        "channel": ("u1", 32),
        "state": ("u1", 66),
        "length": ("u1", 34),
        "id": ("<u4", 36),
        "fd": ("<u4", 44),
    },
}
"""The format and the position of the parts of a CAN FD message that differ from those of `_RECORD`."""
_FD_DATA = {_FD_MESSAGE: 52, _FD_MESSAGE_64: 72}
_MOST_BYTES = 64
_BYTES = 3 << 20
"""So many bytes of the objects of a BLF log are read at once, or one container more."""
_EXTENDED, _REMOTE, _SENT = 0x80000000, 0x80, 0x01
_FD_REMOTE = 0x10
"""Set in the flags of a remote frame in an object of the type 101."""


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
        runs: list[tuple[int, Array]] = []
        position = 0
        while True:
            found = objects.find(b"LOBJ", position, position + 12)
            if found < 0 or found + _OBJECT.size > len(objects):
                break
            kind, run, following = self._run(objects, found)
            if following > len(objects):
                break
            position = following
            if run is not None:
                runs.append((kind, run))
        if any(kind in _FD_CONTENT for kind, _ in runs):
            yield self._frames(np.concatenate([_wide(run, kind) for kind, run in runs]))
        elif runs:
            yield self._frames(runs[0][1] if len(runs) == 1 else np.concatenate([run[_USED] for _, run in runs]))
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

    def _run(self, objects: bytes, position: int) -> tuple[int, Array | None, int]:
        """The messages from a position on that have the same form, their type, and the position behind them."""
        _, _, version, size, kind = _OBJECT.unpack_from(objects, position)
        if size < _OBJECT.size:
            raise ValueError("the BLF log has an object without a size")
        is_fd = kind in _FD_CONTENT
        if version != 1 or size < _LEAST_SIZES.get(kind, size + 1) or (size % 4 and not is_fd):
            self._log.skipped[f"objects of type {kind}"] += 1
            return kind, None, position + size
        most = min((len(objects) - position) // size, 1 if size % 4 else len(objects))
        if not most:
            return kind, None, position + size
        records = np.frombuffer(objects, _dtype(kind, size), most, position)
        same = (records["signature"] == b"LOBJ") & (records["type"] == kind)
        same &= (records["size"] == size) & (records["version"] == 1)
        count = most if same.all() else int(np.argmin(same))
        return kind, records[:count], position + count * size

    def _frames(self, found: Array) -> Frames:
        is_wide = found["data"].ndim > 1
        is_valid = found["length"] <= (_MOST_BYTES if is_wide else 8)
        if not is_valid.all():
            self._log.skipped["messages with too many bytes"] += int(np.count_nonzero(~is_valid))
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
            data=np.ascontiguousarray(found["data"]) if is_wide else found["data"] & _USED_BITS[lengths],
            direction=np.where(found["state"] & _SENT, np.uint8(Mark.SENT), np.uint8(Mark.RECEIVED)),
        )


_USED = ["flags", "time", "channel", "state", "length", "id", "data"]
_USED_BITS = np.array([(1 << 8 * length) - 1 for length in range(9)], np.uint64)


def _dtype(kind: int, size: int) -> np.dtype[Any]:
    """A message in an object of a type and any size."""
    fields: dict[str, Any] = {**np.dtype(_RECORD).fields, **_FD_CONTENT.get(kind, {})}  # type: ignore[dict-item]
    if kind in _FD_DATA:
        fields["data"] = (("u1", (min(size - _FD_DATA[kind], _MOST_BYTES),)), _FD_DATA[kind])
    formats, offsets = zip(*(field[:2] for field in fields.values()), strict=True)
    return np.dtype({"names": [*fields], "formats": formats, "offsets": offsets, "itemsize": size})


_WIDE = np.dtype(
    [
        *(("flags", "<u4"), ("time", "<u8"), ("channel", "<u2"), ("state", "u1"), ("length", "u1")),
        *(("id", "<u4"), ("data", "<u8", _MOST_BYTES // 8)),
    ]
)
"""A message with room for the data of CAN FD."""


def _wide(found: Array, kind: int) -> Array:
    """Messages of one type with room for the data of CAN FD; bytes that are not used are 0."""
    wide = np.zeros(found.size, _WIDE)
    for name in ("flags", "time", "channel", "state", "id"):
        wide[name] = found[name]
    length, data = found["length"], found["data"]
    if kind == _FD_MESSAGE_64:
        wide["state"] |= np.where(found["fd"] & _FD_REMOTE, np.uint8(_REMOTE), np.uint8(0))
    elif kind not in _FD_CONTENT:
        length = np.where(length <= 8, length, np.uint8(0xFF))
        data = np.ascontiguousarray(data).view(np.uint8).reshape(-1, 8)
    wide["length"] = length
    octets = np.zeros((found.size, _MOST_BYTES), np.uint8)
    octets[:, : data.shape[1]] = data
    octets[np.arange(_MOST_BYTES) >= np.where(wide["state"] & _REMOTE, 0, length)[:, None]] = 0
    wide["data"] = octets.view("<u8")
    return wide
