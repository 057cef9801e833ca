"""Docstrings of generated classes and properties: a summary line and paragraphs, safe to print."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import formatting
from ...model.deprecation import Deprecation
from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import Command, Direction, Message
from ...model.types import Encoding, Parameter, Type
from .text import english, plain, sentence

Docstring = tuple[str, ...]
"""A summary line and paragraphs; empty ones are left out."""


def of_edition(edition: Edition) -> Docstring:
    """The docstring of the module."""
    return (f"{edition.family} {edition.name}: {english(edition.title)}", english(edition.about))


def of_parameter(parameter: Parameter) -> Docstring:
    """The docstring of an attribute of `Parameters`."""
    if parameter.is_choice:
        allowed = f"One of {', '.join(value.name for value in parameter.values)}."
    else:
        limits = formatting.allowed(parameter)
        allowed = sentence(limits[:1].upper() + limits[1:])
    return (_joined(sentence(english(parameter.title)), allowed, english(parameter.about)),)


def of_layout(layout: Layout) -> Docstring:
    """The docstring of the base class for the messages of a layout."""
    return (sentence(english(layout.title)), english(layout.about), _manual(layout.manual))


def of_message(command: Command, message: Message) -> Docstring:
    """The docstring of the class of a message."""
    code = f" (0x{command.code:02X})" if command.code is not None else ""
    title = f"{english(command.title)}{code}, {message.direction.value}."
    if message.direction is Direction.REPLY:
        echo = "The request, sent back." if command.is_echoed else ""
        numbers = sentence(formatting.frame_numbers(message.sequence).capitalize()) if message.sequence else ""
        facts = _joined(echo, _sending(message), numbers, _in_manual(command))
        return (title, deprecation(command.deprecated), facts)
    only = (f"Only {name} {', '.join(values)}." for name, values in command.only.items())
    effects = _joined(
        *(sentence(formatting.effect(english(effect.title), command, effect)) for effect in command.effects)
    )
    return (
        title,
        deprecation(command.deprecated),
        _joined(english(command.about), *only, _in_manual(command)),
        _joined(_reply_time(command), _sending(message), *map(sentence, _replies(command))),
        "" if command.implemented else "Not implemented according to the manual.",
        f"Effects: {effects}" if effects else "",
        _joined(*(english(note) for note in command.notes)),
    )


def _reply_time(command: Command) -> str:
    within = command.reply_within_ms
    return "" if within is None else f"Maximum time from request to reply: {formatting.exact(within)} ms."


def _replies(command: Command) -> Iterator[str]:
    """The replies, if there are several."""
    further = [*formatting.further_replies(command)]
    if further and command.reply is not None:
        yield ", ".join((f"The reply is that of {command.reply.command}", *further))


def _sending(message: Message) -> str:
    return f"Timing: {formatting.sending(message.sending)}." if message.sending else ""


def of_field(field: Field, of_type: str, manual_of_layout: str, nodes: Sequence[int]) -> Docstring:
    """The docstring of the property of a field; `of_type` is the sentence about its type.

    `nodes` are the nodes that answer the command one by one; the elements of an array with their numbers are theirs.
    """
    return (
        sentence(english(field.title)),
        deprecation(field.deprecated),
        _joined(
            _elements(field, nodes),
            of_type,
            sentence(english(field.about) or english(field.type.about)),
            f"Exists under {', '.join(field.only)} only." if field.only else "",
            _manual("" if field.manual == manual_of_layout else field.manual, field.manual_name),
        ),
    )


def deprecation(deprecated: Deprecation | None) -> str:
    """The sentence about a deprecated item; empty for any other."""
    return f"Deprecated {deprecated}." if deprecated else ""


def of_type(type_: Type) -> str:
    """Unit, resolution and range in a sentence; empty without any."""
    parts = []
    if type_.unit:
        parts.append(f"In {type_.unit.symbol}")
    if not type_.is_plain and type_.is_number and not type_.is_bare_float:
        parts.append(f"resolution (1 LSB) {formatting.with_cases(formatting.scale(type_))}")
    limits = formatting.ranges(type_)
    if limits:
        parts.append(("from " if type_.encoding is Encoding.FLOAT else "raw ") + formatting.with_cases(limits))
    if type_.no_values:
        parts.append("None: " + ", ".join(f"{n.name} (raw {formatting.no_value(n)})" for n in type_.no_values))
    if type_.names:
        parts.append("names: " + ", ".join(f"{m.name} (raw {m.value})" for m in type_.names))
    joined = "; ".join(parts)
    return sentence(plain(joined[:1].upper() + joined[1:]))


def _elements(field: Field, nodes: Sequence[int]) -> str:
    """The number, or the node, of each element of an array; empty for any other field."""
    numbers = [element.index for element in field.elements if element.index is not None]
    if not numbers:
        return ""
    what = "node" if numbers == list(nodes) else "number"
    return sentence("Elements: " + ", ".join(f"[{i}] is {what} {number}" for i, number in enumerate(numbers)))


def _in_manual(command: Command) -> str:
    return _manual(command.manual, command.manual_name)


def _manual(section: str, name: str = "") -> str:
    if not section:
        return f"In the manual: {plain(name)}." if name else ""
    return f"Manual {plain(formatting.cited(section, name))}."


def _joined(*sentences: str) -> str:
    return " ".join(part for part in sentences if part)
