"""A sample of the mutants of generated code is killed; and survivors and the list of equivalents are compared.

The sample is of the headers and the module of one edition; the command also mutates other editions and the runtime.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from ..spec_texts import SPECS, called
from . import c_mutants, mutation
from .equivalents import Equivalent, judge, read

SAMPLE = {"c": 60, "cxx": 8, "python": 25}
HEADER = """\
enum {
    A,
    B
};
CHECKED(1)
static inline int f(int x)
{
    if (x < 2) {
        return A;
    }
    return B;
}
"""


@pytest.mark.parametrize("language", SAMPLE)
def test_a_sample_of_mutants_is_killed(language: str, tmp_path: Path) -> None:
    spec = next(spec for spec in SPECS if called(spec) == "pump/v1")
    subject = mutation.LANGUAGES[language].Subject(spec, tmp_path)
    own = [mutant for mutant in subject.mutants() if not mutant.is_runtime]
    some = random.Random(1).sample(own, SAMPLE[language])
    listed = read(Path(mutation.__file__).with_name(f"equivalent_{language}.yaml"))
    verdict = judge(some, list(subject.survivors(some)), listed)
    assert [mutant.key for mutant in verdict.unlisted] == []
    assert not verdict.killed


def test_tokens_of_a_header_are_mutated() -> None:
    mutated = {mutant.mutated for mutant in c_mutants.mutants("x.h", HEADER)}
    assert {"if (x <= 2) {", "if (x < 3) {", "if (x < 1) {", "return B;", "return A;"} <= mutated


def test_a_copy_of_a_function_has_the_change() -> None:
    first, *_ = c_mutants.mutants("x.h", HEADER)
    text = c_mutants.merged(HEADER, {7: first}).text
    assert "int f_7(int x)" in text and "case 7: return f_7(x);" in text and text.count("x < 2") == 1


@pytest.mark.parametrize(
    ("alive", "listed", "unlisted", "killed"), [(1, 1, 0, 0), (1, 0, 1, 0), (0, 1, 0, 1), (0, 0, 0, 0)]
)
def test_survivors_and_the_list_must_agree(alive: int, listed: int, unlisted: int, killed: int) -> None:
    mutants = c_mutants.mutants("x.h", HEADER)[:1]
    entries = [Equivalent("f", "if (x < ...) {", ("if (x > ...) {", "if (x <= ...) {"), "for this test")]
    verdict = judge(mutants, mutants[:alive], entries[:listed])
    assert (len(verdict.unlisted), len(verdict.killed)) == (unlisted, killed)
