"""What tools print and write: each of these texts, captures and databases has the same frames, in every encoding."""

from __future__ import annotations

import bz2
import gzip
import lzma
import re
import struct
from collections.abc import Callable, Iterable
from pathlib import Path

import can
import pytest
from canwright.recordings.log_frame import Counts, LogFrame, Mark, SkippedPart
from canwright.recordings.readers import LogError, open_log
from canwright.semantics.frame import CanFrame

SENT, RECEIVED = Mark.SENT, Mark.RECEIVED
FRAMES = [
    CanFrame(0x141, bytes.fromhex("9A00000000000000")),
    CanFrame(0x141, bytes.fromhex("9A20081364000000")),
    CanFrame(0x12345678, bytes.fromhex("00FF"), True),
    CanFrame(0x7FF, b""),
]
MARKS = [SENT, RECEIVED, SENT, RECEIVED]
SINCE = [0, 200_000, 10_000_000, 70_010_000_000]
"""The times of the frames in nanoseconds since the first one, which is later than a minute."""

CANDUMP = """\
(1700000000.000000) can0 141#9A00000000000000 T
(1700000000.000200) can0 141#9A20081364000000 R
(1700000000.010000) can0 12345678#00FF T
(1700000070.010000) can0 7FF# R
"""
CANDUMP_TERMINAL = """\
 (2023-11-14 22:13:20.000000)  can0  TX - -  141   [8]  9A 00 00 00 00 00 00 00   '........'
 (2023-11-14 22:13:20.000200)  can0  RX - -  141   [8]  9A 20 08 13 64 00 00 00
 (2023-11-14 22:13:20.010000)  can0  TX B E  12345678   [2]  00 FF
 (2023-11-14 22:14:30.010000)  can0  RX - -  7FF   [0]
"""
ASC = """\
base hex  timestamps absolute
   0.000000 1  141             Tx   d 8 9A 00 00 00 00 00 00 00
   0.000200 1  141             Rx   d 8 9A 20 08 13 64 00 00 00
   0.010000 1  12345678x       Tx   d 2 00 FF
  70.010000 1  7FF             Rx   d 0
"""
TRC2 = """\
;$FILEVERSION=2.1
;$STARTTIME=45000.5
;$COLUMNS=N,O,T,B,I,d,R,L,D
  1 0.000 DT 1 0141 Tx - 8 9A 00 00 00 00 00 00 00
  2 0.200 DT 1 0141 Rx - 8 9A 20 08 13 64 00 00 00
  3 10.000 DT 1 12345678 Tx - 2 00 FF
  4 70010.000 DT 1 07FF Rx - 0
"""
SAVVYCAN = """\
Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8
1700000000000000,00000141,false,Tx,0,8,9A,00,00,00,00,00,00,00,
1700000000000200,00000141,false,Rx,0,8,9A,20,08,13,64,00,00,00,
1700000000010000,12345678,true,Tx,0,2,00,FF,
1700000070010000,000007FF,false,Rx,0,0,
"""
PYTHON_CAN_CSV = """\
timestamp,arbitration_id,extended,remote,error,dlc,data
1700000000.0,0x141,0,0,0,8,mgAAAAAAAAA=
1700000000.0002,0x141,0,0,0,8,miAIE2QAAAA=
1700000000.01,0x12345678,1,0,0,2,AP8=
1700000070.01,0x7ff,0,0,0,0,
"""
PYTHON_CAN_OLD = """\
Can Logger (Started on 2023-11-14)
Timestamp: 1700000000.000000    ID: 0141    S Tx                DL:  8    9a 00 00 00 00 00 00 00     Channel: can0
Timestamp: 1700000000.000200    ID: 0141    S Rx                DL:  8    9a 20 08 13 64 00 00 00     Channel: can0
Timestamp: 1700000000.010000    ID: 12345678    X Tx                DL:  2    00 ff                     Channel: can0
Timestamp: 1700000070.010000    ID: 07ff    S Rx                DL:  0                              Channel: can0
"""
OLD_CANDUMP = """\
<0x141> [8] 9a 00 00 00 00 00 00 00
<0x141> [8] 9a 20 08 13 64 00 00 00
<0x12345678> [2] 00 ff
<0x7ff> [0]
"""
SLCAN = "\rZ1\rt14189A00000000000000\r\x07t14189A20081364000000\rT12345678200FF\rz\rt7FF0\r"
SLCAN_TIMES = "t14189A00000000000000EA5F\rt14189A200813640000000000\rT12345678200FF000A\rt7FF0271A\r"
"""Milliseconds that begin again after 59999: 1 ms, 11 ms and 10.011 s after the first frame."""
CRTD = """\
1700000000.000000 CXX OVMS CRTD version 3.1
1700000000.000000 1T11 141 9a 00 00 00 00 00 00 00
1700000000.000100 CEV something happened
1700000000.000200 1R11 141 9a 20 08 13 64 00 00 00
1700000000.010000 1T29 12345678 00 ff
1700000070.010000 1R11 7ff
"""
BUSMASTER = """\
***BUSMASTER Ver 3.2.2***
***[START LOGGING SESSION]***
***HEX***
***SYSTEM MODE***
***<Time><Tx/Rx><Channel><CAN ID><Type><DLC><DataBytes>***
17:25:00:0000 Tx 1 0x141 s 8 9A 00 00 00 00 00 00 00
17:25:00:0002 Rx 1 0x141 s 8 9A 20 08 13 64 00 00 00
17:25:00:0100 Tx 1 0x12345678 x 2 00 FF
17:26:10:0100 Rx 1 0x7FF s 0
***[STOP LOGGING SESSION]***
"""
BUSMASTER_DECIMAL = """\
***BUSMASTER Ver 2.0***
***DEC***
***RELATIVE MODE***
0:00:03:0000 Tx 1 321 s 8 154 0 0 0 0 0 0 0
0:00:00:0002 Rx 1 321 s 8 154 32 8 19 100 0 0 0
0:00:00:0098 Tx 1 305419896 x 2 0 255
0:01:10:0000 Rx 1 2047 s 0
"""
PCAN_EXPLORER = """\
    ;Index
    ;|    Time Offset [ms]
    1     37.935        1  141                                       Tx Data       8  9A 00 00 00 00 00 00 00
    2     38.135        1  141       Motor_Status                    Rx Data       8  9A 20 08 13 64 00 00 00
    3     47.935        1  12345678                                  Tx Data       2  00 FF
    4     70047.935     1  7FF                                       Rx Data       0
"""
CABANA = """\
time,addr,bus,data
0.000000,0x141,0,0x9A00000000000000
0.000200,0x141,0,0x9A20081364000000
0.010000,0x12345678,0,0x00FF
70.010000,0x7FF,0,0x
"""


