"""Identification of the editions that a log fits, for each node of each bus.

No frame contains the edition, so this counts what an edition does not allow: ids, codes, lengths, reserved bits, names
and ranges. Some frames of a log are corrupted or belong to other protocols, so an edition fits only if

- most frames of the node are a message of some edition, and the edition explains nearly all of these;
- most requests that have a reply are answered;
- there is not clearly more against it than against the best edition, in kinds of frames that are not rare.

Reserved bits of requests cannot decide: hosts leave them uncleared. If several editions fit, the result lists all.
"""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ..compare import Change, Impact, Side, compare
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Command, Direction, IdRule
from ..semantics.frame import CanFrame, data_bits, node_of
from .checks import IMPLAUSIBLE, STRONG, Reason
from .recorded import Recorded
from .scoring import Interpretation, Kind, Kinds, Observation, reply_rule

JUDGED = Fraction(1, 2)
"""More than this share of the frames of a node is a message of some edition."""
EXPLAINED = Fraction(9, 10)
"""The minimum share of those frames that an edition explains."""
ANSWERED = Fraction(1, 2)
"""The minimum share of the requests with a reply that are answered."""
LEAD = 3
"""The points against an edition, in excess of those against the best one, with which it does not fit any more."""
SHARE = Fraction(1, 20)
"""The minimum share of the frames of a kind; evidence from fewer frames is not listed first."""
MAX_OPEN = 4
"""The maximum number of requests of a node that wait for their replies."""
MAX_KNOWN = 1 << 16
"""The maximum number of ids, and of steps between two states, that are remembered."""
MAX_COUNTED = 1 << 12
"""The maximum number of steps of a node, codes of an id or keys of a code that are remembered."""
MAX_FOREIGN = 1 << 10
"""The maximum number of foreign ids that are counted one by one."""


@dataclass(frozen=True)
class Evidence:
    """Evidence against an edition: in `count` of `among` frames of a kind, of which `example` is the first.

    `points` are those of one frame. It does not count if the frames are rare, so that they may be corrupted.
    """

    points: int
    text: str
    count: int
    among: int
    example: CanFrame
    counts: bool


@dataclass(frozen=True)
class EditionScore:
    """An edition: the number of frames that it explains, and all evidence against it, the strongest first.

    `requests` are those that have a reply in this edition; `unanswered` counts those without one, by command.
    """

    edition: Edition
    explained: int
    score: int
    against: tuple[Evidence, ...]
    requests: int
    unanswered: Mapping[str, int]

    def is_explained(self, judged: int) -> bool:
        """Whether the edition explains nearly all of the frames that some edition has."""
        return self.explained >= EXPLAINED * judged


@dataclass(frozen=True)
class NodeResult:
    """The result for one node of a bus. `editions` are those that fit; exactly one if the edition is identified.

    `unexplained` are frames that no edition has, the first of each kind with its count; they do not affect the scores.
    The replies to the commands `distinguishing` differ between the editions that fit. `scores` starts with the best.
    """

    bus: str
    node: int | None
    frames: int
    unexplained: tuple[tuple[CanFrame, int], ...]
    scores: tuple[EditionScore, ...]
    editions: tuple[Edition, ...]
    distinguishing: tuple[str, ...]

    @property
    def judged(self) -> int:
        """The number of frames that are a message of some edition."""
        return self.frames - sum(count for _, count in self.unexplained)

    @property
    def is_judged(self) -> bool:
        """Whether most frames are a message of some edition."""
        return self.judged > JUDGED * self.frames


@dataclass(frozen=True)
class Identification:
    """The results of a log, by bus and node; `foreign` counts the frames whose id belongs to no edition.

    `foreign_ids` counts them by id, for the first ids: its number, whether it has 29 bits, and whether a frame is remote.
    """

    frames: int
    foreign: int
    foreign_ids: Mapping[tuple[int, bool, bool], int]
    nodes: tuple[NodeResult, ...]


Compared = dict[tuple[str, str], tuple[Change, ...]]
"""The changes between two editions, by their names: a cache, since several nodes mostly fit the same editions."""


