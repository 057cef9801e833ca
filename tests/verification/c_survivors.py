"""Runs mutants of the generated C headers of one edition against everything that the conformance tests ask a header.

The questions are asked of the original first, whose answers must agree with the model. A mutant is killed when the same
program, given the same lines, prints anything else, stops, or takes too long.
"""

from __future__ import annotations

import functools
import itertools
import os
import random
import re
import resource
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import ClassVar

from canwright.conformance.adapter import Adapter, CanFrame, Decoded, Raw, Refused, assignment, write_files
from canwright.conformance.runner import Runner
from canwright.model.edition import Edition
from canwright.model.layout import MAX_DATA_BYTES, Field, Space
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.semantics.decoder import Decoder, Identified, Rejection
from canwright.semantics.encoder import Encoder
from canwright.semantics.frame import node_of, with_checksum
from canwright.semantics.plan import message_plan
from canwright.targets.base import EditionInput
from canwright.targets.c.names import layouts
from canwright.targets.c.package import RUNTIME
from canwright.targets.c.target import CTarget

from ..compilers import SANITIZED, ZIG
from ..conformance.adapters.c import CAdapter
from ..conformance.adapters.c_facts import Facts
from ..conformance.adapters.c_harness import harness, header_text
from ..conformance.adapters.reference import ReferenceAdapter
from ..conformance.questions import Questions
from . import floating, integers
from .c_mutants import CHOICE, functions, merged, mutants, selectable, used
from .differential import compare
from .mutants import Mutant, changed

MAX_LINES = 40_000
"""So many lines of copies are compiled in one program."""

SLOWER = 10
"""A mutant that takes so many times the processor time of the original is killed."""

QUICK = 2500
"""So many random questions are asked first; survivors are asked whole rounds."""

ROUNDS = 2

UNCHECKED = 8
"""So many random messages of each layout are written without a check."""

CASES = 30_000
"""So many cases of exact fractions are asked of the runtime."""

SOONEST = 500
"""So many of these cases, and of the questions about an edition, are asked first; they kill most mutants."""

FRAMES = 4000
"""So many random frames are checked and printed."""

LEAST = 200
"""The least limit of the processor time of a mutant, in milliseconds."""


@dataclass(frozen=True)
class Asked:
    """Questions in a file, the answers of the original, and the limit of the processor time in milliseconds."""

    file: Path
    answers: bytes
    milliseconds: int


