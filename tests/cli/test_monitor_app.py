"""The view of `canwright monitor`, with Textual's Pilot, on a virtual bus with simulated nodes."""

from __future__ import annotations

import asyncio
import contextlib
import html
import re
import threading
from collections.abc import Callable, Coroutine, Iterator
from pathlib import Path
from typing import Any

import can
import pytest
from canwright.cli.monitor_app import MonitorApp, ValueTable
from canwright.cli.monitor_feed import Feed, Player, Receiver
from canwright.cli.monitor_send import edition_of
from canwright.cli.monitor_view import cells
from canwright.cli.node_settings import bus_of
from canwright.project.loader import specification
from canwright.recordings.nodes import Choice, Nodes
from canwright.recordings.readers import open_log
from canwright.recordings.results import Place
from textual.pilot import Pilot
from textual.widgets import Static

from ..spec_texts import ROOT
from .live import NEW, answering
from .monitor_picture import PICTURE, picture
from .test_monitor import LOG

WAIT = 20
"""The longest time in seconds to wait for what the view shows."""
SPEC = specification(ROOT / f"spec/mwd_motor/{NEW}.yaml")
READ = can.Message(arbitration_id=0x141, data=bytes.fromhex("9A00000000000000"), is_extended_id=False)
Use = Callable[[Pilot[None]], Coroutine[Any, Any, None]]


@contextlib.contextmanager
def monitored(channel: str, written: str = "") -> Iterator[MonitorApp]:
    """The view of a bus on which a host asks nodes 1 and 2 for their state ten times a second."""
    with nodes_and_view(channel, written) as (_, app):
        yield app


@contextlib.contextmanager
def nodes_and_view(channel: str, written: str = "") -> Iterator[tuple[Any, MonitorApp]]:
    """The simulated nodes, and the view."""
    editions, settings = bus_of([SPEC.edition], ["series=MG", "encoder_bits=14"])
    ended = threading.Event()

    def ask() -> None:
        with can.Bus(channel, interface="virtual") as bus:
            number = 0
            while not ended.wait(0.05):
                number += 1
                bus.send(can.Message(arbitration_id=0x141 + number % 2, data=READ.data, is_extended_id=False))

    with contextlib.ExitStack() as stack:
        nodes = stack.enter_context(answering("v2_36_2025_03", channel, voltage=48.72))
        bus = stack.enter_context(can.Bus(channel, interface="virtual"))
        host = threading.Thread(target=ask, daemon=True)
        host.start()
        stack.callback(host.join)
        stack.callback(ended.set)
        feed = Feed(Receiver(bus, {"interface": "virtual", "channel": channel}), editions, settings, 1_000_000)
        stack.callback(feed.close)
        yield nodes, MonitorApp(feed, [SPEC], written)


def run(app: MonitorApp, use: Use, width: int = 160) -> None:
    async def piloted() -> None:
        async with app.run_test(size=(width, 24)) as pilot:
            await use(pilot)

    asyncio.run(piloted())


def screen(app: MonitorApp) -> list[str]:
    """The lines of the table on the screen."""
    table = app.query_one(ValueTable)
    return [table.render_line(y).text.rstrip() for y in range(table.size.height)]


def text_of(app: MonitorApp, name: str) -> str:
    return str(app.query_one(f"#{name}", Static).render())


async def until(pilot: Pilot[None], is_met: Callable[[], bool]) -> None:
    for _ in range(20 * WAIT):
        if is_met():
            return
        await pilot.pause(0.05)
    raise AssertionError([screen(pilot.app), text_of(pilot.app, "status"), text_of(pilot.app, "message")])  # type: ignore[arg-type]


async def write(pilot: Pilot[None], key: str, text: str) -> None:
    """Presses a key, and answers its question."""
    await pilot.press(key)
    pilot.app.query_one("Input").value = text  # type: ignore[attr-defined]
    await pilot.press("enter")


@pytest.mark.parametrize("width", [80, 160])
def test_values_are_shown_with_age_rate_and_latency(width: int) -> None:
    with monitored(f"values-{width}") as app:

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: all("/s" in screen(app)[y] and " ms" in screen(app)[y] for y in (2, 8)))
            shown = screen(app)
            assert shown[0].split() == ["node", "command", "signal", "value", "age", "rate", "latency"]
            assert shown[1].split()[:3] == ["1", "read_status_1", "request"]
            assert shown[2].split()[2:6] == ["reply", "temperature", "0", "°C"]
            assert shown[2].endswith(" ms") and shown[3].split() == ["voltage", "48.72", "V"]
            assert shown[7].split()[:3] == ["2", "read_status_1", "request"]
            assert all(len(line) <= width for line in shown)
            await until(pilot, lambda: "load at most 0." in text_of(app, "status"))

        run(app, use, width)


