"""Tables of Arrow: schemas with units, Parquet files, and decoding of batches for DuckDB, Polars and Spark."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from types import TracebackType

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from ._columns import Array, Column, Decoded, Decoder, Direction, Frames, Kind, Table, words_of

DIRECTIONS = ("request", "reply")
INPUT = pa.schema(
    [
        pa.field("time", pa.int64(), metadata={"unit": "ns"}),
        pa.field("bus", pa.string()),
        pa.field("id", pa.uint32()),
        pa.field("extended", pa.bool_()),
        pa.field("remote", pa.bool_()),
        pa.field("data", pa.binary()),
        pa.field("direction", pa.string()),
    ]
)
"""The columns of frames for `decode_batches`: `direction` is `request` or `reply`; in any order, further ones are ignored."""


def schema(decoder: Decoder, table: str) -> pa.Schema:
    """The columns of a table. Metadata of a column: `unit`, and as JSON the names of codes, of bits, of numbers, or of raw
    integers without a value.

    Raises ValueError for an unknown table, and for one whose columns depend on a parameter that is not given.
    """
    if table not in decoder.columns:
        raise ValueError(f"there is no table {table}; the tables are: {', '.join(decoder.columns)}")
    columns = decoder.columns[table]
    if columns is None:
        layout = next(layout for layout in decoder.edition.layouts if layout.name == table)
        raise ValueError(f"the columns of {table} depend on the parameter {layout.parameter}; give it to the decoder")
    edition = decoder.edition
    frame = [
        pa.field("time", pa.int64(), metadata={"unit": "ns"}),
        pa.field("bus", pa.string()),
        pa.field("node", pa.int32()),
        pa.field("direction", pa.string()),
        pa.field("command", pa.string()),
        pa.field("code", pa.int64()),
    ]
    return table_schema([*frame, *map(_field, columns)], edition.family, edition.name, edition.spec_hash, table)


def table_schema(columns: Sequence[pa.Field], family: str, edition: str, spec_hash: str, table: str) -> pa.Schema:
    """The columns of a table, with its origin as metadata."""
    return pa.schema(columns, metadata={"family": family, "edition": edition, "spec": spec_hash, "table": table})


def _field(column: Column) -> pa.Field:
    field = column.field
    metadata = {}
    if field.type.unit and not column.is_raw:
        metadata["unit"] = field.type.unit
    if field.type.is_named_number:
        metadata["names"] = json.dumps(field.type.names)
    elif field.type.names and not column.is_raw:
        metadata["flags" if field.type.is_flags else "enum"] = json.dumps(field.type.names)
    if field.type.no_values:
        metadata["no_value"] = json.dumps(field.type.no_values)
    if field.type.is_joined and column.scale is not None:
        return pa.field(column.name, pa.string() if field.type.text else pa.float64())
    is_float = field.has_other_values(column.scale)
    element = pa.float64() if is_float else pa.from_numpy_dtype(np.dtype(field.dtype))
    return pa.field(column.name, pa.list_(element, field.count) if field.count else element, metadata=metadata or None)


_SPARK = {
    pa.string(): ("string", pa.string()),
    pa.float32(): ("float", pa.float32()),
    pa.float64(): ("double", pa.float64()),
    pa.int8(): ("tinyint", pa.int8()),
    pa.int16(): ("smallint", pa.int16()),
    pa.int32(): ("int", pa.int32()),
    pa.int64(): ("bigint", pa.int64()),
    pa.uint8(): ("smallint", pa.int16()),
    pa.uint16(): ("int", pa.int32()),
    pa.uint32(): ("bigint", pa.int64()),
    pa.uint64(): ("decimal(20,0)", pa.decimal128(20, 0)),
}
"""The name that Spark has for a type, and the type of Arrow that it reads as such: it has no unsigned integers."""


def _spark_type(column: pa.DataType) -> tuple[str, pa.DataType]:
    if pa.types.is_fixed_size_list(column):
        name, element = _SPARK[column.value_type]
        return f"array<{name}>", pa.list_(element)
    return _SPARK[column]


def spark_schema(decoder: Decoder, table: str) -> str:
    """The columns of the batches of `spark_batches`, in the notation of Spark. Raises ValueError as `schema` does."""
    return ", ".join(f"`{column.name}` {_spark_type(column.type)[0]}" for column in schema(decoder, table))


def batch(decoder: Decoder, frames: Frames, table: Table) -> pa.RecordBatch:
    """A table as a batch; no value, and a value that is no finite number, are null."""
    messages = decoder.edition.messages
    columns = [
        frames.time[table.rows],
        _named(frames.buses, frames.bus[table.rows]),
        pa.array(table.node, mask=table.node < 0),
        _named(DIRECTIONS, np.array([m.direction for m in messages], np.int32)[table.message]),
        _named([m.command for m in messages], table.message),
    ]
    codes = np.array([m.code for m in messages], np.int64)[table.message]
    columns.append(pa.array(codes, mask=codes < 0))
    columns += [_array(values) for values in table.columns.values()]
    return pa.RecordBatch.from_arrays([pa.array(c) for c in columns], schema=schema(decoder, table.layout.name))


def batches(decoder: Decoder, frames: Frames) -> dict[str, pa.RecordBatch]:
    """The tables of some frames as batches, by name."""
    return {name: batch(decoder, frames, table) for name, table in decoder.decode(frames).tables.items()}


def _named(names: Sequence[str], places: Array) -> pa.Array:
    return pc.take(pa.array(names, pa.string()), pa.array(places))


def _array(values: Array) -> pa.Array:
    flat = pa.array(values.reshape(-1), from_pandas=values.dtype.kind == "f")
    return flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])


class TableFiles:
    """Writes one Parquet file for each table into a folder: `FOLDER/TABLE.parquet`. Each batch is a row group."""

    def __init__(self, folder: str | Path) -> None:
        self._folder = Path(folder)
        self._writers: dict[str, pq.ParquetWriter] = {}
        self._open = contextlib.ExitStack()

    def write(self, table: str, rows: pa.RecordBatch) -> None:
        """Adds rows to a table. Raises OSError."""
        if table not in self._writers:
            path = self._folder / f"{table}.parquet"
            path.parent.mkdir(parents=True, exist_ok=True)
            self._writers[table] = self._open.enter_context(pq.ParquetWriter(path, rows.schema))
        self._writers[table].write_batch(rows)

    def close(self) -> None:
        """Completes the files."""
        self._open.close()


class ParquetWriter:
    """Decodes frames and writes their tables as `TableFiles`, as a context. Frames are added in blocks."""

    def __init__(self, decoder: Decoder, folder: str | Path) -> None:
        self._decoder = decoder
        self._files = TableFiles(folder)

    def __enter__(self) -> ParquetWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._files.close()

    def add(self, frames: Frames) -> Decoded:
        """Decodes some frames and writes their tables. Raises OSError."""
        decoded = self._decoder.decode(frames)
        for name, table in decoded.tables.items():
            self._files.write(name, batch(self._decoder, frames, table))
        return decoded


def frames_of(batch: pa.RecordBatch) -> Frames:
    """The frames of a batch with the columns of `INPUT`. `bus`, `extended` and `remote` may be missing.

    Raises ValueError for a missing column, and for one of another type or with nulls.
    """
    given = {name: _column(batch, name) for name in INPUT.names if name in batch.schema.names}
    missing = [name for name in ("time", "id", "data", "direction") if name not in given]
    if missing:
        raise ValueError(f"the batch has no column {missing[0]}; its columns are: {', '.join(batch.schema.names)}")
    count = batch.num_rows
    no = np.zeros(count, np.bool_)
    extended, remote = (
        given[name].to_numpy(zero_copy_only=False) if name in given else no for name in ("extended", "remote")
    )
    lengths, words = _words(given["data"])
    bus = (given["bus"] if "bus" in given else pa.repeat("", count)).dictionary_encode()
    direction = pc.index_in(given["direction"], pa.array(DIRECTIONS))
    return Frames(
        time=given["time"].to_numpy(zero_copy_only=False),
        bus=bus.indices.to_numpy(zero_copy_only=False).astype(np.uint16),
        id=given["id"].to_numpy(zero_copy_only=False),
        kind=(extended * np.uint8(Kind.EXTENDED)) | (remote * np.uint8(Kind.REMOTE)),
        length=lengths,
        data=words,
        direction=pc.fill_null(direction, int(Direction.UNKNOWN)).to_numpy(zero_copy_only=False).astype(np.uint8),
        buses=tuple(bus.dictionary.to_pylist()) or ("",),
    )


def _column(batch: pa.RecordBatch, name: str) -> pa.Array:
    column = batch.column(name)
    if name != "direction" and column.null_count:
        raise ValueError(f"the column {name} has nulls")
    try:
        return column.cast(INPUT.field(name).type)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise ValueError(f"the column {name} is no {INPUT.field(name).type}: {error}") from None


def _words(data: pa.Array) -> tuple[Array, Array]:
    """The length of each, at most 255, and its bytes as one or several little-endian integers."""
    _, offsets_buffer, content_buffer = data.buffers()
    offsets = np.frombuffer(offsets_buffer, np.int32)[data.offset : data.offset + len(data) + 1]
    content = np.frombuffer(content_buffer or b"", np.uint8)
    lengths = np.minimum(np.diff(offsets), 255).astype(np.uint8)
    words = words_of(lengths)
    within = np.arange(8 * words) < lengths[:, None]
    places = np.where(within, offsets[:-1, None] + np.arange(8 * words), 0)
    padded = np.append(content, np.uint8(0))  # so that place 0 exists
    octets = np.where(within, padded[places], np.uint8(0)).astype(np.uint8)
    integers = np.ascontiguousarray(octets).view("<u8")
    return lengths, integers if words > 1 else integers[:, 0]


def decode_batches(batches: Iterable[pa.RecordBatch], decoder: Decoder, table: str) -> Iterator[pa.RecordBatch]:
    """One table of batches of frames: their columns are those of `INPUT`, those of the results `schema(...)`.

    A batch gives at most one batch; rows depend only on their own frame, so batches may be split at any frame.
    """
    for frame_batch in batches:
        frames = frames_of(frame_batch)
        decoded = decoder.decode(frames).tables.get(table)
        if decoded is not None:
            yield batch(decoder, frames, decoded)


def spark_batches(batches: Iterable[pa.RecordBatch], decoder: Decoder, table: str) -> Iterator[pa.RecordBatch]:
    """The batches of `decode_batches` for `mapInArrow` of Spark, with signed integers and lists of any size.

    Unsigned integers become the next larger signed type, those of 64 bits decimal numbers.
    """
    columns = schema(decoder, table)
    types = pa.schema([pa.field(column.name, _spark_type(column.type)[1]) for column in columns])
    for decoded in decode_batches(batches, decoder, table):
        arrays = [values.cast(column.type) for values, column in zip(decoded.columns, types, strict=True)]
        yield pa.RecordBatch.from_arrays(arrays, schema=types)
