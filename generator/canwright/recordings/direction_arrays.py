"""The directions of frames in arrays: those of `directions.py`, for logs of millions of frames.

Frames of different nodes do not affect each other. In the frames of one node, most requests are followed by their reply,
and no exchange is open after it: NumPy finds these. The rules of `directions.py` judge the other frames one by one, until
no exchange is open.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import operator
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
from ..semantics.decoder import Rejection
from ..semantics.frame import CanFrame
from .bus_behaviour import LOOKED_AHEAD, Behaviour
from .directions import MAX_KINDS, DirectedFrame, Directions, PendingFrame
from .frame_classes import FrameClass, FrameClasses, MessageForm
from .log_frame import LogFrame, Mark

Array = NDArray[Any]

REQUEST, REPLY, UNKNOWN = 0, 1, 2
"""The directions in arrays, as the target `columns` numbers them."""
_BOTH, _NONE = 3, 4
"""Classes of frames beside the directions: the other frames decide, and no message has the content."""
_NUMBERS = {Direction.REQUEST: REQUEST, Direction.REPLY: REPLY}
_MARKS = (Mark.SENT, Mark.RECEIVED, None)
EXTENDED, REMOTE = 1, 2
"""The bits of `kind`."""

_NOTHING, _ONE, _OTHER = 0, 1, 2
"""What a request opens at a node: no exchange, one that a single frame closes, or possibly another."""
_LOOKED_AFTER = 8
"""The number of frames of a node that are searched for the reply to a request, if the next one can be a request too."""
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
        """The data bytes as `<u8`."""

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
    return Directions({}, edition, window=window).learn(first, {one.bus for one in first})


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
    found = judged.judged if isinstance(judged, PendingFrame) else judged
    if found is None:
        return False
    direction[row] = UNKNOWN if found.direction is None else _NUMBERS[found.direction]
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


class _Kinds:
    """The kinds of frames of an edition on buses of some behaviours, by number, with their properties as arrays."""

    def __init__(self, edition: Edition, window: int | None, *, is_separate: bool) -> None:
        self._kinds = FrameClasses(edition, 0, window)
        self._behaviours: dict[Behaviour, int] = {}
        self._is_separate = is_separate
        self._lines, self._values, self._numbers, self._pairs = _Numbers(), _Numbers(), _Numbers(), _Numbers()
        self._has_nodes: list[bool] = []
        self._key_bits: list[int] = []
        self._kind: list[FrameClass] = []
        self._profiles: dict[object, int] = {}
        self._examples: list[FrameClass] = []
        """A kind of each profile."""
        self._profile: list[int] = []
        self._answers: list[bool] = []
        self.opens: list[Mapping[int, int]] = []
        """The nodes that each kind concerns, and what a request of it opens there."""
        self.is_echoed: list[bool] = []
        self.is_distinct: list[bool] = []
        self.has_old_bits: list[bool] = []
        self.is_copied: list[bool] = []
        """Whether frames on the bus can be recorded twice."""
        self.within: list[int] = []
        self.window: list[int] = []

    @property
    def is_full(self) -> bool:
        """Whether there are too many kinds to remember, as in a log with random frames."""
        return max(self._lines.count, self._values.count, self._numbers.count) > MAX_KINDS

    def numbers(self, frames: FrameArrays, behaviours: Sequence[Behaviour]) -> tuple[Array, Array]:
        """The positions of the frames whose id is one of the edition's, and their kinds; behaviours are those of the buses."""
        known = [self._behaviours.setdefault(one, len(self._behaviours)) for one in behaviours]
        ids = frames.id.astype(np.uint64) | frames.kind.astype(np.uint64) << 32 | frames.length.astype(np.uint64) << 40
        if len(self._behaviours) > 1:
            ids |= np.array(known, np.uint64)[frames.bus] << 48
        lines, new = self._lines.of(ids)
        for row in new.tolist():
            frame = _frame(frames, row)
            self._has_nodes.append(bool(self._kinds.nodes(frame)))
            self._key_bits.append(self._kinds.key_bits(frame))
        rows = np.flatnonzero(np.array(self._has_nodes, np.bool_)[lines])
        lines = lines[rows]
        values, _ = self._values.of(frames.data[rows] & np.array(self._key_bits, np.uint64)[lines])
        numbers, new = self._numbers.of(lines.astype(np.uint64) << 32 | values.astype(np.uint64))
        for row in rows[new].tolist():
            behaviour = behaviours[frames.bus[row]]
            self.is_copied.append(bool(behaviour.copied))
            self._add(self._kinds.kind(_frame(frames, row), behaviour))
        return rows, numbers

    def _add(self, kind: FrameClass) -> None:
        request = kind.request and (kind.request.message, kind.request.constants, kind.request.reserved)
        profile = kind.only, request, tuple(reply.constants for reply in kind.replies)
        number = self._profiles.setdefault(profile, len(self._profiles))
        if number == len(self._examples):
            self._examples.append(kind)
        self._kind.append(kind)
        self._profile.append(number)
        self.opens.append(self._opened(kind))
        self.is_echoed.append(kind.is_echoed)
        self.is_distinct.append(kind.is_distinct)
        self.has_old_bits.append(kind.has_old_bits)
        self.within.append(kind.within)
        self.window.append(kind.window)

    def _opened(self, kind: FrameClass) -> Mapping[int, int]:
        """What a request of a kind opens at each node; also the nodes that can have sent it as a reply."""
        nodes = {_ANY if n is None or not self._is_separate else n for _, _, n in kind.answers}
        if len(nodes) > 1:
            nodes.discard(_ANY)  # the channel of any node, to which no request is sent if the nodes are separate
        opened = dict.fromkeys(nodes, _NOTHING)
        found = kind.identified[Direction.REQUEST]
        if kind.request is None or isinstance(found, Rejection):
            return opened
        is_certain = found.message is kind.request.message and found.message not in kind.with_constants
        for (_, _, node), replies in kind.opens:
            at = _ANY if node is None or not self._is_separate else node
            is_one = is_certain and not kind.has_node_in_data and replies == 1 and not opened.get(at)
            opened[at] = _ONE if is_one else _OTHER
        return opened

    def classes(self, numbers: Array, data: Array) -> Array:
        """The directions that the content of frames allows."""
        found = np.empty(numbers.size, np.uint8)
        profiles = np.array(self._profile, np.intp)[numbers]
        for profile in np.flatnonzero(np.bincount(profiles)).tolist():
            rows = np.flatnonzero(profiles == profile)
            found[rows] = _classes(self._examples[profile], data[rows])
        return found

    def answers(self, frames: FrameArrays, requests: _Rows, replies: _Rows) -> Array:
        """Which replies answer their requests, by their kinds."""
        pairs = requests.kinds.astype(np.uint64) << 32 | replies.kinds.astype(np.uint64)
        numbers, new = self._pairs.of(pairs)
        for at in new.tolist():
            asking, kind = self._kind[requests.kinds[at]], self._kind[replies.kinds[at]]
            request, reply = _frame(frames, int(requests.rows[at])), _frame(frames, int(replies.rows[at]))
            self._answers.append(kind.reply_to(asking, request, reply) is not None)
        return np.array(self._answers, np.bool_)[numbers]


