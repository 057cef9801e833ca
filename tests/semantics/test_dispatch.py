"""The dispatch plan against a plain reading of its rule, on random frames and golden frames of every spec."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from canwright.model.edition import Edition
from canwright.model.layout import Space, bits_of
from canwright.model.message import Direction, Key, Message
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.semantics.configured import configured
from canwright.semantics.decoder import Decoder, Rejection
from canwright.semantics.dispatch import DispatchNode, Match, Select, dispatch_plan
from canwright.semantics.frame import CanFrame

from ..resolve.test_tables import TABLE
from ..spec_texts import SPECS, called, edition
from .random_frames import random_frames

FRAMES = 1000

Outcome = tuple[str, int | None] | Refusal


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_the_dispatch_plan_identifies_random_and_golden_frames(spec: Path) -> None:
    item = specification(spec)
    assert item.frames is not None
    golden = [CanFrame(f.id, f.data, f.extended, f.remote) for f in item.frames.frames]
    lowest = {p.name: p.minimum for p in item.edition.parameters if p.minimum is not None}
    of_bus = configured(item.edition, lowest)
    compare(of_bus, [*golden, *random_frames(of_bus, FRAMES)])


LENGTHS = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
commands:
  short: {code: 0x10, manual: "1", request: {dlc: 2}, reply: {dlc: 2, accept: [0x20], layout: {level: {at: 1, raw: u8}}}}
  long: {code: 0x10, manual: "1", request: {dlc: 4}, reply: {dlc: 4, layout: {level: {at: 2, raw: u16}}}}
  other: {code: 0x30, manual: "1", request: {dlc: 8}, reply: {dlc: 8, layout: {level: {at: 2, raw: u16}}}}
"""
PLACES = """\
canwright: 1
family: lamp
edition: v1
addresses:
  lamp: {id: 0x10000 + node, nodes: 0..3, extended: true, selector: {at: 0, raw: u4}}
  same: {id: 0x10000 + node, nodes: 0..3, extended: true, selector: {at: 6, raw: u8}}
commands:
  first: {code: 1, manual: "1", request: {high: {at: 0.4, raw: u4}}, reply: echo}
  read: {code: 2, manual: "1", request: {kind: {at: 1, raw: u8, constant: 1}, level: {at: 2, raw: u8}}, reply: echo}
  write: {code: 2, manual: "1", request: {kind: {at: 1, raw: u8, constant: 2}, level: {at: 3, raw: u8}}, reply: echo}
  general: {code: 2, manual: "1", request: {kind: {at: 1, raw: u8}, level: {at: 4, raw: u8}}, reply: echo}
  wide: {code: 3, manual: "1", request: {small: {at: id.20, raw: i3}}, reply: none}
  fixed: {code: 4, manual: "1", request: {mark: {at: 1.3, raw: i9, constant: -2}}, reply: none}
  status: {manual: "1", request: none, reply: {level: {at: 0, raw: u8}}}
  seven: {code: 7, address: same, manual: "1", request: {mark: {at: 0, raw: u4, constant: 9}}, reply: none}
  eight: {code: 7, address: same, manual: "1", request: {mark: {at: 0, raw: u4, constant: 10}}, reply: none}
"""
UNUSED = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
commands:
  plain: {code: 0x10, manual: "1", request: {dlc: 2}, reply: none}
  wide: {code: 0x11, manual: "1", request: {dlc: 3, layout: {rank: {at: id.9, raw: u2}}}, reply: none}
  both: {code: 0x12, manual: "1", request: {dlc: 2, layout: {rank: {at: id.9, raw: u2}}}, reply: none}
  both_long: {code: 0x12, manual: "1", request: {dlc: 3}, reply: none}
