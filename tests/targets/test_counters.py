"""Counters in C and JavaScript, and the numbering of messages in Python and JavaScript; the functions of Python are in test_python_runtime.py."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import can
import pytest
from canwright.conformance import modules
from canwright.conformance.adapter import write_files
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget
from canwright.targets.javascript.package import RUNTIME
from canwright.targets.javascript.target import JavaScriptTarget
from canwright.targets.python.target import PythonTarget

from ..compilers import build
from ..node import run
from ..spec_texts import ROOT
from .live_bus import Clock, VirtualTimeBus

CHASSIS = ROOT / "tests/specs/chassis/v1.yaml"
NEXT = {0: 1, 1: 2, 13: 14, 254: 255, 255: 1}
"""The values after some values of a counter 1..255."""
STEPS = {(1, 2): 1, (255, 1): 1, (3, 3): 0, (254, 2): 3, (2, 1): 254, (0, 1): 0, (1, 0): 0, (1, 255): 254}

PROGRAM = """\
#include <stdio.h>
#include "chassis/v1.h"
int main(void)
{
    unsigned counter, previous;
    while (scanf("%u %u", &previous, &counter) == 2) {
        printf("%u %u\\n", (unsigned)chassis_v1_odometer_reply_count_next((uint8_t)previous),
            (unsigned)chassis_v1_odometer_reply_count_steps((uint8_t)previous, (uint8_t)counter));
    }
    return 0;
}
"""


def test_counters_in_c(tmp_path: Path) -> None:
    folder = write_files(CTarget().generate([specification(CHASSIS)], {}), tmp_path)
    source = tmp_path / "counters.c"
    source.write_text(PROGRAM, "utf-8")
    program = build([source], folder / "include", tmp_path / "counters")
    asked = [*((value, value) for value in NEXT), *STEPS]
    given = "".join(f"{previous} {value}\n" for previous, value in asked)
    answers = subprocess.run([program], input=given, capture_output=True, text=True, check=True).stdout.split("\n")
    assert [int(line.split()[0]) for line in answers[: len(NEXT)]] == list(NEXT.values())
    assert [int(line.split()[1]) for line in answers[len(NEXT) : -1]] == list(STEPS.values())


def test_counters_in_javascript() -> None:
    script = f"""
        import {{ countSteps, nextCount }} from {json.dumps((RUNTIME / "canwright-codec.js").as_uri())};
        const steps = {json.dumps(list(STEPS))}.map(([previous, value]) => countSteps([1, 255], previous, value));
        console.log(JSON.stringify([{json.dumps(list(NEXT))}.map((value) => nextCount([1, 255], value)), steps]));
    """
    assert json.loads(run(script)) == [list(NEXT.values()), list(STEPS.values())]


def test_a_sender_numbers_its_messages_in_javascript(tmp_path: Path) -> None:
    """Each message by itself, from the counter that the program gives; a refused message has no number."""
    folder = write_files(JavaScriptTarget().generate([specification(CHASSIS)], {}), tmp_path)
    script = """
        import { Numbering } from "./canwright-codec.js";
        import * as edition from "./chassis/v1.js";
        const numbering = new Numbering(edition);
        const steer = (counter, torque = 0) => edition.encodeRequest("steer", { raw: { torque, mode: 1, counter } });
        const state = edition.encodeReply("brake_state", { raw: { counter: 15, pressed: 0, pressure: 1 } });
        const other = edition.encodeRequest("turn", { node: 1, values: { steps: 1 } });
        const counters = [13, 0, 0, 7].map((counter) => numbering.next(steer(counter)).raw.counter);
        const refused = edition.decodeRequest({ id: 0xA0, data: [0x20, 0x4E, 1, 0, 0, 0, 3, 0xA3] });
        try {
          numbering.next(refused);
        } catch (error) {
          counters.push(error.refusal);
        }
        counters.push(numbering.next(steer(0)).raw.counter);
        const states = [state, state].map((message) => numbering.next(message).raw.counter);
        console.log(JSON.stringify([counters, states, numbering.next(other) === other, numbering.next(steer(0)).frame.data]));
    """
    program = folder / "program.mjs"
    program.write_text(script, "utf-8")
    counters, states, is_same, data = json.loads(run(program))
    assert counters == [13, 14, 0, 1, "out_of_range", 2]
    assert states == [15, 0]
    assert is_same
    assert data[6] == 3


WITH_CODES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
commands:
  beat: {code: 3, manual: "1", request: none, reply: {accept: [4], layout: {count: {at: 1, raw: u8, counter: 0..255}}}}
"""


def test_numbered_messages_keep_their_code(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(WITH_CODES, "utf-8")
    item = specification(tmp_path / "v1.yaml")
    folder = write_files(JavaScriptTarget().generate([item], {}), tmp_path / "javascript")
    script = """
        import { Numbering } from "./canwright-codec.js";
        import * as edition from "./lamp/v1.js";
        const numbering = new Numbering(edition);
        const beat = edition.decodeReply({ id: 0x101, data: [4, 7, 0, 0, 0, 0, 0, 0] });
        console.log(JSON.stringify([beat, beat].map((message) => numbering.next(message).frame.data.slice(0, 2))));
    """
    program = folder / "program.mjs"
    program.write_text(script, "utf-8")
    assert json.loads(run(program)) == [[4, 7], [4, 8]]
    edition, nodes = modules.load(
        write_files(PythonTarget().generate([item], {}), tmp_path / "python"), "lamp.v1", "lamp.nodes"
    )
    beat, numbering = edition.decode_reply(0x101, bytes.fromhex("0407000000000000")), nodes.Numbering()
    assert [numbering.next(beat).encode()[:2].hex() for _ in range(2)] == ["0407", "0408"]


def test_a_client_numbers_its_messages_in_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each message by itself, from the counter that the program gives; a refused message has no number."""
    folder = write_files(PythonTarget().generate([specification(CHASSIS)], {}), tmp_path)
    edition, nodes, client_module = modules.load(folder, "chassis.v1", "chassis.nodes", "chassis.client")
    clock = Clock()
    monkeypatch.setattr(client_module, "time", clock)
    bus = VirtualTimeBus(clock, lambda _: ())
    known = edition.Parameters()
    steer = edition.SteerRequest.from_raw(torque=0, mode=1, counter=13)
    with client_module.Client(bus, [nodes.Node(edition, 1, known)]) as client:
        for _ in range(3):
            client.send(steer)
    assert [message.data[6] for message in bus.sent if isinstance(message, can.Message)] == [13, 14, 0]

    numbering = nodes.Numbering()
    assert [numbering.next(steer).counter for _ in range(3)] == [13, 14, 0]
    with pytest.raises(Exception, match="torque"):
        numbering.next(edition.decode_request(0xA0, bytes.fromhex("204E0100000003A3")))
    assert numbering.next(steer).counter == 1
    turn = edition.TurnRequest(node=1, steps=1)
    assert numbering.next(turn) is turn
