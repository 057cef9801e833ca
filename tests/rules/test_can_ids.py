"""Collisions of ids: of messages with ids of their own, and of addresses with different rules for nodes."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..spec_texts import MINIMAL, findings, marked


def test_ids_without_a_message_do_not_collide(tmp_path: Path) -> None:
    """An address that only frames without a request come from has no requests, whatever `id` says of them."""
    of_all = "all: {id: 0x102}}"
    text = MINIMAL.replace("nodes: 1..4}}", f"nodes: 1..4}}, {of_all}")
    only_request = text.replace("reply: echo", "reply: none")
    beat = "  beat: {address: all, code: 2, request: none, reply: {level: {at: 2, type: level}}}\n"
    assert marked(findings(tmp_path, only_request + beat)) == []
    assert marked(findings(tmp_path, text + beat)) == ["id-collision: 0x102"]


@pytest.mark.parametrize(
    ("ids", "expected"),
    [
        (
            "request: 0x300 + node, reply: 0x380 + node, nodes: 1..200",
            "0x381 is the reply of node 1 and the request of node 129",
        ),
        ("request: 0x300 + node, reply: 0x380 + node, nodes: 1..128", ""),
        ("request: node * 2, reply: 1 + node * 2, nodes: 1..200", ""),
        ("request: node, reply: 2, nodes: 1..127", "0x2 is the reply and the request of node 2"),
        ("request: 0x7E5, reply: 0x7E0 + node, nodes: 1..5", "0x7E5 is the reply of node 5 and the request"),
        ("request: 0x7E5, reply: 0x7E5", ""),
    ],
)
def test_ids_of_a_request_and_a_reply_overlap(tmp_path: Path, ids: str, expected: str) -> None:
    text = MINIMAL.replace("id: 0x100 + node, nodes: 1..4", ids)
    collisions = [finding for finding in findings(tmp_path, text) if finding.rule == "id-collision"]
    assert [finding.message.rpartition(": ")[2] for finding in collisions] == ([expected] if expected else [])
    assert all(
        finding.position.text[finding.related[0].position.column - 1 :].startswith(ids[9:13]) for finding in collisions
    )


@pytest.mark.parametrize(
    ("lamp", "all_", "met"),
    [
        ("300 + node * 10", "305 + node * 10", ""),
        ("300 + node * 10", "310 + node * 10", "0x136"),
        ("300 + node * 10", "302 + node * 6", "0x140"),
        ("300 + node * 10", "301 + node * 6", ""),
        ("302 + node * 6", "350 + node * 4", "0x15E"),
        ("350 + node * 4", "302 + node * 6", "0x15E"),
        ("300 + node * 10", "330", "0x14A"),
        ("300 + node * 10", "331", ""),
    ],
)
def test_ids_that_are_not_powers_of_two_apart(tmp_path: Path, lamp: str, all_: str, met: str) -> None:
    nodes = ", nodes: 0..15" if "node" in all_ else ""
    addresses = f"{{lamp: {{id: {lamp}, nodes: 0..15}}, all: {{id: {all_}{nodes}}}}}"
    reported = findings(tmp_path, MINIMAL.replace("{lamp: {id: 0x100 + node, nodes: 1..4}}", addresses))
    assert [f.message.split()[3] for f in reported if f.rule == "id-collision"] == ([met] if met else [])


IN_THE_ID = """\
canwright: 1
family: lamp
edition: v1
addresses:
  lamp: {id: 0x10000 + node, nodes: 0..3, extended: true}
  store: {id: 0x1C000 + node, nodes: 0..3, extended: true}
selector: {at: id.6, raw: u10}
commands:
  read: {code: 0x061, request: {dlc: 0}, reply: {level: {at: 0, raw: u8}}}
  recall: {address: store, request: {dlc: 0}, reply: {level: {at: 0, raw: u8}, index: {at: id.6, raw: u8}}}
"""


def test_a_message_is_unreachable_if_an_earlier_address_has_its_ids(tmp_path: Path) -> None:
    """The id of `store` fixes two bits of the selector of `lamp`, and is compared first."""
    assert findings(tmp_path, IN_THE_ID) == []
    reported = findings(tmp_path, IN_THE_ID.replace("0x061", "0x361"))
    assert [(f.rule, f.message, f.hint) for f in reported] == [
        (
            "id-collision",
            "the ids of this reply are identified as ids of the address `store`, which has no such code",
            "0x1C000 is node 0 there: check `id`, `nodes` and `selector` of both addresses, or give it another code",
        )
    ]
