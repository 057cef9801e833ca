"""Rules about a spec, one in each module, listed in one table with the rules that loading and resolving check.

Belongs here: what makes a valid spec wrong or unclear, as findings; `checker` runs the rules phase by phase. The first line
of a module is the purpose of its rule, which `canwright explain` shows. Each has an incorrect and a correct example in
`examples/`. Imports `diagnostics`, `document`, `model`, `language`, `semantics`, `resolve` and the registry of `targets`.
"""

from __future__ import annotations

from ..diagnostics.diagnostic import Severity
from .reading_catalogue import LOAD_RULES, LoadRule
from .rule import Phase, Rule

WARNING = Severity.WARNING

RULES: tuple[Rule, ...] = (
    Rule("too-large", Phase.SIZE),
    Rule("overlap", Phase.PARTS),
    Rule("frame-length", Phase.PARTS),
    Rule("beyond-frame", Phase.PARTS),
    Rule("beyond-width", Phase.PARTS),
    Rule("zero-scale", Phase.PARTS),
    Rule("member-value", Phase.PARTS),
    Rule("mixed-type", Phase.PARTS),
    Rule("no-value", Phase.PARTS),
    Rule("parameter-range", Phase.PARTS),
    Rule("range-step", Phase.PARTS, WARNING),
    Rule("deprecation-period", Phase.PARTS),
    Rule("repeated-value", Phase.PARTS),
    Rule("reserved-word", Phase.PARTS),
    Rule("file-name", Phase.PARTS),
    Rule("duplicate-code", Phase.PARTS),
    Rule("duplicate-name", Phase.PARTS),
    Rule("ambiguous-message", Phase.WHOLE),
    Rule("id-collision", Phase.WHOLE),
    Rule("id-bits", Phase.PARTS),
    Rule("unknown-node", Phase.WHOLE),
    Rule("ends-motion", Phase.PARTS),
    Rule("node-variable", Phase.PARTS),
    Rule("node-field", Phase.PARTS),
    Rule("checksum-field", Phase.PARTS),
    Rule("counter-field", Phase.PARTS),
    Rule("frame-number", Phase.PARTS),
    Rule("name-collision", Phase.NAMES),
    Rule("frame-contradiction", Phase.FRAMES),
    Rule("refused-contradiction", Phase.FRAMES),
    Rule("exchange-contradiction", Phase.FRAMES),
    Rule("missing-frame", Phase.COVERAGE, WARNING),
    Rule("unreviewed-frame", Phase.COVERAGE, WARNING),
    Rule("wrong-message", Phase.COVERAGE, WARNING),
    Rule("missing-manual", Phase.PARTS, WARNING),
    Rule("differing-quantity", Phase.PARTS, WARNING),
    Rule("bit-number", Phase.PARTS, WARNING),
    Rule("flag-masks", Phase.PARTS, WARNING),
    Rule("unused", Phase.COVERAGE, WARNING),
    Rule("long-name", Phase.NAMES, WARNING),
)

_ALL: tuple[LoadRule | Rule, ...] = (*LOAD_RULES, *RULES)
ALL_RULES = {rule.id: rule for rule in _ALL}
"""All rules by id, those of reading first."""
