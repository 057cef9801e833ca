"""The real command line killed at every step it makes on disk: the old output is whole, or the next run makes the new."""

from __future__ import annotations

import shutil
import signal
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest
from canwright.folder import JOURNAL, MANIFEST, STAGING, OutputError
from canwright.output import difference, write

from .output_case import MINE, Case, case, tree
from .runs import Binding, Runs


@pytest.fixture(scope="module")
def lamp(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return case(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runs]:
    with Runs(tmp_path_factory.mktemp("runs")) as started:
        yield started


def killed(runs: Runs, lamp: Case, out: Path, first: int = 1) -> Iterator[int]:
    """Runs the case in `out` as it stands there, killed at each step in turn, until one run is through."""
    stands = out.with_name("stands")
    shutil.copytree(out, stands)
    for step in count(first):
        ended = runs.run(*lamp.arguments(out), bound=Binding(str(out), step))
        if ended.status == 0:
            break
        assert ended.status == -signal.SIGKILL, ended
        yield step
        shutil.rmtree(out)
        shutil.copytree(stands, out)
    shutil.rmtree(stands)


@pytest.fixture(scope="module")
def remains(runs: Runs, lamp: Case, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """What is left of the folder after each kill."""
    folder = tmp_path_factory.mktemp("killed")
    lamp.restore(folder / "out")
    return [shutil.copytree(folder / "out", folder / f"{step}") for step in killed(runs, lamp, folder / "out")]


def decided(remains: list[Path]) -> list[Path]:
    return [folder for folder in remains if (folder / JOURNAL).exists()]


def visible(out: Path) -> dict[str, bytes]:
    return {path: data for path, data in tree(out).items() if path == MANIFEST or not path.startswith(".")}


def test_the_old_output_is_whole_or_the_next_run_completes(remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    assert len(remains) > 60 and len(decided(remains)) > 15
    for folder in remains:
        whole = visible(folder) in (lamp.old, lamp.new)
        assert whole or (folder / JOURNAL).exists(), folder.name
        out = shutil.copytree(folder, tmp_path / folder.name)
        write(out, lamp.content, patience=0)
        assert tree(out) == lamp.new, folder.name


def test_the_command_completes(runs: Runs, remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    for folder in decided(remains)[::5]:
        out = shutil.copytree(folder, tmp_path / folder.name)
        assert runs.run(*lamp.arguments(out)).status == 0
        assert tree(out) == lamp.new, folder.name


def test_a_check_in_between_tells_and_completes_nothing(remains: list[Path], lamp: Case) -> None:
    for folder in remains:
        stands = tree(folder)
        found = "".join(difference(folder, lamp.content))
        assert tree(folder) == stands
        assert ("a run that was cut short" in found) == (folder / JOURNAL).exists()
        assert found or visible(folder) == lamp.new


def test_no_edit_is_lost_whenever_it_was_made(remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    """Every file that the run was to change or remove, edited after every kill."""
    assert len(lamp.replaced) >= 8
    for folder in (remains[0], *decided(remains)):
        for path in sorted({*lamp.replaced, *lamp.new} & {*tree(folder)} - {*MINE, MANIFEST}):
            out = shutil.copytree(folder, tmp_path / "out")
            with (out / path).open("ab") as stream:
                stream.write(b"by hand\n")
            stands = tree(out)
            with pytest.raises(OutputError, match=r"was edited by hand|was not made by canwright") as error:
                write(out, lamp.content, patience=0)
            assert f"out/{path} " in str(error.value)
            assert visible(out)[path] == stands[path]
            shutil.rmtree(out)


def test_a_file_put_where_one_is_to_come_is_kept(remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    folder = decided(remains)[0]
    added = [path for path in lamp.new if path not in lamp.old]
    assert len(added) >= 5
    for path in added:
        out = shutil.copytree(folder, tmp_path / "out")
        (out / path).parent.mkdir(parents=True, exist_ok=True)
        (out / path).write_bytes(b"by hand\n")
        with pytest.raises(OutputError, match="was not made by canwright"):
            write(out, lamp.content, patience=0)
        assert (out / path).read_bytes() == b"by hand\n"
        shutil.rmtree(out)


def test_force_drops_edits_and_completes(remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    for folder in decided(remains)[::3]:
        out = shutil.copytree(folder, tmp_path / folder.name)
        for path in lamp.replaced:
            if (out / path).exists():
                (out / path).write_bytes(b"by hand\n")
        write(out, lamp.content, force=True, patience=0)
        assert tree(out) == lamp.new


def test_the_completing_run_may_be_killed_too(runs: Runs, remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    between = decided(remains)
    for folder in (between[0], between[len(between) // 2]):
        out = shutil.copytree(folder, tmp_path / folder.name)
        for step in killed(runs, lamp, out):
            write(out, lamp.content, patience=0)
            assert tree(out) == lamp.new, (folder.name, step)


def test_a_first_run_killed(runs: Runs, lamp: Case, tmp_path: Path) -> None:
    """Where no folder was; every third step, for all of them are the same kind of step as above."""
    out = tmp_path / "out"
    new = {path: data for path, data in lamp.new.items() if path not in MINE}
    for step in count(1, 3):
        ended = runs.run(*lamp.arguments(out), bound=Binding(str(out), step))
        if ended.status == 0:
            break
        write(out, lamp.content, patience=0)
        assert tree(out) == new, step
        shutil.rmtree(out)
    assert step > 60


def test_killed_while_undoing(runs: Runs, lamp: Case, tmp_path: Path) -> None:
    """A folder that may not be written makes the run undo what it did; killed at each step of that."""
    out = tmp_path / "out"
    locked = out / "docs/en/v1"
    lamp.restore(out)
    locked.chmod(0o555)
    bound = Binding(str(out), trace=True, common_user=True)
    traced = runs.run(*lamp.arguments(out), bound=bound)
    assert traced.status == 2 and tree(out) == lamp.old
    steps = [line for line in traced.text.splitlines() if line.startswith(("os.", "open", "fcntl"))]
    decided = next(number for number, line in enumerate(steps, 1) if line == "os.rename")
    assert len(steps) - decided > 20
    for step in range(decided, len(steps) + 1):
        locked.chmod(0o755)
        lamp.restore(out)
        locked.chmod(0o555)
        ended = runs.run(*lamp.arguments(out), bound=Binding(str(out), step, common_user=True))
        assert ended.status == -signal.SIGKILL
        locked.chmod(0o755)
        assert visible(out) == lamp.old or (out / JOURNAL).exists(), step
        write(out, lamp.content, patience=0)
        assert tree(out) == lamp.new, step


def test_rubbish_of_a_killed_run_is_removed_and_nothing_else(remains: list[Path], lamp: Case, tmp_path: Path) -> None:
    undecided = [folder for folder in remains if (folder / STAGING).exists() and folder not in decided(remains)]
    assert len(undecided) > 20
    for folder in undecided[::4]:
        out = shutil.copytree(folder, tmp_path / folder.name)
        (out / "docs/later.md").write_bytes(b"mine\n")
        write(out, lamp.content, patience=0)
        assert tree(out) == dict(sorted({**lamp.new, "docs/later.md": b"mine\n"}.items()))