def identify(recorded: Iterable[Recorded], editions: Sequence[Edition]) -> Identification:
    """The identification of the frames of a log. All editions are of one family."""
    identifier = Identifier(editions)
    for one in recorded:
        identifier.add(one)
    return identifier.result()


class _State:
    """The requests of a node that wait for their replies, by edition, and the next steps by observation."""

    __slots__ = ("steps", "waiting")

    def __init__(self, waiting: tuple[tuple[str, ...], ...]) -> None:
        self.waiting = waiting
        self.steps: dict[Observation, _Step] = {}


class _Meaning(NamedTuple):
    """What a frame is in an edition after the frames before it; `opened` and `unanswered` are names of commands."""

    interpretation: Interpretation
    waiting: tuple[str, ...]
    opened: str | None = None
    unanswered: str | None = None


class _Step:
    """An observation in a state: the meaning in each edition, and the state that follows."""

    __slots__ = ("kind", "meanings", "then")

    def __init__(self, kind: Kind, meanings: Sequence[_Meaning], then: _State) -> None:
        self.kind = kind
        self.meanings = meanings
        self.then = then


class _Code:
    """The frames of a line with one first key: their kind, or the bits of all keys and the kinds by these."""

    __slots__ = ("key_bits", "kind", "kinds")

    def __init__(self, key_bits: int) -> None:
        self.key_bits = key_bits
        self.kind: Kind | None = None
        self.kinds: dict[int, Kind] = {}


class _Line:
    """The frames of one id and length on a bus; `node` is None if the id belongs to no edition."""

    __slots__ = ("codes", "first", "node", "rule")

    def __init__(self, node: _Node | None, rule: IdRule | None, first: slice[int, int, None]) -> None:
        self.node = node
        self.rule = rule
        self.first = first
        """The bytes of the first key."""
        self.codes: dict[bytes, _Code] = {}


class _Node:
    """The frames of a node of a bus."""

    __slots__ = ("counts", "state", "tally")

    def __init__(self, state: _State, tally: _Tally) -> None:
        self.state = state
        self.tally = tally
        self.counts: dict[_Step, int] = {}
        """Steps since they were last added to the tally."""


