"""The frame explorer without a browser: what lines, tables and golden frames mean, and the code that it shows."""

from __future__ import annotations

import ast
import gzip
import itertools
import json
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

import can
import pytest
import yaml
from canwright.conformance.adapter import CanFrame, Cannot, Parameters, Refused, write_files
from canwright.conformance.runner import Runner
from canwright.model import formatting
from canwright.model.golden_frames import GoldenFrame, Value
from canwright.model.message import Message
from canwright.model.sending import Occasion
from canwright.model.types import NO_PARAMETERS
from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.c.target import CTarget
from canwright.targets.javascript.page import FOLDER, explorer
from canwright.targets.python.target import PythonTarget
from canwright.templating.resources import TEMPLATES

from ..compilers import WARNINGS, ZIG
from ..conformance.adapters.javascript import JavaScriptAdapter
from ..node import run
from ..spec_texts import ROOT, SPECS, called

CASES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100}}
parameters: {size: {values: [14, 15]}}
types:
  angle:
    raw: u16
    unit: deg
    raw_range: {by: size, 14: 0..16383, 15: 0..32767}
    scale: {by: size, 14: 360/16384, 15: 360/32768}
  share: {raw: u8, raw_range: {by: size, 14: 0..63, 15: 0..127}, scale: {by: size, 14: 1, 15: 2}}
commands:
  turn: {request: {angle: {at: 0, type: angle}, shares: {at: 2, type: share, array: 1..2}}, reply: none}
