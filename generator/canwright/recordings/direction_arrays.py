"""The directions of frames in arrays: those of `directions.py`, for logs of millions of frames.

Frames of different nodes do not affect each other. Most requests of a node are followed by their reply, and no exchange is
open after it. Whether a frame answers the one before depends on the classes of both, on their content, and on whether the
second comes soon: `Directions` decides on one pair of each kind, which counts for the others. `Directions` also decides on
all other frames, one by one, until no exchange is open. The last request of a node in a block is such a frame.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import operator
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..model.edition import Edition
from ..model.message import Command, Direction, IdRule
from ..semantics.frame import CanFrame
from .bus_behaviour import LOOKED_AHEAD, Behaviour
from .directions import DirectedFrame, Directions, PendingFrame, direction_by_content
from .frame_classes import MAX_CLASSES, DirectionRule, FrameClass, frame_classes
from .log_frame import LogFrame, Mark

Array = NDArray[Any]

REQUEST, REPLY, UNKNOWN = 0, 1, 2
"""The directions in arrays, as the target `columns` numbers them."""
_NUMBERS = {Direction.REQUEST: REQUEST, Direction.REPLY: REPLY, None: UNKNOWN}
_MARKS = (Mark.SENT, Mark.RECEIVED, None)
EXTENDED, REMOTE = 1, 2
"""The bits of `kind`."""

_UNCERTAIN, _ENDS, _CLOSES = range(1, 4)
"""What a frame shows of an open request: the request had ended before, or this frame closes it."""


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
    behaviours = _behaviours(start, edition, window)
    buses: dict[str, _Bus] = {}
    held: deque[_Held] = deque()
    for block in itertools.chain(start, iterator):
        held.append(_Held(block, block.direction.copy(), []))
        for rows in _groups(block.bus):
            name = block.buses[block.bus[rows[0]]]
            if name not in buses:
                buses[name] = _Bus(edition, window, behaviours.get(name, Behaviour()))
            buses[name].add(held[-1], rows)
        for bus in buses.values():
            bus.settle(is_end=False)
        yield from _released(held)
    for bus in buses.values():
        bus.settle(is_end=True)
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
    direction[row] = _NUMBERS[directed.direction]
    return True


def _groups(*values: Array) -> Iterator[Array]:
    """The positions of equal values, in their order; of several arrays, those where all are equal."""
    order = np.arange(values[0].size)
    for each in reversed(values):
        order = order[np.argsort(each[order], kind="stable")]
    is_other = functools.reduce(operator.or_, (np.diff(each[order]) != 0 for each in values))
    return (places for places in np.split(order, np.flatnonzero(is_other) + 1) if places.size)


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


@dataclass(eq=False, kw_only=True)
class _Kind:
    """Frames of a class with the same content and mark; their `direction` is that of a request until it `is_open` no more.

    `nodes` are those that a frame concerns, each with whether it opens an exchange there if it is a request. If it
    `is_certain`, no data decide which frames answer it, and frames are not recorded twice. `verdicts` are what a later
    frame shows, by its kind, and whether it comes soon, is equal and opens an exchange.
    """

    mark: Mark | None
    direction: int
    is_open: bool
    """Whether both directions are possible."""
    nodes: Sequence[tuple[_Node, bool]]
    is_certain: bool
    within: int
    window: int
    verdicts: dict[tuple[_Kind, bool, bool, bool], int] = field(default_factory=dict)


class _Node:
    """A node of a bus: the place of its open request in the block, and the rules for frames that are decided one by one.

    These are in use if it `is_slow`; for them, the node is alone on its bus.
    """

    __slots__ = ("directions", "is_slow", "open")

    def __init__(self, directions: Directions) -> None:
        self.directions = directions
        self.open: int | None = None
        self.is_slow = False


class _Bus:
    """The state of a bus at the end of a block: its clock, and its nodes."""

    def __init__(self, edition: Edition, window: int | None, behaviour: Behaviour) -> None:
        self._edition = edition
        self._window = window
        self._behaviour = behaviour._replace(is_marked=True)
        self._sharing = _sharing(edition)
        self._numbers: dict[FrameClass, int] = {}
        self._rules: list[DirectionRule] = []
        self._kinds: dict[int, _Kind] = {}
        self._nodes: dict[int | None, _Node] = {}
        self._time: int | None = None
        self._clock = 0

    def add(self, held: _Held, rows: Array) -> None:
        """Decides on the frames of the bus in a block."""
        time, data = held.block.time[rows], _integers(held.block, rows)
        start = time[0] if self._time is None else self._time
        clock = self._clock + np.cumsum(np.maximum(np.diff(time, prepend=start), 0))
        self._time, self._clock = int(time[-1]), int(clock[-1])
        codes = self._codes(held.block, rows, data)
        known, of_rows = np.unique(codes, return_inverse=True)
        kinds = [None if code < 0 else self._kinds.get(code) or self._kind(code) for code in known.tolist()]
        own = codes >= 0
        directions = np.array([kind.direction if kind else UNKNOWN for kind in kinds], np.uint8)
        held.direction[rows[own]] = directions[of_rows[own]]
        if self._sharing is not _Sharing.NOTHING:
            listed = [kinds[number] for number in of_rows.tolist()]
            self._pair(_Frames(held, rows.tolist(), listed, clock.tolist(), data.tolist()))

    def settle(self, *, is_end: bool) -> None:
        """Decides on the waiting frames for which it is too late, or at the end of the log on all."""
        for node in self._nodes.values():
            if node.is_slow:
                node.directions.decide_pending("", None if is_end else self._clock)

    def _codes(self, block: FrameArrays, rows: Array, data: Array) -> Array:
        """Numbers of classes with their content and mark; negative if no message has the id."""
        classes = frame_classes(self._edition)
        if len(self._kinds) > MAX_CLASSES:
            for remembered in (self._numbers, self._rules, self._kinds):
                remembered.clear()
        ids = block.id[rows].astype(np.uint64) | block.kind[rows].astype(np.uint64) << 32
        ids |= block.length[rows].astype(np.uint64) << 40
        keys = np.zeros_like(data)
        for places in _groups(ids):
            keys[places] = data[places] & classes.id_class(_frame(block, rows[places[0]])).key_bits
        codes: Array = block.direction[rows].astype(np.intp)
        for places in _groups(ids, keys):
            frame = _frame(block, rows[places[0]])
            if not classes.id_class(frame).nodes:
                codes[places] = -1
                continue
            frame_class = classes.of(frame)
            number = self._numbers.setdefault(frame_class, len(self._rules))
            if number == len(self._rules):
                self._rules.append(DirectionRule(frame_class, self._behaviour, self._window))
            codes[places] |= number << 5 | self._rules[number].content(data[places]) << 2
        return codes

    def _kind(self, code: int) -> _Kind:
        """The frames of a class with a content and a mark."""
        rule, mark = self._rules[code >> 5], code & 3
        content = direction_by_content(rule, code >> 2 & 7)
        direction = REQUEST if content is None else _NUMBERS[content[0]]
        kind = self._kinds[code] = _Kind(
            mark=_MARKS[mark],
            direction=direction if mark == UNKNOWN else mark,
            is_open=mark == UNKNOWN and content is None,
            nodes=() if mark == UNKNOWN == direction else self._of_nodes(rule.frame_class),
            is_certain=not self._behaviour.copied and rule.frame_class.is_certain,
            within=rule.within,
            window=rule.window,
        )
        return kind

    def _of_nodes(self, frame_class: FrameClass) -> Sequence[tuple[_Node, bool]]:
        """The nodes to which a frame of a class is sent, with true, and those that can have sent it."""
        is_separate = self._sharing is _Sharing.IDS
        answers, opens = (
            {channel.node if is_separate else None for channel in channels}
            for channels in (frame_class.of_id.answers, [opened.channel for opened in frame_class.opens])
        )
        if len(answers) > 1:
            answers.discard(None)  # the channel of any node, to which no request is sent if the nodes are separate
        return [(self._node(node), node in opens) for node in answers | opens]

    def _node(self, node: int | None) -> _Node:
        if node not in self._nodes:
            default = None if self._sharing is _Sharing.IDS else self._edition
            known, behaviours = {("", node): self._edition}, {"": self._behaviour}
            self._nodes[node] = _Node(Directions(known, default, window=self._window, behaviours=behaviours))
        return self._nodes[node]

    def _pair(self, frames: _Frames) -> None:
        """Decides on the frames that can be requests or replies."""
        _, rows, kinds, clock, data = frames
        replies = []
        for at, kind in enumerate(kinds):
            for node, opens in kind.nodes if kind else ():
                if node.is_slow:
                    frames.decide(node, at)
                    continue
                verdict, before = _ENDS, node.open
                if before is not None:
                    node.open, first, gap = None, kinds[before], clock[at] - clock[before]
                    assert kind and first
                    if gap <= first.window:
                        shown = kind, gap <= first.within, data[at] == data[before], opens
                        verdict = first.verdicts.get(shown) or frames.verdict(node, before, at)
                        first.verdicts[shown] = verdict
                    if verdict == _CLOSES:
                        replies.append(rows[at])
                        continue
                    if verdict == _UNCERTAIN:
                        frames.decide(node, before)
                        frames.decide(node, at)
                        continue
                assert kind
                if not kind.is_certain:
                    frames.decide(node, at)
                elif opens and kind.direction != REPLY:
                    node.open = at
        frames.held.direction[replies] = REPLY
        for node in self._nodes.values():
            if node.open is not None:
                frames.decide(node, node.open)
                node.open = None


class _Frames(NamedTuple):
    """The frames of a bus in a block."""

    held: _Held
    rows: Sequence[int]
    kinds: Sequence[_Kind | None]
    clock: Sequence[int]
    data: Sequence[int]

    def decide(self, node: _Node, at: int) -> None:
        """Decides on a frame by the rules of its node, which decide on the next ones until no exchange is open."""
        kind = self.kinds[at]
        result = node.directions.accept(self._frame(at))
        if kind is not None and kind.is_open:
            self.held.waiting.append((self.rows[at], result))
        node.is_slow = not node.directions.is_idle("")

    def verdict(self, node: _Node, before: int, at: int) -> int:
        """What a frame shows of the open request before it."""
        _, second = [node.directions.accept(self._frame(place)) for place in (before, at)]
        still_open = {*node.directions.forget("")}
        if isinstance(second, PendingFrame) or not still_open <= {second.number}:
            return _UNCERTAIN
        return _ENDS if still_open else _CLOSES

    def _frame(self, at: int) -> LogFrame:
        """A frame as `Directions` reads it, on the bus of its node."""
        kind = self.kinds[at]
        return LogFrame(self.clock[at], "", _frame(self.held.block, self.rows[at]), kind.mark if kind else None)


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
