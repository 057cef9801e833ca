"""The command reports wrong answers, and asks the same again; `conformance` asks every target a sample."""

from __future__ import annotations

import itertools

import pytest
from canwright.conformance.adapter import CanFrame, Decoded, Parameters, Refused
from canwright.model.message import Direction
from canwright.project.loader import specification

from ..conformance.adapters import ADAPTERS
from ..conformance.adapters.reference import ReferenceAdapter
from ..conformance.questions import Questions
from ..spec_texts import ROOT
from .differential import main


class _Careless(ReferenceAdapter):
    """Accepts a frame of any length."""

    name = "python"

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        longer = frame._replace(data=frame.data.ljust(8, b"\0"))
        return super().decode(direction, frame if frame.remote else longer, parameters, expected)


def test_a_wrong_answer_is_reported(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(ADAPTERS, "python", _Careless)
    assert main(["--questions", "3000", "--edition", "v2.35", "--targets", "python"]) == 1
    assert "wrong_length" in capsys.readouterr().out


def test_equal_seeds_give_equal_questions() -> None:
    edition = specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition
    first, same, different = (list(itertools.islice(Questions(edition, seed).forever(), 500)) for seed in (1, 1, 2))
    assert first == same != different
