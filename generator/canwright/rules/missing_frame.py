"""Every request and reply has a golden frame."""

from __future__ import annotations

from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    if subject.frames is None:
        hint = "write some from the manual into a file beside it: my.frames.yaml for my.yaml"
        yield Finding((), "there are no golden frames beside this spec", hint)
        return
    there = {(frame.direction, frame.command) for frame in subject.frames.frames}
    for message in subject.edition.all_messages():
        if (message.direction, message.command) not in there:
            text = f"the {message.direction.value} of `{message.command}` has no golden frame"
            yield Finding(message.path, text, "write one from the manual, beside the spec", key=True)
