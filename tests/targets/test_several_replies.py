"""Requests with several replies in the generated code: union types, joined frames, and the links of a dissector."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from canwright.conformance.adapter import write_files
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.targets.c.target import CTarget

from ..compilers import build
from ..node import run
from ..recordings.test_directions import frames
from ..spec_texts import ROOT
from . import test_javascript, test_python
from .dissector import judge

RACK, SPINDLE = (ROOT / f"tests/specs/{family}/v1.yaml" for family in ("rack", "spindle"))
LOG = """103#5700000000000000 183#57022D3030303137 183#5701524B32303236 183#57034100000000FF
         104#9000 184#9000C8B4FF850000 184#910007D0FA240000 204#9210040D48
         108#9500000000000000 188#7E01 103#5700000000000000 183#57022D3030303137"""
"""A serial number out of order, three frames of different commands on two ids, an alternative reply, an incomplete reply."""
LINKS = [None, 0, 0, 0, None, 4, 4, 4, None, 8, None, 10]
"""The request of each frame."""

PROGRAM = """
from typing import List
from typing_extensions import assert_type
from rack.v1 import (
    BusyReply, ExtremesReply, LimitsReply, LogReply, ReadSerialReply, ReadSerialRequest, ReadStateReply,
    ReadStateRequest, CodecError, decode_answer, decode_reply, join,
)

request = ReadStateRequest(node=4)
frames = [(0x184, "90 00 C8 B4 FF 85 00 00"), (0x184, "91 00 07 D0 FA 24 00 00"), (0x204, "92 10 04 0D 48"), (0x184, "7E 05")]
for can_id, data in frames:
    answer = decode_answer(request, can_id, bytes.fromhex(data))
    assert_type(answer, ReadStateReply | LimitsReply | ExtremesReply | BusyReply)
    if isinstance(answer, BusyReply):
        print("busy", answer.seconds)
    elif isinstance(answer, LimitsReply):
        print("limits", answer.highest, answer.lowest)
    else:
        print(type(answer).__name__)
for can_id, data in [(0x183, "57 01 00 00 00 00 00 00"), (0x203, "92 10 04 0D 48"), (0x185, "7E 05")]:
    try:
        decode_answer(request, can_id, bytes.fromhex(data))
    except CodecError as error:
        print(error.refusal.value)

asked = ReadSerialRequest(node=3)
parts = [
    decode_answer(asked, 0x183, bytes.fromhex(data))
    for data in ("57 02 2D 30 30 30 31 37", "57 01 52 4B 32 30 32 36", "57 03 41 00 00 00 00 FF")
]
assert_type(parts, List[ReadSerialReply])
serial = join(parts, lambda part: part.serial)
assert_type(serial, List[int])
print(bytes(serial))
print(bytes(join(parts[:2], lambda part: part.serial, last=2)))
for wrong in (parts[:2], [*parts, parts[0]], [parts[0]], []):
    try:
        join(wrong, lambda part: part.serial)
    except ValueError as error:
        print(error)
try:
    join(parts, lambda part: part.serial, last=2)
except ValueError as error:
    print(error)
line = decode_reply(0x281, bytes.fromhex("01 05 45 72 72 20 31 32"))
assert isinstance(line, LogReply)
try:
    join([line], lambda line: line.text)
except ValueError as error:
    print(error)
"""
PRINTED = r"""ReadStateReply
limits 200.0 -150.0
ExtremesReply
busy 5
not_answer
not_answer
not_answer
b'RK2026-00017A\x00\x00\x00\x00\xff'
b'RK2026-00017'
frame 3 is missing
frame 2 is given twice
frame 1 is missing
there are no frames
frame 3 is none of 1 to 2
frame 6 is missing
"""


def test_a_python_program(tmp_path: Path) -> None:
    folder = test_python.write(tmp_path, RACK)
    (folder / "use.py").write_text(PROGRAM, "utf-8")
    done = subprocess.run([sys.executable, "use.py"], cwd=folder, capture_output=True, text=True, check=True)
    assert done.stdout == PRINTED


@pytest.mark.interop("mypy")
def test_the_type_of_an_answer_is_the_union(tmp_path: Path) -> None:
    folder = test_python.write(tmp_path, RACK)
    (folder / "use.py").write_text(PROGRAM, "utf-8")
    mypy = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "use.py"]
    done = subprocess.run(mypy, cwd=folder, capture_output=True, text=True, check=False)
    assert not done.returncode, done.stdout


