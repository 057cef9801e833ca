"""Every frame has a length, and a kind, that exists in the frame format of the bus."""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from ..model.metadata import FrameFormat
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    bus = subject.edition.bus
    seen: set[DocumentPath] = set()
    if bus.dlc not in bus.frame_format.lengths:
        yield _wrong(("bus", "dlc"), "a frame", bus.dlc, bus.frame_format)
    for command in subject.edition.commands:
        for message in (command.request, None if command.is_echoed else command.reply):
            if message is None or message.command != command.name:
                continue
            entry = command.entry
            is_of_entry = entry is not None and subject.spec.tables[entry.table].entries[entry.name].dlc == message.dlc
            path = entry.path if entry is not None and is_of_entry else message.path
            if message.remote and bus.frame_format.is_fd and path not in seen:
                text = f"`{message.name}` is a remote frame, which CAN FD does not have"
                yield Finding((*path, "remote"), text, "remove `remote`, or `frame_format` of `bus`")
                seen.add(path)
            elif message.dlc not in (*bus.frame_format.lengths, bus.dlc) and path not in seen:
                yield _wrong((*path, "dlc"), f"`{message.name}`", message.dlc, bus.frame_format)
                seen.add(path)


def _wrong(path: DocumentPath, what: str, dlc: int, frame_format: FrameFormat) -> Finding:
    if not frame_format.is_fd:
        text = f"{what} has {dlc} data bytes, but a frame of classic CAN has at most {frame_format.max_data_bytes}"
        longer = "" if dlc not in FrameFormat.FD.lengths else ", or `frame_format: fd_brs` in `bus` for CAN FD"
        return Finding(path, text, f"check `dlc`{longer}")
    below = max(length for length in frame_format.lengths if length < dlc)
    above = min(length for length in frame_format.lengths if length > dlc)
    text = f"{what} has {dlc} data bytes, but a frame of CAN FD has {below} or {above}"
    return Finding(path, text, f"write dlc: {above}; bytes without a field are sent as 0")
