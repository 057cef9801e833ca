"""Files, numbers and sizes above the limits are rejected quickly, before they take much time or memory."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.diagnostics.diagnostic import MAX_FINDINGS, SpecError
from canwright.document.document import MAX_BYTES, read_document
from canwright.language import notation
from canwright.resolve.report import MAX_COMMANDS
from canwright.rules import bit_patterns, too_large
from click.testing import CliRunner

from ..spec_texts import MINIMAL, findings, marked, places
from .attacks import ATTACKS, run

AT_ONCE = 20.0
"""CPU seconds, for a slow machine; what is unbounded takes minutes, or does not end."""


def many(count: int, text: str) -> str:
    return "".join(text.replace("#", str(i)) for i in range(count))


@pytest.mark.parametrize("kind", ["folder", "pipe", "device"])
def test_folders_pipes_and_devices_are_not_read(kind: str, tmp_path: Path) -> None:
    file = {"folder": tmp_path, "pipe": tmp_path / "pipe.yaml", "device": Path("/dev/zero")}[kind]
    if kind == "pipe":
        os.mkfifo(file)
    result = CliRunner().invoke(main, ["generate", "--spec", str(file), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert "has no spec" in result.output or "is not a file but a folder, a pipe or a device" in result.output
    assert not (tmp_path / "out").exists()


def test_a_huge_file_is_rejected_without_reading_it(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    with file.open("wb") as stream:
        stream.truncate(1 << 40)
    with pytest.raises(SpecError, match=rf"the file has more than {MAX_BYTES} bytes \[file-size\]"):
        read_document(file)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("a: 1\n".encode("utf-16"), "1:1 encoding"),
        (b"a: 1\nb: \xc0\xaf\n", "2:4 encoding"),
        (b"a: \xed\xa0\x80\n", "1:4 encoding"),
        ("é: \u00b5\nb: ".encode() + b"\xff", "2:4 encoding"),
    ],
)
def test_position_of_invalid_utf_8(content: bytes, expected: str, tmp_path: Path) -> None:
    (tmp_path / "x.yaml").write_bytes(content)
    with pytest.raises(SpecError) as refused:
        read_document(tmp_path / "x.yaml")
    assert places(list(refused.value.diagnostics)) == [expected]


def test_all_findings_about_the_yaml_are_reported_together(tmp_path: Path) -> None:
    text = (
        MINIMAL.replace("raw_range: 0..1000", "raw_range: &all 0..1000, raw_range: *all")
        .replace("raw: u16", "raw: !!str u99, about: no")
        .replace("reply: echo", "reply: sent\n    code: 0x11\n    colour: 1_0\n    notes: [\u202e x]")
    )
    assert places(findings(tmp_path, text)) == [
        "7:16 yaml-tag",
        "7:34 ambiguous-scalar",
        "7:72 yaml-alias",
        "7:86 duplicate-key",
        "7:97 yaml-alias",
        "14:5 duplicate-key",
        "15:13 ambiguous-scalar",
        "16:13 unsafe-character",
    ]


TOO_MUCH: dict[str, Callable[[], str]] = {
    "more digits than a number may have": lambda: MINIMAL.replace("0.1,", '"1/%s",' % ("9" * 190)),
    "a number of a million digits": lambda: MINIMAL.replace("0.1,", '"%s",' % ("9" * 10**6)),
    "a plain number of a million digits": lambda: MINIMAL.replace("0x10", "9" * 10**6),
    "a power": lambda: MINIMAL.replace("0.1,", "1/10**9999,"),
    "a shift": lambda: MINIMAL.replace("0x100 + node", "node << 99999999999"),
    "a long sum": lambda: MINIMAL.replace("0x100 + node", '"%s0"' % ("1 + " * 250000)),
    "an id bit": lambda: MINIMAL.replace("at: 2", "at: id.99999999999"),
    "a byte": lambda: MINIMAL.replace("at: 2", "at: 99999999999"),
    "nodes": lambda: MINIMAL.replace("1..4", "1..536870911"),
    "more nodes": lambda: MINIMAL.replace("1..4", "1..99999999999999999999"),
    "an array": lambda: MINIMAL.replace("{at: 2,", "{array: 1..9999999, at: 2,"),
    "replies": lambda: MINIMAL.replace("reply: echo", "reply: {layout: {}, from_each: 1..999999999}"),
    "a range": lambda: MINIMAL.replace("0..1000", "0..1" + "0" * 60),
    "aliases": lambda: "a: &a [x]\nb: &b [*a,*a]\nc: &c [*b,*b]\nd: [%s]" % ("*c," * 300000),
    "brackets": lambda: "[" * 10**6,
    "braces": lambda: "{a: " * 250000,
    "unseen characters": lambda: "# " + "\u200b" * 300000 + "\n" + MINIMAL,
    "unknown keys": lambda: MINIMAL + many(20000, "    key#: 1\n"),
    "unknown names": lambda: MINIMAL + "    effects: [" + many(40000, "e#, ") + "]\n",
    "wrong commands": lambda: MINIMAL + many(15000, "  c#: {code: x, reply: z}\n"),
    "fields": lambda: MINIMAL.replace("request: {", "request: {" + many(9000, "f#: {at: 3, raw: u8}, ")),
    "addresses": lambda: MINIMAL.replace("es: {", "es: {" + many(3000, "a#: {id: node, nodes: 0..2047}, ")),
    "values of a choice": lambda: MINIMAL + "parameters: {p: {values: {" + many(9000, "v#: {}, ") + "}}}\n",
    "choices": lambda: MINIMAL + "parameters: {" + many(200, "p#: {values: {a: {}, b: {}}}, ") + "}\n",
    "codes to accept": lambda: MINIMAL.replace("echo", "{accept: [" + many(60000, "#, ") + "]}"),
    "a chain of replies": lambda: MINIMAL + many(3000, "  c#: {code: 1, reply: {of: d#}}\n  d#: {reply: {of: c#}}\n"),
    "entries times commands": lambda: (
        MINIMAL
        + many(200, "  c#: {code: 1, table: t, request: entry, reply: echo}\n")
        + "tables: {t: {index: {at: 1, raw: u16}, entries: {"
        + many(1000, "e#: {index: #, layout: {}}, ")
        + "}}}\n"
    ),
}


@pytest.mark.parametrize("what", TOO_MUCH)
def test_excessive_input_is_rejected_quickly(what: str, tmp_path: Path) -> None:
    text = TOO_MUCH[what]()
    start = time.process_time()
    reported = findings(tmp_path, text)
    assert time.process_time() - start < AT_ONCE
    assert 0 < len(reported) <= 2 * MAX_FINDINGS
    assert all(len(str(finding)) < 1500 for finding in reported)


@pytest.mark.parametrize("name", ["../x", "/etc/x", ".", "..", "a/b", "a\\b", "~", "C:", "x\n", "a b", "", "a" * 60])
def test_names_that_are_paths_are_rejected(name: str, tmp_path: Path) -> None:
    quoted = '"' + name.replace("\\", "\\\\").replace("\n", "\\n") + '"'
    for key in ("family: lamp", "edition: v1"):
        (finding,) = findings(tmp_path, MINIMAL.replace(key, f"{key.split()[0]} {quoted}"))
        assert finding.rule in ("name", "value")
    assert {f.rule for f in findings(tmp_path, MINIMAL.replace("  dim:", f"  {quoted}:"))} <= {"name", "value"}
    assert findings(tmp_path, MINIMAL.replace("  dim:", f"  {quoted}:"))


@pytest.mark.parametrize("edition", ["v1.", "v1-", "v1..2", "-v1", ".v1"])
def test_editions_that_are_not_folder_names_are_rejected(edition: str, tmp_path: Path) -> None:
    assert [f.rule for f in findings(tmp_path, MINIMAL.replace("v1", f'"{edition}"'))] == ["name"]


@pytest.mark.parametrize(
    ("written", "rule"),
    [("٣", "value"), ("010", "value"), ("1e3", "value"), (".5", "value"), ("inf", "value"), ("0x", "value")],
)
def test_foreign_notations_of_numbers_are_rejected(written: str, rule: str, tmp_path: Path) -> None:
    for old in ("scale: 0.1", "at: 2"):
        text = MINIMAL.replace(old, f'{old.split()[0]} "{written}"')
        assert marked(findings(tmp_path, text)) == [f'{rule}: "{written}"']


def test_limits_accept_the_largest_valid_values() -> None:
    assert len(notation.nodes("0..65535")) == notation.MAX_NODES
    assert len(notation.indices("0..511")) == notation.MAX_ELEMENTS
    assert notation.at("id.28").bit == notation.LAST_ID_BIT
    assert notation.number("1" * notation.DIGITS) > 0
    assert MAX_COMMANDS >= 100 * 28


@pytest.mark.parametrize(
    "name",
    ["layout x commands x series", "enum x fields", "entries x commands", "array x commands", "bits x nodes x series"],
)
def test_excessive_output_is_rejected_with_its_size(name: str, tmp_path: Path) -> None:
    start = time.process_time()
    (finding,) = (reported for reported in findings(tmp_path, ATTACKS[name]().spec) if reported.rule == "too-large")
    assert time.process_time() - start < AT_ONCE
    assert "exceeds the maximum of" in finding.message
    assert finding.hint


def test_the_environment_raises_the_maximum_size_of_a_trusted_spec(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = MINIMAL + many(300, "  c#: {code: 0x20, request: {a: {at: 1, raw: u16, constant: #}}, reply: none}\n")
    assert "too-large" not in {reported.rule for reported in findings(tmp_path, text)}
    monkeypatch.setattr(too_large, "MAX_SIZE", 10_000)
    (finding,) = (reported for reported in findings(tmp_path, text) if reported.rule == "too-large")
    variable, _, size = finding.hint.partition("environment variable ")[2].partition("=")
    monkeypatch.setenv(variable, "none")
    assert "too-large" in {reported.rule for reported in findings(tmp_path, text)}
    monkeypatch.setenv(variable, size)
    assert "too-large" not in {reported.rule for reported in findings(tmp_path, text)}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("equal commands", "; 1399 more are not listed"),
        ("unknown layouts", "; 3300 more are not listed"),
        ("from_each of other nodes", "nodes in `from_each`"),
        ("overlapping big-endian fields", "; further overlaps of this message are not listed"),
    ],
)
def test_many_mistakes_are_counted_quickly(
    name: str, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CANWRIGHT_MAX_SIZE", "300000")  # the mistakes are counted, too, where the size is accepted
    start = time.process_time()
    reported = findings(tmp_path, ATTACKS[name]().spec)
    assert time.process_time() - start < AT_ONCE
    assert len(reported) <= MAX_FINDINGS
    assert expected in reported[-1].message


def test_too_many_ambiguous_pairs_are_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bit_patterns, "MAX_STEPS", 20)
    layout = "layouts: {l: {fields: {a: {at: 4, raw: u8}}}}\n"
    text = MINIMAL + many(9, "  c#: {code: 0x10, request: none, reply: l}\n") + layout
    assert [f.rule for f in findings(tmp_path, text)] == ["ambiguous-message"]


def test_a_link_to_a_file_outside_is_not_quoted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "secret").write_text("password: 1234\n", "utf-8")
    (tmp_path / "lamp").write_text(MINIMAL, "utf-8")
    folder = tmp_path / "clone"
    folder.mkdir()
    for name in ("secret", "lamp"):
        (folder / f"{name}.yaml").symlink_to(tmp_path / name)
    monkeypatch.chdir(folder)
    result = CliRunner().invoke(main, ["check", "--spec", "secret.yaml"])
    assert result.exit_code == 2
    assert "password" not in result.output and "is a link to a file outside the current folder" in result.output
    assert CliRunner().invoke(main, ["check", "--spec", "lamp.yaml"]).exit_code == 0


def test_the_root_of_the_file_system_is_no_output_folder(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    result = CliRunner().invoke(main, ["generate", "--spec", str(tmp_path / "lamp.yaml"), "--out", "/"])
    assert result.exit_code == 2
    assert "/ is the root of the file system; choose another folder" in result.output


def test_requests_of_one_address_are_not_replies_of_another(tmp_path: Path) -> None:
    addresses = "es: {other: {request: 0x181 + node, reply: 0x200 + node, nodes: 1..4}, "
    text = MINIMAL.replace("es: {", addresses, 1).replace(
        "id: 0x100 + node,", "request: 0x100 + node, reply: 0x180 + node,"
    )
    text = text.replace("  dim:", "  sub: {code: 0x20, address: other, reply: {a: {at: 2, raw: u8}}}\n  dim: ")
    text = text.replace("dim: \n", "dim:\n    address: lamp\n")
    (finding,) = findings(tmp_path, text)
    assert finding.rule == "id-collision"
    assert finding.message == "0x182 is the reply of node 2 here, and the request of node 1 of `other`"
    assert not findings(tmp_path, text.replace("0x181 + node", "0x180 + node"))


def test_a_file_has_a_limited_number_of_values(tmp_path: Path) -> None:
    (finding,) = findings(tmp_path, ATTACKS["long list"]().spec)
    assert (finding.rule, finding.position.line) == ("file-size", 7)


@pytest.mark.parametrize("name", ["enum x fields", "keys as names", "from_each of other nodes"])
def test_processes_with_limits_reject_attacks(name: str, tmp_path: Path) -> None:
    """With 600 MB of address space and 10 seconds of processor time, which the kernel enforces."""
    spec = ATTACKS[name]().write(tmp_path)
    arguments = ("-m", "canwright", "generate", "--spec", str(spec), "--out", str(tmp_path / "out"), "--no-cache")
    used = run(*arguments, log=tmp_path / "log", address_space=600 << 20, time_out=10)
    assert (used.status, "Traceback" in used.output) == (1, False)
    assert f"{spec}:" in used.output
    assert not (tmp_path / "out").exists()
