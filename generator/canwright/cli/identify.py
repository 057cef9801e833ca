"""`identify`."""

from __future__ import annotations

import itertools
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import click

from ..model.edition import Edition
from ..model.formatting import bus_id, counted, sent
from ..recordings.bus_behaviour import LOOKED_AHEAD
from ..recordings.exports import bus_name
from ..recordings.grouping import groups
from ..recordings.log_frame import Counts
from ..recordings.neighbours import neighbours
from ..recordings.nodes import Identifiers, nodes_of
from ..recordings.readers import LogError
from ..recordings.results import EditionScore, Evidence, Identification, NodeResult
from ..recordings.two_recorders import repeated_after, two_recorders
from ..semantics.configured import configured
from . import INTERRUPTED
from .bus import BusArguments, bus_options
from .common import FINDINGS, read, spec_option, stop
from .decode_view import at_frame, node_names
from .log_source import ended_by_interrupt, log_directions, log_or_bus, unset_parameters
from .node_settings import differences_option, direction_of, recorder_option, split_option, window_option
from .settings import assignment
from .terminal import print_json, print_text

SHOWN = 4
"""How many reasons against an edition, ids or frames are printed."""


@click.command()
@click.argument("log", type=click.Path(exists=True, dir_okay=False, allow_dash=True), required=False)
@spec_option
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="A parameter in ids or constants, of all nodes.",
)
@window_option
@differences_option
@split_option
@recorder_option
@bus_options
def identify(
    log: str | None,
    specs: Sequence[Path],
    form: str,
    settings: Sequence[str],
    window: int | None,
    has_differences: bool,
    is_split: bool,
    recorder: str,
    bus_arguments: BusArguments,
) -> None:
    """Show which editions a recorded exchange fits, and why.

    Each node of each bus is identified separately. LOG is a log of candump, ASC, BLF, TRC, MF4, CSV, pcap or another form, or
    - for the standard input. Without LOG, a bus of python-can is read until Ctrl-C. No frame contains its edition: the frames
    are decoded with each edition, and the result follows from the ids, codes, replies, reserved bits and values that it
    explains. It may be undecided. If a node gets another edition, the result names the frame and the time of the change. Of a
    long log, the first frames of each kind and samples of all its parts are compared; the result states how many. Without
    --spec and without a folder spec/, the editions in the package are compared.

    Exit status: 0 if the edition of every node is identified and does not change, 1 if not, or if each frame is recorded
    twice, as by two recorders; 2 if it could not run, 130 if Ctrl-C ended the log, after its result. Nodes with few frames,
    far apart, are listed last and do not affect it: their ids may be damaged. `decode` also accepts editions that fit
    equally well, if the frames of the log mean the same in all of them.
    """
    specifications = read(specs, packaged=True)
    known = assignment(specifications, settings)
    editions = [configured(item.edition, known) for item in specifications]
    identifiers = Identifiers(editions, direction_of(recorder), window)
    try:
        source = log_or_bus(log, bus_arguments, has_differences=has_differences, is_split=is_split)
        with source as read_log, ended_by_interrupt(read_log):
            frames = iter(read_log)
            start = list(itertools.islice(frames, LOOKED_AHEAD))
            for frame in itertools.chain(start, frames):
                identifiers.add(frame)
    except (LogError, OSError) as error:
        stop(str(error))
    identification = identifiers.best.result()
    own = identifiers.best.editions
    family = own[0].family
    if form == "json":
        print_json(_facts(family, identification, read_log.counts))
    else:
        print_identification(own, identification, read_log.counts)
    doubtful: list[str] = []
    if any(repeated_after(f for f in start if f.bus == bus) for bus in {f.bus for f in start}):
        directions = log_directions(read_log, nodes_of(identifiers.best, ()), direction_of(recorder), window)
        doubtful = [*two_recorders(directions.learn(start))]
    unset = unset_parameters(editions) if identification.foreign or not identification.is_complete else []
    for remark in [*unset, *doubtful]:
        print_text(f"{remark}\n", error=form == "json")
    if read_log.is_ended:
        sys.exit(INTERRUPTED)
    if doubtful or not identification.is_complete:
        sys.exit(FINDINGS)


