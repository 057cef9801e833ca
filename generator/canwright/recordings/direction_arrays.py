"""The directions of frames in arrays: those of `directions.py`, for logs of millions of frames.

Frames of different nodes do not affect each other. Most requests of a node are followed by their reply, and no exchange is
open after it. Whether a frame answers the one before depends on the classes of both, on their content, and on whether the
second comes soon: `Directions` decides on one pair of each kind, and NumPy finds the others. `Directions` also decides on
all other frames, one by one, until no exchange is open.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..model.edition import Edition
from ..model.message import Command, Direction, IdRule
from ..semantics.frame import CanFrame
from .bus_behaviour import LOOKED_AHEAD, Behaviour
from .directions import DirectedFrame, Directions, PendingFrame, direction_by_content
from .frame_classes import MAX_CLASSES, DirectionRule, frame_classes
from .log_frame import LogFrame, Mark

Array = NDArray[Any]

REQUEST, REPLY, UNKNOWN = 0, 1, 2
"""The directions in arrays, as the target `columns` numbers them."""
_BOTH, _NONE, _UNSET = 3, 4, 255
"""What else the content of a frame allows: both directions, and none; or it was not seen before."""
_NUMBERS = {Direction.REQUEST: REQUEST, Direction.REPLY: REPLY}
_MARKS = (Mark.SENT, Mark.RECEIVED, None)
EXTENDED, REMOTE = 1, 2
"""The bits of `kind`."""

_UNCERTAIN, _ENDS, _CLOSES = range(3)
"""How many frames after a request no exchange is open: it ends before the next frame, or this closes it."""
_ABSENT, _ANY = -2, -1
"""Numbers in place of a node: the frame concerns none, or frames without a node."""


class FrameArrays(Protocol):
    """Frames as arrays of one length: a dataclass, as `Frames` of the target `columns` is."""

    @property
    def time(self) -> Array:
        """In nanoseconds."""

    @property
    def bus(self) -> Array:
        """Positions in `buses`."""

    @property
    def id(self) -> Array: ...

    @property
    def kind(self) -> Array:
        """1 for a 29-bit id, plus 2 for a remote frame."""

    @property
    def length(self) -> Array: ...

    @property
    def data(self) -> Array:
        """The data bytes as `<u8`: one integer for each frame, or a row of them if frames have more than 8 bytes."""

    @property
    def direction(self) -> Array:
        """0 for a request, 1 for a reply, 2 if it is unknown."""

    @property
    def buses(self) -> Sequence[str]: ...


Block = TypeVar("Block", bound=FrameArrays)


def infer_directions(blocks: Iterable[Block], edition: Edition, *, window: int | None = None) -> Iterator[Block]:
    """The same blocks of frames, in which the unknown directions are those that `Directions` finds.

    Known directions are kept, and count like marks. All blocks are of one log, in its order; all nodes speak `edition`. A
    request is answered within `window` ns; None for the time that suits the edition and the log. Memory does not grow with
    the log. `Directions` decides sooner, without the next frames, if more than 4096 frames wait for an earlier one.
    """
    iterator = iter(blocks)
    start: list[Block] = []
    count = 0
    for block in iterator:
        start.append(block)
        count += block.id.size
        if count >= LOOKED_AHEAD:
            break
    log = _Log(edition, window, _behaviours(start, edition, window))
    held: deque[_Held] = deque()
    for block in itertools.chain(start, iterator):
        held.append(log.add(block))
        log.settle_late()
        yield from _released(held)
    log.settle_all()
    yield from _released(held)


def _behaviours(start: Sequence[FrameArrays], edition: Edition, window: int | None) -> Mapping[str, Behaviour]:
    """The behaviour of the buses in the first blocks of a log. All known directions count."""
    rows = ((block, row) for block in start for row in range(block.id.size))
    first = [
        LogFrame(
            int(block.time[row]), block.buses[block.bus[row]], _frame(block, row), _MARKS[int(block.direction[row])]
        )
        for block, row in itertools.islice(rows, LOOKED_AHEAD)
    ]
    return Directions({}, edition, window=window).learn(first, {frame.bus for frame in first})


@dataclass
class _Held:
    """A block, its directions, and the frames in it that wait for later ones, by their positions."""

    block: Any
    direction: Array
    waiting: list[tuple[int, DirectedFrame | PendingFrame]]


def _released(held: deque[_Held]) -> Iterator[Any]:
    """Takes the blocks from the left in which no frame waits."""
    while held:
        first = held[0]
        first.waiting = [(row, judged) for row, judged in first.waiting if not _set(first.direction, row, judged)]
        if first.waiting:
            return
        held.popleft()
        yield dataclasses.replace(first.block, direction=first.direction)


def _set(direction: Array, row: int, judged: DirectedFrame | PendingFrame) -> bool:
    """Sets the direction of a frame; false while it waits."""
    directed = judged.directed if isinstance(judged, PendingFrame) else judged
    if directed is None:
        return False
    direction[row] = UNKNOWN if directed.direction is None else _NUMBERS[directed.direction]
    return True


class _Numbers:
    """Numbers for integers, from 0 in the order in which they are first seen."""

    def __init__(self) -> None:
        self.count = 0
        self._values = np.empty(0, np.uint64)
        self._numbers = np.empty(0, np.intp)

    def of(self, values: Array) -> tuple[Array, Array]:
        """The number of each value, and the positions of those that were not seen before, one each."""
        new = np.empty(0, np.intp)
        places, known = self._find(values)
        if not known.all():
            rows = np.flatnonzero(~known)
            _, first = np.unique(values[rows], return_index=True)
            new = rows[np.sort(first)]
            joined = np.concatenate([self._values, values[new]])
            numbers = np.concatenate([self._numbers, np.arange(self.count, self.count + new.size)])
            order = np.argsort(joined)
            self._values, self._numbers = joined[order], numbers[order]
            self.count += new.size
            places, _ = self._find(values)
        return self._numbers[places], new

    def _find(self, values: Array) -> tuple[Array, Array]:
        if not self.count:
            return np.zeros(values.size, np.intp), np.zeros(values.size, np.bool_)
        places = np.searchsorted(self._values, values)
        places[places == self.count] = 0
        return places, self._values[places] == values


class _Classes:
    """The classes of frames of an edition on buses of some behaviours, by number."""

    def __init__(self, edition: Edition, window: int | None, *, is_separate: bool) -> None:
        self._edition = edition
        self._window = window
        self._is_separate = is_separate
        self._behaviours: dict[Behaviour, int] = {}
        self._ids, self._values, self._numbers = _Numbers(), _Numbers(), _Numbers()
        self._has_nodes: list[bool] = []
        self._key_bits: list[int] = []
        self._profiles: dict[object, int] = {}
        self._profile: list[int] = []
        """Classes with one profile have the same content."""
        self.rules: list[DirectionRule] = []
        self.opens: list[Mapping[int, bool]] = []
        """The nodes that each class concerns, and whether a request of it opens an exchange there."""
        self.is_certain: list[bool] = []
        """Whether no data decide which frames answer a request, and frames are not recorded twice."""

    @property
    def is_full(self) -> bool:
        """Whether there are too many classes to remember, as in a log with random frames."""
        return max(self._ids.count, self._values.count, self._numbers.count) > MAX_CLASSES

    def numbers(self, frames: FrameArrays, behaviours: Sequence[Behaviour]) -> tuple[Array, Array]:
        """The positions of the frames whose id is one of the edition's, and their classes; behaviours are those of the buses."""
        known = [self._behaviours.setdefault(behaviour, len(self._behaviours)) for behaviour in behaviours]
        ids = frames.id.astype(np.uint64) | frames.kind.astype(np.uint64) << 32 | frames.length.astype(np.uint64) << 40
        if len(self._behaviours) > 1:
            ids |= np.array(known, np.uint64)[frames.bus] << 48
        ids, new = self._ids.of(ids)
        for row in new.tolist():
            id_class = frame_classes(self._edition).id_class(_frame(frames, row))
            self._has_nodes.append(bool(id_class.nodes))
            self._key_bits.append(id_class.key_bits)
        rows = np.flatnonzero(np.array(self._has_nodes, np.bool_)[ids])
        ids = ids[rows]
        data = _integers(frames, rows)
        values, _ = self._values.of(data & np.array(self._key_bits, data.dtype)[ids])
        numbers, new = self._numbers.of(ids.astype(np.uint64) << 32 | values.astype(np.uint64))
        for row in rows[new].tolist():
            self._add(_frame(frames, row), behaviours[frames.bus[row]])
        return rows, numbers

    def _add(self, frame: CanFrame, behaviour: Behaviour) -> None:
        rule = DirectionRule(frame_classes(self._edition).of(frame), behaviour, self._window)
        request = rule.request and (rule.request.message, rule.request.constants, rule.request.reserved)
        profile = rule.only, request, tuple(reply.constants for reply in rule.frame_class.replies)
        self._profile.append(self._profiles.setdefault(profile, len(self.rules)))
        self.rules.append(rule)
        self.opens.append(self._opened(rule))
        self.is_certain.append(not behaviour.copied and rule.frame_class.is_certain)

    def _opened(self, rule: DirectionRule) -> Mapping[int, bool]:
        """The nodes to which a frame of a class is sent, with true, and those that can have sent it."""
        answers, opens = (
            {_ANY if channel.node is None or not self._is_separate else channel.node for channel in channels}
            for channels in (rule.frame_class.answers, [opened.channel for opened in rule.frame_class.opens])
        )
        if len(answers) > 1:
            answers.discard(_ANY)  # the channel of any node, to which no request is sent if the nodes are separate
        return {node: node in opens for node in sorted(answers | opens)}

    def contents(self, numbers: Array, data: Array) -> Array:
        """The bits of `DirectionRule.content` for each frame."""
        contents = np.empty(numbers.size, np.uint8)
        profiles = np.array(self._profile, np.intp)[numbers]
        for profile in np.flatnonzero(np.bincount(profiles)).tolist():
            rows = np.flatnonzero(profiles == profile)
            contents[rows] = self.rules[profile].content(data[rows])
        return contents


