"""Links, manifests and journals that someone else put into the output folder: nothing outside is written or removed."""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path

import pytest
from canwright.output.paths import JOURNAL, LOCK, MANIFEST, STAGING, OutputError, digest
from canwright.output.writer import difference, write

from .runs import Runs
from .scenario import Scenario, tree

ZERO = "0" * 64


@pytest.fixture
def out(scenario: Scenario, tmp_path: Path) -> Path:
    scenario.restore(tmp_path / "out")
    return tmp_path / "out"


@pytest.fixture
def outside(scenario: Scenario, tmp_path: Path) -> Path:
    """A folder with the files of the output folder, so that a link to it leads to all that is expected."""
    return shutil.copytree(scenario.before, tmp_path / "outside")


def assert_rejected(scenario: Scenario, out: Path, outside: Path, message: str) -> None:
    """One printable line, even with force, and nothing is written or removed anywhere."""
    before, elsewhere = tree(out), tree(outside)
    for force in (False, True):
        with pytest.raises(OutputError, match=message) as error:
            write(out, scenario.content, force=force)
        assert str(error.value).isprintable() and len(str(error.value)) < 600
        assert tree(out) == before and tree(outside) == elsewhere


LINKED = [
    "docs",
    "docs/en/v1/commands",
    "docs/en/v1/bus.md",
    "docs/en/v1/commands/fade.md",
    "python",
    "python/lamp/v1.py",
    MANIFEST,
    LOCK,
    STAGING,
    JOURNAL,
]


@pytest.mark.parametrize("dangling", [False, True], ids=["there", "dangling"])
@pytest.mark.parametrize("path", LINKED)
def test_nothing_goes_through_a_link(scenario: Scenario, out: Path, outside: Path, path: str, dangling: bool) -> None:
    destination = outside / path
    if not dangling and not destination.exists():
        destination.parent.mkdir(parents=True, exist_ok=True)
        destination.write_bytes(b"outside\n")
    if dangling:
        destination = outside / "nothing"
    if (out / path).is_dir():
        shutil.rmtree(out / path)
    (out / path).unlink(missing_ok=True)
    (out / path).parent.mkdir(parents=True, exist_ok=True)
    (out / path).symlink_to(destination)
    message = f"{out}/{path} is a symbolic link; remove it, files are not written through links"
    assert_rejected(scenario, out, outside, re.escape(message))
    if path not in (LOCK, STAGING, JOURNAL):
        with pytest.raises(OutputError, match=re.escape(f"{out}/{path} is a symbolic link")):
            list(difference(out, scenario.content))


@pytest.mark.parametrize("dangling", [False, True], ids=["there", "dangling"])
def test_an_output_folder_that_is_a_link_is_rejected(
    scenario: Scenario, outside: Path, tmp_path: Path, dangling: bool
) -> None:
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "nothing" if dangling else outside)
    with pytest.raises(OutputError, match=f"{link} is a symbolic link; name the folder that it leads to with --out"):
        write(link, scenario.content)
    assert tree(outside) == scenario.old and not (tmp_path / "nothing").exists()


def test_a_pipe_or_folder_at_the_path_of_an_output_is_rejected(scenario: Scenario, out: Path, outside: Path) -> None:
    (out / "python").write_bytes(b"mine\n")
    assert_rejected(scenario, out, outside, f"{out}/python is not a folder; move it away")
    (out / "python").unlink()
    (out / "docs/en/v1/bus.md").unlink()
    os.mkfifo(out / "docs/en/v1/bus.md")
    assert_rejected(scenario, out, outside, f"{out}/docs/en/v1/bus.md is not a file; move it away")


def test_a_link_where_a_file_is_no_longer_generated_stays(scenario: Scenario, out: Path, outside: Path) -> None:
    """It belongs to the user, like any file that canwright did not generate."""
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

HOSTILE_RECORDS = {
    "nothing": b"",
    "truncated": b'{"editions": {}, "files": {"docs/en',
    "no object": b"[]",
    "null": b"null",
    "a number": b"1",
    "not UTF-8": b'{"editions": {}, "files": {"\xff": ""}}',
    "half a pair": b'{"editions": {}, "files": {"\\ud800": ""}}',
    "deep": b"[" * 200_000,
    "other keys": b'{"editions": {}, "files": {}, "run": "x"}',
    "files as a list": b'{"editions": {}, "files": ["docs/en/index.md"]}',
    "a digest as a number": b'{"editions": {}, "files": {"docs/en/index.md": 1}}',
    "a digest too short": b'{"editions": {}, "files": {"docs/en/index.md": "00"}}',
    "editions as a list": b'{"editions": ["lamp v1"], "files": {}}',
    "editions as text": b'{"editions": {"docs": "lamp v1"}, "files": {}}',
    "an edition as a number": b'{"editions": {"docs": [1]}, "files": {}}',
    "an edition that clears the screen": b'{"editions": {"docs": ["\\u001b[2J"]}, "files": {}}',
    "a target that clears the screen": b'{"editions": {"\\u001b[2J": []}, "files": {}}',
}

RESTORE = "restore it from version control, or generate into an empty folder"
REMOVE = f"remove .*/{STAGING}, left by an interrupted run, and run again"
REMEDIES = {MANIFEST: RESTORE, JOURNAL: REMOVE}


@pytest.fixture(params=[MANIFEST, JOURNAL])
def record(request: pytest.FixtureRequest, out: Path) -> str:
    """The path of a record that the test replaces."""
    (out / request.param).parent.mkdir(exist_ok=True)
    return str(request.param)


