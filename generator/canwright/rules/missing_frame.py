"""Every request and reply has a golden frame."""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings

SHOWN = 3
"""The maximum number of messages in a finding."""

_HINT = "`canwright frames SPEC` prints an entry for each; fill in the bytes of the manual"


def check(subject: CheckInput) -> Findings:
    if subject.frames is None:
        hint = "`canwright frames SPEC` prints entries to fill in; save them as my.frames.yaml beside my.yaml"
        yield Finding((), "there are no golden frames beside this spec", hint)
        return
    there = {(frame.direction, frame.command) for frame in subject.frames.reviewed.frames}
    order = {command.name: index for index, command in enumerate(subject.edition.commands)}
    messages = (m for m in subject.edition.all_messages() if (m.direction, m.command) not in there)
    missing = sorted(messages, key=lambda message: order[message.command])
    if len(missing) == 1:
        text = f"the {missing[0].direction.value} of `{missing[0].command}` has no golden frame"
        yield Finding(missing[0].path, text, _HINT, key=True)
    elif missing:
        listed = ", ".join(f"`{m.command}` ({m.direction.value})" for m in missing[:SHOWN])
        more = f" and {len(missing) - SHOWN} more" if len(missing) > SHOWN else ""
        text = f"{len(missing)} messages have no golden frame: {listed}{more}"
        yield Finding(missing[0].path, text, _HINT, key=True)
