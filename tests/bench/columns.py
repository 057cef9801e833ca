"""Speed and memory of the generated columns package: `python -m tests.bench.columns`.

One million frames, from a log of candump and from BLF, to columns of values; also without marks, with directions that
canwright infers. Beside it: python-can with cantools and the
generated DBC of the replies, on a part of the same log; and NumPy code for this one protocol, written by hand, which
reads the same logs to the same columns. It assumes a well-formed log whose lines have one length.

All run in this process, by process time; each figure is the median of the ratios of turns. Memory is that of a child
process that decodes a log and writes its tables as Parquet, with its Python, NumPy and Arrow.
"""

from __future__ import annotations

import gc
import itertools
import random
import shutil
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator, Mapping
from datetime import datetime, timezone
from pathlib import Path
from statistics import median
from typing import Any

import can
import cantools.database
import numpy as np
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.recordings.direction_arrays import infer_directions
from canwright.recordings.frame_classes import frame_classes
from canwright.semantics.frame import CanFrame
from canwright.targets.dbc.target import DbcTarget

from ..spec_texts import ROOT
from .bars import Measure, report

PACKAGE = ROOT / "generated/columns"
SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"
PARAMETERS = {"series": "MG", "encoder_bits": "18", "gear_ratio": "6"}
FRAMES = 1_000_000
LONG = 5_000_000
SAMPLE = 50_000
"""So many frames are decoded by python-can and cantools; their time is proportional to the number of frames."""
TURNS = 5
MEGABYTES = 200

CODES = (0x9A, 0x9C, 0xA1, 0x92, 0x30)
"""The codes in the log, and those that the code written by hand decodes, of both directions."""

Work = Callable[[], object]


def main() -> int:
    sys.path.insert(0, str(PACKAGE))
    with tempfile.TemporaryDirectory() as folder:
        logs = list(_logs(Path(folder)))
        return report([measure for log, part in logs for measure in _measures(log, part)])


def _logs(folder: Path) -> Iterator[tuple[Path, Path]]:
    """The logs of one million frames, each with a short one."""
    for ending in ("log", "blf"):
        paths = folder / f"long.{ending}", folder / f"part.{ending}"
        for path, count in zip(paths, (FRAMES, SAMPLE), strict=True):
            write_log(path, count)
        yield paths


def write_log(path: Path, count: int, *, has_marks: bool = True) -> None:
    """Requests, each with its reply, of all nodes; text of candump or BLF. BLF always has marks."""
    stamps = itertools.count(1_700_000_000_000_000, 250)
    frames = zip(range(count), stamps, _exchanged(), strict=False)
    if path.suffix == ".log":
        with path.open("w", encoding="ascii") as log:
            for number, stamp, (id_, data) in frames:
                seconds, fraction = divmod(stamp, 1_000_000)
                mark = f" {'TR'[number % 2]}" if has_marks else ""
                log.write(f"({seconds}.{fraction:06}) can0 {id_:03X}#{data.hex().upper()}{mark}\n")
        return
    with can.BLFWriter(str(path)) as writer:
        for number, stamp, (id_, data) in frames:
            writer.on_message_received(
                can.Message(
                    timestamp=stamp / 1e6, arbitration_id=id_, is_extended_id=False, data=data, is_rx=number % 2 == 1
                )
            )


def _exchanged() -> Iterator[tuple[int, bytes]]:
    """Ids and data of requests and replies by turns. Requests have no bits that they reserve."""
    item = specification(SPEC)
    assert item.frames is not None
    kinds = frame_classes(item.edition)
    data: dict[tuple[Direction, int], list[bytes]] = {}
    for frame in (f for f in item.frames.frames if f.id != 0x280):
        kind = kinds.of(CanFrame(frame.id, frame.data))
        request = kind.request if frame.direction is Direction.REQUEST else None
        if request is None or request.is_regular(int.from_bytes(frame.data, "little")):
            data.setdefault((frame.direction, frame.data[0]), []).append(frame.data)
    chosen = random.Random(1)
    while True:
        id_, code = 0x141 + chosen.randrange(32), chosen.choice(CODES)
        for way in Direction:
            yield id_, chosen.choice(data[way, code])


