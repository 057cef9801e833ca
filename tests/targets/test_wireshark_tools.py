"""Golden frames and exchanges through tshark."""

from __future__ import annotations

import itertools
import math
import shlex
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TypeVar

import can
import pytest
from canwright.conformance.adapter import ExactValue
from canwright.model.golden_frames import CheckedFrame, Exchange, GoldenFrame, RefusedFrame
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.project.loader import specification
from canwright.semantics.decoder import Decoder, Identified
from canwright.semantics.frame import CanFrame
from canwright.targets.base import EditionInput, Output
from canwright.targets.wireshark.family import Filters, flag_filter, preference
from canwright.targets.wireshark.target import WiresharkTarget

from ..spec_texts import MINIMAL, ROOT, SPECS, called
from ..tools import run, tool
from .tshark import Captured, Dissected, capture, dissect

pytestmark = pytest.mark.tools

T = TypeVar("T", GoldenFrame | RefusedFrame, Exchange)

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND


class Replay:
    """The golden frames of an edition through its dissector."""

    def __init__(self, item: EditionInput, folder: Path) -> None:
        assert item.frames is not None
        self.edition, self.frames = item.edition, item.frames
        self._folder = folder
        self._script = folder / f"{item.edition.family}.lua"
        texts = {output.path: output.text for output in WiresharkTarget().generate([item], {})}
        self._script.write_text(texts[self._script.name], "utf-8")
        self._filters = Filters([item.edition]).names
        self._decoder = Decoder(item.edition)
        self.failures: list[str] = []
        self.passed = 0

    def frames_alone(self) -> None:
        """Every golden frame and every rejected one, with the direction in the capture."""
        entries: list[GoldenFrame | RefusedFrame] = [
            *self.frames.frames,
            *(frame for frame in self.frames.refused if isinstance(frame, RefusedFrame)),
        ]

        for settings, same in _by_parameters(entries):
            captured = [
                Captured(START + number * SECOND, _can(frame), _direction(frame)) for number, frame in enumerate(same)
            ]
            for frame, dissected in zip(same, self._dissect(captured, {"marks": "always", **settings}), strict=True):
                wrong = (
                    self._refused(frame, dissected)
                    if isinstance(frame, RefusedFrame)
                    else self._decoded(frame, dissected)
                )
                self._count(frame, wrong)

    def exchanges(self) -> None:
        """Every pair of frames of the golden file: the second is the reply to the first, or is not."""
        for settings, exchanges in _by_parameters(self.frames.exchanges):
            captured = [
                Captured(START + number * SECOND + late * 100_000, _can(frame), direction)
                for number, exchange in enumerate(exchanges)
                for late, (frame, direction) in enumerate(
                    zip((exchange.request, exchange.reply), Direction, strict=True)
                )
            ]
            dissected = self._dissect(captured, {"marks": "always", **settings})
            for number, exchange in enumerate(exchanges):
                reply = dissected[2 * number + 1]
                request = reply.one(self._name("request_in")) if reply else None
                wanted = str(2 * number + 1) if exchange.says is None else None
                self._count(exchange, "" if request == wanted else f"request {request}, not {wanted}")

    def _dissect(self, captured: list[Captured], settings: Mapping[str, str]) -> list[Dissected | None]:
        return dissect(self._folder, [self._script], self.edition.family, captured, settings)

    def _count(self, golden: GoldenFrame | RefusedFrame | Exchange, wrong: str) -> None:
        if wrong:
            self.failures.append(f"{golden}: {wrong}")
        else:
            self.passed += 1

    def _name(self, name: str) -> str:
        return f"{self.edition.family}.{name}"

    def _refused(self, frame: RefusedFrame, dissected: Dissected | None) -> str:
        if dissected is None:  # an id with a parameter that is missing is no id of the edition
            return "" if frame.says in (Refusal.UNKNOWN_ID, Refusal.MISSING_PARAMETER) else "not dissected"
        reason = dissected.one(self._name("rejected"))
        return "" if reason == frame.says.value else f"{reason}, not {frame.says.value}"

    def _decoded(self, frame: GoldenFrame, dissected: Dissected | None) -> str:
        wanted = self._decoder.identify(frame.direction, _can(frame), frame.parameters)
        assert isinstance(wanted, Identified)
        if dissected is None:
            return "not dissected"
        fields = wanted.message.layout.fields
        run = wanted.message.node_in_data
        in_data = next((frame.raw[field.name] for field in fields if run and field.is_node), None)
        node = in_data if frame.node is None else frame.node
        facts = {
            "rejected": None,
            "direction": frame.direction.value,
            "command": wanted.message.command,
            "node": None if node is None else str(node),
            "edition": self.edition.name,
        }
        for name, value in facts.items():
            if dissected.one(self._name(name)) != value:
                return f"{name} {dissected.one(self._name(name))}, not {value}"
        for field in fields:
            if field.name in frame.raw and field.type.joined is None:
                raw = frame.raw[field.name]
                raws = raw if isinstance(raw, list) else [raw]
                name = self._name(self._filters[field.name])
                shown = dissected.all(f"{name}.raw") or dissected.all(name)
                if [int(text) for text in shown] != raws:
                    return f"{field.name}: raw {shown}, not {raws}"
                for flag in field.type.flags:
                    bits = dissected.all(f"{name}.{flag_filter(flag.name)}")
                    if [int(bit) for bit in bits] != [raw_ >> flag.value & 1 for raw_ in raws]:
                        return f"{flag.name}: {bits}"
            if field.name in frame.values and not field.type.flags:
                wrong = self._value(dissected, self._name(self._filters[field.name]), frame.values[field.name])
                if wrong:
                    return f"{field.name}: {wrong}"
        return ""

    def _value(self, dissected: Dissected, name: str, value: ExactValue) -> str:
        shown, wanted = dissected.all(name), value if isinstance(value, list) else [value]
        named = (text for known, _, text in dissected.fields if known in (name, f"{name}.raw"))
        # Those of values, of raw integers without one, or none.
        texts = [text for text in named if " (raw): " not in text] or [""] * len(wanted)
        numbers = iter(shown)
        for expected, text in zip(wanted, texts, strict=True):
            printed = text.partition(": ")[2]
            if expected == "none":
                is_right = not shown or printed.startswith("unknown")
            elif isinstance(expected, str):
                is_named = printed.endswith(f" ({expected})")  # beside the number
                is_right = is_named or printed == expected or printed.startswith(f"{expected} (")
                numbers = iter([*numbers][is_named:])
            else:
                is_right = math.isclose(float(expected), float(next(numbers)), rel_tol=1e-14)
            if not is_right:
                return f"{printed}, not {expected}"
        return ""


