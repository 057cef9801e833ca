"""Checks of a generated Python package besides frames: descriptions, names, ids, equality, text forms, several nodes."""

from __future__ import annotations

import copy
import functools
import itertools
import pickle
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum, IntFlag
from fractions import Fraction
from types import ModuleType
from typing import Any

from canwright.conformance.python import PythonAdapter, node_in_id
from canwright.model.edition import Edition
from canwright.model.layout import NodeRole, Space
from canwright.model.message import Direction, Message
from canwright.model.metadata import Repeat
from canwright.model.refusal import Refusal
from canwright.targets.base import EditionInput
from canwright.targets.python.text import attribute, class_name

EXACT = 1 << 51
"""Values of raw integers from here on are rounded to doubles, some to those of other raw integers."""


def check_package(item: EditionInput, module: ModuleType) -> None:
    """Raises AssertionError for whatever is not as the model has it."""
    edition = item.edition
    assert (edition.family, edition.name, edition.hash) == (module.FAMILY, module.EDITION, module.SPEC_HASH)
    assert edition.bus.reply_within_ms == module.REPLY_WITHIN_MS
    _check_enums(edition, module)
    _check_parameters(edition, module)
    for message in edition.all_messages():
        _check_class(edition, message, getattr(module, class_name(message.name)))
        _check_ids(message, module)
    messages = list(_messages(item, module))
    for decoded in messages:
        _check_value(decoded)
    _check_all_differ(messages)
    _check_answers(item, module)
    _check_nodes(edition, module, sys.modules[f"{edition.family}.nodes"])


def _check_enums(edition: Edition, module: ModuleType) -> None:
    for type_ in edition.types:
        members = {m.name.upper(): m.value for m in type_.enum} or {m.name.upper(): 1 << m.value for m in type_.flags}
        if members:
            enum = getattr(module, class_name(type_.name))
            assert issubclass(enum, IntEnum if type_.enum else IntFlag)
            assert {name: int(member) for name, member in enum.__members__.items()} == members, enum


def _check_parameters(edition: Edition, module: ModuleType) -> None:
    """Each value of a choice and each limit of a number is accepted, and what is beside them is not."""
    for parameter in edition.parameters:
        name = attribute(parameter.name)
        good: list[Any] = []
        bad: list[Any] = []
        if parameter.is_choice and parameter.is_numeric:
            good = [value.number for value in parameter.values]
            bad = [number + step for number in good for step in (-1, 1) if number + step not in good]
        elif parameter.is_choice:
            good = [getattr(module, class_name(parameter.name))(value.name) for value in parameter.values]
            bad = ["nothing of this name"]
        else:
            low, high = parameter.minimum, parameter.maximum
            good = [end for end in (low, high, Fraction(7, 2)) if end is not None and _within(end, low, high)]
            bad = [end + step for end, step in ((low, -1), (high, 1)) if end is not None]
            bad += [float("nan"), float("inf")]
        for value in good:
            assert getattr(module.Parameters(**{name: value}), name) == value
        for value in bad:
            _raises(ValueError, module.Parameters, **{name: value})
    if edition.parameters:
        assert module.Parameters() == module.UNKNOWN


def _within(number: Fraction, low: Fraction | None, high: Fraction | None) -> bool:
    return (low is None or number >= low) and (high is None or number <= high)


