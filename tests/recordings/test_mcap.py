"""`canwright decode --format mcap`: the file has the rows of JSON Lines, and viewers can read it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any, NamedTuple

import pytest
from canwright.model import formatting
from canwright.model.edition import Edition
from canwright.project.loader import specification
from canwright.recordings import mcap_file
from jsonschema import Draft202012Validator

from ..spec_texts import MINIMAL, WITHOUT_SETTINGS_IN_IDS, called
from .test_decode import BOTH_V2_35, EARLY, MIXED, SETTINGS, V2_35, decode, golden_of, run

pytestmark = pytest.mark.interop("mcap")


class Read(NamedTuple):
    """A message as a reader of `mcap` gives it."""

    topic: str
    schema: dict[str, Any]
    time: int
    content: dict[str, Any]


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def messages(log: str, *options: str, status: int | None = 0) -> list[Read]:
    """The messages of the file that `decode` writes."""
    decode(log, *options, "--format", "mcap", "--out", "bus.mcap", status=status)
    with Path("bus.mcap").open("rb") as file:
        return [*read(file)]


def read(file: IO[bytes]) -> Iterator[Read]:
    from mcap.reader import make_reader

    for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages(log_time_order=False):
        assert schema is not None and (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        assert message.publish_time == message.log_time
        yield Read(channel.topic, json.loads(schema.data), message.log_time, json.loads(message.data))


def rows(log: str, *options: str) -> list[dict[str, Any]]:
    """The rows of JSON Lines that are a message."""
    lines = decode(log, *options, "--format", "jsonl", status=None).stdout.splitlines()
    return [row for row in map(json.loads, lines) if row["command"] is not None]


def content_of(row: dict[str, Any]) -> dict[str, Any]:
    """The message that has the facts of a row of JSON Lines."""
    frame = {name: fact for name, fact in row.items() if name not in ("frame", "fields", "rejection")}
    fields = {re.sub(r"\[(\d+)\]", r"_\1", name): field for name, field in row["fields"].items()}
    values = {name: field["value"] for name, field in fields.items() if field["value"] is not None}
    return {
        **{name: "|".join(value) if isinstance(value, list) else value for name, value in values.items()},
        "raw": {name: field["raw"] for name, field in fields.items()},
        "frame": {name: fact for name, fact in frame.items() if fact is not None},
    }


def joined_width(edition: Edition, message: dict[str, Any], name: str) -> int:
    """The bits of an element of a field whose elements are one value."""
    of_command = (m for m in edition.all_messages() if m.command == message["frame"]["command"])
    fields = (field for m in of_command for field in m.layout.fields if field.name == name)
    return next(field.type.joined.width for field in fields if field.type.joined)


def with_whole_raws(edition: Edition, message: dict[str, Any]) -> dict[str, Any]:
    """A message with the raw integer of joined elements as JSON Lines has it."""
    raws = {}
    for name, raw in message["raw"].items():
        width = joined_width(edition, message, name) if isinstance(raw, list) else 0
        elements: Sequence[int] = raw if isinstance(raw, list) else [raw]
        raws[name] = sum(element << width * n for n, element in enumerate(reversed(elements)))
    return {**message, "raw": raws}


@pytest.mark.parametrize("file", WITHOUT_SETTINGS_IN_IDS, ids=called)
def test_messages_of_golden_frames_are_the_rows_of_json_lines(file: Path) -> None:
    """Of all specs, on two buses, once with the parameters of the nodes and once without."""
    edition, golden = golden_of(file)
    log = "".join(
        f"(1700000000.{number:06}) can{number % 2} {formatting.sent(entry)}\n" for number, entry in enumerate(golden)
    )
    known = [f"--set={p.name}={p.values[-1].name if p.values else p.minimum or 1}" for p in edition.parameters]
    for settings in ([], known):
        options = ("--spec", str(file), f"--set=edition={edition.name}", *settings)
        written, expected = messages(log, *options, status=None), rows(log, *options)
        assert [with_whole_raws(edition, each.content) for each in written] == [*map(content_of, expected)] != []
        assert [each.time for each in written] == [1700000000 * 10**9 + row["number"] * 1000 for row in expected]
        for each in written:
            Draft202012Validator(each.schema).validate(each.content)
        assert {each.content["frame"]["bus"] for each in written} == {"can0", "can1"}


def test_each_node_and_layout_of_two_buses_has_a_topic() -> None:
    written = messages(MIXED, *SETTINGS, "--set", "series=MG")
    assert [(each.topic, each.time) for each in written] == [
        ("/can0/mwd_motor/node1/set_torque_request", 1_000_000_000),
        ("/can1/mwd_motor/node3/read_status_1_request", 1_000_100_000),
        ("/can0/mwd_motor/node1/motion_feedback", 1_000_200_000),
        ("/can1/mwd_motor/node3/status_1", 1_000_250_000),
        ("/can0/mwd_motor/node2/read_status_1_request", 1_001_000_000),
        ("/can0/mwd_motor/node2/status_1", 1_001_200_000),
    ]
    assert written[3].content == {
        "temperature": 50,
        "voltage": 48.72,
        "current": 1.0,
        "motor_state": "on",
        "errors": "",
        "raw": {"temperature": 50, "voltage": 4872, "current": 100, "motor_state": 0, "errors": 0},
        "frame": {
            "number": 3,
            "time": 1.00025,
            "bus": "can1",
            "node": 3,
            "edition": "v2.36-2025-03",
            "direction": "reply",
            "decided_by": "id",
            "command": "read_status_1",
            "request": 1,
            "latency_ms": 0.15,
        },
    }
    voltage = {"type": "number", "title": "Supply voltage (V)", "unit": "V"}
    assert written[3].schema["properties"]["voltage"] == voltage
    assert written[3].schema["properties"]["motor_state"]["enum"] == ["on", "off"]


@pytest.mark.parametrize("file", WITHOUT_SETTINGS_IN_IDS, ids=called)
def test_viewers_read_the_schema_of_every_layout(file: Path) -> None:
    """They refuse a property with several types, or none, and a path needs quotes if a name has other characters."""
    for layout in {message.layout: None for message in specification(file).edition.all_messages()}:
        schema = mcap_file.schema_of(layout, mcap_file.properties_of(layout))
        Draft202012Validator.check_schema(schema)
        assert {*types_of(schema)} <= {"object", "number", "integer", "string", "array"}


def types_of(schema: dict[str, Any]) -> Iterator[str]:
    assert isinstance(schema["type"], str)
    yield schema["type"]
    for name, item in schema.get("properties", {}).items():
        assert re.fullmatch(r"[A-Za-z0-9_-]+", name)
        yield from types_of(item)
    if schema["type"] == "array":
        yield from types_of(schema["items"])


def test_names_that_a_message_has_for_other_things() -> None:
    body = "{raw: {at: 1, raw: u8}, frame: {at: 2, raw: u8}, a: {at: 3, raw: u8, array: 1..2}, a_1: {at: 5, raw: u8}}"
    Path("lamp.yaml").write_text(MINIMAL.replace("{level: {at: 2, type: level}}", body), "utf-8")
    (message,) = messages("(1.0) can0 101#1007060102030000\n", "--spec", "lamp.yaml")
    names = {"raw_": 7, "frame_": 6, "a_1": 1, "a_2": 2, "a_1_": 3}
    assert message.content == {**names, "raw": names, "frame": message.content["frame"]}
    assert message.content["frame"]["command"] == "dim"


def test_names_of_buses_that_a_topic_cannot_have() -> None:
    buses = ["##[error]\u202e", "a/../b", "a_2F_b", "a/b", '"', "总线", "总钱", "a.b", "can0"]
    log = "".join(f"({n}.0) {bus} 101#1000640000000000\n" for n, bus in enumerate(buses))
    Path("lamp.yaml").write_text(MINIMAL, "utf-8")
    written = messages(log, "--spec", "lamp.yaml")
    assert [each.topic.replace("/lamp/node1/dim", "") for each in written] == [
        "/_23__23__5B_error_5D__202E_",
        "/a_2F__2E__2E__2F_b",
        "/a_2F_b",
        "/a_2F_b_",
        "/_22_",
        "/_603B__7EBF_",
        "/_603B__94B1_",
        "/a_2E_b",
        "/can0",
    ]
    assert written[0].content["frame"]["bus"] == "#[U+0023][error][U+202E]"
    assert written[3].content["frame"]["bus"] == "a/b"


def test_a_log_without_names_of_buses_and_a_layout_of_no_node() -> None:
    (message,) = messages("t280864009CFFC8000000\r", "--spec", str(V2_35))
    assert message.topic == "/mwd_motor/broadcast_torque_request"
    assert "node" not in message.content["frame"]


def test_times_that_a_file_cannot_have() -> None:
    """They are those of the frame before, and at first 0."""
    result = decode(EARLY, *SETTINGS, "--format", "mcap", "--out", "bus.mcap")
    assert "bus.mcap: 4 frames without a time, or with a negative one, at the time of the frame before" in result.stdout
    with Path("bus.mcap").open("rb") as file:
        written = [*read(file)]
    assert [(each.time, each.content["frame"]["time"]) for each in written][2:] == [(0, -0.5), (0, -0.49975)]
    log = "(2.0) can0 142#9A00000000000000\n(1.2.3) can0 142#9A3200E701000000\n"
    written = messages(log, *SETTINGS, status=1)
    assert [(each.time, each.content["frame"].get("time")) for each in written] == [(2 * 10**9, 2.0), (2 * 10**9, None)]


def test_a_node_whose_edition_changes_has_another_topic() -> None:
    """Two editions fit until a reply of the stream shows which it is; their layouts differ."""
    torque = "(1.0) can0 141#A10000009B000000\n(1.0001) can0 141#A1329B00F4010080\n"
    status = "(3.0) can0 141#9A00000000000000\n(3.0001) can0 141#9A32081364000000\n"
    log = torque * 2000 + status * 500 + torque
    run("-", *BOTH_V2_35, "--format", "mcap", "--out", "bus.mcap", stdin=log, status=None)
    with Path("bus.mcap").open("rb") as file:
        editions = {each.topic: each.content["frame"]["edition"] for each in read(file) if "feedback" in each.topic}
    assert editions == {
        "/can0/mwd_motor/node1/motion_feedback": "v2.35|v2.35-2024-02",
        "/can0/mwd_motor/node1/motion_feedback_": "v2.35-2024-02",
    }


def test_a_file_is_the_same_each_time_and_in_chunks() -> None:
    """It names no version, so equal logs give equal files; a long log is written while it is read."""
    from mcap.reader import make_reader

    decode(MIXED * 800, *SETTINGS, "--format", "mcap", "--out", "1.mcap")
    decode(MIXED * 800, *SETTINGS, "--format", "mcap", "--out", "2.mcap")
    assert Path("1.mcap").read_bytes() == Path("2.mcap").read_bytes()
    with Path("1.mcap").open("rb") as file:
        reader = make_reader(file)
        assert (reader.get_header().library, reader.get_header().profile) == ("canwright", "")
        summary = reader.get_summary()
    assert summary and summary.statistics
    assert (summary.statistics.message_count, summary.statistics.channel_count) == (4800, 6)
    assert len(summary.chunk_indexes) > 1


def test_a_file_that_cannot_be_complete_is_not_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mcap_file, "MAX_TOPICS", 5)
    Path("bus.mcap").write_text("before", "utf-8")
    result = decode(MIXED, *SETTINGS, "--format", "mcap", "--out", "bus.mcap", status=2)
    assert result.stderr.endswith(
        "the log has more than 5 pairs of a node and a layout, and an MCAP file no more topics; "
        "use --format jsonl or parquet\n"
    )
    assert Path("bus.mcap").read_text("utf-8") == "before"
    assert sorted(path.name for path in Path().iterdir()) == ["bus.log", "bus.mcap"]