"""

MOTOR = ROOT / "spec/mwd_motor/v2.35.yaml"


def _bigint(table: dict[str, Any]) -> Any:
    return int(table["bigint"]) if "bigint" in table else table


def interpret(folder: Path, questions: Sequence[Mapping[str, Any]]) -> list[Any]:
    """The answers of the scripts in a folder."""
    (folder / "questions.json").write_text(json.dumps(questions), "utf-8")
    script = Path(__file__).parent / "explorer.cjs"
    answers: list[Any] = json.loads(run(script, folder / FOLDER, folder / "questions.json"), object_hook=_bigint)
    return answers


def _question(frame: GoldenFrame) -> dict[str, Any]:
    return {"line": formatting.sent(frame), "parameters": {name: str(v) for name, v in frame.parameters.items()}}


def _timing(message: Message) -> Iterator[str | float]:
    """The labels of the occasions and times of a message, each time after its label."""
    sending = message.sending
    if sending is None:
        return
    for occasion in sending.occasions:
        if occasion is Occasion.CYCLIC and sending.every_ms is not None:
            yield from ("every", float(sending.every_ms))
        else:
            yield occasion.value
    if sending.timeout_ms is not None:
        yield from ("timeout", float(sending.timeout_ms))


class ExplorerAdapter(JavaScriptAdapter):
    """Answers through the tables that the page interprets."""

    name = "explorer"
    cannot: ClassVar[Mapping[str, str]] = {"answers": "the page does not ask which reply answers a request"}

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> ExplorerAdapter:
        folder = write_files(explorer([specification]), workdir) / FOLDER
        (edition,) = (folder / "editions").iterdir()
        sources = (file.read_text("utf-8") for file in (folder / "codec.js", edition, folder / "edition.js"))
        names = "decodeRequest, decodeReply, decodeAs, encodeRequest, encodeReply, candidates"
        tables = f"export const {{ {names} }} = canwright.createEdition(canwright.editions[0].tables);\n"
        module = workdir / "explorer.mjs"
        module.write_text(f"{''.join(sources)}\n{tables}export const {{ CodecError }} = canwright;\n", "utf-8")
        return cls(specification.edition, module)

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        raise Cannot("answers")


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_the_tables_mean_what_the_golden_frames_mean(spec: Path, tmp_path: Path) -> None:
    item = specification(spec)
    assert item.frames is not None
    report = Runner(item.edition, item.frames, ExplorerAdapter.create(item, tmp_path)).run()
    assert not report.failures, "\n".join(map(str, report.failures[:40]))


@pytest.mark.parametrize("spec", [MOTOR, *SPECS[4:]], ids=called)
def test_golden_frames_and_their_code(spec: Path, tmp_path: Path) -> None:
    """Every golden frame is found with its raw integers; the code for one frame of each message writes its bytes."""
    item = specification(spec)
    assert item.frames is not None
    folder = write_files(explorer([item]), tmp_path)
    frames = item.frames.frames
    programs: dict[tuple[str, str], tuple[str, str, str]] = {}
    for frame, answer in zip(frames, interpret(folder, list(map(_question, frames))), strict=True):
        line = formatting.sent(frame)
        assert answer["frame"] == line
        same = [candidate for candidate in answer["found"] if candidate["direction"] == frame.direction.value]
        message = item.edition.command(frame.command).message(frame.direction)
        assert message is not None
        fitting = [
            candidate
            for candidate in same
            if candidate["command"] == message.command and candidate["raw"] == dict(frame.raw)
        ]
        assert fitting, (line, same)
        assert fitting[0]["timing"] == list(_timing(message))
        assert fitting[0]["cansend"] == f"cansend can0 {line}"
        if not fitting[0]["deviation"] and not fitting[0]["obstacle"] and not frame.decode_only:
            programs.setdefault((frame.direction.value, message.command), (line, fitting[0]["c"], fitting[0]["python"]))
    assert len(programs) > len(item.edition.all_messages()) // 2
    _run_python(write_files(PythonTarget().generate([item], {}), tmp_path), list(programs.values()))
    _run_c(write_files(CTarget().generate([item], {}), tmp_path), list(programs.values()))


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_no_value_depends_on_a_parameter_that_is_not_given(spec: Path, tmp_path: Path) -> None:
    """Values are those of golden frames; without the parameters, a value that depends on them is shown for each of their values."""
    item = specification(spec)
    assert item.frames is not None
    folder = write_files(explorer([item]), tmp_path)
    frames = [frame for frame in item.frames.frames if frame.values and len(frame.data) <= 8]
    given = interpret(folder, list(map(_question, frames)))
    alone = interpret(folder, [{**_question(frame), "parameters": {}} for frame in frames])
    both = [*zip(frames, given, itertools.repeat(True)), *zip(frames, alone, itertools.repeat(False))]
    for frame, answers, is_given in both:
        message = item.edition.command(frame.command).message(frame.direction)
        assert message is not None
        if message.id.parameter is not None and not is_given:
            assert not any(candidate["command"] == message.command for candidate in answers["found"])
            continue
        raw, candidates = (
            dict(frame.raw),
            [(candidate["direction"], candidate["command"], candidate["raw"]) for candidate in answers["found"]],
        )
        shown = answers["found"][candidates.index((message.direction.value, message.command, raw))]["fields"]
        assert all(field["reason"] or field["missing"] == [] for field in shown)
        for field in (field for field in shown if field["name"] in frame.values):
            results = [
                case for case in field["cases"] if set(case["values"]) & {str(v) for v in frame.parameters.values()}
            ]
            assert len(results) <= 1
            _same_value(frame.values[field["name"]], results[0] if results else field, frame)


def _same_value(wanted: Value, result: Mapping[str, Any], frame: GoldenFrame) -> None:
    """Checks that a result is a golden value, or states that it needs a number parameter."""
    value, reason, names = result["value"], result["reason"], result.get("valueName")
    if isinstance(names, list) and isinstance(wanted, list):
        assert not {w for w in wanted if isinstance(w, str)} - {*names, *(result["noValue"] or ())}, frame
        wanted = [number if name == each else each for each, number, name in zip(wanted, value, names, strict=True)]
    elif names and names == wanted:
        wanted = value
    if wanted == "none":
        assert value is None and reason, frame
    elif reason == "missing_parameter":
        assert value is None and frame.parameters, frame
    elif reason == "no_value":
        wants, numbers, names = (x if isinstance(x, list) else [x] for x in (wanted, value, result["noValue"]))
        for expected, each, name in zip(wants, numbers, names, strict=True):
            assert (each, name) == ((None, expected) if isinstance(expected, str) else (expected, None)), frame
    else:
        listed = wanted if isinstance(wanted, list) else [wanted]
        named = wanted == [] or isinstance(listed[0], str)  # bits without a name are in no golden value
        shown = (
            [element for element in value if not named or isinstance(element, str)]
            if isinstance(value, list)
            else [value]
        )
        pairs = zip(listed, shown, strict=True)
        assert all(
            each in (expected, float(expected) if isinstance(expected, Fraction) else expected)
            for expected, each in pairs
        ), frame


def test_programs_with_arrays_of_named_values(tmp_path: Path) -> None:
    spec = (
        CASES.split("types:")[0].replace("parameters: {size: {values: [14, 15]}}\n", "")
        + """\
