"""The edition and the parameters of each node of a log: given by the user, or identified from the first frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ..model.edition import Edition
from ..model.types import Assignment
from ..semantics.frame import CanFrame, has_id
from .identify import identify
from .recorded import Recorded
from .results import NodeResult

IDENTIFIED_FROM = 20_000
"""The number of frames at the start of a log from which editions are identified."""


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
    """The edition of a node, None if none fits, and the others that fit equally well.

    It is assumed if most requests to the node have no reply: then it is an edition of other nodes of the bus.
    """

    edition: Edition | None
    others: tuple[Edition, ...] = ()
    is_assumed: bool = False


@dataclass(frozen=True)
class Nodes:
    """The editions and parameters of the nodes of a log. `default` is the edition of nodes without an entry."""

    editions: Mapping[tuple[str, int | None], Edition]
    default: Edition | None
    identified: Mapping[tuple[str, int | None], Choice]
    settings: Sequence[NodeSetting]

    def assignment(self, bus: str, node: int | None) -> Assignment:
        """The parameters of a node. A setting of the node replaces one of all nodes."""
        found: dict[str, str] = {}
        for setting in sorted(self.settings, key=lambda one: (one.node is not None, one.bus is not None)):
            if isinstance(setting.value, str) and setting.applies(bus, node):
                found[setting.name] = setting.value
        return found


def nodes_of(start: Sequence[Recorded], editions: Sequence[Edition], settings: Sequence[NodeSetting]) -> Nodes:
    """The nodes of a log that starts with some frames. All editions are of one family."""
    given = [setting for setting in settings if isinstance(setting.value, Edition)]
    default = next((one.value for one in given if one.bus is None and one.node is None), None)
    if default is None and len(editions) == 1:
        default = editions[0]
    assert default is None or isinstance(default, Edition)
    identified = {} if default else _identified(start, editions)
    chosen = {key: choice.edition for key, choice in identified.items() if choice.edition}
    if len({*chosen.values()}) == 1 and len(chosen) == len(identified):
        default = next(iter(chosen.values()))
    buses = dict.fromkeys(one.bus for one in start)
    for setting in sorted(given, key=lambda one: one.bus is not None):
        if setting.node is not None and isinstance(setting.value, Edition):
            for bus in buses if setting.bus is None else (setting.bus,):
                chosen[bus, setting.node] = setting.value
                identified.pop((bus, setting.node), None)
    return Nodes(chosen, default, identified, settings)


def family_of(start: Iterable[Recorded], editions: Sequence[Edition]) -> list[Edition]:
    """The editions of the family that has the ids of most frames."""
    families: dict[str, list[Edition]] = {}
    for edition in editions:
        families.setdefault(edition.family, []).append(edition)
    if len(families) == 1:
        return list(editions)
    ids = Counter((one.frame.id, one.frame.extended, one.frame.remote) for one in start)

    def explained(family: list[Edition]) -> int:
        messages = [message for edition in family for message in edition.all_messages()]
        return sum(
            count
            for (id_, extended, remote), count in ids.items()
            if any(has_id(message, CanFrame(id_, b"", extended, remote)) for message in messages)
        )

    return max(families.values(), key=explained)


def _identified(start: Sequence[Recorded], editions: Sequence[Edition]) -> dict[tuple[str, int | None], Choice]:
    """The edition of each node on each bus; of frames without a node only where no frames have one."""
    results = identify(start, editions).nodes
    having = {result.bus for result in results if result.node is not None}
    found = [result for result in results if result.node is not None or result.bus not in having]
    certain = [(result.bus, result.editions[0]) for result in found if len(result.editions) == 1]
    return {(result.bus, result.node): _choice(result, certain) for result in found}


def _choice(result: NodeResult, certain: Sequence[tuple[str, Edition]]) -> Choice:
    """Of several editions that fit, that of another node, if any."""
    fitting = result.editions
    if fitting:
        edition = next((one for _, one in certain if one in fitting), fitting[0])
        return Choice(edition, tuple(one for one in fitting if one is not edition))
    explained = [s.edition for s in result.scores if s.is_explained(result.judged)] if result.is_judged else []
    assumed = next((one for bus, one in certain if bus == result.bus and one in explained), None)
    return Choice(assumed, is_assumed=assumed is not None)
