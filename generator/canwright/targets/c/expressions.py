"""C expressions as text, with parentheses that make their precedence explicit."""

from __future__ import annotations

from collections.abc import Iterable


def operand(expression: str) -> str:
    """An expression in parentheses if it has an operator outside of parentheses; operators have spaces around them."""
    depth = 0
    for character in expression:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == " " and depth == 0:
            return f"({expression})"
    return expression


def joined(operator: str, terms: Iterable[str]) -> str:
    """Terms with one operator between them; a single term is unchanged."""
    every = list(terms)
    return every[0] if len(every) == 1 else f" {operator} ".join(map(operand, every))