def time_of_programs() -> float:
    """The processor time of all programs that have ended, in seconds."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Recorder(CAdapter):
    """Writes down what the program is asked."""

    def __init__(self, edition: Edition, program: Path, header: str = "") -> None:
        super().__init__(edition, program, header)
        self.lines: list[str] = []

    def _ask(self, *words: str) -> list[str] | Refused:
        self.lines.append(" ".join(words))
        return super()._ask(*words)


class Program:
    """A program, the headers that it includes, below `family`, and questions to it."""

    source: ClassVar[str] = "harness.c"
    level: ClassVar[tuple[str, ...]] = ("-O0",)
    jobs = 1
    """So many programs run at the same time."""

    def __init__(self, folder: Path, family: str, headers: Mapping[str, str], harness: str) -> None:
        self.folder, self._family = folder, family
        self.headers = headers
        self.harness = self.folder / self.source
        self.harness.write_text(harness, "utf-8")
        (self.folder / "choice.h").write_text(CHOICE, "utf-8")
        self._programs = itertools.count()
        original, errors = self._compile(self.headers)
        assert original is not None, errors
        self.original = original
        self._asked: list[Asked] = []

    def add_questions(self, lines: Sequence[str]) -> bytes:
        """Adds lines that are asked of every mutant, after those added before; returns the answers of the original."""
        file = self.folder / f"questions-{len(self._asked)}"
        file.write_text("\n".join(lines) + "\n", "utf-8")
        before = time_of_programs()
        answers = answers_of(self.original, 0, file)
        milliseconds = 1000 * SLOWER * (time_of_programs() - before)
        assert answers is not None
        self._asked.append(Asked(file, answers, max(LEAST, int(milliseconds))))
        return answers

    def mutants(self) -> list[Mutant]:
        """The mutants of the headers, without those of functions that no question reaches."""
        reached = used("\n".join(self.headers.values()), self.harness.read_text("utf-8"))
        return [mutant for mutant in self.all_mutants() if not mutant.function or mutant.function in reached]

    def all_mutants(self) -> list[Mutant]:
        """All mutants of the headers."""
        return [mutant for name, text in self.headers.items() for mutant in self.mutants_of(name, text)]

    def mutants_of(self, name: str, text: str) -> list[Mutant]:
        """The mutants of a header, without those of golden frames as a test."""
        return [] if "selftest" in name else mutants(name, text)

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants that answer as the original does."""
        for part in self._parts([mutant for mutant in chosen if mutant.function]):
            yield from self._survivors(dict(enumerate(part, 1)))
        yield from self._outside([mutant for mutant in chosen if not mutant.function])

    def _parts(self, chosen: Sequence[Mutant]) -> Iterator[list[Mutant]]:
        part: list[Mutant] = []
        lines = 0
        sizes = {name: _sizes(text) for name, text in self.headers.items()}
        for mutant in chosen:
            lines += sizes[mutant.file][mutant.function]
            part.append(mutant)
            if lines > MAX_LINES:
                yield part
                part, lines = [], 0
        if part:
            yield part

    def _survivors(self, chosen: dict[int, Mutant]) -> Iterator[Mutant]:
        """Survivors of mutants in one program; those that do not compile are left out, one compilation after another."""
        while chosen:
            files = {
                name: merged(text, {n: m for n, m in chosen.items() if m.file == name})
                for name, text in self.headers.items()
            }
            program, errors = self._compile({name: file.text for name, file in files.items()})
            if program is not None:
                break
            wrong = {files[name].lines.get(line, 0) for name, line in errors} - {0}
            assert wrong, f"the program does not compile: {errors}"
            chosen = {number: mutant for number, mutant in chosen.items() if number not in wrong}
        else:
            return
        yield from (chosen[number] for number in self._alive(program, chosen))
        program.unlink()

    def _outside(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Survivors of mutants of macros and enumerators: macros in one program first, what survives in a program each."""
        labels = set(re.findall(r"\bcase (\w+):", "".join(self.headers.values())))  # must be constants
        macros = {
            number: mutant
            for number, mutant in enumerate(chosen, 1)
            if mutant.original.startswith("#") and mutant.original.split()[1] not in labels
        }
        program, _ = self._compile(
            {
                name: selectable(text, {n: m for n, m in macros.items() if m.file == name})
                for name, text in self.headers.items()
            }
        )
        killed: set[Mutant] = set()
        if program is not None and self._alive(program, [0]):
            alive = self._alive(program, macros)
            killed = {mutant for number, mutant in macros.items() if number not in alive}
        yield from self.alone([mutant for mutant in chosen if mutant not in killed])

    def alone(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Survivors of some mutants, each in a program of its own."""
        with ThreadPoolExecutor(self.jobs) as threads:
            yield from itertools.compress(chosen, threads.map(self._survives_alone, chosen))

    def _survives_alone(self, mutant: Mutant) -> bool:
        text = changed(self.headers[mutant.file], mutant.changes)
        program, _ = self._compile({**self.headers, mutant.file: text})
        if program is None:
            return False
        survives = not self._is_killed(program, 0)
        shutil.rmtree(program.parent)
        return survives

    def _alive(self, program: Path, numbers: Iterable[int]) -> list[int]:
        """The mutants of a program that survive."""
        with ThreadPoolExecutor(self.jobs) as threads:
            every = list(numbers)
            killed = threads.map(functools.partial(self._is_killed, program), every)
            return [number for number, is_killed in zip(every, killed, strict=True) if not is_killed]

    def _compile(self, texts: Mapping[str, str]) -> tuple[Path | None, list[tuple[str, int]]]:
        """The program with these headers; None with the places of errors when it does not compile."""
        include = self.folder / str(next(self._programs))
        for name, text in texts.items():
            file = include / self._family / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, "utf-8")
        program = include / "program"
        try:
            self.build(include, program)
        except AssertionError as error:
            places = re.findall(r"^[^\n]*?([\w.]+\.h):(\d+):\d+: (?:fatal )?error:", str(error), re.MULTILINE)
            return None, [(name, int(line)) for name, line in places]
        return program, []

    def build(self, include: Path, program: Path) -> None:
        """Compiles the program with headers in a folder. Raises AssertionError."""
        flags = (
            "-w",
            *self.level,
            "-g0",
            "-ferror-limit=0",
            *SANITIZED,
            "-fno-sanitize=alignment",
            "-fstrict-flex-arrays=3",  # an array at the end of a struct has bounds, too
        )
        places = (f"-I{include}", f"-I{include / self._family}", "-include", self.folder / "choice.h")
        ZIG.run("gnu99", *flags, *places, self.harness, "-o", program)

    def _is_killed(self, program: Path, number: int) -> bool:
        return any(
            answers_of(program, number, asked.file, asked.milliseconds) != asked.answers for asked in self._asked
        )


