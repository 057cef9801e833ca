"""The picture of `canwright monitor` in the README: the view after frames that are computed here, so it is the same each time.

`python -m tests.cli.monitor_picture` writes it.
"""

from __future__ import annotations

import asyncio
import re
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

from canwright.cli.monitor_app import MonitorApp
from canwright.cli.monitor_feed import Feed
from canwright.cli.monitor_view import Sources, status_parts
from canwright.project.loader import specification
from canwright.recordings.directions import Directions
from canwright.recordings.latest_values import SECOND, LatestValues, Status
from canwright.recordings.log_frame import LogFrame
from canwright.recordings.rows import RowReader
from canwright.semantics.frame import CanFrame

from ..spec_texts import ROOT

PICTURE = Path(__file__).with_name("monitor.svg")
_SPEC = "v2.36-2025-03"
_SIZE = 96, 23
MS = SECOND // 1000
END = 3 * SECOND
_HOSTS = re.compile(r"\s*@font-face \{.*?\}|\s*<!--.*?-->", re.DOTALL)
"""Fonts of another host, without which a browser takes a font of its own, and a remark."""


def frames() -> Iterator[LogFrame]:
    """Nodes 1 and 2 are asked 100 times a second for two seconds; the last frame is too short."""
    for number in range(200):
        for node in (1, 2):
            state = (
                bytes([0x9A, 30 + node]),
                (4832 - number % 9).to_bytes(2, "little"),
                bytes([120 + number % 5, 0, 0, 0]),
            )
            angle = b"\x92", (9000 + 25 * number * node).to_bytes(7, "little")
            at = SECOND + (number * 10 + node) * MS
            for parts in (state, angle):
                reply = b"".join(parts)
                yield LogFrame(at, "", CanFrame(0x140 + node, reply[:1] + bytes(7)), None)
                yield LogFrame(at + 270_000, "", CanFrame(0x180 + node, reply), None)
                at += MS // 2
    yield LogFrame(END - MS, "", CanFrame(0x182, b"\x9a\x20"), None)


class Scene(Feed):
    """A feed that has ended, of a bus that is recorded."""

    def __init__(self) -> None:
        self.error = ""
        self.ended = threading.Event()
        self.table = LatestValues()
        self.source = cast("Any", SimpleNamespace(now=lambda: END))
        reader = RowReader(lambda *_: {"series": "MG", "encoder_bits": "14"})
        edition = specification(ROOT / f"spec/mwd_motor/{_SPEC}.yaml").edition
        self._status: list[Status] = []
        for row in reader.rows(Directions({}, edition).classify(frames())):
            self.table.add(row)
            if len(self._status) < 2 and row.judged.number in (400, 1200):
                self._status.append(self.table.status(row.judged.recorded.time or 0))

    @property
    def recording(self) -> Any:
        return SimpleNamespace()

    def status_parts(self) -> Iterator[str]:
        whole = self.table.status(0)._replace(rate=self._status[1].rate, bits=self._status[1].bits)
        return status_parts(whole, Sources(0, 1_000_000, ("bench.log", whole.frames), ""))


def picture() -> str:
    """The picture as SVG."""

    async def painted() -> str:
        app = MonitorApp(Scene(), [], "node=1..2")
        app.title = "canwright monitor"
        async with app.run_test(size=_SIZE) as pilot:
            app.renew()
            before = ""
            while (shown := app.export_screenshot()) != before:  # a busy machine paints late
                before = shown
                await pilot.pause(0.1)
            return shown

    return _HOSTS.sub("", asyncio.run(painted())) + "\n"


if __name__ == "__main__":
    PICTURE.write_text(picture(), "utf-8")
