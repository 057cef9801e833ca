"""`canwright monitor`: the lines of `--plain`, recordings, and what it refuses; its view is in `test_monitor_app.py`."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import can
import pytest
from canwright.cli import main
from canwright.cli.monitor_feed import QUEUED, Feed, Receiver
from canwright.project.loader import specification
from click.testing import CliRunner, Result

from ..spec_texts import ROOT
from .live import MG, NEW, OLD, free_port, simulated

EDITION = ("--spec", str(ROOT / "spec/mwd_motor/v2.35-2024-02.yaml"), "--set", "series=MG")
NEWER = ("--spec", str(ROOT / f"spec/mwd_motor/{NEW}.yaml"), *MG)
LOG = """\
(1.000000) can0 141#9A00000000000000
(1.000500) can0 141#9A32081364000000
(1.100000) can0 7FF#00
(1.200000) can0 142#9C00000000000000
(1.200300) can0 142#9C320100F4011027
"""


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["monitor", *arguments])


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "bus.log"
    path.write_text(LOG, "ascii")
    return path


def test_a_log_is_played_to_lines(log: Path) -> None:
    result = run(str(log), *EDITION, "--speed", "10")
    assert (result.exit_code, result.stderr) == (0, "")
    head, *lines, status = result.stdout.splitlines()
    assert head.split() == ["node", "command", "direction", "age", "rate", "latency", "values"]
    assert [line.split()[:3] for line in lines] == [
        ["1", "read_status_1", "request"],
        ["1", "read_status_1", "reply"],
        ["2", "read_status_2", "request"],
        ["2", "read_status_2", "reply"],
    ]
    assert lines[1].split("  ")[-1] == "temperature 50 °C, voltage 48.72 V, current 1.0 A, motor_state on, errors []"
    assert "0.50 ms" in lines[1] and "0.30 ms" in lines[3] and "speed 500 °/s" in lines[3]
    assert status.startswith("# ") and status.endswith("5 frames, 1 with foreign ids")


def test_only_what_the_filter_selects_is_printed(log: Path) -> None:
    result = run(str(log), *EDITION, "--speed", "10", "--filter", "node=1", "--filter", "signal=volt")
    assert [line.split("  ")[-1] for line in result.stdout.splitlines()[1:-1]] == ["voltage 48.72 V"]


def test_a_log_is_played_as_fast_as_it_was_recorded(log: Path) -> None:
    """From the first to the last frame are 0.2003 s."""
    start = time.monotonic()
    run(str(log), *EDITION)
    at_once = time.monotonic() - start
    start = time.monotonic()
    run(str(log), *EDITION, "--speed", "0.1")
    assert 2.003 < time.monotonic() - start < 2.003 + 10 * at_once + 5


def test_nodes_of_a_log_are_identified_as_by_decode(log: Path) -> None:
    decoded = CliRunner().invoke(main, ["decode", str(log), "--set", "series=MG"]).stdout
    shown = run(str(log), "--set", "series=MG", "--speed", "100").stdout
    assert decoded.count("speed 500 °/s") == shown.count("speed 500 °/s") == 1
    assert decoded.count("voltage 48.72 V") == shown.count("voltage 48.72 V") == 1


def test_lines_and_a_recording_of_a_bus_of_another_process(tmp_path: Path) -> None:
    """Host, nodes and monitor are three processes; the recording is decoded with the same values."""
    recorded, port = tmp_path / "bus.log", free_port()
    bus = ("-i", "udp_multicast", *port)
    command = (sys.executable, "-m", "canwright", "monitor", "--plain", *NEWER)
    asking = ["request", "read_status_1", "--node", "1..2", *NEWER, "--timeout", "5", *bus]
    pipe = subprocess.PIPE
    with (
        simulated(NEW, "--node", "1..2", *MG, *bus),
        subprocess.Popen(
            [*command, "--record", str(recorded), *bus], text=True, cwd=ROOT, stdout=pipe, stderr=pipe
        ) as process,
    ):
        assert process.stdout
        assert "recording bus.log, 0 frames" in process.stdout.readline()
        assert CliRunner().invoke(main, asking).exit_code == 0
        replies: list[str] = []
        while len(replies) < 2:
            line = process.stdout.readline()
            replies += [line] * ("read_status_1  reply" in line)
        process.send_signal(signal.SIGINT)
        rest, errors = process.communicate()
    assert [line.split()[:3] for line in replies] == [[str(node), "read_status_1", "reply"] for node in (1, 2)]
    assert all(" V," in line for line in replies)
    assert (process.returncode, errors) == (130, "")
    assert "recording bus.log, " in rest
    decoded = CliRunner().invoke(main, ["decode", str(recorded), *NEWER])
    assert decoded.exit_code == 0, decoded.output
    assert decoded.stdout.count(" V, current 0.0 A, motor_state on, errors []") >= 2


def test_a_recording_replaces_no_file(tmp_path: Path) -> None:
    file = tmp_path / "kept.log"
    file.write_text("kept", "ascii")
    result = run("-i", "virtual", "-c", "kept", "--record", str(file))
    says = f"canwright: {file} exists already; choose another name or remove it\n"
    assert (result.exit_code, result.stderr, file.read_text("ascii")) == (2, says, "kept")


@pytest.mark.parametrize("form", [".log", ".asc", ".blf"])
def test_own_frames_and_error_frames_are_recorded(tmp_path: Path, form: str) -> None:
    path = tmp_path / f"bus{form}"
    with can.Bus(form, interface="virtual") as bus, can.Bus(form, interface="virtual") as node:
        receiver = Receiver(bus, {"interface": "virtual", "channel": form}, path)
        receiver.start()
        receiver.send(can.Message(arbitration_id=0x141, data=bytes.fromhex("9A00000000000000"), is_extended_id=False))
        assert node.recv(5)
        node.send(can.Message(arbitration_id=0x141, data=bytes.fromhex("9A32081364000000"), is_extended_id=False))
        node.send(can.Message(is_error_frame=True))
        received = [receiver.recv(5) for _ in range(3)]
        receiver.close()
    assert [message.is_error_frame for message in received if message] == [False, False, True]
    decoded = CliRunner().invoke(main, ["decode", str(path), *EDITION])
    assert "voltage 48.72 V" in decoded.stdout and "answers #0" in decoded.stdout, decoded.output
    assert "error frames: 1" in decoded.stdout.replace("(1)", ": 1"), decoded.output


def test_frames_that_cannot_be_decoded_in_time_are_counted() -> None:
    """All frames that wait are dropped at once, so that those after them are whole exchanges."""
    with can.Bus("full", interface="virtual") as bus, can.Bus("full", interface="virtual") as node:
        receiver = Receiver(bus, {"interface": "virtual", "channel": "full"})
        receiver.start()
        for number in range(QUEUED + 10):
            node.send(can.Message(arbitration_id=0x141, data=[number % 256] * 8, is_extended_id=False))
        first = None
        for _ in range(1000):
            if receiver.table.status(0).dropped:
                first = receiver.recv(1)
                break
            time.sleep(0.01)
        receiver.close()
    assert receiver.table.status(0).dropped == QUEUED
    assert first and first.data[0] == QUEUED % 256


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((), "give either LOG or a bus, such as -i socketcan -c can0"),
        (("-", "-i", "virtual"), "give either LOG or a bus"),
        (("-i", "virtual", "--speed", "2"), "--speed is for LOG, not for a bus"),
        (("-", "--record", "x.log"), "--record is for a bus, not for LOG"),
        (("-i", "virtual", "--record", "x.txt"), "x.txt must end in .asc, .blf, .log"),
        (("-i", "virtual", "--filter", "volt"), "--filter `volt` is not a filter; write it as node=1..2"),
        (("-i", "virtua"), "no bus: "),
        (("-i", "virtual", *EDITION, "--set", "edition=v9"), "--set edition=v9 is not a parameter and its value"),
    ],
)
def test_wrong_arguments_end_with_a_sentence(arguments: tuple[str, ...], says: str) -> None:
    result = run(*arguments)
    assert (result.exit_code, says in result.stderr) == (2, True), result.output


def test_a_lost_bus_ends_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise can.CanOperationError("adapter unplugged")

    monkeypatch.setattr("can.interfaces.virtual.VirtualBus._recv_internal", fail)
    result = run("-i", "virtual", "-c", "lost", *EDITION)
    assert (result.exit_code, result.stderr) == (2, "canwright: the bus does not work any more: adapter unplugged\n")


def test_a_log_without_frames_ends_with_a_sentence(tmp_path: Path) -> None:
    empty = tmp_path / "empty.log"
    empty.write_text("", "ascii")
    for settings in ((), EDITION):
        result = run(str(empty), *settings)
        assert (result.exit_code, "has no frames" in result.stderr) == (2, True), result.output


def test_a_view_without_its_package_says_what_to_install(monkeypatch: pytest.MonkeyPatch, log: Path) -> None:
    """Without a terminal or with `--plain`, the package is not needed."""
    monkeypatch.setitem(sys.modules, "textual", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == "textual" else find_spec(name))
    assert run(str(log), *EDITION, "--speed", "10").exit_code == 0
    monkeypatch.setattr("canwright.cli.monitor.is_terminal", lambda: True)
    assert run(str(log), *EDITION, "--speed", "10", "--plain").exit_code == 0
    says = "canwright: the view, which --plain replaces by lines, needs textual; run: pip install textual\n"
    result = run(str(log), *EDITION)
    assert (result.exit_code, result.stderr) == (2, says)


def test_a_recording_that_fails_ends_and_the_bus_is_read_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with can.Bus("disk", interface="virtual") as bus, can.Bus("disk", interface="virtual") as node:
        receiver = Receiver(bus, {"interface": "virtual", "channel": "disk"}, tmp_path / "full.log")
        assert receiver.recording

        def fail(_: can.Message) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(receiver.recording, "write", fail)
        receiver.start()
        for _ in range(2):
            node.send(can.Message(arbitration_id=0x141, data=bytes(8), is_extended_id=False))
            assert receiver.recv(5)
        assert receiver.recording_error == "the recording ended: [Errno 28] No space left on device"
        assert receiver.recording is None
        receiver.close()


def test_frames_of_unknown_editions_wait_and_this_is_shown() -> None:
    editions = [specification(ROOT / f"spec/mwd_motor/{name}.yaml").edition for name in (OLD, NEW)]
    with can.Bus("wait", interface="virtual") as bus:
        feed = Feed(Receiver(bus, {"interface": "virtual", "channel": "wait"}), editions, [], None)
        assert next(feed.status_parts()).startswith("frames wait until the editions of their nodes are identified")
        feed.close()


def test_editions_are_identified_while_a_bus_is_silent() -> None:
    """After an exchange with each of two nodes, no frame comes that could end the wait."""
    editions = [specification(ROOT / f"spec/mwd_motor/{name}.yaml").edition for name in (OLD, NEW)]
    with can.Bus("silent", interface="virtual") as bus, can.Bus("silent", interface="virtual") as host:
        feed = Feed(Receiver(bus, {"interface": "virtual", "channel": "silent"}), editions, [], None)
        shown: list[int | None] = []
        for node in (1, 2):
            for id_, data in ((0x140 + node, "9A00000000000000"), (0x180 + node, "9A32081364000000")):
                host.send(can.Message(arbitration_id=id_, data=bytes.fromhex(data), is_extended_id=False))
            for _ in range(1000):
                shown = [entry.node for entry in feed.table.entries()]
                if shown.count(node) == 2:
                    break
                time.sleep(0.01)
        feed.close()
    assert shown == [1, 1, 2, 2]
