"""Logs of every format give the same frames, and what is no frame is counted."""

from __future__ import annotations

import gzip
import io
import lzma
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import can
import pytest
from canwright.recordings import candump
from canwright.recordings.log_frame import Counts, LogFrame, Mark, SkippedPart
from canwright.recordings.readers import Log, LogError, open_log
from canwright.recordings.time_differences import since_start
from canwright.semantics.frame import CanFrame

from .test_forms import written

START = 1_700_000_000
MESSAGES = [
    can.Message(START + i / 8, id_, data=bytes.fromhex(data), is_extended_id=id_ > 0x7FF, channel=channel, is_rx=rx)
    for i, (id_, data, channel, rx) in enumerate(
        [
            (0x141, "A100000064000000", 0, False),
            (0x141, "A11A640000002301", 0, True),
            (0x280, "", 1, False),
            (0x12345678, "00FF", 1, True),
        ]
    )
]
FRAMES = [CanFrame(m.arbitration_id, bytes(m.data), m.is_extended_id) for m in MESSAGES]
MARKS = [Mark.SENT, Mark.RECEIVED, Mark.SENT, Mark.RECEIVED]


def log(content: bytes) -> Log:
    return Log(io.BytesIO(content), "the log")


def of(text: str) -> tuple[list[LogFrame], Log]:
    read = log(text.encode())
    return list(read), read


LOG_FORMATS = ["asc", "blf", "trc", "csv", "log", pytest.param("mf4", marks=pytest.mark.interop("asammdf"))]
"""The suffixes of the formats that python-can writes."""


@pytest.mark.parametrize("suffix", LOG_FORMATS)
def test_what_python_can_writes_is_read(suffix: str, tmp_path: Path) -> None:
    with open_log(str(written(tmp_path / f"log.{suffix}", MESSAGES))) as read:
        frames = list(read)
    assert [r.frame for r in frames] == FRAMES
    assert [r.mark for r in frames] == ([None] * 4 if suffix == "csv" else MARKS)
    times = [r.time - frames[0].time for r in frames if r.time is not None and frames[0].time is not None]
    assert times == [i * 125_000_000 for i in range(4)]
    buses = {"csv": ["", ""], "log": ["can0", "can1"], "mf4": ["0", "1"]}.get(suffix, ["1", "2"])
    assert [frames[0].bus, frames[2].bus] == buses
    assert not {p: n for p, n in read.counts.skipped.items() if p is not SkippedPart.OTHER}


@pytest.mark.parametrize(
    ("line", "data"),
    [
        ("(1.0) can0 141##0A100", "A100"),
        ("(1.0) can0 141##5" + "A1" * 64 + " R", "A1" * 64),
        (" can0  141  [12]  A1 00 00 00 00 00 00 00 00 00 00 FF", "A1" + "00" * 10 + "FF"),
        (" can0  141  [02]  A1 00", "A100"),
    ],
)
def test_frames_of_can_fd_in_candump(line: str, data: str) -> None:
    frames, read = of(f"{line}\n")
    assert [(r.frame.id, r.frame.data.hex().upper()) for r in frames] == [(0x141, data)]
    assert not read.counts.skipped


@pytest.mark.parametrize("suffix", [suffix for suffix in LOG_FORMATS if suffix != "trc"])  # TRC 1 has no CAN FD
def test_frames_of_can_fd_in_other_logs(suffix: str, tmp_path: Path) -> None:
    """As python-can writes them, of up to 8 bytes and of more."""
    contents = [bytes([0xA1, 7]), bytes(range(64)), bytes(12)]
    messages = [
        can.Message(1.0 + at, 0x8001, is_extended_id=True, data=data, is_fd=True, bitrate_switch=True)
        for at, data in enumerate(contents)
    ]
    with open_log(str(written(tmp_path / f"fd.{suffix}", messages))) as read:
        frames = list(read)
    assert [(r.frame.id, r.frame.extended, r.frame.data) for r in frames] == [(0x8001, True, data) for data in contents]