def _measures(log: Path, part: Path) -> Iterator[Measure]:
    read = {".log": read_candump, ".blf": read_blf}[log.suffix]
    ours, by_hand, peer = decoded_by_columns(log), decoded_by_hand(read(log)), cantools_work(part)
    _compare(ours, by_hand)
    turns = [
        [_seconds(work) for work in (lambda: decoded_by_columns(log), lambda: decoded_by_hand(read(log)), peer)]
        for _ in range(TURNS)
    ]
    kind = "BLF" if log.suffix == ".blf" else "candump"
    python_can = median(columns / (reader * FRAMES / SAMPLE) for columns, _, reader in turns)
    numpy = median(columns / hand for columns, hand, _ in turns)
    seconds = median(columns for columns, _, _ in turns)
    yield Measure(f"{kind}, time relative to python-can and cantools", python_can, at_most=0.1, note=f"{seconds:.2f} s")
    yield Measure(f"{kind}, time relative to NumPy by hand", numpy, at_most=2)
    yield Measure(f"{kind}, MB for 1 million frames", _memory(log), at_most=MEGABYTES)
    if log.suffix == ".log":
        long = log.parent / "longest.log"
        _repeat(log, long)
        yield Measure(f"{kind}, MB for 5 million frames", _memory(long), at_most=MEGABYTES)
        yield from _without_marks(log.parent, ours, peer)


def _without_marks(folder: Path, expected: Mapping[str, Any], peer: Work) -> Iterator[Measure]:
    """The same frames without marks, with inferred directions."""
    log, long = folder / "unmarked.log", folder / "longest.log"
    write_log(log, FRAMES, has_marks=False)
    _compare(decoded_by_columns(log, has_marks=False), expected)
    turns = [
        [_seconds(work) for work in (lambda: decoded_by_columns(log, has_marks=False), peer)] for _ in range(TURNS)
    ]
    python_can = median(columns / (reader * FRAMES / SAMPLE) for columns, reader in turns)
    seconds = median(columns for columns, _ in turns)
    title = "candump without marks"
    yield Measure(
        f"{title}, time relative to python-can and cantools", python_can, at_most=0.1, note=f"{seconds:.2f} s"
    )
    _repeat(log, long)
    yield Measure(f"{title}, MB for 5 million frames", _memory(long, str(SPEC)), at_most=MEGABYTES)