def print_identification(editions: Sequence[Edition], identification: Identification, counts: Counts) -> None:
    """Prints the editions that the nodes of a bus fit, and why others do not."""
    family = editions[0].family
    if counts.skipped:
        parts = ", ".join(f"{part.value} ({count})" for part, count in counts.skipped.items())
        print_text(f"skipped: {parts}\n\n")
    if identification.foreign:
        ids = _some([bus_id(*id_) for id_ in identification.foreign_ids])
        print_text(
            f"{identification.foreign} of {identification.frames} frames are ignored, since their ids do not belong to {family}: {ids}\n"
        )
        print_text("".join(f"  {line}\n" for line in neighbours(editions, identification.foreign_ids)) + "\n")
    has_buses = len({result.bus for result in identification.nodes}) > 1
    for group in sorted(groups(identification.nodes), key=lambda group: _rank(group.result)):
        result = group.result
        where = ", ".join([family, *([bus_name(result.bus)] if has_buses else []), node_names(group.nodes)])
        since = f" from {at_frame(result.start)}" if result.start else ""
        compared = f" ({result.frames} of them compared)" if result.frames < result.total else ""
        print_text(f"{where}{since}, {counted(result.total, 'frame')}{compared}: {_outcome(result)}\n")
        if result.unexplained:
            ignored = _some([f"{sent(frame)} ({n})" for frame, n in result.unexplained])
            print_text(f"  {counted(result.frames - result.judged, 'frame')} of no edition, ignored: {ignored}\n")
        equal: dict[tuple[str, ...], list[str]] = {}
        for score in result.scores if result.judged else ():
            lines = (_summary(score, result.judged), *map(_evidence, score.against[:SHOWN]))
            equal.setdefault(lines, []).append(score.edition.name)
        for (summary, *against), names in equal.items():
            print_text(f"  {', '.join(names):<16} explain{'s' if len(names) == 1 else ''} {summary}\n")
            for line in against:
                print_text(f"    {line}\n")
        if result.distinguishing:
            print_text(f"  to decide, record the reply to {_some(list(result.distinguishing))}\n")
        print_text("\n")
    if not identification.nodes:
        print_text(f"undecided: no frame has an id of {family}\n")


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN]) + (", ..." if len(names) > SHOWN else "")


def _rank(result: NodeResult) -> int:
    """The order of results: identified, undecided, fitting no edition, of no edition, stray."""
    if result.is_stray:
        return 4
    return 0 if len(result.editions) == 1 else 1 if result.editions else 2 if result.is_judged else 3


def _outcome(result: NodeResult) -> str:
    outcome = _fit(result)
    return f"few frames, far apart, as frames with a damaged id are; {outcome}" if result.is_stray else outcome


def _fit(result: NodeResult) -> str:
    if len(result.editions) == 1:
        return f"fits {result.editions[0].name}"
    if result.editions:
        return f"undecided, {_listed(result.editions)} fit equally well"
    if not result.is_judged:
        return f"no edition fits, since only {result.judged} of {result.frames} are of one"
    best = result.scores[0]
    if not best.is_explained(result.judged):
        return "no edition fits"
    if not best.is_shown(result.judged):
        return f"no edition fits, since {counted(best.tried, 'request')} of other editions have no reply"
    if not best.requests:
        return "no edition fits, since no node fits one that has these frames"
    unanswered = sum(best.unanswered.values())
    return f"no edition fits, since {unanswered} of {counted(best.requests, 'request')} have no reply"


def _listed(editions: Sequence[Edition]) -> str:
    names = [edition.name for edition in editions]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _summary(score: EditionScore, count: int) -> str:
    explained = (
        "every frame" if score.explained == count and not score.against else f"{score.explained} of {count} frames"
    )
    if score.tried:
        explained += f"; {counted(score.tried, 'request')} of other editions without a reply"
    if not score.unanswered:
        return explained
    commands = _some([f"{name} ({n})" for name, n in Counter(score.unanswered).most_common()])
    unanswered = sum(score.unanswered.values())
    return f"{explained}; {unanswered} of {counted(score.requests, 'request')} without a reply: {commands}"


def _evidence(evidence: Evidence) -> str:
    rare = "" if evidence.counts else ", too few to count"
    among = f"{evidence.count} of {evidence.among}{rare}"
    return f"{evidence.text} ({among}, as in {sent(evidence.example)})"


def _facts(family: str, identification: Identification, counts: Counts) -> dict[str, object]:
    def score(each: EditionScore) -> dict[str, object]:
        against = [
            {
                "text": e.text,
                "points": e.points if e.counts else 0,
                "frames": e.count,
                "among": e.among,
                "example": sent(e.example),
            }
            for e in each.against
        ]
        return {
            "edition": each.edition.name,
            "explained": each.explained,
            "tried": each.tried,
            "score": each.score,
            "requests": each.requests,
            "unanswered": dict(each.unanswered),
            "against": against,
        }

    nodes = [
        {
            "bus": result.bus,
            "node": result.node,
            "frames": result.total,
            "compared": result.frames,
            "start": result.start and {"number": result.start.number, "time_ns": result.start.time},
            "stray": result.is_stray,
            "fits": [edition.name for edition in result.editions],
            "of_no_edition": result.frames - result.judged,
            "distinguishing": list(result.distinguishing),
            "editions": [score(each) for each in result.scores],
        }
        for result in identification.nodes
    ]
    skipped = {part.value: count for part, count in counts.skipped.items()}
    return {
        "family": family,
        "frames": identification.frames,
        "foreign": identification.foreign,
        "skipped": skipped,
        "nodes": nodes,
    }
