"""`canwright decode`: rows, their outputs, the summary, and single frames."""

from __future__ import annotations

import contextlib
import csv
import functools
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import IO, Any

import can
import cantools.database
import pytest
from canwright.cli import main
from canwright.conformance.adapter import assignment
from canwright.conformance.runner import as_number
from canwright.model import formatting
from canwright.model.edition import Edition
from canwright.model.golden_frames import GoldenFrame
from canwright.model.message import Direction, Message
from canwright.project.golden_file import read_golden_file
from canwright.project.loader import specification
from canwright.recordings import plot
from canwright.recordings.bus_behaviour import Behaviour, OldBits
from canwright.recordings.directions import Directions
from canwright.recordings.doubts import doubts
from canwright.recordings.golden_text import golden_text
from canwright.recordings.log_frame import LogFrame, Mark
from canwright.recordings.rows import Row, RowReader, elements as elements_of
from canwright.recordings.summary import NodeSummary, Summary
from canwright.semantics.decoder import Decoder, Identified
from canwright.semantics.frame import CanFrame
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL, ROOT, SPECS, WITHOUT_SETTINGS_IN_IDS, called
from .traffic import Loss, Sent, Traffic

V2_35 = ROOT / "spec/mwd_motor/v2.35.yaml"
V2_36 = ROOT / "spec/mwd_motor/v2.36-2025-03.yaml"
BOTH_V2_35 = (f"--spec={V2_35}", f"--spec={V2_35.with_name('v2.35-2024-02.yaml')}")
BOTH_V2_36 = (f"--spec={V2_36}", f"--spec={V2_36.with_name('v2.36-2024-11.yaml')}")

# 155 * 33/2048 A = 2.49755859375 A; 48.7 V as 0.1 V and 48.72 V as 0.01 V; 32768 / 2^16 * 360 = 180 degrees
MIXED = """\
(1.000000) can0 141#A10000009B000000
(1.000100) can1 143#9A00000000000000
(1.000200) can0 141#A1329B00F4010080
(1.000250) can1 183#9A32081364000000
(1.001000) can0 142#9A00000000000000
(1.001200) can0 142#9A3200E701000000
(1.002000) can0 7FF#00
"""
SETTINGS = ("--set", "can0:1:edition=v2.35", "--set", "2:edition=v2.35", "--set", "3:edition=v2.36-2025-03")


