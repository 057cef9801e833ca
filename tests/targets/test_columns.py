"""The columns package: logs as arrays, tables of Arrow, and the same rows whatever the blocks and partitions are."""

from __future__ import annotations

import ast
import functools
import importlib.util
import itertools
import os
import re
import shutil
import subprocess
import sys
import tracemalloc
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import can
import numpy as np
import pytest
from canwright.conformance.adapter import write_files
from canwright.conformance.modules import load
from canwright.diagnostics.diagnostic import SpecError
from canwright.project.loader import specification
from canwright.recordings.readers import open_log
from canwright.targets.base import EditionInput
from canwright.targets.columns.target import TARGET
from canwright.targets.columns.view import columns_of, tables_of
from canwright.targets.options import Options

from ..spec_texts import MINIMAL, ROOT, edition
from ..tools import tool
from ..untrusted.everything import filled

if TYPE_CHECKING:
    import pyarrow as pa

COMMITTED = ROOT / "generated/columns"

PARAMETERS = {"series": "MG", "encoder_bits": 18}


class Package:
    """The generated package of the motors."""

    def __init__(self, folder: Path) -> None:
        item = specification(ROOT / "spec/mwd_motor/v2.35.yaml")
        assert item.frames is not None
        names = ("v2_35", "logs", "_columns")
        self._folder = write_files(TARGET.generate([item], {}, Options()), folder)
        self.edition: Any
        self.logs: Any
        self.runtime: Any
        self.edition, self.logs, self.runtime = load(self._folder, *(f"mwd_motor_columns.{name}" for name in names))
        self.golden = item.frames.frames

    def frames(self) -> Any:
        """All golden frames, on two buses."""
        ways = [self.runtime.Direction[frame.direction.name] for frame in self.golden]
        count = len(self.golden)
        return self.runtime.frames(
            [frame.id for frame in self.golden],
            [frame.data for frame in self.golden],
            ways,
            time=range(1_000_000, 1_000_000 + count * 250_000, 250_000),
            bus=["can0" if number % 3 else "can1" for number in range(count)],
        )

    @functools.cached_property
    def arrow(self) -> Any:
        """The module that needs pyarrow."""
        return load(self._folder, "mwd_motor_columns.arrow")[0]

    def input(self) -> pa.RecordBatch:
        """The same frames as a batch."""
        import pyarrow as pa

        frames = self.frames()
        names = ["request", "reply"]
        return pa.RecordBatch.from_arrays(
            [
                pa.array(frames.time),
                pa.array([frames.buses[bus] for bus in frames.bus]),
                pa.array(frames.id),
                pa.array([frame.extended for frame in self.golden]),
                pa.array([frame.remote for frame in self.golden]),
                pa.array([frame.data for frame in self.golden], pa.binary()),
                pa.array([names[way] for way in frames.direction]),
            ],
            schema=self.arrow.INPUT,
        )


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Package:
    return Package(tmp_path_factory.mktemp("columns"))


LINES = """\
(1700000000.000100) can0 141#9C00000000000000 T
(1700000000.000350) can0 141#9C32640000000000 R
(1700000000.000400) can0 141#9C32640000000001 R
(1700000000.000500) can0 141#9c32640000000002 R
(1700000000.000600) can0 142#9C3264000000 R
(1700000000.000700) can1 00000141#9C00000000000000 T
(1700000000.000800) can0 141#R T
(1700000000.000900) can0 141##19C00000000000000 T
(1700000000.001000) can0 141#9C326400000000GG R
(1700000000.001100) can0 20000088#0000000000000000 R
damaged
(9223372036.000000) can0 141#9C32640000000002 R
# a comment
 (1700000000.001150)  can0  RX - -  141   [8]  9C 32 64 00 00 00 00 04   '.2d.....'
 (2023-11-14 22:13:20.001160)  can1  141   [2]  9C 32
 (1700000000.001170)  can1  141   [3]  9C 32
(1700000000.001180) can0 141#9C.32.64.00.00.00.00.04
(1700000000.0012) can0 141#9C32640000000004
(1700000000.001300) can0 141#9C32640000000005 R
"""


