"""Replays the golden frames of `tank` with frames of up to 24 bytes: `python -m tests.conformance.long_frames TARGET`.

The maximum number of data bytes is read when modules are imported, so it is changed in a process of its own.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from canwright.model import layout

layout.MAX_DATA_BYTES = 24

from canwright.project.loader import specification  # noqa: E402

from ..adapters import ADAPTERS  # noqa: E402
from ..runner import Runner  # noqa: E402

SPEC = Path(__file__).parent / "tank" / "v1.yaml"


def main(target: str) -> int:
    """The number of failures, after their sentences and the cases that passed."""
    item = specification(SPEC)
    assert item.frames is not None
    with tempfile.TemporaryDirectory() as folder:
        report = Runner(item.edition, item.frames, ADAPTERS[target].create(item, Path(folder))).run()
    for failure in report.failures:
        print(failure)
    print(dict(report.passed), dict(report.exceptions))
    return len(report.failures)


if __name__ == "__main__":
    sys.exit(bool(main(sys.argv[1])))
