"""The reference decoder: message, node, raw integers and values of a frame, or the reason for its rejection.

It decodes one frame at a time, with exact numbers, for generating and checking. Every target decides in the same order
and rejects for the same reasons. Programs use the generated bindings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field, Variant
from ..model.message import BitRun, Direction, Message
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS, Assignment, Encoding, Linear, Type, number_of, product_of
from .dispatch import Discriminator, DispatchNode, Length, MaskedId, Match, Route, Select, dispatch_plan
from .floats import float_of
from .frame import CanFrame, Raw, checksum_of, code_of, difference, differs, node_in_id, raw_of, read_bits
from .plan import Check, CheckConstant, CheckParameter, ChooseFields, ReadField, message_plan

Value = Fraction | str | list[str] | None


class Rejection(NamedTuple):
    """The reason for a rejection, as a sentence too, and the field that caused it; None without one."""

    reason: Refusal
    text: str
    field: str | None = None


class Identified(NamedTuple):
    """The message that a frame is, and the node that receives or sends it."""

    message: Message
    node: int | None


class Decoded(NamedTuple):
    """A message with its fields under some parameters; without constants; an array is a list.

    `code` is the one of several accepted codes that the frame has; None if there is one only.
    """

    message: Message
    node: int | None
    variant: Variant
    raws: Mapping[str, Raw]
    values: Mapping[str, Value | list[Value]]
    code: int | None = None


class Decoder:
    """Decodes the frames of one edition by its dispatch plans; the route of each id is cached."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition
        self._routes = {direction: dispatch_plan(edition, direction).routes for direction in Direction}
        rules = (route.rule for routes in self._routes.values() for route in routes)
        self._parameters = sorted({rule.parameter for rule in rules if rule.parameter is not None})
        """The parameters in ids."""
        self._of_id: dict[tuple[object, ...], tuple[Route, int | None] | None] = {}

    def identify(
        self, direction: Direction, frame: CanFrame, assignment: Assignment = NO_PARAMETERS
    ) -> Identified | Rejection:
        """The message that a frame is, without knowledge of its request."""
        routed = self._route(direction, frame, assignment)
        if routed is None:
            kind = ("29-bit " if frame.extended else "") + ("remote " if frame.remote else "")
            missing = next((r.rule for r in self._of_kind(direction, frame) if r.rule.at(assignment) is None), None)
            if missing is not None:
                text = f"0x{frame.id:X} may be an id with the parameter `{missing.parameter}`, which is missing"
                return Rejection(Refusal.MISSING_PARAMETER, text)
            return Rejection(Refusal.UNKNOWN_ID, f"no {direction.value} has the {kind}id 0x{frame.id:X}")
        route, node = routed
        message = _message(route.then, direction, frame)
        return message if isinstance(message, Rejection) else Identified(message, node)

    def decode(self, direction: Direction, frame: CanFrame, assignment: Assignment) -> Decoded | Rejection:
        """The message that a frame is under some parameters, with its fields."""
        identified = self.identify(direction, frame, assignment)
        return identified if isinstance(identified, Rejection) else _fields(identified, frame, assignment)

    def decode_as(self, message: Message, frame: CanFrame, assignment: Assignment) -> Decoded | Rejection:
        """The fields of a frame that is expected to be one message, as the reply to a request is."""
        wrong = difference(message, frame, assignment)
        if wrong:
            return Rejection(_REASONS.get(wrong.part, Refusal.UNKNOWN_ID), wrong.text)
        return _fields(Identified(message, node_in_id(message, frame, assignment)), frame, assignment)

    def decisions(self, direction: Direction, frame: CanFrame) -> DispatchNode | None:
        """The decisions between the messages that have the id of a frame; None without such a message."""
        routed = self._route(direction, frame, NO_PARAMETERS)
        return None if routed is None else routed[0].then

    def _of_kind(self, direction: Direction, frame: CanFrame) -> Iterator[Route]:
        """The routes for frames of this kind."""
        kind = (frame.extended, frame.remote)
        return (route for route in self._routes[direction] if (route.rule.extended, route.remote) == kind)

    def _route(self, direction: Direction, frame: CanFrame, assignment: Assignment) -> tuple[Route, int | None] | None:
        known = (direction, frame.id, frame.extended, frame.remote, *map(assignment.get, self._parameters))
        if known not in self._of_id:
            having = (route for route in self._of_kind(direction, frame) if route.contains(frame.id, assignment))
            self._of_id[known] = next(((route, route.node(frame.id, assignment)) for route in having), None)
        return self._of_id[known]