types:
  lights: {raw: u8, flags: {red: 0, green: 1}}
  mode: {raw: u8, enum: {slow: 1, fast: 2}}
commands:
  show: {request: {lights: {at: 0, type: lights, array: 1..3}, modes: {at: 3, type: mode, array: 1..2}}, reply: none}
"""
    )
    (tmp_path / "lamp.yaml").write_text(spec, "utf-8")
    item = specification(tmp_path / "lamp.yaml")
    folder = write_files(explorer([item]), tmp_path)
    line = "100#0003010201000000"
    (answer,) = interpret(folder, [{"line": line, "parameters": {}}])
    (shown,) = answer["found"]
    _run_python(write_files(PythonTarget().generate([item], {}), tmp_path), [(line, shown["c"], shown["python"])])


def test_a_case_outside_the_range_of_its_raw_integers_is_marked(tmp_path: Path) -> None:
    """An encoder of 14 bits is never at 720 degrees."""
    (tmp_path / "lamp.yaml").write_text(CASES, "utf-8")
    folder = write_files(explorer([specification(tmp_path / "lamp.yaml")]), tmp_path)
    lines = [f"100#{data}00000000" for data in ("FF3F013F", "00400140", "00800101")]
    answers = interpret(folder, [{"line": line, "parameters": {}} for line in lines])
    cases = [
        [[(case["value"], case["isOutside"]) for case in field["cases"]] for field in answer["found"][0]["fields"]]
        for answer in answers
    ]
    assert [angle for angle, _ in cases] == [
        [(16383 * 360 / 16384, False), (16383 * 360 / 32768, False)],
        [(360, True), (180, False)],
        [(720, True), (360, True)],
    ]
    assert [shares for _, shares in cases[:2]] == [
        [([1, 63], False), ([2, 126], False)],
        [([1, 64], True), ([2, 128], False)],
    ]


def test_a_value_is_not_encoded_without_its_parameter(tmp_path: Path) -> None:
    """Raw integers are; a motor without the command, and a program that would have to assume a series, are named."""
    folder = write_files(explorer([specification(MOTOR)]), tmp_path)
    reply, power = "141#A1329B00F4010080", "141#A000000064000000"
    entered = {"name": "iq", "value": 2.5, "raw": 310}
    answers = interpret(folder, [
        {"line": reply, "parameters": {}, "enter": entered},
        {"line": reply, "parameters": {"series": "MG"}, "enter": entered},
        {"line": reply, "parameters": {"series": "MH"}, "enter": entered},
        {"line": power, "parameters": {}},
        {"line": power, "parameters": {"series": "MG"}},
    ])  # fmt: skip
    first = [answer["found"][0] for answer in answers]
    assert [candidate.get("entered") for candidate in first[:3]] == [
        "missing_parameter",
        "141#A1329B00F4010080",
        "no_scale",
    ]
    assert {candidate.get("entered_raw") for candidate in first[:3]} == {"141#A1323601F4010080"}
    assert [candidate["obstacle"] for candidate in first] == ["needs", "", "", "", "absent"]
    assert first[0]["fields"][1]["cases"] == [
        {"values": ["MF"], "value": 155 * 16.5 / 2048, "reason": None, "isOutside": False},
        {"values": ["MH"], "value": None, "reason": "no_scale", "isOutside": False},
        {"values": ["MG"], "value": 155 * 33 / 2048, "reason": None, "isOutside": False},
    ]


def _run_python(folder: Path, programs: Sequence[tuple[str, str, str]]) -> None:

    script = "\n".join(program for _, _, program in programs)
    ast.parse(script)
    done = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    for line, (wanted, _, program) in zip(done.stdout.splitlines(), programs, strict=True):
        assert _same("#".join(line.split(" ", 1)).replace(" ", ""), wanted), program


def _run_c(folder: Path, programs: Sequence[tuple[str, str, str]]) -> None:
    includes = sorted({program.splitlines()[0] for _, program, _ in programs})
    bodies = [program.split("\n", 2)[2] for _, program, _ in programs]
    show = "if (status != CANWRIGHT_OK) { return 1; } show(&frame);"
    functions = "\n".join(f"static int f{i}(void)\n{{\n{body}\n{show}\nreturn 0;\n}}" for i, body in enumerate(bodies))
    calls = " ".join(f"if (f{i}()) {{ return {i + 1}; }}" for i in range(len(bodies)))
    kind = "canwright_fd_frame_t" if "canwright_fd_frame_t" in bodies[0] else "canwright_frame_t"
    printer = f"static void show(const {kind} *frame)"
    printer += """
{
    printf("%X#", (unsigned)(frame->id & 0x1FFFFFFFu));
    for (int i = 0; i < frame->dlc && !(frame->id & CANWRIGHT_REMOTE); i++) {
        printf("%02X", frame->data[i]);
    }
    printf("\\n");
}"""
    source = folder / "main.c"
    source.write_text(
        "\n".join(["#include <stdio.h>", *includes, printer, functions, f"int main(void) {{ {calls} return 0; }}"]),
        "utf-8",
    )
    ZIG.run("c99", *WARNINGS, f"-I{folder / 'include'}", source, "-o", folder / "main")

    done = subprocess.run([folder / "main"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, bodies[done.returncode - 1]
    for line, (wanted, program, _) in zip(done.stdout.splitlines(), programs, strict=True):
        assert _same(line, wanted), program


def _same(written: str, wanted: str) -> bool:
    """Whether a program wrote the id and the data of a frame."""
    (id_, data), (wanted_id, wanted_data) = (
        f"{line}#".replace("##0", "#").split("#")[:2] for line in (written, wanted)
    )
    return int(id_, 16) == int(wanted_id, 16) and data.upper() == wanted_data.rstrip("R")


LINES = {
    "141#9C00000000000000": ("141#9C00000000000000", None, ""),
    "cansend can0 141#9c.00.00.00.00.00.00.00": ("141#9C00000000000000", None, ""),
    "  can0  141   [8]  9C 00 00 00 00 00 00 00": ("141#9C00000000000000", None, ""),
    "(1700000000.000100) can0 141#9C00000000000000 T": ("141#9C00000000000000", True, "1700000000.000100"),
    " (000.5)  can0  RX - -  141   [2]  9C 00": ("141#9C00", False, "000.5"),
    "00000141#R": ("00000141#R", None, ""),
    "can0 141 [0] remote request": ("141#R", None, ""),
    "141#": ("141#", None, ""),
    "": None,
    "0x141#9C": ("141#9C", None, ""),
    "141 9C 00 0A": ("141#9C000A", None, ""),
    "0x141: 0x9C, 0x00": ("141#9C00", None, ""),
    "00000141 9C00": ("00000141#9C00", None, ""),
    "   0.001000 1  141             Rx   d 2 9C 00  Length = 0 BitCount = 0 ID = 321": ("141#9C00", False, "0.001000"),
    "0.5 1 141x Tx d 1 9C": ("00000141#9C", True, "0.5"),
    "0.5 1 141 Rx r": ("141#R", False, "0.5"),
    "141##19C00": ("141#9C00", None, ""),
    "(1.5) can0 00008001##5" + "9C" * 12 + " R": ("00008001##0" + "9C" * 12, False, "1.5"),
}
PASTED = {
    "A1 00 00 00 64 00 00 00": "-#A100000064000000",
    "A100000064000000": "-#A100000064000000",
    "141 # A100000064000000": "141#A100000064000000",
    "141# A1 00 00 00 64 00 00 00": "141#A100000064000000",
    "0x141,0xA1,0x00": "141#A100",
    "0.5,141,2,A1,00": "141#A100",
    "141,08,A1,00,00,00,64,00,00,00": "141#A100000064000000",
    "1700000000.000100,0x141,0,8,a1 00 00 00 64 00 00 00": "141#A100000064000000",
    "1,接收,0x00000141,标准帧,数据帧,2,A1 00": "141#A100",
    "{0xA1, 0x00, 0x00, 0x00, 0x64}": "-#A100000064",
    "uint8_t data[5] = {0xA1, 0, 0, 0, 100};": "-#A100000064",
    "{A1, 00, 10}": "-#A10010",
    "A1h 00h 10h": "-#A10010",
    "141h A1 00 10": "141#A10010",
    "A1-00-10-00": "-#A1001000",
    "\\xA1\\x00\\x10": "-#A10010",
    "b'\\xa1\\x00\\x10'": "-#A10010",
    "标准帧 ID 0x141 长度 3 数据 A1 00 10": "141#A10010",
    "{.id = 0x141, .data = {0xA1, 0x00}}": "141#A100",
    "0x141: [0xA1, 0, 0x10]": "141#A10010",
    "send(0x141, {0xA1, 0x00});": "141#A100",
    "1500,00000141,false,Rx,0,2,A1,00,": "141#A100",
    "1500,00000141,true,Rx,0,2,A1,00,": "00000141#A100",
    '{"id": "0x141", "data": "A1 00"}': "141#A100",
    "ID: 0x141 Data: A1 00 00 00 64 00 00 00": "141#A100000064000000",
    "ID=141h, DLC=2, Data=A100": "141#A100",
    "Timestamp: 1.5  ID: 141  S Rx  DL:  2  a1 00  Channel: can0": "141#A100",
    "Timestamp: 1.5  ID: 00000141  X Rx  DL:  1  a1": "00000141#A1",
    "１４１＃Ａ１００": "141#A100",
    "帧ＩＤ：０ｘ１４１　数据：Ａ１、００": "141#A100",
    "00000000  a1 00 00 00 64 00 00 00  |....d...|": "-#A100000064000000",
    "00000000: a100 0000 6400 0000                      ....d...": "-#A100000064000000",
    "0000: A1 00": "-#A100",
    "t1412A100": "141#A100",
    "T000001412A10012AB": "00000141#A100",
    "     1)         2.1  Rx         0141  2  A1 00": "141#A100",
    "      1      2.104 DT     0141 Rx 2  A1 00": "141#A100",
    "      1      2.104 DT 1   00000141 Tx -  2    A1 00": "00000141#A100",
    "Message(timestamp=1.5, arbitration_id=0x141, is_extended_id=False, dlc=2, data=[0xa1, 0x0])": "141#A100",
    "11:22:33:4444 Rx 1 0x141 s 2 A1 00": "141#A100",
    "MB 1  OVERRUN: 0  LEN: 2 EXT: 0 TS: 1234 ID: 141 Buffer: A1 0": "141#A100",
    "0  00000141   2  A1 00      1.23 R": "00000141#A100",
    "0  接收  10:22:33.123  0x0141  数据帧  标准帧  0x02  x| A1 00": "141#A100",
    "0001  000.000.000  CH1  接收  0141  数据帧  标准帧  2  A1 00": "141#A100",
    "CAN SEND MSG BUFFER: a1 0 0 0 64 0 0 0": "-#A100000064000000",
    "16:29:16.767 -> ID: 0x141 Data: A1 0 10": "141#A10010",
    "141 3 A1 0 10": "141#A10010",
    "TxData[0] = 0xA1; TxData[1] = 0x00; TxData[2] = 16;": "-#A10010",
    "bytearray(b'\\xa1\\x00d\\n')": "-#A100640A",
    "data: [161, 0, 16], id: 321": "141#A10010",
    "<0x141> [2] A1 00": "141#A100",
    "0x141 -> A1 00 10": "141#A10010",
    "0x141, 0xA2, 0, 0, 0, 0x28, 0x23, 0, 0": "141#A200000028230000",
    "0x141, 0xA2, 0, 0, 0, 0x28, 0x23, 0x00, 0x00": "141#A200000028230000",
    "0x141 0xA2 0x0 0x0 0x0 0x28 0x23 0x0 0x0": "141#A200000028230000",
    "A1 0 0 0 64 0 0 0": "-#A100000064000000",
    "141 A1 0 0 0 64 0 0 0": "141#A100000064000000",
    "0xA1, 0, 0, 0, 0x64, 0, 0, 0": "-#A100000064000000",
    "141;A1;0;0;0;64;0;0;0": "141#A100000064000000",
    "0x141;8;A1;0;0;0;64;0;0;0": "141#A100000064000000",
}
PROBLEMS = {
    "141": ["no_frame"],
    "nonsense": ["no_frame"],
    "hello world 12": ["no_frame"],
    "141#A1G0": ["bad_byte", 7, "G"],
    "141#9C00 T x": ["bad_byte", 12, "x"],
    "141 A1 0G 00": ["bad_byte", 8, "0G"],
    "A1 00 G": ["bad_byte", 7, "G"],
    "{0xA1, 0x300}": ["bad_byte", 8, "0x300"],
    "141 9C 0": ["half_byte", 8, "0"],
    "141#9C0": ["half_byte", 7, "0"],
    "A10": ["no_frame"],
    "88 0 0 0 64 0 0 0": ["half_byte", 17, "0"],  # 88 can be decimal
    "0x141, 0xA2, 0, 0, 0, 28, 23, 0, 0": ["half_byte", 34, "0"],
    "0x141 2 A1 0 0": ["half_byte", 14, "0"],
    "A1000": ["half_byte", 5, "0"],
    "  FFF#00": ["bad_id", 3, "FFF"],
    "FFF 00": ["bad_id", 1, "FFF"],
    "1#00": ["bad_id", 1, "1"],
    "141 000000000000000000": ["bad_length", 5, 9],
    "141#000000000000000000": ["bad_length", 5, 9],
    "can0 141 [8] 00": ["bad_count", 11, 8, 1],
    "0.5 1 141 Rx d 2 9C": ["bad_count", 16, 2, 1],
    "ID=141, DLC=3, Data=A100": ["bad_count", 13, 3, 2],
    "0.5 1 8141 Rx d 0": ["half_byte", 17, "0"],
}


def test_lines_of_cansend_and_candump(tmp_path: Path) -> None:
    folder = write_files(explorer([specification(MOTOR)]), tmp_path)
    answers = interpret(folder, [{"line": line, "parameters": {}} for line in LINES])
    parsed = [answer and (answer["frame"], answer["sent"], answer["time"]) for answer in answers]
    assert dict(zip(LINES, parsed, strict=True)) == LINES


def test_what_people_paste(tmp_path: Path) -> None:
    """Bytes without an id are the messages of the first node; a problem has its column."""
    folder = write_files(explorer([specification(MOTOR)]), tmp_path)
    answers = interpret(folder, [{"line": line, "parameters": {}} for line in (*PASTED, *PROBLEMS)])
    frames, problems = answers[: len(PASTED)], answers[len(PASTED) :]
    assert {line: answer["frame"] for line, answer in zip(PASTED, frames, strict=True)} == PASTED
    assert dict(zip(PROBLEMS, problems, strict=True)) == PROBLEMS
    readings = [(each["direction"], each["command"], each["node"]) for each in frames[0]["found"]]
    assert readings[:2] == [("request", "set_torque", 1), ("reply", "set_torque", 1)]
    labels = yaml.safe_load((TEMPLATES / "javascript/labels.yaml").read_text("utf-8"))["en"]
    assert {problem[0] for problem in problems} <= {*labels}


TABLES = {
    "time,id,data\n0.5,141,A100000064000000\n0.6,0x142,9C 00\n0.7,00000141,0x9C 0x00\n0.8,141,\n": [
        ["0.5", "141#A100000064000000"], ["0.6", "142#9C00"], ["0.7", "00000141#9C00"], ["0.8", "141#"],
    ],
    "time;id;data\n0,5;141;A1000000": [["0,5", "141#A1000000"]],
    "Time;Identifier;Data\ndamaged;141;zz\n0.5;141;A1-00": [["0.5", "141#A100"]],
    '"Time (s)"\t"CAN ID"\t"DLC"\t"Data (HEX)"\n0.5\t141h\t2\t"A1 00"\n0.6\t141h\t3\t"A1 00"': [["0.5", "141#A100"]],
    "timestamp,arbitration_id,data\n1.5,0x141,nAAAAAAAAAA=\n1.6,0x141,AAAA": [
        ["1.5", "141#9C00000000000000"], ["1.6", "141#000000"],
    ],
    "timestamp,arbitration_id,dlc,data\n1.5,0x141,8,9C00000000000000\n1.6,0x141,3,AAAA\n1.7,0x141,2,AAAA": [
        ["1.5", "141#9C00000000000000"], ["1.6", "141#000000"], ["1.7", "141#AAAA"],
    ],
    "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n1500,00000141,false,Rx,0,2,A1,00,,,,,,\n"
    "1600,00000141,true,Tx,0,8,A1,00,00,00,64,00,00,00,\n1700,00000841,false,Rx,0,1,00,": [
        ["1500", "141#A100 R"], ["1600", "00000141#A100000064000000 T"],
    ],
    "序号,传输方向,时间标识,帧ID,帧格式,帧类型,数据长度,数据(HEX)\n0,接收,0.5,0x00000141,数据帧,标准帧,0x02,A1 00": [
        ["0.5", "141#A100 R"],
    ],
    "time,speed,data rate\n0.5,141,45": [],
    "id: 0x141, data: A1 00\nid: 0x142, data: A1 00": [],
}  # fmt: skip
"""Tables of comma-separated values with their frames; an id of 11 bits above 7FF is refused."""


def test_tables(tmp_path: Path) -> None:
    """By the names of their columns; those of python-can have data in Base64, whose length decides where both notations fit."""
    folder = write_files(explorer([specification(MOTOR)]), tmp_path)
    answers = interpret(folder, [{"log": table.splitlines()} for table in TABLES])
    assert dict(zip(TABLES, (answer["frames"] for answer in answers), strict=True)) == TABLES


def test_a_table_that_python_can_wrote(tmp_path: Path) -> None:
    folder = write_files(explorer([specification(MOTOR)]), tmp_path)
    messages = [
        can.Message(timestamp=1.5, arbitration_id=0x141, is_extended_id=False, data=bytes.fromhex("9C33640000000100")),
        can.Message(timestamp=1.6, arbitration_id=0x141, is_extended_id=True, data=bytes(6)),
        can.Message(timestamp=1.7, arbitration_id=0x142, is_extended_id=False, is_remote_frame=True, dlc=8),
        can.Message(timestamp=1.8, arbitration_id=4, is_extended_id=False, is_error_frame=True, data=bytes(8)),
    ]
    with can.CSVWriter(tmp_path / "bus.csv") as writer:
        for message in messages:
            writer(message)
    (answer,) = interpret(folder, [{"log": (tmp_path / "bus.csv").read_text("utf-8").splitlines()}])
    frames = [["1.5", "141#9C33640000000100"], ["1.6", "00000141#000000000000"], ["1.7", "142#R"]]
    assert answer == {"frames": frames, "skipped": 0, "errors": 1}


ERRORS = """\
(1.0) can0 20000004#0004000000000000
(1.0) can0 141#9C00000000000000
  can0  20000088   [8]  00 00 08 00 00 00 00 00   ERRORFRAME
   0.5 1  ErrorFrame
   0.5 CANFD 1 Rx ErrorFrame 0 0
     3)         8.5  Error  00000008  4  00 00 00 00
      3      8.500 ER 1      -  Rx  5    04 00 02 00 00
