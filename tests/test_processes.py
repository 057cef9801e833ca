"""Work side by side. It is tried in a process of its own, for one with threads, as under pytest, does not split."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

BEGIN = """
import json, os, signal, time
from functools import partial
from canwright import processes
processes._processors = lambda: 3
here = os.getpid()
def first():
    # so long that others take what follows
    time.sleep(0.5)
    return 1
def left():
    try:
        return os.waitpid(-1, os.WNOHANG)
    except ChildProcessError:
        return None
"""


def run(script: str) -> object:
    done = subprocess.run(
        [sys.executable, "-c", BEGIN + script], capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return json.loads(done.stdout)


def test_results_are_in_order_and_from_several_processes() -> None:
    found = run(
        "def piece(i):\n"
        "    time.sleep(0.5)\n"
        "    return i, os.getpid()\n"
        "found = processes.for_each(piece, range(6))\n"
        "print(json.dumps([[i for i, _ in found], found[0][1] == here, len({pid for _, pid in found}), left()]))"
    )
    assert found == [[0, 1, 2, 3, 4, 5], True, 3, None]


def test_every_item_has_its_result() -> None:
    script = "print(json.dumps([processes.for_each(lambda n: n * n, list(range(n))) for n in range(8)]))"
    assert run(script) == [[i * i for i in range(n)] for n in range(8)]


def test_a_large_result_arrives_whole() -> None:
    script = "a, b = processes.side_by_side([first, lambda: 'x' * 5_000_000])\nprint(json.dumps([a, len(b)]))"
    assert run(script) == [1, 5_000_000]


def test_what_a_piece_raises_is_raised() -> None:
    found = run(
        "def fail(): raise LookupError('the third')\n"
        "try:\n"
        "    processes.side_by_side([first, lambda: 'x' * 5_000_000, fail])\n"
        "except LookupError as error:\n"
        "    print(json.dumps([str(error), left()]))"
    )
    assert found == ["the third", None]


def test_a_failure_here_leaves_no_process_behind() -> None:
    found = run(
        "def fail(): raise LookupError('the first')\n"
        "try:\n"
        "    processes.side_by_side([fail, lambda: 'x' * 5_000_000])\n"
        "except LookupError as error:\n"
        "    print(json.dumps([str(error), left()]))"
    )
    assert found == ["the first", None]


@pytest.mark.parametrize("death", ["os.kill(os.getpid(), signal.SIGKILL)", "raise MemoryError"])
def test_the_work_of_a_process_that_dies_is_done_again(death: str) -> None:
    found = run(
        "def piece():\n"
        f"    if os.getpid() != here: {death}\n"
        "    return 'done'\n"
        "print(json.dumps([processes.side_by_side([first, piece]), left()]))"
    )
    assert found == [[1, "done"], None]


def test_nothing_splits_beside_a_thread() -> None:
    found = run(
        "import importlib, threading\n"
        "importlib.reload(processes)\n"
        "event = threading.Event()\n"
        "threading.Thread(target=event.wait, daemon=True).start()\n"
        "print(json.dumps(processes.side_by_side([os.getpid, os.getpid]) == [here, here]))"
    )
    assert found is True


def test_work_is_done_meanwhile_by_another_process() -> None:
    found = run(
        "with processes.meanwhile(lambda: (os.getpid(), 'x' * 5_000_000)) as result:\n"
        "    time.sleep(0.2)\n"
        "    process, text = result()\n"
        "print(json.dumps([process != here, len(text), left()]))"
    )
    assert found == [True, 5_000_000, None]


@pytest.mark.parametrize("result", [0, None, []])
def test_nothing_is_a_result_too(result: object) -> None:
    script = "work = lambda: RESULT if os.getpid() != here else 'again'\n".replace("RESULT", repr(result))
    script += "with processes.meanwhile(work) as result:\n    print(json.dumps(result()))"
    assert run(script) == result


def test_what_is_done_meanwhile_is_done_again_where_it_failed() -> None:
    found = run(
        "def fail(): raise LookupError(str(os.getpid() == here))\n"
        "try:\n"
        "    with processes.meanwhile(fail) as result: result()\n"
        "except LookupError as error:\n"
        "    print(json.dumps([str(error), left()]))"
    )
    assert found == ["True", None]


def test_what_nobody_asks_for_leaves_no_process_behind() -> None:
    found = run(
        "try:\n"
        "    with processes.meanwhile(lambda: 'x' * 5_000_000): raise LookupError\n"
        "except LookupError:\n"
        "    print(json.dumps(left()))"
    )
    assert found is None


def test_work_within_work_is_not_split_again() -> None:
    found = run(
        "def inner():\n"
        "    time.sleep(0.2)\n"
        "    return os.getpid()\n"
        "def piece():\n"
        "    with processes.meanwhile(os.getpid) as result:\n"
        "        return len({os.getpid(), result(), *processes.side_by_side([inner, inner, inner])})\n"
        "print(json.dumps([processes.side_by_side([piece, piece, piece]), piece() > 1]))"
    )
    assert found == [[1, 1, 1], True]


def test_what_is_done_meanwhile_does_not_split() -> None:
    script = "work = lambda: processes.for_each(lambda i: time.sleep(0.2) or os.getpid(), range(4))\n"
    script += "with processes.meanwhile(work) as result:\n    print(json.dumps(len(set(result()))))"
    assert run(script) == 1
