"""No id belongs to two addresses of one direction."""

from __future__ import annotations

from ..model import Direction, Edition, IdRule
from .rule import Found


def check(edition: Edition) -> Found:
    for direction in Direction:
        owner: dict[tuple[bool, int], str] = {}
        for address in edition.addresses:
            rule = address.request if direction is Direction.REQUEST else address.reply
            for id_ in _ids(rule):
                other = owner.setdefault((rule.extended, id_), address.name)
                if other != address.name:
                    text = f"the {direction.value} id 0x{id_:X} belongs to `{other}` as well"
                    yield address.path, text, "check `id` and `nodes` of both"
                    break


def _ids(rule: IdRule) -> list[int]:
    if rule.nodes is None:
        return [rule.base]
    return [rule.base + (node << rule.node_shift) for node in rule.nodes]
