"""Links, manifests and journals that someone else put into the output folder: nothing outside is written or removed."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from canwright.output.paths import JOURNAL, LOCK, MANIFEST, STAGING, OutputError, digest
from canwright.output.writer import difference, write

from .runs import Runs
from .scenario import Scenario, tree
from .test_output_refused import told

ZERO = "0" * 64


@pytest.fixture
def out(scenario: Scenario, tmp_path: Path) -> Path:
    scenario.restore(tmp_path / "out")
    return tmp_path / "out"


@pytest.fixture
def outside(scenario: Scenario, tmp_path: Path) -> Path:
    """A folder that holds what the output folder holds, so that a link to it leads to all that is expected."""
    return shutil.copytree(scenario.before, tmp_path / "outside")


LINKED = [
    "docs",
    "docs/en/v1/commands",
    "docs/en/v1/bus.md",
    "docs/en/v1/commands/fade.md",
    "python",
    "python/scenario/v1.py",
    MANIFEST,
    LOCK,
    STAGING,
    JOURNAL,
]


@pytest.mark.parametrize("dangling", [False, True], ids=["there", "dangling"])
@pytest.mark.parametrize("path", LINKED)
def test_nothing_goes_through_a_link(
    runs: Runs, scenario: Scenario, out: Path, outside: Path, path: str, dangling: bool
) -> None:
    leads = outside / path
    if not dangling and not leads.exists():
        leads.parent.mkdir(parents=True, exist_ok=True)
        leads.write_bytes(b"outside\n")
    if dangling:
        leads = outside / "nothing"
    if (out / path).is_dir():
        shutil.rmtree(out / path)
    (out / path).unlink(missing_ok=True)
    (out / path).parent.mkdir(parents=True, exist_ok=True)
    (out / path).symlink_to(leads)
    stands, beyond = tree(out), tree(outside)
    for arguments in (scenario.arguments(out), [*scenario.arguments(out), "--force"]):
        ended = runs.run(*arguments)
        told(ended, f"{out}/{path} is a symbolic link; remove it, files are not written through links")
        assert tree(out) == stands and tree(outside) == beyond
    if path not in (LOCK, STAGING, JOURNAL):
        told(runs.run("check", *scenario.arguments(out)[1:]), f"{out}/{path} is a symbolic link")


@pytest.mark.parametrize("dangling", [False, True], ids=["there", "dangling"])
def test_the_folder_itself_is_no_link(
    runs: Runs, scenario: Scenario, outside: Path, tmp_path: Path, dangling: bool
) -> None:
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "nothing" if dangling else outside)
    ended = runs.run(*scenario.arguments(link))
    told(ended, f"{link} is a symbolic link; name the folder that it leads to with --out")
    assert tree(outside) == scenario.old and not (tmp_path / "nothing").exists()


def test_what_is_in_the_way_of_a_folder_or_a_file(runs: Runs, scenario: Scenario, out: Path) -> None:
    (out / "python").write_bytes(b"mine\n")
    told(runs.run(*scenario.arguments(out), "--force"), f"{out}/python is not a folder; move it away")
    (out / "python").unlink()
    (out / "docs/en/v1/bus.md").unlink()
    os.mkfifo(out / "docs/en/v1/bus.md")
    told(runs.run(*scenario.arguments(out), "--force"), f"{out}/docs/en/v1/bus.md is not a file; move it away")


def test_a_link_where_a_file_is_no_longer_generated_stays(scenario: Scenario, out: Path, outside: Path) -> None:
    """It is the user's, like any file that canwright did not make."""
    path = "docs/en/v1/commands/dim.md"
    (out / path).unlink()
    (out / path).symlink_to(outside / path)
    write(out, scenario.content)
    assert (out / path).is_symlink() and tree(outside) == scenario.old


