"""Worked examples: golden frames of a command, in words."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from ... import words
from ...golden import Frame, GoldenFrames, Value
from ...model import Field, Message
from ...written import Text
from .tables import Labels
from .text import code, markdown

MOST = 4


class Example(NamedTuple):
    """A frame and what it means, its parts in Markdown."""

    frame: str
    given: str
    means: str
    source: str


def examples(
    golden: GoldenFrames | None, message: Message, command: str, labels: Labels, language: str
) -> Iterator[Example]:
    """The first few golden frames of one direction of a command, those with most to say first."""
    found = golden.of_command.get((command, message.direction), []) if golden else []
    usual = [f for f in found if not f.decode_only] or found
    for frame in sorted(usual, key=lambda f: -len(f.values))[:MOST]:
        yield Example(
            code(f"{frame.id:03X}#{frame.data.hex().upper()}"),
            ", ".join(code(f"{name} = {value}") for name, value in frame.parameters.items()),
            "<br>".join(_meanings(frame, message, labels)) or labels["none"],
            _source(golden.sources[frame.source], frame.note if language == "en" else None, language) if golden else "",
        )


def _source(source: Text, note: str | None, language: str) -> str:
    """Where a frame is from, and what is noted of it."""
    text = source if isinstance(source, str) else "".join(said for name, said in source.items() if name == language)
    return f"{markdown(text.removesuffix('.'))} ({markdown(note)})" if note else markdown(text)


def _meanings(frame: Frame, message: Message, labels: Labels) -> Iterator[str]:
    if frame.node is not None:
        yield code(f"node = {frame.node}")
    fields = {f.name: f for f in message.layout.fields}
    for name, raw in frame.raw.items():
        value = frame.values.get(name)
        if value is None:
            yield code(f"{name}: raw {_list(raw)}")
        elif value == "none":
            yield f"{code(f'{name}: raw {_list(raw)}')}, {labels['raw_only']}"
        else:
            yield code(f"{name} = {_value(value, fields.get(name)) or labels['none']}") + _raw(raw, value)


def _raw(raw: int | list[int], value: Value) -> str:
    return "" if raw == value else f" ({code(f'raw {_list(raw)}')})"


def _value(value: Value, field: Field | None) -> str:
    unit = f" {field.type.unit.symbol}" if field and field.type.unit else ""
    if isinstance(value, list):
        return ", ".join(_value(v, None) for v in value) + unit
    return words.exact(value) + unit if isinstance(value, Fraction) else value


def _list(raw: int | list[int]) -> str:
    return ", ".join(map(str, raw)) if isinstance(raw, list) else str(raw)
