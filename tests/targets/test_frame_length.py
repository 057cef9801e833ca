"""Each language has one limit of the data bytes of a frame, and nothing else counts to it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from canwright.model.layout import MAX_DATA_BYTES

from ..spec_texts import ROOT

TARGETS = ROOT / "generator/canwright/targets"
SOURCES = [
    file
    for folder in ("generator", "templates")
    for file in sorted((ROOT / folder).rglob("*"))
    if file.suffix in (".py", ".j2", ".h")
]
LENGTH = re.compile(r"(?i)(?:\bdlc\b|len\(data\)|data bytes).*?(?:[=<>]|\bto\b) *\(?8u?\b|\bdata\[8|i < 8u?\b|R\[0-8")
"""A length that is compared with 8, or is 8."""


def test_limit_of_a_language() -> None:
    header = (TARGETS / "c/runtime/canwright.h").read_text("utf-8")
    assert re.findall(r"#define CANWRIGHT_MAX_DATA (\d+)u", header) == [str(MAX_DATA_BYTES)]


def test_no_other_limit() -> None:
    limits = {str(file.relative_to(ROOT)): LENGTH.findall(file.read_text("utf-8")) for file in SOURCES}
    assert {file: texts for file, texts in limits.items() if texts} == {}


LONG = """\
canwright: 1
family: lamp
edition: v1
bus: {dlc: 24}
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
commands:
  dim: {code: 0x10, manual: "1", request: {level: {at: 22, raw: u16}, step: {at: 3, raw: u8}}, reply: echo}
"""
LONG_FRAMES = """\
canwright: 1
family: lamp
edition: v1
sources: {manual: The manual.}
frames:
  - {request: dim, node: 2, id: 0x102, data: "10 00 00 07 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 34 12",
     raw: {level: 4660, step: 7}, values: {level: 4660, step: 7}, source: manual}
exchanges:
  - request: {id: 0x102, data: "10 00 00 07 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 34 12"}
    reply: {id: 0x102, data: "10 00 00 07 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 34 13"}
    says: not_answer
    source: manual
"""
SELF_TEST = """\
import sys
from pathlib import Path
from canwright.model import layout
layout.MAX_DATA_BYTES = 24
from canwright.project.loader import specification
from tests.targets.test_c_selftest import result
from tests.verification.targets import write
print(*result(write(specification(Path(sys.argv[1])), Path(sys.argv[2]))))
"""


def test_generated_c_has_the_limit_of_the_model(tmp_path: Path) -> None:
    (tmp_path / "v1.yaml").write_text(LONG, "utf-8")
    (tmp_path / "v1.frames.yaml").write_text(LONG_FRAMES, "utf-8")
    command = [sys.executable, "-c", SELF_TEST, str(tmp_path / "v1.yaml"), str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.stdout.split() == ["2", "0", "0", "0"], done.stdout + done.stderr
