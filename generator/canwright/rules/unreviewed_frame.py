"""Every golden frame has a source."""

from __future__ import annotations

from ..model.formatting import counted
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    if subject.frames is None or not (paths := subject.frames.unreviewed):
        return
    text = (
        f"{counted(len(paths), 'golden frame')} without `source`: unreviewed, so no evidence that the spec is correct"
    )
    hint = "compare the entry with the manual or another source, then name it: source: manual"
    yield Finding(paths[0], text, hint, in_frames=True)
