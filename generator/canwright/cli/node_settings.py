"""`--set`, `--window` and `--recorder`: what is known of a log."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import click

from ..model.edition import Edition
from ..model.message import Direction
from ..recordings.nodes import EDITION, NodeSetting
from ..semantics.configured import configured
from .common import full_name, stop
from .settings import check_value

recorder_option = click.option(
    "--recorder",
    type=click.Choice(["host", "node", "unknown"]),
    default="host",
    show_default=True,
    help="Who recorded the log, and so sent the frames that it marks as sent (Tx); if unknown, marks are ignored.",
)

settings_option = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="[[BUS:]NODE:]NAME=VALUE",
    help="A parameter or the edition, of all nodes or of one: --set size=12 --set 3:edition=v2.",
)
window_option = click.option(
    "--window",
    type=click.FloatRange(min=0, min_open=True, max=1e9),
    metavar="MS",
    callback=lambda _context, _option, window: None if window is None else int(window * 1_000_000),
    help="The time within which a request is answered.  [default: 2, or longer by the spec and the log]",
)
"""The command gets it in ns."""

differences_option = click.option(
    "--time-differences",
    "has_differences",
    is_flag=True,
    help="The times are since the frame before, as of `candump -td`. This is also seen where the first time is 0 and a "
    "later one is smaller than the one before.",
)

split_option = click.option(
    "--from-split",
    "is_split",
    is_flag=True,
    help="LOG is a file of `decode --split`: its channels 1 to 3 are bus 1, 4 to 6 bus 2.",
)


def direction_of(recorder: str) -> Direction | None:
    """The direction of the frames that a recorder sends; None if it is unknown."""
    return {"host": Direction.REQUEST, "node": Direction.REPLY}.get(recorder)


class Bus(NamedTuple):
    """What is known of a bus: the editions, with the parameters in their ids and constants, and the settings of nodes."""

    editions: Sequence[Edition]
    settings: Sequence[NodeSetting]


def bus_of(editions: Sequence[Edition], settings: Sequence[str]) -> Bus:
    """`--set [[BUS:]NODE:]NAME=VALUE`; the name is that of a parameter, or `edition`."""
    listed = _node_settings(editions, settings)
    in_ids = {parameter.name for edition in editions for parameter in edition.parameters if parameter.whole}
    for setting in listed:
        if setting.name in in_ids and setting.node is not None:
            text = f"`{setting.name}` is in ids or constants, so it applies to all nodes"
            stop(f"--set {setting.node}:{setting.name}={setting.value}: {text}; write {setting.name}={setting.value}")
    known = {setting.name: setting.value for setting in listed if isinstance(setting.value, str)}
    ours = {edition: configured(edition, known) for edition in editions}
    chosen = (s._replace(value=ours[s.value]) if isinstance(s.value, Edition) else s for s in listed)
    return Bus(list(ours.values()), list(chosen))


def _node_settings(editions: Sequence[Edition], settings: Sequence[str]) -> list[NodeSetting]:
    unique: dict[tuple[str | None, int | None, str], NodeSetting] = {}
    names = Counter(edition.name for edition in editions)
    shortest = {edition.name if names[edition.name] == 1 else full_name(edition): edition for edition in editions}
    by_name = {full_name(edition): edition for edition in editions} | shortest
    for setting in settings:
        left, _, value = setting.partition("=")
        scope, _, name = left.rpartition(":")
        bus, _, node = scope.rpartition(":")
        if scope and not (node.isascii() and node.isdigit()):
            stop(f"--set {setting}: `{node}` is not a node; write NODE:NAME=VALUE, for example 3:{name}={value}")
        chosen: Edition | str = by_name.get(value, value) if name == EDITION else value
        if isinstance(chosen, str):
            check_value(editions, setting, name, value, f"{EDITION}={'|'.join(shortest)}")
        node_setting = NodeSetting(bus or None, int(node) if scope else None, name, chosen)
        if unique.setdefault(node_setting[:3], node_setting) != node_setting:
            stop(f"--set {setting}: `{left}` is already set to another value; remove one")
    return list(unique.values())
