"""Identification of the editions that a log fits, for each node of each bus.

No frame contains the edition, so the frames of each node are decoded with each edition, and this counts what an edition
does not explain: ids, codes, lengths, reserved bits, names and ranges. Some frames of a log are corrupted or belong to
other protocols, so an edition fits only if

- most frames of the node are a message of some edition, and the edition explains nearly all of these;
- most requests that have a reply are answered, unless the log lacks requests;
- there is not clearly more against it than against the best edition, in kinds of frames that are not rare.

Requests cannot decide: hosts leave reserved bits uncleared, and try codes. If several editions fit, the result lists all.

No edition explains all frames of a node that gets another firmware while a log is recorded. Then the log is divided in
two where most is explained, and each part is read for itself.
"""

from __future__ import annotations

import dataclasses
import functools
import operator
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from ..model.edition import Edition
from ..model.message import Direction
from ..semantics.frame import CanFrame
from .frame_classes import frame_classes
from .kept_frames import MAX_KEPT, Arrival, KeptFrames, Kind, NodeFrames
from .log_frame import LogFrame, new_tuple
from .parts import Runs, results
from .readings import EditionReader
from .results import Identification, NodeResult

MAX_KNOWN = 1 << 16
"""The maximum number of ids, and of kinds of frames of an id, that are remembered."""
MAX_FOREIGN = 1 << 10
"""The maximum number of foreign ids that are counted one by one."""
NEAR = 32
"""The number of frames of a log within which the next frame of a node is near."""
STRAY = 20
"""A node with at most one of so many frames as the busiest node of its bus is stray, if its frames are far apart."""


def identify(recorded: Iterable[LogFrame], editions: Sequence[Edition]) -> Identification:
    """The identification of the frames of a log. All editions are of one family."""
    identifier = Identifier(editions)
    for frame in recorded:
        identifier.add(frame)
    return identifier.result()


_NUMBER = operator.attrgetter("number")


class _Line:
    """The kinds of frames with one id and length on a bus, by the bits of their keys; these are None for a foreign id.

    The keys of one message can be values of another one, so that many are of one kind.
    """

    __slots__ = ("key_bits", "kinds", "of_messages")

    def __init__(self, key_bits: int | None) -> None:
        self.key_bits = key_bits
        self.kinds: dict[int, Kind] = {}
        self.of_messages: dict[tuple[object, ...], Kind] = {}


