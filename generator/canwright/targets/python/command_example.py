"""The example of a command: a program that encodes its request and decodes its reply."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame
from ...model.message import Message
from ..base import WorkedExchange
from . import code, text
from .class_bodies import depends_on_parameters
from .examples import arguments, parameter_argument
from .imports import Imports
from .types import TypeView, type_views


class SentView(NamedTuple):
    """A request: the call that makes it, the format of its id, and its frame."""

    call: code.Items
    format: str
    text: str


class ReceivedView(NamedTuple):
    """A reply: the call that decodes it."""

    call: code.Items
    text: str


class CommandExampleView(NamedTuple):
    imports: str
    known: code.Items | None
    request: SentView | None
    reply: ReceivedView | None


@functools.lru_cache(maxsize=4)
def _types(edition: Edition) -> Mapping[str, TypeView]:
    return type_views(edition, Imports())


def command_example(edition: Edition, worked: WorkedExchange) -> CommandExampleView:
    """The example with these golden frames."""
    command, names = worked.command, set[str]()
    known = None
    parameters = [p for p in edition.parameters if p.name in worked.parameters]
    if parameters:
        known = code.call("Parameters", [parameter_argument(p, worked.parameters) for p in parameters], "known = ")
        names |= {"Parameters", *(text.class_name(p.name) for p in parameters if p.is_choice and not p.is_numeric)}
    request = reply = None
    if command.request and worked.request:
        request = _sent(edition, command.request, worked.request, names, known is not None)
    if command.reply and worked.reply:
        function = "decode_answer" if worked.is_answered else "decode_reply"
        names.add(function)
        reply = _received(function, worked.reply, ["request"] * worked.is_answered, ["known"] * bool(parameters))
    imports = _imports(f"{edition.family}.{edition.identifier}", names)
    return CommandExampleView(imports, known, request, reply)


def _imports(package: str, names: set[str]) -> str:
    """The import statement, on several lines where one would be too long."""
    listed = ", ".join(sorted(names))
    if len(package) + len(listed) <= code.WIDTH - 15:
        return f"from {package} import {listed}"
    lines = "".join(f"    {name},\n" for name in sorted(names))
    return f"from {package} import (\n{lines})"


def _sent(edition: Edition, message: Message, frame: GoldenFrame, names: set[str], is_known: bool) -> SentView:
    class_ = text.class_name(message.name)
    names.add(class_)
    node = [f"node={frame.node}"] if message.id.nodes is not None else []
    known = ["parameters=known"] if is_known and depends_on_parameters(message.layout) else []
    values = arguments(message, frame, _types(edition))
    if values is None:
        raws = [
            f"{text.attribute(name)}={tuple(raw) if isinstance(raw, list) else raw}" for name, raw in frame.raw.items()
        ]
        call = code.call(f"{class_}.from_raw", [*node, *raws, *known], "request = ")
    else:
        names |= {value.enum for value in values if value.enum}
        call = code.call(class_, [*node, *(f"{v.keyword}={v.value}" for v in values), *known], "request = ")
    return SentView(call, "08X" if frame.extended else "03X", formatting.sent(frame))


def _received(function: str, frame: GoldenFrame, request: list[str], known: list[str]) -> ReceivedView:
    marks = ["extended=True"] * frame.extended + ["remote=True"] * frame.remote
    data = f'bytes.fromhex("{frame.data.hex(" ").upper()}")'
    call = code.call(function, [*request, f"0x{frame.id:X}", data, *known, *marks], "reply = ")
    return ReceivedView(call, formatting.sent(frame))
