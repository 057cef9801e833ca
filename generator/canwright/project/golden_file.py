"""The golden frames beside a spec: those that can be read, where they stand, and what is amiss with the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..diagnostics.diagnostic import Diagnostic, DocumentPath, SpecError, nearest
from ..document import ambiguous
from ..document.document import Document, read_document
from ..language.golden_frames import TAGS, GoldenFrames
from ..language.validate import validate_parts

LISTS = ("frames", "refused", "exchanges")
LOST = {"": ""}
"""In place of sources that could not be read."""
_ASIDE: Mapping[str, tuple[str, ...]] = {"frames": ("note", "values"), "refused": ("note",), "exchanges": ("note",)}
"""Keys of entries without which the rest of an entry is judged all the same."""
_LACKING: Mapping[str, object] = {"canwright": 1, "family": "lost", "edition": "", "sources": LOST, "frames": []}
"""What stands in for what could not be read, so that the rest is judged."""


def _as_text(text: str) -> str:
    """A text as YAML: in quotes where it would be a number without."""
    return f'"{text}"' if text.replace(".", "", 1).isdigit() or ambiguous.ambiguity(text) else text


@dataclass(frozen=True)
class Beside:
    """Golden frames; None when there are none, or none that can be judged.

    `places` are where their entries stand in the document, by list: some between them may not have been readable.
    """

    golden: GoldenFrames | None = None
    document: Document | None = None
    findings: tuple[Diagnostic, ...] = ()
    places: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    def path(self, path: DocumentPath) -> DocumentPath:
        """Where something in `golden` stands in the document."""
        key, *rest = path or ("",)
        if not rest or not isinstance(rest[0], int) or key not in self.places:
            return path
        return (key, self.places[str(key)][rest[0]], *rest[1:])

    def beside(self, said: Mapping[str, str]) -> Beside:
        """These frames beside a spec that says so of its family and edition; without them where they say otherwise."""
        others = [
            self.document.finding(
                (key,), "other-edition", f"these frames stand beside {key} `{wanted}`", f"{key}: {_as_text(wanted)}"
            )
            for key, wanted in said.items()
            if self.golden and self.document and getattr(self.golden, key) not in (wanted, self._lacking(key))
        ]
        return replace(self, golden=None, findings=(*self.findings, *others)) if others else self

    def _lacking(self, key: str) -> object:
        """What stands in for a key that could not be read."""
        return _LACKING[key] if self.places else None

    def commands(self, path: DocumentPath) -> tuple[str, ...] | None:
        """The commands that an entry is about; None when it is about all of them."""
        key, *rest = path or ("",)
        entries = getattr(self.golden, str(key), ()) if key in LISTS else ()
        entry = entries[rest[0]] if rest and isinstance(rest[0], int) else None
        name = getattr(entry, "command", "")
        return (name,) if isinstance(name, str) and name else None


def read(file: Path) -> Beside:
    """The golden frames in a file. Raises OSError."""
    try:
        document, _ = read_document(file)
    except SpecError as error:
        return Beside(findings=error.diagnostics)
    found = validate_parts(document, GoldenFrames)
    golden = found.spec
    places: dict[str, tuple[int, ...]] = {}
    if golden is None or found.diagnostics:
        golden, places = _readable(document)
    beside = Beside(golden, document, found.diagnostics, places)
    if golden is None or golden.sources == LOST:
        return beside
    return replace(beside, findings=(*found.diagnostics, *_unknown_sources(beside, golden, document)))


def _unknown_sources(beside: Beside, golden: GoldenFrames, document: Document) -> Iterator[Diagnostic]:
    """Each source that is not there, where it is named first."""
    used: dict[str, list[DocumentPath]] = {}
    for key in LISTS:
        for i, entry in enumerate(getattr(golden, key)):
            used.setdefault(entry.source, []).append(beside.path((key, i, "source")))
    for name, paths in used.items():
        if name not in golden.sources:
            more = f", which {len(paths)} entries name" if len(paths) > 1 else ""
            hint = nearest(name, golden.sources) or f"say under `sources` what it is: {{{name}: …}}"
            yield document.finding(paths[0], "unknown-reference", f"there is no source `{name}`{more}", hint)


def _readable(document: Document) -> tuple[GoldenFrames | None, dict[str, tuple[int, ...]]]:
    """As many golden frames of a document as are right, and where they stand."""
    if not isinstance(document.data, dict):
        return None, {}
    every: set[DocumentPath] = set(document.spoilt)
    try:
        GoldenFrames.model_validate(document.data)
    except ValidationError as error:
        every |= {tuple(step for step in found["loc"] if step not in TAGS) for found in error.errors()}
    aside = {path[:3] for path in every if len(path) > 2 and path[2] in _ASIDE.get(str(path[0]), ())}
    spoilt = {path[:2] for path in every if path[:3] not in aside}
    heads = {path[0] for path in spoilt if path and path[0] not in LISTS}
    data: dict[str, Any] = {k: v for k, v in document.data.items() if k in GoldenFrames.model_fields}
    data |= {key: value for key, value in _LACKING.items() if key not in data or key in heads}
    places = {}
    for key in LISTS:
        items = data.pop(key, [])
        places[key] = tuple(i for i in range(len(items)) if (key, i) not in spoilt) if isinstance(items, list) else ()
        lost = {i: {path[2] for path in aside if path[:2] == (key, i)} for i in places[key]}
        data[key] = [{k: v for k, v in items[i].items() if k not in lost[i]} for i in places[key]]
    try:
        return GoldenFrames.model_validate(data), places
    except ValidationError:
        return None, {}