_REASONS = {
    "length": Refusal.WRONG_LENGTH,
    "keys": Refusal.UNKNOWN_CODE,
    "parameter": Refusal.MISSING_PARAMETER,
}
"""The reason for a rejection, by the part of the frame that differs; unknown_id for all other parts."""


def _fields(identified: Identified, frame: CanFrame, assignment: Assignment) -> Decoded | Rejection:
    """The fields of a message, by the steps of its plan."""
    layout = identified.message.layout
    raws: dict[str, Raw] = {}
    values: dict[str, Value | list[Value]] = {}
    for step in message_plan(identified.message).decoding:
        if isinstance(step, ChooseFields):
            if layout.variant(assignment) is None:
                return missing_parameter(identified.message, step)
        elif not layout.has(step.field, assignment):
            continue
        elif isinstance(step, ReadField):
            raw = raw_of(step.field, frame)
            raws[step.field.name], values[step.field.name] = raw, field_value(step.field, raw, assignment)
        else:
            rejection = _rejection(step, frame, assignment)
            if rejection is not None:
                return rejection
    variant = layout.variant(assignment)
    assert variant is not None
    return Decoded(*identified, variant, raws, values, code_of(identified.message, frame))


def rejects_checked(message: Message, frame: CanFrame, assignment: Assignment) -> Rejection | None:
    """The rejection of a frame of a message because of a constant or the checksum; None for a frame that has them.

    A constant that exists only under an unknown parameter, or that is an unknown parameter, is not checked.
    """
    return next((rejection for _, rejection in failed_checks(message, frame, assignment)), None)


def failed_checks(message: Message, frame: CanFrame, assignment: Assignment) -> Iterator[tuple[Check, Rejection]]:
    """The checks of `rejects_checked` that a frame fails, each with the rejection."""
    for check in message_plan(message).checks:
        if not message.layout.has(check.field, assignment):
            continue
        if isinstance(check, CheckParameter) and check.parameter not in assignment:
            continue
        rejection = _rejection(check, frame, assignment)
        if rejection is not None:
            yield check, rejection


def missing_parameter(message: Message, step: ChooseFields) -> Rejection:
    """The rejection of a message whose fields are unknown."""
    text = f"the fields of {message.name} depend on `{step.parameter}`, which is missing"
    return Rejection(Refusal.MISSING_PARAMETER, text)


def _wrong_parameter(check: CheckParameter, frame: CanFrame, assignment: Assignment) -> Rejection | None:
    """The rejection of a constant that is a parameter; None if it has the right value."""
    name, raw = check.field.name, number_of(assignment, check.parameter)
    if raw is None:
        text = f"the constant `{name}` depends on `{check.parameter}`, which is missing"
        return Rejection(Refusal.MISSING_PARAMETER, text, name)
    if raw.denominator == 1 and not differs(check.field, int(raw), frame):
        return None
    return Rejection(Refusal.WRONG_CONSTANT, f"the constant `{name}` is not {formatting.exact(raw)}", name)


