"""The page about the language: made from the schema, and every spec in it is right."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.cli import main
from canwright.language import reference
from canwright.language.notation import at, frame_bits
from canwright.model.types import Order
from canwright.project.loader import load
from click.testing import CliRunner

from ..spec_texts import ROOT

PAGE = (ROOT / "spec/README.md").read_text("utf-8")
BLOCKS: list[dict[str, Any]] = [yaml.safe_load(block) for block in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)]
START, FRAMES, *PARTS = BLOCKS


def test_the_page_is_that_of_the_language() -> None:
    assert reference.page() == PAGE, "run `canwright schema --page > spec/README.md`"
    assert CliRunner().invoke(main, ["schema", "--page"]).output == PAGE


def test_every_key_stands_on_the_page_and_is_explained() -> None:
    every = PAGE.partition("## Every key")[2]
    for concept in reference.concepts():
        assert f"\n### {concept.name}\n" in every
        for key in concept.keys:
            assert key.name in ("title", "about") or f"\n| `{key.name}`" in every
            assert any(line.startswith(f"{key.name} of ") for line in reference.explained(key.name))
    assert set(re.findall(r"\]\(#([a-z-]+)\)", every)) <= {c.name.replace(" ", "-") for c in reference.concepts()}


def test_explain_says_what_a_key_is_and_what_a_rule_wants() -> None:
    said = CliRunner().invoke(main, ["explain", "value"]).output
    assert "value of `member`: The raw value that has this name." in said
    assert "A value has the notation of its key." in said
    assert "flags: The bits that have a name" in CliRunner().invoke(main, ["explain", "type"]).output
    unknown = CliRunner().invoke(main, ["explain", "selektor"])
    assert (unknown.exit_code, "did you mean `selector`?" in unknown.output) == (2, True)


def test_the_start_and_its_golden_frames(tmp_path: Path) -> None:
    lamp = written(tmp_path, START)
    (tmp_path / "lamp.frames.yaml").write_text(yaml.safe_dump(FRAMES), "utf-8")
    assert [finding.message for finding in load(lamp).warnings] == [
        "the reply of `dim` has no golden frame",
        "the request of `read_level` has no golden frame",
    ]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: ",".join(part))
def test_every_part_fits_into_the_start(tmp_path: Path, part: dict[str, Any]) -> None:
    whole = START | part | {"types": START["types"] | part.get("types", {})}
    whole["canwright"], whole["family"] = 1, "lamp"
    allowed = {"missing-frame", "unused"}
    assert [str(d) for d in load(written(tmp_path, whole)).warnings if d.rule not in allowed] == []


def written(folder: Path, spec: dict[str, Any]) -> Path:
    file = folder / "lamp.yaml"
    file.write_text(yaml.dump(spec, Dumper=Plain, sort_keys=False), "utf-8")
    return file


class Plain(yaml.SafeDumper):
    """Says everything where it stands."""

    def ignore_aliases(self, data: object) -> bool:
        return True


def test_where_a_field_starts() -> None:
    rows = re.findall(r"^\| (by.*?|12.*?) \| (.*?) ?\| (.*?) ?\|$", PAGE, re.MULTILINE)
    assert len(rows) == 6
    for what, little, big in rows:
        for order, starts in ((Order.LITTLE, little), (Order.BIG, big)):
            for start in re.findall(r"`(.*?)`", starts):
                bits = wanted(what)
                assert sorted(frame_bits(at(start), len(bits), order)) == sorted(bits), (what, start)


def wanted(what: str) -> list[int]:
    """The bits of a frame that a row of the table speaks of."""
    if what == "bytes 2 and 3":
        return list(range(16, 32))
    if what.startswith("12 bits"):
        return [*range(16, 24), *(range(28, 32) if "top of byte 3" in what else range(24, 28))]
    first, last = (re.findall(r"\d", what)[1:] * 2)[:2]
    return list(range(16 + int(first), 17 + int(last)))