def _check_class(edition: Edition, message: Message, cls: Any) -> None:
    command = edition.command(message.command)
    language = edition.languages[0]
    assert (message.command, message.direction.value, message.dlc) == (cls.COMMAND, cls.DIRECTION, cls.DLC), cls
    assert (message.id.extended, message.remote) == (cls.EXTENDED, cls.REMOTE), cls
    in_id = sum(key.value << key.segments[0].low for key in message.keys if key.space is Space.ID and key.width)
    assert not in_id or cls.ID & message.id.base == message.id.base
    if not message.id_mask:
        assert message.id.base == cls.ID
    if message.id.nodes is None:
        assert not hasattr(cls, "NODES")
    else:
        assert (message.id.nodes[0], message.id.nodes[-1]) == cls.NODES and message.id.node_step == cls.NODE_STEP
    assert getattr(cls, "CODE", None) == (message.keys[0].value if message.keys else None), cls
    _check_holder(message, cls)
    if message.direction is Direction.REQUEST or command.request is None:
        assert command.title[language] == cls.TITLE, cls
        assert tuple(effect.name for effect in command.effects) == cls.EFFECTS, cls
        assert tuple(setting.name for setting in command.limited_by) == cls.LIMITED_BY, cls
        only = {name: tuple(_plain(value) for value in values) for name, values in cls.ONLY.items()}
        assert only == {attribute(name): values for name, values in command.only.items()}, cls
        assert command.manual == cls.MANUAL, cls
    if message.direction is Direction.REQUEST:
        first = [reply for reply in command.replies if not reply.is_alternative]
        assert sum(reply.frames for reply in first) == cls.REPLIES, cls
        assert command.from_each == cls.REPLIERS, cls
        assert (None if command.repeat is None else command.repeat is Repeat.SAME) == cls.REPEAT, cls
        within = command.reply_within_ms
        assert (None if within is None else float(within)) == cls.REPLY_WITHIN_MS, cls
    named = {attribute(field.name): field.variable for field in message.layout.fields if field.variable}
    assert named.items() <= cls.VARIABLES.items() | {(name, name) for name in named}, cls


def _check_holder(message: Message, cls: Any) -> None:
    """The field with the node, the parameters on which the fields depend, and the fields of patterns by position."""
    holder, layout = message.node_bits, message.layout
    assert (attribute(holder.name) if holder else "") == cls.NODE_FIELD
    is_part = holder is not None and message.has_low_bits_of_node
    assert ((1 << holder.width) - 1 if holder and is_part else -1) == cls.NODE_MASK
    numbers = {name for field in layout.fields for name in field.type.numbers}
    assert set(cls.DEPENDS) == {attribute(name) for name in numbers.union(layout.parameters)}
    if layout.fields:
        always = tuple(attribute(field.name) for field in layout.fields if field.is_given and not field.only)
        assert always == cls.__match_args__


def _plain(value: Any) -> str:
    return str(getattr(value, "value", value))


def _check_ids(message: Message, module: ModuleType) -> None:
    """The node of the ids at both ends, and none beyond; the ids of these nodes."""
    if message.id.nodes is None:
        return
    flags = {"extended": message.id.extended, "remote": message.remote}
    direction = message.direction.value
    for node in (message.id.nodes[0], message.id.nodes[-1]):
        can_id = message.id.base + node * message.id.node_step
        assert module.node_of(direction, can_id, **flags) == node
        ids = module.ids_of(direction, node)
        assert any(
            (id_ ^ can_id) & ~mask == 0 and (extended, remote) == (message.id.extended, message.remote)
            for id_, mask, extended, remote in ids
        ), (ids, can_id)
    assert module.ids_of(direction, message.id.nodes[-1] + 1 << 20) == ()


def _messages(item: EditionInput, module: ModuleType) -> Iterator[Any]:
    """The messages of the golden frames, and of these with one byte changed, whose values are often invalid."""
    assert item.frames is not None
    adapter = PythonAdapter(item.edition, module)
    for frame in item.frames.frames:
        known = adapter.parameters(frame.parameters)
        decode = module.decode_request if frame.direction is Direction.REQUEST else module.decode_reply
        for byte in (None, *range(len(frame.data))):
            data = bytearray(frame.data)
            if byte is not None:
                data[byte] ^= 0xFF
            decoded = _outcome(decode, frame.id, data, known, extended=frame.extended, remote=frame.remote)
            if not isinstance(decoded, Rejected):
                yield decoded