def answers_of(program: Path, number: int, questions: Path, milliseconds: int | None = None) -> bytes | None:
    """What a program prints; None when it stops or takes too long. `number` is that of a mutant in the program."""
    environment = {**os.environ, "MUTANT": str(number)}
    if milliseconds is not None:
        environment["MILLISECONDS"] = str(milliseconds)
    with questions.open("rb") as lines:
        done = subprocess.run([program], stdin=lines, capture_output=True, env=environment, check=False)
    return None if done.returncode else done.stdout


def packed(harness: str) -> str:
    """A program whose structs have no padding, as on an 8-bit machine: members of a union have different places."""
    return harness.replace('#include "', '#pragma pack(1)\n#include "', 1)


class Subject(Program):
    """One edition: its headers, its program, and the questions to it."""

    def __init__(self, spec: Path, folder: Path) -> None:
        self.item = specification(spec)
        edition = self.item.edition
        include = write_files(CTarget().generate([self.item], {}), folder) / "include"
        headers = {file.name: file.read_text("utf-8") for file in sorted((include / edition.family).glob("*.h"))}
        super().__init__(folder, edition.family, headers, packed(harness(edition, include)))
        asked = []
        for ask in (_ask_everything, _ask_rounds):
            recorder = Recorder(edition, self.original, header_text(edition, include))
            ask(self.item, recorder)
            asked.append(recorder.lines)
        some = random.Random(1).sample(asked[0], min(len(asked[0]), SOONEST))
        for lines in (some, *asked):
            self.add_questions(lines)


class RuntimeSubject(Program):
    """The headers that are the same for every protocol, asked by a module that compares them with exact fractions."""

    level = ("-O1", "-fsanitize=local-bounds")
    """Also stops at an access beyond a variable, which the compiler can check only when it optimizes."""

    def __init__(self, asking: ModuleType, folder: Path) -> None:
        headers = {file.name: file.read_text("utf-8") for file in sorted(RUNTIME.glob("*.h"))}
        super().__init__(folder, "runtime", headers, packed(asking.PROGRAM.read_text("utf-8")))
        cases = asking.cases(CASES, random.Random(1))
        wrong = floating.differences(self.original, cases)
        assert not wrong, wrong[:10]
        lines = [case.line().rstrip() for case in cases]
        for part in (lines[:SOONEST], lines[SOONEST:]):
            self.add_questions(part)


RUNTIME_SUBJECTS = tuple(functools.partial(RuntimeSubject, asking) for asking in (integers, floating))


def _sizes(text: str) -> dict[str, int]:
    """The lines of each function."""
    return {function.name: text.count("\n", function.start, function.end) + 2 for function in functions(text)}


def _ask_everything(item: EditionInput, adapter: CAdapter) -> None:
    """The golden frames, the facts, and some random questions. Raises AssertionError for a wrong answer."""
    assert item.frames is not None
    report = Runner(item.edition, item.frames, adapter).run()
    assert not report.failures, report.failures[:10]
    wrong = adapter.wrong_facts()
    assert not wrong, wrong[:10]
    _ask_filters(item, adapter)
    ask_availability(item.edition, adapter)
    _ask_absent(item, adapter)
    ask_unchecked(item.edition, adapter)
    _ask_milli(item, adapter)
    _ask_frames(item, adapter)
    _ask_singles(item, adapter)
    every = list(Questions(item.edition).round())
    (comparison,) = compare(item, [adapter], random.Random(1).sample(every, min(len(every), QUICK)))
    assert not comparison.disagreements, comparison.disagreements[:10]


