"""The golden frames beside a spec."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ..diagnostics.diagnostic import Diagnostic, SpecError
from ..document import ambiguous
from ..document.document import Document, read_document
from ..language.decoder import decode
from ..language.golden_frames import GoldenFramesSpec
from ..language.references import check_references
from ..model.edition import Edition
from ..model.golden_frames import GoldenFrames
from ..resolve.golden_frames import missing_parts, resolve_golden_frames


class GoldenFile(NamedTuple):
    """Golden frames with their document."""

    golden: GoldenFrames
    document: Document


def read_golden_file(file: Path, edition: Edition) -> GoldenFile:
    """The golden frames of an edition. Raises SpecError with all findings, and OSError."""
    document, _ = read_document(file)
    decoded = decode(document, GoldenFramesSpec)
    if contradictions := list(_other_edition(document, decoded.value, edition)):
        raise SpecError(contradictions)
    check_references(document, decoded.names)
    if missing := list(_missing_parts(document, decoded.value, edition)):
        raise SpecError(missing)
    return GoldenFile(resolve_golden_frames(edition, decoded.value), document)


def _other_edition(document: Document, golden: GoldenFramesSpec, edition: Edition) -> Iterator[Diagnostic]:
    """A finding for a family or an edition that differs from that of the spec."""
    for key, written, expected in (
        ("family", golden.family, edition.family),
        ("edition", golden.edition, edition.name),
    ):
        if written != expected:
            text = f"the {key} of the spec beside this file is `{expected}`"
            yield document.finding((key,), "other-edition", text, f"write {key}: {as_yaml(expected)}")


def _missing_parts(document: Document, golden: GoldenFramesSpec, edition: Edition) -> Iterator[Diagnostic]:
    """A finding for each frame without a node or an id that the spec does not determine."""
    for part in missing_parts(edition, golden):
        path = ("frames", part.position, part.key)
        yield document.finding(path, "missing-key", part.text, f"write `{part.key}`, as in the source of the frame")


def as_yaml(text: str) -> str:
    """A text as a YAML scalar, in quotes if necessary."""
    return f'"{text}"' if text.replace(".", "", 1).isdigit() or ambiguous.ambiguity(text) else text
