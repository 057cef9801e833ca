"""Captures for Wireshark, and what tshark with a generated dissector prints about them."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from canwright.model.message import Direction
from canwright.semantics.frame import CanFrame

from ..tools import run, tool

SOCKETCAN = 227
"""The link type of CAN frames in a capture."""
FLAGS = {Direction.REPLY: 1, Direction.REQUEST: 2, None: 0}
"""The direction in the flags of a packet: inbound, outbound, or none."""


@dataclass(frozen=True)
class Captured:
    """A frame in a capture, at a time in ns, with its direction if the capture has it."""

    time: int
    frame: CanFrame
    direction: Direction | None = None


@dataclass
class Dissected:
    """What tshark prints about a frame: the text and the number or text of each field, in order."""

    fields: list[tuple[str, str, str]] = field(default_factory=list)

    def all(self, name: str) -> list[str]:
        """The values of all fields of this name."""
        return [show for field_name, show, _ in self.fields if field_name == name]

    def one(self, name: str) -> str | None:
        """The value of a field; None without it."""
        return next(iter(self.all(name)), None)

    def texts(self, name: str) -> list[str]:
        """The texts of all fields of this name."""
        return [text for field_name, _, text in self.fields if field_name == name]


def _block(kind: int, body: bytes) -> bytes:
    body += bytes(-len(body) % 4)
    return struct.pack("<II", kind, len(body) + 12) + body + struct.pack("<I", len(body) + 12)


def capture(frames: Iterable[Captured]) -> bytes:
    """A pcapng file with times in ns."""
    section = struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1)
    resolution = struct.pack("<HHB3xHH", 9, 1, 9, 0, 0)
    blocks = [_block(0x0A0D0D0A, section), _block(1, struct.pack("<HHI", SOCKETCAN, 0, 0) + resolution)]
    for captured in frames:
        frame = captured.frame
        id_ = frame.id | frame.extended << 31 | frame.remote << 30
        packet = struct.pack(">IB3x", id_, len(frame.data)) + frame.data
        head = struct.pack("<IIIII", 0, captured.time >> 32, captured.time & 0xFFFFFFFF, len(packet), len(packet))
        flags = struct.pack("<HHIHH", 2, 4, FLAGS[captured.direction], 0, 0)
        blocks.append(_block(6, head + packet + bytes(-len(packet) % 4) + flags))
    return b"".join(blocks)


def dissect(
    folder: Path, scripts: Sequence[Path], family: str, frames: Iterable[Captured], preferences: Mapping[str, str]
) -> list[Dissected | None]:
    """What a dissector adds to each frame; None for a frame that it does not take."""
    file = folder / "frames.pcapng"
    file.write_bytes(capture(frames))
    options = [part for name, value in preferences.items() for part in ("-o", f"{family}.{name}:{value}")]
    loaded = [part for script in scripts for part in ("-X", f"lua_script:{script}")]
    text = run(tool("tshark"), "-r", file, *loaded, *options, "-T", "pdml", "-J", family)
    return [_dissected(packet, family) for packet in ElementTree.fromstring(text).iter("packet")]


def _dissected(packet: ElementTree.Element, family: str) -> Dissected | None:
    ours = [proto for proto in packet.iter("proto") if proto.get("name") == family]
    if not ours:
        return None
    return Dissected(list(_fields(ours[0])))


def _fields(element: ElementTree.Element) -> Iterator[tuple[str, str, str]]:
    for field_element in element.iter("field"):
        yield field_element.get("name", ""), field_element.get("show", ""), field_element.get("showname", "")