def _frame(frames: FrameArrays, row: int) -> CanFrame:
    kind, length = int(frames.kind[row]), int(frames.length[row])
    data = frames.data[row].tobytes()[:length]
    return CanFrame(int(frames.id[row]), data, bool(kind & EXTENDED), bool(kind & REMOTE))


def _integers(frames: FrameArrays, rows: Array) -> Array:
    """The data of some frames, each as one integer; those of more than 64 bits are Python integers, which take longer."""
    data = frames.data[rows]
    if data.ndim == 1:
        return data
    integers = np.empty(len(data), object)
    integers[:] = [int.from_bytes(row.tobytes(), "little") for row in data]
    return integers


class _Entries(NamedTuple):
    """The frames of each node one after the other; a frame that concerns several nodes has several entries."""

    nodes: Array
    """Numbers of nodes on buses."""
    rows: Array
    """Positions of the frames in the block."""
    classes: Array
    """Numbers of classes."""
    kinds: Array
    """Numbers of classes with their content and their mark."""
    opens: Array
    """Whether the frame opens an exchange with the node if it is a request."""
    allowed: Array
    """The directions that id, content and mark allow."""
    clock: Array


class _Log:
    """The state at the end of a block: the clocks of the buses, and the nodes with open exchanges."""

    def __init__(self, edition: Edition, window: int | None, behaviours: Mapping[str, Behaviour]) -> None:
        self._edition = edition
        self._window = window
        self._behaviours = behaviours
        self._sharing = _sharing(edition)
        self._clocks: dict[str, tuple[int, int]] = {}
        """The time of the last frame, and the clock, which never runs backwards."""
        self._buses: dict[str, int] = {}
        self._nodes = _Numbers()
        self._names: list[tuple[str, str]] = []
        """The name of each node on a bus, and of this bus."""
        self._of_nodes: dict[str, Behaviour] = {}
        """The behaviour of the bus of each node, by its name."""
        self._editions: dict[tuple[str, int | None], Edition] = {}
        self._open: dict[str, str] = {}
        """The names of the nodes with open exchanges, and their buses."""
        self._forget()

    def _forget(self) -> None:
        """Forgets the classes of frames, and what follows from them."""
        self._classes = _Classes(self._edition, self._window, is_separate=self._sharing is not _Sharing.NODES)
        self._pairs = _Numbers()
        self._allowed: Array = np.empty(0, np.uint8)
        """The directions that each kind of frames allows."""
        self._of_pairs: list[int] = []
        """What each kind of frames shows after each kind of requests."""

    @cached_property
    def _directions(self) -> Directions:
        """The rules for the frames of one node; for them, each node is on a bus of its own."""
        return self._new_directions()

    @cached_property
    def _trial(self) -> Directions:
        """The same rules, for pairs of frames."""
        return self._new_directions()

    def _new_directions(self) -> Directions:
        default = self._edition if self._sharing is _Sharing.NODES else None
        return Directions(self._editions, default, window=self._window, behaviours=self._of_nodes)

    def add(self, block: FrameArrays) -> _Held:
        """The directions in a block."""
        held = _Held(block, block.direction.copy(), [])
        if not block.id.size:
            return held
        if self._classes.is_full:
            self._forget()
        clock = self._advanced(block)
        rows, classes = self._classes.numbers(block, [self._behaviour(bus) for bus in block.buses])
        kinds = self._kinds_of(block, rows, classes)
        allowed = self._allowed[kinds]
        held.direction[rows] = np.minimum(allowed, UNKNOWN)
        if self._sharing is not _Sharing.NOTHING:
            self._pair(held, self._entries(block, clock, rows, classes, kinds, allowed))
        return held

    def _kinds_of(self, block: FrameArrays, rows: Array, classes: Array) -> Array:
        """The numbers of classes with their content and their mark."""
        contents = self._classes.contents(classes, _integers(block, rows)).astype(np.intp)
        kinds: Array = classes << 5 | contents << 2 | block.direction[rows]
        more = len(self._classes.rules) * 32 - self._allowed.size
        self._allowed = np.concatenate([self._allowed, np.full(more, _UNSET, np.uint8)])
        for kind in np.unique(kinds[self._allowed[kinds] == _UNSET]).tolist():
            self._allowed[kind] = self._directions_of(kind)
        return kinds

    def _directions_of(self, kind: int) -> int:
        """The directions that the class, the content and the mark of frames allow."""
        if kind & 3 != UNKNOWN:
            return kind & 3
        decided = direction_by_content(self._classes.rules[kind >> 5], kind >> 2 & 7)
        return _BOTH if decided is None else _NONE if decided[0] is None else _NUMBERS[decided[0]]

    def _behaviour(self, bus: str) -> Behaviour:
        return self._behaviours.get(bus, Behaviour())._replace(is_marked=True)

    def settle_late(self) -> None:
        """Decides on the waiting frames for which it is too late at the end of the last block."""
        for name, bus in self._open.items():
            self._directions.decide_pending(name, self._clocks[bus][1])

    def settle_all(self) -> None:
        """Decides on all waiting frames."""
        for name in self._open:
            self._directions.decide_pending(name)

    def _advanced(self, block: FrameArrays) -> Array:
        """The clock of the bus at each frame."""
        clocks = np.empty(block.id.size, np.int64)
        for number in np.flatnonzero(np.bincount(block.bus)).tolist():
            rows = np.flatnonzero(block.bus == number)
            time = block.time[rows]
            last, clock = self._clocks.get(block.buses[number], (time[0], 0))
            clocks[rows] = clock + np.cumsum(np.maximum(np.diff(time, prepend=last), 0))
            self._clocks[block.buses[number]] = int(time[-1]), int(clocks[rows[-1]])
        return clocks

    def _pair(self, held: _Held, entries: _Entries) -> None:
        """Decides on the frames that can be requests or replies."""
        steps = self._steps(held.block, entries).tobytes()
        is_reply = bytearray(len(steps))
        ends = np.flatnonzero(np.diff(entries.nodes, append=-1)) + 1
        decided: list[tuple[int, DirectedFrame | PendingFrame]] = []
        place = 0
        for end in ends.tolist():
            name, _ = self._names[entries.nodes[place]]
            if name in self._open:
                place = self._decide(held.block, entries, place, end, decided)
            while place < end:
                step = steps[place]
                if step == _CLOSES:
                    is_reply[place + 1] = 1
                elif step == _UNCERTAIN:
                    place = self._decide(held.block, entries, place, end, decided)
                place += step
        both = entries.allowed == _BOTH
        held.direction[entries.rows[both]] = np.where(np.frombuffer(is_reply, np.bool_)[both], REPLY, REQUEST)
        held.waiting = [(row, result) for row, result in decided if not _set(held.direction, row, result)]

    def _decide(
        self,
        block: FrameArrays,
        entries: _Entries,
        place: int,
        end: int,
        decided: list[tuple[int, DirectedFrame | PendingFrame]],
    ) -> int:
        """Decides on the frames of a node one by one until no exchange is open; returns the place of the next one."""
        name, bus = self._names[entries.nodes[place]]
        self._open[name] = bus
        for at in range(place, end):
            result = self._directions.accept(self._log_frame(block, entries, at))
            if entries.allowed[at] == _BOTH:
                decided.append((int(entries.rows[at]), result))
            if isinstance(result, DirectedFrame) and result.ends_part:
                del self._open[name]
                return at + 1
        return end

    def _log_frame(self, block: FrameArrays, entries: _Entries, at: int) -> LogFrame:
        """A frame as `Directions` reads it, on the bus of its node."""
        row, (name, _) = int(entries.rows[at]), self._names[entries.nodes[at]]
        return LogFrame(int(entries.clock[at]), name, _frame(block, row), _MARKS[int(block.direction[row])])

    def _entries(
        self, block: FrameArrays, clock: Array, rows: Array, classes: Array, kinds: Array, allowed: Array
    ) -> _Entries:
        first = [next(iter(opened.items()), (_ABSENT, False)) for opened in self._classes.opens]
        nodes, opens = np.array(first, np.int64).reshape(-1, 2)[classes].T
        places = [np.flatnonzero((allowed != _NONE) & (nodes != _ABSENT))]
        columns = [(nodes[places[0]], opens[places[0]])]
        for number, opened in enumerate(self._classes.opens):
            if len(opened) > 1:
                these = np.flatnonzero((classes == number) & (allowed != _NONE))
                for node, is_open in [*opened.items()][1:]:
                    places.append(these)
                    columns.append((np.full(these.size, node), np.full(these.size, is_open)))
        at = np.concatenate(places)
        nodes, opens = (np.concatenate(column) for column in zip(*columns, strict=True))
        own = rows[at]
        buses = block.bus[own]
        known = np.array([self._buses.setdefault(name, len(self._buses)) for name in block.buses], np.uint64)
        numbers, new = self._nodes.of(known[buses] << 32 | (nodes - _ANY).astype(np.uint64))
        for place in new.tolist():
            self._add_node(block.buses[buses[place]], int(nodes[place]))
        order = np.argsort(numbers * block.id.size + own)
        at, own = at[order], own[order]
        return _Entries(
            numbers[order], own, classes[at], kinds[at], opens[order].astype(np.bool_), allowed[at], clock[own]
        )

    def _add_node(self, bus: str, number: int) -> None:
        node = None if number == _ANY else number
        name = f"{bus}/{node}"
        self._names.append((name, bus))
        self._of_nodes[name] = self._behaviour(bus)
        self._editions[name, node] = self._edition

    def _steps(self, block: FrameArrays, entries: _Entries) -> Array:
        """How many frames later no exchange is open again if none is open before a frame; 0 if it is not certain.

        Without an open exchange, a frame that can be both is a request.
        """
        is_certain = np.array(self._classes.is_certain, np.bool_)[entries.classes]
        is_request = entries.opens & (entries.allowed != REPLY)
        steps: Array = np.where(~is_request & is_certain, _ENDS, _UNCERTAIN).astype(np.uint8)
        first = np.flatnonzero(is_request & is_certain)
        first = first[first + 1 < entries.nodes.size]
        first = first[entries.nodes[first] == entries.nodes[first + 1]]
        gap = entries.clock[first + 1] - entries.clock[first]
        times = np.array([(rule.within, rule.window) for rule in self._classes.rules], np.int64).reshape(-1, 2)
        within, window = times[entries.classes[first]].T
        steps[first[gap > window]] = _ENDS
        first, is_soon = first[gap <= window], (gap <= within)[gap <= window]
        second, data = first + 1, _integers(block, entries.rows)
        bits = is_soon | (data[first] == data[second]) << 1 | entries.opens[second] << 2
        keys = entries.kinds[first].astype(np.uint64) << 32 | (entries.kinds[second] << 3 | bits).astype(np.uint64)
        pairs, new = self._pairs.of(keys)
        self._of_pairs += [self._verdict(block, entries, at) for at in first[new].tolist()]
        steps[first] = np.array(self._of_pairs, np.uint8)[pairs]
        return steps

    def _verdict(self, block: FrameArrays, entries: _Entries, at: int) -> int:
        """What the frame after a request shows of it."""
        _, second = (self._trial.accept(self._log_frame(block, entries, place)) for place in (at, at + 1))
        open_ = {*self._trial.forget(self._names[entries.nodes[at]][0])}
        if isinstance(second, PendingFrame) or not open_ <= {second.number}:
            return _UNCERTAIN
        return _ENDS if open_ else _CLOSES


