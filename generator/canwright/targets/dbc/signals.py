"""The signals of a frame: its selector and the fields of every message."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from ...model.message import Direction, Key
from ...model.types import Assignment
from .comments import Comments
from .fields import LETTER, Fields, Place, bare
from .frames import Part
from .selectors import bits, joined_span, joined_value, runs
from .view import Signal, fitted


class Signals:
    """Builds the signals of the frames of one direction; those of a message once for each set of parameters it uses."""

    def __init__(self, direction: Direction, numbers: Mapping[str, Fraction], comments: Comments) -> None:
        self._direction = direction
        self._letter = LETTER[direction]
        self._numbers = numbers
        self._comments = comments
        self._fields: dict[tuple[tuple[str, str | Fraction], ...], Fields] = {}

    def of(self, parts: Sequence[Part], assignment: Assignment) -> tuple[Signal, ...]:
        """All signals of a frame; the first selector identifies the message."""
        return fitted(self._of(parts, assignment))

    def joined(self, parts: Sequence[Part], assignment: Assignment, span: range) -> tuple[Signal, ...]:
        """All signals of a frame; its selectors are the bits of `span`, read as one number."""
        return fitted(self._joined(parts, assignment, span))

    def _of(self, parts: Sequence[Part], assignment: Assignment) -> Iterator[Signal]:
        if not parts[0].selectors:
            for part in parts:
                yield from self._fields_of(part, assignment).of(part, "")
            return
        by_value: dict[int, list[Part]] = {}
        for part in parts:
            by_value.setdefault(part.selectors[0][1], []).append(part)
        key = parts[0].selectors[0][0]
        names = _names(
            (value, _shared_name(under), under[0].code.partition("_")[0]) for value, under in by_value.items()
        )
        yield self._selector(f"{self._letter}_{key.name}", "M", key, names, "selector")
        for value, under in by_value.items():
            if len(under[0].selectors) == 1:
                yield from self._fields_of(under[0], assignment).of(under[0], f"m{value}")
            else:
                yield from self._undecided(under, f"m{value}")

    def _joined(self, parts: Sequence[Part], assignment: Assignment, span: range) -> Iterator[Signal]:
        by_value = {joined_value(part, span): part for part in parts}
        name = "_".join((self._letter, *(key.name for key, _ in parts[0].selectors)))
        names = _names((value, part.command.name, part.code) for value, part in by_value.items())
        yield bare(Place(name, "M", tuple(span)), self._sentence("joined"), names)
        for value, part in by_value.items():
            yield from self._fields_of(part, assignment).of(part, f"m{value}", span)

    def _fields_of(self, part: Part, assignment: Assignment) -> Fields:
        """The builder of the fields of a message for the values of the parameters it depends on."""
        known = tuple((name, assignment[name]) for name in part.message.layout.parameters if name in assignment)
        if known not in self._fields:
            self._fields[known] = Fields(self._direction, dict(known), self._numbers, self._comments)
        return self._fields[known]

    def _undecided(self, parts: Sequence[Part], mux: str) -> Iterator[Signal]:
        """Messages with a second selector: that selector, and all other bits as raw bits."""
        code, *_ = parts[0].code.split("_")
        shared = parts[0].selectors[: min(len(part.selectors) for part in parts)]
        for i, (key, _) in enumerate(shared[1:], start=1):
            named = [(part.selectors[i][1], part.command.name) for part in parts]
            values = [value for value, _ in named]
            names = [(value, command) for value, command in named if values.count(value) == 1]
            yield self._selector(f"{self._letter}{code}_{key.name}", mux, key, names, "index")
        free = set(range(max(part.message.dlc for part in parts) * 8)) - {b for key, _ in shared for b in bits(key)}
        comment = self._sentence("separate_file" if all(map(joined_span, parts)) else "undecided")
        for run in runs(free):
            yield bare(Place(f"{self._letter}{code}_data", mux, run), comment)

    def _selector(self, name: str, mux: str, key: Key, names: Sequence[tuple[int, str]], comment: str) -> Signal:
        return bare(Place(name, mux, bits(key), key.order), self._sentence(comment), names)

    def _sentence(self, name: str) -> str:
        return self._comments.sentences([self._comments.fixed(name)])


def _shared_name(parts: Sequence[Part]) -> str:
    """The command of a selector value: of messages with one more selector, the name of all of them; empty if they differ."""
    first, *further = parts
    if len(first.selectors) == 1:
        return first.command.name
    return first.command.spec_name if all(part.command.spec_name == first.command.spec_name for part in further) else ""


def _names(named: Iterable[tuple[int, str, str]]) -> list[tuple[int, str]]:
    """Values with names from value, name and code. Names are unique, because readers look values up by name."""
    values: dict[str, int] = {}
    for value, name, code in named:
        if name:
            values[f"{name}_{code}" if name in values else name] = value
    return [(value, name) for name, value in values.items()]
