"""Frames that are safe to send to a node of an unknown edition, and what each edition replies."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Space
from ...model.message import Command, Message
from ...model.metadata import Neighbour
from ...semantics.encoder import Encoder
from ...semantics.frame import CanFrame
from ...semantics.plan import message_plan
from ...templating.markup import code, markdown
from .links import COMMANDS, command_page

Listed = Sequence[tuple[str, Edition]]


class Answer(NamedTuple):
    """What an edition replies to a probe; the cells are Markdown."""

    edition: Edition
    folder: str
    reply_id: str
    fields: str


class Outcome(NamedTuple):
    """A reply that leaves some editions: its id and, where it decides, whether a byte is 0; the cells are Markdown."""

    reply_id: str
    byte: str
    is_zero: bool
    answers: Sequence[Answer]


class Probe(NamedTuple):
    """A request that only reads, as a frame to node 1, in Markdown, and the replies of the editions that have it."""

    frame: str
    command: str
    answers: Sequence[Answer]
    outcomes: Sequence[Outcome]
    neighbours: Sequence[Neighbour]
    """Ids that belong to others in each of these editions."""

    @property
    def bytes(self) -> Sequence[str]:
        """The bytes of the reply that decide between editions."""
        return list(dict.fromkeys(outcome.byte for outcome in self.outcomes if outcome.byte))


def probes(listed: Listed) -> Iterator[Probe]:
    """For each family with several editions: the read that all have, then one for each edition that it cannot decide."""
    for family in dict.fromkeys(edition.family for _, edition in listed):
        members = [(folder, edition) for folder, edition in listed if edition.family == family]
        reads = {edition: _reads(edition) for _, edition in members}
        common = [frame for frame in reads[members[0][1]] if all(frame in own for own in reads.values())]
        if len(members) < 2 or not common:
            continue
        first = max(common, key=lambda frame: len({_signature(own[frame]) for own in reads.values()}))
        yield _probe(first, members, reads)
        for pair in itertools.combinations(members, 2):
            if _signature(reads[pair[0][1]][first]) == _signature(reads[pair[1][1]][first]):
                yield from itertools.islice(_deciding(pair, reads), 1)


def _deciding(pair: Listed, reads: Mapping[Edition, Mapping[CanFrame, Command]]) -> Iterator[Probe]:
    """Probes that one of two editions replies to, and that the other does not have in any direction."""
    for having, lacking in (pair[::-1], pair):
        codes = {command.code for command in lacking[1].commands}
        for frame, command in reads[having[1]].items():
            if command.code not in codes:
                yield _probe(frame, [having], reads)


def _probe(frame: CanFrame, members: Listed, reads: Mapping[Edition, Mapping[CanFrame, Command]]) -> Probe:
    folder, edition = members[-1]
    command = reads[edition][frame]
    replies = [(_answer(folder, edition, reply), reply) for folder, edition, reply in _replies(frame, members, reads)]
    return Probe(
        code(formatting.sent(frame)),
        f"[{markdown(command.name)}]({folder}/{COMMANDS}{command_page(command)})",
        [answer for answer, _ in replies],
        list(_outcomes(replies)),
        [n for n in edition.bus.neighbours if all(n.ids in _foreign_ids(own) for _, own in members)],
    )


def _foreign_ids(edition: Edition) -> Sequence[range]:
    return [neighbour.ids for neighbour in edition.bus.neighbours]


def _replies(
    frame: CanFrame, members: Listed, reads: Mapping[Edition, Mapping[CanFrame, Command]]
) -> Iterator[tuple[str, Edition, Message]]:
    for folder, edition in members:
        reply = reads[edition][frame].reply
        assert reply is not None
        yield folder, edition, reply


def _outcomes(replies: Sequence[tuple[Answer, Message]]) -> Iterator[Outcome]:
    """The editions by the id of the reply, and by the first byte that is always 0 in some of them only."""
    for reply_id in dict.fromkeys(answer.reply_id for answer, _ in replies):
        used = {answer: _used_bytes(reply) for answer, reply in replies if answer.reply_id == reply_id}
        shared = range(min(reply.dlc for answer, reply in replies if answer in used))
        byte = next((n for n in shared if len({n in own for own in used.values()}) > 1), None)
        if byte is None:
            yield Outcome(reply_id, "", False, list(used))
            continue
        for is_zero in (True, False):
            answers = [answer for answer, own in used.items() if (byte not in own) is is_zero]
            yield Outcome(reply_id, code(f"DATA[{byte}]"), is_zero, answers)


def _used_bytes(message: Message) -> set[int]:
    """The data bytes of a message that are not always 0."""
    sent = message_plan(message).sent
    fields = (field for field in message.layout.fields if field.space is Space.DATA and sent.get(field) != 0)
    runs = [element.segments for field in fields for element in field.elements]
    runs += [key.segments for key in message.keys if key.space is Space.DATA]
    return {segment.byte for segments in runs for segment in segments}


def _answer(folder: str, edition: Edition, reply: Message) -> Answer:
    return Answer(
        edition,
        folder,
        code(formatting.id_rule(reply.id)),
        ", ".join(f"{code(name)} {place}" for name, place in _places(reply)),
    )


def _places(message: Message) -> Iterator[tuple[str, str]]:
    """The fields of a message with their bits, and their resolution if there is one for all."""
    for field in message.layout.fields:
        scales = formatting.scale(field.type) if field.type.is_number and not field.type.is_bare_float else []
        step = f" × {scales[0][1]}" if len(scales) == 1 and field.type.unit else ""
        yield field.name, code(formatting.field_places(field)[0].position + step)


def _reads(edition: Edition) -> Mapping[CanFrame, Command]:
    """The requests to node 1 that have no values, no effects and a reply with fields, with their commands."""
    reads: dict[CanFrame, Command] = {}
    for command in edition.commands:
        request, reply = command.request, command.reply
        if request is None or reply is None or command.effects or command.is_echoed or not command.implemented:
            continue
        if request.layout.fields or not reply.layout.fields or request.id.nodes is None or 1 not in request.id.nodes:
            continue
        frame = Encoder({}).encode_raws(request, 1, {})
        if isinstance(frame, CanFrame):
            reads.setdefault(frame, command)
    return reads


def _signature(command: Command) -> tuple[object, ...]:
    """What the reply to a command shows: its id and its fields."""
    assert command.reply is not None
    return command.reply.id, tuple(_places(command.reply))
