"""The tables of an edition that an interpreter executes, in terms of no language.

Types, layouts and messages refer to each other by position. A target prints the tables; what only its language writes
differently, it overrides.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from typing import ClassVar, TypeVar

from ..model.edition import Edition
from ..model.exhaustive import assert_never
from ..model.joined import JoinedDigits, JoinedText
from ..model.layout import Field, Layout, Segment, Space
from ..model.message import BitRun, Direction, IdRule, Message
from ..model.types import ByParameter, Linear, Type
from ..semantics import dispatch
from ..semantics.checksum import ChecksumPlan
from ..semantics.exchange import ExchangePlan, exchange_plans
from ..semantics.plan import (
    CheckChecksum,
    CheckConstant,
    CheckParameter,
    ChooseFields,
    ReadField,
    message_plan,
    only_by_request,
)
from .field_contents import Content, contents
from .nested_source import Table, Value

ID = -1
"""The byte of segments in the id."""

T = TypeVar("T")


class Positions:
    """The positions of the messages, layouts and types of an edition in its tables."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition
        self.messages = {message: number for number, message in enumerate(edition.all_messages())}
        layouts = dict.fromkeys(message.layout for message in self.messages)
        self.layouts = {layout: number for number, layout in enumerate(layouts)}
        types = dict.fromkeys(field.type for layout in layouts for field in layout.fields)
        self.types = {type_: number for number, type_ in enumerate(types)}


class EditionTables(Positions, ABC):
    """The tables of one edition. An entry that is None is left out."""

    unknown: ClassVar[Value]
    """What the tables have for an unknown scale."""

    @abstractmethod
    def integer(self, raw: int, width: int) -> Value:
        """The raw integer of a field or a key."""

    @abstractmethod
    def linear(self, linear: Linear) -> Value:
        """A scale with its offset."""

    def tables(self) -> dict[str, Value]:
        """All tables that do not depend on a language."""
        return {
            "types": self.type_tables,
            "layouts": self.layout_tables,
            "messages": [self.message(message) for message in self.messages],
            "answers": [self.answer(plan) for plans in exchange_plans(self.edition).values() for plan in plans],
            "explained": [self.messages[message] for message in only_by_request(self.edition)],
            "requests": list(self._routes(Direction.REQUEST)),
            "replies": list(self._routes(Direction.REPLY)),
        }

    @cached_property
    def type_tables(self) -> list[Value]:
        """The types in the order of their positions."""
        return [self.type(type_) for type_ in self.types]

    @cached_property
    def layout_tables(self) -> list[Value]:
        """The layouts in the order of their positions."""
        return [self.layout(layout) for layout in self.layouts]

    def type(self, type_: Type) -> dict[str, Value]:
        """A type; without `linear`, its values are the raw integers or their names."""
        is_plain = type_.is_plain or not type_.is_number
        return {
            "width": type_.width,
            "encoding": type_.encoding.value,
            "text": [type_.joined.codec, type_.joined.padding] if isinstance(type_.joined, JoinedText) else None,
            "digits": isinstance(type_.joined, JoinedDigits) or None,
            "unit": type_.unit.symbol if type_.unit else None,
            "enum": [[self.integer(m.value, type_.width), m.name] for m in type_.enum] or None,
            "flags": [[m.value, m.name] for m in type_.flags] or None,
            "linear": None if is_plain else self.by_parameter(type_.linear, self.linear),
            "names": [[self.integer(m.value, type_.width), m.name] for m in type_.names] or None,
        }

    def by_parameter(self, of: ByParameter[T], value: Callable[[T], Value]) -> Value:
        """A value, or its values by those of a parameter."""
        if of.parameter is None:
            return self.unknown if of.constant is None else value(of.constant)
        cases: Table = {name: self.unknown if case is None else value(case) for name, case in of.cases.items()}
        return {"by": of.parameter, "cases": cases}

    def field(self, field: Field, content: Content | None) -> dict[str, Value]:
        """A field, `hidden` if messages do not have it as a value.

        `fixed` is the raw integer that is always sent, which a receiver checks in a `constant`. A constant without it has
        the value of `parameter`. A message states how a checksum is computed.
        """
        written = content.written if content and content.kind != "checksum" else None
        return {
            "name": field.name,
            "type": self.types[field.type],
            "elements": [segments(element.segments, field.space) for element in field.elements],
            "indices": [element.index or 0 for element in field.elements] if field.is_array else None,
            "only": list(field.only) or None,
            "hidden": None if field.is_given else True,
            "fixed": self.integer(written, field.type.width) if isinstance(written, int) else None,
            "constant": True if content and content.kind == "constant" else None,
            "parameter": written if isinstance(written, str) else None,
        }

    def message(self, message: Message) -> dict[str, Value]:
        return {
            "command": message.command,
            "direction": message.direction.value,
            **id_rule(message.id, message.remote, message.id_mask),
            "length": message.dlc,
            "keys": [self.condition(key.key, key.values) for key in message_plan(message).keys] or None,
            "layout": self.layouts[message.layout],
        }

    def checked(self, message: Message) -> dict[str, Value]:
        """What an interpreter checks besides the fields of the layout: the `node` in the data of a message, its checksum."""
        table: dict[str, Value] = {"node": run_table(message.node_in_data)}
        for step in message_plan(message).decoding:
            match step:
                case CheckChecksum():
                    table["checksum"] = _checksum(step, message.layout.fields.index(step.field))
                case CheckConstant() | CheckParameter() | ChooseFields() | ReadField():
                    pass  # the table of the layout
                case _:
                    assert_never(step)
        return table

    def answer(self, exchange: ExchangePlan) -> dict[str, Value]:
        """A reply to a request, as `ExchangePlan` has it; `frames` if it has several, or 0 instead of others."""
        return {
            "request": self.messages[exchange.request],
            "reply": self.messages[exchange.reply],
            "frames": 0 if exchange.is_alternative else exchange.frames if exchange.frames > 1 else None,
            "nodes": list(exchange.nodes) or None,
            "asked": run_table(exchange.asked),
            "reported": run_table(exchange.reported),
            "echo": exchange.is_echo or None,
        }

    def layout(self, layout: Layout) -> Table:
        """A layout; `values` are those of the parameter that decides on its fields."""
        content = contents(self.edition.of_layout(layout)[0])
        return {
            "parameter": layout.parameter,
            "values": [value for variant in layout.variants for value in variant.values] or None,
            "fields": [self.field(field, content.get(field)) for field in layout.fields],
        }

    def condition(self, run: BitRun, values: Iterable[int]) -> Table:
        """Bits with all accepted values; the first of a key is the one that is sent."""
        return {"segments": run_table(run), "values": [self.integer(value, run.width) for value in values]}

    def _routes(self, direction: Direction) -> Iterator[Table]:
        for route in dispatch.dispatch_plan(self.edition, direction).routes:
            yield {**id_rule(route.rule, route.remote, route.mask), "plan": self._plan(route.then)}

    def _plan(self, node: dispatch.DispatchNode) -> Value:
        """The position of a message, the reason for a rejection, or a decision."""
        if isinstance(node, dispatch.Reject):
            return node.reason.value
        if isinstance(node, dispatch.Match):
            return self.messages[node.message]
        width = node.subject.width if isinstance(node.subject, BitRun) else 32
        cases = [[[self.integer(v, width) for v in case.values], self._plan(case.then)] for case in node.cases]
        return {"on": _subject(node.subject), "cases": cases, "otherwise": self._plan(node.otherwise)}