@pytest.mark.parametrize(
    ("line", "part"),
    [
        ("(1.0) can0 45123#81:00:12345678#1122", SkippedPart.XL),
        (f"141#{'A1' * 65}", SkippedPart.XL),
        ("(1.0) can0 20000004#0001000000000000", SkippedPart.ERROR),
        ("  can0  20000004   [8]  00 01 00 00 00 00 00 00   ERRORFRAME", SkippedPart.ERROR),
        ("\tcontroller-problem{rx-overflow-warning}", SkippedPart.OTHER),
        ("# a comment", SkippedPart.OTHER),
        ("", SkippedPart.OTHER),
        ("(1.0) can0 141#A1000", SkippedPart.MALFORMED),
        ("(1.0) can0 141#A1G0", SkippedPart.MALFORMED),
        ("  can0  141   [8]  A1 00 00", SkippedPart.MALFORMED),
        ("garbage \ufffd \x00", SkippedPart.MALFORMED),
    ],
)
def test_lines_without_a_frame_are_counted(line: str, part: SkippedPart) -> None:
    frames, read = of(f"141#A1\n{line}\n141#A2\n")
    assert [r.frame.data for r in frames] == [b"\xa1", b"\xa2"]
    assert read.counts.skipped == {part: 1}
    assert read.counts.examples == {part: [(2, line.strip()[:80])]}


def test_remote_frames_and_lines_of_cansend() -> None:
    frames, read = of("141#R\n12345678#R8\ncan0 142#A1.00.FF\n can0  143   [8]  remote request\n")
    assert [r.frame for r in frames] == [
        CanFrame(0x141, b"", remote=True),
        CanFrame(0x12345678, b"", True, True),
        CanFrame(0x142, b"\xa1\x00\xff"),
        CanFrame(0x143, b"", remote=True),
    ]
    assert read.counts.remote == 3
    assert [(r.time, r.mark) for r in frames] == [(None, None)] * 4


def test_a_time_of_more_than_64_bits_is_unknown() -> None:
    lines = [f"({seconds}.999999) can0 141#9A\n" for seconds in (9223372035, 9223372036, "9" * 30)]
    frames, read = of("".join(lines))
    assert [r.time for r in frames] == [9_223_372_035_999_999_000, None, None]
    assert not read.counts.skipped


@pytest.mark.parametrize(
    ("stamp", "nanoseconds"),
    [
        ("2024-02-09 10:13:20.000200500", 1_707_473_600_000_200_500),
        ("2024-02-09 10:13:20.5", 1_707_473_600_500_000_000),
        ("1.000000001", 1_000_000_001),
        ("1969-12-31 23:59:59.5", None),
        ("9999-02-09 10:13:20.000200", None),
        ("09.02.2024 10:13:20.000000", None),
    ],
)
def test_a_time_is_read_or_counted(stamp: str, nanoseconds: int | None) -> None:
    frames, read = of(f"({stamp})  can0  141   [8]  9A 00 00 00 00 00 00 00   '.(......'\n")
    assert [r.time for r in frames] == [nanoseconds]
    assert read.counts.untimed == (nanoseconds is None)
    assert read.counts.first_untimed[0] == (nanoseconds is None)


def test_a_frame_that_states_no_time_lacks_none() -> None:
    _, read = of("  can0  141   [8]  28 00 00 00 00 00 00 00   '(.......'\n141#A1\n")
    assert read.counts.untimed == 0
    _, read = of("t14112A\n")
    assert read.counts.untimed == 0
    _, read = of("timestamp,arbitration_id\n1e18,0x141,0,0,0,1,mg==\n")
    assert read.counts.untimed == 1


DIFFERENCES = ["000.000000", "000.000200", "000.009800", "000.000200", "1.5"]


def _with_times(stamps: list[str]) -> str:
    return "".join(f" ({stamp})  can0  141   [2]  9A 00\n" for stamp in stamps)


@pytest.mark.parametrize("packed", [False, True])
def test_times_that_are_differences_are_added_up(packed: bool) -> None:
    text = _with_times(DIFFERENCES).encode()
    read = log(gzip.compress(text) if packed else text)
    assert [r.time for r in read] == [0, 200_000, 10_000_000, 10_200_000, 1_510_200_000]
    assert read.counts.has_differences
    known = Log(io.BytesIO(_with_times(["0.5", "0.25"]).encode()), "the log", has_differences=True)
    assert [r.time for r in known] == [500_000_000, 750_000_000]


