"""Mutants of the C++ headers that survive the questions to an edition: each is a program of its own."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from canwright.conformance.adapter import Raw, Refused, assignment, write_files
from canwright.conformance.runner import Runner
from canwright.model.edition import Edition
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.targets.c.expressions import integer
from canwright.targets.c.target import CTarget

from ..compilers import ZIG
from ..conformance.adapters.c_facts import Facts
from ..conformance.adapters.cxx import FLAGS, CxxAdapter, cxx_harness
from ..conformance.questions import Questions
from .c_mutants import Token, line_mutant, replacements, statements, tokens
from .c_survivors import Program, Recorder, ask_availability
from .differential import compare
from .mutants import Change, Mutant

QUICK = 1500
"""So many random questions are asked."""

_ENUM = re.compile(r"enum class \w+ : \w+ \{(.*?)\};", re.S)
_FUNCTION = re.compile(r"\b(\w+)\($")
_STATUSES = ("CANWRIGHT_OK", "CANWRIGHT_OUT_OF_RANGE", "CANWRIGHT_MISSING_PARAMETER", "CANWRIGHT_NOT_AVAILABLE")


class _Recorder(Recorder, CxxAdapter):
    """Writes down what the program is asked."""


class Subject(Program):
    """One edition: its C++ headers, its program, and the questions to it."""

    source = "harness.cpp"

    def __init__(self, spec: Path, folder: Path) -> None:
        """Records the questions. Raises AssertionError if the original has a wrong answer."""
        item = specification(spec)
        edition = item.edition
        include = write_files(CTarget().generate([item], {}), folder) / "include" / edition.family
        headers = {file.name: file.read_text("utf-8") for file in sorted(include.glob("*.h*"))}
        super().__init__(folder, edition.family, headers, cxx_harness(edition))
        adapter = _Recorder(edition, self.original)
        assert item.frames is not None and not Runner(edition, item.frames, adapter).run().failures
        ask_availability(edition, adapter)
        _ask_unknown_nodes(edition, adapter)
        every = list(Questions(edition).round())
        (comparison,) = compare(item, [adapter], random.Random(1).sample(every, min(len(every), QUICK)))
        assert not comparison.disagreements, comparison.disagreements[:10]
        assert b"WRONG" not in self.add_questions(adapter.lines)

    def mutants(self) -> list[Mutant]:
        """All mutants: the program uses every function."""
        return self.all_mutants()

    def mutants_of(self, name: str, text: str) -> list[Mutant]:
        """The mutants of a header of C++."""
        return mutants(name, text) if name.endswith(".hpp") else []

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants that answer as the original does."""
        return self.alone(chosen)

    def build(self, include: Path, program: Path) -> None:
        """Compiles the program with headers in a folder. Raises AssertionError."""
        unit = program.with_suffix(".o")
        ZIG.run("c++17", "-w", *FLAGS, f"-I{include}", "-c", self.harness, "-o", unit)
        ZIG.run("c++17", *FLAGS, "-nostdlib++", unit, "-o", program)


RUNTIME_SUBJECTS = ()
"""Only programs of an edition use the header that all share."""


def _ask_unknown_nodes(edition: Edition, adapter: CxxAdapter) -> None:
    """Messages with an unknown node and with the largest raw integers: the node is rejected, and no field."""
    for message in edition.all_messages():
        command = edition.command(message.command)
        names = dict.fromkeys([*command.only, *filter(None, [message.layout.parameter])])
        for known in Facts(edition, adapter.header).assignments(*names):
            variant = message.layout.variant(assignment(known))
            if message.id.nodes is not None and variant is not None and command.available(assignment(known)):
                fields = [field for field in variant.fields if field.is_given]
                numbers = [(f, integer(f.type).limits[1]) for f in fields]
                raw: dict[str, Raw] = {f.name: [n] * len(f.elements) if f.is_array else n for f, n in numbers}
                node = message.id.nodes[-1] + 1
                answer = adapter.encode_raw(message.direction, message.command, node, raw, known)
                assert answer == Refused(Refusal.UNKNOWN_NODE), (message.name, known, answer)


def mutants(file: str, text: str) -> list[Mutant]:
    """All mutants of a C++ header: operators, numbers, constants and statements in braces, and enumerators."""
    every = [token for token in tokens(text) if token.kind not in ("space", "comment", "directive")]
    siblings = dict(itertools.pairwise([*_STATUSES, _STATUSES[0]])) | _siblings(text)
    changes: list[tuple[Change, ...]] = []
    for place, token in enumerate(every):
        if not _is_of_template(text, token):
            before = every[place - 1].text if place else "{"
            changes += [((token.start, token.end, new),) for new in replacements(token, before, siblings)]
    changes += [
        ((every[start].start, every[end].end, ";"),)
        for start, end in statements(every)
        if every[start].text != "static_assert"  # for mistakes, which `tests/targets/test_cxx.py` compiles
    ]
    return [line_mutant(file, text, _scope(text, group[0][0]), text, group) for group in dict.fromkeys(changes)]


def _is_of_template(text: str, token: Token) -> bool:
    """Whether a sign is that of arguments of a template, or of a reference: no operator has no space before it."""
    return token.text in ("<", ">", "&", "&&", "*", ">>") and not text[token.start - 1 : token.end + 1].startswith(
        " "
    ) | (text[token.end] != " ")


def _siblings(text: str) -> dict[str, str]:
    """For the value of each enumerator the next one of its enumeration, for the last the first."""
    groups = [re.findall(r"= ([A-Z]\w+)", body) for body in _ENUM.findall(text)]
    return {a: b for group in groups for a, b in zip(group, [*group[1:], *group[:1]], strict=True) if a != b}


def _scope(text: str, place: int) -> str:
    """The name of the last struct and of the last function that starts before a place."""
    names = re.findall(
        r"^(?:template .*)?(?:struct|enum class|class) (\w+)|^[^\n(]*?(\w+)\($|^[^\n(]*?(\w+)\(", text[:place], re.M
    )
    scopes = [next(filter(None, groups)) for groups in names[-1:]]
    return scopes[0] if scopes else ""
