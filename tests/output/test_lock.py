"""Two runs at once in one folder: they follow one another, or the second says why it does not run."""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from canwright.output.paths import LOCK, OutputError
from canwright.output.writer import Content, write

from .runs import Binding, Runs
from .scenario import USER_FILES, Scenario, memory_folder, tree


@pytest.fixture
def out(scenario: Scenario) -> Iterator[Path]:
    with memory_folder() as folder:
        scenario.restore(folder / "out")
        yield folder / "out"


def test_two_runs_at_once_do_not_mix(scenario: Scenario, out: Path, tmp_path: Path) -> None:
    """Each forked just before it begins to write."""
    changed = tmp_path / "other.yaml"
    changed.write_text(scenario.spec.read_text("utf-8").replace("fade:", "glow:"), "utf-8")
    arguments = scenario.arguments(out)
    two = [str(changed) if argument == str(scenario.spec) else argument for argument in arguments]
    (tmp_path / "texts").mkdir()
    with Runs(tmp_path, *arguments, watched=out) as first, Runs(tmp_path / "texts", *two, watched=out) as second:
        whole = []
        for run in (first, second):
            scenario.restore(out)
            assert run.run().status == 0
            whole.append(tree(out))
        assert whole[0] != whole[1]
        for _ in range(25):
            scenario.restore(out)
            processes = first.start(), second.start()
            for run, process in zip((first, second), processes, strict=True):
                ended = run.wait(process)
                assert ended.status == 0, ended.text
            assert tree(out) in whole
    assert set(USER_FILES) <= set(whole[0])


def test_the_second_run_waits_for_the_first_and_then_says_so(runs: Runs, scenario: Scenario, out: Path) -> None:
    """The first is stopped in the middle; the second changes nothing, and the first goes on to its end."""
    first = runs.start(*scenario.arguments(out), bound=Binding(str(out), step=30, signal=signal.SIGSTOP))
    assert runs.wait(first).status == -signal.SIGSTOP
    before = tree(out)
    message = f"another run is writing to {out}; wait until it ends and run again"
    with pytest.raises(OutputError) as error:
        write(out, scenario.content, patience=0.2)
    assert (str(error.value), tree(out)) == (message, before)
    os.kill(first, signal.SIGCONT)
    assert runs.wait(first).status == 0
    assert tree(out) == scenario.new


def test_the_lock_of_a_killed_run_does_not_block(scenario: Scenario, out: Path) -> None:
    (out / LOCK).touch()
    write(out, scenario.content, patience=0)
    assert tree(out) == scenario.new


@pytest.mark.parametrize("linked", [False, True], ids=["a file", "a hard link"])
def test_a_file_of_the_user_at_the_path_of_the_lock_is_kept(
    scenario: Scenario, out: Path, tmp_path: Path, linked: bool
) -> None:
    if linked:
        (out / "elsewhere").write_bytes(b"mine\n")
        (out / LOCK).hardlink_to(out / "elsewhere")
    else:
        (out / LOCK).write_bytes(b"mine\n")
    before = tree(out)
    with pytest.raises(OutputError, match=f"{out}/{LOCK} is not a lock of canwright, it has content; move it away"):
        write(out, scenario.content, force=True)
    assert tree(out) == before


def test_the_lock_is_removed_after_a_failure(scenario: Scenario, out: Path) -> None:
    shutil.copy(out / "mine.txt", out / "docs/en/v1/types.md")
    with pytest.raises(OutputError, match="was edited by hand"):
        write(out, scenario.content)
    assert not (out / LOCK).exists()


def test_a_lock_that_is_a_hard_link_is_not_written(tmp_path: Path) -> None:
    """Locking would open, and some versions of filelock would empty, a file outside the output folder."""
    (tmp_path / "out").mkdir()
    (tmp_path / "empty").touch()
    (tmp_path / "out" / LOCK).hardlink_to(tmp_path / "empty")
    with pytest.raises(OutputError, match="hard link"):
        write(tmp_path / "out", Content(("lamp v1",), ("dbc",), {"dbc/a.dbc": b""}))
    assert not (tmp_path / "out/dbc").exists()
