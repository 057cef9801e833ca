"""Every golden frame has a source."""

from __future__ import annotations

from ..model.formatting import counted
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    if subject.frames is None or not (count := subject.frames.unreviewed):
        return
    text = f"{counted(count, 'golden frame')} without `source`: unreviewed, so no evidence that the spec is correct"
    hint = "compare the entry with the manual or another source, then name it: source: manual"
    entries = {
        "frames": subject.frames.frames,
        "refused": subject.frames.refused,
        "exchanges": subject.frames.exchanges,
    }
    first = next((key, i) for key, listed in entries.items() for i, entry in enumerate(listed) if not entry.source)
    yield Finding(first, text, hint, in_frames=True)
