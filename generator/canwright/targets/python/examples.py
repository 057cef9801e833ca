"""Examples with golden frames: the program of a command, and the longer example of README.md."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame, Value
from ...model.layout import Field
from ...model.message import Message
from ...model.metadata import Consent
from ...model.types import Assignment, Parameter
from ...semantics.frame import CanFrame, node_of
from ..base import EditionInput, WorkedExchange
from ..examples import readme_exchange
from . import code, text, types
from .class_bodies import depends_on_parameters
from .imports import Imports


class Argument(NamedTuple):
    """A keyword with the expression of its value, and the enum class that the expression uses, if any."""

    keyword: str
    value: str
    enum: str


@functools.lru_cache(maxsize=4)
def _types(edition: Edition) -> Mapping[str, types.TypeView]:
    return types.type_views(edition, Imports())


class CommandExample:
    """The program of a command with golden frames: its import statement, and its statements as far as it has them."""

    def __init__(self, edition: Edition, worked: WorkedExchange) -> None:
        command, frame = worked.command, worked.reply
        known, names = _known(edition, worked.parameters)
        self.known = code.call("Parameters", known, "known = ") if known else None
        self.request = self.reply = None
        if command.request and worked.request:
            self.request = _sent(edition, command.request, worked.request, names, bool(known))
        if command.reply and frame:
            function = "decode_answer" if worked.is_answered else "decode_reply"
            names.add(function)
            data = f'bytes.fromhex("{frame.data.hex(" ").upper()}")'
            given = [*["request"] * worked.is_answered, f"0x{frame.id:X}", data, *["known"] * bool(known)]
            marks = ["extended=True"] * frame.extended + ["remote=True"] * frame.remote
            self.reply = code.call(function, [*given, *marks], "reply = ")
        self.imports = _imports(f"{edition.family}.{edition.identifier}", names)


def _imports(package: str, names: set[str]) -> str:
    """The import statement, on several lines where one would be too long."""
    listed = ", ".join(sorted(names))
    if len(package) + len(listed) <= code.WIDTH - 15:
        return f"from {package} import {listed}"
    lines = "".join(f"    {name},\n" for name in sorted(names))
    return f"from {package} import (\n{lines})"


def _sent(edition: Edition, message: Message, frame: GoldenFrame, names: set[str], is_known: bool) -> code.Items:
    """The call that makes a request; adds the `names` that it needs."""
    class_ = text.class_name(message.name)
    names.add(class_)
    values = arguments(message, frame, _types(edition))
    function, listed = class_, [f"{value.keyword}={value.value}" for value in values or ()]
    if values is None:
        function = f"{class_}.from_raw"
        listed = [f"{text.attribute(n)}={tuple(raw) if isinstance(raw, list) else raw}" for n, raw in frame.raw.items()]
    names |= {value.enum for value in values or () if value.enum}
    return code.call(function, _keywords(message, frame, listed, is_known), "request = ")


def _known(edition: Edition, given: Assignment) -> tuple[list[str], set[str]]:
    """The arguments of `Parameters`, and the names that they need."""
    parameters = [p for p in edition.parameters if p.name in given]
    names = {"Parameters"} if parameters else set()
    names |= {text.class_name(p.name) for p in parameters if p.is_choice and not p.is_numeric}
    return [parameter_argument(p, given) for p in parameters], names


def _keywords(message: Message, frame: GoldenFrame, values: Sequence[str], is_known: bool) -> list[str]:
    """The arguments that make a message: node, values, and parameters if it depends on them."""
    node = [f"node={frame.node}"] if message.id.nodes is not None else []
    known = ["parameters=known"] if is_known and depends_on_parameters(message) else []
    return [*node, *values, *known]


def example(specifications: Sequence[EditionInput]) -> Example | None:
    """The example of README.md: a command with a reply of its own, and with values."""
    shown = readme_exchange(specifications, _is_usable)
    return Example(*shown) if shown else None


def _is_usable(edition: Edition, exchange: WorkedExchange) -> bool:
    command, request, reply = exchange.command, exchange.request, exchange.reply
    if command.request is None or command.reply is None or request is None or reply is None:
        return False
    has_own_values = command.reply.command == command.name and reply.values and not reply.remote
    has_same_node = request.node == reply.node
    return bool(has_own_values and has_same_node and arguments(command.request, request, _types(edition)) is not None)


class Example:
    """A request and a frame that answers it."""

    def __init__(self, edition: Edition, exchange: WorkedExchange) -> None:
        request, reply = exchange.request, exchange.reply
        asked, answer = exchange.command.request, exchange.command.reply
        assert asked and answer and request and reply
        sent = arguments(asked, request, _types(edition)) or []
        known, names = _known(edition, exchange.parameters)
        values = [f"{argument.keyword}={argument.value}" for argument in sent]
        self.edition, self.frame = edition, reply
        self.known = ", ".join(known)
        """The arguments of `Parameters`."""
        self.request, self.reply = text.class_name(asked.name), text.class_name(answer.name)
        names |= {self.request, self.reply, "decode_answer", "decode_reply"}
        self.names = sorted(names | {argument.enum for argument in sent if argument.enum})
        node = node_of(asked, CanFrame(request.id, request.data), exchange.parameters)
        self.node = 1 if node is None else node
        """The node of both, in their ids or their data; 1 without one."""
        self.values = ", ".join(values)
        """The arguments of the request without node and parameters."""
        self.arguments = ", ".join(_keywords(asked, request, values, bool(known)))
        own = asked.node_bits and text.attribute(asked.node_bits.name)
        self.of_node = ", ".join(f"{a.keyword}={a.value}" for a in sent if a.keyword != own)
        """The arguments of `Node.make`: those without the node."""
        self.field = text.attribute(next(field.name for field in answer.layout.fields if field.name in reply.values))
        self.shares_ids = any(c.request and c.reply and c.request.id == c.reply.id for c in edition.commands)
        """Whether requests and replies of the edition have the same ids."""
        consents = dict.fromkeys(e.consent for e in exchange.command.effects if e.consent is not Consent.NONE)
        once = " ".join(consent.value for consent in consents if consent is not Consent.MOTION)
        self.allow = ', allow="motion"' if Consent.MOTION in consents else ""
        """The consent that the client needs for the request; empty without one."""
        self.allow_once = f', allow="{once}"' if once else ""
        """The consent that is given with the request; empty without one."""


def arguments(message: Message, frame: GoldenFrame, views: Mapping[str, types.TypeView]) -> list[Argument] | None:
    """The values that make the message of a frame; None where a field has no value."""
    made: list[Argument] = []
    variant = message.layout.variant(frame.parameters)
    for field in variant.given if variant else ():
        view = views[field.type.name]
        value = _value(field, frame.values.get(field.name), view)
        if value is None:
            return None
        made.append(Argument(text.attribute(field.name), value, view.enum))
    return made


def _value(field: Field, value: Value | None, view: types.TypeView) -> str | None:
    if isinstance(value, list) and not field.type.flags:
        parts = [_value(field, element, view) for element in value]
        return None if None in parts else f"({', '.join(map(str, parts))},)"
    if isinstance(value, list):
        return " | ".join(f"{view.enum}.{text.member_name(str(name))}" for name in value) or f"{view.enum}(0)"
    if isinstance(value, Fraction):
        return str(value.numerator) if value.denominator == 1 else repr(float(value))
    if value and field.type.enum and value != "none":
        return f"{view.enum}.{text.member_name(value)}"
    return text.literal(value) if value in [member.name for member in field.type.names] else None


def parameter_argument(parameter: Parameter, given: Assignment) -> str:
    """An argument of `Parameters`."""
    value = formatting.parameter_value(given[parameter.name])
    return f"{text.attribute(parameter.name)}={types.parameter_key(parameter, value) if parameter.is_choice else value}"
