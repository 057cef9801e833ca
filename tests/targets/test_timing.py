"""When frames are sent: every output states the period, the time-out and the occasions of `tests/specs/pack`."""

from __future__ import annotations

import importlib
import json
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import cantools
import pytest
from canwright.cli import main
from click.testing import CliRunner

from ..node import run
from ..spec_texts import ROOT

SPEC = ROOT / "tests/specs/pack/v1.yaml"
STATED: Mapping[str, tuple[tuple[str, ...], float | None, float | None]] = {
    "read_state_reply": (("cyclic", "on_request"), 100, 500),
    "cells_reply": (("cyclic", "on_change"), 2.5, None),
    "alarm_reply": (("on_change", "event"), None, None),
    "discover_reply": (("on_request", "event"), None, None),
    "limit_request": ((), None, 1000),
    "feed_request": (("cyclic",), 50, 200),
    "read_state_request": ((), None, None),
}
"""Occasions, period and time-out in ms of each message, as its section of the spec states."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pack")
    done = CliRunner().invoke(main, ["generate", "--spec", str(SPEC), "--out", str(path)])
    assert done.exit_code == 0, done.output
    return path


@pytest.fixture(scope="module")
def modules(folder: Path) -> Iterator[tuple[Any, Any]]:
    """The modules of the edition: classes of messages, and columns."""
    places = [str(folder / "python"), str(folder / "columns")]
    sys.path[:0] = places
    try:
        yield importlib.import_module("pack.v1"), importlib.import_module("pack_columns.v1")
    finally:
        sys.path[:] = [place for place in sys.path if place not in places]


def test_macros_of_c(folder: Path) -> None:
    header = (folder / "c/include/pack/v1.h").read_text("utf-8")
    macros = {
        name: int(value) for name, value in re.findall(r"#define PACK_V1_(\w+_(?:EVERY|TIMEOUT)_US) +(\d+)u", header)
    }
    assert macros == {
        f"{name.upper()}_{what}_US": round(time * 1000)
        for name, (_, every, timeout) in STATED.items()
        for what, time in (("EVERY", every), ("TIMEOUT", timeout))
        if time is not None
    }


def test_attributes_of_python_and_columns(modules: tuple[Any, Any]) -> None:
    python, columns = modules
    rows = {f"{m.command}_{m.direction.name.lower()}": (m.sent, m.every_ms, m.timeout_ms) for m in columns.MESSAGES}
    for name, stated in STATED.items():
        message = getattr(python, "".join(part.capitalize() for part in name.split("_")))
        assert stated == (message.SENT, message.EVERY_MS, message.TIMEOUT_MS), name
        assert rows[name] == stated


def test_descriptions_of_javascript(folder: Path) -> None:
    module = next((folder / "javascript").rglob("pack/v1.js"))
    program = f"import {{ MESSAGES }} from {json.dumps(module.as_uri())}; console.log(JSON.stringify(MESSAGES));"
    described = {f"{m['command']}_{m['direction']}": m for m in json.loads(run(program))}
    for name, (sent, every, timeout) in STATED.items():
        stated = {"sent": list(sent) or None, "everyMs": every, "timeoutMs": timeout}
        assert {key: described[name].get(key) for key in stated} == stated


def dbc(folder: Path) -> Path:
    (file,) = folder.rglob("*.dbc")
    return file


def test_attributes_of_dbc(folder: Path) -> None:
    database = cantools.database.can.Database()
    database.add_dbc_file(dbc(folder))
    messages = {id_: database.get_message_by_frame_id(id_) for id_ in (0x182, 0x201, 0x284, 0x303, 0x102, 0x381, 0x080)}
    assert {id_: (message.send_type, message.cycle_time) for id_, message in messages.items()} == {
        0x182: ("CyclicAndOnRequest", 100),
        0x201: ("CyclicAndOnChange", None),
        0x284: ("OnChangeAndEvent", None),
        0x303: ("OnRequestAndEvent", None),
        0x102: ("Event", None),
        0x381: ("Event", None),
        0x080: ("Cyclic", 50),
    }
    comments = {id_: database.get_message_by_frame_id(id_ + 1).comment for id_ in (0x180, 0x200, 0x380)}
    assert comments == {
        0x180: "Read state: reply. Timing: every 100 ms, on request, time-out 500 ms.",
        0x200: "Cells: reply. Timing: every 2.5 ms, on change.",
        0x380: "Limit: command. Timing: time-out 1000 ms.",
    }


SHARED_ID = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..2}}
selector: {at: 0, raw: u8}
commands:
  beat: {code: 1, request: none, reply: {layout: {state: {at: 1, raw: u8}}, every_ms: 100}}
  hours: {code: 2, request: none, reply: {layout: {hours: {at: 1, raw: u8}}, every_ms: 1000}}
"""


def test_periods_that_differ_on_one_id_are_in_the_comment_of_a_dbc(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(SHARED_ID, "utf-8")
    arguments = ["generate", "--spec", str(tmp_path / "lamp.yaml"), "--target", "dbc", "--out", str(tmp_path / "out")]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    database = cantools.database.can.Database()
    database.add_dbc_file(dbc(tmp_path / "out"))
    message = database.get_message_by_frame_id(0x101)
    assert (message.send_type, message.cycle_time) == ("Event", None)
    assert message.comment == "Lamp: reply. beat: every 100 ms. hours: every 1000 ms."


@pytest.mark.interop("canmatrix")
def test_another_reader_of_dbc(folder: Path) -> None:
    from canmatrix import formats

    (matrix,) = formats.loadp(str(dbc(folder))).values()
    times = {frame.arbitration_id.id: frame.cycle_time for frame in matrix.frames}
    assert {id_: times[id_] for id_ in (0x182, 0x080, 0x201)} == {0x182: 100, 0x080: 50, 0x201: 0}


@pytest.mark.parametrize(
    ("language", "text"),
    [("en", "every 100 ms, on request, time-out 500 ms"), ("zh", "每 100 ms，请求时，超时 500 ms")],
)
def test_documents(folder: Path, language: str, text: str) -> None:
    page = (folder / f"docs/{language}/v1/commands/read_state.md").read_text("utf-8")
    assert f"| {text} |" in page


def test_bus_load_counts_cyclic_frames(folder: Path) -> None:
    page = (folder / "docs/en/bus-load-calculator.html").read_text("utf-8")
    (data,) = json.loads(page.partition('id="data">')[2].partition("</script>")[0])
    assert [(frame["name"], frame["everyMs"], frame["perNode"]) for frame in data["cyclic"]] == [
        ("feed_request", 50, False),
        ("read_state_reply", 100, True),
        ("cells_reply", 2.5, True),
    ]


def test_dissector_and_show(folder: Path) -> None:
    text = "every 100 ms, on request, time-out 500 ms"
    assert f'sending = "{text}"' in (folder / "wireshark/pack.lua").read_text("utf-8")
    shown = CliRunner().invoke(main, ["show", "read_state", "--spec", str(SPEC)]).output
    assert text in " ".join(shown.split())
