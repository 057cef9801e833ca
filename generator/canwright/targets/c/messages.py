"""Addresses and messages: ids, acceptance filters, and the patterns of frames that identify a message.

A filter is the id and the mask with which a controller or a socket receives the frames of an address. A frame passes if
`(frame.id & mask) == (filter.id & mask)`, as in SocketCAN; both include the flags for 29-bit ids and remote frames. The mask
has every bit that is the same in all ids, so no single filter accepts fewer frames.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from operator import or_
from typing import NamedTuple

from ...model.edition import Edition
from ...model.exhaustive import assert_never
from ...model.formatting import english
from ...model.layout import Layout, Space
from ...model.message import Address, Direction, IdRule, Message
from ...semantics.bits import placed
from ...semantics.plan import (
    CheckChecksum,
    CheckConstant,
    CheckParameter,
    ChooseFields,
    DecodingStep,
    ReadField,
    message_plan,
)
from . import bits
from .choices import ENUM_MAX, Whole, lacks
from .expressions import call, joined, operand, working
from .layouts import CodeChoice, LayoutView
from .names import Names, address_mask, member, patterns
from .text import MacroView, heading, with_deprecation

EXTENDED, REMOTE = 1 << 31, 1 << 30
STANDARD_BITS, EXTENDED_BITS = (1 << 11) - 1, (1 << 29) - 1
MANY_NODES = 1 << 16
"""Of so many ids, all bits between the lowest and the highest that differ are different somewhere."""


class Filter:
    """The frames of an address, for which there is at least one message."""

    def __init__(self, edition: Edition, address: Address, direction: Direction) -> None:
        rule = address.rule(direction)
        kind, width = (EXTENDED, EXTENDED_BITS) if rule.extended else (0, STANDARD_BITS)
        messages = [m for m in edition.of_rule(direction, rule) if m.address == address.name]
        patterns = [pattern for message in messages for pattern in _patterns(message)]
        values = [value for value, _ in patterns]
        self.mask = (EXTENDED | REMOTE | width) & ~(_differing(values) | reduce(or_, (free for _, free in patterns)))
        self.id = values[0] & self.mask
        """Id and mask of one node, without the part of the id that depends on the node."""
        nodes = rule.nodes or range(1)
        first, last = (rule.base + node * rule.node_step for node in (nodes[0], nodes[-1]))
        if len(nodes) < MANY_NODES:
            of_nodes = _differing(range(first, last + 1, rule.node_step))
        else:
            of_nodes = ((1 << (first ^ last).bit_length()) - 1) & -(rule.node_step & -rule.node_step)
        self.all_mask = self.mask & ~of_nodes
        self.all_id = (values[0] | first | kind) & self.all_mask
        """Those for all nodes."""
        self.is_exact = 1 << of_nodes.bit_count() == len(nodes)
        """False if the filter for all nodes also accepts ids that the address does not have."""


def _patterns(message: Message) -> Iterator[tuple[int, int]]:
    """The bits of the id that keys and constant fields set, for each accepted code, and the bits that fields may set."""
    plan = message_plan(message)
    fixed, free = REMOTE * message.remote, 0
    for field in (f for f in message.layout.fields if f.space is Space.ID):
        for element in field.elements:
            if field in plan.required:
                fixed |= placed(element.segments, plan.required[field])
            else:
                free |= placed(element.segments, -1)
    keys = [[placed(k.key.segments, v) * (k.key.space is Space.ID) for v in k.values] for k in plan.keys] or [[0]]
    fixed |= reduce(or_, (bits[0] for bits in keys[1:]), 0)
    yield from ((fixed | bits, free) for bits in keys[0])


def _differing(ids: Sequence[int]) -> int:
    """The bits that are not the same in all ids."""
    return reduce(or_, (id_ ^ ids[0] for id_ in ids), 0)


class RuleView:
    """The ids of one direction of an address. A fixed id has a macro, the others two functions."""

    def __init__(self, names: Names, edition: Edition, address: Address, direction: Direction) -> None:
        rule = address.rule(direction)
        accepted = Filter(edition, address, direction)
        base = names.lower(address.name, direction.value)
        mask = address_mask(edition, address.name, direction)
        self.direction = direction.value
        self.id_macro = names.upper(address.name, direction.value, "id")
        self.id_function, self.node_function = f"{base}_id", f"{base}_node"
        self.check_function, self.filter_function = f"{base}_match_id", f"{base}_filter"
        self.base = f"0x{rule.base | (EXTENDED if rule.extended else 0):X}u"
        self.has_nodes = rule.nodes is not None
        self.whole = Whole(edition, rule.parameter) if rule.parameter else None
        """The parameter in the id; None without one."""
        self.start = self.base
        if self.whole:
            step = rule.parameter_step
            self.start += f" + {self.whole.value if step == 1 else f'({self.whole.value} * {step}u)'}"
        """The id without the node."""
        self.kind = f"0x{EXTENDED if rule.extended else 0:08X}u"
        self.can_fail = self.has_nodes or self.whole is not None
        """Whether there may be no id."""
        self.mask = f"0x{0xFFFFFFFF & ~mask:08X}u" if mask else ""
        """The bits of the id that belong to the address; empty if all do."""
        self.node_unknown = _node_unknown(rule)
        self.has_step = rule.node_step != 1
        """True if the ids of consecutive nodes are not consecutive."""
        self.node_offset, self.offset_node, self.offset_rest = _step(rule.node_step)
        """The part of the id that depends on `node`, the node from the `offset` of an id, and the rest, which must be 0."""
        frames, side = ("replies", "from") if direction is Direction.REPLY else ("requests", "to")
        self.filter_doc = f"The filter for the {frames}{f' {side} one node' * self.has_nodes}."
        self.filter_bits = f"0x{accepted.id:X}u" if accepted.id else ""
        """Bits of the id of the filter for one node besides those of its `id_function`; empty without any."""
        self.filter_mask = f"0x{accepted.mask:08X}u"
        which = f"the {frames}{f' {side} all nodes' * self.has_nodes}"
        superset = "" if accepted.is_exact else ", which also accepts ids of no node"
        ends = (
            ("filter_id", accepted.all_id, f"Id of the filter for {which}{superset}."),
            ("filter_mask", accepted.all_mask, f"Mask of the filter for {which}."),
        )
        self.filters = [
            MacroView(names.upper(address.name, direction.value, ending), f"0x{value:08X}u", doc)
            for ending, value, doc in (() if self.whole else ends)
        ]
        """The filter for all nodes; none if a parameter decides on the ids."""

    def call(self, function: str, *arguments: str) -> str:
        """The call of a function of the address, with the parameters if the id contains one."""
        return call(function, *arguments, *["parameters"] * (self.whole is not None))

    def has_id(self, node: str, id_: str) -> str:
        """The condition for an id of this address; it writes the node into `node`."""
        if self.has_nodes:
            return f"{self.call(self.node_function, node, id_)} == CANWRIGHT_OK"
        if self.whole:
            return f"{self.call(self.check_function, id_)} == CANWRIGHT_OK"
        return f"{self.masked(id_)} == {self.id_macro}"

    def masked(self, id_: str) -> str:
        """The bits of an id that belong to the address."""
        return f"({id_} & {self.mask})" if self.mask else id_


class CodeView(NamedTuple):
    """A function parameter for the value of a key, with the expressions that read and write it."""

    kind: str
    name: str
    read: str
    writes: Sequence[bits.Write]


class PatternView:
    """A pattern of frames: `match` compares a frame with it, `stamp` writes it into a frame."""

    def __init__(self, names: Names, edition: Edition, rule: RuleView, message: Message, name: tuple[str, ...]) -> None:
        mask = address_mask(edition, message.address, message.direction) & ~message.id_mask
        arguments = [("code" if i == 1 else f"code_{i}", key) for i, key in enumerate(message.keys, 1)]
        self.name, self.rule, self.remote = names.lower(*name), rule, message.remote
        self.frame_id = frame_id(message)
        self.unused_bits_set = f"(frame->id & 0x{mask:X}u) != 0u" if mask else ""
        """The condition for bits of the id that only other messages of the address use; empty without any."""
        self.codes = [
            CodeView(
                working(key.width).name,
                code,
                operand(bits.key_value(key)),
                list(bits.write(key.space, key.segments, key.width, code)),
            )
            for code, key in arguments
        ]
        self.code_arguments = [f"{code.kind} {code.name}" for code in self.codes]
        self.same_codes = joined("&&", [f"{code.read} == {code.name}" for code in self.codes]) if self.codes else ""
        """The condition for a frame that has the codes."""


class AddressView:
    """An address with the directions that messages use."""

    def __init__(self, names: Names, address: Address, patterns: Sequence[PatternView]) -> None:
        nodes = address.request.nodes or address.reply.nodes
        ends = [("node_min", nodes[0], "Lowest"), ("node_max", nodes[-1], "Highest")] if nodes else []
        self.heading, self.doc = heading(address), english(address.about)
        self.rules = list(dict.fromkeys(pattern.rule for pattern in patterns))
        self.patterns = patterns
        self.nodes = [MacroView(names.upper(address.name, e), f"{n}u", f"{word} node number.") for e, n, word in ends]


class MessageView:
    """A message with its layout."""

    def __init__(
        self, names: Names, edition: Edition, message: Message, pattern: PatternView, layout: LayoutView
    ) -> None:
        command, plan = edition.command(message.command), message_plan(message)
        lacking = lacks(names, edition, command) if message.direction is Direction.REQUEST else []
        self.name, self.command, self.direction = names.lower(message.name), message.command, message.direction.value
        self.pattern, self.layout, self.dlc = pattern, layout, message.dlc
        self.enumerator = names.command(message.command)
        self.member = member(names.short(message.command))
        """Its member of the union of any message."""
        self.own_layout = not message.layout.shared and edition.of_layout(message.layout)[0] is message
        self.own_struct = message.name == message.layout.name
        self.struct = names.lower(message.name, "t") if layout.members else ""
        """Empty without fields."""
        what = f"The {self.direction}" if self.own_struct else "Request and reply"
        self.title = f"{what} of {message.command}"
        self.deprecated = with_deprecation("", command.deprecated)
        """The end of a comment on a deprecated message."""
        self.codes = list(_codes(message))
        """The values of its keys, then the same with each other accepted value of the first key."""
        self.checks = tuple(_checks(plan.decoding, layout))
        """The conditions under which a frame is rejected whatever the parameters are, each with the status."""
        self.node_in_data = bits.key_value(message.node_in_data) if message.node_in_data else ""
        """The expression of the node in a field; empty unless a field identifies the node."""
        self.confused = bits.is_confused(message.confusions)
        """The condition for a frame that is identified as another message; empty if no values lead to one."""
        self.lacking = joined("||", lacking) if lacking else ""
        """The condition for a node that does not have the command of a request; empty without parameters that decide it."""
        self.choice = CodeChoice(message, layout.code.kind) if layout.code and plan.codes else None
        """How it uses the member with the code; None if it has one code at most."""
        self.code_read = self.choice.read if self.choice else "0u" if layout.code else ""
        """The value of the member with the code of a decoded message; empty if its struct has none."""
        self.has_node = pattern.rule.has_nodes or bool(self.node_in_data)
        """True if a frame contains the node."""
        self.takes_parameters = layout.takes_parameters or bool(self.lacking) or pattern.rule.whole is not None
        """True if encoding the message needs the parameters."""
        self.decode_parameters = layout.depends or pattern.rule.whole is not None
        """True if decoding the message needs the parameters."""
        self._node = "node" if pattern.rule.has_nodes else ""

    @property
    def stamp(self) -> str:
        """The call that writes id, length and code of a frame."""
        codes = self.codes[0] if self.choice is None else (self.choice.sent, *self.codes[0][1:])
        return self.pattern.rule.call(f"{self.pattern.name}_stamp", "frame", self._node, f"{self.dlc}u", *codes)

    @property
    def matches(self) -> list[str]:
        """The calls of which one succeeds if a frame is this message."""
        match, rule = f"{self.pattern.name}_match", self.pattern.rule
        return [rule.call(match, self._node, "frame", f"{self.dlc}u", *codes) for codes in self.codes]

    def encode(self, frame: str, node: str, message: str, parameters: str) -> str:
        """The call that encodes a message, without the arguments that it does not take."""
        given = (node, self._node), (message, self.struct), (parameters, self.takes_parameters)
        return call(f"{self.name}_encode", frame, *(argument for argument, is_taken in given if is_taken))

    def decode(self, message: str, node: str, frame: str, parameters: str) -> str:
        """The call that decodes a message, without the arguments that it does not take."""
        given = (message, self.struct), (node, self.has_node), (frame, True), (parameters, self.decode_parameters)
        return call(f"{self.name}_decode", *(argument for argument, is_taken in given if is_taken))

    @property
    def is_match_only(self) -> bool:
        """True if there is nothing to read or check after the match."""
        layout = self.layout
        return not (layout.members or layout.depends or self.checks or self.node_in_data or self.codes[1:])


class Messages:
    """The messages of an edition, their patterns and their addresses."""

    def __init__(self, names: Names, edition: Edition, layouts: Mapping[Layout, LayoutView]) -> None:
        self.names, self.edition = names, edition
        self.numbers = command_numbers(edition)
        self.fd = "fd_" if edition.bus.frame_format.is_fd else ""
        """In the names of what contains frames of CAN FD."""
        sides = dict.fromkeys((message.address, message.direction) for message in edition.all_messages())
        rules = {side: RuleView(names, edition, edition.address(side[0]), side[1]) for side in sides}
        of_address: dict[str, list[PatternView]] = {}
        self._messages: dict[Message, MessageView] = {}
        for parts, messages in patterns(edition).items():
            first = messages[0]
            view = PatternView(names, edition, rules[first.address, first.direction], first, parts)
            of_address.setdefault(first.address, []).append(view)
            self._messages |= {m: MessageView(names, edition, m, view, layouts[m.layout]) for m in messages}
        used = (address for address in edition.addresses if address.name in of_address)
        self.addresses = [AddressView(names, address, of_address[address.name]) for address in used]
        """The addresses that messages use, each with the directions that they use."""

    def message(self, message: Message) -> MessageView:
        return self._messages[message]


def command_numbers(edition: Edition) -> Mapping[str, int]:
    """The number of each command: its code if no other command has it, else a free number of at least two bytes.

    With the code as number, one statement is enough for all codes whose messages are read in the same way.
    """
    times = Counter(command.code for command in edition.commands)
    codes = {c.name: c.code for c in edition.commands if c.code and times[c.code] == 1 and c.code <= ENUM_MAX}
    taken = set(codes.values())
    free = (number for number in itertools.count(0x100) if number not in taken)
    return {command.name: codes.get(command.name) or next(free) for command in edition.commands}


def _step(step: int) -> tuple[str, str, str]:
    """For ids that are `step` apart: the offset of a node, the node of an offset, and the remainder of the offset."""
    if step == 1:
        return "node", "offset", "0u"
    if step.bit_count() > 1:
        return f"(node * {step}u)", f"offset / {step}u", f"(offset % {step}u)"
    shift = step.bit_length() - 1
    return f"(node << {shift})", f"offset >> {shift}", f"(offset & 0x{step - 1:X}u)"


def frame_id(message: Message, frame: str = "frame") -> str:
    """The id of a frame without the flag of remote frames."""
    return f"({frame}->id ^ CANWRIGHT_REMOTE)" if message.remote else f"{frame}->id"


def _checks(steps: Sequence[DecodingStep], layout: LayoutView) -> Iterator[tuple[str, str]]:
    always: dict[str, list[str]] = {}
    for step in steps:
        match step:
            case CheckConstant():
                if not step.field.only:
                    always.setdefault("WRONG_CONSTANT", []).append(bits.constant_differs(step))
            case CheckChecksum():
                always["WRONG_CHECKSUM"] = [f"{layout.name}_sum(frame) != {bits.constant_read(step.field)}"]
            case ChooseFields() | CheckParameter() | ReadField():
                pass  # the function that unpacks the layout
            case _:
                assert_never(step)
    return ((joined("||", conditions), status) for status, conditions in always.items())


def _codes(message: Message) -> Iterator[tuple[str, ...]]:
    labels = [bits.labels(accepted.key, accepted.values) for accepted in message_plan(message).keys]
    for first in labels[0] if labels else ():
        yield (first, *(values[0] for values in labels[1:]))
    if not labels:
        yield ()


def _node_unknown(rule: IdRule) -> str:
    """The condition for a `node` that the address does not have; values that an unsigned number cannot have are left out."""
    if rule.nodes is None:
        return ""
    low = [f"node < {rule.nodes[0]}u"] if rule.nodes[0] else []
    return joined("||", [*low, f"node > {rule.nodes[-1]}u"])
