"""Speed and memory of the readers and of `identify`: `python -m tests.bench.recordings [LOG]`.

Without a log of `candump -l`, one of a million frames is made: 8 motors whose values change in each frame. The figures
are process time and the peak memory of a new process each.
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
READ = """
for one in log: pass
"""
IDENTIFY = """
from canwright.project.loader import spec_files, specification
from canwright.recordings.identify import identify
identify(log, [specification(file).edition for file in spec_files(Path(sys.argv[2]))])
"""
MEASURED = """
import json, resource, sys, time
from pathlib import Path
from canwright.recordings.readers import open_log
with open_log(sys.argv[1]) as log:
{work}
    frames = log.counts.frames
unit = 1 if sys.platform == "darwin" else 1024
print(json.dumps([time.process_time() / frames, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6]))
"""


def main() -> int:
    if len(sys.argv) > 1:
        return report([*_measures(Path(sys.argv[1]))])
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "bus.log"
        with log.open("w", encoding="utf-8") as file:
            file.writelines(_lines())
        return report([*_measures(log)])


def _measures(log: Path) -> Iterator[Measure]:
    reading, _ = _run(READ, log)
    yield Measure("read a million frames of candump, s", reading * FRAMES, at_most=5)
    identifying, memory = _run(IDENTIFY, log)
    yield Measure("identify the editions of a million frames, s", identifying * FRAMES, at_most=10)
    yield Measure("identify, peak memory, MB", memory, at_most=100)


def _run(work: str, log: Path) -> tuple[float, float]:
    """Seconds of process time for a frame, and megabytes."""
    indented = work.replace("\n", "\n    ")
    script = MEASURED.format(work=indented)
    done = subprocess.run(
        [sys.executable, "-c", script, str(log), str(ROOT / "spec")], capture_output=True, text=True, check=True
    )
    seconds, memory = json.loads(done.stdout)
    return seconds, memory


def _lines() -> Iterator[str]:
    rng = random.Random(1)
    for number in range(FRAMES // 2):
        time, node = f"({1_700_000_000 + number / 4000:.6f})", 1 + number % 8
        iq = rng.randrange(-900, 900).to_bytes(2, "little", signed=True).hex().upper()
        yield f"{time} can0 {0x140 + node:03X}#A1000000{iq}0000\n"
        yield f"{time} can0 {0x140 + node:03X}#A132{iq}{rng.randbytes(4).hex().upper()}\n"


if __name__ == "__main__":
    sys.exit(main())
