"""What `decode` and `identify` read: a log, or a bus of python-can."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator

import click

from ..recordings.bus_log import BusLog
from ..recordings.readers import Log, open_log
from .bus import EXAMPLE, BusArguments, opened_bus


@contextlib.contextmanager
def log_or_bus(
    log: str | None,
    bus_arguments: BusArguments,
    *,
    is_followed: bool = False,
    has_differences: bool = False,
    is_split: bool = False,
) -> Iterator[Log]:
    """The log with this name; without one, the bus. Raises OSError."""
    if (log is None) != bool(bus_arguments):
        raise click.UsageError(f"give either LOG or a bus, such as {EXAMPLE}")
    if log is not None:
        opened = open_log(log, is_followed=is_followed, has_differences=has_differences, is_split=is_split)
        with opened as recording:
            yield recording
    elif is_followed or has_differences or is_split:
        raise click.UsageError("--follow, --time-differences and --from-split are for logs, not for a bus")
    else:
        with opened_bus(bus_arguments) as bus:
            yield BusLog(bus)


@contextlib.contextmanager
def ended_by_interrupt(log: Log) -> Iterator[None]:
    """An interrupt ends the log, so that its summary is printed; the second one ends the run."""
    before = signal.getsignal(signal.SIGINT)

    def end(*_: object) -> None:
        log.is_ended = True
        signal.signal(signal.SIGINT, before)

    signal.signal(signal.SIGINT, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
