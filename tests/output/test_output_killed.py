"""The real command line killed at every step it makes on disk: the old output is whole, or the next run makes the new."""

from __future__ import annotations

import shutil
import signal
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest
from canwright.output.paths import JOURNAL, MANIFEST, STAGING, OutputError
from canwright.output.writer import difference, write

from .output_case import MINE, Case, case, swift_folder, tree
from .runs import Binding, Runs


@pytest.fixture(scope="module")
def lamp(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return case(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def out() -> Iterator[Path]:
    """The folder of all runs."""
    with swift_folder() as folder:
        yield folder / "out"


@pytest.fixture(scope="module")
def runs(lamp: Case, out: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runs]:
    with Runs(tmp_path_factory.mktemp("runs"), *lamp.arguments(out), watched=out) as started:
        yield started


def put(stands: Path, out: Path) -> Path:
    shutil.rmtree(out, ignore_errors=True)
    return shutil.copytree(stands, out)


def killed(runs: Runs, stands: Path, out: Path) -> Iterator[int]:
    """Runs the case on a copy of what stands there, killed at each step in turn, until one run is through."""
    for step in count(1):
        put(stands, out)
        ended = runs.run(bound=Binding(str(out), step))
        if ended.status == 0:
            return
        assert ended.status == -signal.SIGKILL, ended
        yield step


@pytest.fixture(scope="module")
def remains(runs: Runs, lamp: Case, out: Path) -> list[Path]:
    """What is left of the folder after each kill."""
    return [shutil.copytree(out, out.with_name(f"{step}")) for step in killed(runs, lamp.before, out)]


def decided(remains: list[Path]) -> list[Path]:
    return [folder for folder in remains if (folder / JOURNAL).exists()]


def visible(out: Path) -> dict[str, bytes]:
    return {path: data for path, data in tree(out).items() if path == MANIFEST or not path.startswith(".")}


def test_the_old_output_is_whole_or_the_next_run_completes(
    runs: Runs, remains: list[Path], lamp: Case, out: Path
) -> None:
    assert len(remains) > 60 and len(decided(remains)) > 15
    for folder in remains:
        assert visible(folder) in (lamp.old, lamp.new) or (folder / JOURNAL).exists(), folder.name
        put(folder, out)
        assert runs.run().status == 0
        assert tree(out) == lamp.new, folder.name


def test_a_check_in_between_tells_and_completes_nothing(remains: list[Path], lamp: Case) -> None:
    for folder in remains:
        stands = tree(folder)
        found = "".join(difference(folder, lamp.content))
        assert tree(folder) == stands
        assert ("a run that was cut short" in found) == (folder / JOURNAL).exists()
        assert found or visible(folder) == lamp.new


def test_no_edit_is_lost_whenever_it_was_made(remains: list[Path], lamp: Case, out: Path) -> None:
    """Every file that the run was to change, add or remove, edited after every kill."""
    assert len(lamp.replaced) >= 8
    for folder in (remains[0], *decided(remains)):
        put(folder, out)
        stands = tree(out)
        for path in sorted({*lamp.replaced, *lamp.new} & {*stands} - {*MINE, MANIFEST}):
            (out / path).write_bytes(stands[path] + b"by hand\n")
            with pytest.raises(OutputError, match=r"was edited by hand|was not made by canwright") as error:
                write(out, lamp.content, patience=0)
            assert f"out/{path} " in str(error.value)
            assert (out / path).read_bytes() == stands[path] + b"by hand\n"
            put(folder, out)


def test_a_file_put_where_one_is_to_come_is_kept(remains: list[Path], lamp: Case, out: Path) -> None:
    added = [path for path in lamp.new if path not in lamp.old]
    assert len(added) >= 5
    for path in added:
        put(decided(remains)[0], out)
        (out / path).parent.mkdir(parents=True, exist_ok=True)
        (out / path).write_bytes(b"by hand\n")
        with pytest.raises(OutputError, match="was not made by canwright"):
            write(out, lamp.content, patience=0)
        assert (out / path).read_bytes() == b"by hand\n"


def test_force_drops_edits_and_completes(remains: list[Path], lamp: Case, out: Path) -> None:
    for folder in decided(remains)[::3]:
        put(folder, out)
        for path in lamp.replaced:
            if (out / path).exists():
                (out / path).write_bytes(b"by hand\n")
        write(out, lamp.content, force=True, patience=0)
        assert tree(out) == lamp.new


def test_the_completing_run_may_be_killed_too(runs: Runs, remains: list[Path], lamp: Case, out: Path) -> None:
    between = decided(remains)
    for folder in (between[0], between[len(between) // 2]):
        for step in killed(runs, folder, out):
            assert runs.run().status == 0
            assert tree(out) == lamp.new, (folder.name, step)


def test_a_first_run_killed(lamp: Case, out: Path, tmp_path: Path) -> None:
    """Where no folder was."""
    first = out.with_name("first")
    new = {path: data for path, data in lamp.new.items() if path not in MINE}
    with Runs(tmp_path, *lamp.arguments(first), watched=first) as runs:
        for step in count(1):
            shutil.rmtree(first, ignore_errors=True)
            ended = runs.run(bound=Binding(str(first), step))
            if ended.status == 0:
                break
            assert runs.run().status == 0
            assert tree(first) == new, step
    assert step > 60


def test_killed_while_undoing(runs: Runs, lamp: Case, out: Path) -> None:
    """A folder that may not be written makes the run undo what it did; killed at each step of that."""
    closed = out / "docs/en/v1"
    for step in count(1):
        put(lamp.before, out)
        closed.chmod(0o555)
        ended = runs.run(bound=Binding(str(out), step, common_user=True))
        closed.chmod(0o755)
        if ended.status != -signal.SIGKILL:
            break
        assert visible(out) == lamp.old or (out / JOURNAL).exists(), step
        assert runs.run().status == 0
        assert tree(out) == lamp.new, step
    assert ended.status == 2 and tree(out) == lamp.old and step > 60


def test_rubbish_of_a_killed_run_is_removed_and_nothing_else(remains: list[Path], lamp: Case, out: Path) -> None:
    undecided = [folder for folder in remains if (folder / STAGING).exists() and folder not in decided(remains)]
    assert len(undecided) > 20
    for folder in undecided[::4]:
        put(folder, out)
        (out / "docs/later.md").write_bytes(b"mine\n")
        write(out, lamp.content, patience=0)
        assert tree(out) == {**lamp.new, "docs/later.md": b"mine\n"}
