"""Types, style, complexity, names and the order of imports."""

from __future__ import annotations

import ast
import subprocess
import symtable
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


class ComprehensionsAsGenerators(ast.NodeTransformer):
    """Gives each comprehension a scope of its own in every Python: 3.12 and newer merge it with that of its function. What
    was a generator is in a lambda, so that it does not count."""

    def visit_ListComp(self, node: ast.ListComp | ast.SetComp) -> ast.expr:
        self.generic_visit(node)
        return ast.GeneratorExp(node.elt, node.generators)

    def visit_SetComp(self, node: ast.SetComp) -> ast.expr:
        return self.visit_ListComp(node)

    def visit_DictComp(self, node: ast.DictComp) -> ast.expr:
        self.generic_visit(node)
        return ast.GeneratorExp(ast.Tuple([node.key, node.value], ast.Load()), node.generators)

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> ast.expr:
        self.generic_visit(node)
        return ast.parse(f"lambda: {ast.unparse(node)}", mode="eval").body


def comprehensions(scope: symtable.SymbolTable) -> Iterator[symtable.SymbolTable]:
    """The comprehensions that Python 3.12 and newer execute as part of a function."""
    for child in scope.get_children():
        if child.get_name() == "genexpr":
            yield child
            yield from comprehensions(child)


def masked_globals(scope: symtable.SymbolTable) -> Iterator[str]:
    """Names that a comprehension assigns and another one of the same function reads as a global: Python 3.12.0 to 3.12.3
    take the second for the first (python/cpython#118513) and raise UnboundLocalError."""
    if scope.get_type() == "function" and scope.get_name() != "genexpr":
        symbols = [symbol for table in comprehensions(scope) for symbol in table.get_symbols()]
        assigned = {symbol.get_name() for symbol in symbols if symbol.is_assigned()}
        masked = assigned & {symbol.get_name() for symbol in symbols if symbol.is_global()}
        yield from (f"{name} in {scope.get_name()}" for name in sorted(masked))
    for child in scope.get_children():
        yield from masked_globals(child)


def masked_globals_of(source: str) -> list[str]:
    tree = ComprehensionsAsGenerators().visit(ast.parse(source))
    return list(masked_globals(symtable.symtable(ast.unparse(tree), "source", "exec")))


@pytest.mark.parametrize("folder", ["generator", "generated", "tests"])
def test_comprehensions_mask_no_global_that_others_read(folder: str) -> None:
    files = [file for file in sorted((ROOT / folder).rglob("*.py")) if "__pycache__" not in file.parts]
    assert files
    assert [
        f"{file.relative_to(ROOT)}: {masked}" for file in files for masked in masked_globals_of(file.read_text("utf-8"))
    ] == []


@pytest.mark.parametrize(
    ("statements", "masked"),
    [
        ("[g for g in []]; return [g(x) for x in [1]]", True),
        ("[[g for g in []] for y in []]; return {x: g(x) for x in [1]}", True),
        ("{g for g in []}; return [[g(z) for z in [1]] for x in [1]]", True),
        ("return [[g for g in []] + [g(y) for y in [1]] for x in [1]]", True),
        ("[g for g in []]; return g(1)", False),
        ("list(g for g in []); return [g(x) for x in [1]]", False),
        ("g = str; [g for g in []]; return [g(x) for x in [1]]", False),
    ],
)
def test_a_masked_global_is_found(statements: str, masked: bool) -> None:
    """The cases raise UnboundLocalError in Python 3.12.1, or do not."""
    source = f"def g(x): return x\ndef f():\n    {statements}\n"
    assert bool(masked_globals_of(source)) is masked
