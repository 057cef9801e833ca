"""The files of an edition, and the messages of each file for every node."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from ...model.edition import Edition
from ...model.message import Direction
from ...model.types import Assignment, number_of
from ..options import NO_OPTIONS, Options
from . import sending
from .comments import ENGLISH, Comments
from .frames import Frame, Part, frames, partners
from .names import message_endings, node_name
from .selection import COMMENTS, NODES
from .signals import Signals
from .text import fitting
from .view import KIND, File, Message, Signal, agree, file_name, fitted, known_values

_OTHER = {Direction.REPLY: Direction.REQUEST, Direction.REQUEST: Direction.REPLY}
_NO_NODE = "Vector__XXX"
_MAX_NODES_IN_NAME = 8


def files(edition: Edition, set_parameters: Assignment, options: Options) -> Sequence[File]:
    """All files of an edition that contain frames: those of the first selector precede those of tables.

    Files of a table that are the same for every value of the parameters are one file.
    """
    made = _Files(edition, set_parameters, options)
    plain: list[File] = []
    of_tables: dict[tuple[Sequence[Direction], str], list[File]] = {}
    for file in made.files():
        (of_tables.setdefault((file.directions, file.table), []) if file.table else plain).append(file)
    return [*plain, *(file for same in of_tables.values() for file in made.merged(same))]


@functools.lru_cache(maxsize=4)
def _without_options(edition: Edition) -> _Files:
    return _Files(edition, {}, NO_OPTIONS)


def reply_file(edition: Edition, assignment: Assignment) -> str | None:
    """The name of the first file that decodes replies under some parameter values; None without replies."""
    of_replies = (each for each in _without_options(edition).combinations() if Direction.REPLY in each[1])
    return next((file_name(edition, *each) for each in of_replies if agree(each[0], assignment)), None)


def signals_of_files(edition: Edition) -> Iterator[Signal]:
    """The signals in all files of an edition; those of several files several times."""
    return _without_options(edition).signals()


def stems(edition: Edition) -> Iterator[str]:
    """The first part of the names of files: the edition, and the parameter values that have files of their own."""
    name = f"{edition.family}-{edition.name}"
    return ("-".join((name, *known_values(edition, assignment))) for assignment in _assignments(edition, {}))


_Content = tuple[Frame, tuple[Signal, ...]]
"""A frame with its signals."""


class _Files:
    """Builds the files of an edition."""

    def __init__(self, edition: Edition, set_parameters: Assignment, options: Options) -> None:
        self._edition = edition
        self._host = fitting(edition.bus.host)
        self._nodes = options[NODES]
        self._comments = Comments(options[COMMENTS])
        numbers = {p.name: number_of(set_parameters, p.name) for p in edition.parameters if not p.is_choice}
        self._numbers: dict[str, Fraction] = {name: fixed for name, fixed in numbers.items() if fixed is not None}
        self._assignments: Sequence[Assignment] = [
            {**choices, **self._numbers} for choices in _assignments(edition, set_parameters)
        ]
        self._signals = {direction: Signals(direction, self._numbers, self._comments) for direction in KIND}
        every_frame = {direction: frames(edition, direction, {}) for direction in KIND}
        ids = ({id_ for frame in of_one for _, id_ in frame.ids()} for of_one in every_frame.values())
        self._shared = set.intersection(*ids)
        used = tuple(direction for direction in KIND if every_frame[direction])
        self._groups = [(direction,) for direction in used] if self._shared else [used]
        self._tables = table_names(
            [part for listed in every_frame.values() for frame in listed for part in frame.parts]
        )

    def combinations(self) -> Iterator[tuple[Assignment, tuple[Direction, ...]]]:
        """The parameter values and the directions of the files of the first selector."""
        return itertools.product(self._assignments, self._groups)

    def files(self) -> Iterator[File]:
        """A file for each direction, or one for both if they share no id, and one for each table of a direction."""
        for assignment, group in self.combinations():
            contents: dict[str, list[_Content]] = {}
            for table, content in self._contents(group, assignment):
                contents.setdefault(table, []).append(content)
            for table, of_table in contents.items():
                yield from self._file(group, assignment, table, of_table)

    def signals(self) -> Iterator[Signal]:
        """The signals in the files, without the messages of each node."""
        for assignment, group in self.combinations():
            for _, (_, signals) in self._contents(group, assignment):
                yield from signals

    def merged(self, same: Sequence[File]) -> Sequence[File]:
        """The files of a table for all values of the parameters; a single one if their messages are the same."""
        first = same[0]
        if len(same) < len(self._assignments) or any(file.messages != first.messages for file in same):
            return same
        return [
            first._replace(assignment=self._numbers, comment=self._about(self._numbers, first.directions, first.table))
        ]

    def _contents(self, group: Sequence[Direction], assignment: Assignment) -> Iterator[tuple[str, _Content]]:
        """The frames of a file of the first selector, and those whose selectors are read as one number, by their table."""
        for direction in group:
            signals = self._signals[direction]
            for frame in frames(self._edition, direction, assignment):
                yield "", (frame, fitted(signals.of(frame.parts, assignment)))
                for key, parts in parts_of_tables(frame.parts).items():
                    of_table = frame._replace(parts=tuple(parts))
                    yield self._tables[key], (of_table, fitted(signals.joined(parts, assignment, key[1])))

    def _file(
        self, group: tuple[Direction, ...], assignment: Assignment, table: str, contents: Sequence[_Content]
    ) -> Iterator[File]:
        """A file with these frames; none without messages."""
        messages = fitted(message for content in contents for message in self._messages(*content, len(group) > 1))
        ends = [end for message in messages for end in (*message.senders, *message.receivers) if end != _NO_NODE]
        if messages:
            yield File(
                edition=self._edition,
                assignment=assignment,
                directions=group,
                table=table,
                commands=tuple(dict.fromkeys(part.command.spec_name for frame, _ in contents for part in frame.parts)),
                variant=tuple(self._variant()),
                comment=self._about(assignment, group, table),
                nodes=tuple(dict.fromkeys((self._host, *ends))),
                messages=messages,
            )

    def _messages(self, frame: Frame, signals: tuple[Signal, ...], with_direction: bool) -> Iterator[Message]:
        """One message for each node, named by direction and a code in the id, or by the command if there is no selector."""
        first = frame.parts[0]
        selected, of_both, alone = message_endings(first)
        is_of_both = with_direction and first.command.request and first.command.reply
        ending = selected if first.selectors else of_both if is_of_both else alone
        send_type, cycle_ms = sending.attributes(frame)
        for node, id_ in frame.ids(self._nodes):
            name = node_name(first.message.address, node)
            nodes: tuple[str, ...] = (fitting(name),)
            if node is None:
                ends = (end for part in frame.parts for end in partners(self._edition, part, self._nodes))
                nodes = tuple(dict.fromkeys(fitting(node_name(*end)) for end in ends)) or (_NO_NODE,)
            is_request = frame.direction is Direction.REQUEST
            yield Message(
                id=id_,
                whole_name=f"{name}_{ending}",
                length=frame.length,
                shortest=frame.shortest,
                senders=(self._host,) if is_request else nodes,
                receivers=nodes if is_request else (self._host,),
                comment=self._comment(frame, id_ in self._shared),
                signals=signals,
                send_type=send_type,
                cycle_ms=cycle_ms,
            )

    def _comment(self, frame: Frame, is_shared: bool) -> str:
        comments, first = self._comments, frame.parts[0]
        address = self._edition.address(first.message.address)
        about = comments.of(first.command.title if not first.selectors else address.title)
        warning = comments.fixed("same_id", other=comments.fixed(KIND[_OTHER[frame.direction]]))
        kind = comments.fixed(KIND[frame.direction])
        times = sending.sentences(frame, comments)
        return comments.sentences([comments.labelled(about, kind), *times, warning if is_shared else ""])

    def _variant(self) -> Iterator[str]:
        """The selected nodes and the language, as parts of a file name."""
        nodes = self._nodes
        if nodes:
            listed = "_".join(map(str, nodes)) if len(nodes) <= _MAX_NODES_IN_NAME else f"{nodes[0]}_to_{nodes[-1]}"
            yield f"node{listed}"
        if self._comments.language != ENGLISH:
            yield self._comments.language

    def _about(self, assignment: Assignment, group: Sequence[Direction], table: str) -> str:
        """The comment of a file: its origin, and what it describes."""
        comments, edition = self._comments, self._edition
        known = comments.listed(known_values(edition, assignment))
        sentences = [
            comments.fixed("made", family=edition.family, edition=edition.name),
            comments.labelled(comments.fixed("parameters"), known) if known else "",
        ]
        if len(group) == 1:
            opposite = comments.fixed(KIND[_OTHER[group[0]]])
            sentences.append(comments.fixed("one_direction", kind=comments.fixed(KIND[group[0]])))
            sentences.append(comments.fixed("meaningless", other=opposite) if self._shared else "")
        else:
            sentences.append(comments.fixed("both_directions"))
        sentences.append(comments.fixed("table", table=table) if table else "")
        return comments.sentences(sentences)


def _assignments(edition: Edition, set_parameters: Assignment) -> Iterator[Mapping[str, str]]:
    """The combinations of parameter values that have files of their own."""
    choices = []
    for parameter in (p for p in edition.parameters if p.is_choice):
        wanted = set_parameters.get(parameter.name)
        if wanted is not None or not parameter.is_numeric:
            choices.append([(parameter.name, v.name) for v in parameter.values if wanted in (None, v.name)])
    return map(dict, itertools.product(*choices))


def parts_of_tables(parts: Sequence[Part]) -> Mapping[tuple[str, range], Sequence[Part]]:
    """The parts whose selectors can be read as one number, by their table and the bits of the selectors.

    Without a table, the names of the selectors after the first take its place.
    """
    grouped: dict[tuple[str, range], list[Part]] = {}
    for part in parts:
        if part.joined_span:
            entry = part.command.entry
            table = entry.table if entry else "-".join(key.name for key, _ in part.selectors[1:])
            grouped.setdefault((table, part.joined_span), []).append(part)
    # With those of the table that need fewer selectors, such as read-only ones.
    for (table, span), joined in grouped.items():
        joined += [p for p in parts if p.joined_span is None and _has_table(p, table) and p.is_fixed(span)]
    return grouped


def _has_table(part: Part, table: str) -> bool:
    return part.command.entry is not None and part.command.entry.table == table


def table_names(parts: Sequence[Part]) -> Mapping[tuple[str, range], str]:
    """A unique name for each table, as in `stored-settings`.

    Entries of a table with longer selectors than others need a file of their own. The file with most entries, or with
    the shorter selectors, has the name of the table; another one adds the last word that its entries have in common, or a number.
    """
    grouped = parts_of_tables(parts)
    names: dict[tuple[str, range], str] = {}
    for table in dict.fromkeys(table for table, _ in grouped):
        spans = (span for of, span in grouped if of == table)
        for i, span in enumerate(sorted(spans, key=lambda span: (-len(grouped[table, span]), len(span)))):
            ending = [_common_ending(grouped[table, span]) or str(i + 1)] if i else []
            name = "-".join([table, *ending]).replace("_", "-")
            numbered = (name if n == 1 else f"{name}-{n}" for n in itertools.count(1))
            names[table, span] = next(name for name in numbered if name not in names.values())
    return names


def _common_ending(parts: Sequence[Part]) -> str:
    named = (part.command.entry or part.command for part in parts)
    last, *further = {item.name.rpartition("_")[2] for item in named}
    return "" if further else last
