"""Every field lies within the data bytes, or the bits of the id."""

from __future__ import annotations

from ..model import Path, Space
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    seen: set[Path] = set()
    for message in subject.edition.all_messages():
        limit = {Space.DATA: message.dlc * 8, Space.ID: 29 if message.id.extended else 11}
        for field in message.layout.fields:
            last = max(s.byte * 8 + s.low + s.width for e in field.elements for s in e.segments)
            if last > limit[field.space] and field.path not in seen:
                seen.add(field.path)
                there = f"{message.dlc} data bytes" if field.space is Space.DATA else f"{limit[Space.ID]} id bits"
                text = f"`{field.name}` reaches past the {there} of the frame"
                yield Finding(field.path, text, "check `at`, the type and `dlc`")
        for key in message.keys:
            if max(s.byte * 8 + s.low + s.width for s in key.segments) > limit[key.space]:
                text = f"the frame has {message.dlc} data bytes, too few for its selector"
                yield Finding(message.path, text, "check `dlc`")
