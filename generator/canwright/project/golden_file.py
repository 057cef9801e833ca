"""The golden frames beside a spec, and the findings about them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..diagnostics.diagnostic import Diagnostic, DocumentPath, SpecError, nearest
from ..document import ambiguous
from ..document.document import Document, read_document
from ..language.decoder import decode
from ..language.golden_frames import GoldenFrames

LISTS = ("frames", "refused", "exchanges")


@dataclass(frozen=True)
class GoldenFile:
    """Golden frames; `golden` is None where there are none, or where there is an error."""

    golden: GoldenFrames | None = None
    document: Document | None = None
    findings: tuple[Diagnostic, ...] = ()

    def other_edition(self, names: Mapping[str, str]) -> Iterator[Diagnostic]:
        """A finding for each of family and edition that is another one than the spec's."""
        data = self.document.data if self.document and isinstance(self.document.data, dict) else {}
        for key, wanted in names.items():
            if self.document and isinstance(data.get(key), str) and data[key] != wanted:
                text = f"these frames stand beside {key} `{wanted}`"
                yield self.document.finding((key,), "other-edition", text, f"{key}: {_as_yaml(wanted)}")


def read_golden_file(file: Path) -> GoldenFile:
    """The golden frames in a file. Raises OSError."""
    try:
        document, _ = read_document(file)
    except SpecError as error:
        return GoldenFile(findings=error.diagnostics)
    decoded = decode(document, GoldenFrames)
    findings = (*decoded.findings, *_unknown_sources(document))
    return GoldenFile(None if findings else decoded.value, document, findings)


def _unknown_sources(document: Document) -> Iterator[Diagnostic]:
    """Each source that does not exist, where it is named first."""
    data = document.data if isinstance(document.data, dict) else {}
    sources = data.get("sources")
    if not isinstance(sources, dict) or any(path[:1] == ("sources",) for path in document.unreadable):
        return
    used: dict[str, list[DocumentPath]] = {}
    for key in LISTS:
        for i, entry in enumerate(data[key] if isinstance(data.get(key), list) else ()):
            name = entry.get("source") if isinstance(entry, dict) else None
            if isinstance(name, str) and name and (key, i, "source") not in document.unreadable:
                used.setdefault(name, []).append((key, i, "source"))
    for name, paths in used.items():
        if name not in sources:
            more = f", which {len(paths)} entries name" if len(paths) > 1 else ""
            hint = nearest(name, sources) or f"describe it under `sources`: {{{name}: …}}"
            yield document.finding(paths[0], "unknown-reference", f"there is no source `{name}`{more}", hint)


def _as_yaml(text: str) -> str:
    """A text as YAML: in quotes where it would be a number without."""
    return f'"{text}"' if text.replace(".", "", 1).isdigit() or ambiguous.ambiguity(text) else text