def _compare(ours: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    assert ours.keys() == wanted.keys() and len(ours) > 10, ours.keys() ^ wanted.keys()
    for name, values in ours.items():
        assert np.array_equal(values, wanted[name]), name


def _repeat(log: Path, long: Path) -> None:
    """Writes the content of a log several times into a long one."""
    with log.open("rb") as source, long.open("wb") as target:
        for _ in range(LONG // FRAMES):
            source.seek(0)
            shutil.copyfileobj(source, target)


def _seconds(work: Work) -> float:
    gc.collect()
    start = time.process_time()
    work()
    return time.process_time() - start


def _memory(log: Path, *spec: str) -> float:
    """The peak of a process that decodes a log and writes its tables as Parquet; a spec infers the directions."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.bench.columns_memory", str(PACKAGE), str(log), *spec],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def decoded_by_columns(log: Path, *, has_marks: bool = True) -> dict[str, Any]:
    """The columns of all tables, by table and column. Without marks, the directions are inferred."""
    from mwd_motor_columns import Direction as Way, logs, v2_35  # type: ignore[import-not-found]

    decoder = v2_35.decoder(PARAMETERS)
    by_name: dict[str, list[Any]] = {}
    blocks = logs.Log(log, received=Way.REPLY)
    for frames in blocks if has_marks else infer_directions(blocks, specification(SPEC).edition):
        for name, table in decoder.decode(frames).tables.items():
            by_name.setdefault(f"{name}.time", []).append(frames.time[table.rows])
            by_name.setdefault(f"{name}.node", []).append(table.node)
            for column, values in table.columns.items():
                by_name.setdefault(f"{name}.{column}", []).append(values)
    return {name: np.concatenate(parts) for name, parts in by_name.items()}


def cantools_work(log: Path) -> Work:
    """Decodes the replies of a log with cantools, of all nodes."""
    texts = {o.path: o.text for o in DbcTarget().generate([specification(SPEC)], PARAMETERS)}
    path = next(p for p in texts if p.startswith("mwd_motor-v2.35-MG") and "reply" in p and "node" not in p)
    database: Any = cantools.database.load_string(texts[path], "dbc", strict=False)

    def work() -> None:
        with can.LogReader(str(log)) as reader:
            for message in reader:
                if message.is_rx:
                    database.decode_message(message.arbitration_id, message.data, decode_choices=False)

    return work


Block = tuple[Any, Any, Any, Any]
"""Time in ns, id, whether it is a reply, and the data as `<u8`."""

LINES = 1 << 15


def read_candump(log: Path) -> Iterator[Block]:
    """Blocks of a log like `(1700000000.000000) can0 141#0011223344556677 R`, in which every line is of this form."""
    nibbles = np.zeros(256, np.uint8)
    for digit in "0123456789ABCDEF":
        nibbles[ord(digit)] = int(digit, 16)
    powers = 10.0 ** np.arange(9, -1, -1)
    with log.open("rb") as source:
        width = len(source.readline())
        source.seek(0)
        while text := source.read(width * LINES):
            lines = np.frombuffer(text, np.uint8).reshape(-1, width)
            seconds = ((lines[:, 1:11] - 48) @ powers).astype(np.int64)
            microseconds = ((lines[:, 12:18] - 48) @ powers[4:]).astype(np.int64)
            digits = nibbles[lines[:, 25:28]].astype(np.uint32)
            ids = digits[:, 0] << 8 | digits[:, 1] << 4 | digits[:, 2]
            data = nibbles[lines[:, 29:45]]
            words = (data[:, ::2] << 4 | data[:, 1::2]).view("<u8")[:, 0]
            yield seconds * 1_000_000_000 + microseconds * 1000, ids, lines[:, 46] == ord("R"), words


def read_blf(log: Path) -> Iterator[Block]:
    """Blocks of a BLF log in which each object is a CAN message of 48 bytes."""
    record = np.dtype(
        [
            ("head", "V24"),
            ("time", "<u8"),
            ("channel", "<u2"),
            ("state", "u1"),
            ("dlc", "u1"),
            ("id", "<u4"),
            ("data", "<u8"),
        ]
    )
    content = log.read_bytes()
    start = _start_of(content)
    position, rest = int.from_bytes(content[4:8], "little"), b""
    parts: list[bytes] = []
    while position < len(content):
        size = int.from_bytes(content[position + 8 : position + 12], "little")
        parts.append(zlib.decompress(content[position + 32 : position + size]))
        position += size + size % 4
        if len(parts) == 16 or position >= len(content):
            objects = rest + b"".join(parts)
            parts, count = [], len(objects) // record.itemsize
            records = np.frombuffer(objects, record, count)
            rest = objects[count * record.itemsize :]
            words = np.ascontiguousarray(records["data"])
            yield records["time"].astype(np.int64) + start, records["id"], records["state"] & 1 == 0, words


def _start_of(content: bytes) -> int:
    """The date of a BLF log in ns."""
    year, month, _, day, hour, minute, second, milliseconds = np.frombuffer(content, "<u2", 8, 40).tolist()
    moment = datetime(year, month, day, hour, minute, second, tzinfo=timezone.utc)
    start: int = int(moment.timestamp()) * 1_000_000_000 + milliseconds * 1_000_000
    return start


def decoded_by_hand(blocks: Iterator[Block]) -> dict[str, Any]:
    """The columns of all tables, by table and column."""
    by_name: dict[str, list[Any]] = {}
    for time_, ids, is_reply, words in blocks:
        code = words & 0xFF
        for table, mask in _tables(code, is_reply):
            rows = np.flatnonzero(mask)
            own = words[rows]
            columns = {"time": time_[rows], "node": (ids[rows] - 0x140).astype(np.int32), **_columns(table, own)}
            for name, values in columns.items():
                by_name.setdefault(f"{table}.{name}", []).append(values)
    return {name: np.concatenate(parts) for name, parts in by_name.items()}


def _tables(code: Any, is_reply: Any) -> Iterator[tuple[str, Any]]:
    is_request = ~is_reply
    yield "read_status_1_request", is_request & (code == 0x9A)
    yield "read_status_2_request", is_request & (code == 0x9C)
    yield "read_multi_turn_angle_request", is_request & (code == 0x92)
    yield "read_pid_request", is_request & (code == 0x30)
    yield "set_torque_request", is_request & (code == 0xA1)
    yield "motion_feedback", is_reply & ((code == 0x9C) | (code == 0xA1))
    yield "status_1", is_reply & (code == 0x9A)
    yield "pid_gains", is_reply & (code == 0x30)
    yield "read_multi_turn_angle_reply", is_reply & (code == 0x92)


def _columns(table: str, words: Any) -> dict[str, Any]:
    octets, shorts = words.view(np.uint8).reshape(-1, 8), words.view("<i2").reshape(-1, 4)
    if table == "set_torque_request":
        return {"iq": shorts[:, 2] * 33.0 / 2048}
    if table == "motion_feedback":
        return {
            "temperature": octets[:, 1].view(np.int8).copy(),
            "iq": shorts[:, 1] * 33.0 / 2048,
            "speed": shorts[:, 2].copy(),
            "encoder": shorts[:, 3].view(np.uint16) * 45.0 / 8192,
        }
    if table == "status_1":
        return {
            "temperature": octets[:, 1].view(np.int8).copy(),
            "voltage": (words >> 24 & 0xFFFF) / 10,
            "errors": octets[:, 7].copy(),
        }
    if table == "pid_gains":
        names = ("angle_kp", "angle_ki", "speed_kp", "speed_ki", "iq_kp", "iq_ki")
        return {name: octets[:, 2 + place].copy() for place, name in enumerate(names)}
    if table == "read_multi_turn_angle_reply":
        return {"angle": (words.view(np.int64) >> 8) / 100}
    return {}


if __name__ == "__main__":
    sys.exit(main())
