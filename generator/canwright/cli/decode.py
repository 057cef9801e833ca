"""`decode`."""

from __future__ import annotations

import contextlib
import itertools
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click

from ..diagnostics.diagnostic import nearest
from ..diagnostics.unicode_safety import visible
from ..model.edition import Edition
from ..model.formatting import counted
from ..model.message import Direction
from ..recordings import candump, plot as pictures, split as split_logs
from ..recordings.doubts import copies, doubts
from ..recordings.exports import CsvLines, JsonLines, bus_name
from ..recordings.kept_frames import MAX_STREAMED
from ..recordings.log_frame import Counts, LogFrame, SkippedPart
from ..recordings.mcap_file import McapFile
from ..recordings.new_files import is_overwritten, new_file, new_folder, same_path
from ..recordings.nodes import Identifiers, Nodes, NodeSetting, follow
from ..recordings.packages import MissingPackageError
from ..recordings.parquet import ParquetTables
from ..recordings.readers import STANDARD_INPUT, Log, LogError, pasted_frame
from ..recordings.rows import Row, RowReader
from ..recordings.summary import Summary
from ..semantics.frame import CanFrame
from . import INTERRUPTED
from .bus import BusArguments, bus_options
from .common import FINDINGS, FilePath, OutputPath, read, spec_option, stop
from .decode_view import RowTable, summary_text
from .explain_view import explanation, golden_entries
from .log_source import BLOCK, ended_by_interrupt, known_nodes, log_directions, log_or_bus, unset_parameters
from .node_settings import (
    bus_of,
    differences_option,
    direction_of,
    recorder_option,
    settings_option,
    split_option,
    window_option,
)
from .terminal import print_data, print_text, progress

BINARY = {"parquet": "a folder: --out tables", "mcap": "a file: --out log.mcap"}
"""The formats of rows that are not text, and what each needs."""


class LogOrFrame(click.Path):
    """The name of a log, or a frame as candump or another program prints it."""

    name = "log or frame"

    def __init__(self) -> None:
        super().__init__(exists=True, dir_okay=False, allow_dash=True)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if isinstance(value, str) and not _exists(value):
            frame = pasted_frame(value)
            if frame is not None:
                return frame
            if "#" in value:
                counts = Counts()
                list(candump.read([f"{value}\n"], counts))
                id_, separator, data = value.partition("#")
                padded = f"{id_.zfill(3 if len(id_) < 3 else 8)}{separator}{data}"
                if pasted_frame(padded) is not None:
                    self.fail(f"an id has 3 digits, or 8 if it has 29 bits; write {visible(padded)}", param, ctx)
                part = next(iter(counts.skipped)).value
                self.fail(f"`{visible(value)}` is neither a file nor a frame such as 141#A100FF ({part})", param, ctx)
        return super().convert(value, param, ctx)


def _exists(name: str) -> bool:
    try:
        return Path(name).exists()
    except (OSError, ValueError):  # as of a name that is too long
        return False


class Outputs(NamedTuple):
    """What is written of a log."""

    form: str
    out: Path | None
    split: Path | None
    plot: Path | None
    fields: Sequence[str]

    @property
    def prints_rows(self) -> bool:
        """Whether the rows are on the standard output."""
        return self.out is None and self.form != "none"

    @property
    def paths(self) -> Sequence[Path]:
        """The files and the folder that are written."""
        return [path for path in (self.out, self.split, self.plot) if path is not None]


