"""Captures of Wireshark and tcpdump (pcap and pcapng) whose packets are frames of SocketCAN, also of the device `any`."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from .log_frame import Counts, LogError, LogFrame, Mark, SkippedPart, log_frame

PCAPNG = b"\n\r\r\n"
_PCAP = {
    b"\xd4\xc3\xb2\xa1": ("<", 6),
    b"\xa1\xb2\xc3\xd4": (">", 6),
    b"\x4d\x3c\xb2\xa1": ("<", 9),
    b"\xa1\xb2\x3c\x4d": (">", 9),
}
"""The byte order and the decimal digits of the fraction of a second, by the first bytes."""
MAGICS = (PCAPNG, *_PCAP)
_SOCKETCAN, _SLL, _SLL2 = 227, 113, 276
_CAN_PROTOCOLS = (0x000C, 0x000D)
_OUTGOING = 4
_EXTENDED, _REMOTE, _ERROR = 1 << 31, 1 << 30, 1 << 29
_MAX_BLOCK = 1 << 24
_INTERFACE, _PACKET = 1, 6
_NAME, _RESOLUTION = 2, 9
"""Options of an interface."""


class _Interface(NamedTuple):
    link: int
    name: str
    ticks: int
    """The units of a time in a second."""


def read(source: BinaryIO, counts: Counts) -> Iterator[LogFrame]:
    """The frames of a capture. Raises EOFError if it is truncated, and LogError."""
    magic = source.read(4)
    for interface, order, ticks, packet in _blocks(source) if magic == PCAPNG else _records(source, *_PCAP[magic]):
        if interface.link not in (_SOCKETCAN, _SLL, _SLL2):
            raise LogError(
                f"the packets of this capture are not of CAN (link type {interface.link}); capture a device such as can0"
            )
        frame = _frame(interface, order, ticks * 1_000_000_000 // interface.ticks, packet)
        if isinstance(frame, LogFrame):
            yield frame
        else:
            counts.skip(frame)


def _exactly(source: BinaryIO, size: int) -> bytes:
    content = source.read(size) if 0 <= size <= _MAX_BLOCK else b""
    if len(content) != size:
        raise EOFError(f"the last packet has {len(content)} of {size} bytes")
    return content


_Packets = Iterator[tuple[_Interface, str, int, bytes]]
"""Interface, byte order, time in units of the interface, and content."""


def _records(source: BinaryIO, order: str, digits: int) -> _Packets:
    """The packets of a pcap file after its first four bytes."""
    *_, link = struct.unpack(f"{order}HHiIII", _exactly(source, 20))
    interface = _Interface(link & 0xFFFF, "", 10**digits)
    while start := source.read(1):
        seconds, fraction, size, _ = struct.unpack(f"{order}IIII", start + _exactly(source, 15))
        yield interface, order, seconds * interface.ticks + fraction, _exactly(source, size)


def _blocks(source: BinaryIO) -> _Packets:
    """The packets of a pcapng file after its first four bytes."""
    order, interfaces, kind = "<", list[_Interface](), PCAPNG
    while kind:
        kind += _exactly(source, 4 - len(kind))
        size = _exactly(source, 4)
        is_section = kind == PCAPNG
        start = _exactly(source, 4) if is_section else b""
        if is_section:
            order, interfaces = ">" if start == b"\x1a\x2b\x3c\x4d" else "<", []
        (total,) = struct.unpack(f"{order}I", size)
        body = _exactly(source, total - 12 - len(start))
        _exactly(source, 4)
        number = struct.unpack(f"{order}I", kind)[0]
        if number == _INTERFACE and len(body) >= 8:
            interfaces.append(_interface(body, order))
        elif number == _PACKET and len(body) >= 20:
            at, high, low, length = struct.unpack(f"{order}IIII", body[:16])
            if at < len(interfaces):
                yield interfaces[at], order, high << 32 | low, body[20 : 20 + length]
        kind = source.read(1)


def _interface(body: bytes, order: str) -> _Interface:
    """The interface that a block describes."""
    link, rest, name, ticks = struct.unpack(f"{order}H", body[:2])[0], body[8:], "", 1_000_000
    while len(rest) >= 4:
        option, size = struct.unpack(f"{order}HH", rest[:4])
        content, rest = rest[4 : 4 + size], rest[4 + (size + 3) // 4 * 4 :]
        if option == _NAME:
            name = content.rstrip(b"\0").decode("utf-8", "replace")
        elif option == _RESOLUTION and content:
            ticks = 2 ** (content[0] & 0x7F) if content[0] & 0x80 else 10 ** content[0]
    return _Interface(link, name, ticks)


def _frame(interface: _Interface, order: str, time: int, packet: bytes) -> LogFrame | SkippedPart:
    """The frame in a packet, or what the packet is instead. Captures of `any` have the id in the byte order of the host."""
    mark = None
    if interface.link != _SOCKETCAN:
        size, protocol, direction = (
            (16, packet[14:16], packet[1:2]) if interface.link == _SLL else (20, packet[:2], packet[10:11])
        )
        if int.from_bytes(protocol, "big") not in _CAN_PROTOCOLS:
            return SkippedPart.OTHER
        mark, packet = Mark.SENT if direction == bytes([_OUTGOING]) else Mark.RECEIVED, packet[size:]
    if len(packet) < 8:
        return SkippedPart.MALFORMED
    id_ = int.from_bytes(packet[:4], "big" if interface.link == _SOCKETCAN or order == ">" else "little")
    if id_ & _ERROR:
        return SkippedPart.ERROR
    remote = bool(id_ & _REMOTE)
    data = b"" if remote else packet[8 : 8 + packet[4]]
    if not remote and len(data) != packet[4]:
        return SkippedPart.MALFORMED
    extended = bool(id_ & _EXTENDED)
    return log_frame(time, interface.name, id_ & ~(_EXTENDED | _REMOTE), data, mark, extended=extended, remote=remote)
