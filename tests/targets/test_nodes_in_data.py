"""Nodes that reply on one id, with their number in the data: each is decoded with its own parameters."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import pytest
from canwright.cli import main
from canwright.conformance import modules
from canwright.conformance.adapter import write_files
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget
from canwright.targets.columns.target import ColumnsTarget
from canwright.targets.options import NO_OPTIONS
from click.testing import CliRunner

from ..compilers import build
from ..spec_texts import ROOT
from .test_python import write

HOIST = ROOT / "tests/specs/hoist/v1.yaml"
LOW, HIGH = "11 FF FF 0A 00", "12 FF FF 0A 00"
"""Replies to `move` of the nodes with the low bits 1 and 2: the largest position, and a force of 10."""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return modules.load(write(tmp_path_factory.mktemp("hoist"), HOIST), "hoist.v1", "hoist.nodes")


def node(package: Any, number: int, p_max: float, gear: str) -> Any:
    v1, nodes = package
    return nodes.Node(v1, number, v1.Parameters(p_max=p_max, gear=v1.Gear(gear)))


def test_the_low_bits_select_among_the_nodes_of_a_bus(package: Any) -> None:
    v1, nodes = package
    bus = nodes.Nodes([node(package, 33, 10, "low"), node(package, 2, 20, "high")])
    replies = [bus.decode_reply(0, bytes.fromhex(data)) for data in (LOW, HIGH)]
    assert [(reply.position, reply.force, reply.node) for reply in replies] == [(10, 5, None), (20, 20, None)]
    assert [[holder.node for holder in bus.nodes_of("reply", 0, bytes.fromhex(data))] for data in (LOW, HIGH)] == [
        [33],
        [2],
    ]
    whole = [bus.decode_reply(0x7F1, bytes([number]) + bytes.fromhex("FF FF 0A 00")) for number in (33, 2)]
    assert [(reply.position, reply.force, reply.node) for reply in whole] == [(10, 5, 33), (20, 20, 2)]
    with pytest.raises(v1.CodecError, match="is of no node of this bus"):
        bus.decode_reply(0, bytes.fromhex("13 FF FF 0A 00"))


def test_nodes_with_the_same_low_bits_share_what_their_parameters_have_in_common(package: Any) -> None:
    _, nodes = package
    bus = nodes.Nodes([node(package, 18, 10, "high"), node(package, 2, 20, "high")])
    reply = bus.decode_reply(0, bytes.fromhex(HIGH))
    assert (reply.force, reply.parameters.p_max) == (20, None)


def test_columns_select_the_frames_of_a_node(tmp_path: Path) -> None:
    folder = write_files(ColumnsTarget().generate([specification(HOIST)], {}, NO_OPTIONS), tmp_path)
    edition, runtime = modules.load(folder, "hoist_columns.v1", "hoist_columns._columns")
    known = {33: {"p_max": 10, "gear": "low"}, 2: {"p_max": 20, "gear": "high"}}
    data = [bytes([number]) + bytes.fromhex("FF FF 0A 00") for number in (33, 2, 33)]
    frames = runtime.frames([0x7F1] * 3, data, runtime.Direction.REPLY)
    assert edition.decoder().nodes(frames).tolist() == [33, 2, 33]
    positions = {}
    for number, parameters in known.items():
        decoder = edition.decoder(parameters)
        (table,) = decoder.decode(frames.take(decoder.nodes(frames) == number)).tables.values()
        positions[number] = [*zip(table.columns["position"].tolist(), table.columns["force"].tolist(), strict=True)]
    assert positions == {33: [(10, 5), (10, 5)], 2: [(20, 20)]}


def test_decode_takes_the_settings_of_the_node(tmp_path: Path) -> None:
    """A reply with the low bits of a node has the node of the request that it answers."""
    log = tmp_path / "bus.log"
    frames = ("021#FFFF", "000#11FFFF0A00", "002#FFFF", "000#12FFFF0A00", "7F0#21", "7F1#21FFFF0A00", "7F1#02FFFF0A00")
    log.write_text("".join(f"({number / 100:.6f}) can0 {frame}\n" for number, frame in enumerate(frames)), "utf-8")
    settings = ("33:p_max=10", "33:gear=low", "2:p_max=20", "2:gear=high")
    options = [part for setting in settings for part in ("--set", setting)]
    arguments = ["decode", str(log), "--spec", str(HOIST), "--window", "20", *options]
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    replies = [line for line in result.output.splitlines() if "  reply " in line]
    assert [line.partition("position ")[2].partition(";")[0] for line in replies] == [
        "10.0 rad, force 5.0 N",
        "20.0 rad, force 20 N",
        "10.0 rad, force 5.0 N",
        "20.0 rad, force 20 N",
    ]


def test_c_identifies_the_node_before_its_parameters_matter(tmp_path: Path) -> None:
    folder = write_files(CTarget().generate([specification(HOIST)], {}), tmp_path / "c")
    (tmp_path / "use.c").write_text(
        """
        #include <stdio.h>
        #include <hoist/v1.h>

        int main(void)
        {
            static const hoist_v1_parameters_t known[] = {
                {.p_max = {10, 1}, .gear = HOIST_V1_GEAR_LOW}, {.p_max = {20, 1}, .gear = HOIST_V1_GEAR_HIGH},
            };
            for (uint8_t number = 1u; number <= 2u; number++) {
                const canwright_frame_t frame = {.id = 0x7F1u, .dlc = 5u, .data = {number, 0xFFu, 0xFFu, 10u, 0u}};
                hoist_v1_command_t command;
                hoist_v1_measure_reply_t reply;
                int64_t position;
                int32_t force;
                uint32_t node;
                if (hoist_v1_identify_reply(&command, &node, &frame) != CANWRIGHT_OK || node == 0u || node > 2u
                    || hoist_v1_measure_reply_decode(&reply, &node, &frame) != CANWRIGHT_OK
                    || hoist_v1_position_to_milli(&position, reply.position, &known[node - 1u]) != CANWRIGHT_OK
                    || hoist_v1_force_to_milli(&force, reply.force, &known[node - 1u]) != CANWRIGHT_OK) {
                    return 1;
                }
                printf("%u: %ld %ld\\n", (unsigned)node, (long)position, (long)force);
            }
            return 0;
        }
        """,
        "utf-8",
    )
    program = build([tmp_path / "use.c"], folder / "include", tmp_path / "use")
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    assert done.stdout == "1: 10000 5000\n2: 20000 20000\n"
