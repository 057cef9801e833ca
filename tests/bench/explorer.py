"""How long the frame explorer blocks its page while it reads a log of 100,000 lines: `python -m tests.bench.explorer`.

A timer of the page measures the time between two of its turns, which a click would have to wait too.
"""

from __future__ import annotations

import itertools
import sys
import tempfile
from pathlib import Path

from ..project.browser import browser
from ..spec_texts import ROOT
from .bars import Measure, report
from .recordings import log_lines

PAGE = ROOT / "generated/javascript/explorer/index.html"
LINES = 100_000
WATCH = """() => {
  window.longest = 0;
  let last = performance.now();
  setInterval(() => {
    const now = performance.now();
    window.longest = Math.max(window.longest, now - last);
    last = now;
  });
}"""


def main() -> int:
    with tempfile.TemporaryDirectory() as folder, browser() as chromium:
        log = Path(folder) / "bus.log"
        log.write_text("".join(itertools.islice(log_lines(), LINES)), "utf-8")
        page = chromium.new_page()
        page.goto(PAGE.as_uri())
        page.evaluate(WATCH)
        page.locator("#file").set_input_files(log)
        page.wait_for_selector(f"#log-position:has-text('/ {LINES}')")
        page.wait_for_selector("#log-rows tr:nth-child(100)")
        return report([Measure("longest time in which the page is blocked, ms", page.evaluate("longest"), at_most=50)])


if __name__ == "__main__":
    sys.exit(main())
