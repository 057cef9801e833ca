"""Breaks the generated code on purpose, one small change at a time, and lists the changes that no test notices.

`c`: the headers of an edition and the runtime headers that it uses. Mutated are operators, numbers, masks and shifts,
return statuses and other constants, statements, case labels, and the values of macros and enumerators; not types,
casts, members of structs and texts. Asked are the golden frames, the facts of the header and rounds of random
questions, whose answers agree with the model; a mutant is killed when one answer changes, when the program stops, takes
too long or does not compile.

`python`: the module of an edition and its runtime (`_codec.py`, `_dispatch.py`, `nodes.py`). Mutated are comparisons,
arithmetic and logical operators, numbers, conditions, statements and returned values; not texts, annotations and
docstrings. Asked are the golden frames, random questions, and the checks of `tests.assurance.python_facts`.

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

from ..spec_texts import ROOT, SPECS, called
from . import c_survivors, python_survivors
from .equivalents import judge, read

LANGUAGES: dict[str, Callable[[Path, Path], Any]] = {"c": c_survivors.Subject, "python": python_survivors.Subject}


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 1 for survivors that are not listed, and for listed mutants that are killed."""
    parser = argparse.ArgumentParser(
        "python -m tests.assurance.mutation",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("language", choices=LANGUAGES)
    parser.add_argument("--edition", action="append", help="as v2.35 or arm/v1 (default: all editions of spec/)")
    parser.add_argument("--sample", type=int, help="so many mutants of each edition (default: all)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--equivalents", type=Path, help="another list")
    given = parser.parse_args(arguments)
    wanted = given.edition or [called(file) for file in SPECS if (ROOT / "spec") in file.parents]
    chosen = [file for file in SPECS if called(file) in wanted or file.stem in wanted]
    if not chosen:
        parser.error(f"no edition has this name; there are {', '.join(map(called, SPECS))}")
    list_file = given.equivalents or Path(__file__).with_name(f"equivalent_{given.language}.yaml")
    equivalents = read(list_file)
    failed = False
    for spec in chosen:
        with tempfile.TemporaryDirectory() as folder:
            subject = LANGUAGES[given.language](spec, Path(folder))
            mutants = subject.mutants()
            if given.sample is not None:
                mutants = random.Random(given.seed).sample(mutants, min(len(mutants), given.sample))
            survivors = list(subject.survivors(mutants))
        verdict = judge(mutants, survivors, equivalents)
        print(f"{called(spec)} {given.language}: {len(mutants)} mutants, {len(survivors)} survive,", end=" ")
        print(f"{verdict.listed} of them listed as equivalent")
        for mutant in verdict.unlisted:
            function, original, mutated = mutant.key
            print(f"  survives: {function or '(outside of functions)'}\n    - {original}\n    + {mutated}")
        for entry, mutant in verdict.killed:
            print(f"  listed as equivalent, but killed: {mutant.key}\n    {entry.reason}")
        if subject.unused():
            print(f"  not asked: {', '.join(subject.unused())}")
        failed = failed or bool(verdict.unlisted or verdict.killed)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