class Identifier:
    """Identifies the editions of the nodes of a log, frame by frame. Memory does not grow with the log."""

    def __init__(self, editions: Sequence[Edition]) -> None:
        self._editions = editions
        self._kinds = Kinds(editions)
        self._lines: dict[tuple[str, int, bool, bool, int], _Line] = {}
        self._nodes: dict[tuple[str, int | None], _Node] = {}
        self._states: dict[tuple[tuple[str, ...], ...], _State] = {}
        self._steps = 0
        self._foreign: Counter[tuple[int, bool, bool]] = Counter()
        self._foreign_count = 0

    def add(self, recorded: Recorded) -> None:
        """The next frame of the log."""
        _, bus, frame, _ = recorded
        id_, content, extended, remote = frame
        line = self._lines.get((bus, id_, extended, remote, len(content))) or self._line(bus, frame)
        node = line.node
        if node is None:
            self._foreign_count += 1
            foreign = id_, extended, remote
            if foreign in self._foreign or len(self._foreign) < MAX_FOREIGN:
                self._foreign[foreign] += 1
            return
        code = line.codes.get(content[line.first])
        kind = code and (code.kind or code.kinds.get(int.from_bytes(content, "little") & code.key_bits))
        observation = (kind or self._kind(line, frame)).observation(id_, content)
        step = node.state.steps.get(observation) or self._step(node, observation)
        node.state = step.then
        if step in node.counts:
            node.counts[step] += 1
        else:
            if len(node.counts) >= MAX_COUNTED:
                node.tally.add(node.counts)
                node.counts.clear()
            node.counts[step] = 1
            node.tally.first(step, frame)

    def result(self) -> Identification:
        """The identification of the frames so far."""
        compared: Compared = {}
        results = []
        for (bus, number), node in sorted(self._nodes.items(), key=lambda one: (one[0][0], one[0][1] or -1)):
            node.tally.add(node.counts)
            node.counts.clear()
            results.append(node.tally.result(bus, number, node.state.waiting, compared))
        nodes = tuple(_with_broadcasts(results))
        frames = self._foreign_count + sum(result.frames for result in nodes)
        return Identification(frames, self._foreign_count, dict(self._foreign.most_common()), nodes)

    def _line(self, bus: str, frame: CanFrame) -> _Line:
        """The frames with the id and length of a frame, remembered."""
        if len(self._lines) >= MAX_KNOWN:
            self._lines.clear()
        having = self._kinds.messages(frame)
        node = None
        if having:
            message, number = next(((m, n) for m in having if (n := node_of(m, frame)) is not None), (having[0], None))
            node = self._nodes.get((bus, number))
            if node is None:
                tally = _Tally(self._editions, has_number=number is not None)
                node = self._nodes[bus, number] = _Node(self._state(((),) * len(self._editions)), tally)
            line = _Line(node, message.id, self._kinds.first_key(frame))
        else:
            line = _Line(None, None, slice(0, 0))
        self._lines[bus, frame.id, frame.extended, frame.remote, len(frame.data)] = line
        return line

    def _kind(self, line: _Line, frame: CanFrame) -> Kind:
        """The kind of a frame, remembered for its line."""
        assert line.rule is not None
        first = frame.data[line.first]
        if len(line.codes) >= MAX_COUNTED:
            line.codes.clear()
        code = line.codes.get(first)
        if code is None:
            code = line.codes[first] = _Code(self._kinds.key_bits(frame))
        kind = self._kinds.kind(frame, line.rule)
        if not code.key_bits:
            code.kind = kind
            return kind
        if len(code.kinds) >= MAX_COUNTED:
            code.kinds.clear()
        code.kinds[int.from_bytes(frame.data, "little") & code.key_bits] = kind
        return kind

    def _state(self, waiting: tuple[tuple[str, ...], ...]) -> _State:
        return self._states.setdefault(waiting, _State(waiting))

    def _step(self, node: _Node, observation: Observation) -> _Step:
        """The step from the state of a node, remembered."""
        if self._steps >= MAX_KNOWN:
            self._states.clear()
            self._steps = 0
        state = self._state(node.state.waiting)
        meanings = [
            _meaning(edition, waiting, interpretations, has_number=node.tally.has_number)
            for edition, waiting, interpretations in zip(
                self._editions, state.waiting, observation.by_edition, strict=True
            )
        ]
        then = self._state(tuple(meaning.waiting for meaning in meanings))
        step = state.steps[observation] = _Step(observation.kind, meanings, then)
        self._steps += 1
        return step


def _with_broadcasts(results: Sequence[NodeResult]) -> Iterator[NodeResult]:
    """The results, where a broadcast fits only editions of the nodes on its bus that answer it."""
    for result in results:
        names = {
            edition
            for other in results
            if other.bus == result.bus and other.node is not None
            for edition in other.editions
        }
        broadcast = result.node is None and any(_is_broadcast(edition) for edition in result.editions)
        editions = tuple(edition for edition in result.editions if edition in names)
        yield dataclasses.replace(result, editions=editions, distinguishing=()) if broadcast else result


def _is_broadcast(edition: Edition) -> bool:
    """Whether an edition has requests without a node that nodes answer."""
    return any(
        command.request and command.request.id.nodes is None and command.reply and command.reply.id.nodes is not None
        for command in edition.commands
    )


