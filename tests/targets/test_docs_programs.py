"""The programs on the pages: extracted from the pages, compiled and run, all of them."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import pytest
from canwright.model import formatting
from canwright.model.golden_frames import GoldenFrame
from canwright.project.loader import specification
from canwright.targets.base import CodeExample, EditionInput, Output, Target, WorkedExchange
from canwright.targets.c.target import CTarget
from canwright.targets.docs import common
from canwright.targets.docs.target import DocsTarget, folders
from canwright.targets.examples import Examples
from canwright.targets.python.target import PythonTarget

from ..compilers import WARNINGS, ZIG
from ..spec_texts import MINIMAL, SPECS


class Expected(NamedTuple):
    """The golden frames that the programs of a page show."""

    request: GoldenFrame | None
    reply: GoldenFrame | None


@pytest.fixture(scope="module")
def specifications() -> list[EditionInput]:
    return [specification(spec) for spec in SPECS]


@pytest.fixture(scope="module")
def programs(specifications: list[EditionInput]) -> Mapping[tuple[str, str], str]:
    """The programs by page and language."""
    pages = {
        output.path: output.text for output in DocsTarget().generate(specifications, {}) if "/commands/" in output.path
    }
    by_page = {}
    for path, text in pages.items():
        for language, program in re.findall(r"^```(c|python)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            by_page[path, language] = program
    return by_page


@pytest.fixture(scope="module")
def expected(specifications: list[EditionInput]) -> Mapping[str, Expected]:
    """What the programs of each English page show."""
    names = folders([edition_input.edition for edition_input in specifications])
    by_page = {}
    for edition_input in specifications:
        examples = Examples(edition_input.edition, edition_input.frames)
        for command in edition_input.edition.commands:
            exchange = examples.select(command).exchange
            path = f"en/{names[edition_input.edition]}/commands/{command.spec_name}.md"
            if exchange and path not in by_page:
                by_page[path] = Expected(exchange.request, exchange.reply)
    return by_page


def _written(outputs: Iterator[Output], folder: Path) -> None:
    for output in outputs:
        path = folder / output.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(output.text, "utf-8")


def _shows(line: str, frame: GoldenFrame) -> bool:
    """Whether a line of text has the node and the values of a frame."""
    shown = dict(re.findall(r"(\w+)=(-?[0-9.]+)(?=[ ,)]|$)", line))
    numbers = {name: value for name, value in frame.values.items() if isinstance(value, Fraction) and name in shown}
    return all(math.isclose(float(shown[name]), value, rel_tol=2e-3, abs_tol=6e-3) for name, value in numbers.items())


def test_every_command_with_golden_frames_has_programs(
    programs: Mapping[tuple[str, str], str], expected: Mapping[str, Expected]
) -> None:
    assert {(path, language) for path in expected for language in ("c", "python")} == {
        (path, language) for path, language in programs if path.startswith("en/")
    }
    for (path, language), program in programs.items():
        assert programs[re.sub("^../", "en/", path), language] == program


def test_programs_in_c(
    programs: Mapping[tuple[str, str], str],
    expected: Mapping[str, Expected],
    specifications: list[EditionInput],
    tmp_path: Path,
) -> None:
    _written(CTarget().generate(specifications, {}), tmp_path)
    pages = list(expected)
    unit, calls = [], []
    for i, page in enumerate(pages):
        unit.append(programs[page, "c"].replace("int main(void)", f"static int program_{i}(void)"))
        calls.append(f'    (void)printf("#%d\\n", program_{i}());\n')
    source = tmp_path / "programs.c"
    source.write_text("\n".join([*unit, "int main(void)\n{\n", *calls, "    return 0;\n}\n"]), "utf-8")
    ZIG.run("c99", *WARNINGS, "-O0", f"-I{tmp_path}/include", source, "-o", tmp_path / "programs")
    done = subprocess.run([str(tmp_path / "programs")], capture_output=True, text=True, check=True)
    printed = re.findall(r"((?:.+\n)*?)#(-?\d+)\n", done.stdout)
    for page, (text, status) in zip(pages, printed, strict=True):
        assert status == "0", f"{page}: {text}"
        frames = [frame for frame in expected[page] if frame]
        for line, frame in zip(text.splitlines(), frames, strict=True):
            assert f" {frame.direction.value}" in line, page
            assert frame.node is None or f", node {frame.node}" in line, page
            assert _shows(line, frame), f"{page}: {line}"


def test_programs_in_python(
    programs: Mapping[tuple[str, str], str],
    expected: Mapping[str, Expected],
    specifications: list[EditionInput],
    tmp_path: Path,
) -> None:
    _written(PythonTarget().generate(specifications, {}), tmp_path)
    pages = list(expected)
    script = (
        "import contextlib, io, json, sys\n"
        "found = []\n"
        "for program in json.load(sys.stdin):\n"
        "    with contextlib.redirect_stdout(io.StringIO()) as printed:\n"
        "        exec(program, {})\n"
        "    found.append(printed.getvalue())\n"
        "print(json.dumps(found))\n"
    )
    given = json.dumps([programs[page, "python"] for page in pages])
    done = subprocess.run(
        [sys.executable, "-c", script], input=given, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for page, text in zip(pages, json.loads(done.stdout), strict=True):
        lines = text.splitlines()
        if (request := expected[page].request) is not None:
            id_, _, data = lines.pop(0).partition(" ")
            remote = "R" if request.remote else data.replace(" ", "")
            assert f"{id_}#{remote}" == re.sub("##.", "#", formatting.sent(request)), page  # FD frames have flags
        if (reply := expected[page].reply) is not None:
            assert _shows(lines.pop(0), reply), f"{page}: {text}"
        assert lines == [], page


class Wordy(Target):
    """A target of another package, whose programs contain Markdown."""

    title = "Wordy | <b>"

    def generate(self, specifications: object, set_parameters: object, options: object) -> Iterator[Output]:
        yield from ()

    def example(self, edition: object, worked: WorkedExchange) -> CodeExample:
        return CodeExample("text", "before\n```\n# no heading\n````\nafter")


def test_a_target_of_another_package_shows_its_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(common, "targets", lambda: [Wordy()])
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    frames = {"canwright": 1, "family": "lamp", "edition": "v1", "sources": {"manual": "M."}, "frames": []}
    frames["frames"] = [
        {"request": "dim", "node": 1, "id": 0x101, "data": "10" + " 00" * 7, "raw": {"level": 0}, "source": "manual"}
    ]
    (tmp_path / "lamp.frames.yaml").write_text(json.dumps(frames), "utf-8")
    made = DocsTarget().generate([specification(tmp_path / "lamp.yaml")], {})
    page = next(output.text for output in made if output.path.endswith("commands/dim.md"))
    assert "### Wordy \\| &lt;b&gt;\n\n`````text\nbefore\n```\n# no heading\n````\nafter\n`````\n" in page
