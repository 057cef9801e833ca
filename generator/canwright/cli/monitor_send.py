"""What the user of `monitor` sends: as by `request`, with the client of the package."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ..diagnostics.unicode_safety import visible
from ..model.edition import Edition
from ..model.types import Assignment
from ..recordings.nodes import Nodes
from ..targets.base import EditionInput
from ..targets.selected_nodes import selected_nodes
from .encode import written_values
from .monitor_feed import Feed, Receiver
from .python_package import PythonPackage
from .request import TIMEOUT, encoded_frames, exchanged, request_of, stop_command

EXAMPLE = "1 dim level=50"
"""What is written: the nodes, the command, and its values."""


class Prepared(NamedTuple):
    """Requests that can be sent."""

    package: PythonPackage
    requests: Sequence[Any]
    nodes: str
    numbers: Sequence[int]


class Sent(NamedTuple):
    """What became of requests. If an effect lacks consent, nothing was sent, and `consent` is the word that allows it."""

    text: str
    consent: str = ""


class Sender:
    """Sends requests on the bus of a feed."""

    def __init__(self, feed: Feed, receiver: Receiver, specifications: Sequence[EditionInput]) -> None:
        self._feed = feed
        self._receiver = receiver
        self._specifications = {(item.edition.family, item.edition.name): item for item in specifications}
        self._packages: dict[object, PythonPackage] = {}

    def prepare(self, written: str) -> Prepared:
        """The requests of a text such as `1 dim level=50`. Raises ValueError."""
        words = written.split()
        if len(words) < 2:
            raise ValueError(f"write nodes, command and values, such as {EXAMPLE}")
        nodes, command, *values = words
        numbers = selected_nodes(nodes, ())
        edition, given = self._known(numbers)
        selected_nodes(nodes, [edition])
        message = request_of(edition, command, given)
        frames = encoded_frames(edition, message, numbers, written_values(values), given)
        package = self._package(edition, given)
        return Prepared(package, [package.request(message, *pair) for pair in frames.items()], nodes, numbers)

    def send(self, prepared: Prepared, allow: str) -> Sent:
        """Sends requests if all of their effects are allowed."""
        package, requests, nodes, numbers = prepared
        receiver, chosen = self._receiver, map(package.node, numbers)
        client = package.client.Client(receiver, chosen, timeout=TIMEOUT, on_exit="nothing", notifier=receiver)
        with client:
            replies, errors = exchanged(package, client, requests, allow)
        for error in errors:
            if isinstance(error, package.client.ConsentError):
                return Sent(f"{error.reason}.", error.consent)
        texts = [str(error) for error in errors]
        if replies or not errors:
            count = f"{len(replies)} {'reply' if len(replies) == 1 else 'replies'}"
            texts.insert(0, f"{requests[0].COMMAND} was sent, {count}")
        stopping = stop_command(package, requests[0])
        return Sent("; ".join([*texts, *([f"to stop: {nodes} {stopping}"] if stopping else [])]))

    def _known(self, numbers: Sequence[int]) -> tuple[Edition, Assignment]:
        """The edition and the parameters of nodes. Raises ValueError if they are unknown or differ."""
        nodes, bus = self._feed.nodes, self._receiver.bus
        known = [(edition_of(nodes, bus, number), nodes.assignment(bus, number) if nodes else {}) for number in numbers]
        edition, given = known[0]
        if any(pair != known[0] for pair in known):
            raise ValueError("these nodes have different editions or parameters; send to each of them alone")
        return edition, given

    def _package(self, edition: Edition, given: Assignment) -> PythonPackage:
        key = edition.family, edition.name, tuple(sorted(given.items()))
        if key not in self._packages:
            self._packages[key] = PythonPackage(self._specifications[key[:2]], given)
        return self._packages[key]


def edition_of(nodes: Nodes | None, bus: str, number: int) -> Edition:
    """The edition of a node. Raises ValueError if it is unknown, or if several fit."""
    choices = nodes.identified.get((bus, number)) if nodes else None
    edition = choices[-1].edition if choices else nodes.editions.get((bus, number), nodes.default) if nodes else None
    if edition is None:
        raise ValueError(f"the edition of node {number} is unknown; start with --set edition=NAME")
    if choices and choices[-1].others:
        raise ValueError(f"{visible(choices[-1].label)} fit node {number}; start with --set {number}:edition=NAME")
    return edition
