"""Two runs at once in one folder: they follow one another, or the second says why it does not run."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from canwright.output.lock import locked
from canwright.output.paths import LOCK, OutputError, digest
from canwright.output.transaction import stage
from canwright.output.writer import Changes, held, write
from canwright.project.loader import described
from canwright.project.pipeline import generate

from ..spec_texts import MINIMAL, ROOT
from .output_case import MINE, Case, case, swift_folder, tree
from .runs import Binding, Runs


@pytest.fixture(scope="module")
def lamp(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return case(tmp_path_factory.mktemp("case"))


@pytest.fixture
def out() -> Iterator[Path]:
    with swift_folder() as folder:
        yield folder / "out"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runs]:
    with Runs(tmp_path_factory.mktemp("runs")) as started:
        yield started


def test_two_runs_at_once_do_not_mix(lamp: Case, out: Path, tmp_path: Path) -> None:
    """Each forked just before it begins to write."""
    other = tmp_path / "other.yaml"
    other.write_text(lamp.spec.read_text("utf-8").replace("fade:", "glow:"), "utf-8")
    one, two = lamp.arguments(out), [*lamp.arguments(out)[:2], str(other), *lamp.arguments(out)[3:]]
    (tmp_path / "texts").mkdir()
    with Runs(tmp_path, *one, watched=out) as first, Runs(tmp_path / "texts", *two, watched=out) as second:
        whole = []
        for run in (first, second):
            lamp.restore(out)
            assert run.run().status == 0
            whole.append(tree(out))
        assert whole[0] != whole[1]
        ends = []
        for _ in range(25):
            lamp.restore(out)
            processes = first.start(), second.start()
            for run, process in zip((first, second), processes, strict=True):
                ended = run.wait(process)
                assert ended.status == 0, ended.text
            ends.append(whole.index(tree(out)))
    assert set(MINE) <= set(whole[0])


def test_a_run_that_takes_long_is_named(runs: Runs, lamp: Case, out: Path) -> None:
    """It is stopped in the midst; the second run changes nothing, and the first goes on to its end."""
    lamp.restore(out)
    first = runs.start(*lamp.arguments(out), bound=Binding(str(out), step=30, signal=signal.SIGSTOP))
    assert runs.wait(first).status == -signal.SIGSTOP
    stands = tree(out)
    second = runs.run(*lamp.arguments(out))
    assert second.status == 2
    assert second.text == (
        f"canwright: another run (process {first}) is writing to {out}; wait until it ends and run again, or remove "
        f"{out}/{LOCK} if there is no such process\n"
    )
    assert tree(out) == stands
    os.kill(first, signal.SIGCONT)
    assert runs.wait(first).status == 0
    assert tree(out) == lamp.new


@pytest.mark.parametrize("left", ["", "1", "12345", "not a process", "9" * 4000])
def test_the_lock_of_a_killed_run_does_not_block(runs: Runs, lamp: Case, out: Path, left: str) -> None:
    lamp.restore(out)
    (out / LOCK).write_text(left)
    assert runs.run(*lamp.arguments(out)).status == 0
    assert tree(out) == lamp.new


@pytest.mark.parametrize("left", ["", "\x1b[2J", "9" * 4000, "²"])
def test_a_strange_lock_is_not_told(tmp_path: Path, left: str) -> None:
    with locked(tmp_path, 0):
        (tmp_path / LOCK).write_text(left)
        with pytest.raises(OutputError) as error, locked(tmp_path, 0):
            pass
    assert str(error.value).startswith("another run") and str(error.value).isprintable() and len(str(error.value)) < 400


WITHOUT = {
    "system": "sys.modules['fcntl'] = None",
    "file system": """
import errno, os
def no_locks(event, arguments):
    if event == "fcntl.flock":
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
sys.addaudithook(no_locks)
""",
}


@pytest.mark.parametrize("lacking", WITHOUT)
def test_without_locks_having_made_the_file_decides(lamp: Case, out: Path, lacking: str) -> None:
    """A system, or a file system, that has none."""
    lamp.restore(out)
    script = f"""
import sys
{WITHOUT[lacking]}
from pathlib import Path
from canwright.cli import main
from canwright.output.paths import OutputError
from canwright.output.lock import locked
out = Path(sys.argv[1])
main(sys.argv[2:], standalone_mode=False)
with locked(out, 0):
    try:
        with locked(out, 0):
            print("both")
    except OutputError as error:
        print(error)
"""
    command = [sys.executable, "-c", script, str(out), *lamp.arguments(out)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert f"remove {out}/{LOCK} if there is no such process" in ended.stdout and "both" not in ended.stdout
    assert tree(out) == lamp.new


def test_the_lock_is_gone_after_a_failure(runs: Runs, lamp: Case, out: Path) -> None:
    lamp.restore(out)
    shutil.copy(out / "mine.txt", out / "docs/en/v1/types.md")
    assert runs.run(*lamp.arguments(out)).status == 2
    assert not (out / LOCK).exists()


def test_what_another_run_changed_meanwhile_is_not_taken_for_standing(lamp: Case, out: Path, tmp_path: Path) -> None:
    """A run looks at the folder while it makes its files; by the time that it writes, another one has been there."""
    spec = tmp_path / "spec.yaml"
    spec.write_text(MINIMAL, "utf-8")
    lamp.restore(out)
    made = generate([described(spec)], ["docs"], {}, held(out))
    assert not made.files and len(made.standing) >= 9
    assert write(out, made) == Changes((), (), len(made.standing))
    write(out, lamp.content)
    with pytest.raises(OutputError, match=f"{out} was changed while this run was at work; run again"):
        write(out, made)
    assert tree(out) == lamp.new


def test_nothing_is_taken_for_standing_while_a_run_is_to_be_completed(lamp: Case, out: Path) -> None:
    lamp.restore(out)
    assert held(out).files
    stage(out, {"docs/en/index.md": b"new"})
    assert not held(out).files


def test_what_is_standing_was_made_by_an_earlier_run_and_is_there(lamp: Case, out: Path) -> None:
    lamp.restore(out)
    file = out / "docs/en/index.md"
    data = file.read_bytes()
    assert held(out).standing("docs/en/index.md", data) == digest(data)
    assert held(out).standing("docs/en/index.md", data + b"more") is None
    file.write_bytes(data + b"more")
    assert held(out).standing("docs/en/index.md", data + b"more") is None
    assert held(out).standing("docs/en/index.md", data) is None
    file.unlink()
    assert held(out).standing("docs/en/index.md", data) is None
    assert held(out / "elsewhere").standing("docs/en/index.md", data) is None
