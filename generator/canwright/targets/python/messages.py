"""Messages as the classes of a generated module, and the base classes of those that share a layout."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Space
from ...model.message import Command, Direction, Message
from ...model.types import Parameter
from ...semantics.plan import message_plan
from . import client_facts, code, docstrings, encoding, text, types
from .class_bodies import BodyView, ClassBodies, storage
from .encoding import EncodeView


def base_classes(edition: Edition) -> Mapping[str, Sequence[Message]]:
    """The messages of each base class: they share a layout with fields, the length, and what the id contains.

    Its name is that of the layout, with a number where several base classes have that layout.
    """
    alike: dict[str, dict[tuple[object, ...], list[Message]]] = {}
    for message in edition.all_messages():
        group = message.dlc, message.id.nodes is not None, message.id.parameter
        alike.setdefault(message.layout.name, {}).setdefault(group, []).append(message)
    bases: dict[str, Sequence[Message]] = {}
    for layout, groups in alike.items():
        shared = [same for same in groups.values() if same[0].layout.fields and len(same) > 1]
        for number, same in enumerate(shared, 1):
            bases[text.class_name(layout) + (str(number) if len(shared) > 1 else "")] = same
    return bases


def _has_body(message: Message) -> bool:
    """Whether the class has a constructor of its own: for fields, for a parameter in the id, or for several codes."""
    return bool(message.layout.fields or message_plan(message).codes) or message.id.parameter is not None


def _place(message: Message) -> int:
    """The place of the node among the raw integers of a message with its node in the data."""
    return next(place for field, place in storage(message.layout).items() if field.is_node)


def _differ_in_code_only(messages: Sequence[Message]) -> bool:
    """Whether messages have one selector each, at one position in the data."""
    positions = {tuple((k.space, k.segments) for k in m.keys) for m in messages}
    return len(positions) == 1 and all(len(m.keys) == 1 and m.keys[0].space is Space.DATA for m in messages)


class LayoutView:
    """A base class for the messages that share a layout."""

    def __init__(self, bodies: ClassBodies, name: str, messages: Sequence[Message]) -> None:
        self.name, self.doc = name, docstrings.of_layout(messages[0].layout)
        self.body = BodyView(bodies, messages, ())
        self.encode = EncodeView(messages[0], bodies, "self.CODE") if _differ_in_code_only(messages) else None
        """How all of them write their bytes; None when they differ in more than their code."""


class MessageView:
    """The class of a message."""

    def __init__(self, views: MessageViews, command: Command, message: Message) -> None:
        name, has_body, base = text.class_name(message.name), _has_body(message), views.bases.get(message)
        codes, bodies = message_plan(message).codes, views.bodies
        is_request = message.direction is Direction.REQUEST
        self.message, self.name = message, name
        self.header = code.call(f"class {name}", self._base_classes(views, command, message))
        """The first line of the class."""
        self.doc = docstrings.of_message(command, message)
        self.node_place = _place(message) if message.node_in_data else None
        """The place of the node among the raw integers; None where it is not there."""
        has_own = has_body and (codes or base is None)
        self.body = BodyView(bodies, [message], command.from_each) if has_own else None
        """None when a base class has its fields, and no code has to be stored."""
        self.id = encoding.fixed_id(message)
        """The id without the node and the fields."""
        self.data = "" if has_body else encoding.constant_data(message)
        """Expression of the bytes of a frame without fields; empty for one with fields."""
        self.id_terms = encoding.id_terms(message, bodies.imports)
        """The assignment of the bits that fields fill in the id; None without any."""
        self.codes = code.tuple_of((f"0x{value:02X}" for value in codes), "CODES = ") if codes else None
        """The assignment of the codes that it can have; None if it has one at most."""
        writes_own = has_body and (codes or base is None or base.encode is None)
        self.encode = EncodeView(message, bodies, "self._code" if codes else "") if writes_own else None
        self.confusions = list(encoding.confusion_views(message))
        occasions = message.sending.occasions if message.sending else ()
        self.sent = code.tuple_of((text.literal(o.value) for o in occasions), "SENT = ")
        """The assignment of the occasions on which it is sent."""
        has_metadata = is_request or command.request is None
        self.metadata = [
            *(_class_attributes(command, bodies.parameters) if has_metadata else ()),
            *(client_facts.class_attributes(views.edition, command) if is_request else ()),
            *client_facts.state_attributes(command, message),
        ]
        """Assignments of class attributes."""

    def _base_classes(self, views: MessageViews, command: Command, message: Message) -> Iterator[str]:
        base = views.bases.get(message)
        if not _has_body(message):
            yield views.bodies.imports.use("ToNode" if message.id.nodes is not None else "ToAll")
        elif base:
            yield base.name
        replies = dict.fromkeys(text.class_name(reply.message.name) for reply in command.replies)
        is_request = message.direction is Direction.REQUEST
        yield f'Request["{" | ".join(replies) or "Message"}"]' if is_request else "Reply"


class MessageViews:
    """The classes of all messages of an edition: `layouts` before the `messages` that inherit from them."""

    def __init__(self, edition: Edition, bodies: ClassBodies) -> None:
        self.edition, self.bodies = edition, bodies
        sharing = {LayoutView(bodies, name, same): same for name, same in base_classes(edition).items()}
        self.layouts = list(sharing)
        self.bases = {message: layout for layout, same in sharing.items() for message in same}
        self.messages = [MessageView(self, edition.command(m.command), m) for m in edition.all_messages()]


def _class_attributes(command: Command, parameters: Mapping[str, Parameter]) -> Iterator[code.Code]:
    """Assignments of metadata for tools; what a command does not have is left to the base class."""
    yield f"TITLE = {text.literal(formatting.english(command.title))}"
    if command.manual:
        yield f"MANUAL = {text.literal(command.manual)}"
    if command.effects:
        yield code.tuple_of((text.literal(effect.name) for effect in command.effects), "EFFECTS = ")
    if command.limited_by:
        yield code.tuple_of((text.literal(setting.name) for setting in command.limited_by), "LIMITED_BY = ")
    if command.only:
        only = (
            code.tuple_of(
                (types.parameter_key(parameters[name], v) for v in values), f"{text.literal(text.attribute(name))}: "
            )
            for name, values in command.only.items()
        )
        yield code.dict_of(only, "ONLY = ")
