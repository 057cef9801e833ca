"""Each language has one limit of the data bytes of a frame, and nothing else counts to it."""

from __future__ import annotations

import re

import pytest
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


@pytest.mark.parametrize(
    ("file", "definition"),
    [
        ("c/runtime/canwright.h", r"#define CANWRIGHT_MAX_DATA (\d+)u"),
        ("python/runtime/_codec.py", r"MAX_DATA = (\d+)"),
    ],
)
def test_limit_of_a_language(file: str, definition: str) -> None:
    assert re.findall(definition, (TARGETS / file).read_text("utf-8")) == [str(MAX_DATA_BYTES)]


def test_no_other_limit() -> None:
    found = {str(file.relative_to(ROOT)): LENGTH.findall(file.read_text("utf-8")) for file in SOURCES}
    assert {file: texts for file, texts in found.items() if texts} == {}
