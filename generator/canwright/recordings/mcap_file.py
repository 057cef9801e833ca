"""Rows as MCAP: one topic for each node and layout, its messages in JSON, and their schema with titles and units."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import IO, Any, NamedTuple

from ..model.edition import Edition
from ..model.formatting import english
from ..model.joined import JoinedText
from ..model.layout import Layout
from ..model.message import Message
from ..targets.columns.view import free_name, tables_of
from .exports import OF_FRAME, bus_name
from .log_frame import LogError
from .packages import require
from .rows import Cell, Column, Row, columns, elements

MAX_TOPICS = (1 << 16) - 1
"""The maximum number of topics: a file has 16 bits for the number of each."""

_FRAME = {
    "number": {"type": "integer"},
    "time": {"type": "number", "unit": "s"},
    "bus": {"type": "string"},
    "node": {"type": "integer"},
    "edition": {"type": "string"},
    "direction": {"type": "string"},
    "decided_by": {"type": "string"},
    "command": {"type": "string"},
    "request": {"type": "integer"},
    "latency_ms": {"type": "number", "unit": "ms"},
}
"""The schema of what is known of a frame, with the names of JSON Lines."""


class McapFile:
    """A file with a topic for each node and layout, such as `/can0/FAMILY/node1/LAYOUT`. Rows without a message are not written.

    A message has the values of fields, `raw` with their raw integers, and `frame`. What has no value is left out: viewers
    read a schema only if each property has one type, so none can be null. Elements of arrays are properties of their own,
    `level_1`, and flags are one text, `hot|stalled`. `_` is appended to a name that is taken.

    A frame without a time, or with one before 1970, has the time of the frame before it; `untimed` counts them. Raises
    MissingPackageError, and LogError for more topics than a file can have.
    """

    def __init__(self, file: IO[bytes]) -> None:
        require("mcap", "mcap", "MCAP")
        from mcap.writer import Writer

        self._writer = Writer(file)
        self._writer.start(library="canwright")
        self._topics: dict[tuple[str, int | None, Layout], tuple[int, Mapping[str, str]]] = {}
        """The number of each topic in the file, and the properties of its columns."""
        self._names: set[str] = set()
        self._schemas: dict[Layout, _Schema] = {}
        self._time = 0
        self.untimed = 0

    def write(self, row: Row) -> None:
        (time, bus, _, _), _, node, edition, _, _, message, *_ = row.judged
        if message is None or edition is None:
            return
        known = self._topics.get((bus, node, message.layout))
        channel, properties = known or self._topic(bus, node, edition, message)
        if time is None or time < 0:
            self.untimed += 1
        else:
            self._time = time
        data = _json(_content(row, properties))
        self._writer.add_message(channel, log_time=self._time, data=data, publish_time=self._time)

    def close(self) -> None:
        self._writer.finish()

    def _topic(self, bus: str, node: int | None, edition: Edition, message: Message) -> tuple[int, Mapping[str, str]]:
        if len(self._topics) == MAX_TOPICS:
            raise LogError(
                f"the log has more than {MAX_TOPICS} pairs of a node and a layout, and an MCAP file no more topics; "
                "use --format jsonl or parquet"
            )
        schema = self._schemas.get(message.layout) or self._schema(edition, message.layout)
        parts = [_identifier(bus), edition.family, "" if node is None else f"node{node}", schema.table]
        name = free_name("".join(f"/{part}" for part in parts if part), self._names)
        origin = {"bus": bus_name(bus), "family": edition.family, "edition": edition.name, "spec": edition.hash}
        channel: int = self._writer.register_channel(name, "json", schema.number, origin)
        self._topics[bus, node, message.layout] = topic = channel, schema.properties
        return topic

    def _schema(self, edition: Edition, layout: Layout) -> _Schema:
        table, properties = tables_of(edition)[layout], properties_of(layout)
        name, text = f"{edition.family}/{edition.name}/{table}", _json(schema_of(layout, properties))
        number = self._writer.register_schema(name, "jsonschema", text)
        self._schemas[layout] = schema = _Schema(number, table, properties)
        return schema


class _Schema(NamedTuple):
    """The number of a schema in the file, the name of its layout, and the properties of columns by name."""

    number: int
    table: str
    properties: Mapping[str, str]


def _json(content: object) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode()


def _identifier(bus: str) -> str:
    """The name of a bus in a topic: viewers write paths of letters, digits, `_` and `-`. `a 1` is `a_20_1`."""
    return re.sub(r"[^A-Za-z0-9_-]", lambda character: f"_{ord(character[0]):X}_", bus)


def _columns(layout: Layout) -> Iterable[Column]:
    return (column for field in layout.given for column in columns(field))


def properties_of(layout: Layout) -> Mapping[str, str]:
    """The properties of the columns of a layout, by the names of the columns."""
    taken = {"frame", "raw"}
    names = [column.name for column in _columns(layout)]
    return {name: free_name(re.sub(r"\[(\d+)\]", r"_\1", name), taken) for name in names}


def schema_of(layout: Layout, properties: Mapping[str, str]) -> dict[str, Any]:
    """The JSON schema of the messages of a layout."""
    listed = [(properties[column.name], column) for column in _columns(layout)]
    values = {name: _value_schema(column) for name, column in listed}
    integer = {"type": "integer"}
    raws = {name: {"type": "array", "items": integer} if c.field.type.joined else integer for name, c in listed}
    parts = {"raw": _object("Raw integers", raws), "frame": _object("Frame", _FRAME)}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **_object(english(layout.title), {**values, **parts}),
    }


def _object(title: str, properties: Mapping[str, object]) -> dict[str, object]:
    return {"type": "object", "title": title, "properties": properties, "additionalProperties": False}


def _value_schema(column: Column) -> dict[str, object]:
    """The schema of the value of a column."""
    field, type_ = column.field, column.field.type
    is_text = type_.enum or type_.flags or isinstance(type_.joined, JoinedText)
    index, unit = column.name.removeprefix(field.name), f"({column.unit})" if column.unit else ""
    facts = {
        "title": " ".join(filter(None, [english(field.title), index, unit])),
        "description": english(field.about),
        "unit": column.unit,
        "enum": [member.name for member in type_.enum],
    }
    return {"type": "string" if is_text else "number", **{key: fact for key, fact in facts.items() if fact}}


def _content(row: Row, properties: Mapping[str, str]) -> dict[str, object]:
    """A message: the values of a row, its raw integers, and what is known of its frame."""
    judged = row.judged
    time, latency = judged.recorded.time, judged.latency
    listed = [(properties[cell.column.name], cell) for cell in row.cells]
    values = {name: _value(cell) for name, cell in listed}
    times = {
        "time": None if time is None else time / 1_000_000_000,
        "latency_ms": None if latency is None else latency / 1_000_000,
    }
    facts = {name: OF_FRAME[name](row) for name in _FRAME} | times
    return {**_known(values), "raw": {name: _raw(cell) for name, cell in listed}, "frame": _known(facts)}


def _known(properties: Mapping[str, object]) -> dict[str, object]:
    """The properties that have a value."""
    return {name: value for name, value in properties.items() if value is not None}


def _value(cell: Cell) -> object:
    """A number, or a text of names; None for no value."""
    if cell.no_value is not None:
        return None
    return "|".join(cell.value) if isinstance(cell.value, list) else cell.value


def _raw(cell: Cell) -> object:
    joined = cell.column.field.type.joined
    return cell.raw if joined is None else elements(joined, cell.raw)
