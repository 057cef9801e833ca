"""Runs mutants of the generated Python package of one edition, each in a process of its own that is forked for it."""

from __future__ import annotations

import contextlib
import importlib.abc
import importlib.machinery
import importlib.util
import itertools
import os
import random
import signal
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import CodeType, FrameType, ModuleType

from canwright.project.loader import specification
from canwright.targets import python as target
from canwright.targets.base import Specification

from ..conformance.adapter import Cannot
from ..conformance.adapters import modules
from ..conformance.adapters.python import PythonAdapter
from ..conformance.adapters.reference import ReferenceAdapter
from ..conformance.questions import Answer, Question, Questions, disagreement
from ..conformance.runner import Runner
from .python_facts import check_package
from .python_mutants import RUNTIME, Mutant, changed, mutants

SECONDS = 60
"""A mutant that takes longer is killed."""

QUICK, THOROUGH = 1500, 20_000
"""So many random questions are asked of each mutant, and so many of one that survives these."""


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports a package whose modules are compiled already."""

    def __init__(self, codes: Mapping[str, CodeType]) -> None:
        self._codes = codes

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname not in self._codes:
            return None
        return importlib.util.spec_from_loader(fullname, self, is_package="." not in fullname)

    def exec_module(self, module: ModuleType) -> None:
        exec(self._codes[module.__name__], module.__dict__)


class Subject:
    """One edition: its package, and the questions to it with the answers of the reference."""

    def __init__(self, spec: Path, folder: Path) -> None:
        self.item = specification(spec)
        edition = self.item.edition
        self._module = f"{edition.family}.{edition.identifier}"
        self._texts = {
            output.path.rpartition("/")[2]: output.text
            for output in target.generate([self.item], {})
            if output.path.startswith(f"python/{edition.family}/") or output.path.startswith(f"{edition.family}/")
        }
        self._codes = {
            self._name(file): compile(text, file, "exec") for file, text in self._texts.items() if _is_code(file)
        }
        reference = ReferenceAdapter(edition)
        every = list(itertools.islice(Questions(edition, fractions=True).forever(), THOROUGH))
        random.Random(1).shuffle(every)
        self._asked: list[tuple[Question, Answer]] = [(question, question.ask(reference)) for question in every]
        self._called = self._run_original()

    def _name(self, file: str) -> str:
        family = self.item.edition.family
        return family if file == "__init__.py" else f"{family}.{file.removesuffix('.py')}"

    def _run_original(self) -> set[tuple[str, int]]:
        """The functions that are called, by file and line. Raises AssertionError for a wrong answer."""
        called: set[tuple[str, int]] = set()

        def note(frame: FrameType, event: str, argument: object) -> None:
            if event == "call":
                called.add((frame.f_code.co_filename, frame.f_code.co_firstlineno))

        sys.setprofile(note)
        try:
            with self._imported(self._codes) as module:
                _ask(self.item, module, self._asked)
        finally:
            sys.setprofile(None)
        return called

    @contextlib.contextmanager
    def _imported(self, codes: Mapping[str, CodeType]) -> Iterator[ModuleType]:
        """Imports the package; it is removed at the end, so that later imports find the files of others."""
        finder = _Finder(codes)
        with modules.without_modules(self.item.edition.family):
            sys.meta_path.insert(0, finder)
            try:
                for name in codes:
                    importlib.import_module(name)
                yield sys.modules[self._module]
            finally:
                sys.meta_path.remove(finder)

    def mutants(self) -> list[Mutant]:
        """The mutants of the edition and the runtime, without those of functions that are not called."""
        return [m for m in self.all_mutants() if not m.line or (m.file, m.line) in self._called]

    def all_mutants(self) -> list[Mutant]:
        """All mutants of the edition and the runtime."""
        files = (*RUNTIME, f"{self.item.edition.identifier}.py")
        return [mutant for file in files for mutant in mutants(file, self._texts[file])]

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants with which every answer is right."""
        return (mutant for mutant in chosen if not self._is_killed(mutant))

    def _is_killed(self, mutant: Mutant) -> bool:
        child = os.fork()
        if not child:
            self._ask_mutant(mutant)
        return os.waitpid(child, 0)[1] != 0

    def _ask_mutant(self, mutant: Mutant) -> None:
        """Ends the process: with 0 if every answer is right."""
        status = 1
        try:
            signal.alarm(SECONDS)
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, 1)
            os.dup2(null, 2)
            code = compile(changed(self._texts[mutant.file], mutant), mutant.file, "exec")
            with self._imported({**self._codes, self._name(mutant.file): code}) as module:
                _ask(self.item, module, self._asked)
            status = 0
        except BaseException:
            status = 1
        finally:
            os._exit(status)


def _is_code(file: str) -> bool:
    return file.endswith(".py") and file != "python_can.py"


def _ask(item: Specification, module: ModuleType, asked: Sequence[tuple[Question, Answer]]) -> None:
    """Asks everything, what fails soonest first. Raises AssertionError for a wrong answer, or what the package raises."""
    adapter = PythonAdapter(item.edition, module)
    _compare(adapter, asked[:QUICK])
    check_package(item, module)
    assert item.frames is not None
    assert not Runner(item.edition, item.frames, adapter, stop_at_first=True).run().failures
    _compare(adapter, asked[QUICK:])


def _compare(adapter: PythonAdapter, asked: Sequence[tuple[Question, Answer]]) -> None:
    for question, wanted in asked:
        try:
            found = question.ask(adapter)
        except Cannot:
            continue
        wrong = disagreement(wanted, found)
        assert not wrong, f"{question}: {wrong}"