def test_an_echo_and_what_comes_instead(tmp_path: Path) -> None:
    """The data decides on an echo; other replies are accepted all the same."""
    folder = test_python.write(tmp_path, SPINDLE)
    (folder / "use.py").write_text(
        "from spindle.v1 import *\n"
        "request = TurnRequest(node=3, speed=1500)\n"
        "data = ('10 00 00 00 98 3A 00 00', '11 10 01 00 00 00 00 00', '10 00 00 00 99 3A 00 00')\n"
        "for can_id, text in (*((0x203, each) for each in data), (0x83, 'FA 00 10 23 00 00 00 00')):\n"
        "    try:\n"
        "        print(type(decode_answer(request, can_id, bytes.fromhex(text))).__name__)\n"
        "    except CodecError as error:\n"
        "        print(error.refusal.value)\n",
        "utf-8",
    )
    done = subprocess.run([sys.executable, "use.py"], cwd=folder, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["TurnReply", "RefusedReply", "not_answer", "FaultReply"]


def test_a_javascript_program(tmp_path: Path) -> None:
    folder = test_javascript.write(tmp_path, RACK)
    script = """
        import * as rack from "./rack/v1.js";
        const bytes = (text) => text.match(/../g).map((byte) => parseInt(byte, 16));
        const answer = (request, id, data) => rack.decodeAnswer(request, { id, data: bytes(data) });
        const state = rack.encodeRequest("read_state", { node: 4 });
        console.log([[0x184, "9000C8B4FF850000"], [0x184, "910007D0FA240000"], [0x204, "9210040D48"], [0x184, "7E05"]]
          .map(([id, data]) => answer(state, id, data).command).join(" "));
        const serial = rack.encodeRequest("read_serial", { node: 3 });
        const parts = ["57022D3030303137", "5701524B32303236", "57034100000000FF"].map((data) => answer(serial, 0x183, data));
        console.log(String.fromCharCode(...rack.join(parts, "serial").slice(0, 13)), rack.join(parts, "part").join(""));
        console.log(rack.join(parts.slice(0, 2), "serial", 2).length);
        for (const wrong of [parts.slice(1), [...parts, parts[0]], [], [answer(state, 0x184, "7E05")]]) {
          try { rack.join(wrong, "serial"); } catch (error) { console.log(error.name, error.message); }
        }
    """
    (folder / "use.mjs").write_text(script, "utf-8")
    assert run(folder / "use.mjs", cwd=folder).splitlines() == [
        "read_state limits extremes busy",
        "RK2026-00017A 123",
        "12",
        "RangeError frame 2 is missing",
        "RangeError a frame is unexpected or given twice",
        "RangeError there are no frames of a reply of several frames",
        "RangeError there are no frames of a reply of several frames",
    ]


def test_a_c_program(tmp_path: Path) -> None:
    """The number of a frame is the index of its part; the tagged union has any of the replies."""
    folder = write_files(CTarget().generate([specification(RACK)], {}), tmp_path / "c")
    (tmp_path / "use.c").write_text(
        """
        #include <stdio.h>
        #include <string.h>
        #include <rack/v1.h>

        int main(void)
        {
            static const uint8_t data[3][8] = {
                {0x57, 2, 0x2D, 0x30, 0x30, 0x30, 0x31, 0x37},
                {0x57, 1, 0x52, 0x4B, 0x32, 0x30, 0x32, 0x36},
                {0x57, 3, 0x41, 0, 0, 0, 0, 0xFF},
            };
            char serial[RACK_V1_READ_SERIAL_REPLY_FRAMES * 6u + 1u] = "";
            canwright_frame_t request, frame = CANWRIGHT_ZERO;
            rack_v1_any_reply_t reply;
            if (rack_v1_read_serial_request_encode(&request, 3u) != CANWRIGHT_OK) {
                return 1;
            }
            for (unsigned i = 0u; i < 3u; i++) {
                frame.id = 0x183u;
                frame.dlc = 8u;
                memcpy(frame.data, data[i], 8u);
                if (rack_v1_check_reply(&request, &frame) != CANWRIGHT_OK
                    || rack_v1_decode_reply(&reply, &frame) != CANWRIGHT_OK) {
                    return 2;
                }
                memcpy(&serial[(reply.as.read_serial.part - RACK_V1_READ_SERIAL_REPLY_FIRST_FRAME) * 6u],
                       reply.as.read_serial.serial, 6u);
            }
            puts(serial);
            return 0;
        }
        """,
        "utf-8",
    )
    program = build([tmp_path / "use.c"], folder / "include", tmp_path / "use")
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    assert done.stdout == "RK2026-00017A\n"


def test_a_dissector_and_a_decoder_of_logs_link_all_replies() -> None:
    edition, log = specification(RACK).edition, frames(LOG)
    dissected = judge(edition, log)
    assert [result.request for result in dissected] == LINKS
    assert [result.message.command for result in dissected][4:10] == [
        "read_state",
        "read_state",
        "limits",
        "extremes",
        "read_cells",
        "busy",
    ]
    assert [directed.request for directed in Directions({}, edition).classify(log)] == LINKS