def _flat(blocks: Sequence[Any]) -> list[tuple[object, ...]]:
    """The frames of blocks as Python values: time, bus, id, kind, data."""
    return [
        (int(t), block.buses[b], int(i), int(k), w.tobytes()[: int(n)])
        for block in blocks
        for t, b, i, k, w, n in zip(block.time, block.bus, block.id, block.kind, block.data, block.length, strict=True)
    ]


def _reference(path: Path) -> tuple[list[tuple[Any, ...]], Counter[str]]:
    """The frames of a log as canwright reads them, and what it skips."""
    with open_log(str(path)) as log:
        frames = [(r.time, r.bus, r.frame.id, r.frame.extended + 2 * r.frame.remote, r.frame.data) for r in log]
    return frames, Counter({part.value: count for part, count in log.counts.skipped.items()})


def _in_microseconds(frames: Sequence[tuple[Any, ...]]) -> list[tuple[object, ...]]:
    """Frames with rounded times: python-can has them as floats."""
    return [(round(time / 1000), *rest) for time, *rest in frames]


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("block", [60, 200, 1 << 20])
def test_candump_is_read_as_by_the_reader_of_canwright(
    package: Package, tmp_path: Path, block: int, ending: str
) -> None:
    path = tmp_path / "bus.log"
    path.write_bytes((LINES * 20).rstrip("\n").replace("\n", ending).encode())
    _read_alike(package, path, block)


def _read_alike(package: Package, path: Path, block: int = 1 << 20) -> None:
    """Reads a log by both readers: they give the same frames, and count the same parts."""
    log = package.logs.Log(path, block=block)
    flat = _flat(list(log))
    frames, skipped = _reference(path)
    timed = [frame for frame in frames if frame[0] is not None]
    assert flat == timed
    assert log.skipped == skipped + Counter({"frames without a time": len(frames) - len(timed)})


REGULAR = "(1700000000.000001) can0 141#A10000006400FF01 R\n"


@pytest.mark.parametrize("char", ["_", "+", "G", "#", ".", " ", "(", "\t", "f", "-", "\x1b", "\u0661", ""])
def test_a_line_among_lines_of_one_form_is_read_as_any_other(package: Package, tmp_path: Path, char: str) -> None:
    """Lines of one form are read together; wherever one of them is changed, it is read as by the reader of canwright."""
    path, places = tmp_path / "bus.log", range(len(REGULAR))
    path.write_text(
        REGULAR * 4 + "".join(REGULAR[:at] + char + REGULAR[at + n :] for n in (0, 1) for at in places), "utf-8"
    )
    _read_alike(package, path)


def test_long_frames_of_candump_are_read_as_by_the_reader_of_canwright(package: Package, tmp_path: Path) -> None:
    """Lines that are read together, and lines of other forms, of up to 64 bytes."""
    path = tmp_path / "bus.log"
    regular = [f"(1.{number:06}) can0 141##1{bytes([number, *range(11)]).hex()}" for number in range(20)]
    skipped_lines = [
        f"(2.0) can1 00000141##0{'9C' * 64} R",
        " (3.0)  can0  141  [20]  " + "07 " * 20,
        "(4.0) can0 141#9C",
    ]
    path.write_text("\n".join((*regular, *skipped_lines, *regular)) + "\n", "utf-8")
    assert _flat(list(package.logs.Log(path))) == _reference(path)[0]


@pytest.mark.parametrize("damage", [False, True], ids=["complete", "truncated"])
def test_blf_is_read_as_by_the_reader_of_canwright(package: Package, tmp_path: Path, damage: bool) -> None:
    path = tmp_path / "bus.blf"
    with can.BLFWriter(path, max_container_size=4096) as writer:
        for number in range(600):
            long = number % 160 == 17
            writer.on_message_received(
                can.Message(
                    timestamp=1_700_000_000 + number / 1000,
                    arbitration_id=0x141 + number % 3,
                    is_extended_id=number % 50 == 7,
                    is_remote_frame=number % 60 == 11,
                    is_error_frame=number % 70 == 13,
                    is_fd=number % 80 == 17,
                    data=b"" if number % 60 == 11 else bytes([0x9C, number % 256, *range(62 if long else number % 7)]),
                    channel=number % 2,
                    is_rx=number % 2 == 1,
                )
            )
    if damage:
        path.write_bytes(path.read_bytes()[:-700])
    log = package.logs.Log(path, received=package.runtime.Direction.REPLY)
    blocks = list(log)
    assert _in_microseconds(_flat(blocks)) == _in_microseconds(_reference(path)[0])
    assert len(_flat(blocks)) > 400
    assert all((block.direction == block.bus).all() for block in blocks), "sent frames are requests"
    assert log.skipped["objects of type 73"] and not log.skipped["objects of type 100"]
    assert damage is bool(log.skipped["truncated end"] or log.skipped["damaged containers"])


