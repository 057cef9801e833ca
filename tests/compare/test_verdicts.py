"""The verdict of a change is what the witnesses say that are about the definition which it changes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from canwright.compare import CHANGES, Category, Change, compare
from canwright.compare.witnesses.witness import REASONS
from canwright.project.loader import specification

from ..spec_texts import MINIMAL, ROOT, edition
from .test_witnesses import MARKERS, START

EXAMPLES = ROOT / "generator/canwright/compare/examples"
WITH_WITNESSES = [rule.id for rule in CHANGES.values() if rule.has_witnesses]
SENT_ENUM = MINIMAL.replace('raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000', "raw: u8, enum: {low: 0, high: 7}")
KEYED = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
tables: {marks: {index: {at: 0, raw: u32}, entries: {first: {index: 0xFFFFFFFE, layout: time}, second: {index: 0xFFFFFFFD, layout: time}}}}
layouts: {time: {fields: {time: {at: 4, raw: u8}}}}
commands:
  mark: {table: marks, request: {}, reply: none}
  dim: {request: {level: {at: 0, raw: u16}, speed: {at: 2, raw: u16}}, reply: none}
"""
FURTHER = {
    "command-added": (MARKERS.replace(START, ""), MARKERS),
    "entry-added": (KEYED.replace(", second: {index: 0xFFFFFFFD, layout: time}", ""), KEYED),
    "member-removed": (SENT_ENUM, SENT_ENUM.replace(", high: 7", "")),
}
"""Editions before and after, where the example of a change is one that affects no program."""


def _changes(rule: str, folder: Path) -> Sequence[Change]:
    """Some changes of one kind: those of its example, of the reverse, and of further editions."""
    old, new = (specification(EXAMPLES / rule / f"{name}.yaml").edition for name in ("previous", "current"))
    texts = FURTHER.get(rule)
    further = compare(edition(folder, texts[0]), edition(folder, texts[1])) if texts else ()
    return [c for c in (*compare(old, new), *compare(new, old), *further) if c.rule.id == rule]


@pytest.mark.parametrize("rule", WITH_WITNESSES)
def test_witnesses_decide_the_verdict_of_every_kind_of_change(rule: str, tmp_path: Path) -> None:
    """A kind that no frame can show is declared in the catalogue, with the reason."""
    changes = _changes(rule, tmp_path)
    assert any(change.witnesses for change in changes)
    for change in changes:
        assert {w.side: w.impact for w in reversed(change.witnesses)}.items() <= change.verdicts.items()


def test_kinds_without_witnesses_have_a_known_reason() -> None:
    without = {rule.without_witness for rule in CHANGES.values()} - {""}
    assert without <= REASONS.keys()
    assert {rule.category for rule in CHANGES.values() if rule.without_witness} <= {Category.WIRE, Category.VALUE}