HOSTILE_PATHS = [
    "../outside/mine.txt",
    "docs/../../outside/mine.txt",
    "{outside}/mine.txt",
    "docs//en/index.md",
    "docs/./en",
    "",
    ".",
    "docs/",
    ".git/config",
    "docs/.hidden",
    MANIFEST + "/x",
    LOCK,
    STAGING + "/x",
    "C:\\mine.txt",
    "C:mine.txt",
    "..\\outside\\mine.txt",
    "docs/\x1b[2J",
    "docs/\u202e",
    "docs/\x00",
]

HOSTILE_TEXTS = {
    "nothing": b"",
    "truncated": b'{"editions": {}, "files": {"docs/en',
    "no object": b"[]",
    "null": b"null",
    "a number": b"1",
    "not UTF-8": b'{"editions": {}, "files": {"\xff": ""}}',
    "half a pair": b'{"editions": {}, "files": {"\\ud800": ""}, "steps": {"\\ud800": ""}}',
    "deep": b"[" * 200_000,
    "other keys": b'{"editions": {}, "files": {}, "steps": {}, "run": "x"}',
    "files as a list": b'{"editions": {}, "files": ["docs/en/index.md"]}',
    "a digest as a number": b'{"editions": {}, "files": {"docs/en/index.md": 1}}',
    "a digest too short": b'{"editions": {}, "files": {"docs/en/index.md": "00"}}',
    "editions as text": b'{"editions": {"docs": "scenario v1"}, "files": {}}',
    "an edition that clears the screen": b'{"editions": {"docs": ["\\u001b[2J"]}, "files": {}}',
    "steps as a list": b'{"steps": [["docs/en/index.md", null]]}',
    "a step as text": b'{"steps": {"docs/en/index.md": "remove"}}',
    "a step without new": b'{"steps": {"docs/en/index.md": {"old": null}}}',
}


def damaged(runs: Runs, scenario: Scenario, out: Path, outside: Path, record: str, remedy: str) -> None:
    """Refused, told in one line without anything strange in it, and nothing is written or removed anywhere."""
    stands, beyond = tree(out), tree(outside)
    for arguments in (scenario.arguments(out), [*scenario.arguments(out), "--force"]):
        ended = runs.run(*arguments)
        told(ended, f"{out}/{record} is damaged: ", remedy)
        assert ended.text.rstrip("\n").isprintable() and len(ended.text) < 600
        assert tree(out) == stands and tree(outside) == beyond


RESTORE = "restore it from version control, or generate into an empty folder"


@pytest.mark.parametrize("text", HOSTILE_TEXTS)
def test_a_broken_manifest(runs: Runs, scenario: Scenario, out: Path, outside: Path, text: str) -> None:
    (out / MANIFEST).write_bytes(HOSTILE_TEXTS[text])
    damaged(runs, scenario, out, outside, MANIFEST, RESTORE)


@pytest.mark.parametrize("path", HOSTILE_PATHS, ids=ascii)
def test_a_manifest_that_leads_outside(runs: Runs, scenario: Scenario, out: Path, outside: Path, path: str) -> None:
    manifest = json.loads((out / MANIFEST).read_text("utf-8"))
    manifest["files"][path.format(outside=outside)] = ZERO
    (out / MANIFEST).write_text(json.dumps(manifest), "utf-8")
    damaged(runs, scenario, out, outside, MANIFEST, RESTORE)


def journal(out: Path, data: bytes) -> None:
    (out / JOURNAL).parent.mkdir()
    (out / JOURNAL).write_bytes(data)


@pytest.mark.parametrize("text", HOSTILE_TEXTS)
def test_a_broken_journal(runs: Runs, scenario: Scenario, out: Path, outside: Path, text: str) -> None:
    journal(out, HOSTILE_TEXTS[text])
    damaged(
        runs,
        scenario,
        out,
        outside,
        JOURNAL,
        f"remove {out}/{STAGING}, left by a run that was cut short, and run again",
    )
    shutil.rmtree(out / STAGING)
    assert runs.run(*scenario.arguments(out)).status == 0
    assert tree(out) == scenario.new


