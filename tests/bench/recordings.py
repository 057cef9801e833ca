"""Speed and memory of the readers, `identify`, `monitor` and `decode`: `python -m tests.bench.recordings [LOG]`.

Without a log of `candump -l`, one of a million frames is made: 8 motors whose values change in each frame. The figures
are process time and the peak memory of a new process each. Work on a log is compared with reading it, by canwright or by
python-can, and Parquet files with those that the columns package writes.
"""

from __future__ import annotations

import json
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from ..spec_texts import ROOT
from .bars import Measure, report

FRAMES = 1_000_000
BUS_SECONDS = 125
"""How long a bus of 1 Mbit/s takes for a million frames."""
READ = """
from canwright.recordings.readers import open_log
with open_log(sys.argv[1]) as log:
    for frame in log: pass
"""
IDENTIFY = """
from canwright.project.loader import spec_files, specification
from canwright.recordings.identify import identify
from canwright.recordings.readers import open_log
with open_log(sys.argv[1]) as log:
    identify(log, [specification(file).edition for file in spec_files(Path(sys.argv[2]))])
"""
PYTHON_CAN = """
import can
for message in can.LogReader(sys.argv[1]): pass
"""
DECODE = """
from canwright.__main__ import run
options = ["--set", "edition=v2.35", "--set", "series=MG", "--set", "encoder_bits=18", "--format", "FORM"]
sys.argv = ["canwright", "decode", sys.argv[1], *options, "--out", sys.argv[3]]
try:
    run()
except SystemExit as ended:
    assert ended.code in (0, 1)
"""
COLUMNS = """
sys.path.insert(0, str(Path(sys.argv[2]).parent / "generated/columns"))
from mwd_motor_columns import arrow, logs, v2_35
from canwright.project.loader import specification
from canwright.recordings.direction_arrays import infer_directions
edition = specification(Path(sys.argv[2]) / "mwd_motor/v2.35.yaml").edition
with arrow.ParquetWriter(v2_35.decoder({"series": "MG", "encoder_bits": 18}), sys.argv[3]) as writer:
    for frames in infer_directions(logs.Log(sys.argv[1]), edition):
        writer.add(frames)
"""
MONITOR = """
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.recordings.latest_values import LatestValues
from canwright.recordings.readers import open_log
from canwright.recordings.rows import RowReader
edition = specification(Path(sys.argv[2]) / "mwd_motor/v2.35.yaml").edition
values, rows = LatestValues(), RowReader(lambda *_: {"series": "MG", "encoder_bits": 18})
with open_log(sys.argv[1]) as log:
    for row in rows.rows(Directions({}, edition).classify(log)): values.add(row)
"""
MEASURED = """
import json, resource, sys, time
from pathlib import Path
{work}
unit = 1 if sys.platform == "darwin" else 1024
print(json.dumps([time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6]))
"""


def main() -> int:
    if len(sys.argv) > 1:
        return report([*_measures(Path(sys.argv[1]))])
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "bus.log"
        with log.open("w", encoding="utf-8") as file:
            file.writelines(log_lines())
        return report([*_measures(log)])


def _measures(log: Path) -> Iterator[Measure]:
    with log.open("rb") as lines:
        millions = sum(1 for _ in lines) / FRAMES
    reading, _ = _run(READ, log)
    yield Measure("read a million frames of candump, s", reading / millions, at_most=5)
    identifying, memory = _run(IDENTIFY, log)
    yield Measure("identify the editions of a million frames, s", identifying / millions, at_most=10)
    yield Measure("identify, peak memory, MB", memory, at_most=100)
    python_can, columns = _run(PYTHON_CAN, log)[0], _run(COLUMNS, log)[0]
    yield Measure("identify, time relative to the reader of python-can", identifying / python_can, at_most=2)
    monitoring = _run(MONITOR, log)[0] / millions / BUS_SECONDS
    yield Measure("monitor of a bus of 1 Mbit/s with full load, share of a processor", monitoring, at_most=0.2)
    json_lines, tables = (_run(DECODE.replace("FORM", form), log)[0] for form in ("jsonl", "parquet"))
    yield Measure("decode as JSON lines, time relative to the reader of python-can", json_lines / python_can, at_most=3)
    yield Measure("decode as Parquet, time relative to the columns package", tables / columns, at_most=2)


def _run(work: str, log: Path) -> tuple[float, float]:
    """Seconds of process time, and megabytes."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = [str(log), str(ROOT / "spec"), str(Path(folder) / "decoded")]
        done = subprocess.run(
            [sys.executable, "-c", MEASURED.replace("{work}", work), *arguments],
            capture_output=True,
            text=True,
            check=True,
        )
    seconds, memory = json.loads(done.stdout.splitlines()[-1])
    return seconds, memory


def log_lines() -> Iterator[str]:
    rng = random.Random(1)
    for number in range(FRAMES // 2):
        time, node = f"({1_700_000_000 + number / 4000:.6f})", 1 + number % 8
        iq = rng.randrange(-900, 900).to_bytes(2, "little", signed=True).hex().upper()
        yield f"{time} can0 {0x140 + node:03X}#A1000000{iq}0000\n"
        yield f"{time} can0 {0x140 + node:03X}#A132{iq}{rng.randbytes(4).hex().upper()}\n"


if __name__ == "__main__":
    sys.exit(main())
