"""What a receiver makes of a frame, straight from the model: which message it is, and whether it answers a request.

This is what every target does, in the same order, and refuses in the same words.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Variant
from ..model.message import Direction, Key, Message
from ..model.refusal import Refusal
from ..model.types import Assignment
from .decoder import CanFrame, by_rule, data_bits, difference, held, node, node_of, open_bits, wrong_constants


class Refused(NamedTuple):
    """Why a frame or a value is refused, in words as well, and by which field where there is one."""

    says: Refusal
    text: str
    field: str | None = None


class Read(NamedTuple):
    """The message that a frame is, and the node that it is to or from."""

    message: Message
    node: int | None


class Decoded(NamedTuple):
    """A message with the fields that it has under the parameters."""

    message: Message
    node: int | None
    variant: Variant


class Receiver:
    """Reads the frames of one edition; the ids that it has seen it knows."""

    def __init__(self, edition: Edition) -> None:
        self._edition = edition
        self._routes = {
            direction: [_Route(group) for group in by_rule(edition.messages(direction))] for direction in Direction
        }
        self._of_id: dict[tuple[Direction, int, bool, bool], tuple[_Route, int | None] | None] = {}

    def read(self, direction: Direction, frame: CanFrame) -> Read | Refused:
        """The message that a frame is, judged by itself."""
        key = (direction, frame.id, frame.extended, frame.remote)
        if key not in self._of_id:
            found = ((route, route.node(frame)) for route in self._routes[direction])
            self._of_id[key] = next(((route, of[0]) for route, of in found if of), None)
        known = self._of_id[key]
        if known is None:
            kind = ("29-bit " if frame.extended else "") + ("remote " if frame.remote else "")
            return Refused(Refusal.UNKNOWN_ID, f"no {direction.value} has the {kind}id 0x{frame.id:X}")
        message = known[0].message(frame)
        return message if isinstance(message, Refused) else Read(message, known[1])

    def decode(self, direction: Direction, frame: CanFrame, assignment: Assignment) -> Decoded | Refused:
        """The message that a frame is under some parameters, with its constants."""
        read = self.read(direction, frame)
        if isinstance(read, Refused):
            return read
        layout = read.message.layout
        variant = layout.variant(assignment)
        there = variant.fields if variant else (field for field in layout.fields if not field.only)
        wrong = wrong_constants(there, frame)
        if wrong:
            return Refused(Refusal.WRONG_CONSTANT, f"`{wrong[0].name}` should hold {wrong[0].fixed}", wrong[0].name)
        if variant is None:
            text = f"the fields of {read.message.name} depend on `{layout.parameter}`, which is not given"
            return Refused(Refusal.MISSING_PARAMETER, text)
        return Decoded(*read, variant)

    def answer(self, request: CanFrame, reply: CanFrame) -> Read | Refused:
        """The reply that a frame is to a request; refused when it is none, or when the request cannot be read."""
        sent = self.read(Direction.REQUEST, request)
        if isinstance(sent, Refused):
            return sent
        command = self._edition.command(sent.message.command)
        expected = command.reply
        if expected is None:
            return _no_answer(f"{command.name} has no reply")
        wrong = difference(expected, reply)
        if wrong:
            return _no_answer(wrong.text)
        source = node_of(expected, reply)
        asked, told = sent.message.node_bits, expected.node_bits
        to, bits = sent.node, -1
        if asked and not command.from_each:
            to, bits = held(asked, request), (1 << asked.width) - 1
        nodes: Sequence[int] = command.from_each or (() if to is None else (to,))
        if not _is_from(nodes, source, bits):
            return _no_answer(f"it comes from node {source}, not {_listed(nodes)}")
        if told and not _is_from(nodes, held(told, reply), bits & (1 << told.width) - 1):
            return _no_answer(f"`{told.name}` holds node {held(told, reply)}, not {_listed(nodes)}")
        if command.is_echoed and request.data != reply.data:
            return _no_answer(f"the reply of {command.name} is an echo, and this differs")
        return Read(expected, source)


class _Route:
    """The messages of one direction that have a rule from node to id in common."""

    def __init__(self, messages: Sequence[Message]) -> None:
        self.first = messages[0]
        self.mask = open_bits(messages)
        self._lengths = sorted({m.dlc for m in messages})
        self._claims: dict[object, tuple[Key, dict[int, list[Message]]]] = {}
        for message in messages:
            for key in message.keys[:1]:
                _, claims = self._claims.setdefault((key.space, key.segments), (key, {}))
                for value in message.claims:
                    claims[value] = sorted([*claims.get(value, ()), message], key=lambda m: -len(m.keys))
        self._rest = [m for m in messages if not m.keys]
        self._bits = data_bits((k.space, k.segments) for m in messages for k in m.keys)
        self._known: dict[tuple[int, int, int], Message] = {}

    def node(self, frame: CanFrame) -> tuple[int | None] | None:
        """The node of a frame's id, in a tuple; None when the id is not of this rule, whatever its code."""
        rule = self.first.id
        if (rule.extended, self.first.remote) != (frame.extended, frame.remote):
            return None
        rest = frame.id & ~self.mask
        if rule.nodes is None:
            return (None,) if rest == rule.base else None
        found = node(rule, rest)
        return None if found is None else (found,)

    def message(self, frame: CanFrame) -> Message | Refused:
        """The message that a frame is; frames with the same keys are looked at once."""
        key = (len(frame.data), frame.id & self.mask, int.from_bytes(frame.data, "little") & self._bits)
        known = self._known.get(key)
        if known is None:
            found = self._message(frame)
            if isinstance(found, Refused):
                return found
            known = self._known[key] = found
        return known

    def _message(self, frame: CanFrame) -> Message | Refused:
        """What has most keys goes first, what has none is left for the rest."""
        if len(frame.data) not in self._lengths and not frame.remote:
            return _wrong_length(frame, self._lengths)
        fitting = [*self._keyed(frame), *self._rest]
        if not fitting:
            codes = ", ".join(self._told(key, frame) for key, _ in self._claims.values())
            text = f"no {self.first.direction.value} on 0x{frame.id:X} has {codes}"
            return Refused(Refusal.UNKNOWN_CODE, text)
        found = fitting[0]
        if len(frame.data) != found.dlc:
            alike = (m for m in fitting if m.keys == found.keys and m.claims == found.claims)
            found = next((m for m in alike if m.dlc == len(frame.data)), found)
        if frame.id & self.mask & ~found.id_mask:
            return Refused(Refusal.UNKNOWN_ID, f"0x{frame.id:X} has bits that are 0 in every {found.name}")
        if len(frame.data) != found.dlc and not frame.remote:
            return _wrong_length(frame, [found.dlc])
        return found

    def _told(self, key: Key, frame: CanFrame) -> str:
        """The selector of a frame in words; where its value is known, with the further ones that are not."""
        known = self._claims[key.space, key.segments][1].get(held(key, frame), ())
        keys = [key, *(known[0].keys[1:] if known else ())]
        return " and ".join(f"{formatting.place(k.space, k.segments)} 0x{held(k, frame):02X}" for k in keys)

    def _keyed(self, frame: CanFrame) -> list[Message]:
        return [
            message
            for key, claims in self._claims.values()
            for message in claims.get(held(key, frame), ())
            if all(held(further, frame) == further.value for further in message.keys[1:])
        ]


def _wrong_length(frame: CanFrame, lengths: Iterable[int]) -> Refused:
    wanted = " or ".join(map(str, lengths))
    text = f"0x{frame.id:X} has {formatting.counted(len(frame.data), 'byte')} here, not {wanted}"
    return Refused(Refusal.WRONG_LENGTH, text)


def _no_answer(text: str) -> Refused:
    return Refused(Refusal.NOT_ANSWER, text)


def _is_from(nodes: Sequence[int], source: int | None, bits: int) -> bool:
    """Whether a node is one of some, as far as `bits` of it are told; yes, where there is nothing to compare."""
    return source is None or not nodes or any(not (source ^ one) & bits for one in nodes)


def _listed(nodes: Sequence[int]) -> str:
    return " or ".join(map(str, nodes)) if len(nodes) < 3 else f"{min(nodes)}..{max(nodes)}"
