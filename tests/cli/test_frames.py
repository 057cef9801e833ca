"""`canwright frames`: entries for golden frames, with bytes to fill in or from a log."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.cli import main
from canwright.project.loader import load
from click.testing import CliRunner, Result

from ..spec_texts import MINIMAL

LOG = "(1.000) can0 101#1000F40100000000\n(1.001) can0 101#1000F40100000000\n"
SKELETON = '  - {request: dim, node: 1, data: "__ __ __ __ __ __ __ __", values: {level: 100}, source: manual}\n'


@pytest.fixture
def lamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    (tmp_path / "bus.log").write_text(LOG, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "lamp.frames.yaml"


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments)


def test_skeletons_have_values_at_the_ends_of_ranges_and_no_bytes(lamp: Path) -> None:
    lamp.write_text("", "utf-8")  # as the redirection of a shell leaves it
    result = run("frames", "lamp.yaml")
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("canwright: 1\nfamily: lamp\nedition: v1\nsources:\n  manual: Examples")
    assert SKELETON in result.stdout
    lines = [line for line in result.stdout.splitlines() if "data:" in line]
    assert all('data: "__ __ __ __ __ __ __ __"' in line for line in lines)
    assert "replace each __ by a byte of the manual" in result.stderr


def test_a_skeleton_is_rejected_until_its_bytes_are_filled_in(lamp: Path) -> None:
    lamp.write_text(run("frames", "lamp.yaml").stdout, "utf-8")
    result = run("check", "--spec", "lamp.yaml")
    assert result.exit_code == 1
    assert "replace each __ by the byte of the manual or of a log" in result.stderr
    text = lamp.read_text("utf-8").replace("__ __ __ __ __ __ __ __", "10 00 E8 03 00 00 00 00", 1)
    lamp.write_text("\n".join(line for line in text.splitlines() if "__" not in line) + "\n", "utf-8")
    (golden,) = load(Path("lamp.yaml")).specification.frames.frames  # type: ignore[union-attr]
    assert (golden.id, golden.extended, golden.node, golden.raw) == (0x101, False, 1, {"level": 1000})


def test_only_missing_entries_are_printed_below_existing_ones(lamp: Path) -> None:
    frame = SKELETON.replace("__ __ __ __ __ __ __ __", "10 00 E8 03 00 00 00 00")
    lamp.write_text(
        f"canwright: 1\nfamily: lamp\nedition: v1\nsources: {{manual: M}}\nframes:\n{frame}", "utf-8", newline="\n"
    )
    text = run("frames", "lamp.yaml").stdout
    assert text.startswith("  - {reply: dim") and "request: dim" not in text


def test_frames_of_a_log_are_unreviewed_until_a_source_is_named(lamp: Path) -> None:
    result = run("frames", "lamp.yaml", "--from", "bus.log")
    entry = 'node: 1, id: 0x101, data: "10 00 F4 01 00 00 00 00"'
    reading = "  # by the spec: raw: {level: 500}, values: {level: 50}\n"
    assert f"{reading}  - {{request: dim, {entry}}}\n{reading}  - {{reply: dim, {entry}}}\n" in result.stdout
    lamp.write_text(result.stdout, "utf-8")
    for command in (("check",), ("generate", "--target", "columns", "--out", "out")):
        checked = run(*command, "--spec", "lamp.yaml")
        assert checked.exit_code == 0, checked.output
        assert "2 golden frames without `source`: unreviewed" in checked.stderr
        assert "`dim` (request)" in checked.stderr, "an unreviewed frame counts as missing"
    frames = load(Path("lamp.yaml")).specification.frames
    assert frames is not None and frames.frames == []
    named = result.stdout.replace("sources: {}", "sources: {bench: A lamp.}").replace('00"}', '00", source: bench}')
    lamp.write_text(named, "utf-8")
    assert "neither `raw` nor `values` has `level`" in run("check", "--spec", "lamp.yaml").stderr
    lamp.write_text(named.replace("source:", "values: {level: 50}, source:"), "utf-8")
    checked = run("check", "--spec", "lamp.yaml")
    assert "unreviewed" not in checked.stderr and "`dim`" not in checked.stderr


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("frames", "lmap.yaml"), "there is no file and no edition `lmap.yaml`"),
        (("frames", "lamp.yaml", "--set", "size=3"), "is not a parameter"),
        (("frames", "lamp.yaml", "--from", "none.log"), "none.log"),
    ],
)
def test_invalid_arguments_are_rejected(arguments: tuple[str, ...], says: str, lamp: Path) -> None:
    result = run(*arguments)
    assert (result.exit_code, says in result.output) == (2, True), result.output
