"""Rules about a spec, one in each module, listed in one table with the rules that loading and resolving check.

Belongs here: what makes a valid spec wrong or unclear, as findings; `checker` runs the rules phase by phase. The first line
of a module is the purpose of its rule, which `canwright explain` shows. Each has an incorrect and a correct example in
`examples/`. Imports `diagnostics`, `document`, `model`, `language`, `semantics`, `resolve` and the registry of `targets`.
"""

from __future__ import annotations

from types import ModuleType

from ..diagnostics.diagnostic import Severity
from . import (
    ambiguous_message,
    beyond_frame,
    beyond_width,
    bit_number,
    checksum_field,
    counter_field,
    deprecation_period,
    differing_quantity,
    duplicate_code,
    duplicate_name,
    ends_motion,
    exchange_contradiction,
    file_name,
    frame_contradiction,
    frame_length,
    frame_number,
    id_bits,
    id_collision,
    long_name,
    member_value,
    missing_frame,
    missing_manual,
    mixed_type,
    name_collision,
    no_value,
    node_field,
    node_variable,
    overlap,
    parameter_range,
    range_step,
    refused_contradiction,
    repeated_value,
    reserved_word,
    too_large,
    unknown_node,
    unreviewed_frame,
    unused,
    wrong_message,
    zero_scale,
)
from .reading_catalogue import LOAD_RULES
from .rule import Phase, Rule


def _rule(module: ModuleType, phase: Phase = Phase.PARTS, severity: Severity = Severity.ERROR) -> Rule:
    """The rule of a module: its name, the first line of its docstring and its `check`."""
    purpose = (module.__doc__ or "").partition("\n\n")[0]
    return Rule(module.__name__.rpartition(".")[2].replace("_", "-"), purpose, module.check, severity, phase)


WARNING = Severity.WARNING

RULES: tuple[Rule, ...] = (
    _rule(too_large, Phase.SIZE)._replace(purpose=too_large.PURPOSE),
    _rule(overlap),
    _rule(frame_length),
    _rule(beyond_frame),
    _rule(beyond_width),
    _rule(zero_scale),
    _rule(member_value),
    _rule(mixed_type),
    _rule(no_value),
    _rule(parameter_range),
    _rule(range_step, severity=WARNING),
    _rule(deprecation_period),
    _rule(repeated_value),
    _rule(reserved_word),
    _rule(file_name),
    _rule(duplicate_code),
    _rule(duplicate_name),
    _rule(ambiguous_message, Phase.WHOLE),
    _rule(id_collision, Phase.WHOLE),
    _rule(id_bits),
    _rule(unknown_node, Phase.WHOLE),
    _rule(ends_motion),
    _rule(node_variable),
    _rule(node_field),
    _rule(checksum_field),
    _rule(counter_field),
    _rule(frame_number),
    _rule(name_collision, Phase.NAMES),
    _rule(frame_contradiction, Phase.FRAMES),
    _rule(refused_contradiction, Phase.FRAMES),
    _rule(exchange_contradiction, Phase.FRAMES),
    _rule(missing_frame, Phase.COVERAGE, severity=WARNING),
    _rule(unreviewed_frame, Phase.COVERAGE, severity=WARNING),
    _rule(wrong_message, Phase.COVERAGE, severity=WARNING),
    _rule(missing_manual, severity=WARNING),
    _rule(differing_quantity, severity=WARNING),
    _rule(bit_number, severity=WARNING),
    _rule(unused, Phase.COVERAGE, severity=WARNING),
    _rule(long_name, Phase.NAMES, WARNING),
)

ALL_RULES: dict[str, Rule] = {rule.id: rule for rule in (*LOAD_RULES, *RULES)}
"""All rules by id, those of reading first."""
