"""Breaks the generated code on purpose, one small change at a time, and lists the changes that no test notices.

`c`: the headers of an edition and the runtime headers that it uses. Mutated are operators, numbers, masks and shifts,
return statuses and other constants, statements, case labels, and the values of macros and enumerators; not types,
casts, members of structs and texts. Asked are the golden frames, the facts of the header and rounds of random
questions, whose answers agree with the model; a mutant is killed when one answer changes, when the program stops, takes
too long or does not compile.

`cxx`: the C++ header of an edition and the one that all share. Mutated are operators, numbers, constants, enumerators and
statements. Asked are the golden frames, requests to nodes without the command, and random questions. Each mutant is a
program of its own, which takes two seconds, so name an edition and a sample.

`python`: the module of an edition and its runtime (`_codec.py`, `_dispatch.py`, `nodes.py`). Mutated are comparisons,
arithmetic and logical operators, numbers, conditions, statements and returned values; not texts, annotations and
docstrings. Asked are the golden frames, random questions, and the checks of `tests.verification.python_facts`.

Mutants of the C runtime are shown to `tests.verification.integers` and to `tests.verification.floating`, those of the Python
runtime to its unit tests; what is left, to one edition after another, the smallest first, until all that survive are
listed. Functions that are not reached are named. `--part`, `--edition`, `--function` and `--sample` divide a run.
Every survivor must be listed as equivalent, with a reason, in `equivalent_c.yaml`, `equivalent_cxx.yaml` or `equivalent_python.yaml`. The exit
status is 1 for a survivor that is not listed and for a killed mutant that is.

Processor time of a complete run: two minutes for the C runtime, twenty for that of Python; for v2.35, with 3,700 mutants of
its header and 2,100 of its module, about ten minutes and five. `--jobs` processes share it.
"""

from __future__ import annotations

import argparse
import functools
import itertools
import os
import random
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..spec_texts import SPECS, called
from . import c_survivors, cxx_survivors, python_survivors
from .equivalents import Equivalent, judge, read
from .mutants import Mutant

LANGUAGES: dict[str, Any] = {"c": c_survivors, "cxx": cxx_survivors, "python": python_survivors}

CONTEXT = 80
"""The characters that are shown before and after the change of a long line."""

