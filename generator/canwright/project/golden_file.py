"""The golden frames beside a spec, with their findings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..diagnostics.diagnostic import Diagnostic, DocumentPath, SpecError, nearest
from ..document import ambiguous
from ..document.document import Document, read_document
from ..language.decoder import decode
from ..language.golden_frames import GoldenFramesSpec

LISTS = ("frames", "refused", "exchanges")


@dataclass(frozen=True)
class GoldenFile:
    """Golden frames with their document and findings; `golden` is None without a file, or after an error."""

    golden: GoldenFramesSpec | None = None
    document: Document | None = None
    findings: tuple[Diagnostic, ...] = ()

    def other_edition(self, names: Mapping[str, str]) -> Iterator[Diagnostic]:
        """A finding for a family or an edition that differs from that of the spec."""
        data = self.document.data if self.document and isinstance(self.document.data, dict) else {}
        for key, expected in names.items():
            if self.document and isinstance(data.get(key), str) and data[key] != expected:
                text = f"the {key} of the spec beside this file is `{expected}`"
                yield self.document.finding((key,), "other-edition", text, f"write {key}: {_as_yaml(expected)}")


def read_golden_file(file: Path) -> GoldenFile:
    """The golden frames in a file. Raises OSError."""
    try:
        document, _ = read_document(file)
    except SpecError as error:
        return GoldenFile(findings=error.diagnostics)
    decoded = decode(document, GoldenFramesSpec)
    findings = (*decoded.findings, *_unknown_sources(document))
    return GoldenFile(None if findings else decoded.value, document, findings)


def _unknown_sources(document: Document) -> Iterator[Diagnostic]:
    """A finding for each unknown source, at its first use."""
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
            more = f", but {len(paths)} entries use it" if len(paths) > 1 else ""
            hint = nearest(name, sources) or f"define it under `sources`: {{{name}: …}}"
            yield document.finding(paths[0], "unknown-reference", f"there is no source `{name}`{more}", hint)


def _as_yaml(text: str) -> str:
    """A text as a YAML scalar, in quotes if necessary."""
    return f'"{text}"' if text.replace(".", "", 1).isdigit() or ambiguous.ambiguity(text) else text