@pytest.mark.parametrize("new", [None, ZERO], ids=["removed", "written"])
@pytest.mark.parametrize("path", HOSTILE_PATHS, ids=ascii)
def test_a_journal_that_leads_outside(
    runs: Runs, scenario: Scenario, out: Path, outside: Path, path: str, new: str | None
) -> None:
    steps = {"mine.txt": {"old": None, "new": None}, path.format(outside=outside): {"old": None, "new": new}}
    journal(out, json.dumps({"steps": steps}).encode())
    damaged(runs, scenario, out, outside, JOURNAL, f"remove {out}/{STAGING}")


@pytest.mark.parametrize("record", [MANIFEST, JOURNAL])
def test_a_record_without_end(runs: Runs, scenario: Scenario, out: Path, outside: Path, record: str) -> None:
    (out / STAGING).mkdir()
    with (out / record).open("wb") as stream:
        stream.truncate(2**40)
    ended = runs.run(*scenario.arguments(out))
    told(ended, f"{out}/{record} is damaged: it is larger than", "run again" if record == JOURNAL else RESTORE)
    os.truncate(out / record, 0)
    assert {**tree(out), **scenario.old} == {**scenario.old, **({JOURNAL: b""} if record == JOURNAL else {})}


@pytest.mark.parametrize("record", [MANIFEST, JOURNAL])
def test_a_record_that_is_a_pipe_or_a_folder(runs: Runs, scenario: Scenario, out: Path, record: str) -> None:
    (out / STAGING).mkdir()
    (out / record).unlink(missing_ok=True)
    os.mkfifo(out / record)
    told(runs.run(*scenario.arguments(out)), f"{out}/{record} is not a file; move it away")
    (out / record).unlink()
    (out / record).mkdir()
    told(runs.run(*scenario.arguments(out)), f"{out}/{record} is not a file; move it away")


def test_a_journal_does_not_touch_what_the_user_put_there(scenario: Scenario, out: Path) -> None:
    """Neither to remove nor to replace it, with a digest that is not that of the file."""
    for new in (None, ZERO):
        journal(out, json.dumps({"steps": {"mine.txt": {"old": ZERO, "new": new}}}).encode())
        with pytest.raises(OutputError, match=r"mine\.txt was edited by hand"):
            write(out, scenario.content)
        shutil.rmtree(out / STAGING)
    assert tree(out) == scenario.old


@pytest.mark.parametrize("staged", ["nothing", "else", "link", "folder of links"])
def test_a_journal_without_what_it_promises(scenario: Scenario, out: Path, outside: Path, staged: str) -> None:
    content = (outside / "mine.txt").read_bytes()
    sha = ZERO if staged in ("nothing", "else") else digest(content)
    journal(out, json.dumps({"steps": {"docs/mine.txt": {"old": None, "new": sha}}}).encode())
    new = out / STAGING / "new/docs"
    if staged == "folder of links":
        new.parent.mkdir()
        new.symlink_to(outside)
    elif staged != "nothing":
        new.mkdir(parents=True)
        if staged == "link":
            (new / "mine.txt").symlink_to(outside / "mine.txt")
        else:
            (new / "mine.txt").write_bytes(content)
    stands, beyond = tree(out), tree(outside)
    with pytest.raises(OutputError, match=r"symbolic link|is damaged: it is not what .* remove .* and run again"):
        write(out, scenario.content, force=True)
    assert tree(out) == stands and tree(outside) == beyond


def test_a_check_reads_hostile_records_and_writes_nothing(runs: Runs, scenario: Scenario, out: Path) -> None:
    journal(out, HOSTILE_TEXTS["truncated"])
    stands = tree(out)
    assert f"Only in {out}: {JOURNAL}" in "".join(difference(out, scenario.content))
    (out / MANIFEST).write_bytes(b"{")
    told(runs.run("check", *scenario.arguments(out)[1:]), f"{out}/{MANIFEST} is damaged", RESTORE)
    assert {**tree(out), MANIFEST: stands[MANIFEST]} == stands
