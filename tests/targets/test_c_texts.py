"""Texts of a spec that try to leave the comment they are put into, and names that C has taken."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget
from canwright.targets.c.text import fold

from ..compilers import WARNINGS, ZIG
from ..spec_texts import ROOT
from .test_c_compiles import everything, headers, write

PUMP = ROOT / "tests/specs/pump/v1.yaml"

HOSTILE = [
    "*/ #error out /*",
    "/* nested",
    "ends in a backslash \\",
    "ends in a trigraph ??/",
    "*\\\n/ #error spliced",
    "*??/\n/ #error spliced",
    "line\nbreak",
    "@code @endcode @{ @}",
    "<script>alert(1)</script> <b>",
    "\" quote %s %n ' {{ braces }} {% raw %}",
    "中文 ° µ",
]

CODE = (".c", ".h", ".hpp", ".ino")

SPEC = """\
canwright: 1
family: lamp
edition: v1
title: {text}
about: {text}
manual: {text}
addresses: {{lamp: {{id: 0x100 + node, nodes: 1..4, title: {text}, about: {text}}}}}
selector: {{at: 0, raw: u8}}
parameters:
  size: {{values: {{small: {{title: {text}}}, big: {{}}}}, title: {text}, about: {text}}}
types:
  level: {{raw: u16, unit: "%", scale: {{by: size, small: 0.1, big: none}}, title: {text}, about: {text}}}
  colour: {{raw: u8, enum: {{red: {{value: 1, title: {text}}}}}, title: {text}}}
commands:
  dim:
    code: 0x10
    manual: {text}
    title: {text}
    about: {text}
    notes: [{text}]
    request: {{level: {{at: 2, type: level, title: {text}}}, colour: {{at: 1, type: colour}}}}
    reply: echo
"""


def _quoted(text: str) -> str:
    escaped = "".join(c if (c.isalnum() and c.isascii()) or c == " " else f"\\U{ord(c):08X}" for c in text)
    return f'"{escaped}"'


def _bare(source: str) -> list[str]:
    """The words of a source without comments and the hashes of the spec, as a compiler sees them: trigraphs and line ends first."""
    spliced = source.replace("??/", "\\").replace("\\\n", "")
    return re.sub(r"/\*.*?\*/|\b0x[0-9a-f]{8}u\b|\"[0-9a-f]{64}\"", " ", spliced, flags=re.S).split()


def _code(folder: Path, text: str) -> tuple[dict[str, str], dict[str, list[str]]]:
    file = folder / "spec.yaml"
    file.write_text(SPEC.format(text=_quoted(text)), "utf-8")
    made = {output.path: output.text for output in CTarget().generate([specification(file)], {})}
    return made, {path: _bare(source) for path, source in made.items() if path.endswith(CODE)}


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_a_text_stays_in_its_comment(text: str, tmp_path: Path) -> None:
    made, code = _code(tmp_path, text)
    assert code == _code(tmp_path, "plain")[1]
    _compile(tmp_path)
    for path, source in made.items():
        unseen = [c for c in source if c != "\n" and not c.isprintable()]
        assert not unseen, (path, unseen)
        if path.endswith(CODE):
            assert "??" not in source, path
            assert not re.search(r"\\$", re.sub(r"(?m)^#define .*(\n.*\\$)*", "", source), flags=re.M), path


def test_a_field_may_have_a_name_that_c_has_taken(tmp_path: Path) -> None:
    text = SPEC.format(text="Plain").replace("level: {at", "default: {at").replace("colour: {at", "class: {at")
    (tmp_path / "spec.yaml").write_text(text, "utf-8")
    for standard in ("c99", "c++17"):
        _compile(tmp_path, standard)


def _compile(folder: Path, standard: str = "c99") -> None:
    """Compiles all functions of the spec in a folder, with comments checked."""
    made = [specification(folder / "spec.yaml")]
    include = write(made, folder) / "include"
    unit = folder / "everything.c"
    unit.write_text(everything(include, headers(made)), "utf-8")
    language = ("-x", "c++") if standard.startswith("c++") else ()
    flags = (*WARNINGS, "-Wcomment", "-Wtrigraphs", *language, f"-I{include}")
    ZIG.check(standard, *flags, "-c", unit, "-o", folder / "unit.o")


def test_comments_state_the_names_of_numbers() -> None:
    made = {output.path: output.text for output in CTarget().generate([specification(PUMP)], {})}
    comment = re.sub(r"\s*\n\s*\* ", " ", made["include/pump/v1.h"])
    assert comment.count("Raw -100000..100000. Named: full (100000), backwards (-100000), still (0).") >= 2


def test_two_things_with_one_name_in_c_are_refused(tmp_path: Path) -> None:
    layouts = "layouts: {parameters: {fields: {level: {at: 2, type: level}}}}\ncommands:"
    text = SPEC.format(text="Plain").replace("commands:", layouts).replace("reply: echo", "reply: parameters")
    file = tmp_path / "spec.yaml"
    file.write_text(text, "utf-8")
    with pytest.raises(Exception, match="lamp_v1_parameters_t"):
        list(CTarget().generate([specification(file)], {}))


def test_only_a_function_ends_with_a_brace_at_the_margin(tmp_path: Path) -> None:
    for path, source in _code(tmp_path, "plain")[0].items():
        assert not re.search(r"^}\n +\S", source, flags=re.M), path


def test_long_code_is_folded_and_comments_and_directives_are_not() -> None:
    name, word = "a" * 60, "b" * 60
    head = f"static inline void {name}(int one, int {word})"
    assert fold(head) == f"static inline void {name}(\n    int one, int {word})"
    assert fold(f"    if ({name} && {word}) {{") == f"    if ({name}\n        && {word}) {{"
    assert fold(f"    {name}(1, {word}, 2);") == f"    {name}(1,\n        {word}, 2);"
    for line in (f"/* {name}, {word} */", f" * {name}, {word}", f"#error {name}, {word}", f"typedef {name} {word};"):
        assert fold(line) == line
