"""A message that can have several codes keeps the one that came, in every language that encodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from canwright.conformance.adapter import write_files
from canwright.conformance.python import load
from canwright.project.loader import specification
from canwright.targets.python.target import PythonTarget

from ..verification.differential import compare
from .adapters import ADAPTERS
from .questions import Questions

CODES = """\
canwright: 1
family: desk
edition: v1
addresses:
  desk: {request: 0x100 + node, reply: 0x200 + node, nodes: 1..4}
  panel: {id: 0x300 + node, nodes: 1..4, selector: {at: 6, raw: u16}}
  plain: {id: 0x1000000, extended: true, selector: {at: id.8, raw: u8}}
selector: {at: 0, raw: u8}
layouts:
  state: {fields: {level: {at: 2, raw: u16}}}
commands:
  read: {code: 0x10, request: {dlc: 8}, reply: {layout: state, accept: [0x11, 0x00]}}
  set: {code: 0x20, request: {layout: state, accept: [0x21]}, reply: {layout: state}}
  clear: {code: 0x30, request: {dlc: 8}, reply: {layout: {}, accept: [0x10, 0x31]}}
  lock: {code: 0x41, request: {mark: {at: 1, raw: u8, constant: 7}, free: {at: 2, raw: u8}}, reply: none}
  latch: {code: 0x41, request: {mark: {at: 1, raw: u8, constant: 8}, free: {at: 2, raw: u8}}, reply: none}
  open: {code: 0x42, request: {layout: {frame_code: {at: 1, raw: u8}, size: {at: 2, raw: u8}}, accept: [0x41]}, reply: none}
  dim: {code: 0x50, address: panel, request: {accept: [0x00, 0x51], layout: {depth: {at: 0, raw: i16}}}, reply: none}
  beep: {code: 0x60, address: plain, request: {accept: [0x61, 0x00], layout: {tone: {at: 0, raw: u8}}}, reply: none}
  halt: {code: 0x62, address: plain, request: {accept: [0x63], layout: {}}, reply: none}
  fixed: {code: 0x70, request: {layout: {mark: {at: 3, raw: u8, constant: 9}}, accept: [0x71]}, reply: none}
"""
"""The code 0 beside others, codes in the id, of another width, of shared layouts, of other commands, and without fields."""


def test_random_questions_about_messages_with_several_codes(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(CODES, "utf-8")
    item = specification(tmp_path / "v1.yaml")
    targets = [ADAPTERS[target].create(item, tmp_path) for target in ("c", "cxx", "python", "javascript")]
    questions = [question for seed in range(3) for question in Questions(item.edition, seed).round()]
    assert {question.kind for question in questions} >= {"code", "decode", "decode expected"}
    for comparison in compare(item, targets, questions):
        assert not comparison.disagreements, "\n".join([comparison.target, *comparison.disagreements[:10]])


def test_messages_of_python_keep_the_code(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(CODES, "utf-8")
    item = specification(tmp_path / "v1.yaml")
    module: Any = load(write_files(PythonTarget().generate([item], {}), tmp_path), item.edition)
    came = module.decode_reply(0x201, bytes.fromhex("11 00 34 12 00 00 00 00"))
    assert (came.frame_code, came.CODE, came.encode()[0]) == (0x11, 0x10, 0x11)
    assert came == module.ReadReply(node=1, level=0x1234, frame_code=0x11) == came.replace(level=0x1234)
    assert came.replace(level=1).encode() == bytes.fromhex("11 00 01 00 00 00 00 00")
    usual = module.ReadReply(node=1, level=0x1234)
    assert came != usual == came.replace(frame_code=0x10)
    assert len({came, usual, module.ReadReply.from_raw(node=1, level=0x1234, frame_code=0x11)}) == 2
    assert repr(came) == "ReadReply(node=1, frame_code=0x11, level=4660)"
    assert eval(repr(came), vars(module)) == came
    assert isinstance(came, module.State)
    halt = module.HaltRequest(frame_code=0x63)
    assert (halt.can_id, module.HaltRequest().can_id) == (0x1006300, 0x1006200)
    assert module.SetReply(node=1, level=0).frame_code == 0x20
    with pytest.raises(module.CodecError, match="has the code 0x10 or 0x11 or 0x00, not 0x12") as error:
        came.replace(frame_code=0x12)
    assert error.value.refusal is module.Refusal.UNKNOWN_CODE
