"""Mutants of Python modules: one expression or statement changed, found in the syntax tree, replaced in the text."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator

from .mutants import Mutant, make_mutant

_ORDER = ((ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn))
COMPARISONS: dict[type[ast.cmpop], ast.cmpop] = {
    old: new() for pair in _ORDER for old, new in itertools.permutations(pair)
}
_PAIRS = ((ast.Add, ast.Sub), (ast.Mult, ast.FloorDiv), (ast.BitOr, ast.BitAnd), (ast.LShift, ast.RShift))
OPERATORS: dict[type[ast.operator], ast.operator] = {
    old: new() for pair in _PAIRS for old, new in itertools.permutations(pair)
}
OPERATORS |= {ast.Div: ast.Mult(), ast.Mod: ast.Mult(), ast.BitXor: ast.BitOr()}
WORDS = {"little": "big", "big": "little"}

_FORMAT = re.compile(r"[<>][0-9xbBhHiIlLqQfds]+")


def mutants(file: str, text: str) -> list[Mutant]:
    """All mutants of a module."""
    return list(_Finder(file, text).all())


class _Finder:
    def __init__(self, file: str, text: str) -> None:
        self._file, self._text = file, text
        self._scope = text
        self._outside: ast.stmt | None = None
        """The statement outside of functions and classes that is mutated: all its lines identify a mutant."""
        self._lines = [0]
        for line in text.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))
        self._bytes = [line.encode() for line in text.splitlines(keepends=True)]

    def all(self) -> Iterator[Mutant]:
        yield from self._in(ast.parse(self._text).body, "", 0)

    def _in(self, nodes: list[ast.stmt], function: str, line: int) -> Iterator[Mutant]:
        for node in nodes:
            if isinstance(node, (ast.Import, ast.ImportFrom)) or _is_docstring(node) or _is_for_types(node):
                continue
            self._outside = None if function or isinstance(node, (ast.FunctionDef, ast.ClassDef)) else node
            if isinstance(node, ast.FunctionDef):
                for default in (*node.args.defaults, *(d for d in node.args.kw_defaults if d)):
                    yield from self._expressions(default, function, line)
                first = min((node.lineno, *(d.lineno for d in node.decorator_list)))
                yield from self._in_scope(node, function, first)
            elif isinstance(node, ast.ClassDef):
                yield from self._in_scope(node, function, line)
            elif not _is_listing(node):
                yield from self._statement(node, function, line)
                yield from self._parts(node, function, line)

    def _in_scope(self, node: ast.FunctionDef | ast.ClassDef, function: str, line: int) -> Iterator[Mutant]:
        around, self._scope = self._scope, ast.get_source_segment(self._text, node) or ""
        yield from self._in(node.body, f"{function}.{node.name}".lstrip("."), line)
        self._scope = around

    def _parts(self, node: ast.stmt | ast.excepthandler, function: str, line: int) -> Iterator[Mutant]:
        """The mutants of the expressions and statements of a statement."""
        if isinstance(node, ast.Assign) and _is_text(node.value):
            return
        for field, value in ast.iter_fields(node):
            for part in value if isinstance(value, list) else [value]:
                if isinstance(part, ast.stmt):
                    yield from self._in([part], function, line)
                elif isinstance(part, ast.excepthandler):
                    yield from self._parts(part, function, line)
                elif isinstance(part, ast.AST) and field != "annotation":
                    yield from self._expressions(part, function, line)

    def _statement(self, node: ast.stmt, function: str, line: int) -> Iterator[Mutant]:
        """The statement left out, another result, the opposite condition."""
        if isinstance(node, ast.Assign) and _is_text(node.value):
            return
        is_call = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
        if function and (is_call or isinstance(node, (ast.Assign, ast.AugAssign, ast.Raise, ast.Continue, ast.Break))):
            yield self._replaced(node, "pass", function, line)
        if isinstance(node, ast.Return) and node.value is not None and not _is_none(node.value):
            yield self._replaced(node, "return None", function, line)
        if isinstance(node, (ast.If, ast.While)):
            yield self._replaced(node.test, f"not ({ast.unparse(node.test)})", function, line)

    def _expressions(self, node: ast.AST, function: str, line: int) -> Iterator[Mutant]:
        if isinstance(node, ast.JoinedStr):
            return
        for new in _others(node):
            assert isinstance(node, ast.expr)
            yield self._replaced(node, new, function, line)
        for child in ast.iter_child_nodes(node):
            yield from self._expressions(child, function, line)

    def _offset(self, line: int, column: int) -> int:
        return self._lines[line - 1] + len(self._bytes[line - 1][:column].decode())

    def _replaced(self, node: ast.expr | ast.stmt, new: str, function: str, line: int) -> Mutant:
        assert node.end_lineno is not None and node.end_col_offset is not None
        start = self._offset(node.lineno, node.col_offset)
        end = self._offset(node.end_lineno, node.end_col_offset)
        whole = self._outside or node
        low = self._lines[whole.lineno - 1]
        high = self._text.find("\n", self._offset(whole.end_lineno or 0, whole.end_col_offset or 0))
        changes = ((start, end, new),)
        return make_mutant(
            self._file, self._text, changes, (low, high), function=function, scope=self._scope, line=line
        )


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _is_for_types(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.If)
        and "TYPE_CHECKING" in ast.unparse(node.test)
        and not node.orelse
        and (not isinstance(node.test, ast.UnaryOp))
    )


def _is_listing(node: ast.stmt) -> bool:
    """Whether a statement lists names: of what a module exports, of slots."""
    return isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) in ("__all__", "__slots__", "__match_args__")


def _is_text(node: ast.expr) -> bool:
    """Whether an expression makes a part of the text of a message, or a type variable."""
    parts = list(ast.walk(node))
    return any(isinstance(part, ast.JoinedStr) or getattr(part, "id", "") == "TypeVar" for part in parts)


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _others(node: ast.AST) -> Iterator[str]:
    """What an expression is replaced by."""
    if isinstance(node, ast.Compare):
        for place, operator in enumerate(node.ops):
            ops = [*node.ops[:place], COMPARISONS[type(operator)], *node.ops[place + 1 :]]
            yield f"({ast.unparse(ast.Compare(node.left, ops, node.comparators))})"
    elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        yield f"({ast.unparse(ast.BinOp(node.left, OPERATORS[type(node.op)], node.right))})"
    elif isinstance(node, ast.BoolOp):
        opposite = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        yield f"({ast.unparse(ast.BoolOp(opposite, node.values))})"
    elif isinstance(node, ast.UnaryOp):
        yield f"({ast.unparse(node.operand)})"
    elif isinstance(node, ast.IfExp):
        yield f"({ast.unparse(ast.IfExp(node.test, node.orelse, node.body))})"
    elif isinstance(node, ast.Constant):
        yield from _constants(node.value)


def _constants(value: object) -> Iterator[str]:
    if isinstance(value, bool):
        yield repr(not value)
    elif isinstance(value, int):
        yield from (repr(number) for number in ((value + 1, value - 1) if value else (1,)))
    elif isinstance(value, float):
        yield repr(value + 1.0)
    elif isinstance(value, str) and value in WORDS:
        yield repr(WORDS[value])
    elif isinstance(value, str) and _FORMAT.fullmatch(value):
        if set("hHiIlLqQfd") & set(value):  # bytes have no order
            yield repr({"<": ">", ">": "<"}[value[0]] + value[1:])
        for place, letter in enumerate(value):
            if letter in "bBhHiIqQ":
                yield repr(value[:place] + letter.swapcase() + value[place + 1 :])