def _ask_filters(item: EditionInput, adapter: CAdapter) -> None:
    """The filters of some nodes, and whether they accept ids that differ in one bit; the constants of filters.

    `tests/targets/test_c_print.py` compares these constants with the ids of all messages.
    """
    for name in Facts(item.edition, adapter.header).filter_macros():
        adapter.constant(name)
    for address in item.edition.addresses:
        for direction in Direction:
            rule = address.rule(direction)
            if rule.nodes is None or not item.edition.of_rule(direction, rule):
                continue
            assert adapter.filter(address.name, direction, rule.nodes[-1] + 1) == Refused(Refusal.UNKNOWN_NODE)
            for node in rule.nodes[:40]:
                filter_ = adapter.filter(address.name, direction, node)
                assert not isinstance(filter_, Refused)
                ids = [filter_[0], *(filter_[0] ^ 1 << bit for bit in range(32)), 0, (1 << 32) - 1]
                accepted = [not (id_ ^ filter_[0]) & filter_[1] for id_ in ids]
                assert adapter.accepted(address.name, direction, node, ids) == accepted


def ask_availability(edition: Edition, adapter: CAdapter) -> None:
    """Requests to nodes without the command are not encoded; replies do not depend on that."""
    for message in edition.all_messages():
        command = edition.command(message.command)
        for known in Facts(edition, adapter.header).assignments(*command.only):
            is_available = message.direction is Direction.REPLY or command.available(assignment(known))
            assert adapter.has_command(message, known) == is_available, (message.name, known)


def ask_unchecked(edition: Edition, adapter: CAdapter) -> None:
    """The bits of fields that are written without a check, which takes any raw integers of their width."""
    chance = random.Random(1)
    for layout, known in itertools.product(layouts(edition), list(_choices(edition))):
        variant = layout.variant(known)
        assert variant is not None
        fields = [field for field in variant.fields if field.is_given]
        for width in (0, 64, *[1] * UNCHECKED) if fields else ():
            raws: dict[str, list[int]] = {f.name: [_any_raw(f, width, chance) for _ in f.elements] for f in fields}
            bits, sent = dict.fromkeys(Space, 0), message_plan(edition.of_layout(layout)[0]).sent
            for field in variant.fields:
                each = raws.get(field.name, [sent.get(field, 0)] * len(field.elements))
                for raw, element in zip(each, field.elements, strict=True):
                    for s in element.segments:
                        bits[field.space] |= (raw >> s.raw_low & (1 << s.width) - 1) << s.low + 8 * s.byte
            of_layout = edition.of_layout(layout)[0]
            frame = CanFrame(bits[Space.ID], bits[Space.DATA].to_bytes(MAX_DATA_BYTES, "little")[: of_layout.dlc])
            bits[Space.DATA] = int.from_bytes(with_checksum(of_layout, frame).data, "little")
            given: dict[str, Raw] = {f.name: raws[f.name] if f.is_array else raws[f.name][0] for f in fields}
            assert adapter.pack(layout, given, known) == (bits[Space.ID], bits[Space.DATA]), (layout.name, raws)


def _any_raw(field: Field, width: int, chance: random.Random) -> int:
    """A raw integer of a field: 0, all bits, or any bits, for a `width` of 0, of 64, and of 1."""
    low, high = field.type.raw_limits
    number = {0: 0, 64: (1 << field.type.width) - 1}.get(width, chance.getrandbits(field.type.width))
    return number if number <= high else number + 2 * low


def _choices(edition: Edition) -> Iterator[dict[str, str]]:
    """Parameters with each value of each choice at least once."""
    count = max((len(p.values) for p in edition.parameters), default=1)
    for place in range(count):
        yield {p.name: p.values[place % len(p.values)].name if p.values else "1" for p in edition.parameters}


