from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import click
import pytest
from canwright.cli import COMMANDS, main
from canwright.targets.registry import declared_options, default_targets
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL, ROOT

ARM = str(ROOT / "tests/specs/arm/v1.yaml")
MIXER = str(ROOT / "tests/specs/mixer/v2-2024-02.yaml")


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, catch_exceptions=False)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.yaml").write_text(MINIMAL, "utf-8")
    return tmp_path


def test_help_lists_the_commands_and_an_example() -> None:
    result = run("--help")
    assert result.exit_code == 0
    for word in ("generate", "check", "show", "--spec my.yaml --out out", "Exit status"):
        assert word in result.output


def test_check_reports_output_that_differs_after_an_edit_of_the_spec(folder: Path) -> None:
    result = run("generate", "--spec", "my.yaml", "--out", "out")
    assert (result.exit_code, result.stdout.split(":")[0]) == (0, "lamp v1")
    assert "warning: there are no golden frames" in result.stderr
    listed = run("generate", "--spec", "my.yaml", "--out", "out", "--format", "json")
    assert [finding["rule"] for finding in json.loads(listed.stdout)["findings"]] == ["missing-frame"]
    assert {p.name for p in (folder / "out").iterdir()} == {".canwright.json", *default_targets()}
    assert run("check", "--spec", "my.yaml", "--out", "out").exit_code == 0
    (folder / "my.yaml").write_text(MINIMAL.replace("0..1000", "0..999"), "utf-8")
    result = run("check", "--spec", "my.yaml", "--out", "out")
    assert result.exit_code == 1
    assert "+++ c/include/lamp/v1.h as generated" in result.output
    assert run("generate", "--spec", "my.yaml", "--out", "out").exit_code == 0
    assert run("check", "--spec", "my.yaml", "--out", "out").exit_code == 0


def test_generate_writes_only_the_selected_target(folder: Path) -> None:
    run("generate", "--spec", "my.yaml", "--target", "dbc", "--out", "out")
    assert {p.name for p in (folder / "out").iterdir()} == {".canwright.json", "dbc"}


@pytest.mark.parametrize(("options", "is_said"), [((), True), (("--nodes", "300"), False), (("--target", "c"), False)])
def test_generate_says_which_nodes_the_files_do_not_list(folder: Path, options: tuple[str, ...], is_said: bool) -> None:
    (folder / "my.yaml").write_text(MINIMAL.replace("nodes: 1..4}", "nodes: 1..700}"), "utf-8")
    for _ in range(2):
        result = run("generate", "--spec", "my.yaml", "--out", "out", *options)
        text = "lamp v1: the DBC files list the nodes up to 256 of 700; select others with `--nodes 257..700`\n"
        assert (text in result.stdout) is is_said


def test_generate_writes_nothing_for_a_spec_with_an_error(folder: Path) -> None:
    (folder / "my.yaml").write_text(MINIMAL.replace("raw: u16", "raw: u99"), "utf-8")
    result = run("generate", "--spec", "my.yaml", "--out", "out")
    assert result.exit_code == 1
    assert "my.yaml:7:16: error: `u99` is not a raw format" in result.output
    assert "1 error; `canwright explain RULE` explains a rule" in result.output
    assert not (folder / "out").exists()


def test_a_folder_with_nothing_but_a_spec_is_a_project(folder: Path) -> None:
    (folder / "compose.yaml").write_text("services: {lamp: {image: canwright}}\n", "utf-8")
    assert run("check").stdout == "lamp v1: OK\n"
    assert run("generate").stdout.startswith("lamp v1: ")
    assert run("check").stdout == "lamp v1: OK, and generated/ is up to date\n"
    editions = run("editions").output
    assert "lamp" in editions and "mwd_motor" not in editions
    (folder / "my.yaml").write_text(f"\ufeff# a lamp\n{MINIMAL}", "utf-8")
    assert run("check").stdout == "lamp v1: OK, and generated/ is up to date\n"
    (folder / "my.yaml").write_text(MINIMAL.replace("scale: 0.1", "scale: 0.2"), "utf-8")
    assert "differ from the specs [stale-output]" in run("check").stderr


def test_a_project_without_output_gets_one_finding_and_no_comparison(folder: Path) -> None:
    (folder / "spec/lamp").mkdir(parents=True)
    (folder / "my.yaml").rename(folder / "spec/lamp/v1.yaml")
    result = run("check")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "\ngenerated:1:1: error: there is no folder generated/ to compare with the specs" in result.stderr


def test_the_exit_status_is_2_if_the_command_cannot_run(folder: Path) -> None:
    (folder / "my.yaml").rename(folder / "my.yml")
    result = run("generate")
    assert (result.exit_code, "no spec found in spec/ or here; " in result.output) == (2, True)
    (folder / "my.yml").rename(folder / "my.yaml")
    assert run("generate", "--spec", "missing.yaml").exit_code == 2
    result = run("generate", "--spec", "my.yaml", "--set", "size=big", "--out", "out")
    assert (result.exit_code, result.output.endswith("; the spec has no parameters\n")) == (2, True)
    (folder / "file").write_text("")
    assert run("generate", "--spec", "my.yaml", "--out", "file").exit_code == 2


