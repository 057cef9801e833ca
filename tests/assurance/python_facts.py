"""Checks of a generated Python package besides frames: descriptions, names, ids, equality, text forms, several nodes."""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable, Iterator
from enum import IntEnum, IntFlag
from fractions import Fraction
from types import ModuleType
from typing import Any

from canwright.model.edition import Edition
from canwright.model.layout import Space
from canwright.model.message import Direction, Message
from canwright.model.refusal import Refusal
from canwright.targets.base import Specification
from canwright.targets.python.text import attribute, class_name

from ..conformance.adapters.python import PythonAdapter


def check_package(item: Specification, module: ModuleType) -> None:
    """Raises AssertionError for whatever is not as the model has it."""
    edition = item.edition
    assert (module.FAMILY, module.EDITION, module.SPEC_HASH) == (edition.family, edition.name, edition.hash)
    _check_enums(edition, module)
    _check_parameters(edition, module)
    for message in edition.all_messages():
        _check_class(edition, message, getattr(module, class_name(message.name)))
        _check_ids(message, module)
    messages = list(_messages(item, module))
    for one in messages:
        _check_value(one)
    _check_all_differ(messages)
    _check_nodes(edition, module, sys.modules[f"{edition.family}.nodes"])


def _check_enums(edition: Edition, module: ModuleType) -> None:
    for type_ in edition.types:
        members = {m.name.upper(): m.value for m in type_.enum} or {m.name.upper(): 1 << m.value for m in type_.flags}
        if members:
            enum = getattr(module, class_name(type_.name))
            assert issubclass(enum, IntEnum if type_.enum else IntFlag)
            assert {name: int(one) for name, one in enum.__members__.items()} == members, enum


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
    assert (cls.COMMAND, cls.DIRECTION, cls.DLC) == (message.command, message.direction.value, message.dlc), cls
    assert (cls.EXTENDED, cls.REMOTE) == (message.id.extended, message.remote), cls
    in_id = sum(key.value << key.segments[0].low for key in message.keys if key.space is Space.ID and key.width)
    assert not in_id or cls.ID & message.id.base == message.id.base
    if not message.id_mask:
        assert cls.ID == message.id.base
    if message.id.nodes is None:
        assert not hasattr(cls, "NODES")
    else:
        assert cls.NODES == (message.id.nodes[0], message.id.nodes[-1]) and cls.NODE_STEP == message.id.node_step
    if command.code is not None and message.keys and message.direction is Direction.REQUEST and not message.id_mask:
        assert getattr(cls, "CODE", command.code) == command.code, cls
    if message.direction is Direction.REQUEST or command.request is None:
        assert cls.TITLE == command.title[language], cls
        assert cls.EFFECTS == tuple(effect.name for effect in command.effects), cls
        assert cls.LIMITED_BY == tuple(setting.name for setting in command.limited_by), cls
        only = {name: tuple(_plain(value) for value in values) for name, values in cls.ONLY.items()}
        assert only == {attribute(name): values for name, values in command.only.items()}, cls
        assert cls.MANUAL == command.manual, cls


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
            (one ^ can_id) & ~mask == 0 and (extended, remote) == (message.id.extended, message.remote)
            for one, mask, extended, remote in ids
        ), (ids, can_id)
    assert module.ids_of(direction, message.id.nodes[-1] + 1 << 20) == ()


def _messages(item: Specification, module: ModuleType) -> Iterator[Any]:
    """The messages of the golden frames."""
    assert item.frames is not None
    adapter = PythonAdapter(item.edition, module)
    for frame in item.frames.frames:
        known = adapter.parameters(frame.parameters)
        decode = module.decode_request if frame.direction is Direction.REQUEST else module.decode_reply
        yield decode(frame.id, frame.data, known, extended=frame.extended, remote=frame.remote)


def _check_value(message: Any) -> None:
    """A message equals its copy, reads as it is, and knows its fields."""
    other = copy.copy(message)
    assert message == other and not message != other and hash(message) == hash(other)  # noqa: SIM202
    assert message != 1 and message.__eq__(1) is NotImplemented
    assert message.raw() == {name: getattr(message, f"{name}_raw") for name in message.fields()}
    text = repr(message)
    assert text.startswith(f"{type(message).__name__}(") and text.endswith(")")
    for name in message.fields():
        assert f"{name}=" in text or f"{name}_raw=" in text, text
        try:
            assert f"{name}={getattr(message, name)!r}" in text, text
        except ValueError:
            assert f"{name}_raw={getattr(message, f'{name}_raw')!r}" in text, text
    assert (f"node={message.node}" in text) is (message.node is not None), text
    for name in set(type(message).TYPES) - set(message.fields()):
        assert isinstance(_raises(AttributeError, getattr, message, name), AttributeError)
    _raises(AttributeError, getattr, message, "no_such_field")


def _check_all_differ(messages: list[Any]) -> None:
    """Messages are equal exactly if their class, node and raw integers are."""
    for one, other in zip(messages, messages[1:], strict=False):
        same = (type(one), one.node, one.raw()) == (type(other), other.node, other.raw())
        assert (one == other) is same and (one != other) is not same
        if same:
            assert hash(one) == hash(other)


def _check_nodes(edition: Edition, module: ModuleType, nodes: ModuleType) -> None:
    """Frames are decoded as those of the node that they belong to; two nodes with one id are refused."""
    Node, Nodes = nodes.Node, nodes.Nodes
    replies = [m for m in edition.messages(Direction.REPLY) if m.id.nodes is not None and len(m.id.nodes) > 1]
    if not replies:
        return
    numbers = replies[0].id.nodes
    assert numbers is not None
    first, last = Node(module, numbers[0]), Node(module, numbers[-1])
    assert repr(first) == f"Node({edition.name}, {numbers[0]})" and first.parameters == module.UNKNOWN
    bus = Nodes([first, last])
    assert list(bus) == [first, last]
    _raises(ValueError, Nodes, [first, Node(module, numbers[0])])
    _raises(TypeError, Node, module, numbers[0], object())
    for message in edition.all_messages():
        if message.id.nodes is None:
            continue
        name, flags = message.direction.value, {"extended": message.id.extended, "remote": message.remote}
        for node, expected in ((numbers[0], True), (numbers[-1], True), (numbers[1], len(numbers) < 3)):
            can_id = message.id.base + node * message.id.node_step
            if node not in message.id.nodes:
                continue
            assert first.has(name, can_id, *flags.values()) is (node == numbers[0])
            decode = getattr(bus, f"decode_{name}")
            data = bytes(0 if message.remote else message.dlc)
            alone = getattr(module, f"decode_{name}")
            wanted = _outcome(alone, can_id, data, **flags) if expected else Refusal.UNKNOWN_ID.value
            assert _outcome(decode, can_id, data, **flags) == wanted, (message.name, node)
        made = [m for m in edition.all_messages() if m.id.nodes == numbers and not m.layout.fields]
        for one in made:
            assert first.make(getattr(module, class_name(one.name))).node == numbers[0]


def _outcome(decode: Callable[..., Any], can_id: int, data: bytes, **flags: bool) -> Any:
    """The message, or the reason for a rejection."""
    try:
        return decode(can_id, data, **flags)
    except ValueError as error:
        return error.refusal.value  # type: ignore[attr-defined]


def _raises(error: type[BaseException], call: Callable[..., Any], *arguments: Any, **named: Any) -> BaseException:
    try:
        call(*arguments, **named)
    except error as found:
        return found
    raise AssertionError(f"{call} accepts {arguments} {named}")
