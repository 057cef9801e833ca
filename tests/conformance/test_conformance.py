"""Every golden frame of every edition, through every target."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.project.loader import described

from ..semantics.random_frames import random_frames
from ..spec_texts import ROOT, SPECS, called
from .adapter import Adapter, CanFrame, Decoded, Parameters, Refused
from .adapters import ADAPTERS
from .adapters.reference import ReferenceAdapter
from .runner import Runner
from .summary import REPORTS

RANDOM_FRAMES = 400


@pytest.mark.parametrize("target", ADAPTERS)
@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_golden_frames(spec: Path, target: str, tmp_path: Path) -> None:
    item = described(spec)
    assert item.frames is not None, f"{spec.name} has no golden frames beside it"
    adapter = ADAPTERS[target].create(item, tmp_path)
    report = Runner(item.edition, item.frames, adapter).run()
    REPORTS.append(report)
    assert not report.failures, f"{len(report.failures)} failures\n" + "\n".join(report.failures[:40])
    if target in ("c", "python"):
        _compare_random_frames(item.edition, adapter)


def _compare_random_frames(edition: Edition, adapter: Adapter) -> None:
    """Every frame is the same message with the same fields as for the reference decoder, or rejected for the same reason."""
    reference = ReferenceAdapter(edition)
    known = {parameter.name: parameter.values[0].name for parameter in edition.parameters if parameter.is_choice}
    for frame in random_frames(edition, RANDOM_FRAMES):
        for direction in Direction:
            wanted, found = (one.decode(direction, frame, known, None) for one in (reference, adapter))
            if isinstance(wanted, Decoded) and isinstance(found, Decoded):
                there = (wanted.command, wanted.node, wanted.raw)
                assert (found.command, found.node, found.raw) == there, (direction, frame)
            else:
                assert isinstance(wanted, Refused) and isinstance(found, Refused), (direction, frame, wanted, found)
                assert found.says is wanted.says, (direction, frame)


class _OtherMessages(ReferenceAdapter):
    """Decodes every field as it should, as the message of another command."""

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        found = super().decode(direction, frame, parameters, expected)
        if not isinstance(found, Decoded):
            return found
        message = self.message_of(direction, found.command)
        others = [m.command for m in self.edition.messages(direction) if m is not message]
        return dataclasses.replace(found, command=others[0])


def test_another_message_with_the_same_fields_fails(tmp_path: Path) -> None:
    item = described(ROOT / "spec/mwd_motor/v2.35.yaml")
    assert item.frames is not None
    report = Runner(item.edition, item.frames, _OtherMessages.create(item, tmp_path)).run()
    assert not report.passed["decode"] and not report.passed["decode alone"]


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_every_message_has_a_golden_frame(spec: Path) -> None:
    item = described(spec)
    assert item.frames is not None
    there = {(f.direction, f.command) for f in item.frames.frames}
    for message in item.edition.all_messages():
        assert (message.direction, message.command) in there, f"no golden frame for {message.name}"