def test_wrong_usage_is_answered_with_a_suggestion(folder: Path) -> None:
    for arguments, message in (
        (("check", "--spec", "myy.yaml"), "Path 'myy.yaml' does not exist. Did you mean my.yaml?"),
        (("check", "--spec", "nope.yaml"), "Path 'nope.yaml' does not exist.\n"),
        (("check", "--spec", "may.yml"), "Path 'may.yml' does not exist. Did you mean my.yaml?"),
        (("check", "my.yaml"), "give a spec as --spec my.yaml"),
        (("generate", "--spec", "my.yaml", "--out", ""), "The path is empty; `.` is the current folder."),
        (("chek",), "there is no command `chek`; did you mean `check`?"),
        (("check", "--spec", "my.yaml", "--set", "size=big"), "--set size=big is not a parameter and its value"),
        (("check", "--spec", ARM, "--set", "p_max=5", "--set", "p_max=6"), "`p_max` is already set to 5"),
    ):
        result = run(*arguments)
        assert (result.exit_code, message in result.output) == (2, True), result.output
    (folder / "too.yaml").write_text((folder / "my.yaml").read_text("utf-8"), "utf-8")
    assert run("check", "--spec", "my.yaml", "--spec", "./my.yaml").exit_code == 0
    result = run("check", "--spec", "my.yaml", "--spec", "too.yaml")
    assert (result.exit_code, "describes lamp v1, too [name-collision]" in result.output) == (1, True)


@pytest.mark.parametrize("arguments", [("show", "set_torque"), ("editions",)])
def test_without_specs_the_editions_of_the_package_are_shown(folder: Path, arguments: tuple[str, ...]) -> None:
    (folder / "my.yaml").unlink()
    result = run(*arguments)
    assert (result.exit_code, "mwd_motor" in result.output) == (0, True)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_ends_with_130_after_an_interrupt(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    context = click.Context(main)
    command = main.get_command(context, name)
    assert command
    monkeypatch.setattr(command, "parse_args", interrupted)
    result = run(name)
    assert (result.exit_code, result.output) == (130, "")


INTERRUPTED = """
import os, signal, sys, threading
from canwright.__main__ import run
sys.argv = ["canwright", "decode", "-"]
threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT)).start()
run()
"""


def test_an_interrupted_process_ends_with_130() -> None:
    """While it imports its modules, or while it waits for frames."""
    command = [sys.executable, "-c", INTERRUPTED]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        for _ in range(6):
            try:
                process.wait(10)
                break
            except (
                subprocess.TimeoutExpired
            ):  # an interrupt just before a read that waits does not end any Python program
                process.send_signal(signal.SIGINT)
        assert process.stderr
        assert (process.returncode, process.stderr.read()) == (130, b"")


def test_check_without_out_verifies_only_the_spec(folder: Path) -> None:
    result = run("check", "--spec", "my.yaml")
    assert (result.exit_code, result.stdout) == (0, "lamp v1: OK\n")
    assert "my.yaml:1:1: warning: there are no golden frames beside this spec [missing-frame]" in result.stderr
    assert run("check", "--spec", "my.yaml", "--strict").exit_code == 1


def test_show_by_name_and_by_code() -> None:
    shown = run("show", "set_volume", "--spec", MIXER).output
    assert run("show", "0x11", "--spec", MIXER).output == shown
    for text in ("set_volume  0x11", "0x200 + node (1..20)", "DATA[4..5]", "33/2048 V (L)", "-1000..1000"):
        assert text in shown
    lamp = run("show", "set_lamp", "--spec", MIXER).output
    assert "The lamp blinks (not with lamp = off); consent: motion" in lamp
    stop = run("show", "motor_stop", "--spec", str(ROOT / "spec/mwd_motor/v2.35.yaml")).output
    assert "ends the motion of a node: stop" in stop
    turn = run("show", "turn_to_angle", "--spec", str(ROOT / "spec/mwd_motor/v2.35.yaml")).output
    assert "repeated after a missing reply: never" in turn
    assert "设定音量" in run("show", "set_volume", "--lang", "zh", "--spec", MIXER).output


def test_show_suggests_the_nearest_name(folder: Path) -> None:
    result = run("show", "din", "--spec", "my.yaml")
    assert (result.exit_code, "did you mean `dim`?" in result.output) == (2, True)


SHOW = (sys.executable, "-m", "canwright", "show", "dim", "--spec", "my.yaml")


def test_a_full_disk_is_reported(folder: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(SHOW, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "canwright: cannot print: No space left on device\n")


def test_a_closed_pipe_is_no_error(folder: Path) -> None:
    with subprocess.Popen(SHOW, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout and process.stderr
        process.stdout.close()
        assert process.stderr.read() == ""


def test_the_list_of_commands_is_complete() -> None:
    _, _, commands = run("--help").output.partition("Commands:\n")
    assert len(commands.splitlines()) == 20
    assert "..." not in commands


def test_show_takes_the_name_of_a_table_command_and_one_edition(folder: Path) -> None:
    cells = (ROOT / "tests/specs/cells/v1.yaml").read_text("utf-8")
    for name in ("v2-2024-11", "v2-2025-03"):
        (folder / f"{name}.yaml").write_text(cells.replace("edition: v1", f"edition: {name}"), "utf-8")
    specs = ("--spec", "v2-2024-11.yaml", "--spec", "v2-2025-03.yaml")
    result = run("show", "read", "--edition", "v2-2025-03", *specs)
    assert result.exit_code == 0
    assert "read_limit  0x" in result.output
    assert "read_hottest  0x" in result.output
    assert "cells v2-2024-11" not in result.output
    both = run("show", "write_limit", *specs).output
    assert both.startswith("write_limit  0x") and "\n\nwrite_limit  0x" in both
    assert "cells v2-2024-11" in both and "cells v2-2025-03" in both
    result = run("show", "read", "--edition", "v2-2025-04", *specs)
    assert (result.exit_code, "did you mean `v2-2025-03`?" in result.output) == (2, True)


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ("p_max=0", "`p_max` must be above 0, because a scale is a multiple of it"),
        ("p_max=-12.5", "`p_max` must be above 0"),
        ("p_max=0.01", "`p_max` must be at least 0.1"),
        ("p_max=100.5", "`p_max` must be at most 100"),
        ("p_max=", "`` is not a number"),
        ("p_max=nan", "`nan` is not a number"),
        ("p_max=1e1", "`1e1` is not a number"),
        ("p_max=1/0", "`1/0` divides by zero"),
        ("p_max=$(id)", "`$(id)` is not a number"),
        ("winding=12.5", "use one of: i_max=NUMBER; p_max=NUMBER; t_max=NUMBER; v_max=NUMBER; winding=delta|open|star"),
        ("q_max=12.5", "--set q_max=12.5 is not a parameter and its value"),
    ],
)
def test_an_invalid_setting_is_rejected(setting: str, says: str, tmp_path: Path) -> None:
    result = run("generate", "--spec", ARM, "--target", "dbc", "--set", setting, "--out", str(tmp_path / "out"))
    assert (result.exit_code, says in result.output) == (2, True), result.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--target", "dbc", "--nodes", "5,x"], "--nodes 5,x: `x` is not a node; write nodes as 5,7 or 1..8"),
        (["--target", "dbc", "--nodes", "1,99"], "--nodes 1,99: arm v1 has no node 99; its nodes are 1..15"),
        (["--nodes", "1"], "--nodes affects only the target dbc; add --target dbc"),
        (["--target", "c", "--comments", "zh"], "--comments affects only the target dbc; add --target dbc"),
        (["--target", "dbc", "--comments", "fr"], "--comments fr: comments of DBC files are in en or zh"),
    ],
)
def test_impossible_nodes_and_comments_are_rejected(arguments: list[str], message: str, tmp_path: Path) -> None:
    result = run("generate", "--spec", ARM, *arguments, "--out", str(tmp_path / "out"))
    assert (result.exit_code, result.stderr) == (2, f"canwright: {message}\n")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["check", "generate"])