def _rejection(check: Check, frame: CanFrame, assignment: Assignment) -> Rejection | None:
    """The rejection by a check; None for a frame that passes."""
    if isinstance(check, CheckParameter):
        return _wrong_parameter(check, frame, assignment)
    name = check.field.name
    if isinstance(check, CheckConstant):
        if not differs(check.field, check.raw, frame):
            return None
        return Rejection(Refusal.WRONG_CONSTANT, f"the constant `{name}` is not {check.raw}", name)
    computed = checksum_of(check.checksum, frame)
    if not differs(check.field, computed, frame):
        return None
    text = f"the checksum `{name}` is 0x{raw_of(check.field, frame):X}, but that of these bytes is 0x{computed:X}"
    return Rejection(Refusal.WRONG_CHECKSUM, text, name)


def field_value(field: Field, raw: Raw, assignment: Assignment) -> Value | list[Value]:
    """The value of the raw integer of a field, or the values of an array."""
    if isinstance(raw, list) and field.type.joined is not None:
        return field.type.joined.value(raw)
    if isinstance(raw, list):
        return [value_of(field.type, element, assignment) for element in raw]
    return value_of(field.type, raw, assignment)


def value_of(type_: Type, raw: int, assignment: Assignment) -> Value:
    """The value of a raw integer: a number in the unit or the name for no value, the name of a member, the names of flags.

    None if there is no scale or no name.
    """
    if type_.enum:
        return next((member.name for member in type_.enum if member.value == raw), None)
    if type_.flags:
        return [flag.name for flag in type_.flags if raw >> flag.value & 1]
    no_value = type_.no_value(raw)
    if no_value is not None:
        return no_value.name
    linear = linear_of(type_, assignment)
    if linear is None:
        return None
    if type_.encoding is Encoding.FLOAT:
        number = float_of(type_.width, raw)
        return Fraction(number) * linear.scale + linear.offset if math.isfinite(number) else None
    scaled = raw * linear.scale
    return scaled + linear.offset if linear.offset else scaled


def is_finite(type_: Type, raw: int) -> bool:
    """False if a raw integer is the bit pattern of infinity or NaN, or no bit pattern of this width."""
    low, high = type_.raw_limits
    return low <= raw <= high and math.isfinite(float_of(type_.width, raw))


def linear_of(type_: Type, assignment: Assignment) -> Linear | None:
    """Scale and offset under parameters; None if they are unknown or their number parameter is not above 0."""
    linear = type_.linear.at(assignment)
    if linear is None or linear.times is None:
        return linear
    number = product_of(assignment, linear.times)
    return None if number is None else Linear(linear.scale * number, linear.offset * number)


def _message(node: DispatchNode, direction: Direction, frame: CanFrame) -> Message | Rejection:
    """The message of a frame: follows the tree of a route."""
    path: list[tuple[Select, int]] = []
    while isinstance(node, Select):
        value = subject_value(node.subject, frame)
        path.append((node, value))
        node = node.by_value.get(value, node.otherwise)
    return (
        node.message if isinstance(node, Match) else Rejection(node.reason, _text(node.reason, path, direction, frame))
    )


def subject_value(subject: Discriminator, frame: CanFrame) -> int:
    """The value that a decision is on."""
    if isinstance(subject, Length):
        return len(frame.data)
    if isinstance(subject, MaskedId):
        return frame.id & subject.mask
    return read_bits(subject, frame)


def _text(reason: Refusal, path: Sequence[tuple[Select, int]], direction: Direction, frame: CanFrame) -> str:
    """The sentence of a rejection; the last decisions of `path` explain it."""
    if reason is Refusal.WRONG_LENGTH:
        select = next(select for select, _ in reversed(path) if isinstance(select.subject, Length))
        wanted = " or ".join(map(str, select.by_value))
        return f"0x{frame.id:X} has {formatting.counted(len(frame.data), 'data byte')}, not {wanted}"
    if reason is Refusal.UNKNOWN_ID:
        return f"0x{frame.id:X} has the bits 0x{path[-1][1]:X}, which are 0 in the ids of this message"
    codes = " and ".join(
        f"{formatting.place(select.subject.space, select.subject.segments)} 0x{value:02X}"
        for select, value in path
        if isinstance(select.subject, BitRun)
    )
    return f"no {direction.value} on 0x{frame.id:X} has {codes}"
