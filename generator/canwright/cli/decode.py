"""`decode`."""

from __future__ import annotations

import contextlib
import itertools
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import click

from ..model.edition import Edition
from ..model.message import Direction
from ..recordings.directions import WINDOW, Directions
from ..recordings.exports import CsvLines, json_line
from ..recordings.nodes import IDENTIFIED_FROM, family_of, nodes_of
from ..recordings.readers import Log, LogError, open_log
from ..recordings.recorded import Part
from ..recordings.rows import Row, RowReader
from ..recordings.summary import Summary
from .common import FINDINGS, FilePath, read, spec_option, stop
from .decode_view import Table, summary_text
from .settings import node_settings
from .terminal import print_data, print_text, progress

BLOCK = 500
"""The number of rows that are printed at once."""


@click.command()
@click.argument("log", type=click.Path(exists=True, dir_okay=False, allow_dash=True))
@spec_option
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="[[BUS:]NODE:]NAME=VALUE",
    help="A parameter, or the edition, of all nodes or of one: --set size=12 --set 3:edition=v2.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "csv", "jsonl"]),
    default="text",
    show_default=True,
    help="The format of rows.",
)
@click.option("--out", type=FilePath(dir_okay=False), help="A file for the rows.  [default: standard output]")
@click.option(
    "--window",
    type=click.FloatRange(min=0, min_open=True),
    metavar="MS",
    help="The time within which a request is answered.  [default: 2, or twice that of the spec]",
)
@click.option(
    "--recorder",
    type=click.Choice(["host", "node"]),
    default="host",
    show_default=True,
    help="Who recorded the log, and so sent the frames that it marks as sent (Tx).",
)
def decode(
    log: str,
    specs: Sequence[Path],
    settings: Sequence[str],
    form: str,
    out: Path | None,
    window: float | None,
    recorder: str,
) -> None:
    """Decode a log: every frame with its direction and its values.

    Exit status: 0 if all frames of the nodes are decoded, 1 if some lines or frames are not, 2 if it could not run.
    """
    editions = [one.edition for one in read(specs)]
    set_ = node_settings(editions, settings)
    direction = Direction.REQUEST if recorder == "host" else Direction.REPLY
    summary = Summary()
    try:
        with open_log(log) as recording:
            frames = iter(recording)
            start = list(itertools.islice(frames, IDENTIFIED_FROM))
            family = family_of(start, editions)
            nodes = nodes_of(start, family, set_)
            directions = Directions(nodes.editions, nodes.default, window=_window(window, family), recorder=direction)
            rows = RowReader(nodes.assignment).rows(directions.judge(itertools.chain(start, frames)))
            _print(rows, form, out, summary)
    except (LogError, OSError) as error:
        stop(str(error))
    summary.finish()
    print_text(summary_text(summary, nodes, recording.counts), error=out is None and form != "text")
    if not _is_complete(summary, recording):
        sys.exit(FINDINGS)


def _window(given: float | None, editions: Iterable[Edition]) -> int:
    """The time in ns within which a request is answered."""
    if given is not None:
        return int(given * 1_000_000)
    within = [edition.bus.reply_within_ms or 0 for edition in editions]
    return max(WINDOW, int(2 * max(within) * 1_000_000))


def _print(rows: Iterator[Row], form: str, out: Path | None, summary: Summary) -> None:
    """Writes rows, and counts them."""
    with contextlib.ExitStack() as stack:
        advance = stack.enter_context(progress("frames", shown=out is not None or not sys.stdout.isatty()))
        write: Callable[[str], object] = print_data if form != "text" else print_text
        if out is not None:
            write = stack.enter_context(out.open("w", encoding="utf-8", newline="\n")).write
        if form == "text":
            first = list(itertools.islice(rows, BLOCK))
            table = Table(first)
            header, line = table.header, table.line
            rows = itertools.chain(first, rows)
        elif form == "csv":
            header, line = CsvLines.header, CsvLines()
        else:
            header, line = "", json_line
        write(header)
        while block := list(itertools.islice(rows, BLOCK)):
            for row in block:
                summary.add(row)
            write("".join(map(line, block)))
            advance(len(block))


def _is_complete(summary: Summary, log: Log) -> bool:
    """Whether all lines and all frames of nodes are decoded."""
    unread = log.counts.skipped[Part.MALFORMED] + log.counts.skipped[Part.TRUNCATED]
    return not unread and not any(node.rejected for node in summary.nodes.values())
