"""`canwright request`: replies in units, refusals, the round trip; nodes in this process, and in another one."""

from __future__ import annotations

import re

import can
import pytest
from canwright.cli import main
from click.testing import CliRunner, Result

from ..spec_texts import ROOT, SPECS
from .live import MG, NEW, OLD, answering, free_port, simulated

SLOW = ("--timeout", "5")
"""For a machine that is busy with other tests."""


def run(channel: str, *arguments: str) -> Result:
    return CliRunner().invoke(main, ["request", *arguments, "-i", "virtual", "-c", channel])


def test_the_reply_is_printed_in_units() -> None:
    with answering("v2_36_2025_03", "units", voltage=48.72, temperature=-3):
        result = run("units", "read_status_1", "--node", "1", "--edition", NEW, *MG, *SLOW)
        both = run("units", "read_status_1", "--node", "1..2", "--edition", NEW, *MG, *SLOW)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [
        "reply of read_status_1 from node 1",
        "    field        position    raw   value",
        "    temperature  DATA[1]     -3    -3 °C",
        "    voltage      DATA[2..3]  4872  48.72 V",
        "    current      DATA[4..5]  0     0.0 A",
        "    motor_state  DATA[6]     0     on",
        "    errors       DATA[7]     0     []",
    ]
    assert both.stdout == result.stdout + result.stdout.replace("node 1", "node 2")


def test_what_has_an_effect_needs_consent() -> None:
    """The sentence of the client, with what to write here; the node does not get the request."""
    with answering("v2_36_2025_03", "consent") as simulation:
        move = ("write_control_parameter_ram_max_speed", "max_speed=500", "--node", "1", "--edition", NEW, *MG, *SLOW)
        torque = ("set_torque", "iq=2.5", "--node", "1", "--edition", NEW, *MG, *SLOW)
        wear = ("write_position_as_zero_rom", "--node", "2", "--edition", NEW, *MG, *SLOW)
        refused = run("consent", *torque)
        assert (refused.exit_code, refused.stdout) == (1, "")
        assert refused.stderr.startswith("canwright: SetTorqueRequest(node=1, iq=2.49755859375, ")
        assert refused.stderr.endswith("was not sent. The motor moves. To allow this, write --allow motion\n")
        assert run("consent", *wear, "--allow", "motion").stderr.endswith("write --allow wear\n")
        received = simulation.received
        moved = run("consent", *torque, "--allow", "motion")
        assert (moved.exit_code, moved.stderr) == (0, "to stop: canwright request motor_stop --node 1 ...\n")
        assert simulation.received == received + 2  # a read comes first
        assert run("consent", *wear, "--allow", "wear").exit_code == 0
        assert run("consent", "motor_stop", "--node", "1", "--edition", NEW, *MG, *SLOW).stderr == ""
        assert run("consent", *move).exit_code == 0
        assert simulation[1].values["control_parameters.max_speed"] == 500


@pytest.mark.parametrize(("edition", "module"), [(OLD, "v2_35"), (NEW, "v2_36_2025_03")])
def test_the_quick_start_moves_a_node_and_stops_it(edition: str, module: str) -> None:
    page = (ROOT / "generated/docs/en/quickstart.md").read_text("utf-8").partition(f"mwd_motor {edition}\n")[2]
    lines = re.findall(rf"canwright request (.*) --edition {edition} -i socketcan -c can0", page)
    with answering(module, f"quick {edition}") as simulation:
        results = [
            run(f"quick {edition}", *line.replace("=MS", "=MG").split(), "--edition", edition, *SLOW) for line in lines
        ]
        assert [(result.exit_code, "reply of" in result.stdout) for result in results] == [(0, True)] * 6, results
        assert simulation[1].state == "off"
    assert [line for line in lines if "--allow" in line] == [
        "move_by_angle_at_speed increment=90 max_speed=90 --node 1 --allow motion --set series=MS"
    ]


def test_a_broadcast_gathers_the_replies_of_the_nodes() -> None:
    with answering("v2_35", "broadcast"):
        torque = ("broadcast_torque", "iq=1,2,0,0", "--edition", OLD, *MG, "--allow", "motion")
        result = run("broadcast", *torque, "--node", "1..2", *SLOW)
        assert (result.exit_code, result.stdout.count(" from node ")) == (0, 2), result.output
        lacking = run("broadcast", *torque, "--node", "1..3", "--timeout", "0.5")
        assert (lacking.exit_code, "was not sent, because a node does not answer" in lacking.stderr) == (1, True)


