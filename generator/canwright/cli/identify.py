"""`identify`."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import click

from ..model.edition import Edition
from ..model.formatting import counted, sent
from ..recordings.identify import EditionScore, Evidence, NodeResult, identify as look
from ..recordings.readers import LogError, open_log
from .common import FINDINGS, read, spec_option, stop
from .terminal import print_json, print_text

SHOWN = 4
"""How many reasons against an edition, ids or frames are printed."""


@click.command()
@click.argument("log", type=click.Path(exists=True, dir_okay=False, allow_dash=True))
@spec_option
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
def identify(log: str, specs: Sequence[Path], form: str) -> None:
    """Show which editions a recorded exchange fits, and why.

    Each node is identified separately. LOG is a log of candump or of any format that python-can reads. No frame
    contains its edition; the result follows from ids, codes, reserved bits and plausible ranges, and may be undecided.

    Exit status: 0 if the edition of every node is identified, 1 if not, 2 if it could not run.
    """
    editions = [one.edition for one in read(specs)]
    families = dict.fromkeys(edition.family for edition in editions)
    try:
        with open_log(log) as read_log:
            recorded = [one.frame for one in read_log]
    except (LogError, OSError) as error:
        stop(str(error))
    by_family = [(family, *look(recorded, [e for e in editions if e.family == family])) for family in families]
    family, results, foreign = max(by_family, key=lambda one: sum(result.frames for result in one[1]))
    if form == "json":
        print_json(_facts(family, results, foreign))
    else:
        _text(family, results, foreign, len(recorded))
    if not results or any(len(result.editions) != 1 for result in results):
        sys.exit(FINDINGS)


def _text(family: str, results: Sequence[NodeResult], foreign: Counter[int], count: int) -> None:
    if foreign:
        ids = _some([f"0x{id_:X}" for id_, _ in foreign.most_common()])
        print_text(
            f"{foreign.total()} of {count} frames are ignored, since their ids do not belong to {family}: {ids}\n\n"
        )
    for result in results:
        node = "no node" if result.node is None else f"node {result.node}"
        print_text(f"{family}, {node}, {counted(result.frames, 'frame')}: {_outcome(result)}\n")
        if result.unexplained:
            ignored = _some([f"{sent(frame)} ({n})" for frame, n in result.unexplained])
            print_text(f"  {counted(result.frames - result.scored, 'frame')} of no edition, ignored: {ignored}\n")
        for score in result.scores if result.scored else ():
            print_text(f"  {score.edition.name:<16} {_summary(score, result.scored)}\n")
            for evidence in score.against[:SHOWN]:
                print_text(f"    {_evidence(evidence)}\n")
        if result.distinguishing:
            print_text(f"  to decide, record the reply to {_some(list(result.distinguishing))}\n")
        print_text("\n")
    if not results:
        print_text(f"undecided: no frame has an id of {family}\n")


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN]) + (", ..." if len(names) > SHOWN else "")


def _outcome(result: NodeResult) -> str:
    if len(result.editions) == 1:
        return f"fits {result.editions[0].name}"
    if not result.editions:
        return "no edition fits"
    return f"undecided, {_listed(result.editions)} fit equally well"


def _listed(editions: Sequence[Edition]) -> str:
    names = [edition.name for edition in editions]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _summary(score: EditionScore, count: int) -> str:
    if not score.against:
        return "explains every frame"
    return f"explains {score.explained} of {count} frames; {counted(score.score, 'point')} against it"


def _evidence(evidence: Evidence) -> str:
    rare = "" if evidence.counts else ", too few to count"
    among = f"{evidence.count} of {evidence.among}{rare}"
    return f"{evidence.text} ({among}, as in {sent(evidence.example)})"


def _facts(family: str, results: Sequence[NodeResult], foreign: Counter[int]) -> dict[str, object]:
    def score(one: EditionScore) -> dict[str, object]:
        against = [
            {
                "text": e.text,
                "points": e.points if e.counts else 0,
                "frames": e.count,
                "among": e.among,
                "example": sent(e.example),
            }
            for e in one.against
        ]
        return {"edition": one.edition.name, "explained": one.explained, "score": one.score, "against": against}

    nodes = [
        {
            "node": result.node,
            "frames": result.frames,
            "fits": [edition.name for edition in result.editions],
            "of_no_edition": result.frames - result.scored,
            "would_tell": list(result.distinguishing),
            "editions": [score(one) for one in result.scores],
        }
        for result in results
    ]
    return {"family": family, "foreign": foreign.total(), "nodes": nodes}
