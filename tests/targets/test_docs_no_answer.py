"""The page of causes why a device does not answer: its commands can be run, and other pages lead to it."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.project.loader import specification
from canwright.semantics.encoder import Encoder
from canwright.targets.docs.target import TARGET
from click import Context

from ..spec_texts import MINIMAL, ROOT

PAGES = ROOT / "generated/docs"
CAUSES = ["power", "bit_rate", "termination", "error_frames", "id", "edition", "mode", "series", "time"]


def commands(language: str) -> list[str]:
    """The lines of all blocks, with what follows a pipe."""
    page = (PAGES / language / "no-answer.md").read_text("utf-8")
    lines = (line for block in re.findall(r"```sh\n(.*?)```", page, re.DOTALL) for line in block.splitlines())
    return [part.strip() for line in lines for part in line.split("|")]


@pytest.mark.parametrize("language", ["en", "zh"])
def test_every_cause_has_commands_whose_options_exist(language: str) -> None:
    page = (PAGES / language / "no-answer.md").read_text("utf-8")
    assert re.findall(r'<a id="no-answer\.(\w+)">', page) == CAUSES
    assert page.count("```sh\n") == len(CAUSES)
    ours = [shlex.split(line)[1:] for line in commands(language) if line.startswith("canwright ")]
    assert {name for name, *_ in ours} == {"scan", "show", "decode", "identify", "encode", "request", "monitor"}
    for name, *arguments in ours:
        command = main.get_command(Context(main), name)
        assert command
        command.make_context(name, arguments)
    programs = {line.split()[0] for line in commands(language)}
    assert programs == {"canwright", "ip", "sudo", "candump", "cansend"}


def test_the_frame_by_hand_is_that_of_the_command() -> None:
    edition = specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition
    request = edition.command("broadcast_torque").request
    assert request
    frame = Encoder({}).encode_raws(request, None, {"iq": [0, 0, 0, 0]})
    assert f"cansend can0 {frame.id:03X}#{frame.data.hex()}" in commands("en")  # type: ignore[union-attr]


@pytest.mark.parametrize("language", ["en", "zh"])
def test_other_pages_lead_to_it(language: str) -> None:
    for page in ("index", "quickstart", "questions"):
        assert "](no-answer.md)" in (PAGES / language / f"{page}.md").read_text("utf-8")


def test_a_family_without_causes_has_no_such_page(tmp_path: Path) -> None:
    spec = tmp_path / "lamp.yaml"
    spec.write_text(MINIMAL, "utf-8")
    outputs = {output.path: output.text for output in TARGET.generate([specification(spec)], {})}
    assert "en/index.md" in outputs and "en/no-answer.md" not in outputs
    assert not any("no-answer" in str(text) for text in outputs.values())
