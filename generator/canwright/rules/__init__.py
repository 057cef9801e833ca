"""Rules about a spec, one in each module, listed in one table with the rules that loading and resolving check."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..diagnostics.diagnostic import Severity
from ..resolve.doubts import Depth, Doubts
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
    Rule(
        "too-large",
        "A spec has at most 5000 commands, 64 combinations of choices and 2500000 generated lines.",
        too_large.check,
    ),
    Rule(
        "overlap",
        "Fields and keys of one message do not overlap.",
        overlap.check,
        whole=True,
        depth=Depth.FRAMES,
    ),
    Rule(
        "beyond-frame",
        "Every field lies within the data bytes or the bits of the id.",
        beyond_frame.check,
        whole=True,
        depth=Depth.FRAMES,
    ),
    Rule("beyond-width", "Ranges and constants fit the width of their type.", beyond_width.check),
    Rule("zero-scale", "A scale is not 0.", zero_scale.check),
    Rule(
        "member-value",
        "The values of an enum and the bits of flags are distinct and fit the width of the type.",
        member_value.check,
    ),
    Rule("mixed-type", "A type is either a number, an enum or flags.", mixed_type.check),
    Rule(
        "parameter-range",
        "The limits of a parameter allow a value, and its choices are distinct.",
        parameter_range.check,
    ),
    Rule("repeated-value", "A list of names or codes has no duplicates.", repeated_value.check),
    Rule("reserved-word", "A reserved word of the language is not used as a name.", reserved_word.check),
    Rule(
        "duplicate-code",
        "No two commands of one address have the same code.",
        duplicate_code.check,
        whole=True,
        depth=Depth.CODES,
    ),
    Rule(
        "duplicate-name",
        "The names of commands, layouts and errata are unique.",
        duplicate_name.check,
        whole=True,
        depth=Depth.CODES,
    ),
    Rule(
        "ambiguous-message",
        "Messages that a receiver cannot distinguish have one layout.",
        ambiguous_message.check,
        whole=True,
        depth=Depth.BITS,
    ),
    Rule(
        "id-collision",
        "No id belongs to two addresses of one direction, unless all their ids are equal.",
        id_collision.check,
        whole=True,
        depth=Depth.CODES,
    ),
    Rule(
        "id-bits",
        "Fields and selectors in the id do not use bits of the address.",
        id_bits.check,
        whole=True,
        depth=Depth.FRAMES,
    ),
    Rule("unknown-node", "The nodes in `from_each` are nodes of the address.", unknown_node.check, whole=True),
    Rule(
        "node-field",
        "The field that contains the node is an unsigned number without a scale, and always exists.",
        node_field.check,
    ),
    Rule(
        "name-collision",
        "Different items have different names in every target, such as C or Python.",
        name_collision.check,
        whole=True,
        depth=Depth.CODES,
    ),
    Rule(
        "frame-contradiction",
        "Golden frames decode and encode as listed.",
        frame_contradiction.check,
        whole=True,
        of_frames=True,
    ),
    Rule(
        "refused-contradiction",
        "Golden frames and values listed under `refused` are rejected for the listed reason.",
        refused_contradiction.check,
        whole=True,
        of_frames=True,
    ),
    Rule(
        "exchange-contradiction",
        "The exchanges in golden frames are accepted or rejected as listed.",
        exchange_contradiction.check,
        whole=True,
        of_frames=True,
    ),
    Rule(
        "missing-frame",
        "Every request and reply has a golden frame.",
        missing_frame.check,
        WARNING,
        whole=True,
        of_frames=True,
    ),
    Rule("missing-manual", "Every command has the section of the manual.", missing_manual.check, WARNING),
    Rule(
        "differing-quantity",
        "All types of a quantity have one unit and scale, or a reason in `differs`.",
        differing_quantity.check,
        WARNING,
    ),
    Rule("unused", "Every item that a spec defines is used.", unused.check, WARNING, whole=True),
    Rule("long-name", "A name does not exceed the maximum length of a target, such as DBC.", long_name.check, WARNING),
)

EVERY: dict[str, Rule] = {rule.id: rule for rule in (*READING, *RULES)}
"""All rules by id, those of reading first."""


def check(subject: Subject, doubts: Doubts, *phases: Phase) -> Iterator[tuple[Rule, Finding]]:
    """Everything that the rules of some phases find; those that need the `whole` spec look at what is certain of it."""
    certain = {depth: subject._replace(edition=doubts.certain(subject.edition, depth)) for depth in Depth}
    rules = sorted((rule for rule in RULES if rule.phase in phases), key=lambda rule: phases.index(rule.phase))

    def found(rule: Rule) -> Iterable[Finding]:
        return rule.check(certain[rule.depth] if rule.whole else subject) if rule.check else ()

    for rule in rules:
        yield from ((rule, finding) for finding in found(rule))
