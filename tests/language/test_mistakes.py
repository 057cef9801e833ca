"""Mistakes as people make them in a spec, or in its golden frames: all that is told of each, in one run, and no more.

`mistakes/mistakes.txt` has one after the other: what is changed in `heater.yaml` or its frames (`-` is replaced by `+`),
then each finding with what its caret underlines, its message and its hint.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest
from canwright.diagnostics.diagnostic import Diagnostic, SpecError
from canwright.project.loader import load

from ..spec_texts import ROOT

HERE = ROOT / "tests/language/mistakes"


class Mistake(NamedTuple):
    """A name, the changes by file, and what is told."""

    name: str
    changes: list[tuple[str, str, str]]
    told: list[str]


def read(text: str) -> Mistake:
    name, *lines = text.split("\n")
    changes: list[tuple[str, list[str], list[str]]] = []
    told = []
    for line in lines:
        file, mark = ("heater.frames.yaml", line[7:]) if line.startswith("frames ") else ("heater.yaml", line)
        if mark.startswith("- "):
            if not changes or changes[-1][2]:
                changes.append((file, [], []))
            changes[-1][1].append(mark[2:])
        elif mark.startswith("+ "):
            changes[-1][2].append(mark[2:])
        elif line:
            told.append(line)
    return Mistake(name, [(file, "\n".join(old), "\n".join(new)) for file, old, new in changes], told)


MISTAKES = [read(text) for text in (HERE / "mistakes.txt").read_text("utf-8").removeprefix("# ").split("\n\n# ")]
NOT_MEANT = ("frame-contradiction", "missing-frame", "unused")
"""What frames say of a changed spec, and what the spec lacks anyhow."""


def shown(finding: Diagnostic) -> list[str]:
    at = finding.position
    hint = [f"  > {finding.hint}"] if finding.hint else []
    return [f"{finding.rule}: {at.text[at.column - 1 :][: at.length]}", f"  {finding.message}", *hint]


@pytest.mark.parametrize("mistake", MISTAKES, ids=[mistake.name for mistake in MISTAKES])
def test_what_a_mistake_is_told(mistake: Mistake, tmp_path: Path) -> None:
    texts = {name: (HERE / name).read_text("utf-8") for name in ("heater.yaml", "heater.frames.yaml")}
    for name, old, new in mistake.changes:
        assert old in texts[name]
        texts[name] = texts[name].replace(old, new, 1)
    for name, text in texts.items():
        (tmp_path / name).write_text(text, "utf-8")
    with pytest.raises(SpecError) as refused:
        load(tmp_path / "heater.yaml")
    found = [d for d in refused.value.diagnostics if d.rule not in NOT_MEANT]
    assert [line for finding in found for line in shown(finding)] == mistake.told


def test_the_spec_without_a_mistake_is_right() -> None:
    assert {finding.rule for finding in load(HERE / "heater.yaml").warnings} <= {"missing-frame", "unused"}
