"""The nodes that a text selects, as `5,7` and `1..8`."""

from __future__ import annotations

from collections.abc import Sequence

from ..language import notation
from ..model.edition import Edition
from ..model.message import Direction


def selected_nodes(written: str, editions: Sequence[Edition]) -> tuple[int, ...]:
    """The nodes of `5,7` and `1..8`, in ascending order; each must exist in every edition that has nodes."""
    selected: set[int] = set()
    for part in written.split(","):
        try:
            selected |= {*notation.nodes(part if ".." in part else f"{part}..{part}")}
        except ValueError:
            raise ValueError(f"`{part}` is not a node; write nodes as 5,7 or 1..8") from None
    for edition in editions:
        rules = [address.rule(direction) for address in edition.addresses for direction in Direction]
        existing = {node for rule in rules for node in rule.nodes or ()}
        missing = sorted(selected - existing)
        if existing and missing:
            nodes = f"{min(existing)}..{max(existing)}"
            raise ValueError(f"{edition.family} {edition.name} has no node {missing[0]}; its nodes are {nodes}")
    return tuple(sorted(selected))
