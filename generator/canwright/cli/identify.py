"""`identify`."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import click

from ..model.edition import Edition
from ..model.formatting import counted, sent
from ..recordings.identify import Candidate, Evidence, Finding, identify as look
from ..recordings.readers import LogError, frames
from .common import FINDINGS, FilePath, read, spec_option, stop

SHOWN = 4
"""How many reasons against an edition, ids or frames are printed."""


@click.command()
@click.argument("log", type=FilePath(exists=True, dir_okay=False))
@spec_option
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
def identify(log: Path, specs: Sequence[Path], form: str) -> None:
    """Show which editions a recorded exchange fits, and why.

    Each node is judged separately. LOG is a log of candump or any format that python-can reads. No frame names its
    edition; the verdict follows from ids, codes, reserved bits and plausible ranges, and may be undecided.

    Exit status: 0 if the edition of every node is identified, 1 if not, 2 if it could not run.
    """
    editions = [one.edition for one in read(specs)]
    families = dict.fromkeys(edition.family for edition in editions)
    try:
        recorded = list(frames(log))
    except (LogError, OSError) as error:
        stop(str(error))
    if not recorded:
        stop(f"{log} has no frames")
    results = [(family, *look(recorded, [e for e in editions if e.family == family])) for family in families]
    family, findings, foreign = max(results, key=lambda result: sum(f.frames for f in result[1]))
    if form == "json":
        click.echo(_json(family, findings, foreign))
    else:
        _text(family, findings, foreign, len(recorded))
    if not findings or any(len(finding.editions) != 1 for finding in findings):
        sys.exit(FINDINGS)


def _text(family: str, findings: Sequence[Finding], foreign: Counter[int], count: int) -> None:
    if foreign:
        ids = _some([f"0x{id_:X}" for id_, _ in foreign.most_common()])
        click.echo(f"{foreign.total()} of {count} frames have no id of {family} and are left out: {ids}\n")
    for finding in findings:
        node = "no node" if finding.node is None else f"node {finding.node}"
        click.echo(f"{family}, {node}, {counted(finding.frames, 'frame')}: {_verdict(finding)}")
        if finding.strange:
            ignored = _some([f"{sent(frame)} ({n})" for frame, n in finding.strange])
            click.echo(f"  no edition has {counted(finding.frames - finding.judged, 'frame')}, left out: {ignored}")
        for candidate in finding.candidates if finding.judged else ():
            click.echo(f"  {candidate.edition.name:<16} {_summary(candidate, finding.judged)}")
            for evidence in candidate.against[:SHOWN]:
                click.echo(f"    {_evidence(evidence)}")
        if finding.tell:
            click.echo(f"  replies to {_some(list(finding.tell))} would tell more")
        click.echo()
    if not findings:
        click.echo(f"cannot tell: no frame has an id of {family}")


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN]) + (", ..." if len(names) > SHOWN else "")


def _verdict(finding: Finding) -> str:
    if len(finding.editions) == 1:
        return f"fits {finding.editions[0].name}"
    if not finding.editions:
        return "cannot tell, no edition fits"
    return f"cannot tell, {_listed(finding.editions)} fit alike"


def _listed(editions: Sequence[Edition]) -> str:
    names = [edition.name for edition in editions]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _summary(candidate: Candidate, count: int) -> str:
    if not candidate.against:
        return "explains every frame"
    return f"explains {candidate.explained} of {count} frames; {counted(candidate.score, 'point')} against it"


def _evidence(evidence: Evidence) -> str:
    rare = "" if evidence.counts else ", too few to count"
    among = f"{evidence.count} of {evidence.among}{rare}"
    return f"{evidence.text} ({among}, as in {sent(evidence.example)})"


def _json(family: str, findings: Sequence[Finding], foreign: Counter[int]) -> str:
    def candidate(one: Candidate) -> dict[str, object]:
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
            "node": finding.node,
            "frames": finding.frames,
            "fits": [edition.name for edition in finding.editions],
            "of_no_edition": finding.frames - finding.judged,
            "would_tell": list(finding.tell),
            "editions": [candidate(one) for one in finding.candidates],
        }
        for finding in findings
    ]
    return json.dumps({"family": family, "foreign": foreign.total(), "nodes": nodes}, indent=2, ensure_ascii=False)