def _check_answers(item: EditionInput, module: ModuleType) -> None:
    """A request accepts the replies that `check_reply` accepts, of those that its class accepts."""
    assert item.frames is not None
    adapter = PythonAdapter(item.edition, module)
    for command in item.edition.commands:
        sent, received = (item.frames.of_command.get((command.name, direction), []) for direction in Direction)
        for request, reply in itertools.product(sent[:3], received[:3]):
            known = adapter.parameters(request.parameters)
            flags, kind = ({"extended": frame.extended, "remote": frame.remote} for frame in (request, reply))
            asked = _outcome(module.decode_request, request.id, request.data, known, **flags)
            if isinstance(asked, Rejected) or isinstance(_outcome(asked.check), Rejected):
                continue
            kinds = {f"reply_{name}": value for name, value in kind.items()}
            pair = request.id, asked.encode(), reply.id, reply.data
            wanted = _outcome(module.check_reply, *pair, **flags, **kinds)
            if kind["extended"] == flags["extended"]:
                same_kind = {"reply_remote": reply.remote}
                assert _outcome(module.check_reply, *pair, **flags, **same_kind) == wanted
            for parameters in (known, None):
                answer = _outcome(module.decode_answer, asked, reply.id, reply.data, parameters, **kind)
                if wanted is None and parameters is not None:
                    wanted = _outcome(module.decode_answer, type(asked), reply.id, reply.data, parameters, **kind)
                if parameters is not None or isinstance(answer, Rejected):
                    assert parameters is None or answer == wanted, (asked, reply)
                    continue
                assert answer.parameters is module.UNKNOWN, (asked, reply)
                assert node_in_id(answer) == module.node_of("reply", reply.id, **kind)


def _check_value(message: Any) -> None:
    """A message equals its copies, cannot be changed, reads as it is, and knows its fields."""
    cls, names = type(message), message.fields()
    known = {"node": node_in_id(message), "parameters": message.parameters}
    if isinstance(_outcome(message.check), Rejected):
        for call in (message.encode, message.replace, functools.partial(cls.from_raw, **known, **message.raw())):
            _raises(ValueError, call)
        return
    again = cls.from_raw(**known, **message.raw())
    for copied in (copy.copy(message), pickle.loads(pickle.dumps(message)), again, message.replace()):
        assert message == copied and not message != copied and hash(message) == hash(copied)  # noqa: SIM202
        assert (copied.node, copied.parameters, copied.raw()) == (message.node, message.parameters, message.raw())
        assert copied.encode_unchecked() == again.encode() and copied.can_id == message.can_id
    if not cls.TYPES:
        assert cls(**({} if message.node is None else {"node": message.node})) == message
    assert message != 1 and message.__eq__(1) is NotImplemented
    assert message.raw() == {name: getattr(message, f"{name}_raw") for name in names}
    values = {name: _outcome(getattr, message, name) for name in names}
    _check_given_node(message, values)
    assert message.values() == {name: None if isinstance(v, Rejected) else v for name, v in values.items()}
    text = repr(message)
    parts = [f"node={message.node}"] if hasattr(cls, "NODES") else []
    for name, value in values.items():
        raw = isinstance(value, Rejected)
        parts.append(f"{name}_raw={message.raw()[name]!r}" if raw else f"{name}={value!r}")
        if not raw and _is_exact(message.raw()[name]):
            again = message.replace(**{name: value})
            assert getattr(again, name) == value
            is_float = type(getattr(cls.TYPES[name], "type", cls.TYPES[name])).__name__ == "Float"
            assert is_float or again.raw()[name] == message.raw()[name]  # an offset can hide the bits of a float
            assert is_float or again == message
        _raises(AttributeError, setattr, message, name, value)
        _raises(AttributeError, delattr, message, name)
    given = [(name, getattr(message.parameters, name)) for name in cls.DEPENDS]
    if any(value is not None for _, value in given):
        shown = (
            f"{name}={str(value) if isinstance(value, Enum) else repr(value)}"
            for name, value in given
            if value is not None
        )
        parts.append(f"parameters=Parameters({', '.join(shown)})")
    assert text == f"{cls.__name__}({', '.join(parts)})"
    for name in set(cls.TYPES) - set(names):
        for absent in (name, f"{name}_raw"):
            assert "it has" in str(_raises(AttributeError, getattr, message, absent))
        _raises((AttributeError, ValueError), message.replace, **{name: 0})
    _raises(AttributeError, getattr, message, "no_such_field")
    _raises(TypeError, message.replace, no_such_field=1)
    _raises(TypeError, cls.from_raw, **known, **message.raw(), no_such_field=1)
    _check_node(message)
    _check_without_parameters(message)


