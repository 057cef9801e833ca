"""Titles of items without one."""

from __future__ import annotations

from collections.abc import Iterable

from ..model import formatting
from ..model.types import ImpliedTitle, Text


def titled(written: Text, name: str) -> Text:
    """A title; without one, the words of a name in every language."""
    return written if any(written.values()) else implied_title(name, written)


def implied_title(name: str, languages: Iterable[str]) -> Text:
    """The title of an item without one: the words of its name in every language."""
    return ImpliedTitle.fromkeys(languages, formatting.spoken(name))
