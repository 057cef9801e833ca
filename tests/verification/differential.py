"""Asks all targets random questions and compares their answers with those of the reference decoder and encoder.

The targets are C and C++ (one program each, compiled with zig), Python, JavaScript in Node, and the DBC files read by
cantools. A frame must be accepted or rejected for the same reason, as the same message, with the same raw integers and
values; raw integers and values must be encoded to the same bytes, or rejected for the same reason and the same field; a
frame must answer a request, or not, alike. Frames are near those of each message: its id, length, codes, constants and
limits with one part changed, data of random bits, and frames that are wholly random; parameters and nodes vary. Equal
seeds give equal questions.

Not covered: what a DBC cannot express, which is counted by name below each line; several wrong fields in one message,
of which targets may report different ones. The documents are compared with golden frames only.

A million questions about v2.35 to C and to Python take eight minutes of processor time, the reference included. A question to
cantools takes several milliseconds at first, as it loads each message of each file once.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from canwright.conformance.adapter import Adapter, Cannot
from canwright.project.loader import specification
from canwright.targets.base import EditionInput

from ..conformance.adapters import ADAPTERS
from ..conformance.adapters.reference import ReferenceAdapter
from ..conformance.questions import Answer, Question, Questions, disagreement
from ..spec_texts import ROOT, SPECS, called

TARGETS = ("c", "cxx", "python", "javascript", "dbc")
QUESTIONS = 1_000_000
SHOWN = 20
"""So many disagreements of a target are listed."""

AT_ONCE = 2000

NOT_ASKED: Mapping[str, Mapping[str, str]] = {
    "dbc": {
        "decode expected": "no reader of a DBC expects a message",
        "encode between": "a reader works in doubles, and compares with limits before it rounds",
        "answers": "a DBC does not know which reply belongs to which request",
    }
}
"""The kinds of questions that a target is not asked, with the reason; the other exceptions are those of its adapter."""


@dataclass
class Comparison:
    """What was asked of one target: questions by kind, exceptions by name, and disagreements with the reference."""

    target: str
    asked: Counter[str] = field(default_factory=Counter)
    exceptions: Counter[str] = field(default_factory=Counter)
    disagreements: list[str] = field(default_factory=list)

    def ask(self, adapter: Adapter, question: Question, wanted: Answer) -> None:
        """Asks one question and compares the answer with that of the reference."""
        if question.kind in NOT_ASKED.get(self.target, {}):
            self.exceptions[question.kind] += 1
            return
        try:
            answer = question.ask(adapter)
        except Cannot as exception:
            self.exceptions[exception.name] += 1
            return
        wrong = disagreement(wanted, answer, adapter.tolerance, reports_code=adapter.reports_code)
        self.asked[question.kind] += 1
        if wrong:
            self.disagreements.append(f"{question.task}{question.arguments}: {wrong}")


def compare(item: EditionInput, adapters: Sequence[Adapter], questions: Iterable[Question]) -> list[Comparison]:
    """Asks every target every question."""
    reference = ReferenceAdapter(item.edition)
    comparisons = [Comparison(adapter.name) for adapter in adapters]
    for some in _parts(questions, AT_ONCE):
        wanted = [question.ask(reference) for question in some]
        for comparison, adapter in zip(comparisons, adapters, strict=True):
            for question, answer in zip(some, wanted, strict=True):
                comparison.ask(adapter, question, answer)
    return comparisons


def _parts(questions: Iterable[Question], size: int) -> Iterator[list[Question]]:
    remaining = iter(questions)
    while some := list(itertools.islice(remaining, size)):
        yield some


def _report(name: str, comparisons: Sequence[Comparison]) -> Iterator[str]:
    for comparison in comparisons:
        kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(comparison.asked.items()))
        yield f"{name:<24}{comparison.target:<8}{comparison.asked.total():>9} answers, {len(comparison.disagreements)} differ: {kinds}"
        for exception, count in sorted(comparison.exceptions.items()):
            reason = (
                NOT_ASKED.get(comparison.target, {}).get(exception) or ADAPTERS[comparison.target].cannot[exception]
            )
            yield f"    {count:>9} not asked, {exception}: {reason}"
        yield from (f"    {line}" for line in comparison.disagreements[:SHOWN])


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 1 if any answer differs from that of the reference."""
    parser = argparse.ArgumentParser(
        "python -m tests.verification.differential",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--questions", type=int, default=QUESTIONS, help="so many for each edition (default %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--edition", action="append", help="as v2.35 or lamp/v1 (default: all editions of spec/)")
    parser.add_argument("--targets", default=",".join(TARGETS), help="(default %(default)s)")
    given = parser.parse_args(arguments)
    wanted = given.edition or [called(file) for file in SPECS if (ROOT / "spec") in file.parents]
    chosen = [file for file in SPECS if called(file) in wanted or file.stem in wanted]
    if not chosen:
        parser.error(f"no edition has this name; there are {', '.join(map(called, SPECS))}")
    failed = False
    for file in chosen:
        item = specification(file)
        with tempfile.TemporaryDirectory() as folder:
            adapters = [ADAPTERS[name].create(item, Path(folder)) for name in given.targets.split(",")]
            questions = Questions(item.edition, given.seed).forever()
            comparisons = compare(item, adapters, itertools.islice(questions, given.questions))
        print("\n".join(_report(called(file), comparisons)), flush=True)
        failed = failed or any(comparison.disagreements for comparison in comparisons)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
