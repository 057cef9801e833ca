"""A command that ends the motion of a node has a request without values, and there is one of each kind for an address."""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    first: dict[tuple[str, str], str] = {}
    for command in subject.edition.commands:
        if command.ends_motion is None:
            continue
        path, kind = (*command.path, "ends_motion"), command.ends_motion.value
        values = [field.name for field in command.request.layout.given] if command.request else []
        if command.request is None:
            yield Finding(path, f"`{command.name}` has no request", "write `ends_motion` for the command to send")
        elif values:
            text = f"`{values[0]}` of `{command.name}` needs a value, which a client does not know"
            yield Finding(path, text, "remove `ends_motion`, or write another command whose fields are constant")
        known = first.setdefault((command.address, kind), command.name)
        if known != command.name:
            text = f"`{known}` and `{command.name}` both have `ends_motion: {kind}`"
            yield Finding(path, text, "keep the one that a program should send when it ends")
