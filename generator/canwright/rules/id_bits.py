"""Fields and selectors in the id do not use bits of the address."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

from ..diagnostics.diagnostic import DocumentPath
from ..model.layout import Segment, Space
from ..model.message import IdRule, KeyRole, Message
from . import can_ids
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    seen: set[DocumentPath] = set()
    for message in subject.edition.all_messages():
        taken = _bits(message.id)
        for name, path, segments in _in_id(subject, message):
            clash = [bit for s in segments for bit in range(s.low, s.low + s.width) if taken >> bit & 1]
            if clash and path not in seen:
                seen.add(path)
                text = f"{name} shares bit {clash[0]} of the id with the address `{message.address}`"
                hint = "move it, or check `id` and `nodes` of the address"
                yield Finding(path, text, hint)


def _in_id(subject: CheckInput, message: Message) -> Iterator[tuple[str, DocumentPath, tuple[Segment, ...]]]:
    address = subject.spec.addresses[message.address]
    for key in message.keys:
        if key.space is Space.ID:
            of_edition = key.role is KeyRole.CODE and not (address.selector or address.reply_selector)
            yield "the selector", ("selector", "at") if of_edition else message.path, key.segments
    for field in message.layout.fields:
        for element in field.elements if field.space is Space.ID else ():
            yield f"`{field.name}`", (*field.path, "at"), element.segments


def _bits(rule: IdRule) -> int:
    """The bits that are set in some id of a rule."""
    ids = can_ids.of_rule(rule)
    if len(ids) > can_ids.ENUMERATED:
        below = (rule.node_step & -rule.node_step) - 1
        counted = ((1 << (ids[-1] - rule.base).bit_length()) - 1) & ~below
        carried = counted << 1 if rule.base & counted else 0
        return rule.base | counted | carried
    return reduce(lambda bits, id_: bits | id_, ids, 0)
