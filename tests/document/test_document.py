from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import pytest
from canwright.diagnostics.diagnostic import Diagnostic, SpecError
from canwright.document.document import MAX_BYTES, parse_document, read_document
from canwright.document.toml import TomlDocument
from hypothesis import given, settings, strategies as st

from ..spec_texts import places


def findings(text: str) -> list[Diagnostic]:
    try:
        parse_document("x.yaml", text)
    except SpecError as error:
        return list(error.diagnostics)
    return []


def rule_of(text: str) -> str:
    (place,) = places(findings(text))
    return place


def test_scalars_are_exact_and_plain() -> None:
    text = "{a: 12, b: 0x1F, c: -0.10, d: true, e: v2.35, f: 0x140 + node, g: '12', h: 1..32, y: n}"
    data = parse_document("x.yaml", text).data
    assert data == {
        "a": 12,
        "b": 31,
        "c": Decimal("-0.10"),
        "d": True,
        "e": "v2.35",
        "f": "0x140 + node",
        "g": "12",
        "h": "1..32",
        "y": "n",
    }
    assert isinstance(data, dict)
    assert str(data["c"]) == "-0.10"


@pytest.mark.parametrize(
    "text", ["no", "On", "~", "null", ".inf", "-.NaN", "1_0", "0o7", "012", "12:30", "1e3", "1.", "+5", ".5", "True"]
)
def test_ambiguous_scalars_are_rejected(text: str) -> None:
    assert rule_of(f"a: {text}") == "1:4 ambiguous-scalar"
    assert parse_document("x.yaml", f"a: '{text}'").data == {"a": text}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1\nb: 2\na: 3\n", "3:1 duplicate-key"),
        ("a: &x 1\n", "1:4 yaml-alias"),
        ("a: [*x]\n", "1:5 yaml-alias"),
        ("<<: {a: 1}\n", "1:1 yaml-alias"),
        ("a: !!python/object:os.system x\n", "1:4 yaml-tag"),
        ("a: !x {b: 1}\n", "1:4 yaml-tag"),
        ("a:\n", "1:1 yaml"),
        ("a: 1\n---\nb: 2\n", "2:1 yaml"),
        ("", "1:1 yaml"),
        ("a: [1, 2\n", "1:4 yaml"),
        ("[a]: 1\n", "1:1 yaml"),
        ("a: " + "[" * 40 + "]" * 40, "1:27 yaml-depth"),
    ],
)
def test_position_of_unsafe_and_invalid_yaml(text: str, expected: str) -> None:
    assert rule_of(text) == expected


def test_a_file_that_is_too_long_or_not_utf8_is_rejected(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    file.write_bytes(b"a: 1\nb: \xff\n")
    with pytest.raises(SpecError, match=r"x\.yaml:2:4: error: byte 8, 0xFF, is not UTF-8 \[encoding\]"):
        read_document(file)
    file.write_bytes(b"#" * (MAX_BYTES + 1))
    with pytest.raises(SpecError, match="file-size"):
        read_document(file)


def test_a_byte_order_mark_of_utf_8_is_ignored(tmp_path: Path) -> None:
    (tmp_path / "x.yaml").write_bytes(b"\xef\xbb\xbfa: 1\nb: 2\n")
    document, content = read_document(tmp_path / "x.yaml")
    assert document.data == {"a": 1, "b": 2}
    assert (document.position(("a",), key=True).column, content) == (1, b"a: 1\nb: 2\n")
    assert TomlDocument("canwright.toml", "\ufeff[rules]\na = 1\n").data == {"rules": {"a": 1}}
    (tmp_path / "x.yaml").write_bytes("a: 1".encode("utf-16"))
    with pytest.raises(SpecError, match="the byte order mark of UTF-16"):
        read_document(tmp_path / "x.yaml")


def test_toml_that_is_nested_too_deeply_is_an_error() -> None:
    with pytest.raises(SpecError) as raised:
        TomlDocument("canwright.toml", f"[check]\na = {'[' * 20000}{']' * 20000}\n")
    (finding,) = raised.value.diagnostics
    assert finding.message == "this is not TOML: it is nested too deeply"


def test_a_finding_shows_the_line_and_a_caret() -> None:
    document = parse_document("x.yaml", "a:\n  bc: [1, def]\n")
    text = str(document.finding(("a", "bc", 1), "some-rule", "this is invalid", "write ghi"))
    assert text == "x.yaml:2:11: error: this is invalid [some-rule]\n    bc: [1, def]\n            ^^^\n  write ghi"


@given(st.text())
@settings(deadline=None, derandomize=True)  # also without conftest.py
def test_every_text_is_a_document_or_has_findings(text: str) -> None:
    try:
        parse_document("x.yaml", text)
    except SpecError as error:
        assert error.diagnostics
