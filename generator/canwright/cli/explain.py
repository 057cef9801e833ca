"""`explain`."""

from __future__ import annotations

import click

from ..diagnostics import nearest
from ..resources import EXAMPLES
from ..rules import EVERY
from .common import stop


@click.command()
@click.argument("rule", required=False)
def explain(rule: str | None) -> None:
    """Say what a RULE wants, with a bad and a good example; without RULE, list all rules.

    The rule stands in brackets behind every finding.
    """
    if rule is None:
        width = max(map(len, EVERY))
        for one in EVERY.values():
            click.echo(f"{one.id:<{width}}  {one.severity.value:<7}  {one.purpose}")
        return
    if rule not in EVERY:
        stop(f"there is no rule `{rule}`; {nearest(rule, EVERY) or '`canwright explain` lists them'}")
    one = EVERY[rule]
    click.echo(f"{one.id} ({one.severity.value})\n\n{one.purpose}")
    for heading, file in (
        ("Bad, bad.yaml", "bad.yaml"),
        ("With it, bad.frames.yaml", "bad.frames.yaml"),
        ("What canwright says", "expected.txt"),
        ("Good, good.yaml", "good.yaml"),
        ("With it, good.frames.yaml", "good.frames.yaml"),
    ):
        example = EXAMPLES / one.id / file
        if example.is_file():
            lines = example.read_text("utf-8", errors="replace").rstrip("\n").split("\n")
            click.echo(f"\n{heading}:\n" + "\n".join(f"    {line}".rstrip() for line in lines))
