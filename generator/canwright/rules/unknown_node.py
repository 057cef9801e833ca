"""The nodes in `from_each` are nodes of the address."""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for command in subject.edition.commands:
        nodes = command.reply.id.nodes if command.reply else None
        unknown = [node for node in command.from_each if nodes is None or node not in nodes]
        if unknown and command.reply:
            known = f"{nodes[0]}..{nodes[-1]}" if nodes else "none"
            text = f"`{command.reply.address}` has no node {unknown[0]}; its nodes are {known}"
            yield Finding((*command.path, "reply", "from_each"), text, "check `from_each` and `nodes` of the address")
