"""Time and memory of tshark with the generated dissector, beside tshark alone: `python -m tests.bench.wireshark [FRAMES]`.

The frames, by default a million, are those of `tests.bench.recordings`. A figure is process time and the peak memory.
"""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from canwright.recordings.readers import open_log

from ..spec_texts import ROOT
from ..targets.tshark import Captured, capture
from ..tools import tool
from .bars import Measure, report
from .recordings import FRAMES, log_lines

DISSECTOR = ROOT / "generated/wireshark/mwd_motor.lua"
CHOSEN = ("-o", "mwd_motor.edition:v2.35", "-o", "mwd_motor.series:MG", "-o", "mwd_motor.encoder_bits:18")
RUN = """
import json, resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps([used.ru_utime + used.ru_stime, used.ru_maxrss * (1 if sys.platform == "darwin" else 1024) / 1e6]))
"""


def main() -> int:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else FRAMES
    with tempfile.TemporaryDirectory() as folder:
        log, file = Path(folder) / "bus.log", Path(folder) / "bus.pcapng"
        log.write_text("".join(itertools.islice(log_lines(), count)), "utf-8")
        with open_log(str(log)) as frames:
            file.write_bytes(capture(Captured(frame.time or 0, frame.frame) for frame in frames))
        bare, _ = _run(file)
        asleep, _ = _run(file, "-X", f"lua_script:{DISSECTOR}")
        dissecting, memory = _run(file, "-X", f"lua_script:{DISSECTOR}", *CHOSEN)
    return report(
        [
            Measure("no edition chosen, time relative to tshark alone", asleep / bare, at_most=2),
            Measure("an edition chosen, time relative to tshark alone", dissecting / bare, at_most=20),
            Measure("an edition chosen, peak memory, MB", memory, at_most=1000),
        ]
    )


def _run(file: Path, *options: str) -> tuple[float, float]:
    """Seconds of process time, and megabytes."""
    command = [sys.executable, "-c", RUN, tool("tshark"), "-r", str(file), *options]
    seconds, memory = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    return seconds, memory


if __name__ == "__main__":
    sys.exit(main())
