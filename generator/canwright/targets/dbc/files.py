"""The files of an edition, and the messages of each file for every node."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.message import Direction
from ...model.types import Assignment, number_of
from ..options import NO_OPTIONS, Options
from . import sending
from .comments import ENGLISH, Comments
from .frames import Frame, Part, frames, partners
from .names import known_values, message_endings, node_name
from .selection import COMMENTS, NODES
from .signals import Signals
from .text import fitting
from .view import KIND, File, Message, Signal, fitted

_OTHER = {Direction.REPLY: Direction.REQUEST, Direction.REQUEST: Direction.REPLY}
_NO_NODE = "Vector__XXX"
_VERSION_LENGTH = 32
"""A longer VERSION is an error in some readers, and so is a comma in it."""
_MAX_NODES_IN_NAME = 8


def files(edition: Edition, set_parameters: Assignment, options: Options) -> Sequence[File]:
    """All files of an edition that contain frames: those of the first selector precede those of tables.

    Files of a table that are the same for every value of the parameters are one file.
    """
    made = _Files(edition, set_parameters, options)
    plain = [file for values in made.assignments for file in made.plain(values)]
    of_tables: dict[tuple[Sequence[Direction], str], list[File]] = {}
    for assignment in made.assignments:
        for file in made.tables(assignment):
            of_tables.setdefault((file.directions, file.table), []).append(file)
    return [*plain, *(file for same in of_tables.values() for file in made.merged(same))]


@functools.lru_cache(maxsize=4)
def _with_defaults(edition: Edition) -> _Files:
    return _Files(edition, {}, NO_OPTIONS)


def reply_file(edition: Edition, assignment: Assignment) -> str | None:
    """The name of the first file that decodes replies under some parameter values; None without replies."""
    made = _with_defaults(edition)
    agreeing = (a for a in made.assignments if all(assignment.get(name, value) == value for name, value in a.items()))
    return made.name_of_replies(next(agreeing))


def signals_of_files(edition: Edition) -> Iterator[Signal]:
    """The signals in all files of an edition; those of several files several times."""
    made = _with_defaults(edition)
    return (signal for assignment in made.assignments for signal in made.signals(assignment))


def stems(edition: Edition) -> Iterator[str]:
    """The first part of the names of files: the edition, and the parameter values that have files of their own."""
    made = _with_defaults(edition)
    return ("-".join((made.name, *made.known(assignment))) for assignment in made.assignments)


class _Content(NamedTuple):
    """A frame with its direction and signals."""

    direction: Direction
    frame: Frame
    signals: tuple[Signal, ...]


class _Files:
    """Builds the files of an edition."""

    def __init__(self, edition: Edition, set_parameters: Assignment, options: Options) -> None:
        self.name = f"{edition.family}-{edition.name}"
        self.assignments = list(_assignments(edition, set_parameters))
        """The combinations of parameter values that have files of their own."""
        self._edition = edition
        self._host = fitting(edition.bus.host)
        self._nodes = options[NODES]
        self._comments = Comments(options[COMMENTS])
        numbers = {p.name: number_of(set_parameters, p.name) for p in edition.parameters if not p.is_choice}
        self._numbers: dict[str, Fraction] = {name: fixed for name, fixed in numbers.items() if fixed is not None}
        self._signals = {direction: Signals(direction, self._numbers, self._comments) for direction in KIND}
        every_frame = {direction: frames(edition, direction, {}) for direction in KIND}
        ids = ({id_ for frame in of_one for _, id_ in frame.ids()} for of_one in every_frame.values())
        self._shared = set.intersection(*ids)
        used = tuple(direction for direction in KIND if every_frame[direction])
        self._groups = [(direction,) for direction in used] if self._shared else [used]
        self._tables = table_names(part for listed in every_frame.values() for frame in listed for part in frame.parts)

    def plain(self, assignment: Assignment) -> Iterator[File]:
        """The files of the first selector: one for each direction, or one for both if they share no id."""
        for group in self._groups:
            yield from self._file(group, assignment, "", self._plain_contents(group, assignment))

    def name_of_replies(self, assignment: Assignment) -> str | None:
        """The name of the file of the first selector that contains replies."""
        kinds = [KIND[group[0]] if len(group) == 1 else "" for group in self._groups if Direction.REPLY in group]
        return "-".join(filter(None, (self.name, *self.known(assignment), *kinds))) if kinds else None

    def tables(self, assignment: Assignment) -> Iterator[File]:
        """The files that read the selectors of a table as one number."""
        for group in self._groups:
            contents: dict[str, list[_Content]] = {}
            for name, content in self._table_contents(group, assignment):
                contents.setdefault(name, []).append(content)
            for name, parts in contents.items():
                yield from self._file(group, assignment, name, parts)

    def signals(self, assignment: Assignment) -> Iterator[Signal]:
        """The signals of all frames under some parameter values."""
        for group in self._groups:
            of_tables = (content for _, content in self._table_contents(group, assignment))
            for content in (*self._plain_contents(group, assignment), *of_tables):
                yield from content.signals

    def merged(self, same: Sequence[File]) -> Sequence[File]:
        """The files of a table for all values of the parameters; a single one if their messages are the same."""
        first = same[0]
        if len(same) < len(self.assignments) or any(file.messages != first.messages for file in same):
            return same
        comment = self._about({}, first.directions, first.table)
        return [first._replace(known=tuple(self.known({})), comment=comment)]

    def known(self, assignment: Assignment) -> Iterator[str]:
        """The parameter values in file names, with those that are set."""
        return known_values(self._edition, {**assignment, **self._numbers})

    def _plain_contents(self, group: Sequence[Direction], assignment: Assignment) -> Iterator[_Content]:
        for direction in group:
            for frame in frames(self._edition, direction, assignment):
                yield _Content(direction, frame, self._signals[direction].of(frame.parts, assignment))

    def _table_contents(self, group: Sequence[Direction], assignment: Assignment) -> Iterator[tuple[str, _Content]]:
        for direction in group:
            for frame in frames(self._edition, direction, assignment):
                by_name: dict[tuple[str, range], list[Part]] = {}
                for part in frame.parts:
                    if part.joined_span:
                        by_name.setdefault((self._tables[table_key(part)], part.joined_span), []).append(part)
                for (name, span), parts in by_name.items():
                    signals = self._signals[direction].joined(parts, assignment, span)
                    yield name, _Content(direction, frame._replace(parts=tuple(parts)), signals)

    def _file(
        self, group: tuple[Direction, ...], assignment: Assignment, table: str, contents: Iterable[_Content]
    ) -> Iterator[File]:
        """A file with these frames; none without messages."""
        messages = fitted(message for content in contents for message in self._messages(content, len(group) > 1))
        ends = [end for message in messages for end in (*message.senders, *message.receivers) if end != _NO_NODE]
        digest = self._edition.hash[:12]
        if messages:
            yield File(
                edition=self.name,
                known=tuple(self.known(assignment)),
                directions=group,
                table=table,
                variant=tuple(self._variant()),
                version=f"{self._edition.name[: _VERSION_LENGTH - len(digest) - 1]} {digest}",
                comment=self._about(assignment, group, table),
                nodes=tuple(dict.fromkeys((self._host, *ends))),
                messages=messages,
                frame_format=self._edition.bus.frame_format,
            )

    def _messages(self, content: _Content, with_direction: bool) -> Iterator[Message]:
        """One message for each node, named by direction and a code in the id, or by the command if there is no selector."""
        direction, frame, signals = content
        first = frame.parts[0]
        selected, of_both, alone = message_endings(first)
        is_of_both = with_direction and first.command.request and first.command.reply
        ending = selected if first.selectors else of_both if is_of_both else alone
        send_type, cycle_ms = sending.attributes(frame)
        for node, id_ in frame.ids(self._nodes):
            name = node_name(first.message.address, node)
            nodes: tuple[str, ...] = (fitting(name),)
            if node is None:
                ends = (
                    fitting(node_name(*end))
                    for part in frame.parts
                    for end in partners(self._edition, part, self._nodes)
                )
                nodes = tuple(dict.fromkeys(ends)) or (_NO_NODE,)
            is_request = direction is Direction.REQUEST
            yield Message(
                id=id_,
                name=f"{name}_{ending}",
                length=frame.length,
                shortest=frame.shortest,
                senders=(self._host,) if is_request else nodes,
                receivers=nodes if is_request else (self._host,),
                comment=self._comment(content, id_ in self._shared),
                signals=signals,
                send_type=send_type,
                cycle_ms=cycle_ms,
            )

    def _comment(self, content: _Content, is_shared: bool) -> str:
        comments, first = self._comments, content.frame.parts[0]
        address = self._edition.address(first.message.address)
        about = comments.of(first.command.title if not first.selectors else address.title)
        warning = comments.fixed("same_id", other=comments.fixed(KIND[_OTHER[content.direction]]))
        kind = comments.fixed(KIND[content.direction])
        times = sending.sentences(content.frame, comments)
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
        known = comments.listed(self.known(assignment))
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


def _assignments(edition: Edition, set_parameters: Assignment) -> Iterator[Assignment]:
    """The combinations of parameter values that have files of their own."""
    choices = []
    for parameter in (p for p in edition.parameters if p.is_choice):
        wanted = set_parameters.get(parameter.name)
        if wanted is not None or not parameter.is_numeric:
            choices.append([(parameter.name, v.name) for v in parameter.values if wanted in (None, v.name)])
    yield from map(dict, itertools.product(*choices))


TableKey = tuple[str, range | None]
"""The table of a part, and the bits of its selectors; without a table, the names of the selectors after the first."""


def table_key(part: Part) -> TableKey:
    """The table and the selector bits of a part whose selectors can be read as one number."""
    entry = part.command.entry
    return entry.table if entry else "-".join(key.name for key, _ in part.selectors[1:]), part.joined_span


def table_names(parts: Iterable[Part]) -> Mapping[TableKey, str]:
    """A unique name for each table, as in `stored-settings`.

    Entries of a table with longer selectors than others need a file of their own. The file with most entries, or with
    the shorter selectors, has the name of the table; another one adds the last word that its entries have in common, or a number.
    """
    by_table: dict[str, dict[TableKey, list[str]]] = {}
    for part in parts:
        if part.joined_span:
            key = table_key(part)
            name = part.command.entry.name if part.command.entry else part.command.name
            by_table.setdefault(key[0], {}).setdefault(key, []).append(name)
    names: dict[TableKey, str] = {}
    for table, keys in by_table.items():
        for i, (key, entries) in enumerate(
            sorted(keys.items(), key=lambda item: (-len(item[1]), len(item[0][1] or ())))
        ):
            ending = [_common_ending(entries) or str(i + 1)] if i else []
            name = "-".join([table, *ending]).replace("_", "-")
            numbered = (name if n == 1 else f"{name}-{n}" for n in itertools.count(1))
            names[key] = next(name for name in numbered if name not in names.values())
    return names


def _common_ending(names: Sequence[str]) -> str:
    last, *further = {name.rpartition("_")[2] for name in names}
    return "" if further else last