class _Sharing(Enum):
    """What requests and replies have in common."""

    NOTHING = "nothing: the id decides on each direction"
    IDS = "ids, but a frame that can be both concerns one node only"
    NODES = "ids on which a request and a reply can concern different nodes"


_Ids = tuple[IdRule, int]
"""The ids of some messages: their rule, and the bits for keys and fields."""


def _sharing(edition: Edition) -> _Sharing:
    ids: dict[Direction, dict[_Ids, None]] = {
        direction: dict.fromkeys((m.id, m.id_mask) for m in edition.messages(direction)) for direction in Direction
    }
    if not any(_shared_nodes(*pair) for pair in itertools.product(*ids.values())):
        return _Sharing.NOTHING
    pairs = itertools.combinations({**ids[Direction.REQUEST], **ids[Direction.REPLY]}, 2)
    is_separate = all(node == second for pair in pairs for node, second in _shared_nodes(*pair))
    return _Sharing.IDS if is_separate and all(map(_is_answered_by_itself, edition.commands)) else _Sharing.NODES


def _shared_nodes(first: _Ids, second: _Ids) -> set[tuple[int | None, int | None]]:
    """The nodes that an id can mean by two rules."""
    (rule, mask), (other_rule, other_mask) = first, second
    if rule.extended is not other_rule.extended:
        return set()
    fixed = ~(mask | other_mask)
    nodes: dict[int, list[int | None]] = {}
    for id_, node in _ids(rule):
        nodes.setdefault(id_ & fixed, []).append(node)
    return {(node, own) for id_, own in _ids(other_rule) for node in nodes.get(id_ & fixed, ())}


def _ids(rule: IdRule) -> Iterator[tuple[int, int | None]]:
    if rule.parameter is not None:
        return  # unknown
    if rule.nodes is None:
        yield rule.base, None
    for node in rule.nodes or ():
        yield rule.base + node * rule.node_step, node


def _is_answered_by_itself(command: Command) -> bool:
    """Whether only the node of a request answers it; or the nodes of a broadcast, each with its own id."""
    if command.request is None or command.reply is None:
        return True
    to, sources = command.request.id.nodes, {reply.message.id.nodes is None for reply in command.replies}
    if to is None and sources == {False}:
        return bool(command.from_each)
    return sources == {to is None} and not command.from_each