def test_a_filter_is_changed_and_a_wrong_filter_is_explained() -> None:
    with monitored("filter", "node=2") as app:

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])
            assert {line.split()[0] for line in screen(app) if "read_status_1" in line} == {"2"}
            await write(pilot, "slash", "signal=volt")
            await until(pilot, lambda: "48.72" in screen(app)[2])
            assert len([line for line in screen(app) if line]) == 3  # the heading, and a value of each node
            assert "filter signal=volt" in text_of(app, "status")
            await write(pilot, "slash", "volt")
            assert text_of(app, "message").startswith("`volt` is not a filter; write it as node=1..2")
            assert "filter signal=volt" in text_of(app, "status")
            await pilot.press("slash", "x", "escape")
            assert text_of(app, "message") == ""

        run(app, use)


def test_a_pause_stops_the_view_but_not_the_count() -> None:
    with monitored("pause") as app:

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])
            await pilot.press("space")
            before, shown = text_of(app, "status"), screen(app)
            assert before.startswith("PAUSED | ")
            await until(pilot, lambda: text_of(app, "status") != before)
            assert screen(app) == shown
            await pilot.press("space")
            await until(pilot, lambda: screen(app) != shown)
            assert "PAUSED" not in text_of(app, "status")

        run(app, use)


def test_a_recording_has_a_sign_and_replaces_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "monitor-1.log").write_text("kept", "ascii")
    with monitored("record") as app:

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])
            await write(pilot, "r", "monitor-1.log")
            assert "`monitor-1.log` exists already" in text_of(app, "message")
            await write(pilot, "r", "bus.txt")
            assert "must end in .asc, .blf, .log" in text_of(app, "message")
            assert "●" not in text_of(app, "status")
            await pilot.press("r", "enter")
            await until(pilot, lambda: "recording monitor-2.log, " in text_of(app, "status"))
            assert text_of(app, "status").startswith(" ●  ")
            await until(pilot, lambda: "log, 0" not in text_of(app, "status"))
            await pilot.press("r")
            assert text_of(app, "message").startswith("recorded ")
            assert "●" not in text_of(app, "status")

        run(app, use)
    assert (tmp_path / "monitor-1.log").read_text("ascii") == "kept"
    with open_log(str(tmp_path / "monitor-2.log")) as log:
        assert {frame.frame.id for frame in log} <= {0x141, 0x142, 0x181, 0x182}


def test_a_log_is_played_and_its_pause_stops_the_clock(tmp_path: Path) -> None:
    path = tmp_path / "bus.log"
    path.write_text(LOG, "ascii")
    old = specification(ROOT / "spec/mwd_motor/v2.35-2024-02.yaml")
    editions, settings = bus_of([old.edition], ["series=MG"])
    with open_log(str(path)) as log, contextlib.closing(Feed(Player(log, 0.1), editions, settings, None)) as feed:
        app = MonitorApp(feed, [old], "")

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])
            await pilot.press("space")
            stopped = feed.source.now()
            await pilot.pause(0.3)
            assert feed.source.now() == stopped
            await write(pilot, "r", "")
            assert text_of(app, "message") == "a log is not recorded again"
            await pilot.press("space")
            await until(pilot, lambda: "end of the log" in text_of(app, "status"))
            assert "500 °/s" in "".join(screen(app))
            await pilot.press("q")

        run(app, use)


def test_a_lost_bus_ends_the_view(monkeypatch: pytest.MonkeyPatch) -> None:
    with monitored("lost") as app:

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])

            def fail(*_: object, **__: object) -> None:
                raise can.CanOperationError("adapter unplugged")

            source = app._feed.source
            assert isinstance(source, Receiver)
            monkeypatch.setattr(source._can, "_recv_internal", fail)
            for _ in range(20 * WAIT):
                if not app.is_running:
                    break
                await pilot.pause(0.05)

        run(app, use)
        assert app._feed.error == "the bus does not work any more: adapter unplugged"


def test_only_visible_lines_become_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "bus.log"
    lines = (f"({1 + node / 1000:.6f}) can0 {0x140 + node:X}#9A32081364000000\n" for node in range(1, 33))
    path.write_text("".join(lines), "ascii")
    old = specification(ROOT / "spec/mwd_motor/v2.35-2024-02.yaml")
    editions, settings = bus_of([old.edition], ["series=MG"])
    with open_log(str(path)) as log, contextlib.closing(Feed(Player(log, 1), editions, settings, None)) as feed:
        app = MonitorApp(feed, [old], "")
        made: list[object] = []

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: feed.ended.is_set())
            app.renew()
            await pilot.pause()

            def counted(*arguments: Any, **named: Any) -> Any:
                made.append(arguments)
                return cells(*arguments, **named)

            monkeypatch.setattr("canwright.cli.monitor_app.cells", counted)
            table = app.query_one(ValueTable)
            assert table.virtual_size.height == 1 + 32 * 5
            await pilot.press("end")
            await until(pilot, lambda: "32" in screen(app)[-5] or "errors" in screen(app)[-1])
            made.clear()
            app.renew()
            await pilot.pause(0.1)
            assert 0 < len(made) <= 3 * 24

        run(app, use)


