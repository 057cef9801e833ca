"""Rows as Parquet: one table for each layout, so that a field is one column for all commands with this layout."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.edition import Edition
from ..model.joined import JoinedText
from ..model.layout import Field, Layout
from ..model.types import Encoding
from ..targets.columns.view import columns_of, tables_of
from .exports import bus_name
from .packages import require
from .rows import Row, RowForm, elements

if TYPE_CHECKING:
    import pyarrow as pa

_BATCH = 4096
"""The number of rows of a table that are written at once."""
_MAX_BUFFERED = 1 << 16
"""The maximum number of rows of all tables that wait to be written."""


class ParquetTables:
    """A folder with a folder for each edition and a file for each layout. Rows without a message are not written.

    `NAME` is the value of a field in the unit that the metadata state, `NAME_raw` its raw integer. `_` is appended to
    a name that another column has. Raises MissingPackageError.
    """

    def __init__(self, folder: Path) -> None:
        for package in ("numpy", "pyarrow"):
            require(package, package, "Parquet")
        from ..targets.columns.runtime.arrow import TableFiles

        self._files = TableFiles(folder)
        self._tables: dict[Layout, _LayoutTable] = {}
        self._buffered = 0

    def write(self, row: Row) -> None:
        judged = row.judged
        if judged.message is None or judged.edition is None:
            return
        table = self._tables.get(judged.message.layout)
        if table is None:
            table = self._tables[judged.message.layout] = _LayoutTable(judged.edition, judged.message.layout)
        table.rows.append(row)
        self._buffered += 1
        if len(table.rows) >= _BATCH:
            self._flush(table)
        elif self._buffered >= _MAX_BUFFERED:
            self._flush(*self._tables.values())

    def close(self) -> None:
        self._flush(*self._tables.values())
        self._files.close()

    def _flush(self, *tables: _LayoutTable) -> None:
        for table in tables:
            if table.rows:
                self._files.write(table.name, table.batch())
                self._buffered -= len(table.rows)
                table.rows.clear()


class _LayoutTable:
    """The rows of one layout that are not written yet."""

    def __init__(self, edition: Edition, layout: Layout) -> None:
        import pyarrow as pa

        from ..targets.columns.runtime.arrow import table_schema

        frame = [
            pa.field("number", pa.int64(), nullable=False),
            pa.field("time", pa.int64(), metadata={"unit": "ns"}),
            pa.field("bus", pa.string(), nullable=False),
            pa.field("node", pa.int64()),
            pa.field("direction", pa.string()),
            pa.field("decided_by", pa.string(), nullable=False),
            pa.field("command", pa.string(), nullable=False),
            pa.field("request", pa.int64()),
            pa.field("latency", pa.int64(), metadata={"unit": "ns"}),
        ]
        self._names = columns_of(layout, [column.name for column in frame])
        columns = [column for field, names in self._names.items() for column in _columns(field, *names)]
        table = tables_of(edition)[layout]
        self.name = f"{edition.name}/{table}"
        self.schema = table_schema([*frame, *columns], edition.family, edition.name, edition.hash, table)
        self.rows: list[Row] = []

    def batch(self) -> pa.RecordBatch:
        """The rows as columns."""
        import pyarrow as pa

        recorded, number, node, _, direction, rule, message, _, _, request, latency, _ = _columns_of(
            row.judged for row in self.rows
        )
        time, bus, _, _ = _columns_of(recorded)
        columns = [
            number,
            time,
            [*map(bus_name, bus)],
            node,
            [each and each.value for each in direction],
            [each.value for each in rule],
            [each.command for each in message],
            request,
            latency,
        ]
        for field in self._names:
            columns += self._values(field)
        arrays = [pa.array(column, of.type) for column, of in zip(columns, self.schema, strict=True)]
        return pa.RecordBatch.from_arrays(arrays, schema=self.schema)

    def _values(self, field: Field) -> tuple[Sequence[object], Sequence[object]]:
        """The values of a field and its raw integers; None in rows without it."""
        places = {form: _places(form, field) for form in {row.form for row in self.rows}}
        listed = [(row.fields, places[row.form]) for row in self.rows]
        if field.type.no_values:
            listed = [([_number_or_none(value) for value in fields], own) for fields, own in listed]
        joined = field.type.joined
        if field.is_array and joined is None:
            return [[fields[at + 1] for at in own] or None for fields, own in listed], [
                [fields[at] for at in own] or None for fields, own in listed
            ]
        raws = [fields[own[0]] if own else None for fields, own in listed]
        if joined is not None:
            raws = [None if raw is None else elements(joined, raw) for raw in raws]
        return [fields[own[0] + 1] if own else None for fields, own in listed], raws


def _number_or_none(value: object) -> object:
    """A number; None for the name for no value."""
    return None if isinstance(value, str) else value


def _columns_of(rows: Iterable[Sequence[Any]]) -> Iterator[Sequence[Any]]:
    return zip(*rows, strict=True)


def _places(form: RowForm, field: Field) -> Sequence[int]:
    """The places of the raw integers of a field in the fields of a row."""
    return [2 * at for at, column in enumerate(form.columns) if column.field is field]


def _columns(field: Field, name: str, raw_name: str) -> tuple[pa.Field, pa.Field]:
    """The column of the values and that of the raw integers."""
    import pyarrow as pa

    type_ = field.type
    is_text = type_.enum or isinstance(type_.joined, JoinedText)
    value = pa.string() if is_text else pa.list_(pa.string()) if type_.flags else pa.float64()
    raw = pa.uint64() if type_.width == 64 and type_.encoding is not Encoding.SIGNED else pa.int64()
    if field.is_array:
        value, raw = value if type_.joined else pa.list_(value), pa.list_(raw)
    unit = {"unit": type_.unit.symbol} if type_.unit else None
    return pa.field(name, value, metadata=unit), pa.field(raw_name, raw)
