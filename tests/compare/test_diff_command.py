"""`canwright diff` as it is used: files, editions by name, revisions; formats; exit codes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.compare import CHANGES
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL

OLD = MINIMAL
NEW = MINIMAL.replace("edition: v1", "edition: v2\ndate: 2026-01").replace("0.1", "0.01").replace("dim:", "dim_to:")


@pytest.fixture(autouse=True)
def specs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "spec" / "lamp"
    folder.mkdir(parents=True)
    (folder / "v1.yaml").write_text(OLD, "utf-8")
    (folder / "v2.yaml").write_text(NEW, "utf-8")
    monkeypatch.chdir(tmp_path)
    return folder


def diff(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["diff", *arguments])


@pytest.mark.parametrize(
    ("old", "new"), [("v1", "v2"), ("lamp/v1", "lamp/v2"), ("spec/lamp/v1.yaml", "v2"), ("v1", "./spec/lamp/v2.yaml")]
)
def test_ways_to_name_an_edition(old: str, new: str) -> None:
    result = diff(old, new)
    assert result.exit_code == 0
    assert result.output.startswith("lamp v1 -> v2\n")
    assert "the resolution of `level` is 0.01 % (was 0.1 %) [scale-changed]" in result.output
    assert "spec/lamp/v1.yaml:7:32 -> " in result.output


def test_frames_that_do_not_fit_yet_are_no_hindrance(specs: Path) -> None:
    frame = "{request: dim, id: 0x101, node: 1, data: 10 00 64 00 00 00 00 00, raw: {level: 1}, source: manual}"
    lines = ("canwright: 1", "family: lamp", "edition: v2", "sources: {manual: M.}", "frames:", f"  - {frame}")
    (specs / "v2.frames.yaml").write_text("\n".join(lines) + "\n", "utf-8")
    assert CliRunner().invoke(main, ["check", "--spec", "spec/lamp/v2.yaml"]).exit_code == 1
    result = diff("v1", "v2")
    assert (result.exit_code, "[scale-changed]" in result.output) == (0, True)


def _git(folder: Path, *arguments: str) -> None:
    assert shutil.which("git"), "this test needs git; install the package `git`"
    who = {f"GIT_{role}_{what}": "x" for role in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    subprocess.run(["git", *arguments], cwd=folder, check=True, capture_output=True, env={**os.environ, **who})


@pytest.mark.machine
def test_a_revision_in_git(specs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _git(specs, "init", "-q")
    _git(specs, "add", ".")
    _git(specs, "commit", "-qm", "first")
    (specs / "v1.yaml").write_text(OLD.replace("u16", "i16"), "utf-8")
    monkeypatch.chdir(specs)
    result = diff("HEAD:v1.yaml", "v1.yaml", "--fail-on", "wire")
    assert result.exit_code == 1
    assert "HEAD:v1.yaml:7:11 -> v1.yaml:7:11" in result.output
    missing = diff("HEAD:v9.yaml", "v1.yaml")
    assert (missing.exit_code, "git has no `HEAD:v9.yaml`" in missing.output) == (2, True)


def test_a_revision_without_git(specs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(specs))
    result = diff("HEAD:v1.yaml", "v1")
    assert (result.exit_code, "requires git, which is not installed; install it" in result.output) == (2, True)
    assert diff("--upload-pack=x:v1.yaml", "v1").exit_code == 2


def test_exit_codes() -> None:
    assert diff("v1", "v1", "--fail-on", "wire,value,api,doc").exit_code == 0
    assert diff("v1", "v2", "--fail-on", "wire").exit_code == 0
    assert diff("v1", "v2", "--fail-on", "wire, value").exit_code == 1
    assert diff("v1", "v2", "--fail-on", "silent").exit_code == 1
    unknown = diff("v1", "v2", "--fail-on", "values")
    assert (unknown.exit_code, "wire, value, api, doc" in unknown.output) == (2, True)


def test_what_cannot_be_compared(specs: Path) -> None:
    (specs / "bad.yaml").write_text(OLD.replace("code: 0x10", "code: 0x1000"), "utf-8")
    bad = diff("v1", "bad")
    assert (bad.exit_code, "spec/lamp/bad.yaml:10:11: error" in bad.output) == (2, True)
    (specs / "other.yaml").write_text(OLD.replace("lamp", "heater"), "utf-8")
    other = diff("v1", "other")
    assert (other.exit_code, "different families" in other.output) == (2, True)
    nothing = diff("v1", "v22")
    assert (nothing.exit_code, "did you mean `v2`?" in nothing.output) == (2, True)


def test_json() -> None:
    found = json.loads(diff("v1", "v2", "--format", "json").output)
    assert (found["family"], found["old"], found["new"]) == ("lamp", "v1", "v2")
    first = found["changes"][0]
    assert first["rule"] == "scale-changed" and CHANGES[first["rule"]].category.value == first["category"]
    assert (first["impact"], first["host"], first["used_by"]) == ("silent", ["sending"], ["dim"])
    assert first["old"] == {"file": "spec/lamp/v1.yaml", "line": 7, "column": 32}
    assert first["new"] == {"file": "spec/lamp/v2.yaml", "line": 8, "column": 32}


def test_github() -> None:
    first, second = diff("v1", "v2", "--format", "github").output.splitlines()
    assert first.startswith(
        "::warning file=spec/lamp/v2.yaml,line=8,col=32,title=scale-changed::silent, host sending: "
    )
    assert second.startswith("::notice file=spec/lamp/v2.yaml,line=10,col=3,title=command-renamed::")


def test_markdown_and_changelog(specs: Path) -> None:
    (specs / "v2.yaml").write_text(
        NEW.replace("    code", "    renamed_from: dim\n    title: a | <b> c\n    code"), "utf-8"
    )
    text = diff("v1", "v2", "--format", "markdown").output
    assert "# lamp v1 -> v2\n" in text and "## Silent: " in text
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert all(line.replace("\\|", "").count("|") == 7 for line in rows)
    assert "a \\| &lt;b&gt; c" in text
    section = diff("v1", "v2", "--format", "changelog").output
    assert section.startswith("## v2 (2026-01)\n\nSince v1, ")
    assert "- **silent**, host sending: the resolution of `level` is 0.01 % (was 0.1 %)" in section
    assert "### Documents\n\n- A title is changed: `dim`" in section


def test_editions() -> None:
    result = CliRunner().invoke(main, ["editions"])
    assert result.exit_code == 0
    assert [line.split()[:2] for line in result.output.splitlines()[1:]] == [["lamp", "v1"], ["lamp", "v2"]]
