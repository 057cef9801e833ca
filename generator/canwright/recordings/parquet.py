"""Rows as Parquet: one table for each layout, so that a field is one column for all commands with this layout."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.edition import Edition
from ..model.joined import JoinedText
from ..model.layout import Field, Layout
from ..model.types import Encoding
from ..targets.columns.view import columns_of, tables_of
from .exports import bus_name
from .packages import require
from .rows import Row, elements

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
        """The rows as columns, in the order of the log."""
        import pyarrow as pa

        fields = {form: tuple(column.field for column in form.columns) for form in {row.form for row in self.rows}}
        alike: dict[Sequence[Field], list[Row]] = {}
        for row in self.rows:
            alike.setdefault(fields[row.form], []).append(row)
        parts = [self._part(having, rows) for having, rows in alike.items()]
        if len(parts) == 1:
            return parts[0]
        return pa.Table.from_batches(parts).sort_by("number").combine_chunks().to_batches()[0]

    def _part(self, having: Sequence[Field], rows: Sequence[Row]) -> pa.RecordBatch:
        """Rows with the same fields as columns."""
        import pyarrow as pa

        judged, forms, cells, _ = zip(*rows, strict=True)
        recorded, number, _, _, _, _, _, _, request, latency, _ = zip(*judged, strict=True)
        known = {form: at for at, form in enumerate(dict.fromkeys(forms))}
        of_rows = pa.array([known[form] for form in forms])
        integer, text = pa.int64(), pa.string()
        arrays = [
            pa.array(number, integer),
            pa.array([frame.time for frame in recorded], integer),
            pa.array([bus_name(form.bus) for form in known], text).take(of_rows),
            pa.array([form.node for form in known], integer).take(of_rows),
            pa.array([form.direction and form.direction.value for form in known], text).take(of_rows),
            pa.array([form.decided_by.value for form in known], text).take(of_rows),
            pa.array([form.message and form.message.command for form in known], text).take(of_rows),
            pa.array(request, integer),
            pa.array(latency, integer),
        ]
        listed = [*zip(*cells, strict=True)]
        for field, names in self._names.items():
            places = [2 * at for at, each in enumerate(having) if each is field]
            columns = _columns_of(field, listed, places) if places else [[None] * len(rows)] * 2
            for name, column in zip(names, columns, strict=True):
                arrays.append(pa.array(column, self.schema.field(name).type))
        return pa.RecordBatch.from_arrays(arrays, schema=self.schema)


def _columns_of(field: Field, listed: Sequence[Sequence[Any]], places: Sequence[int]) -> Iterator[Sequence[object]]:
    """The values of a field and its raw integers, which are at these places of the fields of rows."""
    raws, values = [listed[at] for at in places], [listed[at + 1] for at in places]
    joined = field.type.joined
    if field.type.is_number and not isinstance(joined, JoinedText):
        values = [[float(value) if isinstance(value, (int, float)) else None for value in column] for column in values]
    if joined is not None:
        yield from (values[0], [elements(joined, raw) for raw in raws[0]])
    elif field.is_array:
        yield from ([*zip(*values, strict=True)], [*zip(*raws, strict=True)])
    else:
        yield from (values[0], raws[0])


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