def _socketcan(frame: CanFrame, order: str = ">") -> bytes:
    id_ = frame.id | (0x80000000 if frame.extended else 0)
    return struct.pack(f"{order}I", id_) + struct.pack("BBBB", len(frame.data), 0, 0, 0) + frame.data


def _sll(frame: CanFrame, order: str, mark: Mark) -> bytes:
    """A packet of the device `any`, with the id in the byte order of the host."""
    return struct.pack(">HHH8sH", 4 if mark is SENT else 1, 280, 0, bytes(8), 0x000C) + _socketcan(frame, order)


def _sll2(frame: CanFrame, order: str, mark: Mark) -> bytes:
    kind = 4 if mark is SENT else 1
    return struct.pack(">HHIHBB8s", 0x000C, 0, 3, 280, kind, 0, bytes(8)) + _socketcan(frame, order)


def _pcap(order: str, link: int, packets: list[bytes], digits: int = 6) -> bytes:
    magic = 0xA1B2C3D4 if digits == 6 else 0xA1B23C4D
    content = struct.pack(f"{order}IHHiIII", magic, 2, 4, 0, 0, 65535, link)
    for since, packet in zip(SINCE, packets, strict=True):
        seconds, fraction = divmod(since, 10**9)
        head = struct.pack(
            f"{order}IIII", 1_700_000_000 + seconds, fraction // 10 ** (9 - digits), len(packet), len(packet)
        )
        content += head + packet
    return content


def _block(order: str, kind: int, body: bytes) -> bytes:
    padded = body + bytes(-len(body) % 4)
    size = struct.pack(f"{order}I", len(padded) + 12)
    return struct.pack(f"{order}I", kind) + size + padded + size