@pytest.fixture(autouse=True)
def without_golden_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two editions, which load faster without their golden frames."""
    for file in (V2_35, V2_36):
        (tmp_path / "spec/mwd_motor").mkdir(parents=True, exist_ok=True)
        (tmp_path / "spec/mwd_motor" / file.name).write_bytes(file.read_bytes())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def decode(log: str, *options: str, status: int | None = 0) -> Result:
    """What `decode` prints of a log; the status may be any if it is None."""
    Path("bus.log").write_text(log, "utf-8")
    return run("bus.log", *options, status=status)


def run(*arguments: str, status: int | None = 0, stdin: str = "") -> Result:
    result = CliRunner().invoke(main, ["decode", *arguments], input=stdin.encode())
    assert status in (None, result.exit_code), result.output
    return result


def json_rows(text: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in text.splitlines()]


def test_rows_of_two_editions_on_two_buses() -> None:
    result = decode(MIXED, *SETTINGS, "--set", "series=MF", "--set", "1:series=MG", "--format", "jsonl")
    rows = json_rows(result.stdout)
    keys = ("bus", "node", "edition", "direction", "decided_by", "command", "request", "latency_ms")
    assert [tuple(row[key] for key in keys) for row in rows] == [
        ("can0", 1, "v2.35", "request", "pairing", "set_torque", None, None),
        ("can1", 3, "v2.36-2025-03", "request", "id", "read_status_1", None, None),
        ("can0", 1, "v2.35", "reply", "content", "set_torque", 0, 0.2),
        ("can1", 3, "v2.36-2025-03", "reply", "id", "read_status_1", 1, 0.15),
        ("can0", 2, "v2.35", "request", "pairing", "read_status_1", None, None),
        ("can0", 2, "v2.35", "reply", "content", "read_status_1", 4, 0.2),
        ("can0", None, None, None, "none", None, None, None),
    ]
    assert rows[0]["fields"] == {"iq": {"raw": 155, "value": 2.49755859375, "unit": "A"}}
    fields = [row["fields"] for row in rows]
    assert isinstance(fields[3], dict) and isinstance(fields[5], dict)
    assert (fields[3]["voltage"], fields[3]["motor_state"]) == (
        {"raw": 4872, "value": 48.72, "unit": "V"},
        {"raw": 0, "value": "on"},
    )
    assert fields[5]["voltage"]["value"] == 48.7
    assert '"time": 1.000250000,' in result.stdout
    assert "1 frame with foreign ids: 0x7FF (1)" in result.stderr


# Requests to one id; the node is in the data. The replies have an id of each node, an id of all, or four bits of the node
NODES_IN_DATA = """\
(1.000000) can0 7E5#1000006F00000000
(1.000200) can0 46F#100000000DF0AD8B
(1.001000) can0 7E6#1125000000000000
(1.001200) can0 7E4#1150000002010000
(1.002000) can0 7E6#1107000000000000
(1.002200) can0 7E4#1170000002010000
(2.002200) can0 7E4#1130000002010000
"""


def test_the_node_in_the_data_of_a_frame() -> None:
    spec = ("--spec", str(ROOT / "tests/specs/valve/v1.yaml"))
    printed = json_rows(decode(NODES_IN_DATA, *spec, "--format", "jsonl").stdout)
    assert [(row["node"], row["request"]) for row in printed] == [
        (111, None),
        (111, 0),
        (37, None),
        (37, 2),
        (7, None),
        (7, 4),
        (None, None),  # the node of a reply alone is unknown: 3, 19, 35 and others have these four bits
    ]
    text = decode(NODES_IN_DATA, *spec).stdout
    assert "can0, node 37, v1: 1 request, 1 reply after 0.200 ms" in text
    assert "can0, no node, v1: 0 requests, 1 reply\n  1 unexpected" in text
    text = run("7E6#1125000000000000", *spec).stdout
    assert "request of read_version to node 37" in text


def test_the_edition_is_identified_for_each_node() -> None:
    result = decode(MIXED, "--format", "csv")
    editions = {(row["bus"], row["node"]): row["edition"] for row in csv.DictReader(io.StringIO(result.stdout))}
    assert editions[("can0", "2")] == "v2.35"
    assert editions[("can1", "3")] == "v2.36-2025-03"
    assert "can0, node 2, v2.35 (identified): 1 request, 1 reply after 0.200 ms on average" in result.stderr
    unknown = "".join(f"(1.0) can0 {id_}#EE00000000000000\n" for id_ in (141, 142, 143, 145))
    text = decode(unknown, status=1).output
    assert "can0, nodes 1..3, 5: no edition fits" in text and "--set 1:edition=NAME" in text


def test_editions_that_fit_equally_well_are_all_named() -> None:
    frames = "(1.0) can0 143#9C00000000000000\n(1.0002) can0 183#9C32010002000A00\n"
    result = decode(frames, *BOTH_V2_36, "--format", "jsonl")
    assert {row["edition"] for row in json_rows(result.stdout)} == {"v2.36-2024-11|v2.36-2025-03"}
    assert "(v2.36-2025-03 fits as well, and all frames mean the same)" in result.stderr
    decode(frames, *BOTH_V2_36, "--set", "edition=v2.36-2024-11")


def test_a_meaning_that_editions_do_not_share_is_a_finding() -> None:
    """Index 0x22 is the maximum angle in one edition, and the upper limit of the angle in the other."""
    frames = "(1.0) can0 143#C022000000000000\n(1.0002) can0 183#C02200000A000000\n"
    result = decode(frames, *BOTH_V2_36, "--format", "jsonl", status=1)
    assert {row["edition"] for row in json_rows(result.stdout)} == {"v2.36-2024-11|v2.36-2025-03"}
    assert "with other meanings of read_control_parameter; --set 3:edition=NAME decides)" in result.stderr


STATUS = "(2.{0:06}) can0 142#9A00000000000000\n(2.{0:06}) can0 142#9A3200E701000000\n"
TORQUE = "(1.{0:06}) can0 141#A10000009B000000\n(1.{0:06}) can0 141#A1329B00F4010080\n"


def test_a_node_that_appears_late() -> None:
    new = "".join(f"(3.{i:06}) can0 143#9A00000000000000\n(3.{i:06}) can0 183#9A32081364000000\n" for i in range(20))
    log = "".join((STATUS + TORQUE).format(i) for i in range(1200)) + new
    for result in (decode(log, "--format", "jsonl"), run("-", "--format", "jsonl", stdin=log)):
        decoded = [(row["edition"], row["fields"]) for row in json_rows(result.stdout) if row["node"] == 3]
        assert {edition for edition, _ in decoded} == {"v2.36-2025-03"}
        assert decoded[-1][1]["voltage"]["value"] == 48.72  # type: ignore[index]


def test_frames_of_a_stream_that_were_read_with_another_edition() -> None:
    """Two editions fit until the stream has a reply in which they differ."""
    torque = "".join(TORQUE.format(i) for i in range(2000))
    status = "".join(
        f"(3.{i:06}) can0 141#9A00000000000000\n(3.{i:06}) can0 141#9A32081364000000\n" for i in range(500)
    )
    result = decode(torque + status, *BOTH_V2_35, "--format", "jsonl")
    assert {row["edition"] for row in json_rows(result.stdout)} == {"v2.35-2024-02"}
    rows_ = json_rows(run("-", *BOTH_V2_35, "--format", "jsonl", stdin=torque + status, status=1).stdout)
    assert {str(row["edition"]) for row in rows_[:4000]} == {"v2.35|v2.35-2024-02"}
    assert rows_[-1]["edition"] == "v2.35-2024-02"


def test_differences_of_times_and_times_that_cannot_be_read_are_stated() -> None:
    stamps = ["000.000000", "000.000200", "000.009800", "000.000200"]
    frames = ["142   [8]  9A 00 00 00 00 00 00 00", "142   [8]  9A 32 00 E7 01 00 00 00"] * 2
    lines = [f" ({stamp})  can0  {frame}\n" for stamp, frame in zip(stamps, frames, strict=True)]
    text = decode("".join(lines), *SETTINGS).stdout
    assert "2 requests, 2 replies after 0.200 ms on average" in text and "#3  0.010200" in text
    assert "the times are differences, as of `candump -td`, and were added up" in text
    text = decode("".join(lines[1:3]), *SETTINGS, "--time-differences").stdout
    assert "#1  0.010000" in text
    text = decode(lines[0] + lines[1].replace("000.000200", "1.2.3"), *SETTINGS, status=1).stdout
    assert "1 frame without a time, since it cannot be read (line 2: `(1.2.3) can0 142" in text


EARLY = """\
Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8
-1769000000020000,00000142,false,Tx,0,8,9A,00,00,00,00,00,00,00,
-1769000000019800,00000142,false,Rx,0,8,9A,32,00,E7,01,00,00,00,
-500000,00000142,false,Tx,0,8,9A,00,00,00,00,00,00,00,
-499750,00000142,false,Rx,0,8,9A,32,00,E7,01,00,00,00,
"""


@pytest.mark.parametrize("suffix", [".log", ".asc", ".blf"])
def test_a_split_log_of_times_before_the_epoch_is_read_again(suffix: str) -> None:
    """ASC and BLF count from the first frame."""
    decode(EARLY, *SETTINGS, "--split", f"split{suffix}")
    printed = json_rows(run(f"split{suffix}", *SETTINGS, "--format", "jsonl").stdout)
    assert [(row["direction"], row["command"]) for row in printed] == [
        ("request", "read_status_1"),
        ("reply", "read_status_1"),
    ] * 2
    times = [Fraction(str(row["time"])) for row in printed]
    start = Fraction(-1769000000020000) if suffix == ".log" else times[0] * 1_000_000
    since = [Fraction(line.split(",")[0]) + 1769000000020000 for line in EARLY.splitlines()[1:]]
    assert [round(time * 1_000_000 - start) for time in times] == since


NEIGHBOURS = """
bus:
  neighbours:
    pumps: {ids: 0x181..0x183, title: Pumps, about: They reply to lamps.}
    far: {ids: 0x12345}