@pytest.mark.parametrize("text", HOSTILE_RECORDS)
def test_a_damaged_record_is_rejected(scenario: Scenario, out: Path, outside: Path, record: str, text: str) -> None:
    (out / record).write_bytes(HOSTILE_RECORDS[text])
    assert_rejected(scenario, out, outside, f"{out}/{record} is damaged: .*; {REMEDIES[record]}")
    if record == JOURNAL:
        shutil.rmtree(out / STAGING)
        write(out, scenario.content)
        assert tree(out) == scenario.new


@pytest.mark.parametrize("path", HOSTILE_PATHS, ids=ascii)
def test_a_record_with_paths_outside_the_folder_is_rejected(
    scenario: Scenario, out: Path, outside: Path, record: str, path: str
) -> None:
    manifest = json.loads(scenario.old[MANIFEST])
    manifest["files"][path.format(outside=outside)] = ZERO
    (out / record).write_text(json.dumps(manifest), "utf-8")
    assert_rejected(scenario, out, outside, f"{out}/{record} is damaged: .* is not a path inside.*; {REMEDIES[record]}")


def test_a_record_that_is_too_large_is_rejected(scenario: Scenario, out: Path, record: str) -> None:
    with (out / record).open("wb") as stream:
        stream.truncate(2**40)
    with pytest.raises(OutputError, match=f"{out}/{record} is damaged: it is larger than .*; {REMEDIES[record]}"):
        write(out, scenario.content)
    os.truncate(out / record, 0)
    assert tree(out) == {**scenario.old, record: b""}


def test_a_record_that_is_a_pipe_or_a_folder(scenario: Scenario, out: Path, outside: Path, record: str) -> None:
    (out / record).unlink(missing_ok=True)
    os.mkfifo(out / record)
    assert_rejected(scenario, out, outside, f"{out}/{record} is not a file; move it away")
    (out / record).unlink()
    (out / record).mkdir()
    assert_rejected(scenario, out, outside, f"{out}/{record} is not a file; move it away")


def write_journal(out: Path, **files: str) -> None:
    """A change of some files, beside what the manifest has."""
    manifest = json.loads((out / MANIFEST).read_text("utf-8"))
    (out / STAGING).mkdir()
    (out / JOURNAL).write_text(json.dumps({**manifest, "files": {**manifest["files"], **files}}), "utf-8")


@pytest.mark.parametrize("staged", [False, True])
def test_a_journal_does_not_replace_a_file_of_the_user(scenario: Scenario, out: Path, staged: bool) -> None:
    write_journal(out, **{"mine.txt": digest(b"new\n")})
    if staged:
        (out / STAGING / "new").mkdir()
        (out / STAGING / "new/mine.txt").write_bytes(b"new\n")
    before = tree(out)
    with pytest.raises(OutputError, match=r"mine\.txt is in the way and was not generated by canwright"):
        write(out, scenario.content)
    assert tree(out) == before


def test_a_journal_does_not_write_through_a_link(scenario: Scenario, out: Path, outside: Path) -> None:
    write_journal(out, **{"linked/new.txt": digest(b"new\n")})
    (out / STAGING / "new/linked").mkdir(parents=True)
    (out / STAGING / "new/linked/new.txt").write_bytes(b"new\n")
    (out / "linked").symlink_to(outside)
    assert_rejected(scenario, out, outside, f"{out}/linked is a symbolic link")


def test_a_journal_removes_no_edited_file(scenario: Scenario, out: Path) -> None:
    (out / STAGING).mkdir()
    (out / JOURNAL).write_text('{"editions": {}, "files": {}}')
    (out / "docs/en/index.md").write_bytes(b"edited\n")
    before = tree(out)
    with pytest.raises(OutputError, match=r"docs/en/index\.md was edited by hand"):
        write(out, scenario.content)
    assert tree(out) == before


@pytest.mark.parametrize("staged", ["nothing", "another file", "a link", "a folder of links"])
def test_a_journal_without_its_staged_files(scenario: Scenario, out: Path, outside: Path, staged: str) -> None:
    content = (outside / "mine.txt").read_bytes()
    write_journal(out, **{"docs/mine.txt": ZERO if staged in ("nothing", "another file") else digest(content)})
    new = out / STAGING / "new/docs"
    if staged == "a folder of links":
        new.parent.mkdir()
        new.symlink_to(outside)
    elif staged != "nothing":
        new.mkdir(parents=True)
        if staged == "a link":
            (new / "mine.txt").symlink_to(outside / "mine.txt")
        else:
            (new / "mine.txt").write_bytes(content)
    message = r"is a symbolic link" if "link" in staged else r"is damaged: it is not .* staged; remove .* and run again"
    assert_rejected(scenario, out, outside, message)


def test_a_check_reads_hostile_records_and_writes_nothing(scenario: Scenario, out: Path) -> None:
    (out / STAGING).mkdir()
    (out / JOURNAL).write_bytes(HOSTILE_RECORDS["truncated"])
    before = tree(out)
    assert f"Only in {out}: {JOURNAL}" in "".join(difference(out, scenario.content))
    (out / MANIFEST).write_bytes(b"{")
    with pytest.raises(OutputError, match=f"{out}/{MANIFEST} is damaged: .*; {RESTORE}"):
        list(difference(out, scenario.content))
    assert {**tree(out), MANIFEST: before[MANIFEST]} == before


@pytest.mark.parametrize("command", ["generate", "check"])
def test_the_command_line_prints_the_reason(runs: Runs, scenario: Scenario, out: Path, command: str) -> None:
    (out / MANIFEST).write_bytes(b"{")
    ended = runs.run(command, *scenario.arguments(out)[1:])
    assert ended.status == 2
    assert re.fullmatch(f"canwright: {out}/{MANIFEST} is damaged: .*; {RESTORE}\n", ended.text)
