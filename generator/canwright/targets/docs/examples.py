"""Worked examples: golden frames of a command with their values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.golden_frames import GoldenFrame, GoldenFrames, Value
from ...model.message import Message
from ...templating.markup import code, markdown
from .links import explorer_link


class Example(NamedTuple):
    """A frame and its meaning; all parts are Markdown."""

    frame: str
    given: str
    means: str
    source: str


class Worked(NamedTuple):
    """An example without a language: `means % labels` is its meaning; `golden` has its source and its note."""

    golden: GoldenFrame
    frame: str
    given: str
    means: str

    def example(self, labels: Mapping[str, str], sources: Mapping[str, str], language: str) -> Example:
        """The example in a language; `sources` are texts in that language, by name."""
        remarks = [labels["section"].format(self.golden.manual)] if self.golden.manual else []
        remarks += filter(None, [self.golden.note.get(language)])
        source = markdown(sources[self.golden.source].rstrip(".。"))
        if remarks:
            source += labels["remark"].format(markdown(labels["and"].join(remarks)))
        return Example(self.frame, self.given, self.means % labels, source)


def worked(edition: str, frame: GoldenFrame, message: Message) -> Worked:
    """A golden frame of a message with its meaning."""
    units = {f.name: f" {f.type.unit.symbol}" for f in message.layout.fields if f.type.unit}
    return Worked(
        frame,
        f"[`{formatting.sent(frame)}`]({explorer_link(edition, frame, message)})",
        ", ".join(code(f"{name} = {value}") for name, value in formatting.parameter_values(frame.parameters).items()),
        "<br>".join(_meanings(frame, units)) or "%(none)s",
    )


def sources(golden: GoldenFrames, language: str) -> Mapping[str, str]:
    """Texts of the sources in one language, by name; a plain text is for all languages."""
    return {
        name: source if isinstance(source, str) else source.get(language, "") for name, source in golden.sources.items()
    }


def _meanings(frame: GoldenFrame, units: Mapping[str, str]) -> Iterator[str]:
    """The node and each field with its value; labels are inserted later by `%`."""
    if frame.node is not None:
        yield code(f"node = {frame.node}")
    for name, raw in frame.raw.items():
        value = frame.values.get(name)
        if value is None:
            yield code(f"{name}: raw {_list(raw)}")
        elif value == "none":
            yield f"{code(f'{name}: raw {_list(raw)}')}, %(raw_only)s"
        else:
            shown = _value(value, units.get(name, "")).replace("%", "%%") or "%(none)s"
            yield code(f"{name} = {shown}") + _raw(raw, value)


def _raw(raw: int | list[int], value: Value) -> str:
    return "" if raw == value else f" ({code(f'raw {_list(raw)}')})"


def _value(value: Value, unit: str) -> str:
    if isinstance(value, list):
        return ", ".join(_value(v, "") for v in value) + unit
    return formatting.exact(value) + unit if isinstance(value, Fraction) else value


def _list(raw: int | list[int]) -> str:
    return ", ".join(map(str, raw)) if isinstance(raw, list) else str(raw)
