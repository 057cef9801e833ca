"""Deprecated items, and the order of the editions that are named or dated."""

from __future__ import annotations

import re
from dataclasses import dataclass

_DATE = re.compile(r"[0-9]{4}(-[0-9]{2}){0,2}")


@dataclass(frozen=True, kw_only=True)
class Deprecation:
    """The edition since which an item is deprecated, and the edition or date until which it remains, if it is known."""

    since: str
    until: str | None

    def __str__(self) -> str:
        return f"since {self.since}" + (f", until {self.until}" if self.until else "")

    def allows_removal(self, edition: str, date: str) -> bool | None:
        """Whether an edition with this date, which may be empty, may lack the item; None if the order is not known."""
        if self.until is None:
            return True
        before = is_before(date if date and is_date(self.until) else edition, self.until)
        return None if before is None else not before


def is_date(name: str) -> bool:
    """Whether a text is a year, a month or a day, such as 2023-03-21."""
    return _DATE.fullmatch(name) is not None


def is_before(first: str, second: str) -> bool | None:
    """Whether the name or date of an edition is before another one; None if the order is not known.

    The first different numbers decide: v2.9 is before v2.10. An edition of a label, v2.1-2024, is not before the label.
    """
    parts, second_parts = (re.findall(r"[0-9]+|[^0-9]+", name) for name in (first, second))
    for part, another in zip(parts, second_parts, strict=False):
        if part != another:
            return int(part) < int(another) if part.isdigit() and another.isdigit() else None
    return False if len(parts) >= len(second_parts) else None
