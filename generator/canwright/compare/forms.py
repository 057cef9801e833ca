"""Forms of requests and replies, and the messages of two editions that can be compared field by field."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from ..language.notation import RawFormat
from ..model.layout import ConstantRole, Element, Field, Layout
from ..model.message import Command, Direction, EchoReply, KeyRole, Message, OtherReply
from ..model.types import Encoding
from ..resolve.types import bare_type

ECHO, FIELDS, NO_FIELDS, NONE = "echo", "fields", "{}", "none"
"""The forms, as a spec writes them."""


def reply_form(command: Command, new_names: Mapping[str, str]) -> str:
    """What a reply is made of; whose layout the fields are in makes no difference."""
    for reply in command.replies[:1]:
        if isinstance(reply, OtherReply):
            return f"of {new_names.get(reply.of, reply.of)}"
        return ECHO if isinstance(reply, EchoReply) else FIELDS
    return NONE


def own_messages(old: Command, new: Command) -> Iterator[tuple[Direction, Message, Message]]:
    """The frames of a command that both editions have and that are its own; no echo, which is as its request."""
    for direction in Direction:
        old_message, new_message = (c.message(direction) for c in (old, new))
        if (
            old_message is None
            or new_message is None
            or old_message.command != old.name
            or new_message.command != new.name
        ):
            continue
        if direction is Direction.REQUEST or not _is_other_reply(old, new):
            yield direction, old_message, new_message


def messages(old: Command, new: Command) -> Iterator[tuple[Direction, Message, Message]]:
    """As `own_messages`, without those that have lost all their fields."""
    return (frames for frames in own_messages(old, new) if not is_emptied(*frames[1:]))


def _is_other_reply(old: Command, new: Command) -> bool:
    """Whether a reply is not compared: it is an echo in one edition, or in both."""
    echoes = old.is_echoed + new.is_echoed
    return echoes == 1 or (echoes == 2 and old.request is not None and new.request is not None)


def is_emptied(old: Message, new: Message) -> bool:
    """Whether a command no longer gives a message any fields, by more than the removal of a single one."""
    gone, left = ((*constants(message), *message.layout.fields) for message in (old, new))
    if left or not gone or new.layout.path[0] != "commands" or old.remote is not new.remote:
        return False
    return len(gone) > 1 or old.layout.path[0] != "commands" or _frame(old) != _frame(new)


def _frame(message: Message) -> tuple[object, ...]:
    codes = tuple(key.value for key in message.keys if key.role is KeyRole.CODE)
    return codes, message.accepted_codes, message.dlc


def is_named(layout: Layout) -> bool:
    """Whether a layout is defined apart from the commands that use it."""
    return layout.path[0] == "layouts"


@functools.lru_cache(maxsize=4096)
def constants(message: Message) -> Mapping[str, Field]:
    """The constants that distinguish a message from others, which are no fields of its layout, by name; cached."""
    return {
        key.name: Field(
            name=key.name,
            renamed_from=None,
            deprecated=None,
            type=bare_type(RawFormat(Encoding.UNSIGNED, key.width), key.order, (), key.path),
            space=key.space,
            elements=(Element(None, key.segments),),
            is_array=False,
            only=(),
            role=ConstantRole(key.value),
            variable=None,
            title={},
            about={},
            manual="",
            manual_name="",
            path=key.path,
        )
        for key in message.keys
        if key.role is KeyRole.CONSTANT
    }
