"""Identification of the editions that a log fits, for each node of each bus.

No frame contains the edition, so this counts what an edition does not allow: ids, codes, lengths, reserved bits, names
and ranges. Some frames of a log are corrupted or belong to other protocols, so an edition fits only if

- most frames of the node are a message of some edition, and the edition explains nearly all of these;
- most requests that have a reply are answered, unless the log lacks requests;
- there is not clearly more against it than against the best edition, in kinds of frames that are not rare.

Requests cannot decide: hosts leave reserved bits uncleared, and try codes. Implausible values count against an edition,
but do not exclude it. If several editions fit, the result lists all.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ..model.edition import Edition
from ..model.message import Direction, IdRule
from ..semantics.frame import CanFrame, node_in_id, node_of
from .changes import BLOCK, NodeFrames
from .log_frame import LogFrame, Mark
from .results import Identification, NodeResult
from .scoring import Observation, ScoredClass, ScoredClasses
from .steps import Circumstances, Repetition, State, Step, Waiting, meaning

MAX_KNOWN = 1 << 16
"""The maximum number of ids, and of steps between two states, that are remembered."""
MAX_COUNTED = 1 << 12
"""The maximum number of codes of an id or keys of a code that are remembered."""
MAX_FOREIGN = 1 << 10
"""The maximum number of foreign ids that are counted one by one."""
STRAY = 20
"""A node with at most one of so many frames as the busiest node of its bus is stray, if its frames are far apart."""


def identify(recorded: Iterable[LogFrame], editions: Sequence[Edition]) -> Identification:
    """The identification of the frames of a log. All editions are of one family."""
    identifier = Identifier(editions)
    for frame in recorded:
        identifier.add(frame)
    return identifier.result()


@dataclass(slots=True)
class _IdState:
    """The frames of one id and length, by the bytes of their first key; `rule` is None if the id belongs to no edition.

    Of each first key, these are the bits that identify a frame further, and the nodes and kinds of frames by these.
    """

    rule: IdRule | None
    first: slice[int, int, None]
    codes: dict[bytes, tuple[int, dict[int, tuple[int | None, ScoredClass]]]]


class Identifier:
    """Identifies the editions of the nodes of a log, frame by frame. Memory does not grow with the log.

    `recorder` is the direction of the frames that the log marks as sent; received ones have the other direction; None if
    marks do not count. Marks count on a bus that has both kinds of one node, but not for a node to which nothing is
    sent: another host asks it.
    """

    def __init__(self, editions: Sequence[Edition], recorder: Direction | None = Direction.REQUEST) -> None:
        opposite = Direction.REPLY if recorder is Direction.REQUEST else Direction.REQUEST
        self.editions = editions
        self.marked: set[str] = set()
        """The buses with sent and received frames of one node."""
        self._of_mark = {Mark.SENT: recorder, Mark.RECEIVED: opposite} if recorder else {}
        self._kinds = ScoredClasses(editions)
        self._lines: dict[tuple[int, bool, bool, int], _IdState] = {}
        self._nodes: dict[tuple[str, int | None], NodeFrames] = {}
        self._states: dict[tuple[Waiting, ...], State] = {}
        self._steps = 0
        self._number = 0
        self._foreign: Counter[tuple[int, bool, bool]] = Counter()
        self._foreign_count = 0

    @property
    def foreign(self) -> int:
        """The number of frames whose id belongs to no edition."""
        return self._foreign_count

    def add(self, recorded: LogFrame) -> NodeFrames | None:
        """The next frame of the log; returns the frames of its node, None if its id belongs to no edition."""
        _, bus, frame, mark = recorded
        id_, content, extended, remote = frame
        number = self._number
        self._number = number + 1
        line = self._lines.get((id_, extended, remote, len(content))) or self._line(frame)
        if line.rule is None:
            self._foreign_count += 1
            foreign = id_, extended, remote
            if foreign in self._foreign or len(self._foreign) < MAX_FOREIGN:
                self._foreign[foreign] += 1
            return None
        key_bits, places = line.codes.get(content[line.first]) or self._code(line, frame)
        bits = key_bits and int.from_bytes(content, "little") & key_bits
        node_number, kind = places.get(bits) or self._place(line.rule, places, bits, frame)
        node = self._nodes.get((bus, node_number)) or self._frames_of(bus, node_number)
        observation = kind.observation(id_, content)
        direction = self._direction(node, mark) if mark is not None and self._of_mark else None
        repetition = node.repetitions.place(recorded, kind)
        known = observation if direction is None and repetition is None else (observation, direction, repetition)
        step = node.state.steps.get(known) or self._step(node, observation, direction, repetition)
        node.state = step.then
        node.recent.append((step, number, recorded))
        if len(node.recent) >= BLOCK:
            node.examine()
        return node

    def results_of(self, node: NodeFrames) -> list[NodeResult]:
        """The result of each part of the frames of a node so far."""
        node.examine()
        busiest = max(each.frames for each in self._nodes.values() if each.bus == node.bus)
        return self._results(node, busiest)

    def result(self) -> Identification:
        """The identification of the frames so far."""
        busiest: Counter[str] = Counter()
        for node in self._nodes.values():
            node.examine()
            busiest[node.bus] = max(busiest[node.bus], node.frames)
        listed = sorted(self._nodes.values(), key=lambda node: (node.bus, node.number or -1))
        results = [result for node in listed for result in self._results(node, busiest[node.bus])]
        nodes = tuple(_with_broadcasts(results))
        return Identification(self._number, self._foreign_count, dict(self._foreign.most_common()), nodes)

    def _results(self, node: NodeFrames, busiest: int) -> list[NodeResult]:
        is_stray = STRAY * node.frames <= busiest and 2 * node.near < node.frames
        nothing: tuple[Waiting, ...] = ((),) * len(self.editions)
        waiting = [*(nothing for _ in node.tallies[1:]), node.state.waiting]
        return [
            dataclasses.replace(tally.result(node.bus, node.number, open_), is_stray=is_stray)
            for tally, open_ in zip(node.tallies, waiting, strict=True)
        ]

    def _direction(self, node: NodeFrames, mark: Mark) -> Direction | None:
        """The direction that a mark of a frame of a node states; None if it does not count so far."""
        if mark not in node.marks:
            node.marks.add(mark)
            if len(node.marks) == len(Mark):
                self.marked.add(node.bus)
        to_all = self._nodes.get((node.bus, None), node)
        is_asked = Mark.SENT in node.marks or Mark.SENT in to_all.marks
        return self._of_mark[mark] if is_asked and node.bus in self.marked else None

    def _line(self, frame: CanFrame) -> _IdState:
        """The frames with the id and length of a frame, remembered."""
        if len(self._lines) >= MAX_KNOWN:
            self._lines.clear()
        having = self._kinds.messages(frame)
        line = _IdState(having[0].id if having else None, self._kinds.first_key(frame), {})
        self._lines[frame.id, frame.extended, frame.remote, len(frame.data)] = line
        return line

    def _code(self, line: _IdState, frame: CanFrame) -> tuple[int, dict[int, tuple[int | None, ScoredClass]]]:
        """The frames with the first key of a frame, remembered for its line."""
        if len(line.codes) >= MAX_COUNTED:
            line.codes.clear()
        code = line.codes[frame.data[line.first]] = self._kinds.further_bits(frame), {}
        return code

    def _place(
        self, rule: IdRule, places: dict[int, tuple[int | None, ScoredClass]], bits: int, frame: CanFrame
    ) -> tuple[int | None, ScoredClass]:
        """The number of the node, and the kind, of a frame, remembered by the bits that identify it."""
        if len(places) >= MAX_COUNTED:
            places.clear()
        in_id = (node_in_id(message, frame) for message in self._kinds.messages(frame))
        in_data = (node_of(message, frame) for message in self._kinds.candidates(frame))
        number = next((n for n in itertools.chain(in_id, in_data) if n is not None), None)
        place = places[bits] = number, self._kinds.kind(frame, rule)
        return place

    def _frames_of(self, bus: str, number: int | None) -> NodeFrames:
        state = self._state(((),) * len(self.editions))
        node = self._nodes[bus, number] = NodeFrames(bus, number, self.editions, state)
        return node

    def _state(self, waiting: tuple[Waiting, ...]) -> State:
        return self._states.setdefault(waiting, State(waiting))

    def _step(
        self, node: NodeFrames, observation: Observation, direction: Direction | None, repetition: Repetition | None
    ) -> Step:
        """The step from the state of a node, remembered."""
        if self._steps >= MAX_KNOWN:
            self._states.clear()
            self._steps = 0
        state = self._state(node.state.waiting)
        circumstances = Circumstances(direction, repetition, node.number is not None)
        meanings = [
            meaning(edition, waiting, interpretations, circumstances)
            for edition, waiting, interpretations in zip(
                self.editions, state.waiting, observation.by_edition, strict=True
            )
        ]
        then = self._state(tuple(each.waiting for each in meanings))
        step = Step(observation.kind, meanings, then)
        known = observation if direction is None and repetition is None else (observation, direction, repetition)
        state.steps[known] = step
        self._steps += 1
        return step


def _with_broadcasts(results: Sequence[NodeResult]) -> Iterator[NodeResult]:
    """The results, where a broadcast fits only editions of the nodes on its bus that answer it."""
    names: dict[str, set[Edition]] = {}
    for result in results:
        if result.node is not None:
            names.setdefault(result.bus, set()).update(result.editions)
    for result in results:
        broadcast = result.node is None and any(_is_broadcast(edition) for edition in result.editions)
        editions = tuple(edition for edition in result.editions if edition in names.get(result.bus, ()))
        yield dataclasses.replace(result, editions=editions, distinguishing=()) if broadcast else result


def _is_broadcast(edition: Edition) -> bool:
    """Whether an edition has requests without a node that nodes answer."""
    return any(
        command.request and command.request.id.nodes is None and command.reply and command.reply.id.nodes is not None
        for command in edition.commands
    )