def _is_exact(raw: int | list[int] | tuple[int, ...]) -> bool:
    """Whether raw integers are small enough for values that lead back to them."""
    return all(abs(number) < EXACT for number in ([raw] if isinstance(raw, int) else raw))


def _check_without_parameters(message: Any) -> None:
    """Parameters that are not given are unknown; a message whose data is always the same has none."""
    cls, known = type(message), {"node": node_in_id(message), **message.raw()}
    unknown = sys.modules[cls.__module__].UNKNOWN
    wanted, made = _outcome(cls.from_raw, **known, parameters=unknown), _outcome(cls.from_raw, **known)
    assert made == wanted
    assert isinstance(made, Rejected) or made.parameters is (None if hasattr(cls, "DATA") else unknown)


def _check_node(message: Any) -> None:
    cls, raw, parameters = type(message), message.raw(), message.parameters
    if not hasattr(cls, "NODES"):
        assert message.node == (message.raw()[cls.NODE_FIELD] if "node" in vars(cls) else None)
        _raises(TypeError, message.replace, node=1)
        return
    first, last = cls.NODES
    for node in (first, last):
        replaced = message.replace(node=node)
        assert (replaced.node, replaced.raw(), replaced == message) == (node, raw, node == message.node)
        assert replaced.can_id - message.can_id == (node - message.node) * cls.NODE_STEP
    for node in (first - 1, last + 1, None):
        made = _outcome(cls.from_raw, node=node, parameters=parameters, **raw)
        assert made == Rejected(Refusal.UNKNOWN_NODE.value)
    _raises(TypeError, cls.from_raw, node="1", parameters=parameters, **raw)


class _Index:
    """An integer that is no int."""

    def __init__(self, number: int) -> None:
        self._number = number

    def __index__(self) -> int:
        return self._number


def _check_given_node(message: Any, values: Mapping[str, Any]) -> None:
    """A constructor takes any kind of integer as the node, as an int, and no other node than those of the message."""
    cls = type(message)
    if not hasattr(cls, "NODES") or any(isinstance(value, Rejected) for value in values.values()):
        return
    if "parameters" in cls.__init__.__annotations__:
        values = {**values, "parameters": message.parameters}
    made = _outcome(cls, node=_Index(message.node), **values)
    assert isinstance(made, Rejected) or (type(made.node), made.node) == (int, message.node)
    for node in (cls.NODES[0] - 1, cls.NODES[1] + 1):
        assert _outcome(cls, node=node, **values) == Rejected(Refusal.UNKNOWN_NODE.value)
    _raises(TypeError, cls, node=float(message.node), **values)


def _check_all_differ(messages: list[Any]) -> None:
    """Messages are equal exactly if their class, node, raw integers, and the parameters on which they depend are."""
    for first, second in itertools.pairwise(messages):
        same = (type(first), first.node, first.raw(), _needed(first)) == (
            type(second),
            second.node,
            second.raw(),
            _needed(second),
        )
        assert (first == second) is same and (first != second) is not same
        if same:
            assert hash(first) == hash(second)


def _needed(message: Any) -> list[Any]:
    return [getattr(message.parameters, name) for name in message.DEPENDS]


