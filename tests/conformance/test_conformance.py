"""Every golden frame of every edition, through every target."""

from __future__ import annotations

import dataclasses
import functools
import random
from collections.abc import Callable
from pathlib import Path

import pytest
from canwright.conformance.adapter import Adapter, CanFrame, Decoded, Parameters, Refused
from canwright.conformance.runner import Runner
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.targets.base import EditionInput

from ..samples import sampled
from ..spec_texts import ROOT, SPECS, called
from ..verification.c_survivors import ask_availability, ask_unchecked
from ..verification.differential import compare
from .adapters import ADAPTERS
from .adapters.c import CAdapter
from .adapters.reference import ReferenceAdapter
from .questions import Questions
from .summary import REPORTS

RANDOM = {("c", "cxx", "python", "javascript"): 500, ("dbc",): 12}
"""So many random questions are asked of each target; `python -m tests.verification.differential` asks a million."""

Adapters = Callable[[Path, str], tuple[EditionInput, Adapter]]


@pytest.fixture(scope="module")
def adapters(tmp_path_factory: pytest.TempPathFactory) -> Adapters:
    """The edition of a spec and the adapter of a target, created once."""

    @functools.cache
    def create(spec: Path, target: str) -> tuple[EditionInput, Adapter]:
        item = specification(spec)
        return item, ADAPTERS[target].create(item, tmp_path_factory.mktemp(target))

    return create


@pytest.mark.parametrize("target", ADAPTERS)
@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_golden_frames(spec: Path, target: str, adapters: Adapters) -> None:
    item, adapter = adapters(spec, target)
    assert item.frames is not None, f"{spec.name} has no golden frames beside it"
    report = Runner(item.edition, item.frames, adapter).run()
    REPORTS.append(report)
    assert not report.failures, f"{len(report.failures)} failures\n" + "\n".join(map(str, report.failures[:40]))


UNANSWERED = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
commands:
  dim: {code: 1, request: {level: {at: 1, raw: u16}}, reply: none}
  level: {code: 2, request: none, reply: {level: {at: 1, raw: u16}}}
"""


def test_questions_about_an_edition_without_exchanges(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(UNANSWERED, "utf-8")
    item = specification(tmp_path / "v1.yaml")
    adapters = [ADAPTERS[target].create(item, tmp_path) for target in ("c", "cxx", "python", "javascript")]
    asked = random.Random(1).sample([*Questions(item.edition).round()], 100)
    assert [comparison.disagreements for comparison in compare(item, adapters, asked)] == [[]] * len(adapters)


@pytest.mark.parametrize("spec", sampled(SPECS, 4), ids=called)
def test_random_questions(spec: Path, adapters: Adapters) -> None:
    item = specification(spec)
    every = list(Questions(item.edition).round())
    for targets, most in RANDOM.items():
        asked = random.Random(1).sample(every, min(len(every), most))
        for comparison in compare(item, [adapters(spec, target)[1] for target in targets], asked):
            assert not comparison.disagreements, "\n".join([comparison.target, *comparison.disagreements[:10]])


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_facts_of_c_headers_are_those_of_the_model(spec: Path, adapters: Adapters) -> None:
    _, adapter = adapters(spec, "c")
    assert isinstance(adapter, CAdapter)
    assert adapter.wrong_facts() == []


@pytest.mark.parametrize("target", ["c", "cxx"])
@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_requests_to_nodes_without_the_command_are_rejected(spec: Path, target: str, adapters: Adapters) -> None:
    item, adapter = adapters(spec, target)
    assert isinstance(adapter, CAdapter)
    ask_availability(item.edition, adapter)


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_fields_without_a_check_are_written_whole(spec: Path, adapters: Adapters) -> None:
    item, adapter = adapters(spec, "c")
    assert isinstance(adapter, CAdapter)
    ask_unchecked(item.edition, adapter)


class _OtherMessages(ReferenceAdapter):
    """Decodes every field as it should, as the message of another command."""

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        decoded = super().decode(direction, frame, parameters, expected)
        if not isinstance(decoded, Decoded):
            return decoded
        message = self.message_of(direction, decoded.command)
        commands = [m.command for m in self.edition.messages(direction) if m is not message]
        return dataclasses.replace(decoded, command=commands[0])


def test_a_replay_fails_if_a_frame_is_decoded_as_another_message(tmp_path: Path) -> None:
    item = specification(ROOT / "spec/mwd_motor/v2.35.yaml")
    assert item.frames is not None
    report = Runner(item.edition, item.frames, _OtherMessages.create(item, tmp_path)).run()
    assert not report.passed["decode"] and not report.passed["decode alone"]


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_every_message_has_a_golden_frame(spec: Path) -> None:
    item = specification(spec)
    assert item.frames is not None
    there = {(f.direction, f.command) for f in item.frames.frames}
    for message in item.edition.all_messages():
        assert (message.direction, message.command) in there, f"no golden frame for {message.name}"
