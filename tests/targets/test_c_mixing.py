"""All editions in one translation unit, and mixing them up does not compile."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from canwright.project.loader import spec_files, specification
from canwright.targets.c.target import CTarget

from ..compilers import WARNINGS, ZIG, Compiler, each_compiler
from ..spec_texts import MEANT_ORDER, ROOT, reversed_keys
from .test_c_compiles import everything, headers

INCLUDE = ROOT / "generated/c/include"
MAIN = ROOT / "spec/mwd_motor/v2.35.yaml"
NAMES = headers([specification(file) for file in spec_files(ROOT / "spec")])
OLD, NEW = "mwd_motor_v2_35", "mwd_motor_v2_35_2024_02"

USE = """
{includes}
canwright_status_t use(void);
canwright_status_t use(void)
{{
    {old}_read_status_1_reply_t message = {{0}};
    canwright_frame_t frame;
    return {encode}_read_status_1_reply_encode(&frame, 1u, &message);
}}
"""
PARAMETERS = """
{includes}
canwright_status_t use(double *value);
canwright_status_t use(double *value)
{{
    static {old}_parameters_t known;
    return {encode}_torque_current_to_double(value, 100, &known);
}}
"""
TABLE = """
{includes}
extern const {old}_read_status_1_reply_t last_status[32];
const {encode}_read_status_1_reply_t last_status[32] = {{{{0}}}};
"""


@pytest.mark.parametrize("standard", ["c99", "c++17"])
@each_compiler
def test_all_editions_in_one_unit(compiler: Compiler, standard: str, tmp_path: Path) -> None:
    assert len(NAMES) == 12
    unit = tmp_path / "unit.c"
    unit.write_text(everything(INCLUDE, NAMES), "utf-8")
    language = ("-x", "c++") if standard == "c++17" else ()
    compiler.check(standard, *WARNINGS, *language, f"-I{INCLUDE}", "-c", unit, "-o", tmp_path / "unit.o")


@pytest.mark.parametrize("standard", ["c99", "c++17"])
@pytest.mark.parametrize("source", [USE, PARAMETERS, TABLE], ids=["message", "parameters", "table"])
@each_compiler
def test_mixing_editions_up_does_not_compile(compiler: Compiler, source: str, standard: str, tmp_path: Path) -> None:
    includes = "\n".join(f'#include "{name}"' for name in NAMES)
    for encode in (OLD, NEW):
        unit = tmp_path / f"{encode}.c"
        unit.write_text(source.format(includes=includes, old=OLD, encode=encode), "utf-8")
        language = ("-x", "c++") if standard == "c++17" else ()
        flags = (*language, "-Werror=incompatible-pointer-types" if standard == "c99" else "-Werror", f"-I{INCLUDE}")
        arguments = (*flags, "-c", unit, "-o", tmp_path / "unit.o")
        if encode == OLD:
            compiler.check(standard, *arguments)
            continue
        with pytest.raises(AssertionError, match="mwd_motor_v2_35"):
            compiler.check(standard, *arguments)


HEADERS = ("v2_35_float.h", "v2_35_print.h", "v2_35_selftest.h", "v2_35.hpp")
"""The headers of an edition that include the first one."""


def mixed(folder: Path, text: str) -> list[tuple[str | Path, ...]]:
    """Arguments of compilers for each of these headers, with the first header of another text of the same edition."""
    shutil.copytree(INCLUDE, folder / "include")
    changed = folder / "v2.35.yaml"
    changed.write_text(text, "utf-8")
    made = {output.path: output.text for output in CTarget().generate([specification(changed)], {})}
    (folder / "include/mwd_motor/v2_35.h").write_text(made["include/mwd_motor/v2_35.h"], "utf-8")
    arguments: list[tuple[str | Path, ...]] = []
    for name in HEADERS:
        is_cxx = name.endswith(".hpp")
        unit = folder / (f"{name}.cpp" if is_cxx else f"{name}.c")
        unit.write_text(f"#include <mwd_motor/{name}>\n", "utf-8")
        standard = "c++17" if is_cxx else "c99"
        arguments.append((standard, *WARNINGS, f"-I{folder / 'include'}", "-c", unit, "-o", folder / "unit.o"))
    return arguments


def test_headers_from_before_and_after_a_comment_compile_together(tmp_path: Path) -> None:
    for arguments in mixed(tmp_path, f"# changed\n{MAIN.read_text('utf-8')}"):
        ZIG.check(*map(str, arguments))


def test_headers_of_another_order_compile_together(tmp_path: Path) -> None:
    """Except the self-test, whose tables are in the order of the members of structs."""
    for name, arguments in zip(
        HEADERS, mixed(tmp_path, reversed_keys(MAIN.read_text("utf-8"), MEANT_ORDER)), strict=True
    ):
        if name != "v2_35_selftest.h":
            ZIG.check(*map(str, arguments))


def test_headers_of_different_meanings_do_not_compile_together(tmp_path: Path) -> None:
    text = MAIN.read_text("utf-8")
    changed = text.replace("code: 0xA1", "code: 0xAF")
    assert changed != text
    for name, arguments in zip(HEADERS, mixed(tmp_path, changed), strict=True):
        with pytest.raises(
            AssertionError, match=rf"v2_35\.h and {re.escape(name)} were generated from different specs"
        ):
            ZIG.check(*map(str, arguments))
