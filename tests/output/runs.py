"""Runs of the real command line, each in a process of its own that can be killed at a step or bound by a limit.

One process has everything imported and forks for each run. Where many runs are alike it goes as far as their first step
and forks there, so that a hundred of them take seconds. Steps are the calls that change something on disk, counted from
the first one inside the watched folder, or from where the run was forked.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from ..spec_texts import ROOT

_STEPS = {
    "os.mkdir",
    "os.rename",
    "os.remove",
    "os.rmdir",
    "os.truncate",
    "os.link",
    "os.symlink",
    "os.chmod",
    "os.utime",
    "fcntl.flock",
}


@dataclass(frozen=True)
class Binding:
    """What a run is bound by: a signal at a step inside a folder, the size of a file, the rights of a common user."""

    folder: str = ""
    step: int = 0
    signal: int = signal.SIGKILL
    trace: bool = False
    file_size: int = 0
    common_user: bool = False


@dataclass(frozen=True)
class Ended:
    """How a run ended: its exit status, or less than 0 for the signal that stopped it; and all that it printed."""

    status: int
    text: str


class Runs:
    """Texts of the runs go to `folder`. With `arguments`, all runs are that one, forked at its first step in `watched`."""

    def __init__(self, folder: Path, *arguments: str, watched: Path | None = None, inside: Sequence[str] = ()) -> None:
        self._folder = folder
        self._count = 0
        self._texts: dict[int, Path] = {}
        command = [*inside, sys.executable, "-m", "tests.output.runs", *([str(watched)] if watched else []), *arguments]
        self._process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.process = self._process.pid

    def __enter__(self) -> Runs:
        return self

    def __exit__(self, *error: object) -> None:
        assert self._process.stdin and self._process.stdout
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def run(self, *arguments: str, bound: Binding | None = None) -> Ended:
        return self.wait(self.start(*arguments, bound=bound))

    def start(self, *arguments: str, bound: Binding | None = None) -> int:
        """The process of a run that goes on meanwhile."""
        self._count += 1
        text = self._folder / f"run{self._count}.txt"
        bound = bound or Binding()
        process = self._ask({"start": arguments, "bound": asdict(bound), "text": str(text)})
        self._texts[process] = text
        return process

    def wait(self, process: int) -> Ended:
        """Until the run ends or is stopped."""
        return Ended(self._ask({"wait": process}), self._texts[process].read_text("utf-8"))

    def _ask(self, question: object) -> int:
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps(question) + "\n")
        self._process.stdin.flush()
        return int(self._process.stdout.readline())


def _serve() -> list[str]:
    """Answers questions; in a run that was asked for, returns its arguments."""
    gc.collect()
    gc.freeze()
    for line in sys.stdin:
        question = json.loads(line)
        if "wait" in question:
            _, status = os.waitpid(question["wait"], os.WUNTRACED)
            answer = -os.WSTOPSIG(status) if os.WIFSTOPPED(status) else os.waitstatus_to_exitcode(status)
        else:
            answer = os.fork()
            if answer == 0:
                descriptor = os.open(question["text"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
                os.dup2(descriptor, 1)
                os.dup2(descriptor, 2)
                _bind(Binding(**question["bound"]))
                return list(question["start"])
        sys.stdout.write(f"{answer}\n")
        sys.stdout.flush()
    os._exit(0)


def _serve_at_first_step(watched: str) -> None:
    stands = False

    def at_step(event: str, arguments: Sequence[object]) -> None:
        nonlocal stands
        if not stands and _is_step(event, arguments) and any(_inside(argument, watched) for argument in arguments):
            stands = True
            _serve()

    sys.addaudithook(at_step)


def _bind(bound: Binding) -> None:
    if bound.common_user:
        _drop_rights()
    if bound.file_size:
        resource.setrlimit(resource.RLIMIT_FSIZE, (bound.file_size, bound.file_size))
    if bound.step or bound.trace:
        steps = 0

        def count(event: str, arguments: Sequence[object]) -> None:
            nonlocal steps
            if not _is_step(event, arguments):
                return
            if steps == 0 and not any(_inside(argument, bound.folder) for argument in arguments):
                return
            steps += 1
            if bound.trace:
                os.write(1, f"{event}\n".encode())
            if steps == bound.step:
                os.kill(os.getpid(), bound.signal)

        sys.addaudithook(count)


def _is_step(event: str, arguments: Sequence[object]) -> bool:
    if event != "open":
        return event in _STEPS
    flags = arguments[2]
    return isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))


def _inside(argument: object, folder: str) -> bool:
    return isinstance(argument, str | os.PathLike) and os.fspath(argument).startswith(folder)


def _drop_rights() -> None:
    """Makes folders that may not be written bind the superuser too: gives up CAP_DAC_OVERRIDE and the like for good."""
    if os.geteuid() != 0:
        return
    system = ctypes.CDLL(None, use_errno=True)
    version_3 = 0x20080522
    header = (ctypes.c_uint32 * 2)(version_3, 0)
    none = (ctypes.c_uint32 * 6)()
    if system.capset(header, none) != 0:
        raise OSError(ctypes.get_errno(), "capset")


def _main() -> None:
    import filelock  # noqa: F401  # which the writer imports only when it writes, in each forked run
    from canwright.cli import main

    status: object = 0
    try:
        if sys.argv[1:]:
            _serve_at_first_step(sys.argv[1])
            main(sys.argv[2:])
        main(_serve())
    except SystemExit as end:
        status = end.code
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status if isinstance(status, int) else 0)  # to take the interpreter down takes longer than most runs


if __name__ == "__main__":
    _main()
