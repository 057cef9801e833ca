"""Runs mutants of the generated Python package of one edition, each in a process of its own that is forked for it."""

from __future__ import annotations

import contextlib
import functools
import importlib.abc
import importlib.machinery
import importlib.util
import itertools
import os
import random
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType, ModuleType

import can
import cantools
import hypothesis
import pytest
from canwright.conformance import modules
from canwright.conformance.adapter import Cannot
from canwright.conformance.python import PythonAdapter
from canwright.conformance.runner import Runner
from canwright.project.loader import specification
from canwright.targets.python.target import RUNTIME, PythonTarget

from ..conformance.adapters.reference import ReferenceAdapter
from ..conformance.questions import Answer, Question, Questions, disagreement
from ..spec_texts import ROOT
from .forks import passing
from .mutants import PYTHON_RUNTIME, Mutant, changed
from .python_facts import check_package
from .python_mutants import mutants

SECONDS, SLOWER = 2, 10
"""A mutant that uses more processor time for one check, and so many times that of the original, is killed."""

QUICK, MOST = 1000, 50_000
"""So many random questions are asked of each mutant first, and at most so many of a round in all."""


UNIT_TESTS = tuple(f"tests/targets/test_python_{name}.py" for name in ("runtime", "nodes"))
"""The tests of the runtime, the quick ones first."""

PRELOADED = (can, cantools, hypothesis)
"""What these tests import, so that a fork need not."""

TESTING = 60
"""A mutant with which these tests use so many seconds of processor time is killed."""


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports modules that are compiled already; `code_of` gives the code of a full name, or None."""

    def __init__(self, code_of: Callable[[str], CodeType | None]) -> None:
        self._code_of = code_of

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> importlib.machinery.ModuleSpec | None:
        if self._code_of(fullname) is None:
            return None
        return importlib.util.spec_from_loader(fullname, self, is_package="." not in fullname)

    def exec_module(self, module: ModuleType) -> None:
        code = self._code_of(module.__name__)
        assert code is not None
        exec(code, module.__dict__)


@dataclass
class _Check:
    """Something to ask a package, the functions that it calls, by file and line, and its limit of processor time."""

    ask: Callable[[PythonAdapter, ModuleType], None]
    calls: frozenset[tuple[str, int]] = frozenset()
    seconds: float = SECONDS


class Subject:
    """One edition: its package, and the questions to it with the answers of the reference."""

    jobs = 1
    """So many mutants are asked at the same time."""

    def __init__(self, spec: Path, folder: Path) -> None:
        self.item = specification(spec)
        edition = self.item.edition
        self._module = f"{edition.family}.{edition.identifier}"
        self._texts = {
            output.path.rpartition("/")[2]: output.text
            for output in PythonTarget().generate([self.item], {})
            if output.path.startswith(f"python/{edition.family}/") or output.path.startswith(f"{edition.family}/")
        }
        self._codes = {
            self._name(file): compile(text, file, "exec") for file, text in self._texts.items() if _is_code(file)
        }
        self._checks = list(self._all_checks())
        self._of_import = self._run_original()

    def _name(self, file: str) -> str:
        family = self.item.edition.family
        return family if file == "__init__.py" else f"{family}.{file.removesuffix('.py')}"

    def _all_checks(self) -> Iterator[_Check]:
        """Everything, what fails soonest first."""
        edition, frames = self.item.edition, self.item.frames
        assert frames is not None
        reference = ReferenceAdapter(edition)
        every = list(itertools.islice(Questions(edition, fractions=True).round(), MOST))
        random.Random(1).shuffle(every)
        asked = [_Check(functools.partial(_compare, question, question.ask(reference))) for question in every]
        yield from asked[:QUICK]
        yield _Check(lambda adapter, module: check_package(self.item, module))
        yield _Check(lambda adapter, module: _replay(Runner(edition, frames, adapter, stop_at_first=True)))
        yield from asked[QUICK:]

    def _run_original(self) -> set[tuple[str, int]]:
        """The functions that the import calls; those of each check are noted. Raises AssertionError for a wrong answer."""
        called: set[tuple[str, int]] = set()

        def note(frame: FrameType, event: str, argument: object) -> None:
            if event == "call" and frame.f_code.co_filename in self._texts:
                called.add((frame.f_code.co_filename, frame.f_code.co_firstlineno))

        sys.setprofile(note)
        try:
            with self._imported(self._codes) as module:
                of_import = set(called)
                same: dict[frozenset[tuple[str, int]], frozenset[tuple[str, int]]] = {}
                adapter = PythonAdapter(self.item.edition, module, sys.modules[f"{self.item.edition.family}.nodes"])
                for check in self._checks:
                    called.clear()
                    before = time.process_time()
                    check.ask(adapter, module)
                    check.seconds = max(SECONDS, SLOWER * (time.process_time() - before))
                    calls = frozenset(called)
                    check.calls = same.setdefault(calls, calls)
        finally:
            sys.setprofile(None)
        return of_import

    @contextlib.contextmanager
    def _imported(self, codes: Mapping[str, CodeType]) -> Iterator[ModuleType]:
        """Imports the package; it is removed at the end, so that later imports find the files of others."""
        finder = _Finder(codes.get)
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
        called = self._of_import.union(*(check.calls for check in self._checks))
        return [m for m in self.all_mutants() if not m.line or (m.file, m.line) in called]

    def all_mutants(self) -> list[Mutant]:
        """All mutants of the edition and the runtime."""
        files = (*PYTHON_RUNTIME, f"{self.item.edition.identifier}.py")
        return [mutant for file in files for mutant in mutants(file, self._texts[file])]

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants with which every answer is right."""
        return passing(chosen, self._ask_mutant, self.jobs)

    def _ask_mutant(self, mutant: Mutant) -> None:
        """Raises an error for a wrong answer; a mutant that takes too long stops the process."""
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        code = compile(changed(self._texts[mutant.file], mutant.changes), mutant.file, "exec")
        with self._imported({**self._codes, self._name(mutant.file): code}) as module:
            adapter = PythonAdapter(self.item.edition, module, sys.modules[f"{self.item.edition.family}.nodes"])
            for check in self._checks_of(mutant):
                signal.setitimer(signal.ITIMER_PROF, check.seconds)
                check.ask(adapter, module)

    def _checks_of(self, mutant: Mutant) -> Iterator[_Check]:
        """The checks that call the function of a mutant; all for one that has an effect when the package is imported."""
        function = mutant.file, mutant.line
        is_of_import = not mutant.line or function in self._of_import
        return (check for check in self._checks if is_of_import or function in check.calls)


