"""Shows mutants of the Python runtime to its unit tests, each in a process of its own that is forked for it."""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import importlib.util
import os
import resource
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import CodeType, ModuleType

import can
import cantools
import hypothesis
import pytest
from canwright.targets.python import RUNTIME as FOLDER

from ..spec_texts import ROOT
from .forks import passing
from .python_mutants import RUNTIME, Mutant, changed, mutants

FILES = tuple(f"tests/targets/test_python_{name}.py" for name in ("runtime", "nodes"))
"""The tests of the runtime, the quick ones first."""

PRELOADED = (can, cantools, hypothesis)
"""What the tests import, so that a fork need not."""

SECONDS = 60
"""A mutant with which the tests use more processor time is killed."""


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports a mutant in place of the module of the runtime, and of its copies in generated packages."""

    def __init__(self, name: str, code: CodeType) -> None:
        self._name, self._code = name, code

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> importlib.machinery.ModuleSpec | None:
        if path is None or fullname.rpartition(".")[2] != self._name:
            return None
        return importlib.util.spec_from_loader(fullname, self)

    def exec_module(self, module: ModuleType) -> None:
        exec(self._code, module.__dict__)


class Subject:
    """The modules of the runtime, and their unit tests."""

    jobs = 1
    """So many mutants are tested at the same time."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._texts = {file: (FOLDER / file).read_text("utf-8") for file in RUNTIME}
        assert list(passing([None], self._test, 1)), "the unit tests of the Python runtime fail"

    def all_mutants(self) -> list[Mutant]:
        """All mutants of the runtime."""
        return [mutant for file, text in self._texts.items() for mutant in mutants(file, text)]

    mutants = all_mutants

    def survivors(self, chosen: Sequence[Mutant]) -> Iterator[Mutant]:
        """Those of some mutants with which every test passes."""
        return passing(chosen, self._test, self.jobs)

    def _test(self, mutant: Mutant | None) -> None:
        """Raises AssertionError if a test fails."""
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        os.chdir(ROOT)
        if mutant is not None:
            for name in [name for name in sys.modules if name.startswith("canwright.targets.python")]:
                del sys.modules[name]
            code = compile(changed(self._texts[mutant.file], mutant), mutant.file, "exec")
            sys.meta_path.insert(0, _Finder(mutant.file.removesuffix(".py"), code))
        temporary = f"--basetemp={self._folder / str(os.getpid())}"
        assert not pytest.main(["-x", "-q", "-n0", "-p", "no:cacheprovider", temporary, *FILES])