@pytest.mark.parametrize(
    "stamps",
    [
        ["1.5", "0.5", "0.4"],
        ["0.0", "0.1", "0.1", "0.2"],
        ["0.0", "0.1", "0.2", "0.0", "0.1", "0.2"],
        ["0.0", *(f"{n}.0" for n in range(1, 9)), "0.5"],
    ],
    ids=["another start", "never earlier", "two recordings", "too late in a stream"],
)
def test_a_clock_that_jumps_back_has_no_differences(stamps: list[str]) -> None:
    frames, read = of(_with_times(stamps))
    assert [r.time for r in frames] == [int(float(stamp) * 1e9) for stamp in stamps]
    assert not read.counts.has_differences


def test_a_log_that_is_cut_off_before_its_times_are_known_keeps_its_frames() -> None:
    def cut_off() -> Iterator[LogFrame]:
        yield from candump.read([_with_times(["0.0"])], Counts())
        raise EOFError

    frames = since_start(cut_off(), Counts(), 1000, are_differences=False)
    assert next(frames).time == 0
    with pytest.raises(EOFError):
        next(frames)


@pytest.mark.parametrize("suffix", ["blf", "blf.gz", "log.gz", "log.xz"])
def test_a_truncated_file_gives_what_it_has(suffix: str, tmp_path: Path) -> None:
    messages = (can.Message(START + i / 8, 0x141, data=(i * 7919).to_bytes(8, "little")) for i in range(20_000))
    content = written(tmp_path / f"log.{suffix.split('.')[0]}", messages).read_bytes()
    if suffix == "blf":
        content = content[: len(content) // 2]
    elif suffix.endswith("gz"):
        content = gzip.compress(content)
        content = content[: len(content) // 2]
    else:
        content = lzma.compress(content)
        content = content[: len(content) * 3 // 4]
    read = log(content)
    frames = list(read)
    assert 1_000 < len(frames) < 20_000
    assert read.counts.skipped[SkippedPart.TRUNCATED] == 1


def test_events_of_a_vector_log_are_no_frames() -> None:
    header = "date Tue Nov 14 10:13:20.000 pm 2023\nbase hex  timestamps absolute\ninternal events logged\n"
    frame = "   0.000100 1  141             Tx   d 8 9A 00 00 00 00 00 00 00  Length = 225910 BitCount = 116 ID = 321\n"
    statistic = "   0.000200 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%\n"
    frames, read = of(header + frame + statistic + frame)
    assert [r.frame.data for r in frames] == [bytes.fromhex("9A00000000000000")] * 2
    assert read.counts.skipped == {SkippedPart.OTHER: 1}
    damaged = "   0.000200 1  1:1             Rx   d 8 9A 00 00 00 00 00 00 00\n"
    _, read = of(header + frame + damaged + frame)
    assert read.counts.skipped == {SkippedPart.MALFORMED: 1}


def test_a_log_without_frames_names_its_first_line() -> None:
    with pytest.raises(LogError, match=r"the log has no frames \(line 1: `hello`\); record it with `candump -l`"):
        of("hello\n")
    with pytest.raises(LogError, match=r"the log has no frames;"):
        of("")


LINE = "(1700000000.000001) can0 141#A10000006400FF01 R\n"


@pytest.mark.parametrize("char", ["_", "+", "G", "#", ".", " ", "(", "\t", "f", "-", "\x1b", "\u0661", ""])
def test_a_line_with_a_known_bus_and_id_is_read_as_any_other(char: str) -> None:
    """Lines of known form take another way; wherever a line is changed, both ways give the same frames."""
    for at in range(len(LINE)):
        for changed in (LINE[:at] + char + LINE[at + 1 :], LINE[:at] + char + LINE[at:]):
            first, known = Counts(), Counts()
            alone = list(candump.read([changed], first))
            assert list(candump.read([LINE, LINE, changed], known))[2:] == alone, changed
            assert first.skipped == known.skipped, changed


def test_a_missing_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == "asammdf" else object())
    file = tmp_path / "log"
    file.write_bytes(b"MDF ")
    with open_log(str(file)) as log, pytest.raises(LogError, match=r"needs asammdf; run: pip install asammdf$"):
        list(log)


ASC_DATES = (
    "date Mon Mar 4 09:21:13.159 am 2024",
    "date Mo Mär 4 09:21:13.159 2024",
    "date Mo. 04.03.2024 09:21:13",
    "date lun. mars 4 09:21:13.159 2024",
    "date 周一 3月 4 09:21:13 2024",
)
ASC_TAILS = (
    "internal events logged\n// version 13.0.0\nBegin Triggerblock {}\n   0.000000 Start of measurement\n",
    "no internal events logged\n",
    "",
)
ASC_FRAMES = {
    "hex": ("8 9A 00 00 00 00 00 00 00", "8 9A 32 00 E7 01 00 00 00  Length = 240015 BitCount = 124 ID = 321", "141"),
    "dec": ("8 154 0 0 0 0 0 0 0", "8 154 50 0 231 1 0 0 0", "321"),
}


@pytest.mark.parametrize("date", ASC_DATES)
@pytest.mark.parametrize("tail", ASC_TAILS)
@pytest.mark.parametrize("base", ASC_FRAMES)
@pytest.mark.parametrize("times", ["absolute", "relative"])
def test_asc_of_any_language_with_absolute_or_relative_times(
    tmp_path: Path, date: str, tail: str, base: str, times: str
) -> None:
    """Relative times are since the line before, which can be an event."""
    request, reply, id_ = ASC_FRAMES[base]
    file = tmp_path / "log.asc"
    file.write_text(
        f"{date}\nbase {base}  timestamps {times}\n{tail.format(date[5:])}"
        f"   0.010000 1  {id_}  Tx   d {request}\n"
        f"   0.000500 1  {id_}  Rx   d {reply}\n"
        "   0.100000 1  Statistic: D 1 R 0 XD 0 XR 0 E 0 O 0 B 0.02%\n"
        f"   1.000000 1  {id_}  Tx   d {request}\n",
        encoding="utf-8",
    )
    with open_log(str(file)) as opened:
        frames = list(opened)
    since = {"absolute": [10, 0.5, 1000], "relative": [10, 10.5, 1110.5]}[times]
    assert [(recorded.time or 0) / 1e6 for recorded in frames] == since
    assert {recorded.frame.id for recorded in frames} == {0x141} and frames[1].frame.data.hex() == "9a3200e701000000"
    assert opened.counts.skipped == {SkippedPart.OTHER: 1}


@pytest.mark.parametrize(
    ("suffix", "start", "line"),
    [
        ("log", "", "(1.000000) can0 141#9A00000000000000\n"),
        ("asc", "base hex  timestamps absolute\n", "   0.5 1  141  Rx   d 8 9A 00 00 00 00 00 00 00\n"),
        ("trc", ";$FILEVERSION=1.1\n", "     1)      1059.9  Rx     0141  8  9A 00 00 00 00 00 00 00\n"),
        ("csv", "timestamp,arbitration_id,extended,remote,error,dlc,data\n", "1.5,0x141,0,0,0,8,mgAAAAAAAAA=\n"),
        ("csv", "Time Stamp,ID,Extended,Bus,LEN,D1,D2\n", "166064000,00000141,false,0,2,9A,00\n"),
    ],
)
@pytest.mark.parametrize("packed", [False, True])
def test_a_line_without_an_end_needs_no_memory(
    tmp_path: Path, suffix: str, start: str, line: str, packed: bool
) -> None:
    text = (start + line + line.rstrip() + " 00" * 3_000_000 + "\n" + line).encode()
    file = tmp_path / f"log.{suffix}"
    file.write_bytes(gzip.compress(text, 1) if packed else text)
    del text
    tracemalloc.start()
    with open_log(str(file)) as opened:
        assert len(list(opened)) == 2
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2_000_000
    assert opened.counts.skipped == {SkippedPart.MALFORMED: 1} and opened.counts.examples[SkippedPart.MALFORMED][0][
        0
    ] in (2, 3)
