"""The tables of an edition that the runtime interprets: types, layouts, messages and the dispatch plan."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import ConstantRole, Field, Layout, ReservedRole, Segment, Space
from ...model.message import BitRun, Command, Direction, IdRule, Message
from ...model.types import Encoding, Linear, Type
from ...semantics import dispatch
from ...semantics.bits import data_bits
from ...semantics.plan import only_by_request
from ..nested_source import Code
from . import text
from .filters import flag_filter
from .text import Table, Value


@dataclass(frozen=True, kw_only=True)
class EditionView:
    """An edition as Lua tables; the messages refer to the layouts, and the layouts to the types, by their positions."""

    name: str
    reply_within: Value
    types: tuple[Table, ...]
    layouts: tuple[Table, ...]
    messages: tuple[Table, ...]
    answers: tuple[tuple[int, Table], ...]
    """The positions of requests, and the facts about their replies."""
    requests: tuple[Table, ...]
    replies: tuple[Table, ...]
    explained: tuple[Code, ...]
    """Replies that only their request identifies."""


class EditionTables:
    """Creates the tables of one edition; `filters` are the names of fields in filters."""

    def __init__(self, edition: Edition, filters: Mapping[str, str]) -> None:
        self._edition = edition
        self._filters = filters
        self._messages = {message: number for number, message in enumerate(edition.all_messages(), 1)}
        layouts = dict.fromkeys(message.layout for message in self._messages)
        self._layouts = {layout: number for number, layout in enumerate(layouts, 1)}
        types = dict.fromkeys(field.type for layout in layouts for field in layout.fields)
        self._types = {type_: number for number, type_ in enumerate(types, 1)}

    def view(self) -> EditionView:
        """All tables."""
        edition = self._edition
        within = edition.bus.reply_within_ms
        explained = only_by_request(edition)
        return EditionView(
            name=edition.name,
            reply_within=None if within is None else text.number(within * 1_000_000),
            types=tuple(map(_type, self._types)),
            layouts=tuple(map(self._layout, self._layouts)),
            messages=tuple(map(self._message, self._messages)),
            answers=tuple(self._answers()),
            requests=tuple(self._routes(Direction.REQUEST)),
            replies=tuple(self._routes(Direction.REPLY)),
            explained=tuple(map(self._reference, explained)),
        )

    def _reference(self, message: Message) -> Code:
        return Code(f"messages[{self._messages[message]}]")

    def _layout(self, layout: Layout) -> Table:
        choices = {value: True for variant in layout.variants for value in variant.values}
        return {
            "parameter": layout.parameter,
            "choices": choices or None,
            "fields": [self._field(field) for field in layout.fields],
        }

    def _field(self, field: Field) -> Table:
        elements = [segments(element.segments, field.space) for element in field.elements]
        title = text.english(field.title) or formatting.spoken(field.name)
        return {
            "name": field.name,
            "label": title,
            "filter": self._filters[field.name] if field.role.is_value else None,
            "type": Code(f"types[{self._types[field.type]}]"),
            "elements": elements,
            "indices": [element.index or 0 for element in field.elements] if field.is_array else None,
            "only": dict.fromkeys(field.only, True) or None,
            "fixed": True if not field.role.is_value else None,
            "constant": text.key(field.role.raw, field.type.width) if isinstance(field.role, ConstantRole) else None,
        }

    def _message(self, message: Message) -> Table:
        return {
            "command": message.command,
            "direction": message.direction.value,
            "length": message.dlc,
            **_rule(message.id, message.remote, message.id_mask),
            "keys": list(map(_key, range(len(message.keys)), [message] * len(message.keys))),
            "layout": Code(f"layouts[{self._layouts[message.layout]}]"),
            "node_bits": _node_bits(message),
            "has_node_in_data": True if message.node_in_data else None,
            "reserved": list(_reserved(message)),
        }

    def _answers(self) -> Iterator[tuple[int, Table]]:
        for command in self._edition.commands:
            if command.request is not None and command.request in self._messages:
                yield self._messages[command.request], self._answer(command, command.request)

    def _answer(self, command: Command, request: Message) -> Table:
        reply = command.reply
        own = command.reply_within_ms
        distinct = reply is not None and bool(_reserved_mask(request) & ~_reserved_mask(reply))
        return {
            "reply": self._reference(reply) if reply is not None else None,
            "nodes": list(command.from_each),
            "echo": command.is_echoed,
            "distinct": distinct,
            "reply_within": None if own is None else text.number(own * 1_000_000),
        }

    def _routes(self, direction: Direction) -> Iterator[Table]:
        for route in dispatch.dispatch_plan(self._edition, direction).routes:
            yield {**_rule(route.rule, route.remote, route.mask), "plan": self._plan(route.then)}

    def _plan(self, node: dispatch.DispatchNode) -> Value:
        if isinstance(node, dispatch.Reject):
            return node.reason.value
        if isinstance(node, dispatch.Match):
            return self._reference(node.message)
        width = node.subject.width if isinstance(node.subject, BitRun) else 32
        cases = {text.key(value, width): self._plan(case.then) for case in node.cases for value in case.values}
        return {"on": _subject(node.subject), "cases": cases, "otherwise": self._plan(node.otherwise)}


def _subject(subject: dispatch.Discriminator) -> Value:
    if isinstance(subject, dispatch.Length):
        return "length"
    if isinstance(subject, dispatch.MaskedId):
        return _id_bits(subject.mask)
    return segments(subject.segments, subject.space)


def segments(of: Iterable[Segment], space: Space) -> list[Value]:
    """Segments as the runtime reads them; those that cross bit 32 of the raw integer are divided there."""
    found: list[Value] = []
    for s in of:
        index = 0 if space is Space.ID else s.byte + 1
        lower = min(s.width, max(0, 32 - s.raw_low))
        if lower:
            found.append([index, 1 << s.low, 1 << lower, 1 << s.raw_low])
        if s.width > lower:
            above = s.raw_low + lower - 32
            found.append([index, 1 << s.low + lower, 1 << s.width - lower, 1 << above, True])
    return found


def _id_bits(mask: int) -> list[Value]:
    """The bits of the id under a mask, not shifted."""
    return [[0, 1 << low, 1 << width, 1 << low] for low, width in _runs(mask)]


def _runs(mask: int) -> Iterator[tuple[int, int]]:
    """The lowest bit and the width of each run of bits that are set."""
    low = 0
    while mask >> low:
        if mask >> low & 1:
            width = ((mask >> low) ^ (mask >> low) + 1).bit_length() - 1
            yield low, width
            low += width
        else:
            low += 1


def _rule(rule: IdRule, remote: bool, mask: int) -> dict[str, Value]:
    return {
        "base": rule.base,
        "step": rule.node_step,
        "first": rule.nodes[0] if rule.nodes is not None else None,
        "last": rule.nodes[-1] if rule.nodes is not None else None,
        "extended": rule.extended,
        "remote": remote,
        "filled": _id_bits(mask),
    }


def _key(index: int, message: Message) -> Table:
    found = message.keys[index]
    values = [found.value, *((*message.accepted_codes, *message.identifying_codes) if index == 0 else ())]
    accepted: Table = {text.key(value, found.width): True for value in values}
    return {"segments": segments(found.segments, found.space), "values": accepted}


def _node_bits(message: Message) -> Table | None:
    bits = message.node_bits
    if bits is None:
        return None
    place: Value = segments(bits.segments, bits.space)
    return {"segments": place, "modulus": 1 << bits.width}


def _reserved_mask(message: Message) -> int:
    """The data bits that a sender always writes with the same value and a receiver ignores."""
    used = [field for field in message.layout.fields if field not in _reserved_fields(message)]
    taken = data_bits((field.space, element.segments) for field in used for element in field.elements)
    keys = data_bits((key.space, key.segments) for key in message.keys)
    return (1 << 8 * message.dlc) - 1 & ~(taken | keys)


def _reserved_fields(message: Message) -> Sequence[Field]:
    return [f for f in message.layout.fields if isinstance(f.role, ReservedRole) and not f.only]


def _reserved(message: Message) -> Iterator[Value]:
    """Runs of reserved bits within a byte: the byte, the position, the width, and the value."""
    value = 0
    for field in _reserved_fields(message):
        for element in field.elements if field.space is Space.DATA else ():
            for s in element.segments:
                bits = (field.role.sent_raw or 0) >> s.raw_low & (1 << s.width) - 1
                value |= bits << s.byte * 8 + s.low
    mask = _reserved_mask(message)
    for byte in range(message.dlc):
        for low, width in _runs(mask >> 8 * byte & 0xFF):
            yield [byte + 1, 1 << low, 1 << width, value >> 8 * byte + low & (1 << width) - 1]


def _type(type_: Type) -> Table:
    found: dict[str, Value] = {
        "width": type_.width,
        "signed": type_.encoding is Encoding.SIGNED,
        "float": type_.encoding is Encoding.FLOAT,
        "plain": type_.is_plain or bool(type_.enum or type_.flags),
        "unit": type_.unit.symbol if type_.unit else None,
    }
    if type_.enum:
        return {
            **found,
            "limited": True,
            "enum": {text.key(m.value, type_.width): m.name for m in type_.enum},
        }
    if type_.flags:
        flags: list[Value] = [
            {"bit": m.value, "name": flag_filter(m.name), "label": text.english(m.title) or m.name} for m in type_.flags
        ]
        return {**found, "limited": True, "flags": flags, "named": {m.value: True for m in type_.flags}}
    low, high = _limits(type_)
    return {
        **found,
        "limited": True if low is not None else None,
        "low": low,
        "high": high,
        "scale_by": type_.linear.parameter,
        "linear": _linears(type_),
    }


def _limits(type_: Type) -> tuple[Value, Value]:
    """The smallest and the largest allowed raw integer under any parameters; None if they are unknown."""
    spans = [span for _, span in type_.raw_range.distinct()]
    known = [span for span in spans if span is not None and span.is_constant]
    if not known or len(known) < len(spans):
        return None, None
    return (
        text.number(min(span.low.constant for span in known)),
        text.number(max(span.high.constant for span in known)),
    )


def _linears(type_: Type) -> Value:
    linear = type_.linear
    if linear.parameter is None:
        return _linear(linear.constant)
    return {name: _linear(case) for name, case in linear.cases.items()}


def _linear(linear: Linear | None) -> Value:
    if linear is None:
        return False
    if linear.is_identity:
        return {"identity": True, "factor": 1, "addend": 0, "divisor": 1}
    factor, addend, divisor = linear.as_quotient
    if max(abs(factor), abs(addend), divisor) > text.EXACT:
        scale, offset = text.number(linear.scale), text.number(linear.offset)
        return {"factor": scale, "addend": offset, "divisor": Code("1.0"), "times": linear.times}
    return {
        "factor": text.number(factor),
        "addend": text.number(addend),
        "divisor": text.number(divisor),
        "times": linear.times,
    }