def test_a_silent_node_is_named_and_the_others_answer() -> None:
    with answering("v2_35", "silent"):
        result = run("silent", "read_status_1", "--node", "2..3", "--edition", OLD, *MG, "--timeout", "0.5")
    assert (result.exit_code, result.stdout.partition("\n")[0]) == (1, "reply of read_status_1 from node 2")
    assert "node=3" in result.stderr and "node=2" not in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_the_round_trip_is_measured_with_reads_only() -> None:
    with answering("v2_36_2025_03", "measured", delay=0.01) as simulation:
        result = run("measured", "read_status_1", "--node", "1", "--edition", NEW, *MG, "--measure", "20", *SLOW)
        assert simulation.received == 21
        first, trip, advice = result.stdout.splitlines()
        assert (result.exit_code, first) == (0, "node 1: 20 of 20 requests answered")
        words = trip.replace(",", "").split()
        p50, p99, longest = (float(words[words.index(name) + 1]) for name in ("p50", "p99", "longest"))
        assert 10 <= p50 <= p99 == longest < 5000
        seconds = float(advice.split()[6])
        assert 2 * longest / 1000 <= seconds < 2 * longest / 1000 + 0.0011
        assert advice.endswith(f"as Client(..., timeout={seconds})")
        refused = run("measured", "motor_stop", "--node", "1", "--edition", NEW, *MG, "--measure", "20")
        assert (refused.exit_code, "--measure is for commands with one reply" in refused.stderr) == (2, True)
        silent = run(
            "measured", "read_status_1", "--node", "9", "--edition", NEW, *MG, "--measure", "3", "--timeout", "0.05"
        )
        assert silent.exit_code == 1
        assert silent.stdout == "node 9: 0 of 3 requests answered\n"


def test_a_lost_bus_ends_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise can.CanOperationError("adapter\n  unplugged.")

    monkeypatch.setattr("can.interfaces.virtual.VirtualBus._recv_internal", fail)
    result = run("lost", "read_status_1", "--node", "1", "--edition", NEW, *MG)
    assert (result.exit_code, result.stderr) == (2, "canwright: the bus does not work: adapter unplugged\n")


@pytest.mark.parametrize(
    ("arguments", "status", "says"),
    [
        (("read_status_1", "--node", "1"), 2, "give the one of the nodes, which `canwright scan` finds: --edition"),
        (
            ("read_status_4", "--node", "1", "--edition", NEW, *MG),
            2,
            "there is no command `read_status_4`; did you mean",
        ),
        (("read_status_1", "--node", "99", "--edition", NEW, *MG), 2, "mwd_motor v2.36-2025-03 has no node 99"),
        (
            ("read_control_parameter", "--node", "1", "--edition", NEW, *MG),
            2,
            "is several commands; write one: read_contr",
        ),
        (("set_torque", "--node", "1", "--edition", NEW, *MG), 1, "set_torque_request lacks 1 value: iq=-33..33 A"),
        (("set_torque", "iq=40", "--node", "1", "--edition", NEW, *MG), 1, "; it takes -33..33 A"),
        (
            ("read_status_2", "--node", "1", "--edition", OLD),
            2,
            "the reply of read_status_2 depends on series; give --set series=MF|MG|MH|MS",
        ),
        (("set_torque", "iq", "--node", "1", "--edition", NEW, *MG), 2, "`iq` is not a value; write FIELD=VALUE"),
    ],
)
def test_wrong_arguments_end_with_a_sentence(arguments: tuple[str, ...], status: int, says: str) -> None:
    result = run("wrong", *arguments)
    assert (result.exit_code, says in result.stderr) == (status, True), result.output


def test_requests_without_a_reply_are_sent() -> None:
    spec = next(spec for spec in SPECS if spec.parent.name == "blower")
    with can.Bus("silently", interface="virtual") as bus:
        for command, can_id in (("stop", 0x22), ("stop_all", 0x7E0)):
            result = run("silently", command, "--node", "1", "--spec", str(spec))
            assert (result.exit_code, result.output) == (0, "")
            frame = bus.recv(1)
            assert frame and frame.arbitration_id == can_id


@pytest.mark.parametrize("edition", [NEW, OLD])
def test_nodes_of_another_process_answer_over_udp(edition: str) -> None:
    """Each process gets the frames that it sends, too, and with the second edition they have the ids of requests."""
    bus = ("-i", "udp_multicast", *free_port())
    with simulated(edition, "--node", "1..4", *MG, *bus) as ended:
        arguments = ["request", "read_status_1", "--node", "1..4", "--edition", edition, *MG, *SLOW, *bus]
        result = CliRunner().invoke(main, arguments)
        assert (result.exit_code, result.stdout.count(" V\n")) == (0, 4), result.output
    assert ended.status == 130
    received, sent = (int(part.split()[0]) for part in ended.stdout.split(",")[:2])
    assert (sent, ended.stdout.split(", ")[2]) == (received, "0 of no request to these nodes\n")
    assert received in (4, 8)  # a read of each node comes first