def _check_nodes(edition: Edition, module: ModuleType, nodes: ModuleType) -> None:
    """Frames are decoded as those of the node that they belong to; two nodes with one id are refused."""
    make, bus_of = nodes.Node, nodes.Nodes
    replies = [m for m in edition.messages(Direction.REPLY) if m.id.nodes is not None and len(m.id.nodes) > 1]
    if not replies:
        return
    numbers = replies[0].id.nodes
    assert numbers is not None
    first, last = make(module, numbers[0]), make(module, numbers[-1])
    assert repr(first) == f"Node({edition.name}, {numbers[0]})" and first.parameters == module.UNKNOWN
    bus = bus_of([first, last])
    assert list(bus) == [first, last]
    _raises(ValueError, bus_of, [first, make(module, numbers[0])])
    _raises(TypeError, make, module, numbers[0], object())
    for message in edition.all_messages():
        if message.id.nodes is None:
            continue
        name, flags = message.direction.value, {"extended": message.id.extended, "remote": message.remote}
        for node in {numbers[0], numbers[1], numbers[-1]} & set(message.id.nodes):
            can_id = message.id.base + node * message.id.node_step
            data = bytes(0 if message.remote else message.dlc)
            there = [bus_node for bus_node in (first, last) if bus_node.node == node]
            assert list(bus.nodes_of(name, can_id, **flags)) == there
            wanted = _outcome(getattr(module, f"decode_{name}"), can_id, data, **flags)
            for bus_node in there:
                assert _outcome(getattr(bus_node, f"decode_{name}"), can_id, data, **flags) == wanted
            decoded = _outcome(getattr(bus, f"decode_{name}"), can_id, data, **flags)
            assert decoded == (wanted if there else Rejected(Refusal.UNKNOWN_ID.value)), (message.name, node)
    _check_node_in_data(edition, module, bus)
    for message in edition.all_messages():
        if message.id.nodes == numbers and not message.layout.fields:
            made = getattr(module, class_name(message.name))
            assert first.make(made).node == numbers[0]
            assert "sets node itself" in str(_raises(TypeError, first.make, made, node=numbers[0]))
    _raises(TypeError, first.make, nodes.Message)


def _check_node_in_data(edition: Edition, module: ModuleType, bus: Any) -> None:
    """It is read with the data of a frame; ids whose frames contain it in the data are known."""
    for message in edition.all_messages():
        name, can_id = message.direction.value, message.id.base
        flags = {"extended": message.id.extended, "remote": message.remote}
        same_rule = edition.of_rule(message.direction, message.id)
        if message.id.nodes is None:
            in_data = any(another.node_in_data for another in same_rule if another.remote == message.remote)
            assert module.has_node_in_data(name, can_id, **flags) is in_data
            assert module.node_of(name, can_id, **flags) is None
            for node in bus if message.node_in_data else ():
                made = _outcome(node.make, getattr(module, class_name(message.name)), **_values_without_node(message))
                if not isinstance(made, Rejected):
                    frame = made.can_id, made.encode()
                    assert made.node == node.node == module.node_of(name, *frame, **flags)
                    assert bus.nodes_of(name, *frame, **flags) == (node,)


def _values_without_node(message: Message) -> dict[str, Any]:
    """Zeros for all fields but the node."""
    fields = [field for field in message.layout.fields if field.is_given and not isinstance(field.role, NodeRole)]
    return {attribute(field.name): [0] * len(field.elements) if field.is_array else 0 for field in fields}


@dataclass(frozen=True)
class Rejected:
    """The reason for a rejection."""

    reason: str


def _outcome(call: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
    """The result, or the reason for a rejection."""
    try:
        return call(*arguments, **named)
    except ValueError as error:
        return Rejected(error.refusal.value)  # type: ignore[attr-defined]


def _raises(
    error: type[BaseException] | tuple[type[BaseException], ...],
    call: Callable[..., Any],
    *arguments: Any,
    **named: Any,
) -> BaseException:
    try:
        call(*arguments, **named)
    except error as raised:
        return raised
    raise AssertionError(f"{call} accepts {arguments} {named}")