def test_a_command_is_sent_with_typed_consent_only() -> None:
    with nodes_and_view("send") as (nodes, app):

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])
            before = dict(nodes[1].values)
            await write(pilot, "s", "1 set_torque iq=2.5")
            await until(pilot, lambda: "type motion" in text_of(app, "message"))
            asked = text_of(app, "message")
            assert asked.startswith("SetTorqueRequest(node=1, iq=2.49755859375, ")
            assert asked.endswith("was not sent. The motor moves. To allow this, type motion")
            for refusal in ("wear", "", "Motion"):
                app.query_one("Input").value = refusal  # type: ignore[attr-defined]
                await pilot.press("enter")
                assert text_of(app, "message") == "nothing was sent"
                await write(pilot, "s", "1 set_torque iq=2.5")
                await until(pilot, lambda: "type motion" in text_of(app, "message"))
            await pilot.press("escape")
            await pilot.pause(0.3)
            assert not any("set_torque" in line for line in screen(app))
            assert nodes[1].values == before
            await write(pilot, "s", "1 set_torque iq=2.5")
            await until(pilot, lambda: "type motion" in text_of(app, "message"))
            await pilot.press(*"motion", "enter")
            await until(pilot, lambda: "was sent" in text_of(app, "message"))
            assert text_of(app, "message") == "set_torque was sent, 1 reply; to stop: 1 motor_stop"
            await until(pilot, lambda: sum("set_torque" in line for line in screen(app)) == 2)

        run(app, use)


def test_what_cannot_be_sent_is_explained_and_a_read_needs_no_consent() -> None:
    with monitored("explained") as app:

        async def use(pilot: Pilot[None]) -> None:
            await until(pilot, lambda: "48.72" in screen(app)[3])
            for text, says in (
                ("1", "write nodes, command and values, such as 1 dim level=50"),
                ("a read_status_1", "`a` is not a node; write nodes as 5,7 or 1..8"),
                ("99 read_status_1", f"mwd_motor {NEW} has no node 99"),
                ("1 read_status_4", "there is no command `read_status_4`; did you mean"),
                ("1 set_torque iq=40", "; it takes -33..33 A"),
                ("1 set_torque iq", "`iq` is not a value; write FIELD=VALUE"),
                ("1..2 read_multi_turn_angle", "read_multi_turn_angle was sent, 2 replies"),
                ("9 read_status_1", "no reply to ReadStatus1Request(node=9)"),
            ):
                await write(pilot, "s", text)
                await until(pilot, lambda says=says: says in text_of(app, "message"))  # type: ignore[misc]
            await until(pilot, lambda: sum("read_multi_turn_angle" in line for line in screen(app)) == 4)

        run(app, use)


def test_an_unknown_edition_is_not_guessed() -> None:
    old, new = specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition, SPEC.edition
    nodes = Nodes([old, new], [])
    for known in (None, nodes):
        with pytest.raises(ValueError, match=r"^the edition of node 1 is unknown; start with --set edition=NAME$"):
            edition_of(known, "can0", 1)
    nodes.choose("can0", 1, Choice(Place(0, None), old, (new,)))
    with pytest.raises(ValueError, match=rf"^v2.35\|{NEW} fit node 1; start with --set 1:edition=NAME$"):
        edition_of(nodes, "can0", 1)
    nodes.choose("can0", 2, Choice(Place(0, None), old))
    assert edition_of(nodes, "can0", 2) is old
    assert edition_of(Nodes([new], [], new), "can0", 1) is new


def test_the_picture_of_the_readme_shows_the_view() -> None:
    """Its words: what else is in the picture differs between versions of Textual."""
    made = picture()
    assert made == picture()
    assert words(PICTURE.read_text("utf-8")) == words(made), "run: python -m tests.cli.monitor_picture"
    assert "48.31 V" in " ".join(words(made))


def words(svg: str) -> list[str]:
    """The texts of a picture in their order."""
    texts = re.findall(r"<text [^>]*>([^<]*)</text>", svg)
    return " ".join(html.unescape(text) for text in texts).split()
