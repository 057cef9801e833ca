"""Findings of the decoder."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from typing import Any

from ..diagnostics.diagnostic import MAX_FINDINGS, Diagnostic, DocumentPath, with_number_of_others
from ..document.document import Document


class Findings:
    """The findings about a document; `invalid` are the paths of omitted values."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._listed = list(document.findings)
        self.invalid = set(document.unreadable)
        self._most = len(self._listed) + MAX_FINDINGS
        self._more = 0

    @property
    def is_full(self) -> bool:
        """Whether further findings are only counted."""
        return len(self._listed) >= self._most

    @property
    def findings(self) -> list[Diagnostic]:
        """The findings so far; the last one states how many more there are."""
        return with_number_of_others(self._listed, self._more)

    def finding(
        self, path: DocumentPath, rule: str, message: str, hint: str = "", *, key: bool = False, about: str = ""
    ) -> None:
        """Adds a finding at a path; `about` is a missing key of the mapping at this path."""
        self.invalid.add((*path, about) if about else path)
        if self.is_full:
            self._more += 1
        else:
            message = message[:1].lower() + message[1:]
            self._listed.append(self._document.finding(path, rule, message, hint, key=key))

    def is_unreadable(self, path: DocumentPath) -> bool:
        """Whether the value at a path already has a finding about its YAML."""
        return path in self._document.unreadable

    def has_unreadable_key(self, path: DocumentPath, data: Mapping[str, Any]) -> bool:
        """Whether the mapping at a path has an unreadable key, which is not in its data."""
        return any(one[:-1] == path and one and one[-1] not in data for one in self._document.unreadable)

    def is_type(self, name: object) -> bool:
        """Whether the document defines a type of this name."""
        data = self._document.data
        types = data.get("types") if isinstance(data, dict) else None
        return isinstance(types, dict) and isinstance(name, str) and name in types

    def written(self, path: DocumentPath, value: object, *, key: bool = False) -> str:
        """A number in the notation of the file: 0x80, not 128."""
        if not key and (isinstance(value, bool) or not isinstance(value, (int, Decimal))):
            return str(value)
        at = self._document.position(path, key=key)
        text = at.text[at.column - 1 :][: at.length].strip("'\"")
        return text if text and len(text) < 40 else str(value)
