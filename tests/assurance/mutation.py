"""Breaks the generated code on purpose, one small change at a time, and lists the changes that no test notices.

`c`: the headers of an edition and the runtime headers that it uses. Mutated are operators, numbers, masks and shifts,
return statuses and other constants, statements, case labels, and the values of macros and enumerators; not types,
casts, members of structs and texts. Asked are the golden frames, the facts of the header and rounds of random
questions, whose answers agree with the model; a mutant is killed when one answer changes, when the program stops, takes
too long or does not compile.

`python`: the module of an edition and its runtime (`_codec.py`, `_dispatch.py`, `nodes.py`). Mutated are comparisons,
arithmetic and logical operators, numbers, conditions, statements and returned values; not texts, annotations and
docstrings. Asked are the golden frames, random questions, and the checks of `tests.assurance.python_facts`.

Mutants of the runtime are shown to all editions, and survive only if none of them kills it. A complete run takes hours.
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
        self.failed = False

    def mutate(self, spec: Path) -> None:
        """Runs the mutants of one edition, and those of the runtime that are left."""
        with tempfile.TemporaryDirectory() as folder:
            subject = LANGUAGES[self._language](spec, Path(folder))
            every = subject.mutants()
            own = self._sampled([mutant for mutant in every if not mutant.is_runtime])
            if self._runtime is None:
                runtime = (mutant for mutant in subject.all_mutants() if mutant.is_runtime)
                self._runtime = {mutant.key: mutant for mutant in self._sampled(list(runtime))}
                self._left = set(self._runtime)
            shared = [mutant for mutant in every if mutant.is_runtime and mutant.key in self._left]
            alive = list(subject.survivors([*own, *shared]))
        self._left -= {mutant.key for mutant in shared} - {mutant.key for mutant in alive}
        self._report(called(spec), own, [mutant for mutant in alive if not mutant.is_runtime])

    def judge_runtime(self) -> None:
        """Reports what is left of the mutants of the runtime."""
        mutants = self._runtime or {}
        self._report("runtime", list(mutants.values()), [mutants[key] for key in self._left])

    def _sampled(self, mutants: list[Any]) -> list[Any]:
        if self._sample is None or len(mutants) <= self._sample:
            return mutants
        return random.Random(self._seed).sample(mutants, self._sample)

    def _report(self, name: str, mutants: Sequence[Any], survivors: Sequence[Any]) -> None:
        verdict = judge(mutants, survivors, self._equivalents)
        print(f"{name} {self._language}: {len(mutants)} mutants, {len(survivors)} survive,", end=" ")
        print(f"{verdict.listed} of them listed as equivalent")
        for mutant in verdict.unlisted:
            function, original, mutated = mutant.key
            print(f"  survives: {function or '(outside of functions)'}\n    - {original}\n    + {mutated}")
        for entry, mutant in verdict.killed:
            print(f"  listed as equivalent, but killed: {mutant.key}\n    {entry.reason}")
        sys.stdout.flush()
        self.failed = self.failed or bool(verdict.unlisted or verdict.killed)


if __name__ == "__main__":
    sys.exit(main())