PARTS = ("own", "runtime")
"""The code of each edition, and the code that is the same for every protocol."""


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 1 for survivors that are not listed, and for listed mutants that are killed."""
    parser = argparse.ArgumentParser(
        "python -m tests.verification.mutation",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("language", choices=LANGUAGES)
    parser.add_argument(
        "--edition", action="append", help="as v2.35 or arm/v1 (default: those of spec/ and tests/specs)"
    )
    parser.add_argument("--sample", type=int, help="so many mutants of each edition, and of the runtime (default: all)")
    parser.add_argument("--part", choices=PARTS, help="only the code of the editions, or only the runtime")
    parser.add_argument("--function", help="only mutants of functions whose names match this expression")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="so many at the same time (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--equivalents", type=Path, help="another list")
    given = parser.parse_args(arguments)
    wanted = given.edition or [*map(called, SPECS)]
    chosen = [file for file in SPECS if called(file) in wanted or file.stem in wanted]
    if not chosen:
        parser.error(f"no edition has this name; there are {', '.join(map(called, SPECS))}")
    list_file = given.equivalents or Path(__file__).with_name(f"equivalent_{given.language}.yaml")
    run = Run(given.language, read(list_file), Choice(given.function or "", given.sample, given.seed), given.jobs)
    parts = [given.part] if given.part else PARTS
    if "runtime" in parts:
        run.mutate_runtime(chosen)
    if "own" in parts:
        run.mutate_editions(chosen)
    return int(run.failed)


Identity = tuple[tuple[str, str, str], int]
"""The key of a mutant, and which of the mutants with this key it is."""


def _identified(mutants: Iterable[Mutant]) -> dict[Identity, Mutant]:
    count: Counter[tuple[str, str, str]] = Counter()
    identified: dict[Identity, Mutant] = {}
    for mutant in mutants:
        count[mutant.key] += 1
        identified[mutant.key, count[mutant.key]] = mutant
    return identified


@dataclass(frozen=True)
class Choice:
    """Which mutants are run: those of functions whose names match an expression, and how many of them."""

    function: str
    sample: int | None
    seed: int

    def of(self, mutants: Iterable[Mutant]) -> list[Mutant]:
        """The chosen ones of some mutants."""
        ours = [mutant for mutant in mutants if re.search(self.function, mutant.function)]
        if self.sample is None or len(ours) <= self.sample:
            return ours
        return random.Random(self.seed).sample(ours, self.sample)


class Run:
    """The mutants of several editions, and of the runtime, which survive only if nothing kills them."""

    def __init__(self, language: str, equivalents: Sequence[Equivalent], choice: Choice, jobs: int) -> None:
        self._name, self._language, self._equivalents = language, LANGUAGES[language], equivalents
        self._choice, self._jobs = choice, jobs
        self.failed = False

    def mutate_editions(self, specs: Sequence[Path]) -> None:
        """Runs the mutants of the code of each edition."""
        for spec in specs:
            with tempfile.TemporaryDirectory() as folder:
                subject = self._language.Subject(spec, Path(folder))
                subject.jobs = self._jobs
                every = self._choice.of(mutant for mutant in subject.all_mutants() if not mutant.is_runtime)
                reached = set(subject.mutants())
                chosen = [mutant for mutant in every if mutant in reached]
                alive = list(subject.survivors(chosen))
            self._report(called(spec), chosen, alive, [mutant for mutant in every if mutant not in reached])

    def mutate_runtime(self, specs: Sequence[Path]) -> None:
        """Runs the mutants of the runtime; each subject sees those that survive the one before."""
        small_first = sorted(specs, key=lambda spec: spec.stat().st_size)
        editions: list[Callable[[Path], Any]] = [
            functools.partial(self._language.Subject, spec) for spec in small_first
        ]
        subjects = [*self._language.RUNTIME_SUBJECTS, *editions]
        mutants: dict[Identity, Mutant] = {}
        reached: set[Identity] = set()
        left: set[Identity] = set()
        for create in subjects:
            with tempfile.TemporaryDirectory() as folder:
                subject = create(Path(folder))
                subject.jobs = self._jobs
                every = _identified(mutant for mutant in subject.all_mutants() if mutant.is_runtime)
                if not mutants:
                    chosen = set(self._choice.of(every.values()))
                    mutants = {key: mutant for key, mutant in every.items() if mutant in chosen}
                    left = set(mutants)
                own = set(subject.mutants())
                shown = {every[key]: key for key in mutants if key in left and every.get(key) in own}
                reached |= set(shown.values())
                left -= set(shown.values()) - {shown[mutant] for mutant in subject.survivors([*shown])}
            if not judge([], [mutants[key] for key in left], self._equivalents).unlisted:
                break
        run = [mutants[key] for key in mutants if key in reached]
        unreached = [mutants[key] for key in mutants if key not in reached]
        self._report("runtime", run, [mutants[key] for key in left & reached], unreached)

    def _report(
        self, name: str, mutants: Sequence[Mutant], survivors: Sequence[Mutant], unreached: Sequence[Mutant]
    ) -> None:
        listed = [entry for entry in self._equivalents if entry.edition in ("", name)]
        verdict = judge(mutants, survivors, listed)
        print(f"{name} {self._name}: {len(mutants)} mutants, {len(survivors)} survive,", end=" ")
        print(f"{verdict.listed} of them listed as equivalent")
        if unreached:
            names = ", ".join(sorted({mutant.function for mutant in unreached}))
            print(f"  not reached, and not in these figures: {len(unreached)} mutants of {names}")
        for mutant in verdict.unlisted:
            function, *lines = mutant.key
            original, mutated = _around_the_change(*lines)
            print(f"  survives: {function or '(outside of functions)'}\n    - {original}\n    + {mutated}")
        for entry, mutant in verdict.killed:
            print(f"  listed as equivalent, but killed: {mutant.key}\n    {entry.reason}")
        sys.stdout.flush()
        self.failed = self.failed or bool(verdict.unlisted or verdict.killed)


def _around_the_change(original: str, mutated: str) -> tuple[str, str]:
    """Two long lines with `...` for what is far from their difference."""
    start = max(0, _alike(original, mutated) - CONTEXT)
    end = max(0, _alike(original[start:][::-1], mutated[start:][::-1]) - CONTEXT)

    def shown(line: str) -> str:
        return f"{'...' if start else ''}{line[start : len(line) - end]}{'...' if end else ''}"

    return shown(original), shown(mutated)


def _alike(first: str, second: str) -> int:
    """The number of characters that two texts have in common at the start."""
    return sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(first, second, strict=False)))


if __name__ == "__main__":
    sys.exit(main())