def _meaning(
    edition: Edition, waiting: tuple[str, ...], interpretations: Sequence[Interpretation], *, has_number: bool
) -> _Meaning:
    """The interpretation of a frame with the fewest points against it, after requests that wait for replies.

    After a request, what is not the same request again is its reply.
    """
    replies: list[tuple[Interpretation, str]] = []
    request: Interpretation | None = None
    for one in interpretations:
        if one.message is not None and one.message.direction is Direction.REQUEST:
            request = one if request is None or one.points < request.points else request
        else:
            replies += [(one, name) for name in waiting if edition.command(name).reply is one.message]
    is_regular = request is not None and not request.reasons
    if replies and (not is_regular or _is_like_a_reply(edition, request)):
        reply, name = min(replies, key=lambda item: item[0].points)
        return _Meaning(reply, tuple(other for other in waiting if other != name))
    if request is not None and not is_regular and len(interpretations) == 1:
        message = request.message
        assert message is not None
        if message.command in waiting and (rule := reply_rule(edition, message)):
            text = f"{formatting.id_rule(message.id)} has a reply of {message.command}{rule}"
            return _Meaning(Interpretation(message.name, message, (Reason(STRONG, text),)), waiting)
    best = request if is_regular else min(interpretations, key=lambda one: one.points)
    assert best is not None
    message = best.message
    if message is None or message.direction is Direction.REPLY or best.points >= STRONG:
        return _Meaning(best, waiting)
    reply_message = edition.command(message.command).reply
    if reply_message is None or (not has_number and reply_message.id.nodes is not None):
        return _Meaning(best, waiting)
    others = tuple(name for name in waiting if name != message.command)
    unanswered = message.command if others != waiting else others[0] if len(others) >= MAX_OPEN else None
    return _Meaning(best, (*others[1 - MAX_OPEN :], message.command), message.command, unanswered)


def _is_like_a_reply(edition: Edition, request: Interpretation | None) -> bool:
    """Whether a reply can equal the request: it is an echo, or the request has no reserved bit."""
    assert request is not None and request.message is not None
    message = request.message
    places = [(key.space, key.segments) for key in message.keys]
    places += [(f.space, e.segments) for f in message.layout.fields for e in f.elements]
    return edition.command(message.command).is_echoed or data_bits(places) == (1 << 8 * message.dlc) - 1


class _KindTally:
    """The frames of one kind; the lists have a number for each edition."""

    def __init__(self, editions: int) -> None:
        self.frames = 0
        self.unexplained = 0
        self.explained = [0] * editions
        self.points = [0] * editions
        self.weak = [0] * editions
        """Points for reserved bits of requests only."""


class _Found:
    """A reason against an edition: the number of frames, and the first."""

    def __init__(self, name: str, points: int, example: CanFrame) -> None:
        self.name = name
        self.points = points
        self.example = example
        self.frames = 0
        self.by_byte: Counter[int] = Counter()


