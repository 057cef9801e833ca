"""The decoder of the generated Wireshark dissector, in the Lua versions of old and new Wiresharks."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import lupa.lua52
import lupa.lua54
from canwright.conformance.adapter import CanFrame, Cannot, Decoded, DecodeOnlyAdapter, Parameters, Refused, Value
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS
from canwright.targets.base import EditionInput
from canwright.targets.wireshark.target import WiresharkTarget

RUNTIMES = (lupa.lua52.LuaRuntime, lupa.lua54.LuaRuntime)


class LuaDecoder:
    """The decoder of one edition in one version of Lua."""

    def __init__(self, runtime: Any, source: str, edition: Edition) -> None:
        self.lua = runtime
        self.module = runtime.execute(source)
        self.codec = self.module.codec
        self.edition = next(e for e in self.module.family.editions.values() if e.name == edition.name)
        self._directions = {Direction.REQUEST: "requests", Direction.REPLY: "replies"}
        every = list(self.edition.messages.values())
        self._messages = {(m.direction, m.command): m for m in every}
        self._messages |= {("reply", m.command): m.answer.reply for m in every if m.answer.reply}
        self._numbers = {p.name for p in edition.parameters if not p.is_choice}

    def frame(self, frame: CanFrame) -> Any:
        """A frame as the table of the decoder."""
        table = self.lua.table_from(
            {0: frame.id, **dict(enumerate(frame.data, 1))} if not frame.remote else {0: frame.id}
        )
        table.length, table.extended, table.remote = len(frame.data), frame.extended, frame.remote
        return table

    def parameters(self, given: Parameters) -> Any:
        """Parameters as the dissector reads them from the preferences."""
        read = {
            name: self.codec.rational(str(value)) if name in self._numbers else str(value)
            for name, value in given.items()
        }
        return self.lua.table_from(read)

    def decode(self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: Any) -> Decoded | Refused:
        """What a frame means, as the message `expected` or by itself."""
        table = self.frame(frame)
        self._configure(parameters)
        if expected is None:
            message, detail = _two(self.codec.identify(self.edition, self._directions[direction], table))
            if message is None:
                return Refused(Refusal(detail))
            node = detail
        else:
            message = expected
            fits, node = _two(self.codec.is_message(message, table))
            if not fits:
                raise Cannot("expected")
        fields = self.codec.decode(message, table, self.parameters(parameters))
        if isinstance(fields, tuple):
            return Refused(Refusal(fields[1]))
        return _decoded(message, node, list(fields.values()))

    def _configure(self, parameters: Parameters) -> None:
        """Sets the parameters in ids, as a change of the preferences does."""
        self.codec.configure(self.edition, self.lua.table_from([self.parameters(parameters)]))

    def message(self, direction: Direction, command: str) -> Any:
        """The request or the reply of a command."""
        return self._messages[direction.value, command]

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters) -> Refused | None:
        """Why a frame is not the reply to a request."""
        asking = self.frame(request)
        self._configure(parameters)
        message, detail = _two(self.codec.identify(self.edition, "requests", asking))
        if message is None:
            return Refused(Refusal(detail))
        rejected = self.codec.rejects(message, asking)
        if rejected is not None:
            return Refused(Refusal(rejected))
        fits, _ = _two(self.codec.answer(message, detail, asking, self.frame(reply)))
        return None if fits else Refused(Refusal.NOT_ANSWER)


def _two(results: Any) -> tuple[Any, Any]:
    """Two results of a function of Lua; the second can be missing."""
    return (results[0], results[1]) if isinstance(results, tuple) else (results, None)


def _decoded(message: Any, node: int | None, fields: list[Any]) -> Decoded:
    raw: dict[str, Any] = {}
    values: dict[str, Any] = {}
    for entry in fields:
        name = entry.field.name
        if entry.raws:
            raw[name] = [int(number) for number in entry.raws.values()]
            values[name] = entry.value.decode("utf-8") if isinstance(entry.value, bytes) else entry.value
            continue
        integer = int(entry.high) * (1 << 32) + int(entry.low)
        value: Value = entry.no_value or entry.value
        if hasattr(value, "values"):
            value = list(value.values())  # type: ignore[union-attr]
        if entry.field.indices:
            raw.setdefault(name, []).append(integer)
            values.setdefault(name, []).append(value)
        else:
            raw[name], values[name] = integer, value
        if entry.reason == Refusal.MISSING_PARAMETER.value:
            values.pop(name, None)
    return Decoded(message.command, None if node is None else int(node), raw, values)


class WiresharkAdapter(DecodeOnlyAdapter):
    """Answers through the functions that the dissector calls; all versions of Lua must agree."""

    name = "wireshark"
    cannot: ClassVar[Mapping[str, str]] = {
        "encode": "a dissector only decodes",
        "expected": "a frame that is no reply to the request before it is decoded by itself",
    }

    def __init__(self, edition: Edition, source: str) -> None:
        super().__init__(edition)
        self._decoders = [LuaDecoder(runtime(unpack_returned_tuples=False), source, edition) for runtime in RUNTIMES]

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> WiresharkAdapter:
        """Loads the generated file in each version of Lua."""
        outputs = {output.path: output.text for output in WiresharkTarget().generate([specification], {})}
        return cls(specification.edition, outputs[f"{specification.edition.family}.lua"])

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        first, *rest = (
            decoder.decode(direction, frame, parameters, expected and decoder.message(direction, expected))
            for decoder in self._decoders
        )
        assert rest == [first] * len(rest), f"the versions of Lua differ: {first}, {rest}"
        return first

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        first, *rest = (decoder.answers(request, reply, parameters) for decoder in self._decoders)
        assert rest == [first] * len(rest), f"the versions of Lua differ: {first}, {rest}"
        return first
