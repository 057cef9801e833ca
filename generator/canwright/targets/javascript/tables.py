"""The tables of an edition that the runtime interprets: types, layouts, messages, answers and the dispatch plan."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

from ...model.edition import Edition
from ...model.layout import Field, FixedRole, Layout, Segment, Space
from ...model.message import BitRun, Command, Direction, IdRule, Message
from ...model.types import Bound, ByParameter, Linear, Parameter, Range, Type
from ...semantics import dispatch
from ...semantics.plan import only_by_request
from . import text
from .text import NULL, Value

ID = -1
"""The byte of segments in the id."""

Table = Mapping[str, Value]
T = TypeVar("T")


class EditionTables:
    """Creates the tables of one edition; they refer to each other by position."""

    def __init__(self, edition: Edition) -> None:
        self._edition = edition
        self.messages = {message: number for number, message in enumerate(edition.all_messages())}
        layouts = dict.fromkeys(message.layout for message in self.messages)
        self.layouts = {layout: number for number, layout in enumerate(layouts)}
        types = dict.fromkeys(field.type for layout in layouts for field in layout.fields)
        self.types = {type_: number for number, type_ in enumerate(types)}

    def view(self) -> Table:
        """All tables."""
        edition = self._edition
        within = edition.bus.reply_within_ms
        return {
            "family": edition.family,
            "edition": edition.name,
            "hash": edition.hash,
            "replyWithin": NULL if within is None else text.double(within),
            "parameters": {p.name: _parameter(p) for p in edition.parameters},
            "types": [_type(type_) for type_ in self.types],
            "layouts": [self._layout(layout) for layout in self.layouts],
            "messages": [self._message(message) for message in self.messages],
            "answers": list(self._answers()),
            "explained": [self.messages[message] for message in only_by_request(edition)],
            "requests": list(self._routes(Direction.REQUEST)),
            "replies": list(self._routes(Direction.REPLY)),
        }

    def _layout(self, layout: Layout) -> Table:
        return {
            "name": layout.name,
            "parameter": layout.parameter,
            "values": [value for variant in layout.variants for value in variant.values] or None,
            "fields": [self._field(field) for field in layout.fields],
        }

    def _field(self, field: Field) -> Table:
        width = field.type.width
        return {
            "name": field.name,
            "type": self.types[field.type],
            "elements": [segments(element.segments, field.space) for element in field.elements],
            "array": field.is_array or None,
            "indices": [element.index or 0 for element in field.elements] if field.is_array else None,
            "only": list(field.only) or None,
            "fixed": text.integer(field.role.raw, width) if isinstance(field.role, FixedRole) else None,
            "constant": True if field.role.is_checked else None,
        }

    def _message(self, message: Message) -> Table:
        only = self._edition.command(message.command).only if message.direction is Direction.REQUEST else {}
        return {
            "command": message.command,
            "direction": message.direction.value,
            **_rule(message.id, message.remote, message.id_mask),
            "length": message.dlc,
            "only": {name: list(values) for name, values in only.items()} or None,
            "keys": [_key(message, number) for number in range(len(message.keys))] or None,
            "layout": self.layouts[message.layout],
            "nodeBits": segments(message.node_bits.segments, message.node_bits.space) if message.node_bits else None,
            "hasNodeInData": True if message.node_in_data else None,
        }

    def _answers(self) -> Iterator[Table]:
        for command in self._edition.commands:
            if command.request is not None and command.reply is not None:
                yield self._answer(command, command.request, command.reply)

    def _answer(self, command: Command, request: Message, reply: Message) -> Table:
        return {
            "request": self.messages[request],
            "reply": self.messages[reply],
            "nodes": list(command.from_each) or None,
            "echo": command.is_echoed or None,
        }

    def _routes(self, direction: Direction) -> Iterator[Table]:
        for route in dispatch.dispatch_plan(self._edition, direction).routes:
            yield {**_rule(route.rule, route.remote, route.mask), "plan": self._plan(route.then)}

    def _plan(self, node: dispatch.DispatchNode) -> Value:
        if isinstance(node, dispatch.Reject):
            return node.reason.value
        if isinstance(node, dispatch.Match):
            return self.messages[node.message]
        width = node.subject.width if isinstance(node.subject, BitRun) else 0
        cases: list[Value] = [
            [[text.integer(value, width) for value in case.values], self._plan(case.then)] for case in node.cases
        ]
        return {"on": _subject(node.subject), "cases": cases, "otherwise": self._plan(node.otherwise)}


def _subject(subject: dispatch.Discriminator) -> Value:
    if isinstance(subject, dispatch.Length):
        return "length"
    if isinstance(subject, dispatch.MaskedId):
        return {"mask": subject.mask}
    return segments(subject.segments, subject.space)


def segments(of: Iterable[Segment], space: Space) -> list[Value]:
    """Segments as lists: byte, lowest bit, width, lowest bit of the raw integer."""
    return [[ID if space is Space.ID else s.byte, s.low, s.width, s.raw_low] for s in of]


def _rule(rule: IdRule, remote: bool, mask: int) -> dict[str, Value]:
    return {
        "base": rule.base,
        "step": rule.node_step if rule.node_step != 1 else None,
        "nodes": [rule.nodes[0], rule.nodes[-1]] if rule.nodes is not None else None,
        "extended": rule.extended or None,
        "remote": remote or None,
        "mask": mask or None,
    }


def _key(message: Message, number: int) -> Table:
    """The bits of a key with all accepted values; the first is the one that is sent."""
    found = message.keys[number]
    values: Sequence[int] = (
        found.value,
        *((*message.accepted_codes, *message.identifying_codes) if number == 0 else ()),
    )
    accepted: list[Value] = [text.integer(value, found.width) for value in dict.fromkeys(values)]
    return {"segments": segments(found.segments, found.space), "values": accepted}


def _parameter(parameter: Parameter) -> Table:
    if parameter.is_choice:
        return {"values": [value.name for value in parameter.values]}
    return {
        "minimum": None if parameter.minimum is None else text.rational(parameter.minimum),
        "maximum": None if parameter.maximum is None else text.rational(parameter.maximum),
    }


def _type(type_: Type) -> Table:
    members: list[Value] = [[text.integer(m.value, type_.width), m.name] for m in type_.enum]
    bits: list[Value] = [[m.value, m.name] for m in type_.flags]
    is_plain = type_.is_plain or not type_.is_number
    return {
        "width": type_.width,
        "encoding": type_.encoding.value,
        "unit": type_.unit.symbol if type_.unit else None,
        "enum": members or None,
        "flags": bits or None,
        "linear": None if is_plain else _dependent(type_.linear, _linear),
        "range": None if type_.raw_range == NO_RANGE else _dependent(type_.raw_range, _range),
    }


NO_RANGE: ByParameter[Range] = ByParameter.always(None)


def _dependent(of: ByParameter[T], table: Callable[[T], Value]) -> Value:
    """A value, or its values by those of a parameter; `null` is unknown."""
    if of.parameter is None:
        return NULL if of.constant is None else table(of.constant)
    cases = {name: NULL if case is None else table(case) for name, case in of.cases.items()}
    return {"by": of.parameter, "cases": cases}


def _linear(linear: Linear) -> Table:
    factor, addend, divisor = linear.as_quotient
    steps: list[Value] = [text.double(n) for n in (linear.offset, linear.scale.denominator, linear.scale.numerator)]
    return {
        "factor": factor if factor != 1 else None,
        "addend": addend or None,
        "divisor": divisor if divisor != 1 else None,
        "steps": steps if addend else None,
        "times": linear.times,
    }


def _range(limits: Range) -> list[Value]:
    return [_bound(limits.low), _bound(limits.high)]


def _bound(bound: Bound) -> Value:
    if bound.parameter is None:
        return text.rational(bound.constant)
    return [text.rational(bound.constant), text.rational(bound.coefficient), bound.parameter]