def _subject(subject: dispatch.Discriminator) -> Value:
    if isinstance(subject, dispatch.Length):
        return "length"
    if isinstance(subject, dispatch.MaskedId):
        return {"mask": subject.mask}
    return run_table(subject)


def checksum_table(plan: ChecksumPlan) -> dict[str, Value]:
    """How a checksum is computed, as the plan has it."""
    return {
        "arithmetic": plan.arithmetic.value,
        "width": plan.width,
        "poly": plan.poly or None,
        "init": plan.init or None,
        "reflected": plan.is_reflected or None,
        "shift": plan.shift or None,
        "xor": plan.xor_out or None,
    }


def _checksum(step: CheckChecksum, field: int) -> Table:
    """The checksum as `ChecksumPlan` has it, with the position of its field; each input is bits of the frame or a constant."""
    plan = step.checksum
    return {
        "field": field,
        **checksum_table(plan),
        "inputs": [part if isinstance(part, int) else segments(part.segments, part.space) for part in plan.inputs],
    }


def run_table(bits: BitRun | None) -> Value:
    """Bits that are read as one integer."""
    return None if bits is None else segments(bits.segments, bits.space)


def segments(of: Iterable[Segment], space: Space) -> list[Value]:
    """Segments as lists: byte, lowest bit, width, lowest bit of the raw integer."""
    return [[ID if space is Space.ID else s.byte, s.low, s.width, s.raw_low] for s in of]


def id_rule(rule: IdRule, remote: bool, mask: int) -> dict[str, Value]:
    """The ids of messages as a table; `mask` are the bits that keys and fields fill."""
    return {
        "base": rule.base,
        "step": rule.node_step if rule.node_step != 1 else None,
        "parameter": rule.parameter,
        "times": rule.parameter_step if rule.parameter_step != 1 else None,
        "nodes": [rule.nodes[0], rule.nodes[-1]] if rule.nodes is not None else None,
        "extended": rule.extended or None,
        "remote": remote or None,
        "mask": mask or None,
    }
