"""Simulates exchanges between an old host and a new node: which message each frame is, and whether a reply answers.

The id, the other distinguishing bits, and the fields are compared one after the other: a frame whose id is another in
the other edition is also tried with the correct id, and fields are compared as if the message had been identified.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.message import Command, Direction, IdRule, Message
from ...model.refusal import Refusal
from ...model.types import Assignment
from ...semantics.decoder import Decoder, Identified, Rejection, rejects_checked
from ...semantics.encoder import Encoder
from ...semantics.exchange import check_reply
from ...semantics.frame import CanFrame, raw_of
from ..change import Impact, Keyword, SentenceArgument, Side
from ..forms import is_emptied
from ..match import Matched
from . import candidates, paths
from .assignments import Assignments
from .candidates import Sender
from .field_comparison import MessagePair, parameters_of, shown
from .nodes import Nodes
from .witness import Witness, sentence

MAX_NODES = 64
"""So many nodes are tried where an id rule differs: the first ones, and as many of the last ones."""


class _Case(NamedTuple):
    """A command of both editions on one side; one of them is None if only the other edition has it."""

    side: Side
    old: Command | None
    new: Command | None

    @property
    def both(self) -> tuple[Command, ...]:
        return tuple(command for command in (self.old, self.new) if command is not None)

    @property
    def parameters(self) -> tuple[str, ...]:
        layouts = [m.layout.parameter for c in self.both for m in c.messages]
        return tuple(dict.fromkeys((*(p for p in layouts if p), *(p for c in self.both for p in c.only))))


class _Transfer(NamedTuple):
    """A message of a case that is sent under some parameters, and the one that is expected; None without one."""

    case: _Case
    sent: Message
    read: Message | None
    known: Assignment
    encoder: Encoder

    @property
    def is_request(self) -> bool:
        return self.case.side is Side.SENDING


class _Trial(NamedTuple):
    """A frame that is given to the receiver, with its node, and whether the sender sends it.

    Where it is `is_of_id`, only the node and the address are compared.
    """

    node: int | None
    frame: CanFrame
    exists: bool = True
    is_of_id: bool = False


class _Outcome(NamedTuple):
    """What the receiver makes of a frame: it takes it for a message, perhaps of another node, or rejects it for a reason."""

    known: Message | None = None
    node: int | None = None
    refusal: Refusal | None = None


class ExchangeSimulation:
    """Observes both directions between an old host and a new node, whose commands are `matched`."""

    def __init__(self, old: Edition, new: Edition, matched: Matched[Command]) -> None:
        self._matched = matched
        self._counterparts = dict((*matched.pairs, *((after, before) for before, after in matched.pairs)))
        self._assignments = Assignments(old, new)
        self._nodes = Nodes(old, new)
        self._editions = {Side.SENDING: (old, new), Side.RECEIVING: (new, old)}
        decoders = Decoder(old), Decoder(new)
        self._decoders = {Side.SENDING: decoders, Side.RECEIVING: decoders[::-1]}
        """The decoders of the sender and of the receiver."""

    def witnesses(self) -> Iterator[Witness]:
        """Every witness that was found."""
        for old, new in self._matched.pairs:
            yield from self._available(_Case(Side.SENDING, old, new))
            yield from self._sending(_Case(Side.SENDING, old, new))
            yield from self._receiving(_Case(Side.RECEIVING, old, new))
        for old in self._matched.removed:
            if old.request is not None:
                yield from self._identified(_Case(Side.SENDING, old, None), old.request, None)
            elif old.reply is not None:
                of_existence = paths.of_existence(old, old.reply)
                yield self._absent(_Case(Side.RECEIVING, old, None), "received-removed", old.reply, {}, of_existence)
        for new in self._matched.added:
            if new.request is None and new.reply is not None:
                yield from self._identified(_Case(Side.RECEIVING, None, new), new.reply, None)

    def _sending(self, case: _Case) -> Iterator[Witness]:
        old, new = case.both
        if old.request is None:
            return
        yield from self._identified(case, old.request, new.request)
        if new.request is not None:
            yield from self._read(case, old.request, new.request)

    def _receiving(self, case: _Case) -> Iterator[Witness]:
        old, new = case.both
        if old.reply is None:
            if new.reply is not None:
                yield from self._identified(case, new.reply, None)
        elif new.reply is None:
            if old.request is None:
                yield self._absent(case, "received-removed", old.reply)
            else:
                request = self._first(old.request)
                yield self._made(case, "sent-unanswered", request, {"sent": f"`{old.name}`"})
        else:
            if old.request is None and new.request is not None:
                yield self._absent(case, "received-missing", old.reply)
            if not self._has_same_form(old, new, new.reply, old.reply):
                yield from self._of_other_form(case, new.reply, old.reply)
                return
            yield from self._identified(case, new.reply, old.reply)
            yield from self._no_longer_accepted(case, old.reply, new.reply)
            if old.request is not None and new.request is not None:
                yield from self._answers(case, old.request, old.reply, new.reply)
                yield from self._others(case, old, new)
            is_echoed = old.is_echoed and new.is_echoed  # then it has the constants of the old host
            read = self._read(case, new.reply, old.reply)
            yield from (witness for witness in read if not (is_echoed and witness.impact is Impact.LOUD))

    def _no_longer_accepted(self, case: _Case, old: Message, new: Message) -> Iterator[Witness]:
        """A reply with a further code that hosts of the new edition reject."""
        encoder, host = self._assignments.encoder(), self._decoders[Side.RECEIVING][0]
        node = self._common_node(old, new)
        frames = itertools.islice(Sender(encoder, old, node).samples(), 1)
        for reply in (candidates.with_first_key(old, frame, code) for frame in frames for code in old.accepted_codes):
            placed = _moved(reply, old.id, new.id, node)
            judged = None if placed is None else host.decode_as(new, placed, encoder.assignment)
            if isinstance(judged, Rejection) and judged.reason is Refusal.UNKNOWN_CODE:
                facts = {"sent": f"`{old.command}`", "reason": _reason(judged.reason.value)}
                of_identity = (*paths.of_identity(case.both[0], old), *paths.of_identity(case.both[1], new))
                yield self._made(case, "received-dropped", reply, facts, concerned=of_identity, exists=placed == reply)
                return

    def _others(self, case: _Case, old: Command, new: Command) -> Iterator[Witness]:
        """The replies besides the first that the old host does not know, and those for which it waits in vain."""
        (sender, receiver), request = self._editions[Side.RECEIVING], old.request
        known = {self._counterparts.get(receiver.command(reply.message.command)) for reply in old.replies}
        for reply in new.replies[1:]:
            if request is not None and sender.command(reply.message.command) not in known:
                node = self._nodes.first(request, reply.message)
                frame = next(Sender(self._assignments.encoder(), reply.message, node).samples(), None)
                facts = {"sent": f"`{reply.message.command}`", "reason": _reason("not_answer")}
                key = "alternative_replies" if reply.is_alternative else "further_replies"
                yield self._made(case, "received-rejected", frame, facts, concerned=[(*old.path, key)])
        sent = {sender.command(reply.message.command) for reply in new.replies}
        for reply in old.further_replies:
            if self._counterparts.get(receiver.command(reply.message.command)) not in sent:
                concerned = [(*old.path, "further_replies")]
                yield self._absent(case, "received-removed", reply.message, concerned=concerned)

    def _of_other_form(self, case: _Case, sent: Message, read: Message) -> Iterator[Witness]:
        """What the old host makes of a reply of another form, judged as a whole."""
        old, new = case.both
        accepted, rejected = self._answers_of_other_form(old, new, sent, read)
        identified = self._identified(case, sent, read)
        yield from (witness for witness in identified if not (accepted and witness.impact is Impact.LOUD))
        if rejected is not None:
            frame, rejection, exists = rejected
            facts = {"sent": f"`{sent.command}`", "reason": _reason(rejection.reason.value)}
            of_answer = self._of_answer(case)
            yield self._made(case, "received-rejected", frame, facts, concerned=of_answer, exists=exists)
        if accepted:
            yield from self._read(case, sent, read)

    def _available(self, case: _Case) -> Iterator[Witness]:
        """The parameter values under which only the old edition has a command."""
        old, new = case.both
        if old.only == new.only:
            return
        of_availability = [path for command in case.both for path in paths.of_availability(command)]
        for assignment in self._assignments.of((*old.only, *new.only)):
            if old.available(assignment) and not new.available(assignment):
                if old.request is not None:
                    frame, facts = self._first(old.request), {"sent": f"`{old.name}`"}
                    yield self._made(case, "sent-unavailable", frame, facts, assignment, of_availability)
                elif old.reply is not None:
                    missing = case._replace(side=Side.RECEIVING)
                    yield self._absent(missing, "received-removed", old.reply, assignment, of_availability)

    def _read(self, case: _Case, sent: Message, read: Message) -> Iterator[Witness]:
        pair = MessagePair(
            assignments=self._assignments,
            side=case.side,
            commands=self._groups(case),
            of_use=frozenset((*self._of_use(case), sent.path, read.path)),
            available=[command.only for command in case.both],
            sent=sent,
            read=read,
            nodes=self._nodes.of(sent),
            has_same_origin=self._has_same_origin(case.side, sent, read),
            receiver=self._decoders[case.side][1],
        )
        yield from pair.witnesses()

    def _has_same_origin(self, side: Side, sent: Message, read: Message) -> bool:
        """Whether two messages are the same one, not the replies of different commands, or an echo in one edition."""
        sender, receiver = (e.command(m.command) for e, m in zip(self._editions[side], (sent, read), strict=True))
        return self._counterparts.get(sender) is receiver and sender.is_echoed == receiver.is_echoed

    def _answers_of_other_form(
        self, old: Command, new: Command, sent: Message, read: Message
    ) -> tuple[bool, tuple[CanFrame, Rejection, bool] | None]:
        """Whether the old host accepts a reply as an answer, and one that it rejects, with whether it is sent so."""
        host, accepted, rejected = self._decoders[Side.SENDING][0], False, None
        for asked, node, reply in self._exchanges(old, new, sent, read):
            ids = (sent.id, read.id) if sent.address == read.address else (sent.id, sent.id)
            placed = _moved(reply, *ids, node) or reply
            answer = check_reply(host, asked, placed)
            wrong = answer if isinstance(answer, Rejection) else rejects_checked(read, placed, self._assignments.first)
            accepted = accepted or wrong is None
            rejected = rejected or (placed, wrong, placed == reply) if wrong is not None else rejected
        return accepted, rejected

    def _has_same_form(self, old: Command, new: Command, sent: Message, read: Message) -> bool:
        if old.request is None or new.request is None:
            return True
        return self._has_same_origin(Side.RECEIVING, sent, read) and not is_emptied(read, sent)

    def _exchanges(
        self, old: Command, new: Command, sent: Message, read: Message
    ) -> Iterator[tuple[CanFrame, int | None, CanFrame]]:
        """Requests of the old host with a node and its reply; for an echo also replies with the data of the request."""
        encoder = self._assignments.encoder()
        if old.request is None:
            return
        node = self._nodes.first(old.request, sent, read)
        sender = Sender(encoder, sent, node)
        for asked in Sender(encoder, old.request, node).variations():
            for reply in self._replies(encoder, new, asked, node):
                yield asked, node, reply
                same = CanFrame(reply.id, asked.data, reply.extended, reply.remote)
                if old.is_echoed and sender.sends(self._decoders[Side.RECEIVING][0], same):
                    yield asked, node, same
            if new.is_echoed:  # a node may build it from the fields, with codes where replies have them
                yield from ((asked, node, frame) for frame in sender.variations())

    def _identified(self, case: _Case, sent: Message, read: Message | None) -> Iterator[Witness]:
        """The frames of a message that are another message, or none; with the correct id, and with the sender's."""
        by_id = self._frames_of_ids(sent, read)  # no parameter that varies here affects an id, so they are tried once
        for assignment in self._assignments.of(case.parameters):
            if not all(command.available(assignment) for command in case.both):
                continue
            seen: set[object] = set()
            for known in (assignment, *self._with_other_ranges(assignment, sent)):
                transfer = _Transfer(case, sent, read, known, self._assignments.encoder(known))
                for trial in itertools.chain(self._frames(transfer), by_id):
                    outcome = self._outcome(transfer, trial)
                    if outcome is None:
                        continue
                    further = self._further(case, outcome)
                    kind = (trial.is_of_id, outcome.refusal is None, self._groups(case, further))
                    if kind not in seen:
                        seen.add(kind)
                        witness = self._witness(transfer, trial, outcome)
                        yield witness
                        if not trial.is_of_id:
                            yield from self._answer_of_another(transfer, witness)

    def _with_other_ranges(self, assignment: Assignment, sent: Message) -> Iterator[Assignment]:
        """`assignment` with other values of the parameters that ranges of the fields of a message depend on."""
        names = [field.type.raw_range.parameter for field in sent.layout.fields]
        further = [name for name in names if name is not None and name not in assignment]
        yield from ({**assignment, **more} for more in self._assignments.of(further) if more)

    def _answer_of_another(self, transfer: _Transfer, misread: Witness) -> Iterator[Witness]:
        """What the old host makes of the reply to a request that the new node takes for another command's."""
        (case, _, _, assignment, encoder), asked, old = transfer, misread.frame, transfer.case.old
        if not transfer.is_request or asked is None or old is None:
            return
        if misread.impact is not Impact.SILENT:  # rejected, perhaps because of a constant
            return
        host, receiver = self._decoders[Side.SENDING]
        understood = candidates.message_of(receiver, Direction.REQUEST, asked)
        if understood is None or old.reply is None or old.request is None:
            return
        command = self._editions[Side.SENDING][1].command(understood.command)
        back = case._replace(side=Side.RECEIVING)
        node = self._nodes.first(old.request, understood, old.reply, *(r.message for r in command.replies))
        reply = self._reply(encoder, command, asked, node)
        if reply is None or command.reply is None:
            facts: dict[str, SentenceArgument] = {"sent": f"`{old.name}`"}
            yield self._made(back, "sent-unanswered", asked, facts, assignment, misread.paths, (command,))
            return
        original = _moved(asked, understood.id, old.request.id, node)
        placed = _moved(reply, command.reply.id, old.reply.id, node)
        if original is None or placed is None:
            return
        facts = {"sent": _whole(command.reply, encoder, reply)}
        exists, known = placed == reply and original == asked, _stated(assignment, encoder, command.reply, old.reply)
        if isinstance(check_reply(host, original, placed), Rejection):
            facts["reason"], about = _reason("not_answer"), "received-rejected"
        elif self._counterparts.get(self._editions[Side.SENDING][1].command(command.reply.command)) is not (
            self._editions[Side.SENDING][0].command(old.reply.command)
        ):
            facts["read"], about = _whole(old.reply, encoder, placed), "received-read"
        else:
            return
        yield self._made(back, about, placed, facts, known, misread.paths, (command,), exists=exists)

    def _frames(self, transfer: _Transfer) -> Iterator[_Trial]:
        """Frames of a message for all decisions: with the ids of the receiver, if it uses the same address."""
        case, sent, read, _, encoder = transfer
        direction, (decoder, receiver) = sent.direction, self._decoders[case.side]
        common = self._common_node(sent, read or sent)
        sender = Sender(encoder, sent, common)
        for frame in sender.samples():
            has_same_address = read is not None and read.address == sent.address
            placed = _moved(frame, sent.id, read.id, common) if read is not None and has_same_address else frame
            if placed is None:
                continue
            for candidate in candidates.reaching(receiver, direction, placed, sender.variable_bits):
                original = CanFrame(frame.id, candidate.data, frame.extended, frame.remote)
                if transfer.is_request and candidates.message_of(decoder, Direction.REQUEST, original) is not sent:
                    continue
                if sender.sends(decoder, original):
                    yield _Trial(common, candidate, exists=candidate == original)
                    for code in sent.accepted_codes:
                        accepted = candidates.with_first_key(sent, candidate, code)
                        yield _Trial(common, accepted, exists=candidate == original)

    def _frames_of_ids(self, sent: Message, read: Message | None) -> Iterator[_Trial]:
        """Frames of a message with the ids of the sender, if those of the receiver differ."""
        if read is not None and read.id != sent.id:
            for node in _nodes(sent.id):
                base = next(Sender(self._assignments.encoder(), sent, node).samples(), None)
                if base is not None:
                    yield _Trial(node, base, is_of_id=True)

    def _outcome(self, transfer: _Transfer, trial: _Trial) -> _Outcome | None:
        """What the receiver makes of a frame; None if it is the expected message of the same node."""
        case, sent, read, _, encoder = transfer
        node, frame, receiver = trial.node, trial.frame, self._decoders[case.side][1]
        result = receiver.identify(sent.direction, frame)
        if isinstance(result, Identified):
            if result.message in self._expected(transfer, frame):
                if node is None or result.node is None or node == result.node:
                    return None
                return _Outcome(result.message, result.node)
            if (
                read is not None
                and not transfer.is_request
                and not isinstance(receiver.decode_as(read, frame, encoder.assignment), Rejection)
            ):  # it takes the same frame of an old node for another message, too
                return None
            wrong = rejects_checked(result.message, frame, encoder.assignment)
            if wrong is None:
                return _Outcome(result.message)
            result = wrong
        if read is None and not transfer.is_request:
            return None
        return _Outcome(refusal=result.reason)

    def _further(self, case: _Case, outcome: _Outcome) -> list[Command]:
        """The command of the message for which the receiver takes a frame."""
        return [] if outcome.known is None else [self._editions[case.side][1].command(outcome.known.command)]

    def _witness(self, transfer: _Transfer, trial: _Trial, outcome: _Outcome) -> Witness:
        """The witness of a frame that is not the expected message of the same node."""
        (case, sent, _, assignment, encoder), (known, node, refusal) = transfer, outcome
        facts: dict[str, SentenceArgument] = {"sent": self._sent(transfer, trial)}
        if node is not None:
            facts["sent"] = (f"`{sent.command}`, ", Keyword("node"), f" {trial.node}")
            facts["read"] = (Keyword("node"), f" {node}")
        elif known is not None:
            facts["read"] = _whole(known, encoder, trial.frame)
        elif refusal is not None:
            facts["reason"] = _reason(refusal.value)
        about = sentence(case.side, "read" if refusal is None else "rejected")
        stated = _stated(assignment, encoder, *filter(None, (sent, known)))
        of_frame, further = self._of_frame(transfer, trial, known), self._further(case, outcome)
        return self._made(case, about, trial.frame, facts, stated, of_frame, further, exists=trial.exists)

    def _of_frame(self, transfer: _Transfer, trial: _Trial, known: Message | None) -> Iterator[DocumentPath]:
        """What decides which message a frame is, which is sent and expected as some messages, and `known` as another."""
        case, sent, read, _, _ = transfer
        sender, receiver = self._editions[case.side]
        ends = [(sender, sent), *((receiver, message) for message in (read, known) if message is not None)]
        has_same_address = all(message.address == sent.address for _, message in ends)
        for edition, message in ends:
            command = edition.command(message.command)
            if trial.is_of_id or not has_same_address:
                yield from paths.of_id(command, message)
            if read is None:
                yield from paths.of_existence(command, message)
            if not trial.is_of_id:
                yield from paths.of_identity(command, message)

    def _of_answer(self, case: _Case) -> Iterator[DocumentPath]:
        """What decides whether a reply answers a request."""
        for command in case.both:
            yield (*command.path, "reply", "from_each")
            for message in command.messages:
                yield from paths.of_identity(command, message)
                yield from paths.of_id(command, message)
                yield from paths.of_node(message)

    def _sent(self, transfer: _Transfer, trial: _Trial) -> SentenceArgument:
        message, encoder = transfer.sent, transfer.encoder
        decoded = self._decoders[Side.SENDING][0].decode_as(message, trial.frame, encoder.assignment)
        is_name = isinstance(decoded, Rejection) or trial.is_of_id
        return f"`{message.command}`" if is_name else _whole(message, encoder, trial.frame)

    def _expected(self, transfer: _Transfer, frame: CanFrame) -> Sequence[Message]:
        """The messages as which the receiver may decode a frame: some replies are identified only by their request."""
        (side, *_), sent, read, _, encoder = transfer
        expected = [] if read is None else [read]
        if side is Side.SENDING:
            return expected
        sender, receiver = self._decoders[side]
        if read is not None:
            node = self._common_node(read, read)
            own = next(Sender(encoder, read, node).samples(), None)
            alone = own and candidates.message_of(receiver, Direction.REPLY, own)
            expected += [alone] if alone else []
        alone = candidates.message_of(sender, Direction.REPLY, frame)
        for message in (sent, *((alone,) if alone is not None else ())):
            counterpart = self._counterparts.get(self._editions[side][0].command(message.command))
            expected += [counterpart.reply] if counterpart and counterpart.reply else []
        return expected

    def _answers(self, case: _Case, request: Message, read: Message, sent: Message) -> Iterator[Witness]:
        """The replies of the new node that the old host does not accept as answers to its request."""
        old, new = case.both
        if set(old.from_each) != set(new.from_each):
            yield from self._repliers(case, old, new)
            return
        host = self._decoders[Side.SENDING][0]
        for assignment in self._assignments.of(case.parameters):
            encoder = self._assignments.encoder(assignment)
            node = self._nodes.first(request, sent, read)
            asked = next(Sender(encoder, request, node).samples(), None)
            repliers = new.from_each[:1] or self._asked(new, node)
            own = self._reply(encoder, old, asked, repliers[0])
            if asked is None or own is None or isinstance(check_reply(host, asked, own), Rejection):
                continue
            replies = (
                (replier, variant)
                for replier in repliers
                for reply in self._replies(encoder, new, asked, replier)
                for variant in (reply, *(candidates.with_first_key(sent, reply, code) for code in sent.accepted_codes))
            )
            for replier, reply in replies:
                placed = _moved(reply, sent.id, read.id, replier)
                judged = None if placed is None else check_reply(host, asked, placed)
                if placed is not None and isinstance(judged, Rejection):
                    facts = {"sent": f"`{new.name}`", "reason": _reason(judged.reason.value)}
                    of_answer, exists = self._of_answer(case), placed == reply
                    yield self._made(case, "received-rejected", placed, facts, assignment, of_answer, exists=exists)
                    break

    def _asked(self, command: Command, node: int | None) -> Sequence[int | None]:
        """The nodes that may reply to a request: the node that it asks, or any if it asks none."""
        request, reply = command.request, command.reply
        nodes = self._nodes.of(reply) if reply is not None else None
        if nodes is None or request is None or request.id.nodes is not None or request.node_bits is not None:
            return [node]
        return list(dict.fromkeys([node, nodes[0], nodes[-1]]))

    def _reply(self, encoder: Encoder, command: Command, asked: CanFrame | None, node: int | None) -> CanFrame | None:
        return None if asked is None else next(iter(self._replies(encoder, command, asked, node)), None)

    def _replies(self, encoder: Encoder, command: Command, asked: CanFrame, node: int | None) -> Iterator[CanFrame]:
        """Replies to a request: its echo, or frames with different values of the first fields."""
        if command.reply is not None:
            for frame in Sender(encoder, command.reply, node).variations():
                same = command.is_echoed and len(frame.data) == len(asked.data)
                yield CanFrame(frame.id, asked.data if same else frame.data, frame.extended, frame.remote)
                if command.is_echoed:
                    return

    def _repliers(self, case: _Case, old: Command, new: Command) -> Iterator[Witness]:
        """The nodes whose replies are missing or unexpected."""
        missing = [n for n in old.from_each if n not in new.from_each] or (
            [] if old.from_each else [n for n in _nodes(new.replies[0].message.id) if n is not None][:1]
        )
        unexpected = [n for n in new.from_each if n not in old.from_each]
        for nodes, about in ((missing, "received-removed"), (unexpected, "received-rejected")):
            for node in nodes[:1]:
                name: SentenceArgument = (f"`{new.name}`, ", Keyword("node"), f" {node}")
                facts: dict[str, SentenceArgument] = {"read": name, "sent": name, "reason": _reason("not_answer")}
                yield self._made(case, about, None, facts, concerned=self._of_answer(case))

    def _common_node(self, first: Message, second: Message) -> int | None:
        """A node that two messages have, of the first if it is the only one with nodes."""
        nodes = self._nodes.of(first)
        return (
            None if nodes is None else nodes[0] if self._nodes.of(second) is None else self._nodes.first(first, second)
        )

    def _owners(self, case: _Case) -> Iterator[str]:
        """The commands whose replies those of a case are."""
        for edition, command in zip(self._editions[Side.SENDING], (case.old, case.new), strict=True):
            if command is not None and command.reply is not None:
                yield edition.command(command.reply.command).spec_name

    def _absent(
        self,
        case: _Case,
        about: str,
        read: Message,
        assignment: Assignment | None = None,
        concerned: Iterable[DocumentPath] = (),
    ) -> Witness:
        return self._made(case, about, None, {"read": f"`{read.command}`"}, assignment, concerned)

    def _first(self, message: Message) -> CanFrame | None:
        encoder = self._assignments.encoder()
        return next(Sender(encoder, message, self._common_node(message, message)).samples(), None)

    def _groups(self, case: _Case, other_commands: Iterable[Command] = ()) -> tuple[str, ...]:
        """The commands that a witness of a case is about, and those whose replies theirs are."""
        commands = (*case.both, *other_commands)
        return tuple(dict.fromkeys((*(command.spec_name for command in commands), *self._owners(case))))

    def _of_use(self, case: _Case) -> Iterator[DocumentPath]:
        direction = Direction.REQUEST if case.side is Side.SENDING else Direction.REPLY
        return (path for command in case.both for path in paths.of_use(command, direction))

    def _made(
        self,
        case: _Case,
        about: str,
        frame: CanFrame | None,
        facts: Mapping[str, SentenceArgument],
        assignment: Assignment | None = None,
        concerned: Iterable[DocumentPath] = (),
        further: Iterable[Command] = (),
        *,
        exists: bool = True,
    ) -> Witness:
        """A witness about the commands of a case and `further`, and about the `concerned` paths."""
        commands, of_use = self._groups(case, further), frozenset((*self._of_use(case), *concerned))
        return Witness(case.side, assignment or {}, frame, about, facts, commands, of_use, exists)


