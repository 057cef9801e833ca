"""Rows as Parquet: one table for each layout, so that a field is one column for all commands with this layout."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..model.edition import Edition
from ..model.layout import Field, Layout
from ..model.types import Encoding, Type
from .exports import bus_name
from .packages import require
from .rows import Row

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
        require("pyarrow", "pyarrow", "Parquet")
        self._folder = folder
        self._tables: dict[Layout, _LayoutTable] = {}
        self._paths: set[Path] = set()
        self._buffered = 0

    def write(self, row: Row) -> None:
        judged = row.judged
        if judged.message is None or judged.edition is None:
            return
        table = self._tables.get(judged.message.layout)
        if table is None:
            path = self._path(judged.edition, judged.message.layout)
            table = self._tables[judged.message.layout] = _LayoutTable(path, judged.edition, judged.message.layout)
        table.add(row)
        self._buffered += 1
        if len(table.rows) >= _BATCH or self._buffered >= _MAX_BUFFERED:
            for full in [table] if self._buffered < _MAX_BUFFERED else self._tables.values():
                self._buffered -= full.flush()

    def close(self) -> None:
        for table in self._tables.values():
            table.close()

    def _path(self, edition: Edition, layout: Layout) -> Path:
        folder = self._folder / edition.name
        folder.mkdir(parents=True, exist_ok=True)
        path, number = folder / f"{layout.name}.parquet", 2
        while path in self._paths:
            path, number = folder / f"{layout.name}-{number}.parquet", number + 1
        self._paths.add(path)
        return path


class _LayoutTable:
    """The file of one layout."""

    def __init__(self, path: Path, edition: Edition, layout: Layout) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        columns: list[Any] = [
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
        names = {column.name for column in columns}
        self._fields: dict[Field, int] = {}
        by_content: dict[object, int] = {}
        for field in layout.fields:
            if not field.role.is_value:
                continue
            unit = field.type.unit.symbol if field.type.unit else None
            same = (field.name, unit, field.is_array, _kind(field.type), _raw_width(field.type))
            if same not in by_content:
                by_content[same] = len(columns)
                for name, type_, metadata in _columns(field):
                    columns.append(pa.field(_unused(name, names), type_, metadata=metadata))
            self._fields[field] = by_content[same]
        metadata = {"family": edition.family, "edition": edition.name, "spec": edition.hash, "table": layout.name}
        self._schema = pa.schema(columns, metadata=metadata)
        self._writer = pq.ParquetWriter(path, self._schema)
        self.rows: list[Sequence[object]] = []

    def add(self, row: Row) -> None:
        judged = row.judged
        assert judged.message is not None
        values: list[Any] = [None] * len(self._schema.names)
        values[:9] = (
            judged.number,
            judged.recorded.time,
            bus_name(judged.recorded.bus),
            judged.node,
            judged.direction.value if judged.direction else None,
            judged.decided_by.value,
            judged.message.command,
            judged.request,
            judged.latency,
        )
        for cell in row.cells:
            field = cell.column.field
            at = self._fields[field]
            if field.is_array:
                values[at] = [*(values[at] or ()), cell.value]
                values[at + 1] = [*(values[at + 1] or ()), cell.raw]
            else:
                values[at], values[at + 1] = cell.value, cell.raw
        self.rows.append(values)

    def flush(self) -> int:
        """Writes the rows; returns their number."""
        import pyarrow as pa

        count = len(self.rows)
        if count:
            arrays = [pa.array(c, f.type) for c, f in zip(zip(*self.rows, strict=True), self._schema, strict=True)]
            self._writer.write_batch(pa.RecordBatch.from_arrays(arrays, schema=self._schema))
            self.rows.clear()
        return count

    def close(self) -> None:
        self.flush()
        self._writer.close()


def _columns(field: Field) -> Sequence[tuple[str, Any, dict[str, str] | None]]:
    """Name, type and metadata of the column of the values and of that of the raw integers."""
    import pyarrow as pa

    type_ = field.type
    value = {"number": pa.float64(), "enum": pa.string(), "flags": pa.list_(pa.string())}[_kind(type_)]
    raw = pa.uint64() if _raw_width(type_) == "u64" else pa.int64()
    unit = {"unit": type_.unit.symbol} if type_.unit else None
    if field.is_array:
        value, raw = pa.list_(value), pa.list_(raw)
    return (field.name, value, unit), (f"{field.name}_raw", raw, None)


def _kind(type_: Type) -> str:
    return "enum" if type_.enum else "flags" if type_.flags else "number"


def _raw_width(type_: Type) -> str:
    return "u64" if type_.width == 64 and type_.encoding is not Encoding.SIGNED else "i64"


def _unused(name: str, names: set[str]) -> str:
    """A name that no other column has; it is added to them."""
    while name in names:
        name += "_"
    names.add(name)
    return name
