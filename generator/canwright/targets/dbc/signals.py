"""The signals of a frame: its selector and the fields of every message."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from ...model.message import Direction, Key
from ...model.types import Assignment
from .fields import LETTER, Fields, Place, bare
from .frames import Part
from .selectors import bits, joined_span, joined_value, runs
from .view import Signal, fitted


class Signals:
    """Builds the signals of the frames of one direction; those of a message once for each set of parameters it uses."""

    def __init__(self, direction: Direction, numbers: Mapping[str, Fraction]) -> None:
        self._direction = direction
        self._letter = LETTER[direction]
        self._numbers = numbers
        self._fields: dict[tuple[tuple[str, str], ...], Fields] = {}

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
        names = _names({value: under[0] for value, under in by_value.items() if len(under[0].selectors) == 1})
        key = parts[0].selectors[0][0]
        yield _selector(f"{self._letter}_{key.name}", "M", key, names, "Identifies the command.")
        for value, under in by_value.items():
            if len(under[0].selectors) == 1:
                yield from self._fields_of(under[0], assignment).of(under[0], f"m{value}")
            else:
                yield from self._undecided(under, f"m{value}")

    def _joined(self, parts: Sequence[Part], assignment: Assignment, span: range) -> Iterator[Signal]:
        by_value = {joined_value(part, span): part for part in parts}
        name = "_".join((self._letter, *(key.name for key, _ in parts[0].selectors)))
        yield bare(Place(name, "M", tuple(span)), "All selectors, read as one number.", _names(by_value))
        for value, part in by_value.items():
            yield from self._fields_of(part, assignment).of(part, f"m{value}", span)

    def _fields_of(self, part: Part, assignment: Assignment) -> Fields:
        """The builder of the fields of a message for the values of the parameters it depends on."""
        known = tuple((name, assignment[name]) for name in part.message.layout.parameters if name in assignment)
        if known not in self._fields:
            self._fields[known] = Fields(self._direction, dict(known), self._numbers)
        return self._fields[known]

    def _undecided(self, parts: Sequence[Part], mux: str) -> Iterator[Signal]:
        """Messages with a second selector: that selector, and all other bits as raw bits."""
        code, *_ = parts[0].code.split("_")
        shared = parts[0].selectors[: min(len(part.selectors) for part in parts)]
        for i, (key, _) in enumerate(shared[1:], start=1):
            named = [(part.selectors[i][1], part.command.name) for part in parts]
            values = [value for value, _ in named]
            names = [(value, command) for value, command in named if values.count(value) == 1]
            yield _selector(
                f"{self._letter}{code}_{key.name}", mux, key, names, "Determines the meaning of the other bits."
            )
        free = set(range(max(part.message.dlc for part in parts) * 8)) - {b for key, _ in shared for b in bits(key)}
        elsewhere = "; a separate file shows them as fields" if all(map(joined_span, parts)) else ""
        for run in runs(free):
            place = Place(f"{self._letter}{code}_data", mux, run)
            yield bare(place, f"Bits whose meaning depends on the other selector{elsewhere}.")


def _selector(name: str, mux: str, key: Key, names: Sequence[tuple[int, str]], comment: str) -> Signal:
    return bare(Place(name, mux, bits(key), key.order), comment, names)


def _names(parts: Mapping[int, Part]) -> list[tuple[int, str]]:
    """The commands of selector values. Names are unique, because readers look values up by name."""
    named: dict[str, int] = {}
    for value, part in parts.items():
        name = part.command.name
        named[f"{name}_{part.code}" if name in named else name] = value
    return [(value, name) for name, value in named.items()]
