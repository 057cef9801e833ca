"""The files of an edition, and the messages of each file for every node."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model.edition import Edition
from ...model.message import Direction
from ...model.types import Assignment, number_of
from ..options import NO_OPTIONS, Options
from .comments import ENGLISH, Comments
from .frames import Frame, Part, Scope, Traffic, partners
from .selection import COMMENTS, NODES
from .selectors import joined_span, table_key, table_names
from .signals import Signals
from .text import camel, fitting, number
from .view import KIND, File, Message, Signal, fitted

_OTHER = {Direction.REPLY: Direction.REQUEST, Direction.REQUEST: Direction.REPLY}
_NO_NODE = "Vector__XXX"
_VERSION_LENGTH = 32
"""A longer VERSION is an error in some readers, and so is a comma in it."""
_MAX_NODES_IN_NAME = 8


Traffics = Mapping[Direction, Traffic]


def traffics(edition: Edition) -> Traffics:
    """Both directions of an edition, in the order of their files."""
    return {direction: Traffic(edition, direction) for direction in KIND}


def files(edition: Edition, both: Traffics, set_parameters: Assignment, options: Options) -> Sequence[File]:
    """All files of an edition that contain frames: those of the first selector precede those of tables.

    Files of a table that are the same for every value of the parameters are one file.
    """
    made = _Files(edition, both, set_parameters, options)
    plain = [file for values in made.assignments for file in made.plain(values)]
    of_tables: dict[tuple[Sequence[Direction], str], list[File]] = {}
    for assignment in made.assignments:
        for file in made.tables(assignment):
            of_tables.setdefault((file.directions, file.table), []).append(file)
    return [*plain, *(file for same in of_tables.values() for file in made.merged(same))]


@functools.lru_cache(maxsize=4)
def _with_defaults(edition: Edition) -> _Files:
    return _Files(edition, traffics(edition), {}, NO_OPTIONS)


def reply_file(edition: Edition, assignment: Assignment) -> str | None:
    """The name of the first file that decodes replies under some parameter values; None without replies."""
    made = _with_defaults(edition)
    agreeing = (a for a in made.assignments if all(assignment.get(name, value) == value for name, value in a.items()))
    return made.name_of_replies(next(agreeing))


def stems(edition: Edition) -> Iterator[str]:
    """The first part of the names of files: the edition, and the parameter values that have files of their own."""
    for assignment in _assignments(edition, {}):
        yield "-".join((f"{edition.family}-{edition.name}", *_known(edition, assignment, {})))


def node_name(address: str, node: int | None) -> str:
    """The name of a node: the name of its address and its number."""
    number_ = "" if node is None else str(node)
    return fitting(camel(address), (), room=len(number_)) + number_


class _Content(NamedTuple):
    """A frame with its direction and signals."""

    direction: Direction
    frame: Frame
    signals: tuple[Signal, ...]


class _Files:
    """Builds the files of an edition."""

    def __init__(self, edition: Edition, both: Traffics, set_parameters: Assignment, options: Options) -> None:
        self._edition = edition
        self._both = both
        self._nodes = options[NODES]
        self._comments = Comments(options[COMMENTS])
        self._numbers: Mapping[str, Fraction] = {
            p.name: number
            for p in edition.parameters
            if not p.is_choice and (number := number_of(set_parameters, p.name)) is not None
        }
        self._signals = {direction: Signals(direction, self._numbers, self._comments) for direction in KIND}
        self.assignments = list(_assignments(edition, set_parameters))
        every_frame = {direction: traffic.frames({}) for direction, traffic in both.items()}
        every_node = Scope(edition, {}, self._numbers)
        ids = [{id_ for frame in frames for id_ in every_node.ids(frame)} for frames in every_frame.values()]
        self._shared = set.intersection(*ids)
        used = tuple(direction for direction in KIND if every_frame[direction])
        self._groups = [(direction,) for direction in used] if self._shared else [used]
        self._names = table_names(part for frames in every_frame.values() for frame in frames for part in frame.parts)

    def plain(self, assignment: Assignment) -> Iterator[File]:
        """The files of the first selector: one for each direction, or one for both if they share no id."""
        for group in self._groups:
            yield from self._file(group, assignment, "", list(self._plain_contents(group, assignment)))

    def name_of_replies(self, assignment: Assignment) -> str | None:
        """The name of the file of the first selector that contains replies."""
        names = f"{self._edition.family}-{self._edition.name}", *self._known(self._scope(assignment))
        groups = [group for group in self._groups if Direction.REPLY in group]
        kinds = [KIND[group[0]] if len(group) == 1 else "" for group in groups]
        return "-".join(filter(None, (*names, *kinds))) if groups else None

    def tables(self, assignment: Assignment) -> Iterator[File]:
        """The files that read the selectors of a table as one number."""
        for group in self._groups:
            contents: dict[str, list[_Content]] = {}
            for name, content in self._table_contents(group, assignment):
                contents.setdefault(name, []).append(content)
            for name, parts in contents.items():
                yield from self._file(group, assignment, name, parts)

    def merged(self, same: Sequence[File]) -> Sequence[File]:
        """The files of a table for all values of the parameters; a single one if their messages are the same."""
        first = same[0]
        if len(same) < len(self.assignments) or any(file.messages != first.messages for file in same):
            return same
        scope = self._scope({})
        comment = self._about(scope, first.directions, first.table)
        return [first._replace(known=tuple(self._known(scope)), comment=comment)]

    def _scope(self, assignment: Assignment) -> Scope:
        return Scope(self._edition, assignment, self._numbers, self._nodes)

    def _plain_contents(self, group: Sequence[Direction], assignment: Assignment) -> Iterator[_Content]:
        for direction in group:
            for frame in self._both[direction].frames(assignment):
                yield _Content(direction, frame, self._signals[direction].of(frame.parts, assignment))

    def _table_contents(self, group: Sequence[Direction], assignment: Assignment) -> Iterator[tuple[str, _Content]]:
        for direction in group:
            for frame in self._both[direction].frames(assignment):
                by_name: dict[str, list[Part]] = {}
                for part in frame.parts:
                    if joined_span(part):
                        by_name.setdefault(self._names[table_key(part)], []).append(part)
                for name, parts in by_name.items():
                    span = joined_span(parts[0])
                    assert span
                    signals = self._signals[direction].joined(parts, assignment, span)
                    yield name, _Content(direction, frame._replace(parts=tuple(parts)), signals)

    def _file(
        self, group: tuple[Direction, ...], assignment: Assignment, table: str, contents: Sequence[_Content]
    ) -> Iterator[File]:
        """A file with these frames; none without messages."""
        scope = self._scope(assignment)
        host = fitting(self._edition.bus.host, ())
        messages = fitted(
            message for content in contents for message in self._messages(scope, content, host, len(group) > 1)
        )
        ends = [end for message in messages for end in (*message.senders, *message.receivers) if end != _NO_NODE]
        if messages:
            yield File(
                f"{self._edition.family}-{self._edition.name}",
                tuple(self._known(scope)),
                group,
                table,
                tuple(self._variant()),
                _version(self._edition),
                self._about(scope, group, table),
                tuple(dict.fromkeys((host, *ends))),
                messages,
            )

    def _messages(self, scope: Scope, content: _Content, host: str, with_direction: bool) -> Iterator[Message]:
        """One message for each node, named by direction and a code in the id, or by the command if there is no selector."""
        direction, frame, signals = content
        first = frame.parts[0]
        kind = KIND[direction]
        ending = "_".join((kind, *first.codes_in_id)) if first.selectors else first.command.name
        if with_direction and not first.selectors and first.command.request and first.command.reply:
            ending = f"{ending}_{kind}"
        length = max(part.message.dlc for part in frame.parts)
        nodes_of_rule = scope.nodes(frame.rule)
        for node in (None,) if nodes_of_rule is None else nodes_of_rule:
            name = node_name(first.message.address, node)
            nodes: tuple[str, ...] = (name,)
            if node is None:
                ends = (node_name(*end) for part in frame.parts for end in partners(scope, part))
                nodes = tuple(dict.fromkeys(ends)) or (_NO_NODE,)
            is_request = direction is Direction.REQUEST
            id_ = frame.dbc_id(node)
            yield Message(
                id_,
                f"{name}_{ending}",
                length,
                frame.shortest,
                (host,) if is_request else nodes,
                nodes if is_request else (host,),
                self._comment(content, id_ in self._shared),
                signals,
            )

    def _comment(self, content: _Content, is_shared: bool) -> str:
        comments, first = self._comments, content.frame.parts[0]
        address = self._edition.address(first.message.address)
        about = comments.of(first.command.title if not first.selectors else address.title)
        warning = comments.fixed("same_id", other=comments.fixed(KIND[_OTHER[content.direction]]))
        kind = comments.fixed(KIND[content.direction])
        return comments.sentences([comments.labelled(about, kind), warning if is_shared else ""])

    def _known(self, scope: Scope) -> Iterator[str]:
        return _known(self._edition, scope.assignment, self._numbers)

    def _variant(self) -> Iterator[str]:
        """The selected nodes and the language, as parts of a file name."""
        nodes = self._nodes
        if nodes:
            listed = "_".join(map(str, nodes)) if len(nodes) <= _MAX_NODES_IN_NAME else f"{nodes[0]}_to_{nodes[-1]}"
            yield f"node{listed}"
        if self._comments.language != ENGLISH:
            yield self._comments.language

    def _about(self, scope: Scope, group: Sequence[Direction], table: str) -> str:
        """The comment of a file: its origin, and what it describes."""
        comments = self._comments
        known = comments.listed(self._known(scope))
        edition = self._edition
        sentences = [
            comments.fixed("made", family=edition.family, edition=edition.name, hash=edition.hash[:12]),
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


def _known(edition: Edition, assignment: Assignment, numbers: Mapping[str, Fraction]) -> Iterator[str]:
    """The parameter values in file names: a name alone, a number together with the name of its parameter."""
    for name, value in assignment.items():
        yield f"{name}_{value}" if edition.parameter(name).is_numeric else str(value)
    for name, fixed in numbers.items():
        yield f"{name}_{number(fixed)}"


def _version(edition: Edition) -> str:
    """The edition and the hash of its spec, as far as they fit."""
    digest = edition.hash[:12]
    return f"{edition.name[: _VERSION_LENGTH - len(digest) - 1]} {digest}"