def _by_parameters(entries: Iterable[T]) -> Iterator[tuple[dict[str, str], list[T]]]:
    """Entries with the same parameters, with these as preferences."""

    def under(entry: T) -> str:
        return str(sorted(entry.parameters.items()))

    for _, group in itertools.groupby(sorted(entries, key=under), under):
        same = list(group)
        yield {preference(name): str(value) for name, value in same[0].parameters.items()}, same


def _can(frame: GoldenFrame | RefusedFrame | CheckedFrame) -> CanFrame:
    return CanFrame(frame.id, frame.data, frame.extended, frame.remote)


def _direction(frame: GoldenFrame | RefusedFrame) -> Direction:
    return frame.direction if isinstance(frame, GoldenFrame) else frame.decode


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_golden_frames_through_tshark(spec: Path, tmp_path: Path) -> None:
    replay = Replay(specification(spec), tmp_path)
    replay.frames_alone()
    replay.exchanges()
    assert not replay.failures, f"{len(replay.failures)} of {replay.passed}\n" + "\n".join(replay.failures[:20])
    assert replay.passed


def test_editions_and_parameters_of_nodes(tmp_path: Path) -> None:
    """Two editions on one bus; other nodes are not decoded, and nothing is without settings."""
    specs = [specification(ROOT / f"spec/mwd_motor/{name}.yaml") for name in ("v2.35", "v2.35-2024-02")]
    script = _script(tmp_path, WiresharkTarget().generate(specs, {}))
    frames = [
        (0x141, "9A 32 00 E7 01 00 00 00"),
        (0x142, "9A 32 08 13 64 00 00 00"),
        (0x143, "A1 32 9B 00 F4 01 00 80"),
    ]
    captured = [
        Captured(START + number * SECOND, CanFrame(id_, bytes.fromhex(data)), Direction.REPLY)
        for number, (id_, data) in enumerate(frames)
    ]

    def found(preferences: Mapping[str, str], name: str) -> list[str | None]:
        dissected = dissect(tmp_path, [script], "mwd_motor", captured, {"marks": "always", **preferences})
        return [frame.one(f"mwd_motor.{name}") if frame else None for frame in dissected]

    nodes = {"nodes": "1: v2.35; 2: v2.35-2024-02"}
    assert found(nodes, "voltage") == ["48.7", "48.72", None]
    assert found(nodes, "edition") == ["v2.35", "v2.35-2024-02", None]
    assert found({**nodes, "edition": "v2.35", "series": "MG"}, "iq") == [None, None, "2.49755859375"]
    assert found({"nodes": "3: v2.35 series=MF"}, "iq") == [None, None, "1.248779296875"]
    assert found({}, "edition") == [None, None, None]
    assert found({"nodes": "3: v9", "edition": "v2.35"}, "edition") == ["v2.35"] * 3


