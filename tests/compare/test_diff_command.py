"""`canwright diff` as it is used: files, editions by name, revisions; formats; exit codes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
from canwright.cli import main
from canwright.compare import CHANGES
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL, ROOT

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
    assert result.exit_code == 1
    assert result.output.startswith("lamp v1 -> v2\n")
    assert "the resolution of `level` is 0.01 % (was 0.1 %) [scale-changed]" in result.output
    assert "spec/lamp/v1.yaml:7:32 -> " in result.output


def test_frames_that_do_not_fit_yet_are_no_hindrance(specs: Path) -> None:
    frame = "{request: dim, id: 0x101, node: 1, data: 10 00 64 00 00 00 00 00, raw: {level: 1}, source: manual}"
    lines = ("canwright: 1", "family: lamp", "edition: v2", "sources: {manual: M.}", "frames:", f"  - {frame}")
    (specs / "v2.frames.yaml").write_text("\n".join(lines) + "\n", "utf-8")
    assert CliRunner().invoke(main, ["check", "--spec", "spec/lamp/v2.yaml"]).exit_code == 1
    result = diff("v1", "v2")
    assert (result.exit_code, "[scale-changed]" in result.output) == (1, True)


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
    assert diff("v1", "v2").exit_code == diff("v1", "v2", "--fail-on", "breaking").exit_code == 1
    assert diff("v1", "v2", "--fail-on", "none").exit_code == 0
    unknown = diff("v1", "v2", "--fail-on", "values")
    assert (unknown.exit_code, "breaking, wire, value, api, doc" in unknown.output) == (2, True)


def test_invalid_and_unrelated_specs_are_not_compared(specs: Path) -> None:
    (specs / "bad.yaml").write_text(OLD.replace("code: 0x10", "code: 0x1000"), "utf-8")
    bad = diff("v1", "bad")
    assert (bad.exit_code, "spec/lamp/bad.yaml:10:11: error" in bad.output) == (2, True)
    (specs / "other.yaml").write_text(OLD.replace("lamp", "heater"), "utf-8")
    heater = diff("v1", "other")
    assert (heater.exit_code, "different families" in heater.output) == (2, True)
    nothing = diff("v1", "v22")
    assert (nothing.exit_code, "did you mean `v2`?" in nothing.output) == (2, True)


def test_json() -> None:
    report = json.loads(diff("v1", "v2", "--format", "json").output)
    assert (report["family"], report["old"], report["new"]) == ("lamp", "v1", "v2")
    first = report["changes"][0]
    assert first["rule"] == "scale-changed" and CHANGES[first["rule"]].category.value == first["category"]
    assert (first["impact"], first["host"], first["used_by"]) == ("silent", ["sending", "receiving"], ["dim"])
    assert first["verdicts"] == {"sending": "silent", "receiving": "silent"}
    assert first["old"] == {"file": "spec/lamp/v1.yaml", "line": 7, "column": 32}
    assert first["new"] == {"file": "spec/lamp/v2.yaml", "line": 8, "column": 32}


def test_github() -> None:
    first, second = diff("v1", "v2", "--format", "github").output.splitlines()
    assert first.startswith(
        "::error file=spec/lamp/v2.yaml,line=8,col=32,title=scale-changed::silent, host sending and receiving: "
    )
    assert second.startswith("::notice file=spec/lamp/v2.yaml,line=10,col=3,title=command-renamed::")


def test_markdown_and_changelog(specs: Path) -> None:
    (specs / "v2.yaml").write_text(
        NEW.replace("    code", "    renamed_from: dim\n    title: a | <b> c\n    code"), "utf-8"
    )
    text = diff("v1", "v2", "--format", "markdown").output
    assert "# lamp v1 -> v2\n" in text and "## Silent: " in text
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert all(line.replace("\\|", "").count("|") == 8 for line in rows)
    assert "a \\| &lt;b&gt; c" in text
    section = diff("v1", "v2", "--format", "changelog").output
    assert section.startswith("## v2 (2026-01)\n\nSince v1, ")
    assert "- **silent**, host sending and receiving: the resolution of `level` is 0.01 % (was 0.1 %)" in section
    assert "### Documents\n\n- A title is changed: `dim`" in section


def test_a_configuration(specs: Path) -> None:
    Path("canwright.toml").write_text(
        '[diff]\nfail_on = ["api"]\n[diff.severity]\nscale-changed = "warning"\n', "utf-8"
    )
    assert (diff("v1", "v2").exit_code, diff("v1", "v2", "--fail-on", "value").exit_code) == (1, 0)
    Path("canwright.toml").write_text('[diff.severity]\ncommand-renamed = "error"\nscale-changed = "ignore"\n', "utf-8")
    result = diff("v1", "v2")
    assert (result.exit_code, "scale-changed" in result.output) == (1, False)
    assert diff("v1", "v2", "--fail-on", "none").exit_code == 0
    Path("canwright.toml").write_text('[diff.ignore]\nscale-changed = ["type lev*"]\n', "utf-8")
    assert (diff("v1", "v2").exit_code, "scale-changed" in diff("v1", "v2").output) == (0, False)
    check = ("check", "--spec", "spec/lamp/v1.yaml")
    for severity, status, shown in (("error", 1, True), ("warning", 0, True), ("ignore", 0, False)):
        Path("canwright.toml").write_text(f'[check.severity]\nmissing-frame = "{severity}"\n', "utf-8")
        result = CliRunner().invoke(main, check)
        assert (result.exit_code, f"{severity}: there are no golden frames" in result.output) == (status, shown)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[diff]\nseverty = {}\n", "canwright.toml:2:1: error: unknown key `severty`"),
        ("[diff.severity]\nscale-chnged = 'error'\n", "canwright.toml:2:1: error: `canwright diff` has no such rule"),
        ("[diff.severity]\nscale-changed = 'of'\n", "canwright.toml:2:17: error: `of` is not `error`, `warning`"),
        ("[check.severity]\noverlap = 'warning'\n", "canwright.toml:2:1: error: `overlap` is always an error"),
        ("[diff]\nfail_on = ['values']\n", "`values` is not a kind of change; use one of: breaking, wire"),
        ("[diff]\nx = \n", "canwright.toml:2:5: error: this is not TOML: Invalid value"),
        ("[diff]\nbaseline = 'no.yaml'\n", "there is no file no.yaml; write it with --write-baseline REASON"),
    ],
)
def test_an_invalid_configuration(text: str, message: str) -> None:
    Path("canwright.toml").write_text(text, "utf-8")
    result = diff("v1", "v2")
    assert (result.exit_code, message in result.output) == (2, True), result.output


def test_a_baseline(specs: Path) -> None:
    accepted = ("v1", "v2", "--baseline", "accepted.yaml")
    assert diff(*accepted, "--write-baseline", " ").exit_code == 2
    assert diff(*accepted, "--write-baseline", 'agreed "twice": # yes').exit_code == 0
    written = Path("accepted.yaml").read_text("utf-8")
    assert written.endswith(
        '    rule: scale-changed\n    item: "type level"\n'
        '    facts: {name: "level", new: "0.01 %", old: "0.1 %", when: ""}\n    reason: "agreed \\"twice\\": # yes"\n'
    )
    result = diff(*accepted)
    assert (result.exit_code, "nothing breaks; 1 more accepted" in result.output) == (0, True)
    assert json.loads(diff(*accepted, "--format", "json").output)["accepted"][0]["reason"].startswith("agreed")
    moved = (specs / "v2.yaml").read_text("utf-8").replace("types:", "# a comment\n\ntypes:")
    (specs / "v2.yaml").write_text(moved, "utf-8")
    assert diff(*accepted).exit_code == 0
    (specs / "v2.yaml").write_text(moved.replace("0.01", "0.02"), "utf-8")
    result = diff(*accepted)
    assert (result.exit_code, "accepted.yaml:3:5: warning: no change from lamp v1 -> v2" in result.output) == (1, True)
    Path("accepted.yaml").write_text(written.replace("reason:", "raeson:"), "utf-8")
    assert (diff(*accepted).exit_code, "did you mean `reason`?" in diff(*accepted).output) == (2, True)


def test_a_repurposed_code_fails_unless_accepted(specs: Path) -> None:
    repurposed = (
        OLD.replace("edition: v1", "edition: v3").replace("dim:", "blink:").replace("{level: {at: 2", "{time: {at: 4")
    )
    (specs / "v3.yaml").write_text(repurposed, "utf-8")
    for kinds in ("breaking", "wire", "silent"):
        result = diff("v1", "v3", "--fail-on", kinds)
        assert (result.exit_code, "[command-repurposed]" in result.output) == (1, True)
    accepted = ("v1", "v3", "--baseline", "accepted.yaml")
    assert diff(*accepted, "--write-baseline", "the lamp was never sold").exit_code == 0
    assert (diff(*accepted).exit_code, "[command-repurposed]" in diff(*accepted).output) == (0, False)


@pytest.mark.machine
def test_all_specs_against_a_revision(specs: Path) -> None:
    for command in (("init", "-q"), ("add", "."), ("commit", "-qm", "first")):
        _git(Path.cwd(), *command)
    assert diff("--against", "HEAD").output == "no spec differs from HEAD\n"
    (specs / "v1.yaml").rename(specs / "v1-old.yaml")
    (specs / "v1-old.yaml").write_text(OLD.replace("0.1", "0.01"), "utf-8")
    (specs / "v2.yaml").unlink()
    (specs / "v3.yaml").write_text(OLD.replace("edition: v1", "edition: v3"), "utf-8")
    result = diff("--against", "HEAD", "spec")
    assert result.exit_code == 1
    assert "HEAD:spec/lamp/v1.yaml:7:32 -> spec/lamp/v1-old.yaml:7:32" in result.output
    assert result.output.endswith("added: lamp v3 (spec/lamp/v3.yaml)\nremoved: lamp v2 (HEAD:spec/lamp/v2.yaml)\n")
    assert len(json.loads(diff("--against", "HEAD", "--format", "json").output)["comparisons"]) == 1
    assert diff("--against", "nothing").exit_code == diff("--against=--all").exit_code == 2
    index = CliRunner().invoke(main, ["diff", ":spec/lamp/v1.yaml", "-"], input=OLD.replace("0.1", "0.01"))
    assert (index.exit_code, ":spec/lamp/v1.yaml:7:32 -> <stdin>:7:32" in index.output) == (1, True)


def test_wrong_arguments() -> None:
    for arguments in ((), ("v1",), ("-", "-"), ("--against", "HEAD", "a", "b"), ("v1", "v2", "--write-baseline", "x")):
        assert diff(*arguments).exit_code == 2


def test_reports_for_build_servers(specs: Path) -> None:
    text = NEW.replace("    code", "    renamed_from: dim\n    title: 'a </details> <b> | ##vso[x]'\n    code")
    (specs / "v2.yaml").write_text(text, "utf-8")
    junit = diff("v1", "v2", "--format", "junit").output
    assert "##vso" not in junit
    suite = ElementTree.fromstring(junit)[0]
    assert any("##vso[x]" in case.get("name", "") for case in suite)
    assert (suite.get("tests"), suite.get("failures")) == ("3", "1")
    (failure,) = (case[0] for case in suite if len(case))
    assert failure.get("type") == "scale-changed" and "silent: 101#" in str(failure.text)
    summary = diff("v1", "v2", "--format", "summary").output
    assert summary.startswith("### lamp v1 -> v2\n\n**Existing programs break: 1 change, 1 silent.**\n\n| impact |")
    assert summary.count("</details>") == 1 and summary.count("\n| silent | type level |") == 1
    assert "| silent: 101#" in summary
    assert "title-changed" not in diff("v1", "v2", "--no-doc").output


def test_editions() -> None:
    result = CliRunner().invoke(main, ["editions"])
    assert result.exit_code == 0
    assert [line.split()[:2] for line in result.output.splitlines()[1:]] == [["lamp", "v1"], ["lamp", "v2"]]


def test_verdicts_that_differ_by_side(tmp_path: Path) -> None:
    """The new node rejects the requests, and an old host takes the replies for those of the other command."""
    text = (ROOT / "tests/verification/specs/doser/v1.yaml").read_text("utf-8")
    old, new = tmp_path / "old.yaml", tmp_path / "new.yaml"
    old.write_text(text, "utf-8")
    swapped = text.replace("code: 5", "code: X").replace("code: 6", "code: 5").replace("code: X", "code: 6")
    new.write_text(swapped, "utf-8")
    assert "host sending: loud, receiving: silent; " in diff(str(old), str(new)).output
    first = json.loads(diff(str(old), str(new), "--format", "json").output)["changes"][0]
    assert (first["impact"], first["verdicts"]) == ("silent", {"sending": "loud", "receiving": "silent"})
