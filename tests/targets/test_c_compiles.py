"""The C headers under every compiler, standard and level, on a bare Cortex-M0, and several editions in one unit."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.c.expressions import raw_of
from canwright.targets.c.names import PARTS, Names, member
from canwright.targets.c.target import CTarget

from ..compilers import CORTEX_M0, LEVELS, STANDARDS, WARNINGS, ZIG, Compiler, each_compiler
from ..conformance.adapters.c_harness import harness
from ..conformance.adapters.c_signatures import functions
from ..spec_texts import MINIMAL, SMALL, called

ROOT = Path(__file__).parents[2]
CASES = Path(__file__).parent / "dbc"
MAIN = ROOT / "spec" / "mwd_motor" / "v2.35.yaml"
SPECS = [MAIN, CASES / "tiny.yaml", CASES / "packed.yaml"]


def write(described_: Sequence[EditionInput], folder: Path) -> Path:
    """The generated files below a folder."""
    for output in CTarget().generate(described_, {}):
        file = folder / output.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(output.text, "utf-8")
    return folder


def headers(described_: Sequence[EditionInput]) -> list[str]:
    names = [f"{d.edition.family}/{d.edition.identifier}" for d in described_]
    return [f"{name}{part}.h" for name in names for part in PARTS]


def everything(include: Path, names: Sequence[str]) -> str:
    """A unit that takes the address of every function, so that a compiler makes code of each."""
    function_names = [name for header in names for name in functions((include / header).read_text("utf-8"))]
    lines = [f'#include "{header}"' for header in [*names, *names]]
    table = [f"    (void (*)(void)){name}," for name in function_names]
    lines += ["extern void (*const everything[])(void);", "void (*const everything[])(void) = {", *table, "};"]
    return "\n".join([*lines, ""])


@pytest.fixture(scope="module")
def units(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `include/`, a unit that has all functions of all editions, and a program that uses the first."""
    folder = tmp_path_factory.mktemp("c")
    editions = [specification(spec) for spec in SPECS]
    include = write(editions, folder) / "include"
    (folder / "everything.c").write_text(everything(include, headers(editions)), "utf-8")
    (folder / "program.c").write_text(harness(editions[0].edition, include), "utf-8")
    return folder


@pytest.mark.parametrize("standard", STANDARDS)
@each_compiler
def test_no_warning(compiler: Compiler, standard: str, units: Path, tmp_path: Path) -> None:
    """Every function by itself at every level, and all of them inlined into a program.

    The warnings of zig depend neither on the level nor on what is inlined.
    """
    language = ("-x", "c++") if standard.startswith("c++") else ()
    flags = (*WARNINGS, f"-I{units / 'include'}", *language, "-c", "-o", tmp_path / "unit.o")
    for level in LEVELS[:1] if compiler is ZIG else LEVELS:
        compiler.check(standard, *flags, "-Wswitch-enum", level, units / "everything.c")
    if compiler is not ZIG:
        for level in ("-O1", "-O3"):  # GCC finds other variables that may be uninitialized at each
            compiler.check(standard, *flags, level, units / "program.c")


@pytest.mark.parametrize(
    "spec", [MAIN, *(spec for spec in SMALL if spec.parent.name in ("press", "valve"))], ids=called
)
@each_compiler
def test_a_program_may_read_the_fields_of_any_frame(compiler: Compiler, spec: Path, tmp_path: Path) -> None:
    """GCC does not relate the command to the member of the union, and says so at a level that depends on the program."""
    item = specification(spec)
    include = write([item], tmp_path) / "include"
    unit = tmp_path / "unit.c"
    for step in (1, 3, 5):
        unit.write_text(readers(item, include, step), "utf-8")
        for level in LEVELS[:1] if compiler is ZIG else ("-O1", "-O2", "-O3", "-Os"):
            compiler.check("c99", *WARNINGS, f"-I{include}", level, "-c", unit, "-o", tmp_path / "unit.o")


