"""A full disk, folders that may not be written: exit status 2, reason, file and remedy, and the old output whole."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from canwright.output.paths import LOCK

from .runs import Binding, Ended, Runs
from .scenario import USER_FILES, Scenario, memory_folder, tree

NAMESPACE = ["unshare", "-m" if os.geteuid() == 0 else "-rm"]
MOUNT = 'mount -t tmpfs -o size=2m,nr_inodes=500 none "$0" && exec "$@"'


def _can_mount() -> bool:
    if shutil.which("unshare") is None:
        return False
    with memory_folder() as folder:
        command = [*NAMESPACE, "sh", "-c", MOUNT, str(folder), "true"]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0


OF_MACHINE = ["room", "files"] if _can_mount() else []
WAYS = ["file size", *(pytest.param(way, marks=pytest.mark.machine) for way in OF_MACHINE)]
"""What runs out. A limit of file sizes binds everywhere; a machine that permits mounts has a disk of 2 MiB and 500 files."""


def assert_rejected(ended: Ended, *parts: str) -> None:
    """One line that says what is wrong, where and what to do."""
    assert ended.status == 2, ended
    assert ended.text.startswith("canwright: ") and ended.text.count("\n") == 1, ended.text
    for part in parts:
        assert part in ended.text, ended.text


@contextmanager
def scarce(way: str, scenario: Scenario, texts: Path) -> Iterator[tuple[Path, Callable[[int], Ended]]]:
    """The output folder, and what runs the scenario in it with so much left."""
    with ExitStack() as stack:
        folder = stack.enter_context(memory_folder())
        inside = [] if way == "file size" else [*NAMESPACE, "sh", "-c", MOUNT, str(folder)]
        runs = stack.enter_context(
            Runs(texts, *scenario.arguments(folder / "out"), watched=folder / "out", inside=inside)
        )
        assert runs.run().status == 0
        disk = Path(f"/proc/{runs.process}/root{folder}") if inside else folder

        def run(left: int) -> Ended:
            ballast = disk / "ballast"
            shutil.rmtree(ballast, ignore_errors=True)
            scenario.restore(disk / "out")
            if way == "file size":
                return runs.run(bound=Binding(file_size=left))
            ballast.mkdir()
            (ballast / "0").touch()
            now = os.statvfs(disk)
            if way == "files":
                for number in range(1, now.f_favail - left + 1):
                    (ballast / f"{number}").touch()
            else:
                (ballast / "0").write_bytes(bytes(now.f_frsize * (now.f_bavail - left)))
            return runs.run()

        yield disk / "out", run


@pytest.mark.parametrize("way", WAYS)
def test_a_full_disk_leaves_the_old_output_whole(way: str, scenario: Scenario, tmp_path: Path) -> None:
    """With ever more left, until it is enough."""
    reason, remedy = {
        "file size": ("File too large", "raise the limit of file sizes (ulimit -f) and run again"),
        "room": ("No space left on device", "make room there and run again"),
        "files": ("No space left on device", "make room there and run again"),
    }[way]
    largest = max(map(len, scenario.new.values()))
    steps = range(400, 2 * largest, largest // 20) if way == "file size" else range(200)
    rejected = 0
    with scarce(way, scenario, tmp_path) as (out, run):
        for left in steps:
            ended = run(left)
            if ended.status == 0:
                break
            assert_rejected(
                ended,
                f"cannot write {out.as_posix().partition('/root')[2] or out}/",
                reason,
                remedy,
                "nothing was changed",
            )
            assert tree(out) == scenario.old and not (out / "python").exists(), left
            rejected += 1
        assert tree(out) == scenario.new
        assert rejected >= 10


@pytest.fixture(scope="module")
def out() -> Iterator[Path]:
    with memory_folder() as folder:
        yield folder / "out"


@pytest.fixture(scope="module")
def writes(scenario: Scenario, out: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runs]:
    """Runs that have generated everything and begin to write."""
    with Runs(tmp_path_factory.mktemp("writes"), *scenario.arguments(out), watched=out) as started:
        yield started


@pytest.mark.parametrize(
    ("closed", "at"),
    [
        (".", LOCK),
        ("docs", "docs/en"),
        ("docs/en/v1", "docs/en/v1/"),
        ("docs/en/v1/commands", "docs/en/v1/commands/"),
        ("docs/pictures/v1", "docs/pictures/v1/"),
    ],
)
def test_a_folder_that_may_not_be_written(writes: Runs, scenario: Scenario, out: Path, closed: str, at: str) -> None:
    """One in the middle is noticed only when some files are replaced already: these are put back."""
    scenario.restore(out)
    if closed == "docs":
        shutil.rmtree(out / "docs/en")
    before = tree(out)
    (out / closed).chmod(0o555)
    ended = writes.run(bound=Binding(common_user=True))
    (out / closed).chmod(0o755)
    assert_rejected(
        ended,
        f"cannot write {out}/{at}",
        "Permission denied; make it accessible to you, or choose another folder with --out; nothing was changed",
    )
    assert tree(out) == before
    assert writes.run().status == 0
    assert {**tree(out), **USER_FILES} == scenario.new


def test_a_folder_that_may_not_be_made(runs: Runs, scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "closed").mkdir(0o555)
    ended = runs.run(*scenario.arguments(tmp_path / "closed/out"), bound=Binding(common_user=True))
    assert_rejected(ended, f"cannot write {tmp_path}/closed/out: Permission denied")
    assert list((tmp_path / "closed").iterdir()) == []


@pytest.mark.parametrize("command", ["generate", "check"])
@pytest.mark.parametrize("path", ["docs/en/index.md", ".canwright.json", "docs/en", "."])
def test_a_file_that_may_not_be_read(
    runs: Runs, writes: Runs, scenario: Scenario, out: Path, path: str, command: str
) -> None:
    scenario.restore(out)
    (out / path).chmod(0)
    bound = Binding(common_user=True)
    arguments = scenario.arguments(out)[1:]
    ended = writes.run(bound=bound) if command == "generate" else runs.run(command, *arguments, bound=bound)
    (out / path).chmod(0o755)
    assert_rejected(ended, "Permission denied", "make it accessible to you", "nothing was changed")
    assert tree(out) == scenario.old


def test_a_file_in_place_of_the_folder(runs: Runs, scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"mine\n")
    assert_rejected(
        runs.run(*scenario.arguments(tmp_path / "file/out")), f"{tmp_path}/file", "Not a directory", "--out"
    )
    ended = runs.run(*scenario.arguments(tmp_path / "file"))
    assert ended.status == 2 and "is a file" in ended.text
    assert (tmp_path / "file").read_bytes() == b"mine\n"


def test_a_link_to_itself_in_place_of_the_folder(runs: Runs, scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    ended = runs.run(*scenario.arguments(tmp_path / "loop"))
    assert_rejected(ended, f"{tmp_path}/loop is a symbolic link", "--out")
    ended = runs.run(*scenario.arguments(tmp_path / "loop/out"))
    assert_rejected(ended, f"{tmp_path}/loop", "symbolic links", "nothing was changed")


def test_a_check_of_outputs_writes_nothing(runs: Runs, scenario: Scenario, tmp_path: Path) -> None:
    """No step of it, where nothing was generated, where it is old, and where it is up to date."""
    for name, status in (("nothing", 1), ("old", 1), ("new", 0)):
        out = tmp_path / name
        if name != "nothing":
            scenario.restore(out)
        if name == "new":
            assert runs.run(*scenario.arguments(out)).status == 0
        before, times = tree(out), {file: file.stat().st_mtime_ns for file in tmp_path.rglob("*")}
        ended = runs.run("check", *scenario.arguments(out)[1:], bound=Binding(str(tmp_path), trace=True))
        assert ended.status == status
        assert not any(line.startswith(("os.", "open", "fcntl")) for line in ended.text.splitlines()), ended.text
        assert tree(out) == before
        assert times == {file: file.stat().st_mtime_ns for file in tmp_path.rglob("*")}
    assert set(USER_FILES) <= set(tree(tmp_path / "new"))
