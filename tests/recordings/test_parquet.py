"""Parquet files have the rows of JSON Lines, cell for cell: both come from the same rows."""

from __future__ import annotations

import json
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from canwright.model.edition import Edition
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.recordings.exports import JsonLines
from canwright.recordings.log_frame import LogFrame
from canwright.recordings.rows import Row, RowReader
from canwright.semantics.frame import CanFrame

from ..spec_texts import ROOT
from .traffic import MIXES, Loss, Traffic

SPECS = (
    "spec/mwd_motor/v2.35",
    "spec/mwd_motor/v2.36-2025-03",
    # arrays, names, flags, fields that depend on parameters, no values, and joined elements
    *(
        f"tests/specs/{name}"
        for name in ("cells/v1", "engine/v1", "joint/v1", "mixer/v2-2024-02", "spindle/v1", "tank/v1")
    ),
)


def recorded(edition: Edition) -> Iterator[LogFrame]:
    """Traffic of two buses, with frames that no message explains and one without a time."""
    for number, mix in enumerate(MIXES):
        for sent in Traffic(edition, mix, number, loss=Loss(failed=0.05), bus=f"can{number % 2}").frames(120):
            yield sent.recorded
        yield LogFrame(None, "can0", sent.recorded.frame, None)
        yield LogFrame(None, "can0", CanFrame(sent.recorded.frame.id, b"\xee" * 8), None)


def rows_of(edition: Edition) -> list[Row]:
    """Rows of nodes of which each second one has no parameters."""
    given = {p.name: p.values[0].name if p.values else str(p.minimum or 1) for p in edition.parameters}
    reader = RowReader(lambda _, node: given if (node or 0) % 2 else {})
    return [*reader.rows(Directions({}, edition).classify(recorded(edition)))]


def cells_of(row: dict[str, Any], edition: Edition) -> dict[str, object]:
    """The cells of Parquet that a line of JSON has."""
    message = next(m for m in edition.all_messages() if (m.command, m.direction) == (row["command"], row["direction"]))
    times = {"time": (row["time"], 10**9), "latency": (row["latency_ms"], 10**6)}
    of_frame = ("number", "bus", "node", "direction", "decided_by", "command", "request")
    cells: dict[str, object] = {name: row[name] for name in of_frame}
    cells |= {name: None if time is None else int(time * unit) for name, (time, unit) in times.items()}
    for field in (field for field in message.layout.fields if field.is_given):
        joined = field.type.joined
        parts = [part for name, part in row["fields"].items() if name.partition("[")[0] == field.name]
        raws, values = [part["raw"] for part in parts], [_value(part["value"]) for part in parts]
        if joined is not None:
            raws = [[*each.to_bytes(joined.count, "big")] if joined.width == 8 else each for each in raws]
        is_list = field.is_array and joined is None
        name = f"{field.name}_" if field.name in (*of_frame, *times) else field.name
        cells[name] = (values or None) if is_list else next(iter(values), None)
        cells[f"{field.name}_raw"] = (raws or None) if is_list else next(iter(raws), None)
    return cells


def _value(value: object) -> object:
    return float(value) if isinstance(value, (int, Decimal)) else value


@pytest.mark.interop("pyarrow")
@pytest.mark.parametrize("spec", SPECS)
def test_parquet_equals_json_lines(spec: str, tmp_path: Path) -> None:
    import pyarrow.parquet as pq
    from canwright.recordings.parquet import ParquetTables

    edition = specification(ROOT / f"{spec}.yaml").edition
    rows = rows_of(edition)
    tables = ParquetTables(tmp_path)
    for row in rows:
        tables.write(row)
    tables.close()
    lines = [json.loads(line, parse_float=Decimal) for line in JsonLines()(rows).splitlines()]
    expected = [cells_of(line, edition) for line in lines if line["command"] is not None]
    written = [row for file in tmp_path.rglob("*.parquet") for row in pq.read_table(file).to_pylist()]
    assert sorted(written, key=lambda row: row["number"]) == expected
