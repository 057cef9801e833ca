"""Rules about a spec, one in each module, listed in one table with the rules that loading and resolving check.

Belongs here: what makes a valid spec wrong or unclear, as findings; `checker` runs the rules phase by phase. Each has an
incorrect and a correct example in `examples/`. Imports `diagnostics`, `document`, `model`, `language`, `semantics`,
`resolve` and the registry of `targets`.
"""

from __future__ import annotations

from ..diagnostics.diagnostic import Severity
from ..resolve.report import MAX_COMMANDS, MAX_FIELDS
from . import (
    ambiguous_message,
    beyond_frame,
    beyond_width,
    bit_number,
    deprecation_period,
    differing_quantity,
    duplicate_code,
    duplicate_name,
    exchange_contradiction,
    file_name,
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
from .reading_catalogue import LOAD_RULES
from .rule import Phase, Rule

WARNING = Severity.WARNING

RULES: tuple[Rule, ...] = (
    Rule(
        "too-large",
        f"A spec has at most {MAX_COMMANDS} commands, {MAX_FIELDS} fields, {too_large.MAX_COMBINATIONS} combinations of "
        f"choices and a size of {too_large.MAX_SIZE}, which is the sum of the sizes of its parts.",
        too_large.check,
        phase=Phase.SIZE,
    ),
    Rule(
        "overlap",
        "Fields and keys of one message do not overlap.",
        overlap.check,
    ),
    Rule(
        "beyond-frame",
        "Every field lies within the data bytes or the bits of the id.",
        beyond_frame.check,
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
    Rule(
        "deprecation-period",
        "The end of a deprecation is not before its start, and its dates exist.",
        deprecation_period.check,
    ),
    Rule("repeated-value", "A list of names or codes has no duplicates.", repeated_value.check),
    Rule("reserved-word", "A reserved word of the language is not used as a name.", reserved_word.check),
    Rule(
        "file-name",
        "Families, editions and commands have names that files can have on every system.",
        file_name.check,
    ),
    Rule(
        "duplicate-code",
        "No two commands of one address have the same code.",
        duplicate_code.check,
    ),
    Rule(
        "duplicate-name",
        "The names of commands, layouts and errata are unique.",
        duplicate_name.check,
    ),
    Rule(
        "ambiguous-message",
        "Messages that a receiver cannot distinguish have one layout.",
        ambiguous_message.check,
        phase=Phase.WHOLE,
    ),
    Rule(
        "id-collision",
        "No id belongs to two addresses, or to a request and a reply of different nodes.",
        id_collision.check,
        phase=Phase.WHOLE,
    ),
    Rule(
        "id-bits",
        "Fields and selectors in the id do not use bits of the address.",
        id_bits.check,
    ),
    Rule("unknown-node", "The nodes in `from_each` are nodes of the address.", unknown_node.check, phase=Phase.WHOLE),
    Rule(
        "node-field",
        "The field that contains the node is an unsigned number without a scale, and always exists.",
        node_field.check,
    ),
    Rule(
        "name-collision",
        "Different items have different names in every target, such as C, which compares 63 characters, or Python.",
        name_collision.check,
    ),
    Rule(
        "frame-contradiction",
        "Golden frames decode and encode as listed.",
        frame_contradiction.check,
        phase=Phase.FRAMES,
    ),
    Rule(
        "refused-contradiction",
        "Golden frames and values listed under `refused` are rejected for the listed reason.",
        refused_contradiction.check,
        phase=Phase.FRAMES,
    ),
    Rule(
        "exchange-contradiction",
        "The exchanges in golden frames are accepted or rejected as listed.",
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
    Rule("missing-manual", "Every command has the section of the manual.", missing_manual.check, WARNING),
    Rule(
        "differing-quantity",
        "All types of a quantity have one unit and scale, or a reason in `differs`.",
        differing_quantity.check,
        WARNING,
    ),
    Rule(
        "bit-number",
        "The position of a big-endian field or selector of less than a byte has the number of a bit.",
        bit_number.check,
        WARNING,
    ),
    Rule("unused", "Every item that a spec defines is used.", unused.check, WARNING, Phase.COVERAGE),
    Rule("long-name", "A name does not exceed the maximum length of a target, such as DBC.", long_name.check, WARNING),
)

ALL_RULES: dict[str, Rule] = {rule.id: rule for rule in (*LOAD_RULES, *RULES)}
"""All rules by id, those of reading first."""
