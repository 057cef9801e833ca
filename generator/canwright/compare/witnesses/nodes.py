"""The nodes that messages are about, wherever a frame contains their number."""

from __future__ import annotations

from collections.abc import Sequence

from ...model.edition import Edition
from ...model.message import Command, Message


class Nodes:
    """The nodes of the messages of two editions."""

    def __init__(self, *editions: Edition) -> None:
        self._of: dict[Message, Sequence[int] | None] = {}
        for edition in editions:
            for command in edition.commands:
                for message in command.messages:
                    self._of.setdefault(message, _nodes(edition, command, message))

    def of(self, message: Message) -> Sequence[int] | None:
        """The nodes of a message: all numbers of its field if the spec does not limit them; None without a node."""
        return self._of[message]

    def first(self, *messages: Message) -> int | None:
        """A node that all messages have, as far as they have nodes; None if none has."""
        return max((nodes[0] for nodes in map(self.of, messages) if nodes is not None), default=None)


def _nodes(edition: Edition, command: Command, message: Message) -> Sequence[int] | None:
    bits = message.node_bits
    if message.id.nodes is not None or bits is None:
        return message.id.nodes
    address = edition.address(message.address)
    rules = (*(frame.id for frame in command.messages), address.request, address.reply)
    ranges = (rule.nodes for rule in rules)
    return next((nodes for nodes in ranges if nodes is not None), range(1 << bits.width))
