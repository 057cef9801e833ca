"""A sample of edits: the verdicts of a comparison are those of generated code, and the oracle notices wrong ones."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.compare import compare

from ..spec_texts import SMALL, called
from .behaviour import LOUD, RECEIVING, SAFE, SENDING, SILENT
from .compare import OWN, Case, Spec, run


def _case(family: str, name: str, folder: Path) -> Case:
    (file,) = (f for f in (*OWN, *SMALL) if called(f).startswith(f"{family}/"))
    spec = Spec(file, folder)
    (edit,) = (e for e in spec.edits() if e.name == name)
    case = spec.case(edit)
    assert case is not None
    return case


@pytest.mark.parametrize(
    ("family", "edit", "sending", "receiving"),
    [
        ("windlass", "codes of wind and hold swapped", LOUD, SAFE),
        ("oven", "id of addresses stop_all and start_all swapped", SILENT, SAFE),
        ("oven", "status must be requested", SAFE, LOUD),
        ("windlass", "enum mode: parking added", SAFE, SILENT),
        ("pump", "scale of current times 10", SILENT, SAFE),
        ("pump", "set_duty renamed", SAFE, SAFE),
        ("arm", "parameter p_max renamed", SAFE, SAFE),
        ("pump", "commands.status.reply.current narrowed to 8 bits, a field beside it", SAFE, SILENT),
        ("windlass", "commands.wind.request.speed becomes the constant 1: plain", SILENT, SAFE),
        ("windlass", "settings: names of top_speed and brake_delay swapped", SILENT, SAFE),
        ("joint", "commands.get_limit.reply.layout.limit becomes a constant", SAFE, SAFE),
    ],
)
def test_verdicts_agree_with_generated_code(
    family: str, edit: str, sending: int, receiving: int, tmp_path: Path
) -> None:
    sides = _case(family, edit, tmp_path).happened.sides
    assert (sides[SENDING].low, sides[RECEIVING].low) == (sending, receiving)


def test_the_largest_value_of_a_parameter_is_tried(tmp_path: Path) -> None:
    """Numbers of few channels fit into four bits, and all 64 do not."""
    case = _case("mixer", "commands.set_levels.request.channel narrowed to 4 bits", tmp_path)
    assert (case.dangerous, case.reported[SENDING]) == ([], SILENT)


def test_a_sample_of_all_edits(tmp_path: Path) -> None:
    files = [f for f in (*OWN, *SMALL) if f.parent.name in ("blower", "oven", "pump", "windlass")]
    totals = run(files, tmp_path, sample=5)
    assert [c.name for c in totals.cases if c.is_wrong] == []
    assert totals.cases


@pytest.mark.parametrize("kind", ["beside it", "top bit", "becomes the constant", "names of", "in another order"])
def test_verdicts_of_a_sample_of_each_kind_agree_with_generated_code(kind: str, tmp_path: Path) -> None:
    files = [f for f in (*OWN, *SMALL) if f.parent.name in ("arm", "cells", "windlass", "valve")]
    totals = run(files, tmp_path, sample=3, only=kind)
    wrong = [c.name for c in totals.cases if c.dangerous or c.wrong_witnesses or c.ordered or c.missing]
    assert wrong == []
    assert totals.cases


def test_a_wrong_verdict_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "tests.verification.compare.compare",
        lambda old, new: tuple(c._replace(verdicts={}, witnesses=()) for c in compare(old, new)),
    )
    assert _case("pump", "scale of current times 10", tmp_path).dangerous