"""


@pytest.mark.parametrize("text", [PLACES, LENGTHS, UNUSED, TABLE], ids=["places", "lengths", "unused", "table"])
def test_the_dispatch_plan_identifies_random_frames_of_unusual_specs(text: str, tmp_path: Path) -> None:
    of_text = edition(tmp_path, text)
    compare(of_text, list(random_frames(of_text, FRAMES)))


def test_only_the_length_decides_between_messages_of_one_code(tmp_path: Path) -> None:
    """Whatever further codes are accepted for one of them."""
    decoder = Decoder(edition(tmp_path, LENGTHS))
    identified = decoder.identify(Direction.REPLY, CanFrame(0x101, bytes.fromhex("10 00 00 00")))
    assert not isinstance(identified, Rejection) and identified.message.command == "long"
    identified = decoder.identify(Direction.REPLY, CanFrame(0x101, bytes.fromhex("20 00 00 00")))
    assert isinstance(identified, Rejection) and identified.reason is Refusal.WRONG_LENGTH


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_the_tree_has_every_message_that_claims_a_code(spec: Path) -> None:
    of_spec = specification(spec).edition
    for direction in Direction:
        routes = dispatch_plan(of_spec, direction).routes
        there = {name for route in routes for name in names(route.then)}
        assert there == {m.name for m in of_spec.messages(direction) if m.identifying_codes or not m.keys}


def names(node: DispatchNode) -> Iterator[str]:
    """The messages below a node."""
    if isinstance(node, Match):
        yield node.message.name
    elif isinstance(node, Select):
        for branch in (*(case.then for case in node.cases), node.otherwise):
            yield from names(branch)


def compare(of_spec: Edition, frames: Sequence[CanFrame]) -> None:
    """Compares every frame in both directions; all messages and reasons have to occur."""
    decoder = Decoder(of_spec)
    by_rule = {direction: groups(of_spec.messages(direction)) for direction in Direction}
    seen: Counter[str | Refusal] = Counter()
    for frame in frames:
        for direction in Direction:
            identified = decoder.identify(direction, frame)
            outcome = (
                identified.reason if isinstance(identified, Rejection) else (identified.message.name, identified.node)
            )
            wanted = expected(by_rule[direction], frame)
            assert outcome == wanted, (direction, frame)
            seen[wanted if isinstance(wanted, Refusal) else wanted[0]] += 1
    assert {m.name for m in of_spec.all_messages() if m.identifying_codes or not m.keys} <= set(seen)
    assert {Refusal.UNKNOWN_ID} < {result for result in seen if isinstance(result, Refusal)}


Group = tuple[list[Message], set[int]]
"""The messages of one id rule, and the bits of the id that keys and fields of some of them have."""


def groups(messages: Sequence[Message]) -> list[Group]:
    """The messages by id rule, fewest open bits first."""
    by_rule = {(m.id, m.remote): [o for o in messages if (o.id, o.remote) == (m.id, m.remote)] for m in messages}
    return sorted(((group, _open(group)) for group in by_rule.values()), key=lambda group: len(group[1]))


def expected(of_direction: Sequence[Group], frame: CanFrame) -> Outcome:
    """The id rule, the longest matching keys, the length, the message without keys; by trying every message."""
    fitting = [(*group, node) for group in of_direction for node in _nodes(*group, frame)]
    if not fitting:
        return Refusal.UNKNOWN_ID
    group, open_bits, node = fitting[0]
    if not frame.remote and all(len(frame.data) != m.dlc for m in group):
        return Refusal.WRONG_LENGTH
    matching = [m for m in group if m.keys and _keys_match(m, frame)] or [m for m in group if not m.keys]
    if not matching:
        return Refusal.UNKNOWN_CODE
    most = max(len(m.keys) for m in matching)
    first = next(m for m in matching if len(m.keys) == most)
    same = [m for m in matching if _where(m) == _where(first)]
    fitting_length = next((m for m in same if len(frame.data) == m.dlc and not frame.remote), first)
    if any(frame.id >> bit & 1 for bit in open_bits - _open([fitting_length])):
        return Refusal.UNKNOWN_ID
    return (
        (fitting_length.name, node) if frame.remote or len(frame.data) == fitting_length.dlc else Refusal.WRONG_LENGTH
    )


def _open(messages: Sequence[Message]) -> set[int]:
    """The bits of the id that keys and fields of messages have."""
    bits = {bit for m in messages for k in m.keys if k.space is Space.ID for bit in bits_of(k.segments)}
    fields = (f for m in messages for f in m.layout.fields if f.space is Space.ID)
    return bits | {bit for f in fields for e in f.elements for bit in e.bits}


def _nodes(group: Sequence[Message], open_bits: set[int], frame: CanFrame) -> list[int | None]:
    """The node that an id is of, by trying all of them."""
    rule = group[0].id
    if (rule.extended, group[0].remote) != (frame.extended, frame.remote):
        return []
    rest = sum(1 << bit for bit in range(29) if frame.id >> bit & 1 and bit not in open_bits)
    if rule.nodes is None:
        return [None] if rest == rule.base else []
    return [node for node in rule.nodes if rule.base + node * rule.node_step == rest]


def _keys_match(message: Message, frame: CanFrame) -> bool:
    first, *further = message.keys
    return _held(first, frame) in message.identifying_codes and all(_held(key, frame) == key.value for key in further)


def _held(key: Key, frame: CanFrame) -> int:
    word = frame.id if key.space is Space.ID else int.from_bytes(frame.data, "little")
    return sum((word >> bit & 1) << i for i, bit in enumerate(bits_of(key.segments)))


def _where(message: Message) -> object:
    return [(key.space, key.segments, key.value) for key in message.keys]
