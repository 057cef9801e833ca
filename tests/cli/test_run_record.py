"""A run with nothing to do is not computed again, and the record of it never hides a change."""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from canwright.cli import COMMANDS, HELP, main, run_record
from canwright.cli.run_record import Printed, RunRecord
from canwright.output.paths import digest
from canwright.output.writer import Content
from canwright.templating import resources
from click import Context, unstyle
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL

FRAMES = """canwright: 1
family: lamp
edition: v1
sources: {manual: The manual.}
frames:
  - {request: dim, id: 0x101, node: 1, data: 10 00 64 00 00 00 00 00, raw: {level: 100}, values: {level: 10}, source: manual}
  - {reply: dim, id: 0x101, node: 1, data: 10 00 64 00 00 00 00 00, raw: {level: 100}, values: {level: 10}, source: manual}
"""
GENERATE = ("generate", "--target", "c", "--out", "out")
CHECK = ("check", "--target", "c", "--out", "out")
SPEC = Path("spec/lamp/v1.yaml")
HEADER = Path("out/c/include/lamp/v1.h")
MANIFEST = Path("out/.canwright.json")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same for all tests, so that the copied templates are compiled once."""
    return tmp_path_factory.mktemp("run_record")


@pytest.fixture(autouse=True)
def project(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a spec, and a copy of canwright's own files that a test may change."""
    shutil.rmtree(folder)
    (folder / "project" / SPEC).parent.mkdir(parents=True)
    monkeypatch.chdir(folder / "project")
    SPEC.write_text(MINIMAL, "utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    monkeypatch.delenv("NO_COLOR", raising=False)
    shutil.copytree(resources.TEMPLATES, folder / "templates")
    shutil.copytree(resources.PACKAGE / "targets", folder / "package/targets")
    for name, copied in (("UNITS", "units.yaml"), ("SYNONYMS", "synonyms.yaml"), ("SCHEMA", "canwright.schema.json")):
        shutil.copy(getattr(resources, name), folder / copied)
        monkeypatch.setattr(resources, name, folder / copied)
    monkeypatch.setattr(resources, "TEMPLATES", folder / "templates")
    monkeypatch.setattr(resources, "PACKAGE", folder / "package")
    (folder / "site").mkdir()
    monkeypatch.syspath_prepend(folder / "site")
    return folder


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, obj=RunRecord(arguments), catch_exceptions=False)


def is_known(*arguments: str) -> bool:
    return RunRecord(arguments).printed() is not None


def test_successful_run_is_not_repeated() -> None:
    assert not is_known(*GENERATE)
    assert "0 files written" not in run(*GENERATE).stdout
    known = RunRecord(GENERATE).printed()
    again = run(*GENERATE)
    assert known and (known.out, unstyle(known.error)) == (again.stdout, again.stderr)
    assert not is_known(*CHECK)
    first = run(*CHECK)
    known = RunRecord(CHECK).printed()
    assert known and (known.out, unstyle(known.error)) == (first.stdout, first.stderr)
    assert "[missing-frame]" in known.error


@pytest.mark.parametrize("printer", ["json", "github", "sarif"])
def test_findings_in_other_formats_are_repeated(printer: str) -> None:
    run(*GENERATE)
    first = run(*CHECK, "--format", printer)
    known = RunRecord((*CHECK, "--format", printer)).printed()
    assert known and (known.out, unstyle(known.error)) == (first.stdout, first.stderr)


def edited(file: Path) -> None:
    """Adds a line, with the times of before."""
    times = file.stat()
    file.write_bytes(file.read_bytes() + b"\n")
    os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))


def same_size(file: Path) -> None:
    """Changes one byte, with the times of before."""
    times = file.stat()
    content = file.read_bytes()
    file.write_bytes(bytes([content[0] ^ 1]) + content[1:])
    os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))


def linked(path: Path) -> None:
    """The same content, reached through a link."""
    elsewhere = Path("../elsewhere").absolute()
    path.rename(elsewhere)
    path.symlink_to(elsewhere)


def of_another_family() -> None:
    Path("spec/desk").mkdir()
    Path("spec/desk/v1.yaml").write_text(MINIMAL.replace("family: lamp", "family: desk"), "utf-8")