@click.command()
@click.argument("log", type=LogOrFrame(), required=False)
@spec_option
@settings_option
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "csv", "jsonl", "parquet", "mcap"]),
    help="The format of rows: a table, CSV with one line for each value, JSON Lines, a folder of Parquet files, one "
    "for each layout, or a file of MCAP for viewers, with a topic for each node and layout.  [default: text]",
)
@click.option("--out", type=FilePath(), help="File or folder for the rows.  [default: standard output]")
@click.option(
    "--split",
    type=OutputPath(split_logs.FORMATS),
    help="A log to write (.asc, .blf, or .log for candump) with requests on channel 1, replies on 2, other frames on "
    "3; on 4 to 6 for the next bus.",
)
@click.option(
    "--plot", type=OutputPath(pictures.FORMATS), help="A picture to write (.pdf, .png, .svg) of each --field."
)
@click.option("--field", "fields", multiple=True, help="A field for --plot; may be given several times.")
@click.option("--golden", is_flag=True, help="Print a single frame as golden frames, for review.")
@window_option
@click.option(
    "--follow", "followed", is_flag=True, help="Wait for more lines at the end of the file, until Ctrl-C ends the log."
)
@differences_option
@split_option
@recorder_option
@bus_options
def decode(
    log: str | CanFrame | None,
    specs: Sequence[Path],
    settings: Sequence[str],
    form: str | None,
    out: Path | None,
    split: Path | None,
    plot: Path | None,
    fields: Sequence[str],
    golden: bool,
    window: int | None,
    followed: bool,
    has_differences: bool,
    is_split: bool,
    recorder: str,
    bus_arguments: BusArguments,
) -> None:
    """Decode a log or a bus, or explain one frame.

    LOG is a log of candump, ASC, BLF, TRC, MF4, CSV, pcap or another form, `-` for the standard input, or a frame such as
    141#A100FF. Without LOG, a bus of python-can is read until Ctrl-C: -i socketcan -c can0. Each row has the direction of the frame and the rule that decided on it, the values of its fields, and
    the request that it answers. The edition of a node is given by --set, or identified: from the whole log if it is a
    file, and while it is read if it is a stream. If several editions fit, a row lists all, and is decoded with the first.

    At the end, a summary lists missing, late, unexpected and rejected frames for each node (with the longest gap of
    frames that have a period or a time-out, and the gaps of counters), implausible values,
    effects of requests that are warnings or do not occur in the state of the node, and everything that was skipped. With --split or --plot, rows are printed only if --format is given.

    Exit status: 0 if every line and every frame of the nodes is decoded, no frame has another meaning in another edition
    that fits, no edition changes, every value is plausible, and the directions are certain; 1 if not; 2 if it could not run;
    130 if Ctrl-C ended the log, after its rows and summary.
    """
    editions, set_ = bus_of([item.edition for item in read(specs, packaged=True)], settings)
    if isinstance(log, CanFrame):
        if form or out or split or plot:
            raise click.UsageError("--format, --out, --split and --plot are for logs, not for a single frame")
        if followed:
            raise click.UsageError("--follow is for a file, not for a single frame")
        _explain(log, editions, set_, golden=golden)
        return
    if golden:
        raise click.UsageError("--golden is for a single frame, such as 141#A100FF")
    if followed and log == STANDARD_INPUT:
        raise click.UsageError("--follow needs a file; the standard input is followed without it")
    outputs = Outputs(form or ("none" if split or plot else "text"), out, split, plot, fields)
    _check(outputs)
    if log is not None:
        _check_paths(log, outputs)
    try:
        source = log_or_bus(
            log, bus_arguments, is_followed=followed, has_differences=has_differences, is_split=is_split
        )
        with source as recording:
            _decode(recording, editions, set_, outputs, window, direction_of(recorder))
    except (LogError, MissingPackageError, OSError) as error:
        if isinstance(error, BrokenPipeError):  # of the standard output
            raise
        stop(str(error))


def _explain(frame: CanFrame, editions: Sequence[Edition], settings: Sequence[NodeSetting], *, golden: bool) -> None:
    only = next((setting.value for setting in settings if isinstance(setting.value, Edition)), None)
    chosen = [only] if isinstance(only, Edition) else editions
    assignment = Nodes(editions, settings).assignment("", None)
    if golden:
        text = golden_entries(chosen, frame, assignment)
        print_data(text)
        is_explained = bool(text)
        if not is_explained:
            print_text("canwright: no message fits, or its fields depend on a parameter; see --set\n", error=True)
    else:
        text, is_explained = explanation(chosen, frame, assignment)
        print_text(text)
    if not is_explained:
        sys.exit(FINDINGS)


