"""`explain`."""

from __future__ import annotations

import click

from ..compare import CHANGES
from ..diagnostics import nearest
from ..resources import CHANGE_EXAMPLES, EXAMPLES
from ..rules import EVERY
from .common import stop

_FILES = (
    ("Bad, bad.yaml", "bad.yaml"),
    ("With it, bad.frames.yaml", "bad.frames.yaml"),
    ("Before, previous.yaml", "previous.yaml"),
    ("After, current.yaml", "current.yaml"),
    ("What canwright says", "expected.txt"),
    ("Good, good.yaml", "good.yaml"),
    ("With it, good.frames.yaml", "good.frames.yaml"),
)


@click.command()
@click.argument("rule", required=False)
def explain(rule: str | None) -> None:
    """Say what a RULE wants, with a bad and a good example.

    Without RULE, list all rules. The rule stands in brackets behind every finding of `check`, and every change of `diff`.
    """
    kinds = {one.id: (one.severity.value, one.purpose) for one in EVERY.values()}
    kinds |= {one.id: (one.category.value, one.purpose) for one in CHANGES.values()}
    if rule is None:
        width = max(map(len, kinds))
        for id_, (kind, purpose) in kinds.items():
            click.echo(f"{id_:<{width}}  {kind:<7}  {purpose}")
        return
    if rule not in kinds:
        stop(f"there is no rule `{rule}`; {nearest(rule, kinds) or '`canwright explain` lists them'}")
    kind, purpose = kinds[rule]
    click.echo(f"{rule} ({kind})\n\n{purpose}")
    for heading, file in _FILES:
        example = (EXAMPLES if rule in EVERY else CHANGE_EXAMPLES) / rule / file
        if example.is_file():
            lines = example.read_text("utf-8", errors="replace").rstrip("\n").split("\n")
            click.echo(f"\n{heading}:\n" + "\n".join(f"    {line}".rstrip() for line in lines))
