"""`monitor`."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..diagnostics.unicode_safety import visible
from ..model.edition import Edition
from ..recordings.latest_values import FILTER, Filter, parse_filter
from ..recordings.packages import MissingPackageError, require
from ..recordings.readers import LogError, open_log
from ..recordings.split import FORMATS
from . import INTERRUPTED
from .bus import EXAMPLE, BusArguments, bus_options, opened_bus
from .common import OutputPath, read, spec_option, stop
from .monitor_view import PlainTable
from .node_settings import bus_of, settings_option
from .terminal import print_text

if TYPE_CHECKING:
    from .monitor_feed import Feed

SECONDS = 1.0
"""The time between two blocks of lines."""


@click.command()
@click.argument("log", type=click.Path(exists=True, dir_okay=False, allow_dash=True), required=False)
@spec_option
@settings_option
@click.option(
    "--filter",
    "filters",
    multiple=True,
    metavar="NAME=TEXT",
    help=f"What to show: {FILTER.split()[0]}, and parts of names, as {' '.join(FILTER.split()[1:])}.",
)
@click.option(
    "--speed",
    type=click.FloatRange(min=0, min_open=True),
    metavar="N",
    help="Play LOG N times as fast as it was recorded.  [default: 1]",
)
@click.option("--record", type=OutputPath(FORMATS), help="A new log for all frames of the bus: .asc, .blf or .log.")
@click.option("--plain", is_flag=True, help="Print lines, as to a pipe, and not a view of the terminal.")
@bus_options
def monitor(
    log: str | None,
    specs: Sequence[Path],
    settings: Sequence[str],
    filters: Sequence[str],
    speed: float | None,
    record: Path | None,
    plain: bool,
    bus_arguments: BusArguments,
) -> None:
    """Show the nodes of a bus or a LOG with their latest values.

    Each value is shown with its unit, the time since its frame, the frames a second, and the time from the request to the
    reply; beside them are the load of the bus, rejected frames and error frames. Frames are decoded as by `canwright
    decode`. The view needs `pip install textual`, and shows its keys: a filter, a pause, a recording, and a command to send, which asks for the
    consent that `canwright request` needs. Without a terminal, or with --plain, a line for each message that came is
    printed every second.

    \b
      canwright monitor -i socketcan -c can0 -b 1000000
      canwright monitor -i socketcan -c can0 --filter node=1..2 --filter signal=volt --record bus.log
      canwright monitor bus.log --speed 10
      canwright monitor --plain -i udp_multicast | grep voltage

    Exit status: 0 at the end of LOG or of the view, 2 if it could not run or the bus does not work any more, 130 if
    Ctrl-C ended the lines.
    """
    try:
        chosen = parse_filter(" ".join(filters))
    except ValueError as error:
        stop(f"--filter {error}")
    bit_rate, further = bus_arguments.get("bitrate"), {**bus_arguments}
    if log is not None:
        further.pop("bitrate", None)
    _check(log, further, speed, record)
    is_plain = plain or not is_terminal()
    specifications = read(specs, packaged=True)
    editions, given = bus_of([item.edition for item in specifications], settings)
    from .monitor_feed import Feed, Player, Receiver

    bit_rate = bit_rate or _bit_rate(editions)
    try:
        if not is_plain:
            require("textual", "textual", "the view, which --plain replaces by lines,")
        with contextlib.ExitStack() as stack:
            if log is not None:
                source: Receiver | Player = Player(stack.enter_context(open_log(log)), speed or 1.0)
            else:
                source = Receiver(stack.enter_context(opened_bus(further)), further, record)
            feed = Feed(source, editions, given, bit_rate)
            stack.callback(feed.close)
            if is_plain:
                _print_lines(feed, chosen)
            else:
                from .monitor_app import MonitorApp

                MonitorApp(feed, specifications, " ".join(filters)).run()
    except FileExistsError as error:
        stop(f"{visible(str(error.filename))} exists already; choose another name or remove it")
    except (LogError, MissingPackageError, OSError) as error:
        if isinstance(error, BrokenPipeError):  # of the standard output
            raise
        stop(str(error))
    if feed.error:
        stop(feed.error)


def _check(log: str | None, bus: BusArguments, speed: float | None, record: Path | None) -> None:
    if (log is None) != bool(bus):
        raise click.UsageError(f"give either LOG or a bus, such as {EXAMPLE}")
    if log is None and speed is not None:
        raise click.UsageError("--speed is for LOG, not for a bus")
    if log is not None and record is not None:
        raise click.UsageError("--record is for a bus, not for LOG")


def is_terminal() -> bool:
    """Whether there is a terminal for keys and a view."""
    return all(stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr))


def _bit_rate(editions: Sequence[Edition]) -> int | None:
    """The default of the editions in bit/s, if they have the same."""
    rates = {mode.default_kbps for edition in editions for mode in edition.bus.modes if mode.default_kbps}
    return 1000 * rates.pop() if len(rates) == 1 else None


def _print_lines(feed: Feed, chosen: Filter) -> None:
    """Prints lines every second until the end, or an interrupt."""
    table = PlainTable()

    def show() -> None:
        entries, now = feed.table.entries(), feed.source.now()
        print_text(table(chosen.lines(entries), now, has_buses=len({entry.bus for entry in entries}) > 1))
        print_text(f"# {', '.join(feed.status_parts())}\n")

    is_interrupted = False
    try:
        while not feed.ended.wait(SECONDS):
            show()
    except KeyboardInterrupt:
        is_interrupted = True
    show()
    if is_interrupted:
        sys.exit(INTERRUPTED)