def _pcapng(order: str, resolution: bytes, ticks: int) -> bytes:
    options = struct.pack(f"{order}HH4sHH1s3xHH", 2, 4, b"can0", 9, 1, resolution, 0, 0)
    content = _block(order, 0x0A0D0D0A, struct.pack(f"{order}IHHq", 0x1A2B3C4D, 1, 0, -1))
    content += _block(order, 1, struct.pack(f"{order}HHI", 227, 0, 0) + options)
    content += _block(order, 5, bytes(12))
    for since, frame in zip(SINCE, FRAMES, strict=True):
        stamp, packet = since * ticks // 10**9, _socketcan(frame)
        head = struct.pack(f"{order}IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(packet), len(packet))
        content += _block(order, 6, head + packet)
    return content


NO_MARKS = [None] * 4
NO_TIMES = [None] * 4
CAPTURED = {
    "pcap": _pcap("<", 227, [*map(_socketcan, FRAMES)]),
    "pcap, big-endian, ns": _pcap(">", 227, [*map(_socketcan, FRAMES)], 9),
    "pcap of any": _pcap("<", 113, [_sll(*pair) for pair in zip(FRAMES, "<<<<", MARKS, strict=True)]),
    "pcap of any, big-endian": _pcap(">", 113, [_sll(*pair) for pair in zip(FRAMES, ">>>>", MARKS, strict=True)]),
    "pcap of any, version 2": _pcap("<", 276, [_sll2(*pair) for pair in zip(FRAMES, "<<<<", MARKS, strict=True)]),
    "pcapng": _pcapng("<", b"\x06", 10**6),
    "pcapng, big-endian, ns": _pcapng(">", b"\x09", 10**9),
    "pcapng, binary ticks": _pcapng("<", b"\x9e", 1 << 30),
}
TEXTS = {
    "python-can": PYTHON_CAN_OLD,
    "old candump": OLD_CANDUMP,
    "slcan": SLCAN,
    "CRTD": CRTD,
    "BUSMASTER": BUSMASTER,
    "BUSMASTER, decimal": BUSMASTER_DECIMAL,
    "PCAN-Explorer": PCAN_EXPLORER,
    "Cabana": CABANA,
    "candump -l": CANDUMP,
    "candump -x": CANDUMP_TERMINAL,
    "ASC": ASC,
    "TRC": TRC2,
    "SavvyCAN": SAVVYCAN,
    "CSV": PYTHON_CAN_CSV,
}
LOGS: dict[str, bytes] = {**{name: text.encode() for name, text in TEXTS.items()}, **CAPTURED}
REPLY = re.compile("9a[ ,]?20[ ,]?08[ ,]?13|154 32 8 19|miAIE2", re.IGNORECASE)
WITHOUT_MARKS = {"old candump", "slcan", "Cabana", "CSV", "pcap", "pcap, big-endian, ns"}
BUSES = {
    **dict.fromkeys(("python-can", "candump -l", "candump -x"), "can0"),
    **dict.fromkeys(("old candump", "slcan", "CSV"), ""),
    **dict.fromkeys(("Cabana", "SavvyCAN"), "0"),
}
ENCODINGS: dict[str, Callable[[bytes], bytes]] = {
    "plain": lambda content: content,
    "bz2": bz2.compress,
    "gz": gzip.compress,
    "xz": lzma.compress,
    "crlf": lambda text: text.replace(b"\n", b"\r\n"),
    "utf-8-sig": lambda text: text.decode().encode("utf-8-sig"),
    "utf-16": lambda text: text.decode().encode("utf-16"),
    "utf-16-le": lambda text: text.decode().encode("utf-16-le"),
}
"""The first four are also those of captures."""


def written(file: Path, messages: Iterable[can.Message]) -> Path:
    """A log as python-can writes it, in the form of its suffix."""
    with can.Logger(str(file)) as writer:
        for message in messages:
            writer.on_message_received(message)
    return file


def read(tmp_path: Path, content: str | bytes) -> tuple[list[LogFrame], Counts]:
    file = tmp_path / "log"
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    with open_log(str(file)) as log:
        return list(log), log.counts


@pytest.mark.parametrize(
    ("name", "encoding"), [(name, each) for name in LOGS for each in [*ENCODINGS][: None if name in TEXTS else 4]]
)
def test_the_same_frames_in_every_form_and_encoding(tmp_path: Path, name: str, encoding: str) -> None:
    frames, counts = read(tmp_path, ENCODINGS[encoding](LOGS[name]))
    assert [recorded.frame for recorded in frames] == FRAMES
    is_marked = name not in WITHOUT_MARKS and not name.startswith("pcapng")
    assert [recorded.mark for recorded in frames] == (MARKS if is_marked else NO_MARKS)
    has_name = name.startswith("pcapng")
    bus = "can0" if has_name else "" if name.startswith("pcap") else BUSES.get(name, "1")
    assert {recorded.bus for recorded in frames} == {bus}
    times = [recorded.time for recorded in frames]
    if name in ("old candump", "slcan"):
        assert times == NO_TIMES
    else:
        first = times[0] or 0
        rounding = 1 if "binary" in name else 0
        assert all(abs((at or 0) - first - since) <= rounding for at, since in zip(times, SINCE, strict=True))
    assert not {part for part in counts.skipped if part is not SkippedPart.OTHER}
    assert counts.frames == 4


def test_milliseconds_of_slcan_begin_again_after_a_minute(tmp_path: Path) -> None:
    frames, _ = read(tmp_path, SLCAN_TIMES.encode())
    assert [recorded.frame for recorded in frames] == FRAMES
    assert [(recorded.time or 0) // 1_000_000 - 59_999 for recorded in frames] == [0, 1, 11, 10_011]


def test_the_text_and_the_database_of_the_installed_python_can(tmp_path: Path) -> None:
    messages = [
        can.Message(1.7e9 + i / 8, f.id, is_extended_id=f.extended, data=f.data, channel="can0", is_rx=mark is RECEIVED)
        for i, (f, mark) in enumerate(zip(FRAMES, MARKS, strict=True))
    ]
    messages.append(can.Message(1.7e9 + 1, 0x141, is_extended_id=False, is_remote_frame=True, channel="can0"))
    messages.append(can.Message(1.7e9 + 1, 0x141, is_extended_id=False, data=b"ab1", channel="can0"))
    messages.append(can.Message(1.7e9 + 1, 0x20000000, is_error_frame=True, channel="can0"))
    expected = [*FRAMES, CanFrame(0x141, b"", remote=True), CanFrame(0x141, b"ab1")]
    for form in ("txt", "db"):
        with open_log(str(written(tmp_path / f"log.{form}", messages))) as log:
            frames = list(log)
        assert [recorded.frame for recorded in frames] == expected
        times = [recorded.time for recorded in frames]
        assert times[:4] == [1_700_000_000_000_000_000 + i * 125_000_000 for i in range(4)]
        assert log.counts.skipped == {SkippedPart.ERROR: 1}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_that_ends_within_a_byte_is_truncated(tmp_path: Path, name: str) -> None:
    """The end of the last line alone may be missing, but for a decimal number. Some formats do not state a length."""
    lines = TEXTS[name].replace("\r", "\n").splitlines(keepends=True)
    at = next(i for i, line in enumerate(lines) if REPLY.search(line))
    whole = lines[at].split("Channel")[0].rstrip(" ,\n").removesuffix(" R")
    frames, counts = read(tmp_path, "".join([*lines[:at], whole]).encode())
    assert [recorded.frame for recorded in frames] == FRAMES[: 1 if "decimal" in name else 2]
    for cut in (
        (1,) if name in ("CRTD", "Cabana") else (1, 4, len(whole) // 2) if "[8]" in whole else (1, len(whole) // 2)
    ):
        frames, counts = read(tmp_path, "".join([*lines[:at], whole[:-cut]]).encode())
        assert [recorded.frame for recorded in frames] == FRAMES[:1]
        assert counts.skipped[SkippedPart.TRUNCATED] == 1


@pytest.mark.parametrize("name", TEXTS)
def test_a_damaged_line_is_counted_and_reading_goes_on(tmp_path: Path, name: str) -> None:
    lines = TEXTS[name].replace("\r", "\n").splitlines(keepends=True)
    at = next(i for i, line in enumerate(lines) if REPLY.search(line))
    damaged = REPLY.sub(lambda data: data[0].replace("13", "1G").replace(" 19", " 300").replace("AI", "*"), lines[at])
    frames, counts = read(tmp_path, "".join([*lines[: at + 1], damaged, *lines[at + 1 :]]).encode())
    assert [recorded.frame for recorded in frames] == FRAMES
    assert counts.skipped[SkippedPart.MALFORMED] == 1
    assert counts.examples[SkippedPart.MALFORMED] == [(at + 2, damaged.strip()[:80])]


@pytest.mark.parametrize("name", CAPTURED)
@pytest.mark.parametrize("cut", [1, 9, 20])
def test_a_capture_that_was_cut_off(tmp_path: Path, name: str, cut: int) -> None:
    frames, counts = read(tmp_path, CAPTURED[name][:-cut])
    assert [recorded.frame for recorded in frames][:3] == FRAMES[:3] or len(frames) == 2
    assert counts.skipped[SkippedPart.TRUNCATED] == 1


ROS = "header:\n  stamp:\n    sec: 1700000000\n  frame_id: can\nid: 321\nis_rtr: false\ndlc: 1\ndata: [154]\n---\n"


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (ROS.encode(), r"`ros2 topic echo` prints this; record the bus with `candump -l`"),
        (
            b"# Logger type: CL2000\nTimestamp;Type;ID;Data\n01T022231683;8;7df;02\n",
            "CL2000 writes this; write each frame",
        ),
        (b"TimestampEpoch;BusChannel;ID;IDE\n1.5;1;141;0\n", "mdf2csv writes this; read the MF4 file"),
        (_pcap("<", 1, [*map(_socketcan, FRAMES)]), r"not of CAN \(link type 1\); capture a device such as can0"),
    ],
)
def test_what_is_not_read_is_named_with_a_way(tmp_path: Path, content: bytes, problem: str) -> None:
    with pytest.raises(LogError, match=problem):
        read(tmp_path, content)


def test_a_database_of_another_program(tmp_path: Path) -> None:
    import sqlite3

    file = tmp_path / "log.db"
    with sqlite3.connect(file) as database:
        database.execute(
            "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) SELECT i FROM n"
        )
    database.close()
    with open_log(str(file)) as log, pytest.raises(LogError, match="no table `messages`"):
        list(log)
