"""The files of an edition, and the messages of each file for every node."""

from __future__ import annotations

import itertools
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from ...language import notation
from ...model.edition import Edition
from ...model.message import Direction, IdRule
from ...model.types import Assignment
from ..base import header
from .frames import Frame, Part, Scope, Traffic, partners
from .selectors import joined_span
from .signals import Signals
from .text import camel, fitting, in_ascii, number
from .view import EXTENDED, File, Message, Signal, fitted

KIND = {Direction.REPLY: "reply", Direction.REQUEST: "command"}
"""Direction as it appears in names of files and messages."""

_OTHER = {Direction.REPLY: Direction.REQUEST, Direction.REQUEST: Direction.REPLY}
_NO_NODE = "Vector__XXX"


Traffics = Mapping[Direction, Traffic]


def traffics(edition: Edition) -> Traffics:
    """Both directions of an edition, in the order of their files."""
    return {direction: Traffic(edition, direction) for direction in KIND}


def files(edition: Edition, both: Traffics, set_parameters: Assignment) -> Iterator[File]:
    """All files of an edition that contain frames; files for all nodes precede those for the first node."""
    return (file for file in _files(edition, both, set_parameters) if file.messages)


def _files(edition: Edition, both: Traffics, set_parameters: Assignment) -> Iterator[File]:
    numbers = {
        p.name: notation.rational(set_parameters[p.name])
        for p in edition.parameters
        if not p.is_choice and p.name in set_parameters
    }
    signals = {direction: Signals(direction, numbers) for direction in KIND}
    for assignment in _assignments(edition, set_parameters):
        frames = {direction: one.frames(assignment) for direction, one in both.items()}
        for direction in KIND:
            scope = Scope(edition, direction, assignment, numbers)
            contents = list(_contents(frames[direction], signals[direction], assignment))
            shared = {(frame.rule, frame.id_bits) for frame in frames[_OTHER[direction]]}
            yield from (_file(scope, joined, (), found, shared) for joined, found in contents)
            nodes = next((m.id.nodes for m in edition.messages(direction) if m.id.nodes), None)
            if nodes and len(nodes) > 1:
                first = replace(scope, first_node_only=True)
                yield from (_file(first, joined, (f"node{nodes[0]}",), found, shared) for joined, found in contents)


def _assignments(edition: Edition, set_parameters: Assignment) -> Iterator[Assignment]:
    """The combinations of parameter values that have files of their own."""
    choices = []
    for parameter in (p for p in edition.parameters if p.is_choice):
        wanted = set_parameters.get(parameter.name)
        if wanted is not None or not parameter.is_numeric:
            choices.append([(parameter.name, v.name) for v in parameter.values if wanted in (None, v.name)])
    yield from map(dict, itertools.product(*choices))


def stems(edition: Edition) -> Iterator[str]:
    """The first part of the names of files: the edition, and the parameter values that have files of their own."""
    for assignment in _assignments(edition, {}):
        yield "-".join((f"{edition.family}-{edition.name}", *_known(edition, assignment, {})))


def node_name(address: str, node: int | None) -> str:
    """The name of a node: the name of its address and its number."""
    number_ = "" if node is None else str(node)
    return fitting(camel(address), (), room=len(number_)) + number_


Contents = Sequence[tuple[Frame, tuple[Signal, ...]]]
"""Frames with their signals."""


def _contents(frames: Sequence[Frame], signals: Signals, assignment: Assignment) -> Iterator[tuple[str, Contents]]:
    """The contents of the file of the first selector, and of one file for each span of selectors read as one number.

    Each comes with the part of the file name that names the joined selectors.
    """
    yield "", [(frame, signals.of(frame.parts, assignment)) for frame in frames]
    joined: dict[range, list[tuple[Frame, tuple[Signal, ...]]]] = {}
    names: dict[range, str] = {}
    for frame in frames:
        by_span: dict[range, list[Part]] = {}
        for one in frame.parts:
            span = joined_span(one)
            if span:
                by_span.setdefault(span, []).append(one)
        for span, parts in by_span.items():
            if span not in names:
                names[span] = fitting("-".join(key.name for key, _ in parts[0].selectors[1:]), names.values())
            read = signals.joined(parts, assignment, span)
            joined.setdefault(span, []).append((frame._replace(parts=tuple(parts)), read))
    for span, found in joined.items():
        yield names[span], found


def _file(
    scope: Scope, joined: str, part: tuple[str, ...], found: Contents, shared: Container[tuple[IdRule, int]]
) -> File:
    """A file with the frames `found`; `shared` are the ids that are also used by the other direction."""
    edition = scope.edition
    host = fitting(edition.bus.host, ())
    messages = fitted(
        message
        for frame, signals in found
        for message in _messages(scope, frame, host, signals, (frame.rule, frame.id_bits) in shared)
    )
    ends = [end for message in messages for end in (*message.senders, *message.receivers) if end != _NO_NODE]
    return File(
        f"{edition.family}-{edition.name}",
        tuple(_known(scope.edition, scope.assignment, scope.numbers)),
        KIND[scope.direction],
        joined,
        (*filter(None, [joined]), *part),
        header(edition),
        _about(scope),
        tuple(dict.fromkeys((host, *ends))),
        messages,
    )


def _messages(scope: Scope, frame: Frame, host: str, signals: tuple[Signal, ...], shared: bool) -> Iterator[Message]:
    """One message for each node, named by direction and a code in the id, or by the command if there is no selector."""
    first = frame.parts[0]
    address = first.message.address
    ending = "_".join((KIND[scope.direction], *first.codes_in_id)) if first.selectors else first.command.name
    length = max(part.message.dlc for part in frame.parts)
    comment = _comment(scope, frame, shared)
    for node in scope.nodes(frame.rule) or (None,):
        name = node_name(address, node)
        nodes: tuple[str, ...] = (name,)
        if node is None:
            ends = (node_name(*end) for part in frame.parts for end in partners(scope, part))
            nodes = tuple(dict.fromkeys(ends)) or (_NO_NODE,)
        is_request = scope.direction is Direction.REQUEST
        yield Message(
            frame.id(node) | (EXTENDED if frame.rule.extended else 0),
            f"{name}_{ending}",
            length,
            (host,) if is_request else nodes,
            nodes if is_request else (host,),
            comment,
            signals,
        )


def _comment(scope: Scope, frame: Frame, shared: bool) -> str:
    first = frame.parts[0]
    address = scope.edition.address(first.message.address)
    about = first.command.title if not first.selectors else address.title
    warning = f" A {KIND[_OTHER[scope.direction]]} has the same id." if shared else ""
    return f"{in_ascii(about)}: {KIND[scope.direction]}.{warning}"


def _known(edition: Edition, assignment: Assignment, numbers: Mapping[str, Fraction]) -> Iterator[str]:
    """The parameter values in file names: a name alone, a number together with the name of its parameter."""
    for name, value in assignment.items():
        yield f"{name}_{value}" if edition.parameter(name).is_numeric else value
    for name, fixed in numbers.items():
        yield f"{name}_{number(fixed)}"


def _about(scope: Scope) -> str:
    kind, other = KIND[scope.direction], KIND[_OTHER[scope.direction]]
    known = "".join(f", {word}" for word in _known(scope.edition, scope.assignment, scope.numbers))
    return (
        f"{scope.edition.family} {scope.edition.name}{known}: {kind} frames only. "
        f"DBC files do not specify directions: a {other} frame decoded with this file shows meaningless values."
    )
