"""The examples of the README run, and print what it says."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.diagnostics.diagnostic import SpecError
from canwright.project.loader import specification
from click.testing import CliRunner

from .cli.live import free_port, simulated
from .compilers import WARNINGS, Compiler, each_compiler
from .conformance.adapters import ADAPTERS
from .spec_texts import ROOT, findings

README = (ROOT / "README.md").read_text("utf-8")


def example(name: str) -> str:
    """The code block behind `<!-- example: name -->`."""
    match = re.search(rf"<!-- example: {name} -->\n```\w+\n(.*?)```", README, re.DOTALL)
    assert match, f"README.md has no example {name}"
    return match.group(1)


def printed(name: str) -> str:
    """What the README says that an example prints."""
    match = re.search(rf"<!-- example: {name} -->\n```\w+\n.*?```\n\n```text\n(.*?)```", README, re.DOTALL)
    assert match, f"README.md does not say what example {name} prints"
    return match.group(1)


def test_readme_can_be_read_in_five_minutes() -> None:
    assert len(README.splitlines()) < 300


def test_python_example_prints_what_the_readme_shows(tmp_path: Path) -> None:
    script = tmp_path / "example.py"
    script.write_text(example("python"), "utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "generated/python")}
    result = subprocess.run([sys.executable, script], capture_output=True, text=True, env=environment, check=False)
    assert (result.stdout, result.stderr) == (printed("python"), "")


@each_compiler
def test_c_example_prints_what_the_readme_shows(compiler: Compiler, tmp_path: Path) -> None:
    source, program = tmp_path / "example.c", tmp_path / "example"
    source.write_text(example("c"), "utf-8")
    compiler.run("c99", *WARNINGS, f"-I{ROOT}/generated/c/include", source, "-o", program)
    result = subprocess.run([str(program)], capture_output=True, text=True, check=True)
    assert result.stdout == printed("c")


def test_spec_of_the_readme_has_no_findings_and_generates(tmp_path: Path) -> None:
    assert findings(tmp_path, example("spec")) == []
    arguments = example("generate").split()
    assert arguments[0] == ".venv/bin/canwright"
    (tmp_path / "lamp.yaml").write_text(example("spec"), "utf-8")
    before = Path.cwd()
    os.chdir(tmp_path)
    try:
        result = CliRunner().invoke(main, arguments[1:], catch_exceptions=False)
    finally:
        os.chdir(before)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "out/c/include/lamp/v1.h").is_file()


REPLAY = "tests/conformance/test_conformance.py"
REPEATED = [
    *(
        f"{REPLAY}::test_{name}"
        for name in (
            "random_questions",
            "facts_of_c_headers_are_those_of_the_model",
            "requests_to_nodes_without_the_command_are_rejected",
            "fields_without_a_check_are_written_whole",
        )
    ),
    *(
        f"{REPLAY}::test_golden_frames[mwd_motor/v2.36-2025-09-{target}]"
        for number, target in enumerate(ADAPTERS)
        if number % 3
    ),
]
"""All tests of a new edition but a sample of the replays; they run for the edition that it is a copy of."""


def run(command: str, folder: Path, status: int = 0) -> str:
    """What a command of the README prints, in a folder that has what a clone has; fails with another exit status."""
    program, *arguments = shlex.split(command)
    python = {".venv/bin/python": [], ".venv/bin/canwright": ["-m", "canwright"]}[program]
    environment = {
        **os.environ,
        "PYTHONPATH": str(folder / "generator"),
        "NO_COLOR": "1",
        # this test runs in one of several processes already
        "PYTEST_ADDOPTS": " ".join(["-n 0", *(f"--deselect {test}" for test in REPEATED)]),
    }
    done = subprocess.run(
        [sys.executable, *python, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == status, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A scratch copy of what is committed."""
    for name in ("spec", "generator", "templates", "generated", "tests"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def test_log_is_decoded_and_its_edition_identified(clone: Path) -> None:
    match = re.search(r"<!-- example: log -->\n```text\n(.*?)```", README, re.DOTALL)
    assert match
    (clone / "bus.log").write_text(match.group(1), "utf-8")
    assert run(example("decode"), clone) == printed("decode")
    identify, decode = (
        f".venv/bin/{command}" for command in re.findall(r"`(canwright (?:identify|decode) [^`]+)`", README)
    )
    assert ": fits v2.35-2024-02\n" in run(identify, clone)
    assert "reply of set_torque from node 1" in run(decode, clone)


def test_cantools_decodes_the_frame_of_the_readme() -> None:
    frame, _, command = example("dbc").partition(" | ")
    given = frame.removeprefix("echo '").removesuffix("'")
    program, *arguments = command.split()
    done = subprocess.run(
        [sys.executable, "-m", Path(program).name, *arguments],
        input=given,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == printed("dbc").strip()


def test_dbc_file_of_selected_nodes_has_only_their_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    arguments = [str(tmp_path) if word == "my-dbc" else word for word in example("dbc-nodes").split()[1:]]
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    text = (tmp_path / "dbc/mwd_motor-v2.35-MG-encoder_bits_18-reply-node5_7.dbc").read_text("ascii")
    assert re.findall(r"^BO_ (\d+) ", text, re.MULTILINE) == [str(0x145), str(0x147)]
    assert 'rA1_encoder m161 : 48|16@1+ (0.0054931640625,0) [0|359.9945068359375] "deg"' in text


def test_command_of_the_readme_is_shown(clone: Path) -> None:
    (command,) = re.findall(r"`(\.venv/bin/canwright show [^`]+)`", README)
    assert run(command, clone).startswith(
        "set_torque  0xA1  Torque control\nmwd_motor v2.35, manual 2.5, 转矩闭环控制命令\n"
    )


def test_new_edition_is_copied_compared_generated_and_replayed(clone: Path) -> None:
    run(example("copy"), clone)
    spec = clone / "spec/mwd_motor/v2.36-2025-09.yaml"
    before = spec.read_text("utf-8")
    states = before.index("  motor_state:")
    at = before.index('      "on":', states)
    spec.write_text(before[:at] + example("edit") + before[at:], "utf-8")
    assert run(example("compare"), clone, status=1) == printed("compare")
    frames = spec.with_name("v2.36-2025-09.frames.yaml")
    frames.write_text(frames.read_text("utf-8").replace("\nframes:\n", f"\nframes:\n{example('frame')}", 1), "utf-8")
    generated, replayed = example("renew").strip().split("\n")
    assert "mwd_motor v2.36-2025-09: " in run(generated, clone)
    assert (clone / "generated/docs/en/v2.36-2025-09/changes.md").is_file()
    replay = run(replayed, clone)
    assert "\n1 edition through " in replay
    changed = frames.read_text("utf-8").replace("motor_state: 32, errors: 0}", "motor_state: 33, errors: 0}", 1)
    frames.write_text(changed, "utf-8")
    with pytest.raises(SpecError, match="frame-contradiction"):
        specification(spec)  # with which every replay starts


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", ".github/SECURITY.md"])
def test_links_lead_to_a_file_or_a_heading(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    headings = {re.sub(r"[^a-z0-9 -]", "", h.lower()).replace(" ", "-") for h in re.findall(r"(?m)^#+ (.*)$", text)}
    for path, heading in re.findall(r"\]\(([^)#:]*)#?([^):]*)\)", text):
        assert (ROOT / page).parent.joinpath(path).exists(), path
        assert path or heading in headings, heading


def test_files_that_contributing_names_exist() -> None:
    """Except examples, which contain a name in capitals."""
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    named = {path for path in re.findall(r"`([a-z_.]+/[\w/.-]+)`", text) if not re.search("[A-Z]{2}", path)}
    folders = (ROOT, ROOT / "generator/canwright", ROOT / "generator/canwright/targets/javascript")
    assert len(named) > 40
    assert [path for path in sorted(named) if not any((folder / path).exists() for folder in folders)] == []


def test_commands_on_a_bus_are_answered() -> None:
    """By the nodes of the other process, in a time that a busy machine keeps; the port is one that no other test uses."""
    port = free_port()
    slowly = shlex.join(("--timeout", "1", *port))
    simulate, *asking, monitor = example("bus").splitlines()
    with simulated(*shlex.split(simulate)[2:], *port) as ended:
        scan = run(f"{asking[0]} --node 1..5 {slowly}", ROOT)
        requests = [run(f"{command} {slowly}", ROOT) for command in asking[1:]]
        assert ": fits v2.36-2025-03\n" in scan
        assert all(printed_reply.startswith("reply of ") for printed_reply in requests)
        _monitor([*shlex.split(monitor)[1:], *port], f"{asking[1]} {slowly}")
    assert ended.status == 130


def _monitor(arguments: list[str], request: str) -> None:
    """Reads the lines that the monitor prints without a terminal, until it shows the values of a request."""
    command = [sys.executable, "-m", "canwright", *arguments]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        assert process.stdout.readline().startswith("# ")
        run(request, ROOT)
        assert any("read_status_1" in line and " V," in line for line in process.stdout)
        process.send_signal(signal.SIGINT)
        process.communicate()
    assert process.returncode == 130
