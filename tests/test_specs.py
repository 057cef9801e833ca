"""The small whole specs: nothing to find in them, and every target of theirs stands up to its tools."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.project.loader import all_loaded, frames_file
from canwright.project.pipeline import generate
from canwright.targets.options import NO_OPTIONS
from canwright.targets.registry import default_targets, targets
from click.testing import CliRunner

from .compilers import WARNINGS, ZIG, Compiler, each_compiler
from .spec_texts import MINIMAL, ROOT, SMALL, called, edition, findings, marked
from .targets.test_c_compiles import everything, headers

FRAMES = [frames_file(spec) for spec in SMALL]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All targets of all small specs, in one folder."""
    folder = tmp_path_factory.mktemp("specs")
    items = [loaded.specification for loaded in all_loaded(SMALL)]
    for path, content in generate(items, default_targets(), {}).files.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    (folder / "everything.c").write_text(everything(folder / "c/include", headers(items)), "utf-8")
    return folder


@pytest.mark.parametrize("spec", SMALL, ids=called)
def test_check_finds_nothing_in_a_small_spec(spec: Path) -> None:
    result = CliRunner().invoke(main, ["check", "--strict", "--spec", str(spec)], catch_exceptions=False)
    assert result.exit_code == 0, result.output


@pytest.mark.interop("check_jsonschema")
@pytest.mark.parametrize(
    ("schema", "files"), [("canwright.schema.json", SMALL), ("canwright.frames.schema.json", FRAMES)]
)
def test_the_json_schema_accepts_the_small_specs(schema: str, files: list[Path]) -> None:
    _succeeds(sys.executable, "-m", "check_jsonschema", "--schemafile", ROOT / "spec" / schema, *files)


@pytest.mark.parametrize("standard", ["c99", "c++17"])
@each_compiler
def test_headers_of_all_small_specs_compile_without_a_warning(
    compiler: Compiler, standard: str, made: Path, tmp_path: Path
) -> None:
    language = ("-x", "c++") if standard.startswith("c++") else ()
    level = "-O0" if compiler is ZIG else "-O2"  # the warnings of zig do not depend on it
    flags = (*WARNINGS, level, *language, f"-I{made}/c/include", "-c", "-o", tmp_path / "unit.o")
    compiler.check(standard, *flags, made / "everything.c")


@pytest.mark.interop("mypy")
def test_mypy_finds_nothing_in_the_packages_of_small_specs(made: Path) -> None:
    families = sorted({spec.parent.name for spec in SMALL})
    mypy = (sys.executable, "-m", "mypy", "--strict", "--no-incremental")
    _succeeds(*mypy, *families, folder=made / "python")
    packages = [f"{family}_columns" for family in families]
    pyarrow = ("--disable-error-code=import-untyped", "--disable-error-code=import-not-found")
    _succeeds(*mypy, *pyarrow, *packages, folder=made / "columns")


def _succeeds(*command: str | Path, folder: Path | None = None) -> None:
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr


TOGETHER = """\
  fast: {code: 0x20, request: {mode: {at: 1, raw: u8, constant: 1}, speed: {at: 2, raw: u16}}, reply: none}
  slow: {code: 0x20, request: {mode: {at: 1, raw: u8, constant: 2}, time: {at: 2, raw: u16}}, reply: none}
  stop: {code: 0x21, request: {mode: {at: 1, raw: u8, constant: 3}}, reply: none}
"""


def test_a_constant_that_tells_messages_apart_is_a_key(tmp_path: Path) -> None:
    item = edition(tmp_path, MINIMAL + TOGETHER)
    requests = {c.name: c.request for c in item.commands if c.request}
    assert [(k.name, k.value) for k in requests["slow"].keys] == [("code", 0x20), ("mode", 2)]
    assert [f.name for f in requests["slow"].layout.fields] == ["time"]
    assert [f.name for f in requests["stop"].layout.fields] == ["mode"]


def test_constants_identify_a_message_only_where_another_has_fields(tmp_path: Path) -> None:
    fixed = MINIMAL + "  stop: {request: {all: {at: 0, raw: u64, constant: 5}}, reply: none}\n"
    rest = fixed + "  go: {request: {speed: {at: 0, raw: u16}}, reply: none}\n"
    assert marked(findings(tmp_path, rest)) == []
    elsewhere = (
        fixed.replace("{at: 0, raw: u64", "{at: 4, raw: u32") + "  go: {request: {a: {at: 1, raw: u8}}, reply: none}\n"
    )
    assert marked(findings(tmp_path, elsewhere))[0] == "ambiguous-message: request"