def test_a_family_with_the_name_of_a_protocol_of_wireshark(tmp_path: Path) -> None:
    (tmp_path / "ip.yaml").write_text(MINIMAL.replace("family: lamp", "family: ip"), "utf-8")
    script = _script(tmp_path, WiresharkTarget().generate([specification(tmp_path / "ip.yaml")], {}))
    captured = [Captured(START, CanFrame(0x102, bytes.fromhex("10 00 01 00 00 00 00 00")))]
    [dissected] = dissect(tmp_path, [script], "ip_can", captured, {})
    assert dissected is not None and dissected.one("ip_can.command") == "dim"


GENERATED = ROOT / "generated/wireshark"
EXCHANGE = [CanFrame(0x141, bytes.fromhex("A10000009B000000")), CanFrame(0x141, bytes.fromhex("A1329B00F4010080"))]


def test_the_command_of_the_guide(tmp_path: Path) -> None:
    shutil.copy(GENERATED / "mwd_motor.lua", tmp_path)
    file = tmp_path / "bus.pcapng"
    file.write_bytes(capture(Captured(START + i * 200_000, frame) for i, frame in enumerate(EXCHANGE)))
    guide = (GENERATED / "README.md").read_text("utf-8")
    (line,) = (line for line in guide.splitlines() if line.startswith("tshark -X"))
    _, *options = shlex.split(line.replace("mwd_motor.lua", str(tmp_path / "mwd_motor.lua")))
    options[-1] = str(file)
    request, reply = run(tool("tshark"), *options).splitlines()
    assert "set_torque request, node 1: iq 2.49755859375 A" in request
    assert "set_torque reply, node 1: temperature 50 °C, iq 2.49755859375 A, speed 500 °/s, encoder 180 °" in reply


def test_blf_gives_the_directions(tmp_path: Path) -> None:
    """The marks decide against the content, which is the same in both frames."""
    file = tmp_path / "bus.blf"
    with can.BLFWriter(file) as writer:
        for number, is_rx in enumerate((False, True, True)):
            frame = EXCHANGE[0]
            writer.on_message_received(
                can.Message(1000 + number, frame.id, is_extended_id=False, data=frame.data, is_rx=is_rx)
            )
    shown = [part for name in ("rule", "direction") for part in ("-e", f"mwd_motor.{name}")]
    settings = ("-o", "mwd_motor.edition:v2.35", "-T", "fields", *shown)
    text = run(tool("tshark"), "-r", file, "-X", f"lua_script:{GENERATED}/mwd_motor.lua", *settings)
    assert text.split()[-4:] == ["mark", "reply", "mark", "reply"]


def _script(folder: Path, outputs: Iterable[Output]) -> Path:
    output = next(output for output in outputs if output.path.endswith(".lua"))
    (folder / output.path).write_text(output.text, "utf-8")
    return folder / output.path