def _classes(kind: FrameClass, data: Array) -> Array | int:
    """The directions of frames of a kind, as `Directions` finds them by id and content."""
    if kind.only is not None:
        return _NUMBERS[kind.only]
    is_request, is_regular = np.zeros(data.size, np.bool_), np.zeros(data.size, np.bool_)
    if kind.request is not None:
        is_request |= kind.request.has_constants(data)
        is_regular = _are_regular(kind.request, data)
    is_reply = np.zeros(data.size, np.bool_)
    for form in kind.replies:
        is_reply |= form.has_constants(data)
    either = np.where(is_regular, _BOTH, REPLY)
    return np.where(is_request, np.where(is_reply, either, REQUEST), np.where(is_reply, REPLY, _NONE))


def _are_regular(form: MessageForm, data: Array) -> Array:
    """Which data a program that obeys the spec can send."""
    found: Array = data & form.reserved.mask == form.reserved.value
    for parts, allows in form.limits:
        found &= allows(functools.reduce(operator.or_, ((data >> low & ones) << high for low, ones, high in parts)))
    return found


def _frame(frames: FrameArrays, row: int) -> CanFrame:
    kind, length = int(frames.kind[row]), int(frames.length[row])
    data = int(frames.data[row]).to_bytes(8, "little")[:length]
    return CanFrame(int(frames.id[row]), data, bool(kind & EXTENDED), bool(kind & REMOTE))


