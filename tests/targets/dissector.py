"""The directions of a log by the generated dissector, without Wireshark."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

from canwright.model.edition import Edition
from canwright.recordings.log_frame import LogFrame, Mark
from canwright.targets.base import EditionInput
from canwright.targets.wireshark.target import WiresharkTarget
from lupa import lua54

from ..conformance.adapters.wireshark import LuaDecoder

MARKS = {Mark.SENT: "sent", Mark.RECEIVED: "received", None: None}


@functools.cache
def decoder(edition: Edition) -> LuaDecoder:
    """The decoder of an edition."""
    source = next(
        o.text for o in WiresharkTarget().generate([EditionInput(edition, None)], {}) if o.path.endswith(".lua")
    )
    return LuaDecoder(lua54.LuaRuntime(unpack_returned_tuples=False), source, edition)


def judge(edition: Edition, log: Sequence[LogFrame]) -> list[Any]:
    """The results for the frames of a log."""
    lua, results = decoder(edition), []
    state = lua.module.directions.new(2_000_000)
    for number, entry in enumerate(log):
        frame = lua.frame(entry.frame)
        _, is_request, is_reply = lua.codec.nodes(lua.edition, frame)
        only = None if is_request and is_reply else "request" if is_request else "reply"
        assert entry.time is not None
        frame.number, frame.time, frame.mark = number, entry.time, MARKS[entry.mark]
        results.append(lua.module.directions.judge(state, entry.bus, lua.edition, only, frame))
    return results
