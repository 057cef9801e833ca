"""One rule a file, listed in one table; behind them what is found while a spec is read."""

from __future__ import annotations

from collections.abc import Iterator

from ..diagnostics.diagnostic import Severity
from . import (
    ambiguous_message,
    beyond_frame,
    beyond_width,
    differing_quantity,
    duplicate_code,
    duplicate_name,
    exchange_contradiction,
    frame_contradiction,
    id_bits,
    id_collision,
    long_name,
    member_value,
    missing_frame,
    missing_manual,
    mixed_type,
    name_collision,
    node_field,
    overlap,
    parameter_range,
    refused_contradiction,
    repeated_value,
    reserved_word,
    too_large,
    unknown_node,
    unused,
    zero_scale,
)
from .reading_catalogue import READING
from .rule import Finding as Finding, Phase as Phase, Rule as Rule, Subject as Subject

WARNING = Severity.WARNING

RULES: tuple[Rule, ...] = (
    Rule("too-large", "A spec has at most 5000 commands, 64 combinations of choices, 2500000 lines.", too_large.check),
    Rule(
        "overlap",
        "No two fields of one message share a bit, nor a field and a key, nor two keys.",
        overlap.check,
    ),
    Rule(
        "beyond-frame",
        "Every field lies within the data bytes, or the bits of the id.",
        beyond_frame.check,
    ),
    Rule("beyond-width", "A range and a constant lie within what the bits hold.", beyond_width.check),
    Rule("zero-scale", "A scale is not zero.", zero_scale.check),
    Rule("member-value", "The values of an enum and the bits of flags are distinct and fit.", member_value.check),
    Rule("mixed-type", "A type is a number, an enum or flags: one of them.", mixed_type.check),
    Rule("parameter-range", "Limits leave room, and choices do not repeat.", parameter_range.check),
    Rule("repeated-value", "A list of names or codes has each once.", repeated_value.check),
    Rule("reserved-word", "A word of the language is not used as a name.", reserved_word.check),
    Rule(
        "duplicate-code",
        "No two commands of one address have the same code.",
        duplicate_code.check,
        phase=Phase.CODES,
    ),
    Rule(
        "duplicate-name",
        "Commands, layouts and errata have names of their own.",
        duplicate_name.check,
        phase=Phase.CODES,
    ),
    Rule(
        "ambiguous-message",
        "Two messages that a receiver cannot tell apart have one layout.",
        ambiguous_message.check,
        phase=Phase.WHOLE,
    ),
    Rule(
        "id-collision",
        "No id belongs to two addresses of one direction, unless all their ids are the same.",
        id_collision.check,
        phase=Phase.WHOLE,
    ),
    Rule(
        "id-bits",
        "Fields and selectors in the id leave the bits of the address alone.",
        id_bits.check,
    ),
    Rule("unknown-node", "The nodes that reply are nodes of their address.", unknown_node.check, phase=Phase.WHOLE),
    Rule("node-field", "The field that holds the node is one bare number, and always there.", node_field.check),
    Rule(
        "name-collision",
        "No two names become one in a target, as in C or Python.",
        name_collision.check,
        phase=Phase.CODES,
    ),
    Rule(
        "frame-contradiction",
        "Golden frames mean what the spec says.",
        frame_contradiction.check,
        phase=Phase.FRAMES,
    ),
    Rule(
        "refused-contradiction",
        "What golden frames say is refused, the spec refuses as they say.",
        refused_contradiction.check,
        phase=Phase.FRAMES,
    ),
    Rule(
        "exchange-contradiction",
        "A golden reply answers a request, or does not, as the spec says.",
        exchange_contradiction.check,
        phase=Phase.FRAMES,
    ),
    Rule(
        "missing-frame",
        "Every request and reply has a golden frame.",
        missing_frame.check,
        WARNING,
        phase=Phase.COVERAGE,
    ),
    Rule("missing-manual", "Every command names its section of the manual.", missing_manual.check, WARNING),
    Rule("differing-quantity", "One quantity has one unit and scale, or a reason.", differing_quantity.check, WARNING),
    Rule("unused", "What a spec defines is used.", unused.check, WARNING, Phase.COVERAGE),
    Rule("long-name", "A name is short enough for every target, as for a DBC file.", long_name.check, WARNING),
)

EVERY: dict[str, Rule] = {rule.id: rule for rule in (*READING, *RULES)}
"""All rules by id, those of reading first."""


def check(subject: Subject, phase: Phase) -> Iterator[tuple[Rule, Finding]]:
    """All findings of the rules of a phase."""
    for rule in RULES:
        if rule.check and rule.phase is phase:
            yield from ((rule, finding) for finding in rule.check(subject))
