"""Two editions compared: every change, what kind it is, and who is hit by it."""

from __future__ import annotations

from ..model.edition import Edition
from . import commands, edition_changes, renames
from .catalogue import CHANGES as CHANGES
from .change import Category as Category, Change as Change, Impact as Impact, Item as Item, Side as Side
from .collector import Found

_CATEGORIES, _IMPACTS = list(Category), list(Impact)


def compare(old: Edition, new: Edition) -> tuple[Change, ...]:
    """Every change from `old` to `new`, in the order of the specs, what surrounds the commands first."""
    found = Found()
    old = renames.compare(found, old, new)
    edition_changes.compare(found, old, new)
    commands.compare(found, old, new)
    return tuple(found)


def by_impact(changes: tuple[Change, ...]) -> tuple[Change, ...]:
    """Silent changes first, then loud ones; within, by category."""
    return tuple(sorted(changes, key=lambda c: (_IMPACTS.index(c.impact), _CATEGORIES.index(c.rule.category))))