def folder_in_place_of_a_file() -> None:
    HEADER.unlink()
    HEADER.mkdir()


def installed(project: Path, name: str, points: str = "") -> None:
    folder = project / "site" / name
    folder.mkdir()
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name.partition('-')[0]}\nVersion: 1\n")
    (folder / "entry_points.txt").write_text(points)


CHANGES: dict[str, Callable[[Path, pytest.MonkeyPatch], object]] = {
    "a spec": lambda project, patch: edited(SPEC),
    "a spec, of the same size": lambda project, patch: same_size(SPEC),
    "a spec that is a link": lambda project, patch: linked(SPEC),
    "another spec": lambda project, patch: SPEC.with_name("v2.yaml").write_text(MINIMAL.replace("v1", "v2")),
    "a spec of another family": lambda project, patch: of_another_family(),
    "golden frames": lambda project, patch: SPEC.with_name("v1.frames.yaml").write_text(FRAMES),
    "no spec": lambda project, patch: SPEC.unlink(),
    "a template": lambda project, patch: edited(project / "templates/c/edition.h.j2"),
    "a new template": lambda project, patch: (project / "templates/c/new.j2").touch(),
    "generator source": lambda project, patch: edited(project / "package/targets/c/view.py"),
    "runtime source": lambda project, patch: edited(project / "package/targets/c/runtime/canwright.h"),
    "units": lambda project, patch: edited(project / "units.yaml"),
    "synonyms": lambda project, patch: edited(project / "synonyms.yaml"),
    "the schema": lambda project, patch: edited(project / "canwright.schema.json"),
    "Python": lambda project, patch: patch.setattr(sys, "version", "3.99"),
    "flags of Python": lambda project, patch: patch.setattr(sys, "flags", (*sys.flags, 1)),
    "colour": lambda project, patch: patch.setenv("NO_COLOR", "1"),
    "shell completion": lambda project, patch: patch.setenv("_CANWRIGHT_COMPLETE", "bash_complete"),
    "a package": lambda project, patch: installed(project, "jinja2-99.dist-info"),
    "a package of distutils": lambda project, patch: installed(project, "jinja2-99.egg-info"),
    "a target": lambda project, patch: installed(project, "other-1.dist-info", "[canwright.targets]\nx = y:z\n"),
    "entry points": lambda project, patch: (project / "site/old-1.dist-info/entry_points.txt").write_text("[x]\n"),
    "an archive of packages": lambda project, patch: (project / "site/one.zip").write_bytes(b"PK"),
    "a finder of packages": lambda project, patch: patch.setattr(sys, "meta_path", [*sys.meta_path, Finder()]),
    "an edited file": lambda project, patch: edited(HEADER),
    "an edited file of the same size": lambda project, patch: same_size(HEADER),
    "a removed file": lambda project, patch: HEADER.unlink(),
    "a link to a file": lambda project, patch: linked(HEADER),
    "a link to a folder": lambda project, patch: linked(HEADER.parent),
    "a link to a target": lambda project, patch: linked(Path("out/c")),
    "a link to the output": lambda project, patch: linked(Path("out")),
    "a folder in place of a file": lambda project, patch: folder_in_place_of_a_file(),
    "the manifest": lambda project, patch: edited(MANIFEST),
    "no manifest": lambda project, patch: MANIFEST.unlink(),
    "another run": lambda project, patch: Path("out/.canwright-lock").touch(),
    "an interrupted run": lambda project, patch: Path("out/.canwright-staging").mkdir(),
    "no output": lambda project, patch: shutil.rmtree("out"),
}


class Finder:
    """Finds packages that are not files in `sys.path`."""

    def find_spec(self, *arguments: object) -> None:
        return None

    def find_distributions(self, *arguments: object) -> None:
        return None


