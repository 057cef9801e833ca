"""Variables of README.md: the files, the parts of the spec they omit, and examples from golden frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...language.golden_frames import GoldenFrame
from ...model.edition import Edition
from ...model.message import LISTED_NODES, Direction
from ...model.types import Parameter
from ...semantics import parameters
from ..base import Specification, header
from .fields import LETTER
from .files import KIND, Traffics
from .frames import Part, obstacle
from .selectors import joined_span
from .text import number
from .view import EXTENDED, File, Message, Signal

_HIGHEST_STANDARD_ID = 0x7FF


class Section(NamedTuple):
    """The files of one edition as a table: a row for each combination of parameter values.

    `joined` are the name parts of joined selectors, with the commands of such a file.
    `open_choices` are parameters that are not set, with their values; `open_numbers` are parameters that scales are
    multiples of, with an example; `lacking` is direction, command and reason.
    """

    edition: str
    header: str
    parameters: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[File, ...]], ...]
    joined: tuple[tuple[str, tuple[str, ...]], ...]
    open_choices: tuple[tuple[str, tuple[str, ...]], ...]
    open_numbers: tuple[tuple[str, str], ...]
    lacking: tuple[tuple[str, str, str], ...]


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
    def is_seen_in_a_log(self) -> bool:
        """False for a 29-bit id that fits into 11 bits: `cantools decode` reads it as an 11-bit id."""
        return not self.message.extended or self.frame.id > _HIGHEST_STANDARD_ID

    @property
    def data(self) -> str:
        return self.frame.data.hex(" ").upper()


class Made(NamedTuple):
    """An edition with its files."""

    specification: Specification
    traffics: Traffics
    files: tuple[File, ...]


class Guide(NamedTuple):
    """Content of README.md; an example is None if there is no golden frame for it."""

    sections: tuple[Section, ...]
    first: File | None
    reading: Example | None
    sending: Example | None
    for_one_node: bool


def guide(made: Sequence[Made]) -> Guide:
    sections = tuple(map(_section, made))
    reading = [e for one in made for e in _examples(one.specification, one.files, Direction.REPLY)]
    requests = (e for one in made for e in _examples(one.specification, one.files, Direction.REQUEST))
    sending = next((e for e in requests if len(e.values) == len(e.frame.raw)), None)
    best = max(reading, key=lambda e: len(e.values), default=None)
    first = next((file for one in made for file in one.files), None)
    for_one_node = any(file.part for one in made for file in one.files)
    return Guide(sections, best.file if best else first, best, sending, for_one_node)


def _usual(specification: Specification, parameter: Parameter) -> str:
    """A typical value of a number parameter: that of the first golden frame with one."""
    golden = specification.frames.frames if specification.frames else ()
    texts = (str(f.parameters[parameter.name]) for f in golden if parameter.name in f.parameters)
    found = (parameters.number(specification.edition, parameter, text) for text in texts)
    return number(next(found, parameter.maximum or Fraction(1)))


def _section(made: Made) -> Section:
    specification, traffics, files = made
    edition = specification.edition
    rows: dict[tuple[str, ...], list[File]] = {}
    for file in files:
        rows.setdefault(file.known, []).append(file)
    return Section(
        f"{edition.family} {edition.name}",
        header(edition),
        ", ".join(p.name for p in edition.parameters if p.is_choice and not p.is_numeric) or "for",
        tuple(" ".join((file.kind, *file.part)) for file in next(iter(rows.values()), ())),
        tuple((" ".join(known) or "all", tuple(row)) for known, row in rows.items()),
        tuple((name, tuple(dict.fromkeys(commands))) for name, commands in _joined(files).items()),
        tuple((p.name, tuple(v.name for v in p.values)) for p in edition.parameters if p.is_choice and p.is_numeric),
        tuple((p.name, _usual(specification, p)) for p in edition.parameters if edition.is_factor(p)),
        tuple(_lacking(edition, traffics)),
    )


def _joined(files: Sequence[File]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for file in files:
        if file.joined:
            found.setdefault(file.joined, []).extend(name for _, name in file.messages[0].signals[0].values)
    return found


def _lacking(edition: Edition, traffics: Traffics) -> Iterator[tuple[str, str, str]]:
    """Direction, command and reason of every part of the spec that is missing or incomplete in the files."""
    for direction, kind in KIND.items():
        for message in edition.messages(direction):
            reason = obstacle(message)
            if reason:
                yield kind, message.command, f"omitted: {reason}"
        frames = traffics[direction].frames({})
        hidden = {name: what for frame in frames for name, what in frame.hidden.items()}
        for message in edition.messages(direction):
            if message.name in hidden:
                what = f"{hidden[message.name]} distinguishes it from the other messages of its id"
                yield kind, message.command, f"omitted: {what}, which a multiplexor cannot express"
        for frame in frames:
            nodes = frame.rule.nodes or range(0)
            if len(nodes) > LISTED_NODES:
                last = nodes[LISTED_NODES - 1]
                yield (
                    kind,
                    frame.parts[0].command.name,
                    f"the files list the nodes up to {last} of {nodes[-1]}",
                )
            length = max(part.message.dlc for part in frame.parts)
            for part in frame.parts:
                if len(part.selectors) > 1 and joined_span(part) is None:
                    yield (
                        kind,
                        part.command.name,
                        "its fields are shown as raw bits, because its selectors are not adjacent",
                    )
                if part.message.dlc < length:
                    yield (
                        kind,
                        part.command.name,
                        f"it has {part.message.dlc} bytes, but the file lists {length}, the longest frame on its id",
                    )


def _examples(specification: Specification, files: Sequence[File], direction: Direction) -> Iterator[Example]:
    """Golden frames that a file describes without other parameters than those in its name."""
    golden = [f for f in specification.frames.frames if f.direction is direction] if specification.frames else []
    whole = [
        (file, set(file.known), {message.id & ~EXTENDED: message for message in reversed(file.messages)})
        for file in files
        if file.kind == KIND[direction] and not file.part
    ]
    for frame in golden:
        known = {str(value) for value in frame.parameters.values()}
        for file, known_there, by_id in whole:
            view = by_id.get(frame.id) if known_there == known else None
            example = _example(specification.edition, file, view, frame) if view else None
            if example and not frame.decode_only:
                yield example


def _example(edition: Edition, file: File, view: Message, frame: GoldenFrame) -> Example | None:
    command = edition.command(frame.command)
    message = command.message(frame.direction)
    if message is None:
        return None
    code = Part(command, message, tuple(key.value for key in message.keys)).code
    signals = {signal.name: signal for signal in view.signals}
    values = []
    for field, value in frame.values.items():
        signal = signals.get(f"{LETTER[frame.direction]}{code}_{field}")
        if signal and isinstance(value, Fraction):
            values.append((signal, number(value), False))
        elif signal and isinstance(value, str) and value in dict(signal.values).values():
            values.append((signal, value, True))
    selector = next((s for s in view.signals if s.mux == "M"), None)
    if not values or len(message.keys) > 1:
        return None
    return Example(file, frame, view, (selector.name, frame.command) if selector else None, tuple(values))
