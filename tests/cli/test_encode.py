"""`canwright encode`: the frames of golden frames, and what it says about values that have none."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from canwright.cli import main
from canwright.model import formatting
from canwright.model.golden_frames import GoldenFrame, Value
from canwright.model.message import Direction
from canwright.project.loader import load
from canwright.targets.examples import is_usual
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL, SPECS

FRAMES_OF_A_SPEC = 3
NO_VALUE = "none"
"""The value of a field whose raw integer has none."""


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["encode", *arguments])


@pytest.fixture
def lamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "spec/lamp").mkdir(parents=True)
    (tmp_path / "spec/lamp/v1.yaml").write_text(MINIMAL, "utf-8")
    monkeypatch.chdir(tmp_path)


def written(value: Value) -> str:
    if isinstance(value, list):
        return ",".join(map(written, value))
    return f"{value.numerator}/{value.denominator}" if isinstance(value, Fraction) else value


def arguments_of(frame: GoldenFrame) -> list[str]:
    """The arguments for the values of a golden frame, and for the raw integers of fields without a value."""
    values = {name: value for name, value in frame.values.items() if value != NO_VALUE or name not in frame.raw}
    raws = {
        name: ",".join(map(str, raw)) if isinstance(raw, list) else str(raw)
        for name, raw in frame.raw.items()
        if name not in values
    }
    return [
        frame.command,
        *(f"{name}={written(value)}" for name, value in values.items()),
        *(f"{name}=raw:{raw}" for name, raw in raws.items()),
        *([f"--node={frame.node}"] if frame.node is not None else []),
        *(f"--set={name}={formatting.parameter_value(value)}" for name, value in frame.parameters.items()),
        *(["--reply"] if frame.direction is Direction.REPLY else []),
    ]


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: f"{spec.parent.name}-{spec.stem}")
def test_golden_frames_are_encoded_from_their_values(spec: Path) -> None:
    item = load(spec).specification
    edition, golden = item.edition, item.frames
    assert golden is not None
    messages = {
        (direction, command.name): message
        for command in edition.commands
        for direction, message in ((Direction.REQUEST, command.request), (Direction.REPLY, command.reply))
    }
    frames = [frame for frame in golden.frames if is_usual(messages.get((frame.direction, frame.command)), frame)]
    for frame in frames[:: max(1, len(frames) // FRAMES_OF_A_SPEC)]:
        result = run(*arguments_of(frame), f"--spec={spec}")
        assert (result.exit_code, result.stdout.split()[-1:]) == (0, [formatting.sent(frame)]), result.output


def test_a_number_can_be_given_by_its_name() -> None:
    spec = next(spec for spec in SPECS if spec.parent.name == "pump")
    result = run("set_duty", "duty=backwards", "--node=10", f"--spec={spec}")
    assert result.stdout.split()[-1] == "0000000A#FFFE7960"
    assert "-100000  -1.0 (backwards)" in result.stdout
    refused = run("set_duty", "duty=back", "--node=10", f"--spec={spec}")
    assert refused.exit_code == 1 and "there is no value `back`; did you mean `backwards`?" in refused.output


@pytest.mark.usefixtures("lamp")
def test_the_table_shows_what_is_sent_of_a_rounded_value() -> None:
    assert run("dim", "level=33.333", "--node", "1").stdout == (
        "request of dim to node 1\n"
        "  in lamp v1\n"
        "    field  position    raw  value\n"
        "    level  DATA[2..3]  333  33.3 %\n"
        "  cansend can0 101#10004D0100000000\n"
    )


@pytest.mark.usefixtures("lamp")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("dim level=200 --node 1", "level=200: raw 2000 is invalid for `level`; it takes 0..100 %"),
        ("dim level=-1 --node 1", "level=-1: raw -10 is invalid for `level`; it takes 0..100 %"),
        ("dim level=bright --node 1", "level=bright: `bright` is not a number; write an integer"),
        ("dim level=raw:0.5 --node 1", "level=raw:0.5: `0.5` is not a raw integer; write a whole number"),
        ("dim level=raw:1,2 --node 1", "level=raw:1,2: write one raw integer"),
        ("dim level=1/0 --node 1", "level=1/0: `1/0` divides by zero"),
        ("dim level=nan --node 1", "level=nan: nan is invalid for `level`"),
        ("dim --node 1", "dim_request lacks 1 value: level=0..100 %"),
        ("dim levle=2 --node 1", "dim_request has no field `levle`; did you mean `level`?"),
        ("dim level=2", "dim_request needs a node, "),
        ("dim level=2 --node 99", "dim_request has no node 99"),
    ],
)
def test_a_refusal_says_why_and_what_to_write(arguments: str, message: str) -> None:
    result = run(*arguments.split())
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith(f"canwright: {message}") and result.stderr.endswith("\n  in lamp v1\n")


@pytest.mark.usefixtures("lamp")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("dmi --node 1", "there is no command `dmi`; did you mean `dim`?"),
        ("dim level", "`level` is not a value; write FIELD=VALUE, for example level=0"),
        ("dim level=1 level=2", "`level` is given twice; remove one"),
        ("dim level=1 --edition v9", "there is no edition `v9`; "),
        ("dim level=1 --set size=1", "--set size=1 is not a parameter and its value; the spec has no parameters"),
    ],
)
def test_wrong_arguments_end_with_one_sentence(arguments: str, message: str) -> None:
    result = run(*arguments.split())
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"canwright: {message}") and result.stderr.count("\n") == 1


def test_a_missing_parameter_is_named_with_its_values() -> None:
    result = run("set_torque", "iq=2.5", "--node=1", "--edition=v2.35")
    assert result.exit_code == 1
    assert "`iq` depends on `series`, which is missing; give --set series=MF|MG|MH|MS\n" in result.stderr


def test_an_edition_without_the_reply_is_refused_beside_those_that_have_it() -> None:
    request = run("set_torque", "iq=raw:155", "--node=1")
    assert request.exit_code == 0 and request.stdout.endswith("  cansend can0 141#A10000009B000000\n")
    reply = run("dim", "--reply", "--node=1")
    assert reply.exit_code == 2


def test_editions_of_one_name_are_chosen_by_their_family(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for family in ("lamp", "desk"):
        (tmp_path / f"{family}.yaml").write_text(MINIMAL.replace("family: lamp", f"family: {family}"), "utf-8")
    specs = ("--spec", "lamp.yaml", "--spec", "desk.yaml")
    lines = ["encode", "dim", "level=1", "--node", "1", *specs]
    chosen = CliRunner().invoke(main, [*lines, "--edition", "desk/v1"])
    assert "in desk v1" in chosen.output and "in lamp v1" not in chosen.output
    (tmp_path / "bus.log").write_text("(1.0) can0 101#10000A0000000000\n", "utf-8")
    ambiguous = CliRunner().invoke(main, ["decode", "bus.log", *specs, "--set", "edition=v1"])
    assert "use one of: edition=desk/v1|lamp/v1" in ambiguous.output
    assert CliRunner().invoke(main, ["decode", "bus.log", *specs, "--set", "edition=desk/v1"]).exit_code == 0
