"""Every golden frame of every edition, through every target."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.project.loader import described

from ..spec_texts import SPECS, called
from .adapters import ADAPTERS
from .runner import Runner
from .summary import REPORTS


@pytest.mark.parametrize("target", ADAPTERS)
@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_golden_frames(spec: Path, target: str, tmp_path: Path) -> None:
    item = described(spec)
    assert item.frames is not None, f"{spec.name} has no golden frames beside it"
    report = Runner(item.edition, item.frames, ADAPTERS[target].create(item, tmp_path)).run()
    REPORTS.append(report)
    assert not report.failures, f"{len(report.failures)} failures\n" + "\n".join(report.failures[:40])


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_every_message_has_a_golden_frame(spec: Path) -> None:
    item = described(spec)
    assert item.frames is not None
    there = {(f.direction, f.command) for f in item.frames.frames}
    for message in item.edition.all_messages():
        assert (message.direction, message.command) in there, f"no golden frame for {message.name}"