def readers(item: EditionInput, include: Path, step: int) -> str:
    """A unit with a function for each direction that reads the fields of every so many commands."""
    names = Names(item.edition)
    header = f"{item.edition.family}/{item.edition.identifier}.h"
    known = functions((include / header).read_text("utf-8"))
    lines = [f"#include <{header}>"]
    for direction in Direction:
        word = direction.value
        decode = known[names.lower("decode", word)]
        given = [f"{kind}{name.lstrip('*')}" for kind, name in zip(decode.types, decode.parameters, strict=True)][1:]
        head = f"int read_{word}(int64_t *sum, {', '.join(given)})"
        call = f"{decode.name}(&any, {', '.join(name.lstrip('*') for name in decode.parameters[1:])})"
        lines += [
            f"{head};",
            head,
            "{",
            f"    {names.lower('any', word, 't')} any;",
            f"    if ({call} != CANWRIGHT_OK) {{",
        ]
        lines += ["        return 1;", "    }", "    switch ((int)any.command) {"]
        for message in item.edition.messages(direction)[::step]:
            fields = [field for field in message.layout.fields if field.is_given]
            place = f"any.as.{member(names.short(message.command))}"
            lines.append(f"    case {names.command(message.command)}:")
            for field in fields:
                element = f"{place}.{member(field.name)}" + ("[0]" if field.is_array else "")
                lines.append(f"        *sum += (int64_t){raw_of(field.type, element)};")
            lines.append("        return 0;")
        lines += ["    default:", "        return 2;", "    }", "}"]
    return "\n".join([*lines, ""])


@each_compiler
def test_strict_cxx_takes_the_casts_of_c(compiler: Compiler, units: Path, tmp_path: Path) -> None:
    """What C++ projects forbid in their own code, and what a pragma of ours must not leave behind."""
    names = headers([specification(spec) for spec in SPECS])
    unit = tmp_path / "unit.cpp"
    unit.write_text("".join(f'#include "{name}"\n' for name in names) + "int own(double d);\n", "utf-8")
    forbidden = ["-Wold-style-cast", "-Wzero-as-null-pointer-constant"]
    forbidden += ["-Wuseless-cast"] if compiler.name == "gcc" else []
    flags = (*WARNINGS, *forbidden, f"-I{units / 'include'}")
    arguments: tuple[str | Path, ...] = (*flags, "-c", unit, "-o", tmp_path / "unit.o")
    compiler.check("c++17", *arguments)
    with unit.open("a", encoding="utf-8") as file:
        file.write("int own(double d)\n{\n    return (int)d;\n}\n")
    with pytest.raises(AssertionError, match="old-style"):
        compiler.check("c++17", *arguments)


def test_every_macro_and_member_has_a_comment(units: Path) -> None:
    """Doxygen with WARN_IF_UNDOCUMENTED says nothing; include guards it knows by itself."""
    for header in sorted((units / "include").rglob("*.h")):
        text = header.read_text("utf-8")
        declared = [(_before(text, match), match[0]) for match in re.finditer(r"^#define .*", text, re.M)]
        for struct in re.findall(r"^typedef struct \{(.*?)^\}", text, re.DOTALL | re.MULTILINE):
            declared += re.findall(r"(.*)\n( +(?:\w+ \w+\S*;|union \{))(?=\n)", struct)
        assert declared
        for before, line in declared:
            assert before.endswith("*/") or before.startswith("#ifndef") or "/**<" in line, f"{header.name}: {line}"


def _before(text: str, define: re.Match[str]) -> str:
    """The line before a definition; of alternative definitions of one macro, the line before the first."""
    name = define[0].split()[1]
    lines = text[: define.start()].splitlines()
    while re.match(rf"#(?:if |elif|else|ifndef {name}$|define {name}\b)", lines[-1]):
        lines.pop()
    return lines[-1]


def test_two_editions_of_a_family_in_one_unit(tmp_path: Path) -> None:
    second = tmp_path / "second.yaml"
    second.write_text(re.sub(r"(?m)^edition: .*$", "edition: v9-second", MAIN.read_text("utf-8")), "utf-8")
    editions = [specification(MAIN), specification(second)]
    include = write(editions, tmp_path) / "include"
    unit = tmp_path / "both.c"
    unit.write_text(everything(include, headers(editions)), "utf-8")
    for standard, language in (("c99", ()), ("c++17", ("-x", "c++"))):
        ZIG.check(standard, *WARNINGS, f"-I{include}", *language, "-c", unit, "-o", tmp_path / "both.o")


@pytest.mark.parametrize("standard", ["c99", "c++17"])
def test_bare_cortex_m0(standard: str, units: Path, tmp_path: Path) -> None:
    """No library but that of the compiler itself: the linker finds every function that is called."""
    language = ("-x", "c++") if standard.startswith("c++") else ()
    flags = (*CORTEX_M0, *WARNINGS, "-Os", f"-I{units / 'include'}", *language)
    ZIG.check(standard, *flags, "-c", units / "everything.c", "-o", tmp_path / "unit.o")


