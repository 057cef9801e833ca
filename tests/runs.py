"""Runs of the real command line, each in a process of its own that can be killed at a step or bound by a limit.

One process has everything imported and forks for each run, so that hundreds of runs take seconds. The steps of a run are
the calls that change something on disk, counted from the first one inside the watched folder.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from .spec_texts import ROOT

_STEPS = {
    "open",
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
    """Use as a context manager. `text` is the file that output goes to."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        self._texts: dict[int, Path] = {}
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.runs"], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

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


def _serve() -> None:
    from canwright.cli import main

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
                main(question["start"])
        sys.stdout.write(f"{answer}\n")
        sys.stdout.flush()


def _bind(bound: Binding) -> None:
    if bound.common_user:
        _drop_rights()
    if bound.file_size:
        resource.setrlimit(resource.RLIMIT_FSIZE, (bound.file_size, bound.file_size))
    if bound.step or bound.trace:
        steps = 0

        def count(event: str, arguments: Sequence[object]) -> None:
            nonlocal steps
            if event not in _STEPS or (event == "open" and not _writes(arguments)):
                return
            if steps == 0 and not any(_inside(argument, bound.folder) for argument in arguments):
                return
            steps += 1
            if bound.trace:
                os.write(1, f"{event}\n".encode())
            if steps == bound.step:
                os.kill(os.getpid(), bound.signal)

        sys.addaudithook(count)


def _writes(arguments: Sequence[object]) -> bool:
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


if __name__ == "__main__":
    _serve()