class _Tally:
    """The frames of a node of a bus, counted."""

    def __init__(self, editions: Sequence[Edition], *, has_number: bool) -> None:
        self.has_number = has_number
        self._editions = editions
        self._kinds: dict[Kind, _KindTally] = {}
        self._examples: dict[Kind, CanFrame] = {}
        self._found: list[dict[str, _Found]] = [{} for _ in editions]
        self._names: list[Counter[str]] = [Counter() for _ in editions]
        self._requests = [0] * len(editions)
        self._unanswered: list[Counter[str]] = [Counter() for _ in editions]

    def first(self, step: _Step, frame: CanFrame) -> None:
        """The first frame of a step."""
        self._examples.setdefault(step.kind, frame)
        for found, meaning in zip(self._found, step.meanings, strict=True):
            one = meaning.interpretation
            for reason in one.reasons:
                if reason.text not in found:
                    found[reason.text] = _Found(one.kind, reason.points, frame)

    def add(self, counts: Mapping[_Step, int]) -> None:
        """Counts frames by step."""
        for step, count in counts.items():
            kind = self._kinds.setdefault(step.kind, _KindTally(len(self._editions)))
            kind.frames += count
            if all(meaning.interpretation.points >= STRONG for meaning in step.meanings):
                kind.unexplained += count
                continue
            for i, meaning in enumerate(step.meanings):
                one = meaning.interpretation
                kind.explained[i] += count * (one.points < IMPLAUSIBLE)
                is_weak = one.is_dirty and all(reason.byte is not None for reason in one.reasons)
                (kind.weak if is_weak else kind.points)[i] += count * one.points
                self._names[i][one.kind] += count
                self._requests[i] += count * (meaning.opened is not None)
                if meaning.unanswered is not None:
                    self._unanswered[i][meaning.unanswered] += count
                for text in {reason.text for reason in one.reasons}:
                    self._found[i][text].frames += count
                for reason in one.reasons:
                    if reason.byte is not None:
                        self._found[i][reason.text].by_byte[reason.byte] += count

    def result(self, bus: str, node: int | None, waiting: Sequence[Sequence[str]], compared: Compared) -> NodeResult:
        """The result for the node; `waiting` are the commands without a reply so far."""
        frames = sum(kind.frames for kind in self._kinds.values())
        judged = frames - sum(kind.unexplained for kind in self._kinds.values())
        explained = [sum(kind.explained[i] for kind in self._kinds.values()) for i in range(len(self._editions))]
        noise = frames - max(explained)
        rare = max(math.sqrt(frames) / 10, noise / 32)
        scores = []
        for i, edition in enumerate(self._editions):
            often = [kind for kind in self._kinds.values() if kind.frames >= rare]
            weak = min(sum(kind.weak[i] for kind in often), LEAD - 1)
            score = sum(kind.points[i] for kind in often) + weak
            unanswered = self._unanswered[i] + Counter(waiting[i])
            scores.append(
                EditionScore(edition, explained[i], score, self._evidence(i, rare), self._requests[i], unanswered)
            )
        possible = [one for one in scores if judged > JUDGED * frames and _is_possible(one, judged)]
        scores.sort(key=lambda one: (one not in possible, one.score, -one.explained))
        limit = min((one.score for one in possible), default=0) + LEAD * max(1, math.sqrt(noise))
        fitting = tuple(one.edition for one in scores if one in possible and one.score < limit)
        seen = {name for names in self._names for name in names}
        unexplained = [
            (self._examples[kind], tally.unexplained) for kind, tally in self._kinds.items() if tally.unexplained
        ]
        unexplained.sort(key=lambda item: -item[1])
        return NodeResult(
            bus, node, frames, tuple(unexplained), tuple(scores), fitting, _distinguishing(fitting, seen, compared)
        )

    def _evidence(self, edition: int, rare: float) -> tuple[Evidence, ...]:
        """All evidence against an edition, the strongest first."""
        listed = []
        for text, found in self._found[edition].items():
            if not found.frames:
                continue
            among = self._names[edition][found.name]
            counts = found.frames >= rare and Fraction(found.frames, among) >= SHARE
            where, points = text, found.points
            if found.by_byte:
                often = [byte for byte, count in found.by_byte.items() if Fraction(count, among) >= SHARE]
                bytes_ = sorted(often or found.by_byte)
                where = f"{text}: {', '.join(f'DATA[{byte}]' for byte in bytes_)} should be 0"
                points = min(points * len(bytes_), STRONG)
            listed.append(Evidence(points, where, found.frames, among, found.example, counts))
        return tuple(sorted(listed, key=lambda e: (not e.counts, -e.points, -e.count)))


def _is_possible(score: EditionScore, judged: int) -> bool:
    """Whether an edition explains nearly all frames of a node, and most of its requests are answered."""
    answered = score.requests - sum(score.unanswered.values())
    return score.is_explained(judged) and answered >= ANSWERED * score.requests


def _distinguishing(fitting: Sequence[Edition], seen: set[str], compared: Compared) -> tuple[str, ...]:
    """Read commands whose replies differ between the editions that fit; those without a recorded reply first."""
    if len(fitting) < 2:
        return ()
    first = fitting[0]
    for other in fitting[1:]:
        if (first.name, other.name) not in compared:
            compared[first.name, other.name] = compare(first, other)
    changes = [change for other in fitting[1:] for change in compared[first.name, other.name]]
    counts = Counter(
        name
        for change in changes
        if change.verdicts.get(Side.RECEIVING, Impact.SAFE) is not Impact.SAFE and change.rule.id != "range-changed"
        for name in change.used_by
    )
    known = [{c.group: c for c in edition.commands} for edition in fitting]
    names = [
        name for name, _ in counts.most_common() if all(name in group and _only_reads(group[name]) for group in known)
    ]
    return tuple(sorted(names, key=lambda name: f"{name}_reply" in seen))


def _only_reads(command: Command) -> bool:
    return not command.effects and command.request is not None and not command.request.layout.fields