"""


def test_a_log_without_a_frame_of_the_family_is_undecided(tmp_path: Path) -> None:
    log = tmp_path / "other.log"
    log.write_text("(1.0) can0 123#00\n", "utf-8")
    for command in ("decode", "identify"):
        result = CliRunner().invoke(main, [command, str(log)])
        assert (result.exit_code, result.output.splitlines()[-1]) == (1, "undecided: no frame has an id of mwd_motor")
    log.write_text("(1.0) can0 141#FF\n(1.1) can0 141#9AFF\n", "utf-8")
    assert "undecided" not in CliRunner().invoke(main, ["decode", str(log)]).output


def test_ids_of_neighbours_get_the_sentence_of_the_spec() -> None:
    """In the summary, in `identify` and of a single frame; an id of 29 bits is not one of 11 bits."""
    Path("lamp.yaml").write_text(MINIMAL + NEIGHBOURS, "utf-8")
    lines = [
        f"(1.{n}) can0 {id_}#1000640000000000\n" for n, id_ in enumerate(("181", "00000182", "183", "00012345", "184"))
    ]
    text = decode("".join(lines), "--spec", "lamp.yaml", status=1).output
    stated = ["  0x181, 0x183: Pumps. They reply to lamps.\n", "  0x00012345: Far\n"]
    for sentence in stated:
        assert sentence in text
    assert "0x00000182:" not in text
    assert "0x184:" not in text
    result = CliRunner().invoke(main, ["identify", "bus.log", "--spec", "lamp.yaml"])
    for sentence in stated:
        assert sentence in result.output
    assert "\n0x183: Pumps. They reply to lamps.\n" in run("183#10", "--spec", "lamp.yaml", status=1).output
    assert "Pumps" not in run("184#10", "--spec", "lamp.yaml", status=1).output


@pytest.mark.parametrize(
    ("ids", "message"),
    [
        ("0x20000000", "is not an id or a range of them; write, for example, 0x300 or 0x241..0x260"),
        ("-1", "is not an id or a range of them"),
        ("nan", "is not an id or a range of them"),
        ("0x260..0x241", "is empty"),
    ],
)
def test_ids_of_neighbours_exist(ids: str, message: str) -> None:
    Path("lamp.yaml").write_text(MINIMAL + NEIGHBOURS.replace("0x12345", ids), "utf-8")
    assert message in decode(MIXED, "--spec", "lamp.yaml", status=1).output


def split_rows(log: str, suffix: str, *options: str) -> tuple[list[dict[str, object]], list[dict[str, object]]]:
    """The rows of a log, and of the file that it is split into; times are since the first, ASC and BLF lack its date."""
    results: list[list[dict[str, object]]] = []
    Path("bus.log").write_text(log, "utf-8")
    for name, *more in (["bus.log", "--split", f"split{suffix}"], [f"split{suffix}", "--from-split"]):
        result = CliRunner().invoke(main, ["decode", name, *more, *options, "--format", "jsonl"])
        rows = json_rows(result.stdout)
        start = rows[0]["time"]
        for row in rows:
            row["time"] = round((row["time"] - start) * 1e6)  # type: ignore[operator]
            del row["decided_by"]
        buses = list(dict.fromkeys(row["bus"] for row in rows))
        results.append([{**row, "bus": buses.index(row["bus"])} for row in rows])
    written, read = results
    return written, read


def recorded(sent: Sequence[Sent]) -> str:
    return "".join(
        f"({(frame.time or 0) / 10**9:.6f}) {frame.bus} {formatting.sent(frame.frame)}\n" for frame, _ in sent
    )


@pytest.mark.parametrize("only", [(), (Direction.REQUEST,), (Direction.REPLY,)])
@pytest.mark.parametrize("spec", [V2_35, V2_36, ROOT / "tests/specs/servo/v1.yaml"], ids=["v2.35", "v2.36", "fd"])
@pytest.mark.parametrize("suffix", [".log", ".asc", ".blf"])
def test_a_split_log_has_the_rows_of_the_log(suffix: str, spec: Path, only: Sequence[Direction]) -> None:
    """Also a log of requests or replies alone, and frames of CAN FD, with the edition known and identified."""
    edition = specification(spec).edition
    both = [
        sent
        for seed, bus in enumerate(("can0", "vcan1"))
        for sent in Traffic(edition, "mixed", seed, loss=Loss(0.1, has_retries=True), nodes=2, bus=bus).frames(60)
        if not only or sent.direction in only
    ]
    log = recorded(sorted(both, key=lambda sent: sent.recorded.time or 0)) + "(1700000001.0) can0 7FF#00\n"
    written, read = split_rows(log, suffix, "--spec", str(spec))
    assert read == written
    assert {row["direction"] for row in read} == {None, *(only or Direction)}
    assert len(read) > 50
    if ROOT / "spec" in spec.parents:
        written, read = split_rows(log, suffix)
        assert read == written


@pytest.mark.parametrize(
    "text",
    [
        "can0  141   [8]  9A 00 00 00 00 00 00 00",
        " (1.5)  can0  RX - -  141   [8]  9A 00 00 00 00 00 00 00   '........'",
        "141 9A 00 00 00 00 00 00 00",
        "0x141#9A00000000000000",
        "141: 0x9A, 0x00, 0, 0".replace(" 0, 0", " " + ", ".join(["00"] * 6)),
        "<0x141> [8] 9a 00 00 00 00 00 00 00",
        "1.5 1  141  Rx   d 8 9A 00 00 00 00 00 00 00",
        "  7)      1059.9  Rx     0141  8  9A 00 00 00 00 00 00 00",
        f"Timestamp: 1700000000.000000 {' ' * 300} ID: 0141    S Rx    DL:  8    9a 00 00 00 00 00 00 00     Channel: can0",
        "t14189A00000000000000",
    ],
)
def test_a_line_that_is_pasted_is_explained(text: str) -> None:
    output = run(text, "--spec", str(V2_35)).stdout
    assert output.startswith("141#9A00000000000000\n") and "request of read_status_1 to node 1" in output


def test_requests_without_all_bytes_are_named() -> None:
    text = decode("".join(f"({n}.0) can0 141#9A\n" for n in range(4)), status=1).stdout
    assert "4 frames with foreign ids: 0x141 (4)\n  0x141 has 1 data byte, not 8, as in 141#9A" in text
    assert "not 8" not in decode("(1.0) can0 7FF#9A\n", *SETTINGS, status=1).stdout


def test_a_log_of_error_frames_alone_names_their_causes() -> None:
    text = decode("(1.0) can0 20000004#0001000000000000\n" * 2, status=2).output
    assert "bus.log has 2 error frames and no frames; check that the bit rate is that of the nodes" in text


def test_replies_to_a_broadcast_are_counted_with_it() -> None:
    exchange = (
        "(1.0) can0 280#64009CFFC8000000\n(1.0003) can0 142#A12A9CFFF0FF0050\n(1.0006) can0 143#A12AC80020000060\n"
    )
    text = decode(exchange, "--set", "edition=v2.35").stdout
    assert "can0, no node, v2.35: 1 request, 2 replies of the nodes that it addresses\n" in text
    assert "can0, node 2, v2.35: 0 requests, 1 reply after 0.300 ms" in text


# 5000 of at most 2048; 32768 of the 16384 numbers of an encoder of 14 bits
OUTSIDE = """\
(1.000000) can0 141#A10000009B000000
(1.000200) can0 141#A1328813F4010080
(1.010000) can0 141#A10000009B000000
(1.010200) can0 141#A1329B00F4010080
"""


def test_values_outside_their_range_are_counted() -> None:
    text = decode("(1.1) can0 142#9A00000000000000\n(1.1002) can0 142#9A32003200000000\n", *SETTINGS, status=1).stdout
    assert "  1 implausible: `voltage` is outside 6..100 V, as 5.0 V in 142#9A32003200000000" in text
    settings = ("--set", "edition=v2.35", "--set", "series=MG")
    text = decode(OUTSIDE, *settings, "--set", "encoder_bits=14", status=1).stdout
    assert "1 implausible: `iq` is outside raw -2048..2048, as 80.56640625 A in 141#A1328813F4010080" in text
    assert "2 implausible: `encoder` is outside raw 0..16383, as 720.0 ° in 141#A1328813F4010080" in text
    text = decode(OUTSIDE, *settings, "--set", "encoder_bits=18", status=1).stdout
    assert "`iq` is outside" in text and "`encoder`" not in text


SHUTTER = """\
canwright: 1
family: shutter
edition: v1
bus: {dlc: 2}
addresses:
  shutter: {request: 0x100 + node, reply: 0x180 + node, nodes: 1..2}
  every: {request: 0x100, reply: 0x180 + node, nodes: 1..2}
selector: {at: 0, raw: u8}
effects:
  turns: {level: danger, consent: motion, title: The shutter turns}
  forgets: {level: warning, title: The position is lost}