class _Rows(NamedTuple):
    """Positions of frames in a block, and their kinds."""

    rows: Array
    kinds: Array

    def at(self, places: Array) -> _Rows:
        return _Rows(self.rows[places], self.kinds[places])


class _Entries(NamedTuple):
    """The frames of each node one after the other; a frame that concerns several nodes has several entries."""

    nodes: Array
    """Numbers of nodes on buses."""
    of: _Rows
    opens: Array
    classes: Array
    clock: Array
    data: Array


class _Log:
    """The state at the end of a block: the clocks of the buses, and the nodes with open exchanges."""

    def __init__(self, edition: Edition, window: int | None, behaviours: Mapping[str, Behaviour]) -> None:
        self._edition = edition
        self._window = window
        self._behaviours = behaviours
        self._sharing = _sharing(edition)
        self._kinds = self._new_kinds()
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

    def _new_kinds(self) -> _Kinds:
        return _Kinds(self._edition, self._window, is_separate=self._sharing is not _Sharing.NODES)

    @cached_property
    def _directions(self) -> Directions:
        """The rules for the frames of one node; for them, each node is on a bus of its own."""
        default = self._edition if self._sharing is _Sharing.NODES else None
        return Directions(self._editions, default, window=self._window, behaviours=self._of_nodes)

    def add(self, block: FrameArrays) -> _Held:
        """The directions in a block."""
        held = _Held(block, block.direction.copy(), [])
        if not block.id.size:
            return held
        if self._kinds.is_full:
            self._kinds = self._new_kinds()
        clock = self._advanced(block)
        rows, numbers = self._kinds.numbers(block, [self._behaviour(bus) for bus in block.buses])
        given = block.direction[rows]
        classes = np.where(given == UNKNOWN, self._kinds.classes(numbers, block.data[rows]), given)
        held.direction[rows] = np.minimum(classes, UNKNOWN)
        if self._sharing is not _Sharing.NOTHING:
            self._pair(held, clock, _Rows(rows, numbers), classes)
        return held

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
        found = np.empty(block.id.size, np.int64)
        for number in np.flatnonzero(np.bincount(block.bus)).tolist():
            rows = np.flatnonzero(block.bus == number)
            time = block.time[rows]
            last, clock = self._clocks.get(block.buses[number], (time[0], 0))
            found[rows] = clock + np.cumsum(np.maximum(np.diff(time, prepend=last), 0))
            self._clocks[block.buses[number]] = int(time[-1]), int(found[rows[-1]])
        return found

    def _pair(self, held: _Held, clock: Array, frames: _Rows, classes: Array) -> None:
        """Decides on the frames that can be requests or replies."""
        entries = self._entries(held.block, clock, frames, classes)
        steps = self._steps(held.block, entries).tobytes()
        second = bytearray(len(steps))
        ends = np.flatnonzero(np.diff(entries.nodes, append=-1)) + 1
        judged: list[tuple[int, DirectedFrame | PendingFrame]] = []
        place = 0
        for end in ends.tolist():
            name, _ = self._names[entries.nodes[place]]
            if name in self._open:
                place = self._judge(held.block, entries, place, end, judged)
            while place < end:
                step = steps[place]
                if step == 2:
                    second[place + 1] = 1
                elif not step:
                    place = self._judge(held.block, entries, place, end, judged)
                place += step
        both = entries.classes == _BOTH
        held.direction[entries.of.rows[both]] = np.where(np.frombuffer(second, np.bool_)[both], REPLY, REQUEST)
        held.waiting = [(row, one) for row, one in judged if not _set(held.direction, row, one)]

    def _judge(
        self,
        block: FrameArrays,
        entries: _Entries,
        place: int,
        end: int,
        judged: list[tuple[int, DirectedFrame | PendingFrame]],
    ) -> int:
        """Judges the frames of a node one by one until no exchange is open; returns the place of the next one."""
        name, bus = self._names[entries.nodes[place]]
        self._open[name] = bus
        for at in range(place, end):
            row = int(entries.of.rows[at])
            mark = _MARKS[int(block.direction[row])]
            found = self._directions.accept(LogFrame(int(entries.clock[at]), name, _frame(block, row), mark))
            if entries.classes[at] == _BOTH:
                judged.append((row, found))
            if isinstance(found, DirectedFrame) and found.ends_part:
                del self._open[name]
                return at + 1
        return end

    def _entries(self, block: FrameArrays, clock: Array, frames: _Rows, classes: Array) -> _Entries:
        first = [next(iter(opened.items()), (_ABSENT, _NOTHING)) for opened in self._kinds.opens]
        nodes, opens = np.array(first, np.int64).reshape(-1, 2)[frames.kinds].T
        places = [np.flatnonzero((classes != _NONE) & (nodes != _ABSENT))]
        columns = [(nodes[places[0]], opens[places[0]])]
        for number, opened in enumerate(self._kinds.opens):
            if len(opened) > 1:
                these = np.flatnonzero((frames.kinds == number) & (classes != _NONE))
                for node, how in [*opened.items()][1:]:
                    places.append(these)
                    columns.append((np.full(these.size, node), np.full(these.size, how)))
        at = np.concatenate(places)
        nodes, opens = (np.concatenate(column) for column in zip(*columns, strict=True))
        rows = frames.rows[at]
        buses = block.bus[rows]
        known = np.array([self._buses.setdefault(name, len(self._buses)) for name in block.buses], np.uint64)
        numbers, new = self._nodes.of(known[buses] << 32 | (nodes - _ANY).astype(np.uint64))
        for place in new.tolist():
            self._add_node(block.buses[buses[place]], int(nodes[place]))
        order = np.argsort(numbers * block.id.size + rows)
        at, rows = at[order], rows[order]
        of = _Rows(rows, frames.kinds[at])
        return _Entries(numbers[order], of, opens[order], classes[at], clock[rows], block.data[rows])

    def _add_node(self, bus: str, number: int) -> None:
        node = None if number == _ANY else number
        name = f"{bus}/{node}"
        self._names.append((name, bus))
        self._of_nodes[name] = self._behaviour(bus)
        self._editions[name, node] = self._edition

    def _steps(self, block: FrameArrays, entries: _Entries) -> Array:
        """How many frames later no exchange is open again if none is open before a frame; 0 if it is not certain.

        Without an open exchange, a frame that can be both is a request. After 2 frames, the second answers the first. A
        request that the next one replaces counts as none.
        """
        nodes, of, opens, classes, clock, data = entries
        kinds = self._kinds
        is_copied = np.array(kinds.is_copied, np.bool_)[of.kinds]
        steps: Array = (((classes == REPLY) | (opens == _NOTHING)) & ~is_copied).astype(np.uint8)
        first = np.flatnonzero((classes != REPLY) & (opens == _ONE) & ~is_copied)
        first = first[first + 1 < nodes.size]
        first = first[nodes[first] == nodes[first + 1]]
        gap = clock[first + 1] - clock[first]
        is_answered = gap <= np.array(kinds.window, np.int64)[of.kinds[first]]
        steps[first[~is_answered]] = 1
        first, gap = first[is_answered], gap[is_answered]
        then = first + 1
        asking, kind = of.kinds[first], of.kinds[then]
        is_same = data[first] == data[then]
        is_echoed = np.array(kinds.is_echoed, np.bool_)[asking]
        answers = ~is_echoed | is_same
        possible = np.flatnonzero(answers)
        answers[possible] = kinds.answers(block, of.at(first[possible]), of.at(then[possible]))
        is_soon = gap <= np.array(kinds.within, np.int64)[asking]
        is_distinct = np.array(kinds.is_distinct, np.bool_)[kind]
        has_old_bits = np.array(kinds.has_old_bits, np.bool_)[kind]
        is_repeated = asking == kind
        is_same &= is_repeated
        is_both = classes[then] == _BOTH
        closes = answers & np.where(is_echoed, is_soon, ~is_distinct & (is_soon | ~(is_same | has_old_bits)))
        steps[first[np.where(is_both, closes, answers & (classes[then] == REPLY))]] = 2
        replaces = ~answers | (~is_soon & (is_distinct | is_same | has_old_bits))
        is_replaced = is_repeated & ~is_echoed & np.where(is_both, replaces, classes[then] == REQUEST)
        steps[first[is_replaced]] = 1
        waits = np.flatnonzero(is_both & answers & ~is_echoed & is_soon & is_distinct)
        steps[self._waiting_replies(block, entries, first[waits])] = 2
        return steps

    def _waiting_replies(self, block: FrameArrays, entries: _Entries, first: Array) -> Array:
        """The requests whose next frame can be a request too, but replies: no other frame replies within the window."""
        nodes, of, _, classes, clock, _ = entries
        found = [first[:0]]
        for distance in range(2, _LOOKED_AFTER + 2):
            first = first[first + distance < nodes.size]
            first = first[nodes[first] == nodes[first + distance]]
            later = first + distance
            is_late = clock[later] - clock[first + 1] > np.array(self._kinds.window, np.int64)[of.kinds[first]]
            found.append(first[is_late])
            first, later = first[~is_late], later[~is_late]
            if not first.size:
                break
            answers = self._kinds.answers(block, of.at(first), of.at(later))
            is_reply = classes[later] == REPLY
            ends = ~is_reply & ((answers & (classes[later] == _BOTH)) | (of.kinds[first] == of.kinds[later]))
            found.append(first[ends])
            first = first[~ends & ~(is_reply & answers)]
        return np.concatenate(found)


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
    is_separate = all(node == other for pair in pairs for node, other in _shared_nodes(*pair))
    return _Sharing.IDS if is_separate and all(map(_is_answered_by_itself, edition.commands)) else _Sharing.NODES


def _shared_nodes(first: _Ids, second: _Ids) -> set[tuple[int | None, int | None]]:
    """The nodes that an id can mean by two rules."""
    (rule, mask), (other, other_mask) = first, second
    if rule.extended is not other.extended:
        return set()
    fixed = ~(mask | other_mask)
    found: dict[int, list[int | None]] = {}
    for id_, node in _ids(rule):
        found.setdefault(id_ & fixed, []).append(node)
    return {(node, own) for id_, own in _ids(other) for node in found.get(id_ & fixed, ())}


def _ids(rule: IdRule) -> Iterator[tuple[int, int | None]]:
    if rule.nodes is None:
        yield rule.base, None
    for node in rule.nodes or ():
        yield rule.base + node * rule.node_step, node


def _is_answered_by_itself(command: Command) -> bool:
    """Whether only the node of a request answers it; or the nodes of a broadcast, each with its own id."""
    if command.request is None or command.reply is None:
        return True
    to, source = command.request.id.nodes, command.reply.id.nodes
    if to is None and source is not None:
        return bool(command.from_each)
    return (to is None) is (source is None) and not command.from_each