def test_marks_count_only_if_the_recorder_is_known(package: Package, tmp_path: Path) -> None:
    path = tmp_path / "bus.log"
    path.write_text(LINES, "utf-8")
    way = package.runtime.Direction
    for received, expected in (
        (way.UNKNOWN, [way.UNKNOWN] * 4),
        (way.REPLY, [way.REQUEST, way.REPLY, way.REPLY, way.REPLY]),
        (way.REQUEST, [way.REPLY, way.REQUEST, way.REQUEST, way.REQUEST]),
    ):
        (block,) = package.logs.Log(path, received=received)
        assert block.direction[:4].tolist() == expected
        assert block.direction[-2] == way.UNKNOWN, "a line without a mark"
    decoded = package.edition.decoder(PARAMETERS).decode(block.take(block.direction == way.UNKNOWN))
    assert not decoded.tables and set(decoded.message) == {package.runtime.Refusal.UNKNOWN_DIRECTION}


def test_a_direction_that_the_id_decides(package: Package) -> None:
    way = package.runtime.Direction
    frames = package.runtime.frames([0x280, 0x141, 0x141], [bytes(8), b"\x9c" + bytes(7), bytes(8)], way.UNKNOWN)
    decoder = package.edition.decoder(PARAMETERS)
    assert decoder.with_directions(frames).direction.tolist() == [way.REQUEST, way.UNKNOWN, way.UNKNOWN]
    given = package.runtime.frames([0x280], [bytes(8)], way.REPLY)
    assert decoder.with_directions(given).direction.tolist() == [way.REPLY], "a given direction is kept"


def test_a_field_is_one_column_for_all_commands(package: Package) -> None:
    way = package.runtime.Direction.REPLY
    data = [bytes.fromhex(f"{code} 32 64 00 F4 01 00 40") for code in ("A1", "9C", "A4")]
    table = package.edition.decoder(PARAMETERS, raw=True).decode(package.runtime.frames([0x141] * 3, data, way)).tables
    assert list(table) == ["motion_feedback"]
    columns = table["motion_feedback"].columns
    assert columns["iq_raw"].tolist() == [100] * 3
    assert columns["iq"].tolist() == [100 * 33 / 2048] * 3
    assert columns["temperature"].tolist() == [50] * 3, "degrees are raw integers"


def test_parameters_are_checked(package: Package) -> None:
    for given, text in (
        ({"colour": "red"}, "no parameter colour; its parameters are: series"),
        ({"series": "MX"}, "series is 'MX', but must be one of MS, MF"),
        ({"gear_ratio": 0}, "gear_ratio is 0, but must be"),
        ({"gear_ratio": "much"}, "gear_ratio is 'much', but must be a finite number"),
    ):
        with pytest.raises(ValueError, match=text):
            package.edition.decoder(given)


def _decoded(package: Package, batches: Sequence[pa.RecordBatch], table: str) -> pa.Table:
    import pyarrow as pa

    decoder = package.edition.decoder(PARAMETERS)
    decoded = list(package.arrow.decode_batches(batches, decoder, table))
    return pa.Table.from_batches(decoded, package.arrow.schema(decoder, table))


