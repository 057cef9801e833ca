"""Logs that are damaged or made to do harm: they are read to their end, once, and what is no frame is counted."""

from __future__ import annotations

import bz2
import contextlib
import gzip
import lzma
import random
import struct
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import can
import pytest
from canwright.recordings.log_frame import SkippedPart
from canwright.recordings.readers import LogError, open_log

from ..spec_texts import ROOT
from .test_forms import LOGS, read, written

ASC = "base hex  timestamps absolute\n"
ASC_FRAME = "   0.5 1  141  Rx   d 8 9A 00 00 00 00 00 00 00\n"
TRC_FRAME = "     1)      1059.9  Rx     0141  8  9A 00 00 00 00 00 00 00 \n"
TRC2 = ";$FILEVERSION=2.1\n;$STARTTIME=45000.5\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n"
TRC2_FRAME = "  2 1.5 DT 1 0141 Rx - 8 9A 00 00 00 00 00 00 00\n"
CSV = "timestamp,arbitration_id,extended,remote,error,dlc,data\n"
CSV_FRAME = "0.5,0x141,0,0,0,8,mgAAAAAAAAA=\n"
SAVVYCAN = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n"
SAVVYCAN_FRAME = "1000,00000141,false,Rx,0,8,9A,00,00,00,00,00,00,00,\n"


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        (";$FILEVERSION=1.1\n;$STARTTIME=45000,5\n" + TRC_FRAME, (45000.5 - 25569) * 86400 + 1.0599),
        (";$FILEVERSION=1.1\n;$STARTTIME=x\n" + TRC_FRAME, 1.0599),
        (
            ";#####\n;    Start time: 11.09.2022 16:04:18.061\n     1)      1841      0141  8  9A 00 00 00 00 00 00 00 \n",
            1.841,
        ),
        (TRC2 + TRC2_FRAME, (45000.5 - 25569) * 86400 + 0.0015),
        (CSV + "\n" + CSV_FRAME, 0.5),
        ("Time Stamp,ID,Extended,LEN,D1\n500000,141,false,1,9A\n", 0.5),
        (ASC.replace("hex", "dec") + "   0.5 1  321  Rx   d 1 154\n", 0.5),
    ],
)
def test_headers_that_are_unusual(tmp_path: Path, text: str, seconds: float) -> None:
    (frame,), counts = read(tmp_path, text)
    assert frame.frame.id == 0x141 and frame.frame.data[0] == 0x9A
    assert frame.time is not None and round(frame.time / 1e9, 6) == round(seconds, 6)
    assert not {part for part in counts.skipped if part is not SkippedPart.OTHER}


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (";$FILEVERSION=2.1\nx\n 1 1.0 DT 0141 Rx 8 9A 00 00 00 00 00 00 00\n", r"no frames \(line 3: `1 1.0 DT 0141"),
        ("Time Stamp,ID,Extended\n1,141,false\n", "names no column LEN; export it again"),
        (SAVVYCAN.replace("Extended", "Extended?") + SAVVYCAN_FRAME, "names no column Extended; export it again"),
        *(
            (packed, "compressed log contains another compressed file, MF4 or a database; decompress it first")
            for packed in (
                gzip.compress(gzip.compress(ASC_FRAME.encode(), mtime=0), mtime=0),
                bz2.compress(b"SQLite format 3\0"),
                lzma.compress(b"MDF     4.10"),
            )
        ),
        (
            b"\xd4\xc3\xb2\xa1"
            + struct.pack("<HHiIII", 2, 4, 0, 0, 65535, 227)
            + struct.pack("<IIIII", 1, 0, 4, 4, 0x141),
            r"has no frames \(1 malformed\); record it",
        ),
    ],
)
def test_what_cannot_be_read_is_stated(tmp_path: Path, content: str | bytes, problem: str) -> None:
    with pytest.raises(LogError, match=problem):
        read(tmp_path, content)


@pytest.mark.parametrize(
    ("header", "good", "bad"),
    [
        (ASC, ASC_FRAME, "   0.5 1  141  Rx   d\n"),
        (ASC, ASC_FRAME, "   0.5 1  941  Rx   d 1 9A\n"),
        (ASC, ASC_FRAME, "   0.5 1  80000141x  Rx   d 1 9A\n"),
        (ASC, ASC_FRAME, "   0.5 1  -141  Rx   d 1 9A\n"),
        (ASC, ASC_FRAME, "   0.5 CANFD 1 Rx 141 1 0 2 2 9A\n"),
        (TRC2, TRC2_FRAME, TRC2_FRAME.replace("0141", "0941")),
        (TRC2, TRC2_FRAME, TRC2_FRAME.replace("0141", "80000141")),
        (TRC2, TRC2_FRAME, TRC2_FRAME.replace(" 8 ", " -1 ")),
        (CSV, CSV_FRAME, "0.5,0x141,0,0,0\n"),
        (CSV, CSV_FRAME, CSV_FRAME.replace("0x141", "0x941")),
        (CSV, CSV_FRAME, CSV_FRAME.replace("0x141", "-0x141")),
        (CSV, CSV_FRAME, CSV_FRAME.replace(",8,", ",7,")),
        (SAVVYCAN, SAVVYCAN_FRAME, SAVVYCAN_FRAME.replace("141", "941")),
        (SAVVYCAN, SAVVYCAN_FRAME, SAVVYCAN_FRAME.replace("00000141", "8141414141")),
        (SAVVYCAN, SAVVYCAN_FRAME, SAVVYCAN_FRAME.replace("00000141", "-141")),
        (SAVVYCAN, SAVVYCAN_FRAME, SAVVYCAN_FRAME.replace(",8,", ",-1,")),
        ("", "(1.0) can0 141#9A\n", "(1.0) can0 941#9A\n"),
        ("", "(1.0) can0 141#9A\n", "(1.0) can0 80000141#9A\n"),
    ],
)
def test_impossible_frames_are_malformed(tmp_path: Path, header: str, good: str, bad: str) -> None:
    frames, counts = read(tmp_path, header + good + bad + good)
    assert [recorded.frame.id for recorded in frames] == [0x141, 0x141]
    assert counts.skipped == {SkippedPart.MALFORMED: 1}
    assert counts.examples[SkippedPart.MALFORMED] == [(header.count("\n") + 2, bad.strip())]


