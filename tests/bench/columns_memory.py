"""Decodes a log, writes its tables as Parquet and prints the peak of this process in MB.

With a spec, the directions are inferred. Imports nothing that these do not need.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

PARAMETERS = {"series": "MG", "encoder_bits": 18}


def main(package: str, log: str, *spec: str) -> None:
    sys.path.insert(0, package)
    from mwd_motor_columns import Direction, arrow, logs, v2_35  # type: ignore[import-not-found]

    blocks = logs.Log(log, received=Direction.REPLY)
    if spec:
        import canwright
        from canwright.recordings.direction_arrays import infer_directions

        blocks = infer_directions(blocks, canwright.load(*spec).edition)
    with tempfile.TemporaryDirectory() as folder, arrow.ParquetWriter(v2_35.decoder(PARAMETERS), folder) as writer:
        for frames in blocks:
            writer.add(frames)
    status = Path("/proc/self/status").read_text("ascii")  # `getrusage` includes the peak of the parent process
    print(int(status.partition("VmHWM:")[2].split()[0]) / 1024)


if __name__ == "__main__":
    main(*sys.argv[1:])
