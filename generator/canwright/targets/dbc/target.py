"""The target `dbc`."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence

from ...diagnostics.diagnostic import DocumentPath, Severity
from ...model.edition import Edition
from ...model.layout import Field, Space
from ...model.message import Direction
from ...model.types import Assignment
from ...semantics.configured import configured
from ...templating.environment import environment
from ..base import CodeExample, EditionInput, NameProblem, Output, Target, WorkedExchange
from ..options import NO_OPTIONS, Options
from .files import files, reply_file, signals_of_files, stems
from .frames import Part, frames, unlisted_nodes
from .guide import Made, guide
from .names import node_name, signal_name, signals_of
from .printer import printed
from .selection import COMMENTS, NODES
from .text import NAME_LENGTH, fitting
from .view import KIND


class DbcTarget(Target):
    """Generates DBC files."""

    title = "DBC"
    options = (NODES, COMMENTS)

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options = NO_OPTIONS
    ) -> Iterator[Output]:
        """The files of every edition, and a README.md with instructions."""
        known = (item._replace(edition=configured(item.edition, set_parameters)) for item in specifications)
        made = [Made(item, tuple(files(item.edition, set_parameters, options)), set_parameters) for item in known]
        for product in made:
            for file in product.files:
                yield Output(f"{file.name}.dbc", printed(file))
        env = environment("dbc", {})
        yield Output("README.md", env.get_template("README.md.j2").render(guide=guide(made)))

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        """A problem for every field with a signal name that is too long."""
        seen: set[DocumentPath] = set()
        for message in edition.all_messages():
            part = Part(edition.command(message.command), message)
            for field in message.layout.fields:
                name = max((name for _, name in _signals(part, field)), key=len)
                if field.space is Space.DATA and len(name) > NAME_LENGTH and field.path not in seen:
                    seen.add(field.path)
                    text = f"the signal name `{name}` has {len(name)} characters; the maximum in a DBC is {NAME_LENGTH}"
                    hint = f"use a shorter name; readers that ignore long names show `{fitting(name)}`"
                    yield NameProblem(field.path, text, hint, Severity.WARNING)

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        owners: dict[str, Edition] = {}
        for edition in editions:
            for name in stems(edition):
                owner = owners.setdefault(name.lower(), edition)
                if owner is not edition:
                    yield edition, f"{owner.family} {owner.name} would also have the files `{name}-….dbc`"
                    break

    def notices(self, editions: Sequence[Edition], options: Options) -> Iterator[str]:
        for edition in editions if not options[NODES] else ():
            listed = [frame for direction in KIND for frame in frames(edition, direction, {})]
            for text in dict.fromkeys(text for frame in listed for text in unlisted_nodes(frame)):
                yield f"{edition.family} {edition.name}: {text}"

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """The host, the first node of each address, signals, and names of values."""
        yield ("bus", "host"), edition.bus.host
        parts = [part for direction in KIND for frame in frames(edition, direction, {}) for part in frame.parts]
        first = {part.message.address: part.message.id.nodes[0] for part in parts if part.message.id.nodes}
        yield from ((("addresses", address), fitting(node_name(address, node))) for address, node in first.items())
        existing = {signal.whole_name for signal in signals_of_files(edition)}
        for part in parts:
            for field in part.message.layout.fields:
                for path, name in _signals(part, field):
                    if path and name in existing:
                        yield path, fitting(name)
                        for key in ("enum", "no_value", "names"):
                            members = field.type.members_by_key[key]
                            yield from (((*field.type.path, key, m.name), m.name) for m in members)

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample | None:
        frame, command = worked.reply, worked.command
        if frame is None or frame.remote or command.entry is not None or _has_several_lengths(edition):
            return None  # a terminal cannot decode tables and frames of several lengths in one line
        file = reply_file(edition, worked.parameters)
        digits = 8 if frame.extended else 3
        line = f"can0 {frame.id:0{digits}X} [{len(frame.data)}] {frame.data.hex(' ').upper()}"
        text = f"echo '{line}' | cantools decode --single-line {file}.dbc"
        return CodeExample("sh", text) if file else None


def _signals(part: Part, field: Field) -> Iterator[tuple[DocumentPath | None, str]]:
    """The names of the signals of a field, each with the path of the field or the flag; None for some of its bits."""
    for element in field.elements:
        for bits in signals_of(field, element):
            flag = (*field.type.path, "flags", bits.flag) if bits.flag else None
            yield flag or (None if bits.ending else field.path), signal_name(part, field, element) + bits.ending


@functools.lru_cache(maxsize=4)
def _has_several_lengths(edition: Edition) -> bool:
    """Whether replies have different numbers of data bytes."""
    return len({message.dlc for message in edition.messages(Direction.REPLY)}) > 1


TARGET = DbcTarget()