@pytest.mark.interop("pyarrow")
def test_parquet_has_units_and_one_file_for_each_table(package: Package, tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    decoder, frames = package.edition.decoder(PARAMETERS), package.frames()
    with package.arrow.ParquetWriter(decoder, tmp_path) as writer:
        for block in (frames.take(slice(0, 100)), frames.take(slice(100, None))):
            writer.add(block)
    assert {path.stem for path in tmp_path.iterdir()} == set(decoder.decode(frames).tables)
    table = pq.read_table(tmp_path / "motion_feedback.parquet")
    assert table.schema.field("iq").metadata[b"unit"] == b"A"
    assert table.equals(_decoded(package, [package.input()], "motion_feedback"))
    status = pq.read_schema(tmp_path / "status_1.parquet")
    assert b"low_voltage" in status.field("errors").metadata[b"flags"]


@pytest.mark.interop("pyarrow")
def test_spark_has_no_unsigned_integers(package: Package) -> None:
    decoder = package.edition.decoder(PARAMETERS, raw=True)
    frame = "`time` bigint, `bus` string, `node` int, `direction` string, `command` string, `code` bigint"
    for table, fields in (
        ("motor_off", ""),
        ("status_1", ", `temperature` tinyint, `voltage` double, `voltage_raw` int, `errors` smallint"),
        ("broadcast_torque_request", ", `iq` array<double>, `iq_raw` array<smallint>"),
        ("read_single_turn_angle_reply", ", `angle` double, `angle_raw` bigint"),
    ):
        assert package.arrow.spark_schema(decoder, table) == frame + fields
        decoded = list(package.arrow.decode_batches([package.input()], decoder, table))
        for_spark = list(package.arrow.spark_batches([package.input()], decoder, table))
        assert [batch.to_pylist() for batch in for_spark] == [batch.to_pylist() for batch in decoded]
        types = [column.type for batch in for_spark for column in batch.schema]
        assert not any(str(kind).startswith(("uint", "fixed_size_list")) for kind in types)
    with pytest.raises(ValueError, match="there is no table nothing"):
        package.arrow.spark_schema(decoder, "nothing")


@pytest.mark.interop("pyarrow")
def test_a_partition_by_bus_and_time_gives_the_same_rows(package: Package) -> None:
    import pyarrow as pa

    whole = package.input()
    expected = _decoded(package, [whole], "motion_feedback")
    for cuts in ((1,), (17, 18), tuple(range(1, whole.num_rows))):
        ends = [0, *cuts, whole.num_rows]
        parts = [whole.slice(start, end - start) for start, end in itertools.pairwise(ends)]
        assert _decoded(package, parts, "motion_feedback").equals(expected)
    buses = [whole.filter(pa.compute.equal(whole["bus"], name)) for name in ("can0", "can1")]
    assert _decoded(package, buses, "motion_feedback").sort_by("time").equals(expected)


@pytest.mark.interop("pyarrow")
def test_longer_frames_than_the_edition_has(package: Package) -> None:
    """Frames of CAN FD among others are rejected for their length; both readers give them all their bytes."""
    import pyarrow as pa

    data = [bytes([0x9A, *range(1, length)]) for length in (8, 20, 8)]
    frames = package.runtime.frames([0x141] * 3, data, 0)
    rows = [{"time": 0, "id": 0x141, "data": item, "direction": "request"} for item in data]
    batch = pa.RecordBatch.from_pylist(rows, schema=pa.schema([package.arrow.INPUT.field(n) for n in rows[0]]))
    for read in (frames, package.arrow.frames_of(batch)):
        assert [row.tobytes()[:length] for row, length in zip(read.data, read.length, strict=True)] == data
        wanted = package.edition.decoder(PARAMETERS).decode(package.runtime.frames([0x141], data[:1], 0)).message[0]
        decoded = package.edition.decoder(PARAMETERS).decode(read)
        assert list(decoded.message) == [wanted, package.runtime.Refusal.WRONG_LENGTH, wanted]


@pytest.mark.interop("pyarrow")
def test_a_batch_with_wrong_columns_is_an_error(package: Package) -> None:
    import pyarrow as pa

    decoder, whole = package.edition.decoder(PARAMETERS), package.input()
    strings = pa.array(["x"] * whole.num_rows)
    for batch, text in (
        (whole.drop_columns(["data"]), "no column data"),
        (whole.set_column(0, "time", strings), "the column time is no int64"),
        (whole.set_column(2, "id", pa.nulls(whole.num_rows, pa.uint32())), "the column id has nulls"),
    ):
        with pytest.raises(ValueError, match=text):
            list(package.arrow.decode_batches([batch], decoder, "motion_feedback"))
    with pytest.raises(ValueError, match="there is no table nothing; the tables are: motor_off"):
        package.arrow.schema(decoder, "nothing")
    with pytest.raises(ValueError, match="depend on the parameter series"):
        package.arrow.schema(package.edition.decoder(), "motion_feedback")


@pytest.mark.parametrize("block", [64, 1 << 21])
def test_a_line_without_an_end_needs_no_memory(package: Package, tmp_path: Path, block: int) -> None:
    line = b"(1.000000) can0 141#9A00000000000000\n"
    path = tmp_path / "log"
    path.write_bytes(line + b"x" * 3_000_000 + b"\n" + line + b"y" * 3_000_000)
    log = package.logs.Log(path, block=block)
    tracemalloc.start()
    assert sum(len(frames) for frames in log) == 2
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200_000 + 4 * block
    assert log.skipped == {"malformed": 2}


@pytest.mark.interop("duckdb", "polars", "pyarrow")
def test_duckdb_and_polars(package: Package, tmp_path: Path) -> None:
    import duckdb
    import polars
    import pyarrow as pa
    import pyarrow.parquet as pq

    decoder = package.edition.decoder(PARAMETERS)
    expected = _decoded(package, [package.input()], "motion_feedback")
    path = tmp_path / "frames.parquet"
    pq.write_table(pa.Table.from_batches([package.input()]), path)
    source, database = duckdb.connect(), duckdb.connect()
    batches = source.sql(f"select * from '{path}'").to_arrow_reader(50)
    schema = package.arrow.schema(decoder, "motion_feedback")
    decode = package.arrow.decode_batches(batches, decoder, "motion_feedback")
    database.register("decoded", pa.RecordBatchReader.from_batches(schema, decode))
    mean = float(np.mean(expected["iq"].to_numpy()))
    assert database.execute("select avg(iq), count(*) from decoded").fetchall() == [
        (pytest.approx(mean), expected.num_rows)
    ]

    frames: Any = polars.scan_parquet(path).collect()
    read: Any = polars.from_arrow(_decoded(package, frames.to_arrow().to_batches(), "motion_feedback"))
    assert read["iq"].mean() == pytest.approx(mean)


SNIPPETS = re.findall(r"```python\n(.*?)```", (COMMITTED / "README.md").read_text("utf-8"), re.DOTALL)
"""The examples of the guide."""


@pytest.mark.interop("duckdb", "polars", "pyarrow")
def test_the_examples_of_the_guide(package: Package, tmp_path: Path) -> None:
    """All but that of Spark, in one program."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    (tmp_path / "frames").mkdir()
    pq.write_table(pa.Table.from_batches([package.input()]), tmp_path / "frames/1.parquet")
    (tmp_path / "bus.log").write_text(LINES, "utf-8")
    shutil.copy(ROOT / "spec/mwd_motor/v2.35.yaml", tmp_path / "spec.yaml")
    parts = [snippet for snippet in SNIPPETS if "spark" not in snippet]
    assert len(parts) == len(SNIPPETS) - 1 == 4
    script = "\n".join([*parts, "print(decoded.height)"])
    environment = {**os.environ, "PYTHONPATH": str(COMMITTED)}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    skipped, inferred, by_node, height = done.stdout.splitlines()
    assert "error frames" in skipped and "motion_feedback" in inferred
    table = next(re.findall(r'TABLE = "(\w+)"', snippet)[0] for snippet in SNIPPETS if "TABLE =" in snippet)
    rows = _decoded(package, [package.input()], table)
    assert sum(count for _, count in ast.literal_eval(by_node)) == int(height) == rows.num_rows


@pytest.mark.tools("pyarrow")
def test_the_example_of_spark(package: Package, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    tool("java")
    if importlib.util.find_spec("pyspark") is None:
        raise SystemExit("pyspark is not installed: pip install pyspark")
    sql = importlib.import_module("pyspark.sql")
    for name, value in (("PYSPARK_PYTHON", sys.executable), ("PYTHONPATH", str(COMMITTED))):
        monkeypatch.setenv(name, value)  # the workers import the package
    monkeypatch.syspath_prepend(str(COMMITTED))
    monkeypatch.chdir(tmp_path)
    edition_, arrow = (importlib.import_module(f"mwd_motor_columns.{name}") for name in ("v2_35", "arrow"))
    pq.write_table(pa.Table.from_batches([package.input()]), "frames")
    builder = sql.SparkSession.builder.master("local[1]").config("spark.ui.enabled", "false")
    session = builder.config("spark.driver.host", "127.0.0.1").getOrCreate()
    decoder = edition_.decoder(PARAMETERS, raw=True)
    names = {"spark": session, "arrow": arrow, "decoder": decoder}
    read = {}
    try:
        for table in ("motion_feedback", "status_1", "broadcast_torque_request", "read_single_turn_angle_reply"):
            exec(next(snippet for snippet in SNIPPETS if "spark" in snippet), {**names, "TABLE": table}, names)
            read[table] = [row.asDict() for row in names["decoded"].collect()]
    finally:
        session.stop()
    for table, rows in read.items():
        expected = pa.Table.from_batches(arrow.decode_batches([package.input()], decoder, table))
        assert rows == expected.to_pylist()


def test_hostile_texts_stay_texts(tmp_path: Path) -> None:
    hostile = 'x""" \'\\ {{7*7}} # )\\'
    for output in TARGET.generate([filled(lambda: hostile, tmp_path)], {}, Options()):
        if output.path.endswith("/v1.py"):
            tree = ast.parse(output.text)
            assert all(
                isinstance(statement, ast.Expr | ast.ImportFrom | ast.Assign | ast.AnnAssign) for statement in tree.body
            )
            assert "{{7*7}}" in output.text


@pytest.mark.interop("pyarrow")
def test_numbers_with_names_have_raw_integers(tmp_path: Path) -> None:
    """10 % are raw 100 = 0x64, 100 % are raw 1000 = 0x03E8."""
    text = MINIMAL.replace('"%", scale: 0.1', '"%", scale: 0.1, names: {stopped: 0, maximum: 1000}')
    text = text.replace("type: level}}", "type: level}, steps: {at: 4, type: steps}}")
    text = text.replace("types:", "types:\n  steps: {raw: u8, names: {few: 3}}")
    item = EditionInput(edition(tmp_path, text), None)
    folder = write_files(TARGET.generate([item], {}, Options()), tmp_path / "out")
    module, runtime, arrow = load(folder, *(f"lamp_columns.{name}" for name in ("v1", "_columns", "arrow")))
    decoder = module.decoder()
    frames = runtime.frames([0x101] * 2, [bytes([16, 0, 0xE8, 3, 3, 0, 0, 0]), bytes([16, 0, 100, 0, 4, 0, 0, 0])], 0)
    ((name, table),) = decoder.decode(frames).tables.items()
    assert {column: values.tolist() for column, values in table.columns.items()} == {
        "level": [100.0, 10.0],
        "level_raw": [1000, 100],
        "steps": [3, 4],
    }
    schema = arrow.schema(decoder, name)
    named = {field.name: field.metadata[b"names"] for field in schema if field.metadata and b"names" in field.metadata}
    assert named == {
        "level": b'{"0": "stopped", "1000": "maximum"}',
        "level_raw": b'{"0": "stopped", "1000": "maximum"}',
        "steps": b'{"3": "few"}',
    }


def test_names_that_are_taken_differ(tmp_path: Path) -> None:
    fields = "{level: {at: 2, type: level}, time: {at: 4, raw: u8}, level_raws: {at: 5, raw: u8}}"
    lamp = edition(tmp_path, MINIMAL.replace("{level: {at: 2, type: level}}", fields))
    (layout,) = tables_of(lamp)
    assert list(columns_of(layout).values()) == [
        ("level", "level_raw"),
        ("time_", "time_raw"),
        ("level_raws", "level_raws_raw"),
    ]
    assert not list(TARGET.problems(lamp))
    with pytest.raises(SpecError, match="already contains a module `logs`"):
        edition(tmp_path, MINIMAL.replace("edition: v1", "edition: logs"))