@pytest.mark.parametrize("change", CHANGES)
def test_run_with_a_changed_input_is_repeated(change: str, project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(project, "old-1.dist-info")
    monkeypatch.syspath_prepend(project / "site/one.zip")
    run(*GENERATE)
    run(*CHECK)
    assert is_known(*GENERATE) and is_known(*CHECK)
    CHANGES[change](project, monkeypatch)
    assert not is_known(*GENERATE) and not is_known(*CHECK)


@pytest.mark.parametrize(
    "option", ["--force", "--no-cache", "--set=x=1", "--target=python", "--format=json", "--spec=spec/lamp/v1.yaml"]
)
def test_a_run_with_other_options_is_not_skipped(option: str) -> None:
    run(*GENERATE)
    assert is_known(*GENERATE) and not is_known(*GENERATE, option)


def test_a_run_in_another_folder_is_not_skipped(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run(*GENERATE)
    shutil.copytree(Path.cwd(), project / "copy")
    monkeypatch.chdir(project / "copy")
    assert not is_known(*GENERATE)
    run(*GENERATE)
    assert is_known(*GENERATE)


def test_a_deleted_file_is_generated_again() -> None:
    run(*GENERATE)
    content = HEADER.read_bytes()
    HEADER.unlink()
    assert run(*CHECK).exit_code == 1
    assert "1 files written" in run(*GENERATE).output
    assert HEADER.read_bytes() == content


def test_own_files_and_file_modes_do_not_repeat_a_run() -> None:
    """A run leaves them as they are, so it has nothing to do."""
    run(*GENERATE)
    (HEADER.parent / "mine.h").touch()
    HEADER.chmod(0o444)
    before = run(*GENERATE)
    assert "0 files written" in before.output
    known = RunRecord(GENERATE).printed()
    assert known and known.out == before.stdout


def test_nothing_is_recorded_with_no_cache_or_after_a_finding() -> None:
    run(*GENERATE, "--no-cache")
    assert not is_known(*GENERATE, "--no-cache")
    run(*CHECK, "--strict")
    assert not is_known(*CHECK, "--strict")
    run(*CHECK, "--no-cache")
    assert not is_known(*CHECK, "--no-cache")
    HEADER.unlink()
    run(*CHECK)
    assert not is_known(*CHECK)


def test_nothing_is_recorded_with_a_target_of_another_package(project: Path) -> None:
    run(*GENERATE)
    installed(project, "other-1.dist-info", "[other.spec_name]\nx = y:z\n")
    run(*CHECK)
    assert is_known(*CHECK)
    (project / "site/other-1.dist-info/entry_points.txt").write_text(
        "[canwright.targets]\nc = canwright.targets.c.target:TARGET\n"
    )
    run(*CHECK)
    assert not is_known(*CHECK)


@pytest.mark.parametrize("changed", ["spec/lamp/v1.yaml", "../templates/c/edition.h.j2", "out/.canwright.json"])
def test_nothing_is_recorded_when_an_input_changes_meanwhile(changed: str, monkeypatch: pytest.MonkeyPatch) -> None:
    run(*GENERATE)
    save = RunRecord.save

    def late(self: RunRecord, folder: Path, content: Content, printed: Printed) -> None:
        edited(Path(changed))
        save(self, folder, content, printed)

    monkeypatch.setattr(RunRecord, "save", late)
    run(*CHECK)
    assert not is_known(*CHECK)


def record_file(project: Path) -> Path:
    (file,) = (project / "cache/canwright").iterdir()
    return file


def test_a_record_is_private(project: Path) -> None:
    run(*GENERATE)
    file = record_file(project)
    assert (stat.S_IMODE(file.stat().st_mode), stat.S_IMODE(file.parent.stat().st_mode)) == (0o600, 0o700)


@pytest.mark.parametrize("content", [b"", b"\n", b"x\n{}", b"[" * 100_000, b"\xff", b"0" * (1 << 21)])
def test_a_damaged_record_is_ignored_and_replaced(content: bytes, project: Path) -> None:
    run(*GENERATE)
    file = record_file(project)
    whole = file.read_bytes()
    file.write_bytes(content)
    assert not is_known(*GENERATE)
    run(*GENERATE)
    assert file.read_bytes() == whole


@pytest.mark.parametrize(
    "content",
    [
        b"[]",
        b"{}",
        b'{"state": 1, "files": [], "folder": "out", "targets": [], "manifest": "", "printed": ["", ""]}',
        b'{"state": "", "files": 1, "folder": "out", "targets": [], "manifest": "", "printed": ["", ""]}',
        b'{"state": "", "files": ["\\u0000"], "folder": "out", "targets": [], "manifest": "", "printed": ["", ""]}',
        b'{"state": "", "files": [], "folder": "out", "targets": [], "manifest": "", "printed": [""]}',
    ],
)
def test_a_record_of_another_form_is_ignored(content: bytes, project: Path) -> None:
    run(*GENERATE)
    record_file(project).write_bytes(digest(content).encode() + b"\n" + content)
    assert not is_known(*GENERATE)


def test_each_byte_of_a_record_matters(project: Path) -> None:
    run(*GENERATE)
    file = record_file(project)
    file.write_bytes(file.read_bytes().replace(b" unchanged", b" untouched"))
    assert not is_known(*GENERATE)


@pytest.mark.parametrize("place", ["a file", "a folder"])
def test_runs_work_without_a_cache_folder(place: str, project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if place == "a file":
        (project / "cache").write_text("")
    else:
        monkeypatch.setenv("XDG_CACHE_HOME", "/proc/cannot-be-made")
    assert run(*GENERATE).exit_code == 0
    assert not is_known(*GENERATE)
    assert run(*CHECK).exit_code == 0


def test_old_records_are_removed(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_record, "MAX_RECORDS", 2)
    for option in ("--force", "--format=json", "--format=sarif"):
        run(*GENERATE, option)
    assert len(list((project / "cache/canwright").iterdir())) == 2
    assert not is_known(*GENERATE, "--force")
    assert is_known(*GENERATE, "--format=sarif")


@pytest.mark.parametrize(
    ("platform", "variable", "expected"),
    [
        ("linux", "XDG_CACHE_HOME", "{home}/set/canwright"),
        ("linux", "", "{home}/.cache/canwright"),
        ("darwin", "", "{home}/Library/Caches/canwright"),
        ("win32", "LOCALAPPDATA", "{home}/set/canwright"),
    ],
)
def test_the_cache_folder_is_that_of_the_system(
    platform: str, variable: str, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    if variable:
        monkeypatch.setenv(variable, str(tmp_path / "set"))
    monkeypatch.setattr(sys, "platform", platform)
    assert str(run_record.cache_folder()) == expected.format(home=tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    if platform == "linux":
        assert str(run_record.cache_folder()) == f"{tmp_path}/.cache/canwright"


SCRIPT = """
import sys
from canwright.__main__ import run
sys.argv = ["canwright", *sys.argv[1:]]
try:
    run()
finally:
    print(sorted({"click", "jinja2", "yaml", "canwright.model"} & sys.modules.keys()))
"""


def process(*arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", SCRIPT, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_a_process_repeats_what_it_printed_without_the_generator() -> None:
    run(*GENERATE)
    first, second = process(*CHECK).communicate(), process(*CHECK).communicate()
    assert first[0].splitlines() == [
        "lamp v1: OK, and out/ is up to date",
        "['canwright.model', 'click', 'jinja2', 'yaml']",
    ]
    assert second == (first[0].splitlines()[0] + "\n['click']\n", first[1])
    assert "[missing-frame]" in second[1]
    SPEC.with_name("v1.frames.yaml").write_text(FRAMES, "utf-8")  # colours of a warning need click
    process(*GENERATE).communicate()
    assert process(*GENERATE).communicate()[0].splitlines()[1] == "[]"


def test_simultaneous_processes_print_the_same() -> None:
    run(*GENERATE)
    for printed, _ in [started.communicate() for started in [process(*CHECK) for _ in range(3)]]:
        assert printed.startswith("lamp v1: OK, and out/ is up to date\n")


@pytest.mark.parametrize("option", ["-h", "--help"])
def test_help_imports_no_library(option: str) -> None:
    printed, _ = process(option).communicate()
    assert printed == f"{HELP}[]\n"


def test_the_list_of_commands_is_that_of_their_help() -> None:
    for name, (_, text) in COMMANDS.items():
        command = main.get_command(Context(main), name)
        assert command and command.help and command.help.split("\n\n")[0] == text
    assert list(COMMANDS) == sorted(COMMANDS)
