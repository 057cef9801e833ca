"""Document to concepts, in one pass, with a position for every finding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from ..diagnostics.diagnostic import Diagnostic, DocumentPath
from ..document.document import Document
from .concept import Concept, keys
from .findings import Findings
from .forms import INVALID, ConceptForm, Location

C = TypeVar("C", bound=Concept)


@dataclass(frozen=True)
class DecodedDocument(Generic[C]):
    """A decoded document; `invalid` are the paths of omitted values. `value` is None for a file of another kind."""

    value: C | None
    findings: tuple[Diagnostic, ...]
    invalid: frozenset[DocumentPath]


def decode(document: Document, concept: type[C]) -> DecodedDocument[C]:
    """The document as an instance of `concept`, with every structural finding."""
    other = _other_file(document, concept)
    if other:
        return DecodedDocument(None, (*document.findings, other), frozenset({()}))
    report = Findings(document)
    value = INVALID if report.is_unreadable(()) else ConceptForm(concept).decode(report, document.data, Location(()))
    return DecodedDocument(None if value is INVALID else value, tuple(report.findings), frozenset(report.invalid))


def _other_file(document: Document, concept: type[Concept]) -> Diagnostic | None:
    """A finding when this is a file of another kind."""
    data, (key, message, hint) = document.data, concept.other
    if not isinstance(data, dict):
        return None
    if key in data and not {"commands", "frames"} - {key} & set(data):
        return document.finding((key,), "missing-key", message, hint, key=True)
    needed = [name for name, key in keys(concept).items() if key.required]
    if needed and not (set(data) | {path[0] for path in document.unreadable if path}) & set(needed):
        message = f"this file has none of the required keys {', '.join(f'`{name}`' for name in needed)}"
        return document.finding((), "missing-key", message, "start with `canwright: 1`")
    return None
