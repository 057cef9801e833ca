"""Typical mistakes in a spec or its golden frames, and the exact findings of one run.

`mistakes/mistakes.txt` lists the changes of `heater.yaml` and, after `F`, in its golden frames: `old => new`, with
`||` between alternatives that give the same findings and `;;` between changes made together. Each finding follows on a
separate line after `!`: position, rule, and a part of its hint, or of its message if it has no hint.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import pytest
from canwright.diagnostics.diagnostic import SpecError
from canwright.project.loader import load

from ..spec_texts import ROOT

HERE = ROOT / "tests/language/mistakes"
SPEC, FRAMES = "heater.yaml", "heater.frames.yaml"


class Mistake(NamedTuple):
    """Changes by file, and the findings: file, position and rule, with a part of the hint."""

    changes: list[tuple[str, str, str]]
    findings: list[tuple[str, str]]


def read(lines: list[str]) -> dict[str, Mistake]:
    mistakes: dict[str, Mistake] = {}
    findings: list[tuple[str, str]] = []
    for line in lines:
        if line.startswith("! "):
            place, _, fact = line[2:].partition(": ")
            findings.append((place, fact))
            continue
        findings = []
        changes = [part.partition(" => ") for part in line.split(" ;; ")]
        for alternative in changes[-1][2].split(" || "):
            alternatives = [*changes[:-1], (*changes[-1][:2], alternative)]
            name = f"{changes[0][0]} => {' ;; '.join(new for _, _, new in alternatives)}"
            assert name not in mistakes, line
            mistakes[name] = Mistake([change(old, new) for old, _, new in alternatives], findings)
    return mistakes


def change(old: str, new: str) -> tuple[str, str, str]:
    file = FRAMES if old.startswith("F ") else SPEC
    return file, old.removeprefix("F ").replace("\\n", "\n"), new.replace("\\n", "\n")


MISTAKES = read((HERE / "mistakes.txt").read_text("utf-8").splitlines())


@pytest.mark.parametrize("name", MISTAKES)
def test_findings_about_a_mistake(name: str, tmp_path: Path) -> None:
    texts = {file: (HERE / file).read_text("utf-8") for file in (SPEC, FRAMES)}
    for file, old, new in MISTAKES[name].changes:
        assert old in texts[file]
        texts[file] = texts[file].replace(old, new, 1)
    for file, text in texts.items():
        (tmp_path / file).write_text(text, "utf-8")
    with pytest.raises(SpecError) as refused:
        load(tmp_path / SPEC)
    reported = [
        (f"{'F ' if d.position.file.endswith(FRAMES) else ''}{d.position.line}:{d.position.column} {d.rule}", d)
        for d in refused.value.diagnostics
    ]
    expected = MISTAKES[name].findings
    assert [place for place, _ in reported] == [place for place, _ in expected]
    for (_, diagnostic), (_, fact) in zip(reported, expected, strict=True):
        assert fact in (diagnostic.hint or diagnostic.message)


def test_the_spec_without_a_mistake_is_valid() -> None:
    assert {finding.rule for finding in load(HERE / SPEC).warnings} <= {"missing-frame", "unused"}


def test_no_suggestion_omits_a_part(tmp_path: Path) -> None:
    """`360/counts` is not 360."""
    text = (HERE / SPEC).read_text("utf-8")
    for scale in ("360/counts", "360 / 2^14", "10%", "2 pi", "5 k", "raw / 10 + 3"):
        (tmp_path / SPEC).write_text(text.replace("scale: 0.1", f'scale: "{scale}"'), "utf-8")
        with pytest.raises(SpecError) as refused:
            load(tmp_path / SPEC)
        assert not [d.hint for d in refused.value.diagnostics if re.search(r"did you mean `[0-9./-]+`", d.hint)], scale
