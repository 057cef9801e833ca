"""`canwright test`: golden frames through generated code, and what is printed of a target that contradicts them."""

from __future__ import annotations

import importlib.util
import json
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from canwright.cli import main
from canwright.conformance.replay import TARGETS
from canwright.targets.base import Output, Target
from canwright.targets.c.target import CTarget
from canwright.targets.dbc.printer import printed
from canwright.targets.python.target import PythonTarget
from click.testing import CliRunner, Result

from ..compilers import ZIG
from ..spec_texts import MINIMAL, ROOT

SPEC = Path("spec/lamp/v1.yaml")
FRAMES = Path("spec/lamp/v1.frames.yaml")
HEAD = "edition  target     asked  passed  failed  not asked\n"


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CC", shlex.join(ZIG.c))


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, catch_exceptions=False)


@pytest.fixture
def lamp() -> None:
    assert run("init", "lamp").exit_code == 0


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new), "utf-8")


def generate_with(target: type[Target], old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes a target generate files with other text."""
    generate = target.generate

    def changed(*arguments: Any) -> Iterator[Output]:
        outputs = [output for output in generate(*arguments) if isinstance(output, Output)]
        assert any(old in output.text for output in outputs)
        return (output._replace(text=output.text.replace(old, new)) for output in outputs)

    monkeypatch.setattr(target, "generate", changed)


@pytest.mark.usefixtures("lamp")
def test_every_target_is_asked_the_golden_frames_of_a_new_spec() -> None:
    result = run("test")
    rows = "".join(f"lamp v1  {target:<9}      4       4       0          0\n" for target in TARGETS)
    assert (result.exit_code, result.stdout, result.stderr) == (0, HEAD + rows, "")


def test_what_targets_are_not_asked_is_counted_with_the_reason() -> None:
    spec = str(ROOT / "tests/specs/tank/v1.yaml")
    result = run("test", "--spec", spec, "--target", "dbc", "--target", "c")
    assert result.exit_code == 0
    assert "tank v1  dbc            8       8       0          7\n" in result.stdout
    assert "not asked: 7 questions of dbc: all messages of one id have one length\n" in result.stdout
    assert "not asked: 1 question of c: the self-test leaves out values in units" in result.stdout


@pytest.mark.usefixtures("lamp")
def test_a_golden_frame_that_contradicts_the_spec_is_named() -> None:
    edit(FRAMES, "speed: -30}", "speed: -300}")
    result = run("test")
    assert result.exit_code == 1
    place = "spec/lamp/v1.frames.yaml:11:99: error: `speed` is -30 according to the scale in the spec"
    assert result.stderr.startswith(place)


@pytest.mark.usefixtures("lamp")
@pytest.mark.parametrize(
    ("target", "generated", "old", "new", "places", "says"),
    [
        ("python", PythonTarget, "/ 10", "/ 5", ("11:5", "12:5", "13:5"), "python, decode: speed is -60.0, not -30.0"),
        (
            "python",
            PythonTarget,
            '"<',
            '">',
            ("11:5", "12:5", "13:5"),
            "python, decode: raw {state: 1, speed: -11010}, not {state: 1, speed: -300}",
        ),
        (
            "c",
            CTarget,
            "message->speed >> 8",
            "message->speed >> 7",
            ("11:5", "12:5", "13:5"),
            "c, self-test: the raw integers are rejected, or encoded as another frame",
        ),
        (
            "c",
            CTarget,
            "frame->data[2] |",
            "frame->data[4] |",
            ("11:5", "12:5", "13:5"),
            "c, self-test: another node or other raw integers",
        ),
    ],
)
def test_a_broken_target_is_named_at_the_golden_frame(
    target: str,
    generated: type[Target],
    old: str,
    new: str,
    places: tuple[str, ...],
    says: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    generate_with(generated, old, new, monkeypatch)
    result = run("test")
    assert result.exit_code == 1
    failures = [line for line in result.stderr.splitlines() if "[target-contradiction]" in line]
    assert f"spec/lamp/v1.frames.yaml:{places[0]}: error: {says} [target-contradiction]" in failures
    assert [line.split(": ")[0] for line in failures] == [f"spec/lamp/v1.frames.yaml:{place}" for place in places]
    assert f"lamp v1  {target:<9}      4       {4 - len(places)}       {len(places)}          0\n" in result.stdout


@pytest.mark.usefixtures("lamp")
def test_a_broken_dbc_file_is_named_at_the_golden_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("canwright.conformance.dbc.printed", lambda file: printed(file).replace("(0.1,0)", "(0.2,0)"))
    result = run("test", "--target", "dbc")
    assert result.exit_code == 1
    assert "spec/lamp/v1.frames.yaml:11:5: error: dbc, decode: speed is -60.0, not -30.0 [" in result.stderr
    assert result.stdout == f"{HEAD}lamp v1  dbc            4       1       3          0\n"


@pytest.mark.usefixtures("lamp")
@pytest.mark.parametrize(
    ("target", "generated", "old", "says"),
    [
        ("python", PythonTarget, "class ", "load: raises SyntaxError"),
        ("c", CTarget, "typedef ", "self-test: zig: include/lamp/canwright.h:"),
    ],
)
def test_generated_code_that_is_no_code_fails_every_golden_frame(
    target: str, generated: type[Target], old: str, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    generate_with(generated, old, f"broken {old}", monkeypatch)
    result = run("test", "--target", target)
    assert result.exit_code == 1
    assert f"spec/lamp/v1.frames.yaml:4:1: error: {target}, {says}" in result.stderr
    assert f"lamp v1  {target:<9}      4       0       4          0\n" in result.stdout


@pytest.mark.usefixtures("lamp")
def test_a_missing_tool_is_named_with_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    find_spec = importlib.util.find_spec
    monkeypatch.setattr(
        "canwright.conformance.c_selftest.find_spec", lambda name: None if name == "ziglang" else find_spec(name)
    )
    result = run("test")
    compiler = "no C compiler found; install gcc or clang, or run: pip install ziglang"
    assert result.exit_code == 0
    assert f"lamp v1  c              0       0       0          4  {compiler}\n" in result.stdout
    assert "lamp v1  dbc            4       4       0          0\n" in result.stdout
    required = run("test", "--target", "reference", "--target", "c")
    assert (required.exit_code, required.stdout, required.stderr) == (2, "", f"canwright: c: {compiler}\n")


@pytest.mark.usefixtures("lamp")
@pytest.mark.parametrize("arguments", [["check", "--no-cache"], ["generate"], ["test", "--target", "reference"]])
def test_cantools_is_imported_for_dbc_only(arguments: list[str]) -> None:
    script = "import sys\nfrom canwright.cli import main\ntry:\n main()\nfinally:\n print({'can', 'cantools'} & {*sys.modules})"
    done = subprocess.run([sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=False)
    assert (done.stdout.splitlines()[-1], done.stderr.count("Traceback")) == ("set()", 0)


@pytest.mark.usefixtures("lamp")
def test_golden_frames_without_a_source_are_counted_and_not_asked() -> None:
    edit(FRAMES, "speed: -30}, source: starter", "speed: -30}")
    result = run("test", "--target", "reference")
    assert (result.exit_code, "1 golden frame without `source`" in result.stderr) == (0, True)
    row = "lamp v1  reference      3       3       0          1\nnot asked: 1 golden frame without a source\n"
    assert result.stdout == HEAD + row


@pytest.mark.parametrize("frames", ["", "frames: []\n"])
def test_a_run_that_asks_nothing_is_not_a_success(frames: str) -> None:
    Path("lamp.yaml").write_text(MINIMAL, "utf-8")
    if frames:
        Path("lamp.frames.yaml").write_text(
            f"canwright: 1\nfamily: lamp\nedition: v1\nsources: {{}}\n{frames}", "utf-8"
        )
    result = run("test", "--target", "reference")
    assert result.exit_code == 1
    assert "error: no golden frame was asked, so nothing is tested [not-tested]" in result.stderr


@pytest.mark.usefixtures("lamp")
def test_findings_have_the_formats_of_other_commands() -> None:
    edit(FRAMES, ", source: starter", "")
    result = run("test", "--target", "reference", "--format", "json")
    assert result.exit_code == 1
    findings = json.loads(result.stdout)["findings"]
    assert [finding["rule"] for finding in findings] == ["unreviewed-frame", "missing-frame", "not-tested"]
    assert result.stderr.startswith(HEAD)
