"""Findings of the resolvers, and the limits of what they resolve."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from enum import Enum

from ..diagnostics.diagnostic import DocumentPath, SpecError
from ..document.document import Document
from ..language.findings import Findings

MAX_COMMANDS = 3000
"""The maximum number of commands; a command with a table counts once for each entry."""
MAX_FIELDS = 20_000
"""The maximum number of fields that a spec defines; an array counts once for each element."""
MAX_REPLIES = 100_000
"""The maximum number of nodes in all `from_each`, because outputs list each of them."""


class Limited(Enum):
    """What is limited before its size is known, because resolving it would take too long: maximum and description."""

    COMMANDS = MAX_COMMANDS, "commands, with one for each table entry"
    FIELDS = MAX_FIELDS, "fields, with one for each element of an array"
    REPLIES = MAX_REPLIES, "nodes in `from_each`, with those of each table entry"


class Report(Findings):
    """The findings of the resolvers."""

    def __init__(self, document: Document, languages: Sequence[str]) -> None:
        super().__init__(document, languages)
        self._counts: Counter[Limited] = Counter()

    def count(self, what: Limited, number: int, path: DocumentPath) -> None:
        """Counts items. Raises SpecError at the first one above the maximum."""
        self._counts[what] += number
        most, description = what.value
        if self._counts[what] > most:
            text = f"the number of {description}, exceeds the maximum of {most}"
            hint = "split the protocol into several specs; this is the first one above the maximum"
            raise SpecError([self._document.finding(path, "too-large", text, hint, key=True)])
