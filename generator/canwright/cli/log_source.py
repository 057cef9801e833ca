"""What `decode` and `identify` read: a log, or a bus of python-can."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator, Sequence

import click

from ..model.edition import Edition
from ..model.message import Direction
from ..recordings.bus_log import BusLog
from ..recordings.directions import Directions
from ..recordings.identify import Identifier
from ..recordings.nodes import Identifiers, Nodes, NodeSetting, common_edition, nodes_of
from ..recordings.readers import Log, open_log
from .bus import EXAMPLE, BusArguments, opened_bus
from .terminal import progress

BLOCK = 500
"""The maximum number of frames that are processed at once."""


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


def known_nodes(
    log: Log,
    editions: Sequence[Edition],
    settings: Sequence[NodeSetting],
    recorder: Direction | None,
    window: int | None = None,
) -> Nodes | None:
    """The nodes of a log, which is read once to identify them; None for a stream whose nodes may have several editions."""
    common = common_edition(editions, settings)
    if common is not None:
        return Nodes([common], settings, common)
    return nodes_of(_identified(log, Identifiers(editions, recorder, window)), settings) if log.is_file else None


def _identified(log: Log, identifiers: Identifiers) -> Identifier:
    """All frames of a log in a file, with the editions that they fit."""
    again = open_log(log.name, has_differences=log.has_differences, is_split=log.is_split)
    with again as frames, progress("frames", shown=True) as advance:
        for number, frame in enumerate(frames):
            identifiers.add(frame)
            if number % BLOCK == BLOCK - 1:
                advance(BLOCK)
    return identifiers.best


def unset_parameters(editions: Sequence[Edition]) -> list[str]:
    """A remark for each parameter in ids or constants that is unknown, so that frames with it are not identified."""
    unknown = dict.fromkeys(name for e in editions for m in e.all_messages() for name in m.parameters)
    return [f"ids or constants contain `{name}`, which is unknown: --set {name}=NUMBER" for name in unknown]


def log_directions(log: Log, nodes: Nodes, recorder: Direction | None, window: int | None = None) -> Directions:
    """What decides on the directions of the frames of a log; a request is answered within `window` ns."""
    return Directions(
        nodes.editions,
        nodes.default,
        window=window,
        recorder=recorder,
        is_stream=not log.is_file,
        further=nodes.family,
        changes=nodes.changes,
    )
