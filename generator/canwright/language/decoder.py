"""A document as the classes of the language: one pass, every finding with its position."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Generic, TypeVar

from ..diagnostics.diagnostic import MOST_FINDINGS, Diagnostic, DocumentPath
from ..document.document import Document
from .concept import Concept, keys
from .forms import INVALID, Mapped, Place

C = TypeVar("C", bound=Concept)


@dataclass(frozen=True)
class Decoded(Generic[C]):
    """What a document contains; `invalid` are the paths of what is left out. `value` is None for something else."""

    value: C | None
    findings: tuple[Diagnostic, ...]
    invalid: frozenset[DocumentPath]


def decode(document: Document, concept: type[C]) -> Decoded[C]:
    """The document as an instance of `concept`, with every structural finding."""
    other = _other_file(document, concept)
    if other:
        return Decoded(None, (*document.findings, other), frozenset({()}))
    report = _Findings(document)
    value = INVALID if report.is_unreadable(()) else Mapped(concept).decode(report, document.data, Place(()))
    return Decoded(None if value is INVALID else value, tuple(report.findings), frozenset(report.invalid))


def _other_file(document: Document, concept: type[Concept]) -> Diagnostic | None:
    """A finding when this is a file of another kind."""
    data, (key, message, hint) = document.data, concept.other
    if not isinstance(data, dict):
        return None
    if key in data and not {"commands", "frames"} - {key} & set(data):
        return document.finding((key,), "missing-key", message, hint, key=True)
    needed = [name for name, key in keys(concept).items() if key.required]
    if not (set(data) | {path[0] for path in document.unreadable if path}) & set(needed):
        message = f"none of {', '.join(f'`{name}`' for name in needed)} is here, so this is something else"
        return document.finding((), "missing-key", message, "`canwright: 1` comes first")
    return None


class _Findings:
    """Collects the findings about a document, and the paths of what is invalid."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self.findings = list(document.findings)
        self.invalid = set(document.unreadable)
        self._most = len(self.findings) + MOST_FINDINGS

    def finding(
        self, path: DocumentPath, rule: str, message: str, hint: str = "", *, key: bool = False, about: str = ""
    ) -> None:
        self.invalid.add((*path, about) if about else path)
        if len(self.findings) < self._most:
            message = message[:1].lower() + message[1:]
            self.findings.append(self._document.finding(path, rule, message, hint, key=key))

    def is_unreadable(self, path: DocumentPath) -> bool:
        return path in self._document.unreadable

    def has_unreadable_key(self, path: DocumentPath, data: Mapping[str, Any]) -> bool:
        return any(one[:-1] == path and one and one[-1] not in data for one in self._document.unreadable)

    def is_type(self, name: object) -> bool:
        data = self._document.data
        types = data.get("types") if isinstance(data, dict) else None
        return isinstance(types, dict) and name in types

    def written(self, path: DocumentPath, value: object, *, key: bool = False) -> str:
        """A number as it stands in the file: 0x80 and not 128."""
        if not key and (isinstance(value, bool) or not isinstance(value, (int, Decimal))):
            return str(value)
        at = self._document.position(path, key=key)
        text = at.text[at.column - 1 :][: at.length].strip("'\"")
        return text if text and len(text) < 40 else str(value)
