"""Logs of known editions, and what `canwright identify` makes of them. The frames are worked out by hand."""

from __future__ import annotations

import json
from pathlib import Path

import can
import pytest
from canwright.cli import main
from canwright.identify import best_reading, identify
from canwright.interpret import CanFrame
from canwright.load import described, spec_files
from canwright.logs import LogError, frames
from click.testing import CliRunner, Result

from .spec_texts import ROOT

EDITIONS = [described(file).edition for file in spec_files(ROOT / "spec")]

# 48.7 V as 0.1 V in DATA[3..4]: 487 = 0x01E7
V2_35 = ["142#9A00000000000000", "142#9A3200E701000000", "142#A10000009B000000", "142#A1329B00F4010080"]
# 48.72 V as 0.01 V in DATA[2..3]: 4872 = 0x1308; 1 A in DATA[4..5]
V2_35_2024_02 = ["141#9A00000000000000", "141#9A32081364000000"]
V2_36 = ["143#9A00000000000000", "183#9A32081364000000"]
# 0x18 calibrates, and only the edition of 2025-03 has it
V2_36_2025_03 = ["143#1800000000000000", "183#1800000100020011", "143#9A00000000000000", "183#9A32081364000000"]


def write(folder: Path, lines: list[str]) -> Path:
    file = folder / "bus.log"
    file.write_text("".join(f"({i}.000000) can0 {line}\n" for i, line in enumerate(lines)), "utf-8")
    return file


def run(folder: Path, lines: list[str], *options: str) -> Result:
    specs = [option for file in spec_files(ROOT / "spec") for option in ("--spec", str(file))]
    return CliRunner().invoke(main, ["identify", str(write(folder, lines)), *specs, *options])


@pytest.mark.parametrize(
    ("lines", "node", "fits"),
    [
        (V2_35, 2, ["v2.35"]),
        (V2_35_2024_02, 1, ["v2.35-2024-02"]),
        (V2_36, 3, ["v2.36-2024-11", "v2.36-2025-03"]),
        (V2_36_2025_03, 3, ["v2.36-2025-03"]),
        (["141#8100000000000000"], 1, ["v2.35", "v2.35-2024-02", "v2.36-2024-11", "v2.36-2025-03"]),
        (["141#EE00000000000000"], 1, []),
    ],
)
def test_what_fits(lines: list[str], node: int, fits: list[str], tmp_path: Path) -> None:
    found, foreign = identify(frames(write(tmp_path, lines)), EDITIONS)
    assert [(f.node, sorted(e.name for e in f.editions)) for f in found] == [(node, fits)]
    assert foreign == 0


def test_a_bus_of_three_editions_is_told_node_by_node(tmp_path: Path) -> None:
    result = run(tmp_path, V2_35 + V2_35_2024_02 + V2_36_2025_03)
    assert result.exit_code == 0
    assert "node 1, 2 frames: fits v2.35-2024-02\n" in result.output
    assert "node 2, 4 frames: fits v2.35\n" in result.output
    assert "node 3, 4 frames: fits v2.36-2025-03\n" in result.output
    assert "is not within a plausible 6..100 V" in result.output
    assert "0x183 is no id of this edition (2 of 2, as in 183#1800000100020011)" in result.output


def test_when_it_cannot_tell_it_says_what_would(tmp_path: Path) -> None:
    result = run(tmp_path, ["141#9C00000000000000", "141#9C32010002000A00", "7FF#00"])
    assert result.exit_code == 1
    assert "cannot tell, v2.35 and v2.35-2024-02 fit alike" in result.output
    assert "replies to read_status_1" in result.output
    assert "1 of 3 frames have no id of mwd_motor and are left out" in result.output
    assert run(tmp_path, ["7FF#00"]).exit_code == 1


def test_json(tmp_path: Path) -> None:
    found = json.loads(run(tmp_path, V2_35, "--format", "json").output)
    (node,) = found["nodes"]
    assert (found["family"], node["node"], node["fits"]) == ("mwd_motor", 2, ["v2.35"])
    assert node["editions"][0] == {"edition": "v2.35", "explained": 4, "score": 0, "against": []}
    assert all(edition["score"] >= 3 for edition in node["editions"][1:])


def test_a_rare_slip_does_not_decide(tmp_path: Path) -> None:
    lines = V2_35 * 30 + ["142#9A3200E701000400"]
    found, _ = identify(frames(write(tmp_path, lines)), EDITIONS)
    assert [e.name for e in found[0].editions] == ["v2.35"]
    assert found[0].candidates[0].against and found[0].candidates[0].score == 0


@pytest.mark.parametrize(
    "line",
    [
        "(1.5) can0 141#9A01",
        "141#9A01",
        "  can0  141   [2]  9A 01",
        " (2026-01-01 10:00:00.000000)  can0  141   [2]  9A 01",
        " (1.5)  can0  RX - -  141   [2]  9A 01   '..'",
    ],
)
def test_what_candump_writes(line: str, tmp_path: Path) -> None:
    file = tmp_path / "x.txt"
    file.write_text(f"# a comment\n\n{line}\n", "utf-8")
    assert list(frames(file)) == [CanFrame(0x141, b"\x9a\x01")]


def test_extended_and_remote_frames(tmp_path: Path) -> None:
    file = tmp_path / "x.log"
    file.write_text("can0 00000141#R\ncan0  00000142   [0]  remote request\n", "utf-8")
    assert list(frames(file)) == [CanFrame(0x141, b"", True, True), CanFrame(0x142, b"", True, True)]


def test_a_log_of_python_can(tmp_path: Path) -> None:
    file = tmp_path / "bus.asc"
    with can.Logger(str(file)) as log:
        for line in V2_35:
            id_, data = line.split("#")
            log.on_message_received(
                can.Message(arbitration_id=int(id_, 16), data=bytes.fromhex(data), is_extended_id=False, timestamp=1.0)
            )
    assert [frame.data.hex().upper() for frame in frames(file)] == [line.split("#")[1] for line in V2_35]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("can0 141#9A0\n", ":1: the data has half a byte"),
        ("can0 141#\nhello\n", ":2: expected a frame as candump writes it"),
    ],
)
def test_what_is_no_log(text: str, says: str, tmp_path: Path) -> None:
    file = tmp_path / "x.log"
    file.write_text(text, "utf-8")
    with pytest.raises(LogError, match=says):
        list(frames(file))
    result = CliRunner().invoke(main, ["identify", str(file), "--spec", str(spec_files(ROOT / "spec")[0])])
    assert (result.exit_code, says in result.output) == (2, True)


def test_bytes_and_broken_recordings(tmp_path: Path) -> None:
    file = tmp_path / "x.log"
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(LogError, match="is no text"):
        list(frames(file))
    broken = tmp_path / "x.blf"
    broken.write_bytes(b"not a recording at all, but long enough to be looked at" * 10)
    with pytest.raises(LogError, match=r"cannot be read as \.blf"):
        list(frames(broken))


@pytest.mark.parametrize("file", spec_files(ROOT / "spec"), ids=lambda file: file.stem)
def test_golden_frames_speak_for_their_own_edition(file: Path) -> None:
    """What an encoder of an edition writes has nothing against it there, but for values that no node would report."""
    item = described(file)
    assert item.frames is not None
    far_out = {m.command for m in item.edition.all_messages() for f in m.layout.fields if f.type.plausible}
    checked = [g for g in item.frames.frames if not g.decode_only and g.command not in far_out]
    assert len(checked) > 100
    for golden in checked:
        assert best_reading(item.edition, CanFrame(golden.id, golden.data))[1] == [], golden
