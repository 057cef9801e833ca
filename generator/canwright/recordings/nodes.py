"""The edition and the parameters of each node of a log: given by the user, or identified from the frames.

A log in a file is read twice: once to identify the editions, once to decode. Of a stream, frames of a node wait until its
edition is identified, at most LOOKAHEAD frames. Each time the stream has paused for PATIENCE seconds in all, it is enough
that some edition fits; the edition can change later.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..model.edition import Edition
from ..model.message import Direction
from ..model.types import Assignment
from .directions import Change, DirectedFrame
from .identify import Identifier
from .kept_frames import MAX_KEPT, NodeFrames
from .log_frame import LogFrame
from .readers import Log
from .results import Identification, NodeResult, Place

BLOCK = 64
"""The number of frames of a node after which it is examined for the first time."""
LOOKAHEAD = 2048
"""The maximum number of frames of a stream that wait until editions are identified."""
PATIENCE = 0.2
"""The time in seconds after which any edition that fits is enough. Only pauses of the stream count, so that the speed of
the computer does not change the results."""
Key = tuple[str, int | None]
"""A bus and a node."""


class NodeSetting(NamedTuple):
    """A parameter, or the edition, of a node; of all buses or nodes where these are None."""

    bus: str | None
    node: int | None
    name: str
    value: Edition | str

    def applies(self, bus: str, node: int | None) -> bool:
        return self.bus in (None, bus) and self.node in (None, node)


EDITION = "edition"
"""The name of a setting whose value is an edition."""


class Choice(NamedTuple):
    """The edition of a node from a frame on, None if none fits, and the others that fit equally well.

    The frames of the commands `differing` have another meaning in some of them. It is assumed if most requests to the node have no reply: then it is an edition of other nodes of the bus that
    explains the frames no worse than any.
    """

    start: Place
    edition: Edition | None
    others: tuple[Edition, ...] = ()
    differing: frozenset[str] = frozenset()
    is_assumed: bool = False
    is_stray: bool = False

    @property
    def label(self) -> str:
        """The names of all editions that fit: `v1`, `v1|v2`."""
        return "|".join(edition.name for edition in (self.edition, *self.others) if edition)


class Misread(NamedTuple):
    """Frames of a stream, from a number to another, that were read with another edition than fits all frames."""

    bus: str
    node: int | None
    start: int
    end: int
    label: str
    edition: Edition


class Nodes:
    """The editions and parameters of the nodes of a log. `default` is the edition of nodes without an entry.

    `editions` are those at the start of the log, and `changes` the later ones by number of a frame. `identified` has
    all choices that were not given by the user.
    """

    def __init__(
        self, family: Sequence[Edition], settings: Sequence[NodeSetting], default: Edition | None = None
    ) -> None:
        self.family = family
        self.settings = settings
        self.default = default
        self.editions: dict[Key, Edition] = {}
        self.changes: dict[int, list[Change]] = {}
        self.identified: dict[Key, list[Choice]] = {}
        self.misread: list[Misread] = []

    def assignment(self, bus: str, node: int | None) -> Assignment:
        """The parameters of a node. A setting of the node replaces one of all nodes."""
        return {name: value for _, _, name, value in self._settings_of(bus, node) if isinstance(value, str)}

    def _settings_of(self, bus: str, node: int | None) -> Sequence[NodeSetting]:
        """The settings of a node, after those of all nodes."""
        own = (setting for setting in self.settings if setting.applies(bus, node))
        return sorted(own, key=lambda setting: (setting.node is not None, setting.bus is not None))

    def label(self, judged: DirectedFrame) -> str:
        """The names of the editions that fit the node of a frame; exactly one if it is identified or given."""
        if judged.edition is None:
            return ""
        choices = self.identified.get((judged.recorded.bus, judged.node))
        if choices is None:
            return judged.edition.name
        if len(choices) == 1:
            return choices[0].label or judged.edition.name
        number = bisect_right([choice.start.number for choice in choices], judged.number)
        return choices[max(0, number - 1)].label or judged.edition.name

    def choose(self, bus: str, node: int | None, choice: Choice) -> None:
        """Adds a choice, unless the user has given the edition of the node."""
        key = bus, node
        given = [value for *_, value in self._settings_of(bus, node) if isinstance(value, Edition)]
        if given:
            self.editions[key] = given[-1]
            return
        choices = self.identified.setdefault(key, [])
        choices.append(choice)
        if len(choices) > 1 or choice.start.number:
            self.changes.setdefault(choice.start.number, []).append(Change(bus, node, choice.edition))
        elif choice.edition is not None:
            self.editions[key] = choice.edition

    def is_stray(self, bus: str, node: int | None) -> bool:
        """Whether a node has few frames that are far apart, as frames with a damaged id are."""
        choices = self.identified.get((bus, node), ())
        return bool(choices) and all(choice.is_stray for choice in choices)

    def is_complete(self, commands: Mapping[Key, Collection[str]]) -> bool:
        """Whether the edition of every node, apart from stray ones, is known, not only assumed, and does not change.

        Several editions may fit a node if the frames of its `commands` have the same meaning in all of them.
        """
        listed = {key: choices for key, choices in self.identified.items() if not self.is_stray(*key)}
        is_known = all(
            len(own) == 1
            and own[0].edition
            and not own[0].is_assumed
            and own[0].differing.isdisjoint(commands.get(key, ()))
            for key, own in listed.items()
        )
        return is_known and not self.misread


def common_edition(editions: Sequence[Edition], settings: Sequence[NodeSetting]) -> Edition | None:
    """The edition that all nodes have: given by the user, or the only one; None if nodes can have different ones."""
    given = [(value, (bus, node)) for bus, node, _, value in settings if isinstance(value, Edition)]
    if any(place != (None, None) for _, place in given):
        return None
    return given[0][0] if given else editions[0] if len(editions) == 1 else None


class Identifiers:
    """Identifies the editions of a log whose family is unknown: the one with messages for most frames.

    Ids do not decide, because those of some families are nearly all ids. `recorder`, `window` and `kept` are those of `Identifier`.
    """

    def __init__(
        self,
        editions: Sequence[Edition],
        recorder: Direction | None,
        window: int | None = None,
        kept: int = MAX_KEPT,
    ) -> None:
        families = dict.fromkeys(edition.family for edition in editions)
        self._all = [Identifier([e for e in editions if e.family == name], recorder, window, kept) for name in families]

    def add(self, recorded: LogFrame) -> None:
        """The next frame of the log."""
        for identifier in self._all:
            identifier.add(recorded)

    @property
    def is_certain(self) -> bool:
        """Whether one family has messages for more frames than each other one."""
        return len(self._most_explained) == 1

    @property
    def best(self) -> Identifier:
        """The identifier of the family; of several with messages for the same frames, one whose editions fit most of them."""
        first, *rest = self._most_explained
        return min((first, *rest), key=_not_fitting) if rest else first

    @property
    def _most_explained(self) -> list[Identifier]:
        least = min(identifier.unexplained for identifier in self._all)
        return [identifier for identifier in self._all if identifier.unexplained == least]


def _not_fitting(identifier: Identifier) -> int:
    """The number of frames of nodes that no edition fits."""
    return sum(result.total for result in identifier.result().nodes if not result.editions)


def nodes_of(identifier: Identifier, settings: Sequence[NodeSetting]) -> Nodes:
    """The nodes of a log that has been identified."""
    nodes = Nodes(identifier.editions, settings)
    results = [*_with_nodes(identifier.result())]
    certain = _certain(results)
    for result in results:
        nodes.choose(result.bus, result.node, _choice(result, certain))
    return nodes


def follow(log: Log, identifiers: Identifiers, settings: Sequence[NodeSetting]) -> tuple[Nodes, Iterator[LogFrame]]:
    """The nodes of a stream, and its frames; later choices are added to the nodes before the frame is yielded."""
    frames = log.with_pauses()
    start: list[LogFrame] = []
    patience = _Patience(log)
    for frame in frames:
        if frame is not None:
            start.append(frame)
            identifiers.add(frame)
            if len(start) == LOOKAHEAD or (len(start) % (4 * BLOCK) == 0 and _is_decided(identifiers.best)):
                break
        if patience.is_over(frame) and identifiers.is_certain and _has_fitting(identifiers.best):
            break
    identifier = identifiers.best
    nodes = nodes_of(identifier, settings)
    return nodes, itertools.chain(start, _Following(identifier, nodes, len(start)).frames(frames, log))


class _Patience:
    """Measures the pauses of a stream."""

    def __init__(self, log: Log) -> None:
        self._log = log
        self._due = math.inf

    def is_over(self, frame: LogFrame | None) -> bool:
        """Whether there were PATIENCE seconds of pauses since it was over before, or since the first frame after that."""
        if self._log.waited > self._due:
            self._due = self._log.waited + PATIENCE if frame else math.inf
            return True
        if frame and self._due == math.inf:
            self._due = self._log.waited + PATIENCE
        return False


def _has_fitting(identifier: Identifier) -> bool:
    """Whether an edition fits each node: with few frames, as requests without their replies, often none does."""
    return all(result.editions for result in _with_nodes(identifier.result()))


def _is_decided(identifier: Identifier) -> bool:
    """Whether each node has enough frames, and exactly one edition fits it."""
    nodes = [result for result in _with_nodes(identifier.result()) if not result.is_stray]
    return bool(nodes) and all(result.frames >= BLOCK and len(result.editions) == 1 for result in nodes)


class _Following:
    """Identifies the editions of a stream while it is decoded."""

    def __init__(self, identifier: Identifier, nodes: Nodes, number: int) -> None:
        self._identifier = identifier
        self._nodes = nodes
        self._number = number
        self._held: deque[tuple[int, LogFrame, NodeFrames | None]] = deque()
        self._waiting: set[NodeFrames] = set()
        """New nodes whose edition is not chosen yet."""
        self._next: dict[NodeFrames, int] = {}
        """The number of frames of a node at which it is examined again."""

    def frames(self, frames: Iterable[LogFrame | None], log: Log) -> Iterator[LogFrame]:
        """The next frames of a stream, with its pauses; those of a new node wait."""
        patience = _Patience(log)
        for frame in frames:
            if frame is not None:
                node = self._identifier.add(frame)
                self._held.append((self._number, frame, node))
                if node is not None:
                    self._examine(node)
                self._number += 1
            if patience.is_over(frame):
                self._choose_fitting()
            while self._held and (self._held[0][2] not in self._waiting or len(self._held) > LOOKAHEAD):
                yield self._released()
        while self._held:
            yield self._released()
        self._finish()

    def _examine(self, node: NodeFrames) -> None:
        key = node.bus, node.number
        if node not in self._next:
            self._next[node] = BLOCK
            if key not in self._nodes.identified and key not in self._nodes.editions:
                self._waiting.add(node)
        if node.total >= self._next[node]:
            self._next[node] = node.total + max(BLOCK, node.total // 2)
            results = self._identifier.results_of(node)
            if node not in self._waiting or len(results[-1].editions) == 1:
                self._choose(node, results[-1])

    def _choose_fitting(self) -> None:
        """Chooses the editions of the nodes that wait, if any edition fits: with few frames often none does."""
        for node in [*self._waiting]:
            result = self._identifier.results_of(node)[-1]
            if result.editions:
                self._choose(node, result)

    def _released(self) -> LogFrame:
        _, frame, node = self._held[0]
        if node is not None and node in self._waiting:
            self._choose(node, self._identifier.results_of(node)[-1])
        self._held.popleft()
        return frame

    def _choose(self, node: NodeFrames, result: NodeResult) -> None:
        """Chooses the edition of a node for its first frame that waits, or the next one."""
        self._waiting.discard(node)
        number, time = next(((n, frame.time) for n, frame, of in self._held if of is node), (self._number, None))
        choice = _choice(result, ())._replace(start=Place(number, time))
        choices = self._nodes.identified.get((node.bus, node.number))
        if not choices or choices[-1][1:3] != choice[1:3]:
            self._nodes.choose(node.bus, node.number, choice)

    def _finish(self) -> None:
        """Lists the frames that were read with another edition than fits the whole stream."""
        results: dict[Key, list[NodeResult]] = {}
        for result in _with_nodes(self._identifier.result()):
            results.setdefault((result.bus, result.node), []).append(result)
        for key, choices in self._nodes.identified.items():
            parts = results.get(key, [])
            for part, end in zip(parts, [*(after.start for after in parts[1:]), None], strict=False):
                if len(part.editions) == 1:
                    last = end.number if end else self._number
                    first = part.start.number if part.start else 0
                    self._nodes.misread += _misread(key, choices, first, last, part.editions[0])


def _misread(key: Key, choices: Sequence[Choice], first: int, last: int, edition: Edition) -> Iterator[Misread]:
    """The frames from a number to another for which another edition was chosen."""
    ends = [*(choice.start.number for choice in choices[1:]), last]
    for choice, end in zip(choices, ends, strict=True):
        start, end = max(choice.start.number, first), min(end, last)
        if start < end and choice.edition is not edition:
            yield Misread(*key, start, end - 1, choice.label or "foreign", edition)


def _with_nodes(identification: Identification) -> Iterator[NodeResult]:
    """The results with a node; of frames without a node only where no frames have one."""
    having = {result.bus for result in identification.nodes if result.node is not None}
    return (result for result in identification.nodes if result.node is not None or result.bus not in having)


def _certain(results: Iterable[NodeResult]) -> Sequence[tuple[str, Edition]]:
    """The buses and editions of nodes that are not stray and fit exactly one."""
    return [*dict.fromkeys((r.bus, r.editions[0]) for r in results if len(r.editions) == 1 and not r.is_stray)]


def _choice(result: NodeResult, certain: Sequence[tuple[str, Edition]]) -> Choice:
    """Of several editions that fit, that of another node, if any."""
    start = result.start or Place(0, None)
    of_bus = [edition for bus, edition in certain if bus == result.bus]
    fitting = result.editions
    if result.is_stray and len(fitting) > 1:
        fitting = tuple(candidate for candidate in fitting if candidate in of_bus)
    if fitting:
        edition = next((candidate for _, candidate in certain if candidate in fitting), fitting[0])
        rest = tuple(candidate for candidate in fitting if candidate is not edition)
        return Choice(start, edition, rest, result.differing if rest else frozenset(), is_stray=result.is_stray)
    explained = [s for s in result.scores if s.is_explained(result.judged)] if result.is_judged else []
    least = min((score.score for score in explained), default=0)
    best = [score.edition for score in explained if score.score == least]
    assumed = next((candidate for candidate in of_bus if candidate in best), None)
    return Choice(start, assumed, is_assumed=assumed is not None, is_stray=result.is_stray)
