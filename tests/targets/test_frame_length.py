"""Each frame format has one limit of the data bytes, and nothing else counts to it."""

from __future__ import annotations

import re

from canwright.model.layout import MAX_DATA_BYTES
from canwright.model.metadata import FrameFormat

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
    for file, fd, form in (("canwright.h", "", FrameFormat.CLASSIC), ("canwright_fd.h", "FD_", FrameFormat.FD)):
        header = (TARGETS / "c/runtime" / file).read_text("utf-8")
        assert re.findall(rf"#define CANWRIGHT_{fd}MAX_DATA (\d+)u", header) == [str(form.max_data_bytes)]
    assert FrameFormat.FD.max_data_bytes == MAX_DATA_BYTES


def test_no_source_limits_frames_to_8_bytes() -> None:
    limits = {str(file.relative_to(ROOT)): LENGTH.findall(file.read_text("utf-8")) for file in SOURCES}
    assert {file: texts for file, texts in limits.items() if texts} == {}