def _check(outputs: Outputs) -> None:
    if bool(outputs.plot) != bool(outputs.fields):
        raise click.UsageError("--plot and --field need each other: --plot current.png --field current")
    if outputs.form in BINARY and outputs.out is None:
        raise click.UsageError(f"--format {outputs.form} needs {BINARY[outputs.form]}")
    if outputs.form == "none" and outputs.out:
        raise click.UsageError("--out needs a --format")


def _check_paths(log: str, outputs: Outputs) -> None:
    """Stops if an output replaces the log or another output."""
    try:
        read = os.fstat(sys.stdin.fileno()) if log == STANDARD_INPUT else Path(log).stat()
    except OSError:  # no file, as the standard input may be none
        read = None
    for path in outputs.paths:
        if read is not None and stat.S_ISREG(read.st_mode) and is_overwritten(read, path):
            stop(f"{visible(str(path))} is the log that is read; choose another file")
    twice = same_path(outputs.paths)
    if twice:
        stop(f"{visible(str(twice))} is the file of two outputs; choose another file for one")


def _decode(
    log: Log,
    editions: Sequence[Edition],
    settings: Sequence[NodeSetting],
    outputs: Outputs,
    window: int | None,
    recorder: Direction | None,
) -> None:
    nodes = known_nodes(log, editions, settings, recorder, window)
    with ended_by_interrupt(log):
        frames: Iterable[LogFrame] = log
        if nodes is None:
            nodes, frames = follow(log, Identifiers(editions, recorder, window, MAX_STREAMED), settings)
        is_clean = _print(log, frames, nodes, editions, outputs, window, recorder)
    if log.is_ended:
        sys.exit(INTERRUPTED)
    if not is_clean:
        sys.exit(FINDINGS)


def _print(
    log: Log,
    frames: Iterable[LogFrame],
    nodes: Nodes,
    editions: Sequence[Edition],
    outputs: Outputs,
    window: int | None,
    recorder: Direction | None,
) -> bool:
    """Prints rows, summary and remarks of a log. Returns whether it has no findings."""
    _check_fields(outputs.fields, nodes.family)
    directions = log_directions(log, nodes, recorder, window)
    reader, summary = RowReader(nodes.assignment, nodes.label), Summary()
    rows = reader.rows(directions.classify(frames))
    remarks = _write(log, rows, lambda pause: reader.rows(directions.paused(int(pause * 1e9))), outputs, summary)
    summary.finish()
    print_text(summary_text(summary, nodes, log.counts), error=outputs.prints_rows and outputs.form != "text")
    behaviours = directions.behaviours or {}
    doubtful = [*doubts(summary, behaviours)]
    if summary.foreign and not summary.nodes and nodes.is_complete({}):
        doubtful.append(f"undecided: no frame has an id of {editions[0].family}")
    for remark in [*remarks, *unset_parameters(editions), *copies(summary, behaviours), *doubtful]:
        print_text(f"{remark}\n", error=outputs.prints_rows and outputs.form != "text")
    return not doubtful and _is_clean(summary, nodes, log.counts)


def _is_clean(summary: Summary, nodes: Nodes, counts: Counts) -> bool:
    """Whether everything was read, no frame has several meanings, and every value is plausible."""
    unread = counts.skipped[SkippedPart.MALFORMED] + counts.skipped[SkippedPart.TRUNCATED] + counts.untimed
    rejecting = [place for place, node in summary.nodes.items() if node.rejected and not nodes.is_stray(*place)]
    commands = {place: node.commands for place, node in summary.nodes.items()}
    return not (unread or rejecting or summary.has_implausible) and nodes.is_complete(commands)


def _check_fields(fields: Sequence[str], editions: Iterable[Edition]) -> None:
    messages = (message for edition in editions for message in edition.all_messages())
    known = dict.fromkeys(field.name for message in messages for field in message.layout.fields)
    for name in fields:
        if name.partition("[")[0] not in known:
            stop(f"there is no field `{visible(name)}`; {nearest(name, known) or 'see `canwright show COMMAND`'}")


