"""`canwright copy`: a new edition starts as a copy of another one."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.cli import main
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL

OLD = "# kept\n" + MINIMAL.replace("edition: v1\n", "edition: v1   # the label\n")
FRAMES = """\
canwright: 1
family: lamp
edition: v1
sources: {manual: The manual.}
frames:
  - {request: dim, id: 0x101, node: 1, data: 10 00 64 00 00 00 00 00, raw: {level: 100}, values: {level: 10}, source: manual}
"""


@pytest.fixture
def lamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "spec" / "lamp"
    folder.mkdir(parents=True)
    (folder / "v1.yaml").write_text(OLD, "utf-8")
    (folder / "v1.frames.yaml").write_text(FRAMES, "utf-8")
    monkeypatch.chdir(tmp_path)
    return folder


def copy(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["copy", *arguments])


def test_a_copied_edition_differs_only_in_label_and_date(lamp: Path) -> None:
    result = copy("v1", "v2", "--date", "2026-01")
    assert (result.exit_code, result.stdout) == (0, "wrote spec/lamp/v2.yaml\nwrote spec/lamp/v2.frames.yaml\n")
    assert result.stderr.endswith("; then run: canwright diff v1 v2\n")
    made = (lamp / "v2.yaml").read_text("utf-8")
    assert made == OLD.replace("edition: v1   # the label\n", "edition: v2   # the label\ndate: 2026-01\n")
    assert (lamp / "v2.frames.yaml").read_text("utf-8") == FRAMES.replace("edition: v1", "edition: v2")
    assert copy("v2", "v3", "--date", "2026-02").exit_code == 0
    assert (lamp / "v3.yaml").read_text("utf-8") == made.replace("v2", "v3").replace("2026-01", "2026-02")


def test_copy_without_golden_frames(lamp: Path) -> None:
    result = copy("spec/lamp/v1.yaml", "v2", "--no-frames")
    assert result.stdout == "wrote spec/lamp/v2.yaml\n"
    assert result.stderr.endswith("; then run: canwright diff spec/lamp/v1.yaml spec/lamp/v2.yaml\n")
    assert not (lamp / "v2.frames.yaml").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("v1", "v1"), "spec/lamp/v1.yaml exists already; nothing was written"),
        (("v1", "v2.yaml"), "`v2.yaml` is a file name; give the name of the edition: v2"),
        (("v1", "../v2"), "`../v2` is not a valid edition"),
        (("v1", "v2", "--date", "soon"), "`soon` is not a valid date"),
        (("v11", "v2"), "did you mean `v1`?"),
        (("bad", "v2"), "has errors; correct them first"),
    ],
)
def test_invalid_arguments_of_copy_are_rejected(arguments: tuple[str, ...], says: str, lamp: Path) -> None:
    (lamp / "bad.yaml").write_text(OLD.replace("reply: echo", "reply: eco"), "utf-8")
    before = sorted(file.name for file in lamp.iterdir())
    result = copy(*arguments)
    assert (result.exit_code, says in result.output) == (2, True), result.output
    assert sorted(file.name for file in lamp.iterdir()) == before


def test_copy_never_overwrites_golden_frames(lamp: Path) -> None:
    (lamp / "v2.frames.yaml").write_text("mine", "utf-8")
    assert "v2.frames.yaml exists already" in copy("v1", "v2").output
    assert not (lamp / "v2.yaml").exists()
    assert (lamp / "v2.frames.yaml").read_text("utf-8") == "mine"
