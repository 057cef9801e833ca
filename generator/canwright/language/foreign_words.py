"""The words of words.yaml: what authors write instead of words of the language."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence

from ..document.document import read_document
from ..templating.resources import TEMPLATES


@functools.cache
def foreign_words(kind: str) -> Mapping[str, Sequence[str]]:
    """The foreign words for each word of a kind: `keys`, `words`, `units` or `formats`."""
    document, _ = read_document(TEMPLATES / "language" / "words.yaml")
    if not isinstance(document.data, dict):
        raise TypeError(f"{document.name} is not a mapping of words")
    words: Mapping[str, Sequence[str]] = document.data[kind]
    return words


def meant(kind: str, written: str) -> str:
    """The first word of a kind with this foreign word; empty without one."""
    return next((word for word, foreign in foreign_words(kind).items() if written in foreign), "")