@pytest.mark.parametrize("header", [ASC + "x\n" * 60_000, TRC2 + ";\n" * 60_000, ";$FILEVERSION=1.1\n" * 20_000])
def test_a_header_without_an_end_needs_no_memory(tmp_path: Path, header: str) -> None:
    file = tmp_path / "log"
    file.write_bytes(gzip.compress(header.encode()))
    tracemalloc.start()
    with open_log(str(file)) as log, pytest.raises(LogError, match="no frames"):
        list(log)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2_000_000


@pytest.mark.parametrize(("header", "line"), [(ASC, ASC_FRAME), (TRC2, TRC2_FRAME), (CSV, CSV_FRAME)])
def test_each_line_is_read_once(tmp_path: Path, header: str, line: str) -> None:
    """As many damaged lines after a long header as would take minutes if each of them read it again."""
    comment = ";" if header is TRC2 else "//"
    damaged = line.replace("0141", "9141").replace("  141", "  941").replace("0x141", "0x941")
    long_header = header + (f"{comment}\n" * 4_000 if header is not CSV else "\n" * 4_000)
    frames, counts = read(tmp_path, long_header + line + damaged * 4_000 + line)
    assert len(frames) == 2 and counts.skipped[SkippedPart.MALFORMED] == 4_000


def equal_messages(count: int, start: float = 0) -> Iterator[can.Message]:
    """Frames without a difference but in their times."""
    return (can.Message(start + at / 8, 0x141, is_extended_id=False, data=bytes(8)) for at in range(count))


@pytest.mark.interop("asammdf")
@pytest.mark.parametrize("kept", [70, 4000, -100, -1])
def test_a_truncated_mf4_is_stated_in_a_line(tmp_path: Path, kept: int) -> None:
    file = written(tmp_path / "log.mf4", equal_messages(2000))
    file.write_bytes(file.read_bytes()[:kept])
    command = [sys.executable, "-m", "canwright", "decode", str(file)]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1 and "has no frames" in result.stderr


@pytest.mark.parametrize("stamp", ["9" * 20 + "e99", "1e18", "1e99", "9" * 19])
def test_a_time_of_a_table_beyond_64_bits_is_unknown(tmp_path: Path, stamp: str) -> None:
    (frame,), _ = read(tmp_path, CSV + CSV_FRAME.replace("0.5", stamp))
    assert frame.time is None
    frames, counts = read(tmp_path, CSV + CSV_FRAME + CSV_FRAME.replace("0.5", "9" * 300 + "e99"))
    assert len(frames) == 1 and counts.skipped == {SkippedPart.MALFORMED: 1}


WRITTEN = ["asc", "blf", "trc", "csv", "log"]
WHOLE = {
    **LOGS,
    "utf-16": (SAVVYCAN + 9 * SAVVYCAN_FRAME).encode("utf-16"),
    "gz": gzip.compress((ASC + 9 * ASC_FRAME).encode(), mtime=0),
}
"""Logs without damage; those of the forms WRITTEN are written by python-can."""


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.exhaustive) for seed in range(2, 200))])
@pytest.mark.parametrize("form", [*WRITTEN, *WHOLE])
def test_mutants_end_soon_with_frames_or_a_sentence(tmp_path: Path, form: str, seed: int) -> None:
    """Logs with bytes that are changed, removed, repeated or cut off. What does not end takes minutes, on any machine."""
    whole = WHOLE.get(form) or written(tmp_path / f"whole.{form}", equal_messages(9, 1e9)).read_bytes()
    chance = random.Random(f"{form} {seed}")
    for _ in range(10):
        mutant = _mutated(whole, chance)
        start = time.process_time()
        with contextlib.suppress(LogError):
            read(tmp_path, mutant)
        assert time.process_time() - start < 20, mutant


def _mutated(whole: bytes, chance: random.Random) -> bytes:
    content = bytearray(whole)
    for _ in range(chance.choice([1, 1, 2, 8])):
        start = chance.randrange(len(content) + 1)
        end = min(len(content), start + chance.choice([0, 1, 1, 2, 8, 64]))
        inserted = chance.choice(
            [b"", bytes([chance.randrange(256)]), chance.choice(_PIECES), content[start:end] * 3, bytes(8)]
        )
        content[start:end] = inserted
    return bytes(content[: chance.choice([len(content), chance.randrange(len(content) + 1)])])


_PIECES = [b"\n", b"\n\n", b"-1", b"9" * 400, b"e99", b".", b",", b";", b"nan", b"\xff\xfe", b"\x1b[0m", b"\t", b"0x"]
"""What is put into logs, where readers take numbers and the ends of cells and lines."""


def test_what_a_log_contains_reaches_no_logger(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    frames, _ = read(tmp_path, ";$FILEVERSION=1.1\n;\n\x1b]0;title\x07\x1b[31mred\n" + TRC_FRAME)
    assert len(frames) == 1
    assert capfd.readouterr() == ("", "")
