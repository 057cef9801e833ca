"""One rule a file, listed in one table. A rule looks at a resolved edition and yields what it finds."""

from __future__ import annotations

from collections.abc import Iterator

from ..diagnostics import Diagnostic
from ..model import Edition
from ..source import Document
from . import ambiguous_message, beyond_frame, beyond_width, id_collision, member_value, overlap, zero_scale
from .rule import Rule

RULES: tuple[Rule, ...] = (
    Rule("overlap", "No two fields of one message share a bit, nor a field and a key.", overlap.check),
    Rule("beyond-frame", "Every field lies within the data bytes, or the bits of the id.", beyond_frame.check),
    Rule("beyond-width", "A range lies within what the bits hold.", beyond_width.check),
    Rule("zero-scale", "A scale is not zero.", zero_scale.check),
    Rule("member-value", "The values of an enum and the bits of flags are distinct and fit.", member_value.check),
    Rule(
        "ambiguous-message", "Two messages that a receiver cannot tell apart have one layout.", ambiguous_message.check
    ),
    Rule("id-collision", "No id belongs to two addresses of one direction.", id_collision.check),
)


def check(edition: Edition, document: Document) -> Iterator[Diagnostic]:
    """Everything that all rules find."""
    for rule in RULES:
        for path, message, hint in rule.check(edition):
            yield document.finding(path, rule.id, message, hint)
