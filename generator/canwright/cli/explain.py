"""`explain`."""

from __future__ import annotations

import click

from ..compare import CHANGES
from ..diagnostics.diagnostic import nearest
from ..rules import ALL_RULES
from ..templating.resources import CHANGE_EXAMPLES, EXAMPLES
from .common import stop
from .terminal import print_text

_FILES = (
    ("Bad, bad.yaml", "bad.yaml"),
    ("Golden frames of the bad spec, bad.frames.yaml", "bad.frames.yaml"),
    ("Before, previous.yaml", "previous.yaml"),
    ("After, current.yaml", "current.yaml"),
    ("What canwright reports", "expected.txt"),
    ("Good, good.yaml", "good.yaml"),
    ("Golden frames of the good spec, good.frames.yaml", "good.frames.yaml"),
)


@click.command()
@click.argument("rule", metavar="[RULE|KEY]", required=False)
def explain(rule: str | None) -> None:
    """Explain a RULE by example, or the meaning of a KEY.

    Without an argument, list all rules. `check` and `diff` print the rule in brackets after each finding and change.
    """
    kinds = {
        finding_rule.id: (finding_rule.severity.value, finding_rule.purpose) for finding_rule in ALL_RULES.values()
    }
    kinds |= {change_rule.id: (change_rule.category.value, change_rule.purpose) for change_rule in CHANGES.values()}
    if rule is None:
        width = max(map(len, kinds))
        for id_, (kind, purpose) in kinds.items():
            print_text(f"{id_:<{width}}  {kind:<7}  {purpose}\n")
        return
    from ..language import reference

    of_language = list(reference.explained(rule))
    if rule in kinds:
        _show_rule(rule, *kinds[rule])
    elif not of_language:
        hint = nearest(rule, [*kinds, *reference.words()]) or "`canwright explain` lists the rules"
        stop(f"there is no rule or key `{rule}`; {hint}")
    if of_language:
        print_text(("\n" if rule in kinds else "") + "\n".join(of_language) + "\n")


def _show_rule(rule: str, kind: str, purpose: str) -> None:
    print_text(f"{rule} ({kind})\n\n{purpose}\n")
    for heading, file in _FILES:
        example = (EXAMPLES if rule in ALL_RULES else CHANGE_EXAMPLES) / rule / file
        if example.is_file():
            lines = example.read_text("utf-8", errors="replace").rstrip("\n").split("\n")
            print_text(f"\n{heading}:\n" + "".join(f"    {line}".rstrip() + "\n" for line in lines))