def _ask_absent(item: EditionInput, adapter: CAdapter) -> None:
    """Messages with fields that do not exist under a parameter; they have to be 0 in C."""
    edition = item.edition
    for message in (message for message in edition.all_messages() if message.layout.parameter):
        node = message.id.nodes[0] if message.id.nodes else None
        for value in edition.parameter(message.layout.parameter or "").values:
            known = {p.name: p.values[0].name if p.values else "1" for p in edition.parameters}
            known[message.layout.parameter or ""] = value.name
            encoder = Encoder(known)
            fields = encoder.fields(message) or {}
            raws = {name: _valid(encoder, field) for name, field in fields.items()}
            for absent in (f for f in message.layout.fields if f.is_given and f.name not in fields):
                wrong = {**raws, absent.name: [1 for _ in absent.elements] if absent.is_array else 1}
                answer = adapter.encode_raw(message.direction, message.command, node, wrong, known)
                assert answer == Refused(Refusal.OUT_OF_RANGE, absent.name), (message.name, absent.name, known, answer)


def _valid(encoder: Encoder, field: Field) -> Raw:
    raw = next(raw for raw in (0, 1, *field.type.raw_limits) if encoder.rejects_raw(field, raw) is None)
    return [raw for _ in field.elements] if field.is_array else raw


def _ask_milli(item: EditionInput, adapter: CAdapter) -> None:
    """Thousandths of raw integers with more bits than their type; these can be rejected."""
    for fact in Facts(item.edition, adapter.header).milli_beyond():
        answer = adapter.milli(fact.name, "to", int(fact.rest[1]), fact.parameters)
        assert answer in (int(fact.answer), Refused(Refusal.OUT_OF_RANGE)), (fact, answer)


def _ask_frames(item: EditionInput, adapter: CAdapter) -> None:
    """The check and the identification of frames, which must agree with the model, and their texts.

    `tests/targets/test_c_print.py` compares texts of golden frames with the model.
    """
    assert item.frames is not None
    reference, decoder = ReferenceAdapter(item.edition), Decoder(item.edition)
    frames = [(f.direction, CanFrame(f.id, f.data, f.extended, f.remote), f.parameters) for f in item.frames.frames]
    random_ = (q.arguments[:3] for q in Questions(item.edition, 3).round() if q.kind == "decode")
    for place, (direction, frame, known) in enumerate((*frames, *itertools.islice(random_, FRAMES))):
        if not item.edition.messages(direction):
            continue
        length, _ = adapter.text(direction, frame, known)
        if place % 20 == 0:
            for size in (0, 1, 2, length // 2, length, length + 1, length + 2):
                adapter.text(direction, frame, known, size)
        wanted = reference.decode(direction, frame, known, None)
        identified, named = decoder.identify(direction, frame), adapter.identify(direction, frame)
        if isinstance(identified, Rejection):
            assert named == Refused(identified.reason), (direction, frame)
        elif named != (identified.message.command, _node(identified, frame)):  # a constant of the fields can be wrong
            assert isinstance(wanted, Refused) and named == Refused(wanted.says), (direction, frame)
        answer = adapter.check(direction, frame, known)
        if isinstance(wanted, Decoded):
            encoded = reference.encode_raw(direction, wanted.command, wanted.node, wanted.raw, known)
            assert answer == (encoded if isinstance(encoded, Refused) else None), (direction, frame, known)
        else:
            assert answer == Refused(wanted.says), (direction, frame, known)


def _node(identified: Identified, frame: CanFrame) -> int:
    """The node in the id or in the data of a frame; 0 without one."""
    return node_of(identified.message, frame) or 0


def _ask_singles(item: EditionInput, adapter: CAdapter) -> None:
    """Conversions of single precision, near the limits of every type; their error is limited."""
    for single in Facts(item.edition, adapter.header).singles():
        answer = adapter.single(single.type, single.direction, single.number, single.parameters)
        assert single.accepts(answer), (single, answer)


def _ask_rounds(item: EditionInput, adapter: Adapter) -> None:
    """Some rounds of random questions. Raises AssertionError for a wrong answer."""
    for seed in range(1, ROUNDS + 1):
        (comparison,) = compare(item, [adapter], Questions(item.edition, seed).round())
        assert not comparison.disagreements, comparison.disagreements[:10]