states:
  awake: {entered_by: [wake], title: Awake}
  asleep: {entered_by: [sleep, all_sleep], prevents: [turns], title: Asleep}
types:
  way: {raw: u8, enum: {stay: {value: 0, without_effects: [turns]}, up: 1}}
commands:
  wake: {code: 1, reply: echo}
  sleep: {code: 2, reply: echo, effects: [forgets]}
  all_sleep: {code: 4, address: every, reply: {from_each: 1..2}, effects: [forgets]}
  go: {code: 3, request: {way: {at: 1, type: way}}, reply: echo, effects: [turns]}
"""
ASLEEP = """\
(1.0) can0 101#0301
(1.1) can0 101#0200
(1.2) can0 101#0301
(1.3) can0 101#0300
(1.4) can0 101#0200
(1.5) can0 101#0301
(1.6) can0 102#0301
(1.7) can0 101#0100
(1.8) can0 101#0301
(1.9) can0 100#0400
(2.0) can0 102#0301
(2.1) can0 182#0301
"""


def test_effects_that_are_warnings_or_do_not_occur_are_stated() -> None:
    """The second `sleep` changes nothing of the state; staying has no effect; the other shutter sleeps after the broadcast."""
    Path("shutter.yaml").write_text(SHUTTER, "utf-8")
    text = decode(ASLEEP, "--spec", "shutter.yaml").stdout
    stated = [line for line in text.splitlines() if ", first in " in line]
    assert stated == [
        "  2 sleep, first in #1: The position is lost",
        "  1 all_sleep, first in #9: The position is lost",
        "  2 go, first in #2, in the state Asleep since sleep in #1, without the effect: The shutter turns",
        "  1 all_sleep, first in #9: The position is lost",
        "  1 go, first in #10, in the state Asleep since all_sleep in #9, without the effect: The shutter turns",
    ]


GAUGE = """\
canwright: 1
family: tank
edition: v1
addresses: {tank: {id: 0x100 + node, nodes: 1..2}}
types:
  level: {raw: u8, unit: "%", scale: 0.4, raw_range: 0..250, no_value: {error: 254}}
  heat: {raw: f32, unit: K, range: 0..500}
commands:
  state: {request: none, reply: {level: {at: 0, type: level}, heat: {at: 1, type: heat}}}
"""


def test_names_for_no_value_are_within_the_range_and_floats_have_one() -> None:
    Path("tank.yaml").write_text(GAUGE, "utf-8")
    spec = ("--spec", "tank.yaml")
    decode("(1.0) can0 101#FE00004040000000\n(1.1) can0 101#FA00004040000000\n", *spec)
    text = decode("(1.0) can0 101#FB00401C46000000\n(1.1) can0 101#FF0000C07F000000\n", *spec, status=1).stdout
    assert "2 implausible: `level` is outside raw 0..250, as 100.4 % in 101#FB00401C46000000" in text
    assert "2 implausible: `heat` is outside 0..500 K, as 10000.0 K in 101#FB00401C46000000" in text


NAMED = """\
canwright: 1
family: tank
edition: v1
addresses: {tank: {id: 0x100 + node, nodes: 1..2}}
types:
  level:
    {raw: i8, unit: "%", scale: 0.5, raw_range: -100..126, names: {brim: 126, empty: {value: -100}}, no_value: {error: 127}}
  depth: {raw: u8, scale: none, names: {ground: 1}}
commands:
  state: {request: none, reply: {level: {at: 0, type: level, array: 1..2}, depth: {at: 2, type: depth}}}
