"""Tests in processes of their own, which are forked for them."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

T = TypeVar("T")


def passing(subjects: Iterable[T], test: Callable[[T], None], jobs: int) -> Iterator[T]:
    """Those of some subjects with which a test raises nothing and is not stopped; `jobs` run at the same time."""
    running: deque[tuple[int, T]] = deque()
    for subject in subjects:
        if len(running) == jobs:
            yield from _passed(*running.popleft())
        running.append((_forked(test, subject), subject))
    for process in running:
        yield from _passed(*process)


def _passed(process: int, subject: T) -> Iterator[T]:
    if not os.waitpid(process, 0)[1]:
        yield subject


def _forked(test: Callable[[T], None], subject: T) -> int:
    """The process of a test, whose output is dropped."""
    process = os.fork()
    if not process:
        status = 1
        try:
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, 1)
            os.dup2(null, 2)
            test(subject)
            status = 0
        finally:
            os._exit(status)
    return process
