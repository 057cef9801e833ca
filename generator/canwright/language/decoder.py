"""Document to concepts, in one pass, with a position for every finding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from ..diagnostics.diagnostic import Diagnostic, SpecError
from ..document.document import Document
from .concept import Concept, keys
from .findings import Findings, Names
from .forms import ConceptForm, Location, declared

C = TypeVar("C", bound=Concept)


@dataclass(frozen=True)
class DecodedDocument(Generic[C]):
    """A decoded document, and the names in it."""

    value: C
    names: Names


def decode(document: Document, concept: type[C]) -> DecodedDocument[C]:
    """The document as an instance of `concept`. Raises SpecError with every structural finding."""
    other_file = _other_file(document, concept)
    if other_file:
        raise SpecError([other_file])
    report = Findings(document, _languages(document, concept))
    value = ConceptForm(concept).decode(report, document.data, Location(()))
    if report.number:
        raise SpecError(report.findings)
    return DecodedDocument(value, report.names)


def _languages(document: Document, concept: type[Concept]) -> list[str]:
    """The languages of the texts of a file; none if they are invalid, which is reported at `languages`."""
    if "languages" not in keys(concept) or not isinstance(document.data, dict):
        return []
    key, form = declared(concept)["languages"]
    findings = Findings(document, [])
    languages = form.decode(findings, document.data.get("languages", key.default), Location(("languages",), key))
    return [] if findings.number else [str(language) for language in languages]


def _other_file(document: Document, concept: type[Concept]) -> Diagnostic | None:
    """A finding when this is a file of another kind."""
    data, (key, message, hint) = document.data, concept.other_file
    if not isinstance(data, dict):
        return None
    if key in data and not {"commands", "frames"} - {key} & set(data):
        return document.finding((key,), "missing-key", message, hint, key=True)
    needed = [name for name, key in keys(concept).items() if key.required]
    if needed and not set(data) & set(needed):
        message = f"this file has none of the required keys {', '.join(f'`{name}`' for name in needed)}"
        return document.finding((), "missing-key", message, "start with `canwright: 1`")
    return None