def _reason(refusal: str) -> Keyword:
    """The reason for a rejection: `unknown code`."""
    return Keyword(refusal.replace("_", " "))


def _stated(known: Assignment, encoder: Encoder, *messages: Message) -> Assignment:
    """Parameter values with those that the values of the first fields of some messages depend on."""
    fields = (field for message in messages for field in candidates.first_fields(encoder, message))
    names = (name for field in fields for name in parameters_of(field.type) if name in encoder.assignment)
    return {**known, **{name: encoder.assignment[name] for name in names}}


def _whole(message: Message, encoder: Encoder, frame: CanFrame) -> str:
    """A message with the values of its first fields: `` `dim`: `level = 5 %` ``."""
    values = [shown(f, raw_of(f, frame), encoder.assignment) for f in candidates.first_fields(encoder, message)]
    return f"`{message.command}`" + (f": {', '.join(values)}" if values else "")


def _nodes(rule: IdRule) -> Sequence[int | None]:
    """Nodes of a rule: all, or the first and the last ones."""
    if rule.nodes is None:
        return [None]
    if len(rule.nodes) <= 2 * MAX_NODES:
        return list(rule.nodes)
    return [*rule.nodes[:MAX_NODES], *rule.nodes[-MAX_NODES:]]


def _moved(frame: CanFrame, old: IdRule, new: IdRule, node: int | None) -> CanFrame | None:
    """A frame of a node with the id of another rule; None if there is no such id."""
    id_ = frame.id - _id(old, node) + _id(new, node)
    if not 0 <= id_ < 1 << (29 if new.extended else 11):
        return None
    return CanFrame(id_, frame.data, new.extended, frame.remote)


def _id(rule: IdRule, node: int | None) -> int:
    """The id of a node, or of the first one if the rule does not have it."""
    if rule.nodes is None:
        return rule.base
    return rule.base + rule.node_step * (rule.nodes[0] if node is None or node not in rule.nodes else node)