def test_help_lists_the_options_of_targets(command: str) -> None:
    words = " ".join(run(command, "--help").stdout.replace("-\n", "-").split())
    assert {"nodes", "comments"} <= declared_options().keys()
    for name, declared in declared_options().items():
        assert f"--{name} {declared[0][1].metavar} {declared[0][1].help}".replace("- ", "-") in words.replace("- ", "-")


def test_nodes_are_selected_singly_or_as_a_range(tmp_path: Path) -> None:
    run("generate", "--spec", ARM, "--target", "dbc", "--nodes", "3,1..2", "--out", str(tmp_path / "out"))
    assert (tmp_path / "out/dbc/arm-v1-star-reply-node1_2_3.dbc").is_file()


def test_a_setting_affects_only_dbc_files(tmp_path: Path) -> None:
    settings = ("--set", "winding=star", "--set", "p_max=25/2")
    assert run("generate", "--spec", ARM, *settings, "--out", str(tmp_path / "out")).exit_code == 0
    names = {path.name for path in (tmp_path / "out/dbc").glob("*-command.dbc")}
    assert names == {"arm-v1-star-p_max_12.5-command.dbc"}
    assert run("check", "--spec", ARM, *settings, "--out", str(tmp_path / "out")).exit_code == 0
    header = (tmp_path / "out/c/include/arm/v1.h").read_text("utf-8")
    assert "canwright_ratio_t p_max;" in header


def test_a_command_is_found_by_the_id_of_a_broadcast() -> None:
    spec = ("--spec", str(ROOT / "spec/mwd_motor/v2.35.yaml"))
    assert run("show", "0x280", *spec).stdout.startswith("broadcast_torque")
    node = run("show", "0x141", *spec)
    assert node.exit_code == 2
    assert "it is an id of node 1 (0x140 + node), which many commands have; give a code or a name" in node.stderr