def test_each_address_has_a_selector_of_its_own(tmp_path: Path) -> None:
    text = MINIMAL.replace(
        "addresses: {",
        "addresses: {far: {request: 0x200 + node, reply: 0x300, nodes: 1..4, selector: {at: 1, raw: u8}, "
        "reply_selector: {at: 2, raw: u16}}, ",
    ).replace("  dim:\n", "  dim:\n    address: lamp\n")
    commands = edition(tmp_path, text + "  ask: {code: 0x10, reply: {level: {at: 4, type: level}}}\n").commands

    def places(number: int) -> list[tuple[int, int]]:
        both = (commands[number].request, commands[number].reply)
        return [(m.keys[0].segments[0].byte, m.keys[0].width) for m in both if m]

    assert (places(0), places(1)) == ([(0, 8), (0, 8)], [(1, 8), (2, 16)])


def test_a_selector_below_very_many_nodes(tmp_path: Path) -> None:
    text = MINIMAL.replace("{id: 0x100 + node, nodes: 1..4}", "{id: node << 5, nodes: 0..65535, extended: true}")
    assert marked(findings(tmp_path, text.replace("{at: 0, raw: u8}", "{at: id.0, raw: u5}"))) == []
    assert marked(findings(tmp_path, text.replace("{at: 0, raw: u8}", "{at: id.1, raw: u5}"))) == ["id-bits: id.1"]


def test_fields_beside_a_layout(tmp_path: Path) -> None:
    text = MINIMAL + (
        "  ask: {code: 0x11, reply: {layout: state, fields: {lamp: {at: 1, raw: u8}}}}\n"
        "layouts: {state: {fields: {level: {at: 2, type: level}}}}\n"
    )
    reply = edition(tmp_path, text).command("ask").reply
    assert reply and (reply.layout.name, reply.layout.shared) == ("ask_reply", False)
    assert [f.name for f in reply.layout.fields] == ["lamp", "level"]
    assert marked(findings(tmp_path, text.replace("{lamp: {at: 1", "{level: {at: 1"))) == ["duplicate-name: level"]
    assert marked(findings(tmp_path, text.replace("at: 1,", "at: 2,"))) == ["overlap: 2"]


def test_fields_and_layout_depend_on_one_parameter(tmp_path: Path) -> None:
    text = MINIMAL + (
        "  ask: {code: 0x11, reply: {layout: state, fields: {lamp: {at: 1, raw: u8, only: {size: [S]}}}}}\n"
        "layouts: {state: {fields: {level: {at: 2, type: level, only: {kind: [A]}}}}}\n"
        "parameters: {size: {values: {S: {}, L: {}}}, kind: {values: {A: {}, B: {}}}}\n"
    )
    assert marked(findings(tmp_path, text)) == ["two-parameters: {"]


def test_a_bare_number_has_a_byte_order(tmp_path: Path) -> None:
    text = MINIMAL + "  ask: {code: 0x11, reply: {a: {at: 1, raw: u16, byte_order: big}, b: {at: 3, raw: u16}}}\n"
    reply = edition(tmp_path, text).command("ask").reply
    assert reply and [f.type.name for f in reply.layout.fields] == ["u16_big", "u16"]
    both = text.replace("raw: u16, byte_order: big", "type: level, byte_order: big")
    assert marked(findings(tmp_path, both)) == ["field-type: big"]


def test_addresses_may_share_all_their_ids(tmp_path: Path) -> None:
    text = MINIMAL.replace(
        "{lamp: {id: 0x100 + node", "{far: {request: 0x300, reply: 0x7F}, lamp: {request: 0x100 + node"
    )
    text = text.replace("nodes: 1..4}", "reply: 0x7F, nodes: 1..4}").replace("  dim:\n", "  dim:\n    address: lamp\n")
    assert marked(findings(tmp_path, text + "  ask: {code: 0x11, reply: none}\n")) == []


def test_every_target_accepts_an_empty_list_of_editions() -> None:
    for target in targets():
        list(target.generate([], {}, NO_OPTIONS))