def test_main_header_has_no_float(units: Path) -> None:
    for header in sorted((units / "include").rglob("*.h")):
        text = re.sub(r"/\*.*?\*/", "", header.read_text("utf-8"), flags=re.S)
        includes = set(re.findall(r"#include <(.*?)>", text))
        if header.stem.endswith("_float"):
            assert includes <= {"float.h"}
        else:
            assert includes - {"avr/pgmspace.h"} <= {"stdbool.h", "stddef.h", "stdint.h"}
            assert "avr/pgmspace.h" not in includes or header.stem == "canwright_selftest"
            assert not re.search(r"\b(float|double)\b", text)


def test_two_runs_give_the_same_bytes(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path; from canwright.project.loader import specification; from canwright.targets.c.target import CTarget; "
        "sys.stdout.write(repr([(o.path, o.text) for o in CTarget().generate([specification(Path(sys.argv[1]))], {})]))"
    )
    made = {
        subprocess.run(
            [sys.executable, "-c", program, str(MAIN)],
            capture_output=True,
            check=True,
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT / "generator")},
        ).stdout
        for seed in ("1", "2")
    }
    assert len(made) == 1


@pytest.mark.interop("cmake", "ninja")
def test_example_builds_and_runs(tmp_path: Path) -> None:
    folder = write([specification(MAIN)], tmp_path / "c")
    build, prefix, examples = tmp_path / "build", tmp_path / "prefix", tmp_path / "examples"
    cmake("-S", folder, "-B", build, f"-DCMAKE_INSTALL_PREFIX={prefix}")
    cmake("--build", build)
    cmake("--install", build)
    cmake("-S", folder / "examples", "-B", examples, f"-DCMAKE_PREFIX_PATH={prefix}")
    cmake("--build", examples)
    programs = [f for f in sorted(examples.iterdir()) if f.is_file() and f.stat().st_mode & 0o111 and not f.suffix]
    assert programs
    for program in programs:
        done = subprocess.run([program], capture_output=True, text=True, check=False)
        if program.name.endswith("_socketcan"):
            assert (done.returncode, done.stdout) == (1, "")
            assert done.stderr.startswith("can0: ")
        else:
            assert (done.returncode, done.stderr) == (0, "")
            assert done.stdout


@pytest.mark.parametrize("has_golden_frames", [True, False])
@pytest.mark.parametrize("spec", SMALL, ids=called)
def test_example_shows_exchanges_in_which_the_reply_answers(
    spec: Path, has_golden_frames: bool, tmp_path: Path
) -> None:
    item = specification(spec)
    folder = write([item if has_golden_frames else EditionInput(item.edition, None)], tmp_path / "c")
    for source in {*folder.glob("examples/*.c")} - {*folder.glob("examples/*_socketcan.c")}:
        program = tmp_path / "program"
        ZIG.run("c99", *WARNINGS, f"-I{folder / 'include'}", source, "-o", program)
        done = subprocess.run([program], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout.split()[-1]) == (0, "ok"), done.stdout


def test_an_id_that_code_or_fields_go_into_is_said_to_lack_them() -> None:
    said = [
        o.text for o in CTarget().generate([specification(CASES / "packed.yaml")], {}) if o.path == "include/drive/v1.h"
    ]
    assert "/** The id of a request to a node, without the bits of code and fields. */" in said[0]
    assert "/** The id of a request. */" in said[0]