def _write(
    log: Log, rows: Iterable[Row], paused: Callable[[float], Iterable[Row]], outputs: Outputs, summary: Summary
) -> list[str]:
    """Writes the rows of a log to all outputs, and counts them; `paused` gives those of a stream after a pause in seconds.

    Returns remarks.
    """
    remarks: list[str] = []
    with contextlib.ExitStack() as stack:
        writers: list[Callable[[Row], object]] = [summary.add]
        split = plot = picture = None
        if outputs.split:
            file = stack.enter_context(new_file(outputs.split))
            split = stack.enter_context(contextlib.closing(split_logs.SplitLog(file, outputs.split.suffix)))
            writers.append(split.write)
        if outputs.plot:
            picture = stack.enter_context(new_file(outputs.plot))
            plot = pictures.Plot(outputs.fields)
            writers.append(plot.write)
        binary = _binary(outputs, stack)
        if binary:
            writers.append(binary.write)
        emit, text_of = _emitter(outputs, stack), _printer(outputs.form)
        advance = stack.enter_context(progress("frames", shown=not (outputs.prints_rows and sys.stdout.isatty())))
        block: list[Row] = []

        def print_block() -> None:
            for write, row in itertools.product(writers, block):
                write(row)
            emit(text_of(block))
            advance(len(block))
            block.clear()

        def print_rows(pause: float) -> None:
            block.extend(paused(pause))
            if block:
                print_block()

        log.on_wait = print_rows
        for row in rows:
            block.append(row)
            if len(block) == BLOCK:
                print_block()
        print_block()
        if plot and picture and outputs.plot:
            remarks += [f"{outputs.plot}: no frame has a field {name}" for name in plot.missing]
            plot.save(picture, outputs.plot.suffix)
    return [*remarks, *_channels(split, outputs), *_times(binary, outputs)]


def _channels(split: split_logs.SplitLog | None, outputs: Outputs) -> Iterator[str]:
    """Remarks on the channels of a split log."""
    if split is None:
        return
    for bus, first in split.buses.items():
        name = f"of {bus_name(bus)} " if bus else ""
        yield f"{outputs.split}: requests {name}on channel {first}, replies on {first + 1}, others on {first + 2}"
    yield f"`canwright decode --from-split {outputs.split}` reads them again"


def _times(binary: McapFile | ParquetTables | None, outputs: Outputs) -> Iterator[str]:
    """A remark on times that differ from those of the log."""
    if isinstance(binary, McapFile) and binary.untimed:
        frames = counted(binary.untimed, "frame")
        yield f"{outputs.out}: {frames} without a time, or with a negative one, at the time of the frame before"


def _binary(outputs: Outputs, stack: contextlib.ExitStack) -> McapFile | ParquetTables | None:
    """What writes rows that are not text."""
    if outputs.form not in BINARY or outputs.out is None:
        return None
    if outputs.form == "parquet":
        folder = stack.enter_context(new_folder(outputs.out))
        return stack.enter_context(contextlib.closing(ParquetTables(folder)))
    file = stack.enter_context(stack.enter_context(new_file(outputs.out)).open("wb"))
    return stack.enter_context(contextlib.closing(McapFile(file)))


def _emitter(outputs: Outputs, stack: contextlib.ExitStack) -> Callable[[str], object]:
    """Where lines are written to."""
    if outputs.out and outputs.form not in BINARY:
        file = stack.enter_context(new_file(outputs.out))
        return stack.enter_context(file.open("w", encoding="utf-8", newline="\n")).write
    return print_text if outputs.form == "text" else print_data


def _printer(form: str) -> Callable[[Sequence[Row]], str]:
    """The function that prints rows, the first of them with a header."""
    if form == "text":
        return RowTable()
    if form == "csv":
        return CsvLines()
    return JsonLines() if form == "jsonl" else lambda _: ""