class RuntimeSubject:
    """The modules that are the same for every protocol, and their unit tests."""

    jobs = 1
    """So many mutants are tested at the same time."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._texts = {file: (RUNTIME / file).read_text("utf-8") for file in PYTHON_RUNTIME}
        assert list(passing([None], self._test, 1)), "the unit tests of the Python runtime fail"

    def all_mutants(self) -> list[Mutant]:
        """All mutants of the runtime."""
        return [mutant for file, text in self._texts.items() for mutant in mutants(file, text)]

    mutants = all_mutants

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants with which every test passes."""
        return passing(chosen, self._test, self.jobs)

    def _test(self, mutant: Mutant | None) -> None:
        """Raises AssertionError if a test fails, of the runtime or of its copies in generated packages."""
        resource.setrlimit(resource.RLIMIT_CPU, (TESTING, TESTING))
        os.chdir(ROOT)
        if mutant is not None:
            for name in [name for name in sys.modules if name.startswith("canwright.targets.python")]:
                del sys.modules[name]
            code = compile(changed(self._texts[mutant.file], mutant.changes), mutant.file, "exec")
            ending = f".{mutant.file.removesuffix('.py')}"
            sys.meta_path.insert(0, _Finder(lambda name: code if name.endswith(ending) else None))
        temporary = f"--basetemp={self._folder / str(os.getpid())}"
        assert not pytest.main(["-x", "-q", "-n0", "-p", "no:cacheprovider", temporary, *UNIT_TESTS])


RUNTIME_SUBJECTS = (RuntimeSubject,)


def _is_code(file: str) -> bool:
    return file.endswith(".py") and file not in ("python_can.py", "client.py", "client_asyncio.py", "simulation.py")


def _replay(runner: Runner) -> None:
    failures = runner.run().failures
    assert not failures, failures[:10]


def _compare(question: Question, wanted: Answer, adapter: PythonAdapter, module: ModuleType) -> None:
    try:
        answer = question.ask(adapter)
    except Cannot:
        return
    wrong = disagreement(wanted, answer)
    assert not wrong, f"{question}: {wrong}"
