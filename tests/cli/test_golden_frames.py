"""Golden frames and targets are loaded by the commands that use them, and by no other."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest
from canwright.cli import main
from click.testing import CliRunner

from ..spec_texts import MINIMAL

USERS = (["check"], ["generate", "--no-cache"], ["handover", "--out", "documents"])
OTHERS = (["show", "dim"], ["editions"], ["decode", "101#1000640000000000"])


@pytest.mark.parametrize("arguments", [*USERS, *OTHERS], ids=lambda arguments: arguments[0])
def test_golden_frames_with_an_error_affect_only_their_users(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "spec" / "lamp"
    folder.mkdir(parents=True)
    (folder / "v1.yaml").write_text(MINIMAL, "utf-8")
    (folder / "v1.frames.yaml").write_text("frames: [", "utf-8")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, arguments)
    assert ("v1.frames.yaml" in result.output) == (arguments in USERS)
    assert (result.exit_code == 0) == (arguments not in USERS)


@pytest.mark.parametrize("command", ["check", "editions"])
def test_names_that_a_target_cannot_use_affect_only_output(command: str) -> None:
    spec = files("canwright.rules") / "examples/name-collision/bad.yaml"
    result = CliRunner().invoke(main, [command, "--spec", str(spec)])
    assert ("[name-collision]" in result.output) == (command == "check")