"""


def test_named_numbers_are_numbers_with_a_name() -> None:
    Path("tank.yaml").write_text(NAMED, "utf-8")
    spec = ("--spec", "tank.yaml")
    text = decode("(1.0) can0 101#7E9C010000000000\n(1.1) can0 101#7F7D020000000000\n", *spec).stdout
    assert "level[1] 63 % (brim), level[2] -50 % (empty), depth raw 1 (ground)" in text
    assert "level[1] error, level[2] 62.5 %, depth raw 2" in text
    lines = list(
        csv.DictReader(io.StringIO(decode("(1.0) can0 101#7E9C010000000000\n", *spec, "--format", "csv").stdout))
    )
    assert [line["value"] for line in lines] == ["63", "-50", ""]
    shown = CliRunner().invoke(main, ["show", "state", *spec]).output
    assert "126 brim" in shown and "-100 empty" in shown
    explained = CliRunner().invoke(main, ["decode", "101#7E9C010000000000", *spec]).output
    assert "63 % (brim)" in explained


def test_a_node_that_does_not_reply_has_the_edition_of_others_of_its_bus() -> None:
    silent = "".join(f"({second}.000000) {bus} 145#9A00000000000000\n" for second in (1, 2) for bus in ("can0", "can1"))
    text = decode(MIXED + silent, status=1).stdout
    assert "can0, node 5, v2.35 (assumed, as of other nodes of the bus, since most requests have no reply)" in text
    assert "  2 missing: 2 requests without an answer" in text


def test_no_edition_is_assumed_that_explains_the_frames_worse_than_another_one() -> None:
    """777 of 0.1 V is 0x0309, but DATA[2] and DATA[5] of that reply would be 0."""
    asked, answered = "145#9A00000000000000", "145#9A32600903010000"
    log = "".join(f"({2 + i / 100}) can0 {data}\n" for i, data in enumerate((asked, answered, asked, asked)))
    text = decode(MIXED + log, *BOTH_V2_35, status=1).stdout
    assert "can0, node 5; can1, node 3: no edition fits, so these frames count as foreign" in text


def test_marks_are_ignored_if_the_recorder_is_unknown() -> None:
    """Of a log in which the replies are marked as sent."""
    cycle = "(1.{0:02}0000) can0 141#9A00000000000000 R\n(1.{0:02}0300) can0 141#9A3200E701000000 T\n"
    text = "".join(cycle.format(number) for number in range(20))
    spec = ("--spec", str(V2_35))
    for options, by, status in (((), {"mark"}, 1), (("--recorder", "unknown"), {"pairing", "content"}, 0)):
        rows = json_rows(decode(text, *spec, *options, "--format", "jsonl", status=status).stdout)
        assert {row["decided_by"] for row in rows} == by
        assert ([row["direction"] for row in rows] == ["request", "reply"] * 20) is (status == 0)
        result = CliRunner().invoke(main, ["identify", "bus.log", *spec, *options])
        assert ("explains every frame" in result.output) is (status == 0), result.output


def test_csv_has_one_line_for_each_value() -> None:
    lines = list(csv.DictReader(io.StringIO(decode(MIXED, *SETTINGS, "--format", "csv").stdout)))
    reply = [line for line in lines if line["number"] == "2"]
    assert [(line["field"], line["raw"], line["value"], line["unit"]) for line in reply] == [
        ("temperature", "50", "50", "°C"),
        ("speed", "500", "500", "°/s"),
        ("encoder", "32768", "", "°"),
    ]
    assert {(line["time"], line["frame"], line["request"], line["latency_ms"]) for line in reply} == {
        ("1.000200000", "141#A1329B00F4010080", "0", "0.200000")
    }
    assert [line["field"] for line in lines if line["number"] == "1"] == [""]


def test_a_table_with_a_summary() -> None:
    text = decode(MIXED, *SETTINGS, "--set", "series=MG", "--set", "1:encoder_bits=18").stdout
    header, first, *_ = text.splitlines()
    assert header.split() == ["number", "time", "bus", "node", "edition", "direction", "by", "command", "fields"]
    assert first.endswith("set_torque     iq 2.49755859375 A")
    assert "encoder 180.0 °; answers #0 after 0.200 ms" in text
    assert "values depend on `encoder_bits`" not in text
    without = decode(MIXED, *SETTINGS).stdout
    assert "values depend on `encoder_bits` (can0, node 1): --set encoder_bits=14|15|18" in without


def test_everything_that_is_not_decoded_is_reported() -> None:
    log = (
        MIXED
        + "garbage\n(1.0) can0 141#81:00:12345678#11\n(1.003) can0 141#EE00000000000000\n(1.004) can0 141#R\n(1.0) can0 14"
    )
    text = decode(log, *SETTINGS, status=1).stdout
    assert "rejected: no request on 0x141 has DATA[0] 0xEE (141#EE00000000000000)" in text
    assert "  1 rejected, unknown_code: no request on 0x141 has DATA[0] 0xEE, as in 141#EE00000000000000" in text
    assert "2 frames with foreign ids: 0x7FF (1), 0x141 remote (1)" in text
    assert "1 remote frame among all frames" in text
    assert "skipped, malformed: 1 (line 8: `garbage`)" in text
    assert "skipped, CAN XL frames: 1 (line 9: `(1.0) can0 141#81:00:12345678#11`)" in text
    assert "skipped, truncated end: 1 (line 12: `(1.0) can0 14`)" in text


# The spec states 0.25 ms. The second request is never answered; the last reply comes without a request.
TROUBLE = """\
(1.000000) can0 141#9A00000000000000 T
(1.000600) can0 141#9A3200E701000000 R
(1.100000) can0 141#9A00000000000000 T
(1.200000) can0 141#9A3200E701000000 R
"""


def test_missing_late_and_unexpected_frames() -> None:
    text = decode(TROUBLE, "--set", "edition=v2.35").stdout
    assert "node 1, v2.35: 2 requests, 2 replies after 0.600 ms on average, at most 0.600 ms\n" in text
    for line in (
        "1 missing: 1 request without an answer",
        "1 late: slower than the reply time of the spec, or if the bus is slower, than most replies",
        "1 unexpected: without a request",
    ):
        assert f"  {line}\n" in text
    waited = decode(TROUBLE, "--set", "edition=v2.35", "--window", "200").stdout
    assert "  2 late" in waited and "missing" not in waited and "unexpected" not in waited
    swapped = decode(TROUBLE, "--set", "edition=v2.35", "--recorder", "node", status=1).stdout
    assert "2 requests, 2 replies" in swapped


def test_a_command_of_several_editions_has_doubtful_directions_once() -> None:
    summary = Summary()
    summary.nodes["can0", 1] = NodeSummary()
    requests = [specification(file).edition.command("motor_on").request for file in (V2_35, V2_36)]
    old_bits = tuple(OldBits(request, 5) for request in requests if request)
    assert [*doubts(summary, {"can0": Behaviour(old_bits=old_bits)})] == [
        "can0: the host sends old bytes in reserved bits of motor_on: they are the same in all requests"
    ]


def test_a_broadcast_misses_only_nodes_of_the_log() -> None:
    asked = "(1.0{0}0000) can0 280#0000000000000000\n(1.0{0}0100) can0 141#A10000000000000{1}\n"
    log = asked.format(1, 1) + "(1.010200) can0 142#A100000000000001\n" + asked.format(2, 1)
    text = decode(log, "--set", "edition=v2.35").stdout
    lines = text.splitlines()
    first, second = (next(i for i, line in enumerate(lines) if f"node {node}, v2.35: " in line) for node in (1, 2))
    assert text.count("missing") == 1 and lines[second + 1].startswith("  1 missing")
    assert "0 requests, 2 replies" in lines[first] and "0 requests, 1 reply" in lines[second]


def test_requests_that_wait_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("canwright.recordings.summary._MAX_WAITING", 10)
    edition, summary = specification(V2_35).edition, Summary()
    frames = [LogFrame(i * 10**9, "", CanFrame(0x141, bytes([0x9A, *[0] * 7])), None) for i in range(50)]
    for row in rows(edition, frames, {}):
        summary.add(row)
    assert summary.nodes["", 1].missing == 40
    summary.finish()
    assert summary.nodes["", 1].missing == 50


def same(parameters: dict[str, str], bus: str, node: int | None) -> dict[str, str]:
    return parameters


def rows(edition: Edition, recorded: Sequence[LogFrame], parameters: dict[str, str]) -> list[Row]:
    judged = Directions({}, edition).classify(recorded)
    return list(RowReader(functools.partial(same, parameters)).rows(judged))


def golden_of(file: Path) -> tuple[Edition, Sequence[GoldenFrame]]:
    item = specification(file)
    assert item.frames
    return item.edition, item.frames.frames


@pytest.mark.parametrize("file", WITHOUT_SETTINGS_IN_IDS, ids=called)
def test_golden_frames_as_a_log(file: Path) -> None:
    edition, golden = golden_of(file)
    decoder = Decoder(edition)
    marks = {Direction.REQUEST: Mark.SENT, Direction.REPLY: Mark.RECEIVED}
    recorded = [
        LogFrame(i * 10**12, "", CanFrame(entry.id, entry.data, entry.extended, entry.remote), marks[entry.direction])
        for i, entry in enumerate(golden)
    ]
    judged = Directions({}, edition, behaviours={"": Behaviour(is_marked=True)}).classify(recorded)
    for entry, each in zip(golden, judged, strict=True):
        frame, parameters = each.recorded.frame, {name: str(value) for name, value in entry.parameters.items()}
        (row,) = RowReader(functools.partial(same, parameters)).rows([each])
        assert row.judged.direction is entry.direction
        identified = decoder.identify(entry.direction, frame)  # without its request, also for replies of other commands
        assert isinstance(identified, Identified) and row.judged.message is identified.message
        holding = identified.message.node_in_data
        in_data = entry.raw[holding.name] if holding and holding.name in entry.raw else None
        assert row.judged.node == (in_data if identified.message.id.nodes is None else entry.node)
        assert by_field(row, raw=True) == entry.raw
        values = by_field(row, raw=False)
        for name, value in numbers_of(entry, identified.message).items():
            assert is_value(values[name], value), (entry, name)


def numbers_of(entry: GoldenFrame, message: Message) -> dict[str, object]:
    """The values of a golden frame, with the number where it has the name of one."""
    types = {field.name: field.type for field in message.layout.fields}
    known = assignment(entry.parameters)
    return {name: as_number(types[name], value, entry.raw[name], known) for name, value in entry.values.items()}


def by_field(row: Row, *, raw: bool) -> dict[str, object]:
    contents: dict[str, object] = {}
    for cell in row.cells:
        content = cell.raw if raw else cell.value
        joined = cell.column.field.type.joined
        if joined is not None:
            contents[cell.column.name] = elements_of(joined, cell.raw) if raw else content
        elif cell.column.field.is_array:
            elements = contents.setdefault(cell.column.field.name, [])
            assert isinstance(elements, list)
            elements.append(content)
        else:
            contents[cell.column.name] = content
    return contents


def is_value(decoded: object, value: object) -> bool:
    """Whether a value is that of a golden frame, or the nearest float."""
    if isinstance(value, list):
        return isinstance(decoded, list) and all(map(is_value, decoded, value)) and len(decoded) == len(value)
    if isinstance(value, Fraction):
        return decoded in (value, float(value))
    return decoded == (None if value == "none" else value)


@pytest.mark.parametrize("file", SPECS, ids=called)
def test_golden_frames_are_printed_as_they_are_written(file: Path, tmp_path: Path) -> None:
    edition, every = golden_of(file)
    golden = every[:: 1 + len(every) // 60]
    printed = []
    for entry in golden:
        frame = CanFrame(entry.id, entry.data, entry.extended, entry.remote)
        message = edition.command(entry.command).message(entry.direction)
        parameters = {name: str(value) for name, value in entry.parameters.items()}
        assert message
        text = golden_text(edition, message, frame, parameters)
        assert text, entry
        printed.append(text)
    head = f"canwright: 1\nfamily: {edition.family}\nedition: {edition.name}\nsources: {{}}\nframes:\n"
    (tmp_path / "x.frames.yaml").write_text(head + "".join(printed), "utf-8")
    printed_frames = read_golden_file(tmp_path / "x.frames.yaml", edition).golden.frames
    for again, original in zip(printed_frames, golden, strict=True):
        for key in ("id", "extended", "remote", "data", "node", "raw", "direction"):
            assert getattr(again, key) == getattr(original, key), original
        messages = [edition.command(frame.command).message(frame.direction) for frame in (again, original)]
        assert messages[0] is messages[1]
        assert messages[1]
        for name, value in numbers_of(original, messages[1]).items():
            assert again.values.get(name) == value or len(str(value)) > 120, original
        assert again.decode_only >= original.decode_only
    assert all(len(line) <= 120 or 'data: "' in line for text in printed for line in text.splitlines())


def test_a_single_frame_in_every_edition_and_direction() -> None:
    text = run("141#A1329B00F4010080").stdout
    assert text.startswith("141#A1329B00F4010080\n\nreply of set_torque from node 1\n  in mwd_motor v2.35\n")
    assert "    speed        DATA[4..5]  500    500 °/s\n" in text
    assert (
        "iq           DATA[2..3]  155    raw 155 (MH), 1.248779296875 A (MF), 2.49755859375 A (MG) (only series" in text
    )
    assert "request of set_torque to node 1; unusual" in text
    assert "no reply: no reply has the id 0x141\n  in mwd_motor v2.36-2025-03\n" in text
    chosen = run("141#A1329B00F4010080", "--set", "series=MF", "--set", "edition=v2.35").stdout
    assert "155    1.248779296875 A\n" in chosen and "v2.36" not in chosen
    assert "no request" in run("141#EE", status=1).stdout


@pytest.mark.parametrize(
    ("frame", "settings", "text", "status"),
    [
        ("141#9C0000000000FFFF", ["encoder_bits=14"], "`encoder` is 65535, outside the raw range 0..16383", 1),
        ("141#9C0000000000FFFF", ["encoder_bits=18"], "reply of read_status_2 from node 1\n", 0),
        ("141#9C0000000000FFFF", [], "reply of read_status_2 from node 1\n", 0),
        ("141#9C00FF0F00000000", ["series=MG"], "`iq` is 4095, outside the raw range -2048..2048", 1),
        ("141#9A32000000000000", [], "`voltage` is outside the plausible range 6..100 V", 1),
        (
            "141#A1000100000000FF",
            [],
            "request of set_torque to node 1; unusual: DATA[2], DATA[7] have reserved bits",
            0,
        ),
        ("141#A100000000100000", [], "request of set_torque to node 1; unusual: `iq` is 4096", 0),
    ],
)
def test_what_is_unusual_in_a_frame(frame: str, settings: list[str], text: str, status: int) -> None:
    chosen = [part for setting in (*settings, "edition=v2.35") for part in ("--set", setting)]
    assert text in run(frame, *chosen, status=status).stdout


def test_a_float_is_shown_with_its_own_digits_and_exported_exactly() -> None:
    Path("lamp.yaml").write_text(f"{MINIMAL}  heat: {{code: 0x24, reply: {{heat: {{at: 4, raw: f32}}}}}}\n", "utf-8")
    log = "(1.0) can0 101#24000000CDCCCC3D\n"
    assert " 0.1\n" in run("101#24000000CDCCCC3D", "--spec", "lamp.yaml").stdout
    assert "  heat 0.1\n" in decode(log, "--spec", "lamp.yaml").stdout
    exported = decode(log, "--spec", "lamp.yaml", "--format", "jsonl").stdout
    assert json_rows(exported)[0]["fields"] == {"heat": {"raw": 0x3DCCCCCD, "value": 0.10000000149011612}}


def test_a_single_frame_as_a_golden_frame() -> None:
    text = run("141#A1329B00F4010080", "--golden", "--set", "series=MG", "--set", "encoder_bits=18").stdout
    assert text.startswith(
        '  # mwd_motor v2.35\n  - {reply: set_torque, node: 1, id: 0x141, data: "A1 32 9B 00 F4 01 00 80", '
        "parameters: {series: MG, encoder_bits: 18},\n     raw: {temperature: 50, iq: 155, speed: 500, encoder: 32768},\n"
        "     values: {temperature: 50, iq: 2.49755859375, speed: 500, encoder: 180}}\n"
    )
    assert "see --set" in run("181#A1329B00F4010080", "--golden", status=1).stderr


@pytest.mark.interop("pyarrow")
def test_parquet_has_one_table_for_each_layout() -> None:
    import pyarrow.parquet as pq

    log = MIXED + "(1.100000) can0 141#9C00000000000000\n(1.100100) can0 141#9C329B00F4010080\n"
    decode(log, *SETTINGS, "--set", "series=MG", "--format", "parquet", "--out", "tables")
    assert sorted(path.as_posix() for path in Path("tables").rglob("*.parquet")) == [
        "tables/v2.35/motion_feedback.parquet",
        "tables/v2.35/read_status_1_request.parquet",
        "tables/v2.35/read_status_2_request.parquet",
        "tables/v2.35/set_torque_request.parquet",
        "tables/v2.35/status_1.parquet",
        "tables/v2.36-2025-03/read_status_1_request.parquet",
        "tables/v2.36-2025-03/status_1.parquet",
    ]
    table = pq.read_table("tables/v2.35/motion_feedback.parquet")
    assert table.schema.field("iq").metadata == {b"unit": b"A"}
    assert table.schema.field("time").metadata == {b"unit": b"ns"}
    assert table.schema.metadata[b"edition"] == b"v2.35"
    again = decode(log, "--format", "parquet", "--out", "tables", status=2)
    assert "tables" in again.stderr and "choose a new folder" in again.stderr


@pytest.mark.parametrize("suffix", [".log", ".asc", ".blf"])
def test_requests_and_replies_in_separate_channels(suffix: str) -> None:
    name = f"split{suffix}"
    text = decode(MIXED, *SETTINGS, "--split", name).output
    assert f"{name}: requests of can1 on channel 4, replies on 5, others on 6" in text
    assert "#0" not in text
    with can.LogReader(name) as reader:
        messages = [(m.channel, m.arbitration_id, bytes(m.data).hex().upper(), m.is_rx) for m in reader]
    first = "can{}" if suffix == ".log" else ""
    channels = [first.format(n) if first else n - 1 for n in (1, 4, 2, 5, 1, 2, 3)]
    assert [channel for channel, *_ in messages] == channels
    assert [is_rx for *_, is_rx in messages] == [False, False, True, True, False, True, True]
    frames = [line.split()[2].split("#") for line in MIXED.splitlines()]
    assert [[f"{id_:03X}", data] for _, id_, data, _ in messages] == frames
    before = Path(name).read_bytes()
    decode(MIXED, *SETTINGS, "--split", name)
    assert Path(name).read_bytes() == before


@pytest.mark.interop("asammdf")
def test_both_dbc_files_read_the_channels_of_a_split_log() -> None:
    """Without marks, cantools and asammdf find the values of `canwright decode`, and no others."""
    from asammdf import MDF

    traffic = Traffic(specification(V2_35).edition, "mixed", 4, loss=Loss(0.1, has_retries=True), nodes=1)
    settings = ("--spec", str(V2_35), "--set", "series=MG")
    rows: list[Any] = list(json_rows(decode(recorded(traffic.frames(100)), *settings, "--format", "jsonl").stdout))
    run("bus.log", *settings, "--split", "split.blf")
    files = [ROOT / f"generated/dbc/mwd_motor-v2.35-MG-{part}.dbc" for part in ("command", "reply")]
    databases: Any = [cantools.database.load_file(file) for file in files]

    channels: dict[str, list[float]] = {}
    with can.LogReader("split.blf") as reader, can.Logger("split.mf4") as writer:
        for row, message in zip(rows, reader, strict=True):
            assert message.channel == ["request", "reply"].index(row["direction"])
            decoded = databases[message.channel].decode_message(
                message.arbitration_id, message.data, decode_choices=False
            )
            values = {name.partition("_")[2]: value for name, value in decoded.items()}
            for name, field in row["fields"].items():
                if not isinstance(field["value"], list):  # flags are several signals
                    wanted = field["value"] if isinstance(field["value"], int | float) else field["raw"]
                    assert values[name.replace("[", "_").strip("]")] == pytest.approx(wanted), (row, name)
            for name, value in decoded.items():
                channels.setdefault(name, []).append(float(value))
            message.channel += 1  # asammdf takes channel 0 for any
            writer.on_message_received(message)
    with MDF("split.mf4") as mdf:
        extracted = mdf.extract_bus_logging({"CAN": [(files[0], 1), (files[1], 2)]})
    for name, values_ in channels.items():
        samples = []
        for group, index in extracted.channels_db[name]:
            raw = extracted.get(group=group, index=index, raw=True)
            physical = raw.physical()
            samples += [float(sample) for sample in (raw if physical.samples.dtype.kind in "SU" else physical).samples]
        assert sorted(samples) == pytest.approx(sorted(values_)), name
    assert len(channels) > 50


@pytest.mark.interop("matplotlib")
def test_a_picture_of_fields() -> None:
    for name in ("a.png", "a.svg"):
        decode(MIXED, *SETTINGS, "--set", "series=MG", "--plot", name, "--field", "iq", "--field", "voltage")
        before = Path(name).read_bytes()
        decode(MIXED, *SETTINGS, "--set", "series=MG", "--plot", name, "--field", "iq", "--field", "voltage")
        assert Path(name).read_bytes() == before
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    text = decode(MIXED, *SETTINGS, "--plot", "b.png", "--field", "kp").output
    assert "b.png: no frame has a field kp" in text


def test_a_curve_has_the_extremes_of_any_number_of_points() -> None:
    curve = plot.Curve()
    for i in range(100_000):
        curve.add(i, {40_001: 99.0, 70_003: -99.0}.get(i, i % 7))
    times, values = curve.points()
    assert len(times) < 10_000
    assert times == sorted(times)
    assert (values[times.index(40_001)], values[times.index(70_003)]) == (99.0, -99.0)
    few = plot.Curve()
    for i in range(5):
        few.add(i, 2 * i)
    assert few.points() == ([0, 1, 2, 3, 4], [0, 2, 4, 6, 8])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bus.log", "--set", "series=MX"], "use one of: edition=v2.35|v2.36-2025-03; encoder_bits="),
        (["bus.log", "--set", "x:series=MG"], "`x` is not a node; write NODE:NAME=VALUE, for example 3:series=MG"),
        (["bus.log", "--set", "1:series=MG", "--set", "1:series=MF"], "`1:series` is already set to another value"),
        (["bus.log", "--plot", "a.png"], "--plot and --field need each other"),
        (["bus.log", "--plot", "a.txt", "--field", "iq"], "a.txt must end in .pdf, .png, .svg"),
        (["bus.log", "--plot", "a.png", "--field", "iqq"], "there is no field `iqq`; did you mean `iq`?"),
        (["bus.log", "--format", "parquet"], "--format parquet needs a folder: --out tables"),
        (["bus.log", "--format", "mcap"], "--format mcap needs a file: --out log.mcap"),
        (["bus.log", "--golden"], "--golden is for a single frame"),
        (["bus.log", "--split", "missing/a.log"], "missing"),
        (["141#A1", "--format", "csv"], "are for logs"),
        (["141#A1000"], "is neither a file nor a frame such as 141#A100FF (malformed)"),
        *(([text], "does not exist") for text in ("missing.log", "141 9G", "141", "9" * 300)),
        (["-", "--follow"], "--follow needs a file"),
        (["141#A1", "--follow"], "--follow is for a file"),
        (["bus.log", "--from-split"], "`can0` is no channel of a file that --split writes; omit --from-split"),
        (["192497F#80"], "an id has 3 digits, or 8 if it has 29 bits; write 0192497F#80"),
        (["41#A1"], "an id has 3 digits, or 8 if it has 29 bits; write 041#A1"),
    ],
)
def test_wrong_arguments(arguments: list[str], message: str) -> None:
    Path("bus.log").write_text(MIXED, "utf-8")
    result = run(*arguments, status=2)
    assert message in " ".join(result.stderr.split())
    assert not list(Path().glob("*.p*")) and not list(Path().glob(".*part"))


@pytest.mark.parametrize(
    "spelling", ["bus.log", "./bus.log", "folder/../bus.log", "symbolic.log", "hard.log", "absolute"]
)
@pytest.mark.parametrize("option", ["--out", "--split", "--plot"])
def test_an_output_never_replaces_the_log(option: str, spelling: str) -> None:
    suffix = {"--plot": ".svg"}.get(option, ".log")
    log = Path(f"bus{suffix}")
    log.write_text(MIXED, "utf-8")
    Path("folder").mkdir()
    Path(f"symbolic{suffix}").symlink_to(log.name)
    os.link(log, f"hard{suffix}")
    written = str(log.absolute()) if spelling == "absolute" else spelling.replace(".log", suffix)
    fields = ["--field", "iq"] if option == "--plot" else []
    for name in (log.name, f"symbolic{suffix}"):
        result = run(name, *SETTINGS, "--format", "csv", option, written, *fields, status=2)
        assert "is the log that is read; choose another file" in result.stderr
    assert log.read_text("utf-8") == MIXED


def test_an_output_never_replaces_the_standard_input() -> None:
    Path("bus.log").write_text(MIXED, "utf-8")
    command = [sys.executable, "-m", "canwright", "decode", "-", *SETTINGS, "--out", "bus.log"]
    with Path("bus.log").open("rb") as log:
        result = subprocess.run(command, stdin=log, capture_output=True, check=False)
    assert (result.returncode, Path("bus.log").read_text("utf-8")) == (2, MIXED)


@pytest.mark.interop("pyarrow")
def test_a_log_with_the_name_of_a_temporary_file() -> None:
    for name in (".rows.part", ".tables.part/bus.log"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text(MIXED, "utf-8")
        run(name, *SETTINGS, "--out", "rows")
        run(name, *SETTINGS, "--format", "parquet", "--out", f"tables{len(name)}")
        run(name, *SETTINGS, "--format", "parquet", "--out", "tables")
        shutil.rmtree("tables")
        assert Path(name).read_text("utf-8") == MIXED


def test_two_outputs_of_one_name() -> None:
    result = decode(MIXED, *SETTINGS, "--format", "csv", "--out", "x.log", "--split", "./x.log", status=2)
    assert "x.log is the file of two outputs" in result.stderr
    assert not Path("x.log").exists()


@pytest.mark.parametrize(
    ("package", "options"),
    [
        ("numpy", ["--format", "parquet"]),
        ("pyarrow", ["--format", "parquet"]),
        ("mcap", ["--format", "mcap"]),
        ("matplotlib", ["--plot"]),
    ],
)
def test_a_missing_package(package: str, options: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == package else object())
    arguments = [*options, "a.png", "--field", "iq"] if package == "matplotlib" else [*options, "--out", "tables"]
    result = decode(MIXED, *SETTINGS, *arguments, status=2)
    assert result.stderr.endswith(f"needs {package}; run: pip install {package}\n")
    assert not Path("tables").exists() and not Path("a.png").exists()


def test_the_name_of_a_bus_is_escaped() -> None:
    log = "(1.0) ##[error]\u202e 141#A10000009B000000\n"
    for form in ("text", "csv", "jsonl"):
        text = decode(log, "--set", "edition=v2.35", "--format", form).stdout
        assert "#[U+0023][error][U+202E]" in text
        assert "\u202e" not in text and "##[" not in text


@contextlib.contextmanager
def decoding(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], IO[str], IO[str]]]:
    """A process that decodes what is written to it, ended after a minute, with its input and its output."""
    command, pipe = [sys.executable, "-m", "canwright", "decode", *arguments], subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, encoding="utf-8") as process:
        assert process.stdin is not None and process.stdout is not None
        too_late = threading.Timer(60, process.kill)
        too_late.start()
        yield process, process.stdin, process.stdout
        process.stdin.close()
        too_late.cancel()


def send(stream: IO[str], text: str) -> None:
    stream.write(text)
    stream.flush()


@pytest.mark.parametrize("form", ["text", "csv", "jsonl"])
def test_a_row_of_a_stream_is_printed_before_the_next_frame_arrives(form: str) -> None:
    data = ("A10000009B000000", "A1329B00F4010080")
    with decoding("-", "--spec", str(V2_35), "--format", form) as (_, frames, printed):
        delays = []
        for number in range(8):
            start = time.monotonic()
            send(frames, f"(1.{number:06}) can0 141#{data[number % 2]}\n")
            header = [] if form == "jsonl" or number else [printed.readline()]
            row = next((line for line in printed if f"1.{number:06}" in line), "")
            assert not header or "direction" in header[0]
            assert "set_torque" in row
            delays.append(time.monotonic() - start)
        assert min(delays) < 0.2  # not of all: the first waits for the process to start, and any for a busy computer
        frames.close()
        assert "can0" in printed.read() or form != "text"


def test_a_frame_that_waits_for_later_ones_is_printed_after_a_pause() -> None:
    """The second frame can be the echo of the first, or repeat it: the next one shows which, or that none comes."""
    arguments = ("-", "--spec", str(V2_35), "--window", "50", "--format", "jsonl")
    with decoding(*arguments) as (_, frames, printed):
        send(frames, "(1.00) can0 141#8000000000000000\n(1.03) can0 141#8000000000000000\n")
        assert [json.loads(printed.readline())["direction"] for _ in range(2)] == ["request", "reply"]


@pytest.mark.parametrize("followed", [False, True])
def test_an_interrupt_ends_a_log_with_its_summary(followed: bool, tmp_path: Path) -> None:
    file = tmp_path / "growing.log"
    file.touch()
    source = ["--follow", str(file)] if followed else ["-"]
    arguments = (*source, "--spec", str(V2_35), "--format", "jsonl")
    with decoding(*arguments) as (process, frames, printed), file.open("a") as growing:
        for data in ("A10000009B000000", "A1329B00F4010080"):
            send(growing if followed else frames, f"(1.0) can0 141#{data}\n")
            assert "set_torque" in printed.readline()
        process.send_signal(signal.SIGINT)
        assert process.stderr and "can0, node 1, v2.35: 1 request, 1 reply" in process.stderr.read()
        assert process.wait() == 130


def test_rows_of_a_slow_stream_do_not_wait_for_the_editions() -> None:
    """A node that is there from the start, and one that appears later; several editions fit both."""
    with decoding("-", *BOTH_V2_35, "--format", "jsonl") as (_, frames, printed):
        for id_ in ("141", "142"):
            is_read = threading.Event()
            sending = threading.Thread(target=_send_slowly, args=(frames, id_, is_read))
            sending.start()
            row = next((line for line in printed if f'"frame": "{id_}' in line), "")
            is_read.set()
            sending.join()
            assert "set_torque" in row and not frames.closed


def _send_slowly(stream: IO[str], id_: str, is_read: threading.Event) -> None:
    """Sends exchanges until a row is read, at most a fraction of the frames of the look-ahead."""
    for _ in range(400):
        send(stream, f"{id_}#A10000009B000000\n{id_}#A1329B00F4010080\n")
        if is_read.wait(0.1):
            return
    stream.close()


def test_a_table_widens_where_rows_need_it() -> None:
    buses = ["can0"] * 500 + ["can0", "vcan10"] * 50
    log = "".join(f"(1.{i:06}) {bus} 141#A10000009B000000\n" for i, bus in enumerate(buses))
    rows_ = decode(log, "--set", "edition=v2.35").stdout.splitlines()[1:601]
    places = [row.index("set_torque") for row in rows_]
    assert places == [places[0]] * 500 + [places[0] + 2] * 100