def test_without_exchanges_there_are_no_examples(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    spec.write_text(MINIMAL.replace("reply: echo", "reply: none"), "utf-8")
    folder = write([specification(spec)], tmp_path / "c")
    assert not (folder / "examples").exists()
    assert "examples" not in (folder / "README.md").read_text("utf-8")


def test_the_readme_shows_the_parameters_of_the_first_edition_that_has_any(tmp_path: Path) -> None:
    scaled = MINIMAL.replace("family: lamp", "family: motor").replace("scale: 0.1", "scale: 2/65535*size")
    texts = (
        MINIMAL,
        f"{scaled.replace(', raw_range: 0..1000', '')}parameters: {{size: {{number: {{}}, title: Largest value}}}}\n",
    )
    specs = [tmp_path / f"{i}.yaml" for i in range(len(texts))]
    for spec, text in zip(specs, texts, strict=True):
        spec.write_text(text, "utf-8")
    readme = (write([specification(spec) for spec in specs], tmp_path / "c") / "README.md").read_text("utf-8")
    assert "const motor_v1_parameters_t node_1 = {\n    .size = {6, 1u},\n};" in readme


def cmake(*arguments: str | Path) -> str:
    """The output of the CMake of PyPI, with the Ninja and the compilers of PyPI where it configures."""
    command = [sys.executable, "-c", "import cmake; cmake.cmake()", *map(str, arguments)]
    if arguments[0] == "-S":
        find = (sys.executable, "-c", "import ninja; print(ninja.BIN_DIR)")
        ninja = subprocess.run(find, capture_output=True, text=True, check=True).stdout.strip()
        cxx = (*ZIG.cxx, "-nostdlib++")  # zig would first build the library of C++, for a minute
        compilers = [f"-DCMAKE_C_COMPILER={';'.join(ZIG.c)}", f"-DCMAKE_CXX_COMPILER={';'.join(cxx)}"]
        command += ["-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={ninja}/ninja", *compilers]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("spec", [MAIN, *SMALL], ids=called)
def test_the_programs_of_the_readme_compile(spec: Path, tmp_path: Path) -> None:
    item = specification(spec)
    folder = write([item], tmp_path)
    has_examples = bool(list(folder.glob("examples/*.c")))
    has_flags = any("_first_flag(" in header.read_text("utf-8") for header in folder.glob("include/*/v*.h"))
    expected = {"c": 3 * has_examples + 3 + has_flags + bool(item.edition.parameters), "cpp": has_examples + 1}
    for language, standard, include in (("c", "c99", "include"), ("cpp", "c++17", "src")):
        blocks = re.findall(rf"```{language}\n(.*?)```", (folder / "README.md").read_text("utf-8"), re.DOTALL)
        assert len(blocks) == expected[language]
        for number, block in enumerate(blocks):
            unit = tmp_path / f"{number}.{language}"
            unit.write_text(block, "utf-8")
            ZIG.check(standard, *WARNINGS, f"-I{folder / include}", "-c", unit, "-o", tmp_path / "unit.o")


@pytest.mark.interop("cmake", "ninja")
def test_cmake_serves_a_project_in_cxx_alone_and_keeps_editions_apart(tmp_path: Path) -> None:
    folder = write([specification(MAIN), specification(MAIN.with_name("v2.36-2025-03.yaml"))], tmp_path / "c")
    prefix = tmp_path / "prefix"
    cmake("-S", folder, "-B", tmp_path / "build", f"-DCMAKE_INSTALL_PREFIX={prefix}")
    cmake("--install", tmp_path / "build")
    use = """
#include <mwd_motor/v2_35.h>
#include <mwd_motor/v2_36_2025_03.h>
int main(void)
{
    canwright_frame_t frame;
    mwd_motor_v2_35_set_speed_request_t message = {0};
    return (int)mwd_motor_%s_set_speed_request_encode(&frame, 1u, &message);
}
"""
    for language, ending, edition, compiles in (
        ("CXX", "cpp", "v2_35", True),
        ("C", "c", "v2_35", True),
        ("C", "c", "v2_36_2025_03", False),
    ):
        project = tmp_path / f"{language}_{edition}"
        project.mkdir()
        (project / f"main.{ending}").write_text(use % edition, "utf-8")
        lines = (
            "cmake_minimum_required(VERSION 3.15)",
            f"project(use LANGUAGES {language})",
            "find_package(mwd_motor REQUIRED)",
            f"add_executable(use main.{ending})",
            "target_link_libraries(use PRIVATE mwd_motor::mwd_motor)",
        )
        (project / "CMakeLists.txt").write_text("\n".join(lines), "utf-8")
        cmake("-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
        if compiles:
            cmake("--build", project / "build")
        else:
            with pytest.raises(AssertionError, match="incompatible pointer type"):
                cmake("--build", project / "build")


QT = """\
#define signals public
#define slots
#define emit
#define foreach for
#define forever for (;;)
"""
"""What the headers of Qt define in lower case, unless a program defines QT_NO_KEYWORDS."""


def test_names_of_qt_are_renamed(tmp_path: Path) -> None:
    names = re.findall(r"#define (\w+)", QT)
    types = "".join(f"  {name}: {{raw: u8, scale: 0.5}}\n" for name in names)
    commands = "".join(
        f'  {name}: {{code: {code}, manual: "1", request: {{{name}: {{at: 1, type: {name}}}}}, reply: echo}}\n'
        for code, name in enumerate(names)
    )
    text = MINIMAL.partition("types:")[0] + f"types:\n{types}commands:\n{commands}"
    spec = tmp_path / "lamp.yaml"
    spec.write_text(text, "utf-8")
    write([specification(spec)], tmp_path)
    unit = tmp_path / "unit.cpp"
    program = "int main()\n{\n    const lamp_v1_emit_request_t sent = CANWRIGHT_ZERO;\n    return sent.emit_;\n}\n"
    unit.write_text(f'{QT}#include "lamp/v1.hpp"\n{program}', "utf-8")
    ZIG.check("c++17", "-x", "c++", f"-I{tmp_path}/include", "-c", "-o", tmp_path / "unit.o", unit)
