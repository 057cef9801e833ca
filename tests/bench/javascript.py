"""Speed of the generated JavaScript, beside a function by hand: `python -m tests.bench.javascript`.

Four replies of a motor are decoded to values in units. By hand, it is one `switch` with a `DataView`, which checks the id
and the length and nothing else.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from ..node import NODE
from ..spec_texts import ROOT
from .bars import Measure, report

PROGRAM = Path(__file__).with_suffix(".mjs")
MODULE = ROOT / "generated/javascript/mwd_motor/v2_35.js"


def main() -> int:
    ratios = json.loads(subprocess.run([NODE, PROGRAM, MODULE.as_uri()], check=True, stdout=subprocess.PIPE).stdout)
    return report(
        [
            Measure("decodeReply, beside by hand", ratios["decode"], at_most=8),
            Measure("decodeAnswer, beside decodeReply", ratios["decodeAnswer"], at_most=2),
            Measure("a foreign frame, beside decodeReply", ratios["foreign"], at_most=1),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
