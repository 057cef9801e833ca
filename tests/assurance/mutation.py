"""Breaks the generated code on purpose, one small change at a time, and lists the changes that no test notices.

`c`: the headers of an edition and the runtime headers that it uses. Mutated are operators, numbers, masks and shifts,
return statuses and other constants, statements, case labels, and the values of macros and enumerators; not types,
casts, members of structs and texts. Asked are the golden frames, the facts of the header and rounds of random
questions, whose answers agree with the model; a mutant is killed when one answer changes, when the program stops, takes
too long or does not compile.

`python`: the module of an edition and its runtime (`_codec.py`, `_dispatch.py`, `nodes.py`). Mutated are comparisons,
arithmetic and logical operators, numbers, conditions, statements and returned values; not texts, annotations and
docstrings. Asked are the golden frames, random questions, and the checks of `tests.assurance.python_facts`.

Mutants of the runtime are shown to all editions, those for floating point also to `tests.assurance.floating`, and
survive only if none of them kills it. Functions that are not reached are named. A complete run takes hours.
Every survivor must be listed as equivalent, with a reason, in `equivalent_c.yaml` or `equivalent_python.yaml`. The exit
status is 1 for a survivor that is not listed and for a killed mutant that is.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..spec_texts import SPECS, called
from . import c_survivors, python_survivors
from .equivalents import Equivalent, judge, read

LANGUAGES: dict[str, Callable[[Path, Path], Any]] = {"c": c_survivors.Subject, "python": python_survivors.Subject}
RUNTIMES: dict[str, tuple[Callable[[Path], Any], ...]] = {"c": (c_survivors.FloatingSubject,), "python": ()}
"""What the mutants of the runtime are shown to, besides the editions."""


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 1 for survivors that are not listed, and for listed mutants that are killed."""
    parser = argparse.ArgumentParser(
        "python -m tests.assurance.mutation",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("language", choices=LANGUAGES)
    parser.add_argument(
        "--edition", action="append", help="as v2.35 or arm/v1 (default: those of spec/ and tests/specs)"
    )
    parser.add_argument("--sample", type=int, help="so many mutants of each edition, and of the runtime (default: all)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--equivalents", type=Path, help="another list")
    given = parser.parse_args(arguments)
    wanted = given.edition or [*map(called, SPECS)]
    chosen = [file for file in SPECS if called(file) in wanted or file.stem in wanted]
    if not chosen:
        parser.error(f"no edition has this name; there are {', '.join(map(called, SPECS))}")
    list_file = given.equivalents or Path(__file__).with_name(f"equivalent_{given.language}.yaml")
    run = Run(given.language, read(list_file), given.sample, given.seed)
    for spec in chosen:
        run.mutate(spec)
    run.judge_runtime()
    return int(run.failed)


class Run:
    """The mutants of several editions. Those of the runtime survive only if no edition kills them."""

    def __init__(self, language: str, equivalents: Sequence[Equivalent], sample: int | None, seed: int) -> None:
        self._language, self._equivalents = language, equivalents
        self._sample, self._seed = sample, seed
        self._runtime: dict[tuple[str, str, str], Any] | None = None
        self._left: set[tuple[str, str, str]] = set()
        self._unreached: set[tuple[str, str, str]] = set()
        self.failed = False

    def mutate(self, spec: Path) -> None:
        """Runs the mutants of one edition, and those of the runtime that are left."""
        with tempfile.TemporaryDirectory() as folder:
            subject = LANGUAGES[self._language](spec, Path(folder))
            every, reached = subject.all_mutants(), subject.mutants()
            if self._runtime is None:
                runtime = self._sampled([mutant for mutant in every if mutant.is_runtime])
                self._runtime = {mutant.key: mutant for mutant in runtime}
                self._left, self._unreached = set(self._runtime), set(self._runtime)
            own = self._sampled([mutant for mutant in reached if not mutant.is_runtime])
            alive = list(subject.survivors(own))
            self._show_runtime(subject)
        known = set(reached)
        self._report(called(spec), own, alive, [m for m in every if not m.is_runtime and m not in known])

    def judge_runtime(self) -> None:
        """Reports what is left of the mutants of the runtime."""
        for create in RUNTIMES[self._language]:
            with tempfile.TemporaryDirectory() as folder:
                self._show_runtime(create(Path(folder)))
        mutants = self._runtime or {}
        unreached = [mutants[key] for key in self._unreached]
        reached = [mutant for key, mutant in mutants.items() if key not in self._unreached]
        self._report("runtime", reached, [mutants[key] for key in self._left - self._unreached], unreached)

    def _show_runtime(self, subject: Any) -> None:
        """Runs the mutants of the runtime that are left."""
        shown = [mutant for mutant in subject.mutants() if mutant.is_runtime and mutant.key in self._left]
        alive = {mutant.key for mutant in subject.survivors(shown)}
        keys = {mutant.key for mutant in shown}
        self._unreached -= keys
        self._left -= keys - alive

    def _sampled(self, mutants: list[Any]) -> list[Any]:
        if self._sample is None or len(mutants) <= self._sample:
            return mutants
        return random.Random(self._seed).sample(mutants, self._sample)

    def _report(self, name: str, mutants: Sequence[Any], survivors: Sequence[Any], unreached: Sequence[Any]) -> None:
        verdict = judge(mutants, survivors, self._equivalents)
        print(f"{name} {self._language}: {len(mutants)} mutants, {len(survivors)} survive,", end=" ")
        print(f"{verdict.listed} of them listed as equivalent")
        if unreached:
            names = ", ".join(sorted({mutant.function for mutant in unreached}))
            print(f"  not reached, and not in these figures: {len(unreached)} mutants of {names}")
        for mutant in verdict.unlisted:
            function, original, mutated = mutant.key
            print(f"  survives: {function or '(outside of functions)'}\n    - {original}\n    + {mutated}")
        for entry, mutant in verdict.killed:
            print(f"  listed as equivalent, but killed: {mutant.key}\n    {entry.reason}")
        sys.stdout.flush()
        self.failed = self.failed or bool(verdict.unlisted or verdict.killed)


if __name__ == "__main__":
    sys.exit(main())