class Identifier:
    """Identifies the editions of the nodes of a log. Memory does not grow with the log.

    `recorder` is the direction of the frames that the log marks as sent; received ones have the other direction; None if
    marks do not count. A request is answered within `window` ns; None for the time that suits the editions and the log.
    At most `kept` frames are compared.
    """

    def __init__(
        self,
        editions: Sequence[Edition],
        recorder: Direction | None = Direction.REQUEST,
        window: int | None = None,
        kept: int = MAX_KEPT,
    ) -> None:
        self.editions = editions
        self._classes = [frame_classes(edition) for edition in editions]
        self._readers = [EditionReader(edition, editions, recorder, window) for edition in editions]
        self._lines: dict[tuple[str, int, bool, bool, int], _Line] = {}
        self._nodes: dict[tuple[str, int | None], NodeFrames] = {}
        self._kept = KeptFrames(kept)
        self._number = 0
        self._foreign: Counter[tuple[int, bool, bool]] = Counter()
        self._foreign_count = 0
        self._of_no_message = 0

    @property
    def unexplained(self) -> tuple[int, int]:
        """The number of frames that are no message of any edition, and of those whose id belongs to none."""
        return self._foreign_count + self._of_no_message, self._foreign_count

    def add(self, recorded: LogFrame) -> NodeFrames | None:
        """The next frame of the log; returns the frames of its node, None if its id belongs to no edition."""
        _, bus, frame, _ = recorded
        id_, content, extended, remote = frame
        number = self._number
        self._number = number + 1
        line = self._lines.get((bus, id_, extended, remote, len(content))) or self._line(bus, frame)
        if line.key_bits is None:
            self._foreign_count += 1
            foreign = id_, extended, remote
            if foreign in self._foreign or len(self._foreign) < MAX_FOREIGN:
                self._foreign[foreign] += 1
            return None
        key = int.from_bytes(content, "little") & line.key_bits
        kind = line.kinds.get(key) or self._kind(line, key, bus, frame)
        kind.count += 1
        self._of_no_message += not kind.is_message
        node = kind.node
        node.total += 1
        if number - node.last <= NEAR:
            node.near += 1
        node.last = number
        self._kept.add(new_tuple(Arrival, (number, recorded, kind)))
        return node

    def results_of(self, *nodes: NodeFrames) -> list[NodeResult]:
        """The result of each part of the frames of some nodes so far."""
        busiest: Counter[str] = Counter()
        for each in self._nodes.values():
            busiest[each.bus] = max(busiest[each.bus], each.total)
        listed, runs = [], self._runs()
        for node in nodes:
            is_stray = STRAY * node.total <= busiest[node.bus] and 2 * node.near < node.total
            parts = [*results(node, runs.get(node, ()), self._readers)]
            if len(parts) == 1:
                parts = [dataclasses.replace(parts[0], total=node.total)]
            listed += [dataclasses.replace(part, is_stray=is_stray) for part in parts]
        return listed

    def result(self) -> Identification:
        """The identification of the frames so far."""
        ordered = sorted(self._nodes.values(), key=lambda node: (node.bus, node.number or -1))
        nodes = tuple(_with_broadcasts(self.results_of(*ordered)))
        return Identification(self._number, self._foreign_count, dict(self._foreign.most_common()), nodes)

    def _line(self, bus: str, frame: CanFrame) -> _Line:
        """The frames with the id and length of a frame, remembered."""
        if len(self._lines) >= MAX_KNOWN:
            self._lines.clear()
        having = [own for own in (classes.id_class(frame) for classes in self._classes) if own.nodes]
        key_bits = functools.reduce(operator.or_, (own.key_bits for own in having), 0) if having else None
        line = self._lines[bus, frame.id, frame.extended, frame.remote, len(frame.data)] = _Line(key_bits)
        return line

    def _kind(self, line: _Line, key: int, bus: str, frame: CanFrame) -> Kind:
        """The frames with the keys of a frame, remembered."""
        if len(line.kinds) >= MAX_KNOWN:
            line.kinds.clear()
            line.of_messages.clear()
        forms = [form for classes in self._classes for form in classes.of(frame).forms]
        in_id = (number for classes in self._classes for number in classes.id_class(frame).nodes)
        number = next((n for n in (*in_id, *(form.node for form in forms)) if n is not None), None)
        node = self._nodes.get((bus, number))
        if node is None:
            node = self._nodes[bus, number] = NodeFrames(bus, number)
        alike = (node, *(form.message for form in forms)) if forms else (node, frame.data[:1])
        kind = line.kinds[key] = line.of_messages.setdefault(alike, Kind(node, is_message=bool(forms)))
        return kind

    def _runs(self) -> Mapping[NodeFrames, Runs]:
        """The kept frames of each node."""
        runs: dict[NodeFrames, list[Sequence[Arrival]]] = {}
        for run in self._kept.runs():
            by_node: dict[NodeFrames, list[Arrival]] = {}
            for arrival in run:
                by_node.setdefault(arrival.kind.node, []).append(arrival)
            to_all = {node.bus: own for node, own in by_node.items() if node.number is None}
            for node, own in by_node.items():
                is_asked = node.number is not None and node.bus in to_all
                merged = sorted(own + to_all[node.bus], key=_NUMBER) if is_asked else own
                runs.setdefault(node, []).append(merged)
        return runs


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
