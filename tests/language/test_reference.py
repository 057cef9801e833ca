"""The page about the language: generated from the schema, with valid specs."""

from __future__ import annotations

import re
import shlex
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

from ..compilers import ZIG
from ..spec_texts import ROOT

PAGE = (ROOT / "spec/README.md").read_text("utf-8")
BLOCKS: list[dict[str, Any]] = [yaml.safe_load(block) for block in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)]
SPEC, FRAMES, START, *PARTS = BLOCKS


def test_the_page_is_up_to_date() -> None:
    page = CliRunner().invoke(main, ["schema", "--page"]).output
    assert page == PAGE, "run `canwright schema --page > spec/README.md`"


def test_every_key_is_on_the_page_and_explained() -> None:
    every = PAGE.partition("## Every key")[2]
    for concept in reference.concepts():
        assert f"\n### {concept.name}\n" in every
        for key in concept.keys:
            assert key.name in ("title", "about") or f"\n| `{key.name}`" in every
            assert any(line.startswith(f"{key.name} of ") for line in reference.explained(key.name))
    assert set(re.findall(r"\]\(#([a-z-]+)\)", every)) <= {c.name.replace(" ", "-") for c in reference.concepts()}


def test_explain_describes_keys_and_rules() -> None:
    output = CliRunner().invoke(main, ["explain", "value"]).output
    assert "value of `member`, `name`:" in output
    assert "value (error)" in output
    assert "\n  flags:" in CliRunner().invoke(main, ["explain", "type"]).output
    unknown = CliRunner().invoke(main, ["explain", "selektor"])
    assert (unknown.exit_code, "did you mean `selector`?" in unknown.output) == (2, True)


def test_a_page_of_a_manual_becomes_a_tested_spec_as_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", shlex.join(ZIG.c))
    monkeypatch.chdir(tmp_path)
    spec = Path("spec/battery_monitor/v1.yaml")
    frames = spec.with_name("v1.frames.yaml")
    blocks = re.findall(r"^```\w+\n(.*?)^```$", PAGE.partition("## Limits")[0], re.MULTILINE | re.DOTALL)
    manual, init, described, skeletons, golden, test, table, wrong, generate = blocks
    run(init)
    assert spec.is_file() and frames.is_file()
    spec.write_text(described, "utf-8")
    run(skeletons)
    assert frames.read_text("utf-8").partition("frames:\n")[0] == golden.partition("frames:\n")[0]
    assert frames.read_text("utf-8").count("__ __ __ __ __ __ __ __") == golden.count("data: ")
    frames.write_text(golden, "utf-8")
    for data in re.findall(r'data: "(.*?)"', golden):
        assert data in manual
    assert run(test) == (table, "")
    spec.write_text(described.replace("scale: 0.1}", "scale: 0.01}"), "utf-8")
    assert run(test, status=1) == ("", f"{wrong}1 error; `canwright explain RULE` explains a rule\n")
    spec.write_text(described, "utf-8")
    run(generate)
    for output in re.findall(r"`(?:pip install ./)?(generated/[\w/]+)`", PAGE):
        assert Path(output).is_dir()


def run(command: str, status: int = 0) -> tuple[str, str]:
    """What a command of the page prints on standard output and on standard error; `> FILE` empties a file and writes it."""
    line, _, file = command.strip().partition(" > ")
    program, *arguments = shlex.split(line)
    assert program == "canwright"
    if file:
        Path(file).write_bytes(b"")
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert result.exit_code == status, result.output
    if file:
        Path(file).write_text(result.stdout, "utf-8")
    return result.stdout, result.stderr


@pytest.mark.parametrize("part", PARTS, ids=lambda part: ",".join(part))
def test_every_example_is_valid_in_the_first_spec(tmp_path: Path, part: dict[str, Any]) -> None:
    whole = START | part | {"types": START["types"] | part.get("types", {})}
    whole["canwright"], whole["family"] = 1, "lamp"
    allowed = {"missing-frame", "unused"}
    assert [str(d) for d in load(written(tmp_path, whole)).warnings if d.rule not in allowed] == []


def written(folder: Path, spec: dict[str, Any]) -> Path:
    file = folder / "lamp.yaml"
    file.write_text(yaml.dump(spec, Dumper=Plain, sort_keys=False), "utf-8")
    return file


class Plain(yaml.SafeDumper):
    """Writes no aliases."""

    def ignore_aliases(self, data: object) -> bool:
        return True


def test_the_table_of_starts_is_correct() -> None:
    rows = re.findall(r"^\| (by.*?|12.*?) \| (.*?) ?\| (.*?) ?\|$", PAGE, re.MULTILINE)
    runs = [(text, little, big) for text, little, big in rows if "[" in little + big]
    assert (len(rows), len(runs)) == (7, 1)
    for text, little, big in rows:
        if (text, little, big) in runs:  # of several runs, see tests/resolve
            continue
        for order, starts in ((Order.LITTLE, little), (Order.BIG, big)):
            for start in re.findall(r"`(.*?)`", starts):
                bits = bits_of_row(text)
                assert sorted(frame_bits(at(start), len(bits), order)) == sorted(bits), (text, start)


def bits_of_row(text: str) -> list[int]:
    """The frame bits of a row of the table."""
    if text == "bytes 2 and 3":
        return list(range(16, 32))
    if text.startswith("12 bits"):
        return [*range(16, 24), *(range(28, 32) if "top of byte 3" in text else range(24, 28))]
    first, last = (re.findall(r"\d", text)[1:] * 2)[:2]
    return list(range(16 + int(first), 17 + int(last)))
