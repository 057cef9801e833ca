"""`scan`."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..diagnostics.unicode_safety import visible
from ..model.edition import Edition
from ..model.formatting import counted
from ..model.message import Direction, Message
from ..model.types import Assignment
from ..recordings.bus_log import errors_of_use, lost
from ..recordings.by_python_can import recorded_frame
from ..recordings.explain import meanings
from ..recordings.log_frame import Counts, LogFrame, Mark
from ..recordings.nodes import Identifiers
from ..semantics.configured import configured
from ..semantics.exchange import is_read, reply_differs
from ..semantics.frame import CanFrame
from ..targets.python.runtime.exchange import Copies
from ..targets.selected_nodes import selected_nodes
from .bus import BusArguments, bus_options, opened_bus, returns_own_frames
from .common import FINDINGS, of_edition, read, spec_option, stop
from .decode_view import node_names
from .encode import encoded
from .identify import print_identification
from .settings import assignment
from .terminal import print_text

if TYPE_CHECKING:
    import can

MAX_NODES = 256
"""The most nodes that are asked if no nodes are given."""


@click.command()
@spec_option
@click.option("--edition", help="Ask for this edition only.  [default: all]")
@click.option("--node", "nodes", metavar="NODES", help="The nodes to look for, such as 1..4.  [default: all]")
@click.option("--set", "settings", multiple=True, metavar="PARAMETER=VALUE", help="A parameter of the nodes.")
@click.option(
    "--timeout",
    type=click.FloatRange(min=0, min_open=True, max=60),
    default=0.05,
    show_default=True,
    help="The time in seconds to wait for each reply.",
)
@bus_options
def scan(
    specs: Sequence[Path],
    edition: str | None,
    nodes: str | None,
    settings: Sequence[str],
    timeout: float,
    bus_arguments: BusArguments,
) -> None:
    """Find the nodes on a bus, and show which editions each of them fits.

    Only reads are sent: commands without values and effects, and none whose frame is another command in any of the
    editions. The result follows from the replies as that of `canwright identify`. Options of the bus have the names of
    python-can's own commands; what is not given is in its configuration file can.conf.

    \b
      canwright scan -i socketcan -c can0
      canwright scan --node 1..4 -i pcan -c PCAN_USBBUS1 -b 1000000

    Exit status: 0 if nodes answer and the edition of each is identified, 1 if not, 2 if the command could not run or the
    bus does not work any more.
    """
    specifications = of_edition(read(specs, packaged=True), edition)
    given = assignment(specifications, settings)
    probes = _Probes([configured(item.edition, given) for item in specifications], given)
    try:
        numbers = selected_nodes(nodes, probes.editions) if nodes else probes.nodes
    except ValueError as error:
        stop(f"--node {visible(nodes or '')}: {error}")
    if len(numbers) > MAX_NODES and not nodes:
        stop(f"there are {len(numbers)} nodes; give those to look for as --node {numbers[0]}..{numbers[0] + 31}")
    if not any(probes.first(number) for number in numbers):
        stop("no command is known to be a harmless read; a spec states effects, or all of its commands have values")
    with opened_bus(bus_arguments) as bus:
        scanner = _Scanner(bus, timeout, own_frames=returns_own_frames(bus_arguments) or None)
        try:
            recorded = {number: scanner.ask(probes.first(number)) for number in numbers}
            scanner.learn()
            answering = [number for number, frames in recorded.items() if probes.is_answered(number, frames)]
            for number in answering:
                fitting = _identifiers(probes.editions, recorded[number], timeout).best.result().nodes[0].editions
                recorded[number] += scanner.ask(probes.further(number, fitting or probes.editions))
        except errors_of_use() as error:
            stop(f"{lost(error)}; if nothing acknowledges frames, check power, wiring and bit rate")
    if scanner.errors:
        print_text(
            f"{counted(scanner.errors, 'error frame')}: check the bit rate, termination and wiring\n", error=True
        )
    if not answering:
        print_text(f"no answer of {node_names(numbers)}\n")
        sys.exit(FINDINGS)
    identifiers = _identifiers(probes.editions, [frame for number in answering for frame in recorded[number]], timeout)
    identification = identifiers.best.result()
    print_identification(identifiers.best.editions, identification, Counts())
    if not identification.is_complete:
        sys.exit(FINDINGS)


def _identifiers(editions: Sequence[Edition], frames: Iterable[LogFrame], timeout: float) -> Identifiers:
    identifiers = Identifiers(editions, Direction.REQUEST, int(timeout * 1e9))
    for frame in frames:
        identifiers.add(frame)
    return identifiers


class _Probes:
    """The frames of reads that are harmless in every edition."""

    def __init__(self, editions: Sequence[Edition], given: Assignment) -> None:
        self.editions = editions
        self._given = given
        self._reads = {edition: [*self._harmless(edition)] for edition in editions}
        """The requests of each edition, those whose reply cannot equal them first."""
        messages = [message for reads in self._reads.values() for message in reads]
        self.nodes = sorted({node for message in messages for node in message.id.nodes or ()})

    def first(self, node: int) -> list[CanFrame]:
        """A read that all editions have; without one, a read of each edition."""
        known = [self._frames(edition, node) for edition in self.editions]
        common = [frame for frame in known[0] if all(frame in frames for frames in known)]
        return common[:1] or list(dict.fromkeys(frame for frames in known for frame in frames[:1]))

    def further(self, node: int, editions: Sequence[Edition]) -> list[CanFrame]:
        """The other reads of some editions."""
        frames = (frame for edition in editions for frame in self._frames(edition, node))
        return [frame for frame in dict.fromkeys(frames) if frame not in self.first(node)]

    def is_answered(self, node: int, frames: Iterable[LogFrame]) -> bool:
        """Whether one of the frames is a reply of a node."""
        received = {frame.frame for frame in frames if frame.mark is Mark.RECEIVED}
        possible = (m for frame in received for e in self.editions for m in meanings(e, frame, self._given))
        return any(m.direction is Direction.REPLY and m.message and m.node in (node, None) for m in possible)

    def _frames(self, edition: Edition, node: int) -> list[CanFrame]:
        frames = (encoded(edition, message, node, {}, self._given) for message in self._reads[edition])
        return [frame for frame in frames if isinstance(frame, CanFrame)]

    def _harmless(self, edition: Edition) -> Iterator[Message]:
        differing: dict[Message, bool] = {}
        for command in edition.commands:
            if is_read(edition, command) and command.request:
                node = command.request.id.nodes[0] if command.request.id.nodes else 1
                frame = encoded(edition, command.request, node, {}, self._given)
                if isinstance(frame, CanFrame) and self._is_harmless(frame):
                    differing[command.request] = reply_differs(edition, command)
        yield from sorted(differing, key=lambda message: not differing[message])

    def _is_harmless(self, frame: CanFrame) -> bool:
        """Whether a frame is a read in every edition that has it."""
        return all(
            is_read(edition, edition.command(meaning.message.command))
            for edition in self.editions
            for meaning in meanings(edition, frame, self._given)
            if meaning.direction is Direction.REQUEST and meaning.message
        )


class _Scanner:
    """Asks on a bus, one frame after the other."""

    def __init__(self, bus: can.BusABC, timeout: float, *, own_frames: bool | None) -> None:
        self.errors = 0
        self._bus = bus
        self._timeout = timeout
        self._copies = Copies(own_frames)
        self._sent = self._returned = 0

    def ask(self, frames: Iterable[CanFrame]) -> list[LogFrame]:
        """Sends frames, and returns them with what is received."""
        return [recorded for frame in frames for recorded in self._exchange(frame)]

    def learn(self) -> None:
        """Own frames are returned if each of them was, although most nodes do not exist."""
        if self._copies.returned is None:
            self._copies.learn(returned=self._returned == self._sent)

    def _exchange(self, frame: CanFrame) -> Iterator[LogFrame]:
        import can

        from ..targets.python.runtime.python_can import frame_of

        message = can.Message(
            arbitration_id=frame.id, is_extended_id=frame.extended, is_remote_frame=frame.remote, data=frame.data
        )
        start = time.monotonic()
        yield LogFrame(time.monotonic_ns(), "", frame, Mark.SENT)
        self._copies.add(frame_of(message))
        self._bus.send(message)
        self._sent += 1
        is_answered = False
        while not is_answered or self._copies.returned is None:
            received = self._bus.recv(max(0.0, start + self._timeout - time.monotonic()))
            if received is None:
                return
            if received.is_error_frame:
                self.errors += 1
            elif self._copies.take(frame_of(received)):
                self._returned += 1
            else:
                is_answered = True
                recorded = recorded_frame("", received)
                if isinstance(recorded, LogFrame):
                    yield recorded._replace(time=time.monotonic_ns(), bus="", mark=Mark.RECEIVED)
