"""Types, style, complexity, names and the order of imports."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from .spec_texts import ROOT

BIN = Path(sys.executable).parent
TOOLS = [("mypy",), ("ruff", "check"), ("ruff", "format", "--check"), ("lint-imports",)]


@pytest.mark.parametrize("command", TOOLS, ids=" ".join)
def test_tool_reports_nothing(command: tuple[str, ...]) -> None:
    tool, *arguments = command
    result = subprocess.run([BIN / tool, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


VAGUE = {"one", "found", "other", "others"}
"""Names of variables and parameters that do not say what they contain."""


def vague_names(source: str) -> Iterator[tuple[int, str]]:
    """The lines of variables and parameters with vague names, and the names."""
    tree = ast.parse(source)
    bodies = (statement for item in ast.walk(tree) if isinstance(item, ast.ClassDef) for statement in item.body)
    attributes = {statement.target for statement in bodies if isinstance(statement, ast.AnnAssign)}
    for item in ast.walk(tree):
        if item in attributes:
            continue
        if isinstance(item, ast.arg) and item.arg in VAGUE:
            yield item.lineno, item.arg
        elif isinstance(item, ast.Name) and isinstance(item.ctx, ast.Store) and item.id in VAGUE:
            yield item.lineno, item.id
        elif isinstance(item, (ast.MatchAs, ast.MatchStar, ast.ExceptHandler)) and item.name in VAGUE:
            yield item.lineno, str(item.name)


@pytest.mark.parametrize("folder", ["generator", "tests"])
def test_names_of_variables_say_what_they_contain(folder: str) -> None:
    # code that is copied into the output is left out: its mutants are listed by their text
    files = sorted(file for file in (ROOT / folder).rglob("*.py") if file.parent.name != "runtime")
    assert [
        f"{file.relative_to(ROOT)}:{line}: {name}"
        for file in files
        for line, name in sorted(vague_names(file.read_text("utf-8")))
    ] == []


@pytest.mark.parametrize(
    "source",
    [
        "one = 1",
        "for found in []: pass",
        "[other for other in []]",
        "lambda others: 1",
        "def f(*, one): pass",
        "with f() as found: pass",
        "(other := 1)",
        "match 1:\n    case other: pass",
    ],
)
def test_a_vague_name_is_found(source: str) -> None:
    assert len(list(vague_names(source))) == 1
