"""`canwright copy`: a new edition starts as a copy of another one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

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


def test_copy_differs_only_in_label_and_date(lamp: Path) -> None:
    result = copy("v1", "v2", "--date", "2026-01")
    assert (result.exit_code, result.stdout) == (0, "wrote spec/lamp/v2.yaml\nwrote spec/lamp/v2.frames.yaml\n")
    assert result.stderr.endswith("; then run: canwright diff v1 v2\n")
    made = (lamp / "v2.yaml").read_text("utf-8")
    assert made == OLD.replace("edition: v1   # the label\n", "edition: v2   # the label\ndate: 2026-01\n")
    assert (lamp / "v2.frames.yaml").read_text("utf-8") == FRAMES.replace("edition: v1", "edition: v2")
    assert copy("v2", "v3", "--date", "2026-02").exit_code == 0
    assert (lamp / "v3.yaml").read_text("utf-8") == made.replace("v2", "v3").replace("2026-01", "2026-02")


def test_a_label_or_a_date_that_would_be_a_number_is_quoted(lamp: Path) -> None:
    assert copy("v1", "6.05", "--date", "2026").exit_code == 0
    made = (lamp / "6.05.yaml").read_text("utf-8")
    assert made == OLD.replace("edition: v1   # the label\n", 'edition: "6.05"   # the label\ndate: "2026"\n')
    assert (lamp / "6.05.frames.yaml").read_text("utf-8") == FRAMES.replace("edition: v1", 'edition: "6.05"')
    assert copy("6.05", "6.06", "--date", "2027").exit_code == 0
    assert (lamp / "6.06.yaml").read_text("utf-8") == made.replace("6.05", "6.06").replace("2026", "2027")


def test_an_edition_in_a_file_of_another_name_is_named(lamp: Path) -> None:
    (lamp / "v1.yaml").write_text(OLD.replace("edition: v1 ", 'edition: "6.05" '), "utf-8")
    says = "no file has the name of the edition `6.05`; write `lamp/v1`, or rename that file to 6.05.yaml"
    assert says in copy("6.05", "6.06").output


def test_no_frames_copies_the_spec_without_golden_frames(lamp: Path) -> None:
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
def test_invalid_arguments_are_rejected(arguments: tuple[str, ...], says: str, lamp: Path) -> None:
    (lamp / "bad.yaml").write_text(OLD.replace("reply: echo", "reply: eco"), "utf-8")
    before = sorted(file.name for file in lamp.iterdir())
    result = copy(*arguments)
    assert (result.exit_code, says in result.output) == (2, True), result.output
    assert sorted(file.name for file in lamp.iterdir()) == before


def test_existing_golden_frames_are_not_overwritten(lamp: Path) -> None:
    (lamp / "v2.frames.yaml").write_text("mine", "utf-8")
    assert "v2.frames.yaml exists already" in copy("v1", "v2").output
    assert not (lamp / "v2.yaml").exists()
    assert (lamp / "v2.frames.yaml").read_text("utf-8") == "mine"


def test_an_edition_of_the_package_is_copied_unchanged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "package" / "lamp"
    package.mkdir(parents=True)
    (package / "v1.yaml").write_text(OLD, "utf-8")
    (package / "v1.frames.yaml").write_text(FRAMES, "utf-8")
    for module in ("cli.copy", "cli.common", "project.references"):
        monkeypatch.setattr(f"canwright.{module}.SPECS", package.parent)
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.chdir(home)
    run = CliRunner().invoke
    assert "lamp" in run(main, ["editions"]).stdout
    assert "dim" in run(main, ["show", "dim"]).stdout
    assert run(main, ["diff", "lamp/v1", "v1"]).exit_code == 0
    assert "--date is for a new edition" in copy("v1", "--date", "2026-01").output
    result = copy("lamp/v1")
    assert result.stdout == "wrote spec/lamp/v1.yaml\nwrote spec/lamp/v1.frames.yaml\n", result.output
    assert Path("spec/lamp/v1.yaml").read_text("utf-8") == OLD
    assert Path("spec/lamp/v1.frames.yaml").read_text("utf-8") == FRAMES
    assert "give the name of the new edition" in copy("lamp/v1").output
    assert copy("lamp/v1", "v2").exit_code == 0, "now it is an edition of spec/"
    Path("spec").rename("mine")
    assert copy("lamp/v1", "mine/lamp").exit_code == 2
    assert copy("lamp/v1", "other/place").stdout.startswith("wrote other/place/v1.yaml\n")


def test_nothing_is_written_if_a_write_fails(lamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original = Path.open

    def fails(self: Path, mode: str = "r", **rest: Any) -> Any:
        if self.name == "v2.frames.yaml" and mode == "x":
            raise OSError(28, "No space left on device")
        return original(self, mode, **rest)

    before = sorted(lamp.iterdir())
    monkeypatch.setattr(Path, "open", fails)
    assert copy("v1", "v2").exit_code == 2
    assert sorted(lamp.iterdir()) == before
