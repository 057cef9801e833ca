"""Mutants of the C++ headers that survive the questions to an edition: each is a program of its own."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from canwright.model.edition import Edition
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.targets.c.expressions import integer

from ..compilers import SANITIZED, ZIG
from ..conformance.adapter import Raw, Refused, assignment
from ..conformance.adapters.c_facts import Facts
from ..conformance.adapters.cxx import CxxAdapter, cxx_harness
from ..conformance.questions import Questions
from ..conformance.runner import Runner
from .c_mutants import Change, Mutant, Token, changed, replacements, statements, tokens
from .c_survivors import LEAST, SLOWER, Asked, answers_of, ask_availability, time_of_programs
from .differential import compare
from .equivalents import is_repeated

QUICK = 1500
"""So many random questions are asked."""

_ENUM = re.compile(r"enum class \w+ : \w+ \{(.*?)\};", re.S)
_FUNCTION = re.compile(r"\b(\w+)\($")
_STATUSES = ("CANWRIGHT_OK", "CANWRIGHT_OUT_OF_RANGE", "CANWRIGHT_MISSING_PARAMETER", "CANWRIGHT_NOT_AVAILABLE")


class _Recorder(CxxAdapter):
    """Writes down what the program is asked."""

    lines: list[str]

    def _ask(self, *words: str) -> list[str] | Refused:
        self.lines.append(" ".join(words))
        return super()._ask(*words)


class Subject:
    """One edition: its C++ headers, its program, and the questions to it."""

    jobs = 1
    """So many programs run at the same time."""

    def __init__(self, spec: Path, folder: Path) -> None:
        """Records the questions. Raises AssertionError if the original has a wrong answer."""
        item = specification(spec)
        edition = item.edition
        self._folder, self._family = folder, edition.family
        adapter = _Recorder.create(item, folder)
        assert isinstance(adapter, _Recorder)
        include = next(folder.glob("*/include"))
        self._include = include
        self._harness = folder / "harness.cpp"
        self._harness.write_text(cxx_harness(edition), "utf-8")
        names = ("canwright.hpp", f"{edition.identifier}.hpp")
        self.headers = {name: (include / edition.family / name).read_text("utf-8") for name in names}
        self._programs = itertools.count()
        adapter.lines = []
        assert item.frames is not None and not Runner(edition, item.frames, adapter).run().failures
        ask_availability(edition, adapter)
        _ask_unknown_nodes(edition, adapter)
        every = list(Questions(edition).round())
        (comparison,) = compare(item, [adapter], random.Random(1).sample(every, min(len(every), QUICK)))
        assert not comparison.disagreements, comparison.disagreements[:10]
        original = self._compile(self.headers)
        assert original is not None
        file = folder / "questions"
        file.write_text("\n".join(adapter.lines) + "\n", "utf-8")
        before = time_of_programs()
        answers = answers_of(original, 0, file)
        assert answers is not None and b"WRONG" not in answers
        milliseconds = int(1000 * SLOWER * (time_of_programs() - before))
        self._asked = Asked(file, answers, max(LEAST, milliseconds))

    def mutants(self) -> list[Mutant]:
        """All mutants: the program uses every function."""
        return self.all_mutants()

    def all_mutants(self) -> list[Mutant]:
        """All mutants of the headers."""
        return [mutant for name, text in self.headers.items() for mutant in mutants(name, text)]

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants that answer as the original does."""
        with ThreadPoolExecutor(self.jobs) as threads:
            yield from itertools.compress(chosen, threads.map(self._survives, chosen))

    def _survives(self, mutant: Mutant) -> bool:
        text = changed(self.headers[mutant.file], mutant.changes)
        program = self._compile({**self.headers, mutant.file: text})
        if program is None:
            return False
        answers = answers_of(program, 0, self._asked.file, self._asked.milliseconds)
        program.unlink()
        return answers == self._asked.answers

    def _compile(self, headers: Mapping[str, str]) -> Path | None:
        """The program with these headers; None if it does not compile."""
        into = self._folder / f"mutant-{next(self._programs)}"
        for name, text in headers.items():
            file = into / self._family / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, "utf-8")
        for file in (self._include / self._family).glob("*.h"):
            (into / self._family / file.name).symlink_to(file)
        unit, program = into / "harness.o", into / "program"
        flags = ("-w", "-O0", "-g0", "-fno-exceptions", "-fno-rtti", *SANITIZED, f"-I{into}")
        try:
            ZIG.run("c++17", *flags, "-c", self._harness, "-o", unit)
            ZIG.run("c++17", *SANITIZED, "-nostdlib++", unit, "-o", program)
        except AssertionError:
            return None
        return program


def _ask_unknown_nodes(edition: Edition, adapter: CxxAdapter) -> None:
    """Messages with an unknown node and with the largest raw integers: the node is rejected, and no field."""
    for message in edition.all_messages():
        command = edition.command(message.command)
        names = dict.fromkeys([*command.only, *filter(None, [message.layout.parameter])])
        for known in Facts(edition, adapter.header).assignments(*names):
            variant = message.layout.variant(assignment(known))
            if message.id.nodes is not None and variant is not None and command.available(assignment(known)):
                fields = [field for field in variant.fields if field.role.is_value]
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
    return [_mutant(file, text, group) for group in dict.fromkeys(changes)]


def _is_of_template(text: str, token: Token) -> bool:
    """Whether a sign is that of arguments of a template, or of a reference: no operator has no space before it."""
    return token.text in ("<", ">", "&", "&&", "*", ">>") and not text[token.start - 1 : token.end + 1].startswith(
        " "
    ) | (text[token.end] != " ")


def _siblings(text: str) -> dict[str, str]:
    """For the value of each enumerator the next one of its enumeration, for the last the first."""
    groups = [re.findall(r"= ([A-Z]\w+)", body) for body in _ENUM.findall(text)]
    return {a: b for group in groups for a, b in zip(group, [*group[1:], *group[:1]], strict=True) if a != b}


def _mutant(file: str, text: str, changes: tuple[Change, ...]) -> Mutant:
    low, high, new = changes[0]
    start = text.rfind("\n", 0, low) + 1
    end = text.find("\n", high)
    if text[start:high].strip() == text[low:high] or is_repeated(text[start:end], text):
        start = text.rfind("\n", 0, start - 1) + 1
    mutated = text[start:low] + new + text[high:end]
    return Mutant(file, _scope(text, low), changes, " ".join(text[start:end].split()), " ".join(mutated.split()))


def _scope(text: str, place: int) -> str:
    """The name of the last struct and of the last function that starts before a place."""
    names = re.findall(
        r"^(?:template .*)?(?:struct|enum class|class) (\w+)|^[^\n(]*?(\w+)\($|^[^\n(]*?(\w+)\(", text[:place], re.M
    )
    scopes = [next(filter(None, groups)) for groups in names[-1:]]
    return scopes[0] if scopes else ""
