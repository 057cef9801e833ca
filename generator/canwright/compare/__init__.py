"""Two editions compared: every change, its category, and who is affected.

Belongs here: matching the items of two editions, the catalogue of changes, and their impact, which follows from frames
that both editions decode (`witnesses`, `verdicts`). What names a target exports is passed in. Imports `diagnostics`,
`model`, `resolve` and `semantics`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..model.edition import Edition
from .catalogue import CHANGES as CHANGES
from .change import Category as Category, Change as Change, Impact as Impact, Item as Item, Side as Side

if TYPE_CHECKING:
    from .exported_names import Exporter

_CATEGORIES, _IMPACTS = list(Category), list(Impact)


def compare(old: Edition, new: Edition, exporters: Sequence[Exporter] = ()) -> tuple[Change, ...]:
    """Every change from `old` to `new`, in the order of the old spec; what surrounds the commands comes first.

    The order of keys makes no difference, except where the first one has a meaning, as that of addresses.
    A renamed item is reported with its names in each of the `exporters`, which are targets.
    """
    from .comparison import changes

    return changes(old, new, exporters)


def by_impact(changes: tuple[Change, ...]) -> tuple[Change, ...]:
    """Silent changes first, then loud ones; within, by category."""
    return tuple(sorted(changes, key=lambda c: (_IMPACTS.index(c.impact), _CATEGORIES.index(c.rule.category))))
