"""Variables of README.md: the files, the parts of the spec they omit, and examples from golden frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.golden_frames import GoldenFrame
from ...model.message import Direction
from ...model.types import Assignment, Parameter, number_of
from ..base import EditionInput, header
from ..examples import is_usual
from .comments import ENGLISH, languages
from .frames import Part, frames, obstacle, unlisted_nodes
from .limits import LIMITS
from .names import prefix
from .text import number
from .view import EXTENDED, KIND, File, Message, Signal, known_values

_HIGHEST_STANDARD_ID = 0x7FF


class Example(NamedTuple):
    """A golden frame and a file that describes it, with the selector and the values of all other signals."""

    file: File
    frame: GoldenFrame
    message: Message
    selector: tuple[str, str] | None
    values: tuple[tuple[Signal, str, bool], ...]
    """Signals and their values as text; True if the value is a name."""

    @property
    def digits(self) -> int:
        return 8 if self.message.extended else 3

    @property
    def id(self) -> str:
        return f"{self.frame.id:0{self.digits}X}"

    @property
    def data(self) -> str:
        return self.frame.data.hex(" ").upper()

    @property
    def mark(self) -> str:
        """Between id and data in the notation of can-utils."""
        frame_format = self.file.edition.bus.frame_format
        return f"##{int(frame_format.switches_rate)}" if frame_format.is_fd else "#"


class Made(NamedTuple):
    """An edition with its files, and the parameters that are set."""

    specification: EditionInput
    files: tuple[File, ...]
    set_parameters: Assignment


def guide(made: Sequence[Made]) -> Mapping[str, object]:
    """Variables of README.md; an example is None if there is no golden frame for it."""
    reading = [e for product in made for e in _examples(product.specification, product.files, Direction.REPLY)]
    requests = (e for product in made for e in _examples(product.specification, product.files, Direction.REQUEST))
    sending = next((e for e in requests if len(e.values) == len(e.frame.raw)), None)
    best = max(reading, key=lambda e: len(e.values), default=None)
    first = best.file if best else next((file for product in made for file in product.files), None)
    written = {language for product in made for language in product.specification.edition.languages}
    return {
        "sections": list(map(_section, made)),
        "first": first,
        "limits": LIMITS,
        "first_needs_program": any(map(_is_rejected, first.messages)) if first else False,
        "is_fd": any(file.edition.bus.frame_format.is_fd for product in made for file in product.files),
        "has_ranges": any(s.ranges for p in made for f in p.files for m in f.messages for s in m.signals),
        "reading": best,
        "sending": sending,
        "kinds": {file.kind for product in made for file in product.files},
        "selection": " ".join(_selection(made[0])) if made else "",
        "translations": [name for name in languages() if name != ENGLISH and name in written],
    }


def _is_rejected(message: Message) -> bool:
    """Whether `cantools decode` rejects frames of a message.

    It rejects a frame that is shorter than the message, and reads a 29-bit id that fits into 11 bits as an 11-bit id.
    """
    has_small_id = message.extended and message.id & ~EXTENDED <= _HIGHEST_STANDARD_ID
    return has_small_id or message.shortest < message.length


def _selection(made: Made) -> Iterator[str]:
    """Options of `generate` that select two nodes and the last value of each parameter."""
    edition = made.specification.edition
    nodes = next((m.id.nodes for m in edition.all_messages() if m.id.nodes), range(0))
    if len(nodes) > 1:
        yield f"--nodes {nodes[0]},{nodes[1]}"
    yield from (f"--set {p.name}={p.values[-1].name}" for p in edition.parameters if p.is_choice)


def _usual(specification: EditionInput, parameter: Parameter) -> str:
    """A typical value of a number parameter: that of the first golden frame with one."""
    golden = specification.frames.frames if specification.frames else ()
    numbers = (number_of(f.parameters, parameter.name) for f in golden)
    return number(next(filter(None, numbers), parameter.maximum or Fraction(1)))


def _section(made: Made) -> Mapping[str, object]:
    """The files of one edition as a table with a row for each combination of parameter values."""
    specification, files, known = made
    edition = specification.edition
    rows: dict[tuple[str, ...], list[File]] = {}
    tables: dict[str, list[File]] = {}
    for file in files:
        if file.table:
            tables.setdefault(file.table, []).append(file)
        else:
            rows.setdefault(file.known, []).append(file)
    unset = [p for p in edition.parameters if p.name not in known] if files else []
    return {
        "edition": f"{edition.family} {edition.name}",
        "header": header(edition),
        "parameters": ", ".join(p.name for p in edition.parameters if p.is_choice and not p.is_numeric) or "for",
        "columns": [file.kind or "requests and replies" for file in next(iter(rows.values()), ())],
        "rows": [(" ".join(values) or "all", row) for values, row in rows.items()],
        "tables": [
            (name, dict.fromkeys(c for file in some for c in file.commands), some) for name, some in tables.items()
        ],
        # parameters that are not set: choices with their values, and factors of scales with an example
        "open_choices": [(p.name, [v.name for v in p.values]) for p in unset if p.is_choice and p.is_numeric],
        "open_numbers": [(p.name, _usual(specification, p)) for p in unset if edition.is_factor(p)],
        "open_ids": [(p.name, _usual(specification, p)) for p in edition.parameters if p.whole and p.name not in known],
        "lacking": [(kind, *lack) for direction, kind in KIND.items() for lack in _lacking(edition, direction)],
        "excluded": "" if files else ", ".join(f"{name}={value}" for name, value in known.items()),
    }


def _lacking(edition: Edition, direction: Direction) -> Iterator[tuple[str, str]]:
    """Command and reason of every part of the spec that is missing or incomplete in the files of a direction."""
    for message in edition.messages(direction):
        reason = obstacle(message)
        if reason:
            yield message.command, f"omitted: {reason}"
    listed = frames(edition, direction, {})
    hidden = {name: what for frame in listed for name, what in frame.hidden.items()}
    for message in edition.messages(direction):
        if message.name in hidden:
            what = f"{hidden[message.name]} distinguishes it from the other messages of its id"
            yield message.command, f"omitted: {what}, which a multiplexor cannot express"
    for frame in listed:
        yield from ((frame.parts[0].command.name, text) for text in unlisted_nodes(frame))
        for part in frame.parts:
            name, length = part.command.name, part.message.dlc
            if len(part.selectors) > 1 and part.joined_span is None:
                yield name, "its fields are shown as raw bits, because its selectors are not adjacent"
            if length < frame.length:
                yield name, f"it has {length} bytes, but the file lists {frame.length}, the longest frame on its id"


def _examples(specification: EditionInput, files: Sequence[File], direction: Direction) -> Iterator[Example]:
    """Golden frames that a file describes without other parameters than those in its name."""
    golden = [f for f in specification.frames.frames if f.direction is direction] if specification.frames else []
    whole = [
        (file, set(file.known), {message.id & ~EXTENDED: message for message in reversed(file.messages)})
        for file in files
        if direction in file.directions and not file.table
    ]
    for frame in golden:
        known = set(known_values(specification.edition, frame.parameters))
        for file, known_there, by_id in whole:
            view = by_id.get(frame.id) if known_there == known else None
            example = _example(specification.edition, file, view, frame) if view else None
            if example and is_usual(specification.edition.command(frame.command).message(direction), frame):
                yield example


def _example(edition: Edition, file: File, view: Message, frame: GoldenFrame) -> Example | None:
    command = edition.command(frame.command)
    message = command.message(frame.direction)
    if message is None:
        return None
    start = prefix(Part(command, message))
    signals = {signal.whole_name: signal for signal in view.signals}
    values = []
    for field, value in frame.values.items():
        signal = signals.get(f"{start}_{field}")
        if signal and isinstance(value, Fraction):
            values.append((signal, number(value), False))
        elif signal and isinstance(value, str) and value in dict(signal.values).values():
            values.append((signal, value, True))
    selector = next((s for s in view.signals if s.mux == "M"), None)
    if not values or len(message.keys) > 1:
        return None
    return Example(file, frame, view, (selector.whole_name, frame.command) if selector else None, tuple(values))
