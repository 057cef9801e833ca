"""The first steps with a device: frames to send in order, and what happens at each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.message import Command
from ...model.metadata import Consent
from ...semantics.encoder import Encoder
from ...semantics.frame import CanFrame
from ...templating import resources
from ...templating.data_files import read_data
from ...templating.markup import code, markdown
from .links import COMMANDS, command_page

NODE = 1


class Step(NamedTuple):
    """A frame to node 1, as `candump` and `cansend` write it, and the arguments of `canwright request`.

    The other texts are Markdown.
    """

    frame: str
    arguments: str
    settings: str
    command: str
    given: str
    about: str


class FirstSteps(NamedTuple):
    """The steps of an edition."""

    edition: Edition
    folder: str
    steps: Sequence[Step]
    settings: str
    """The parameters that replies depend on, as options, with their first values as an example."""


def first_steps(listed: Sequence[tuple[str, Edition]], language: str) -> Iterator[FirstSteps]:
    """The steps of each edition whose family has some; `listed` are the editions with their folders."""
    written = read_data(resources.QUICK_START)
    for folder, edition in listed:
        steps = [step for item in written.get(edition.family, ()) for step in _step(folder, edition, item, language)]
        if steps:
            yield FirstSteps(
                edition, folder, steps, " ".join(dict.fromkeys(step.settings for step in steps if step.settings))
            )


def _step(folder: str, edition: Edition, written: Mapping[str, Any], language: str) -> Iterator[Step]:
    for command in edition.forms(written["command"])[:1]:
        values: Mapping[str, int] = written.get("values", {})
        frame = _frame(command, values)
        if frame is not None:
            title = markdown(command.spec_title[language])
            given = ", ".join(code(f"{name} = {value}") for name, value in values.items())
            link = f"[{title}]({folder}/{COMMANDS}{command_page(command)})"
            consents = dict.fromkeys(e.consent.value for e in command.effects if e.consent is not Consent.NONE)
            words = [command.name, *(f"{name}={value}" for name, value in values.items()), f"--node {NODE}"]
            arguments = " ".join([*words, *(f"--allow {consent}" for consent in consents)])
            settings = " ".join(
                f"--set {p.name}={p.values[0].name}" for p in edition.parameters if p.name in command.reply_parameters
            )
            yield Step(formatting.sent(frame), arguments, settings, link, given, markdown(written["about"][language]))


def _frame(command: Command, values: Mapping[str, int]) -> CanFrame | None:
    """The request to node 1 with these values; None if the edition cannot send it without parameters."""
    request = command.request
    if request is None or {field.name for field in request.layout.given} != {*values}:
        return None
    frame = Encoder({}).encode_values(request, NODE, values)
    return frame if isinstance(frame, CanFrame) else None