Timestamp:        1.500000    ID: 00000004    X Rx E              DL:  8    00 04 00 00 00 00 00 00
   0.5 1  123             Rx   d 1 9C
2E 00
"""


def test_error_frames_are_counted(tmp_path: Path) -> None:
    """Apart from the lines without a frame."""
    folder = write_files(explorer([specification(MOTOR)]), tmp_path)
    (answer,) = interpret(folder, [{"log": ERRORS.splitlines()}])
    assert answer == {"frames": [["1.0", "141#9C00000000000000"], ["0.5", "123#9C R"]], "skipped": 1, "errors": 7}


def test_reasons_name_the_editions(tmp_path: Path) -> None:
    """No reason of one edition is given for all, and the chosen edition gives its own alone."""
    folder = write_files(explorer([specification(spec) for spec in SPECS[:4]]), tmp_path)
    answers = interpret(
        folder, [{"line": "141#A132", "parameters": {}, "leading": leading} for leading in ("", "v2.35")]
    )
    short = "0x141 has 2 data bytes, not 8"
    newest = ["v2.36-2025-03", "v2.36-2024-11"]
    reasons = [{(r["direction"], r["message"]): sorted(r["labels"]) for r in answer["reasons"]} for answer in answers]
    assert reasons[0] == {
        ("request", short): sorted(["v2.35", "v2.35-2024-02", *newest]),
        ("reply", short): ["v2.35", "v2.35-2024-02"],
        ("reply", "no reply has the id 0x141"): sorted(newest),
    }
    assert reasons[1] == {("request", short): ["v2.35"], ("reply", short): ["v2.35"]}


def test_the_chosen_edition_leads(tmp_path: Path) -> None:
    folder = write_files(explorer([specification(spec) for spec in SPECS[:4]]), tmp_path)
    names = [specification(spec).edition.name for spec in SPECS[:4]]
    questions = [{"line": "141#9C33640000000100", "parameters": {}, "leading": name} for name in names]
    for name, answer in zip(names, interpret(folder, questions), strict=True):
        editions = [each["edition"] for each in answer["found"]]
        count = editions.count(name)
        assert 0 < count < len(editions) and set(editions[:count]) == {name}


def test_the_most_probable_message_is_first(tmp_path: Path) -> None:
    """A request with its reserved bits, a reply with them set, all editions, both layouts of a series, and marked replies of zeros."""
    folder = write_files(explorer([specification(spec) for spec in SPECS[:4]]), tmp_path)
    lines = ["141#9C00000000000000", "141#9C33640000000100", "141#A1329B00F4010080", "141#9C33640000000100"]
    lines += ["(1.0) can0 141#8000000000000000 R", "(1.0) can0 141#8000000000000000 T", "141#9C00000000000000 R"]
    parameters = [{}, {}, {"series": "MG"}, {"series": "MS", "nonsense": "1", "encoder_bits": "99"}, {}, {}, {}]
    answers = interpret(folder, [{"line": a, "parameters": b} for a, b in zip(lines, parameters, strict=True)])
    firsts = [(answer["found"][0]["direction"], answer["found"][0]["command"]) for answer in answers]
    status = ("reply", "read_status_2")
    marked = [("reply", "motor_off"), ("request", "motor_off"), status]
    assert firsts == [("request", "read_status_2"), status, ("reply", "set_torque"), status, *marked]
    assert {candidate["edition"] for candidate in answers[0]["found"]} == {
        specification(spec).edition.name for spec in SPECS[:4]
    }
    assert [candidate["series"] for candidate in answers[1]["found"]][:2] == [["MS"], ["MF", "MH", "MG"]]
    assert {
        tuple(candidate["series"] or ()) for candidate in answers[3]["found"] if candidate["direction"] == "reply"
    } == {("MS",)}


def test_a_mark_decides_among_equally_plausible_meanings(tmp_path: Path) -> None:
    """Many recorders mark every frame as received; the request turns by 360 degrees, as a reply it is at -29536 degrees per second."""
    folder = write_files(explorer([specification(spec) for spec in SPECS[:4]]), tmp_path)
    lines = ["1 141 Rx d 8 A3 00 00 00 A0 8C 00 00", "0.5 1 141 Tx d 8 A3 00 00 00 A0 8C 00 00", "141#A3000000A08C0000"]
    answers = interpret(folder, [{"line": line, "parameters": {}, "leading": "v2.35"} for line in lines])
    for answer in answers:
        first, second = answer["found"][:2]
        assert [first["direction"], second["direction"]] == ["request", "reply"]
        assert [field["value"] for field in first["fields"]] == [360]


def test_both_languages_have_the_same_labels() -> None:
    labels = yaml.safe_load((TEMPLATES / "javascript/labels.yaml").read_text("utf-8"))
    assert list(labels) == ["en", "zh"] and list(labels["en"]) == list(labels["zh"])
    sources = ROOT / "generator/canwright/targets/javascript/explorer/explorer.js"
    page = (TEMPLATES / "javascript/explorer.html.j2").read_text("utf-8")
    codec = (ROOT / "generator/canwright/targets/javascript/runtime/canwright-codec.js").read_text("utf-8")
    rejections = {*re.findall(r'\brejection\("(\w+)"|this\.reason === "(\w+)"', codec)}
    assert {name for names in rejections for name in names} - {"", "not_answer"} <= set(labels["en"])
    used = set(re.findall(r'\bsay\("(\w+)"', sources.read_text("utf-8"))) | set(re.findall(r'data-label="(\w+)"', page))
    assert used <= set(labels["en"]) and "innerHTML" not in sources.read_text("utf-8")


def test_it_is_small() -> None:

    folder = ROOT / "generated/javascript/explorer"
    assert sum(len(gzip.compress(file.read_bytes())) for file in folder.rglob("*.*")) < 100_000
