"""`--set` and `--recorder`: what is known of a log."""

from __future__ import annotations

from collections.abc import Sequence

import click

from ..model.edition import Edition
from ..model.message import Direction
from ..recordings.nodes import EDITION, NodeSetting
from .common import stop
from .settings import check_value

recorder_option = click.option(
    "--recorder",
    type=click.Choice(["host", "node"]),
    default="host",
    show_default=True,
    help="Who recorded the log, and so sent the frames that it marks as sent (Tx).",
)


def direction_of(recorder: str) -> Direction:
    """The direction of the frames that a recorder sends."""
    return Direction.REQUEST if recorder == "host" else Direction.REPLY


def node_settings(editions: Sequence[Edition], settings: Sequence[str]) -> list[NodeSetting]:
    """`--set [[BUS:]NODE:]NAME=VALUE`; the name is that of a parameter, or `edition`."""
    unique: dict[tuple[str | None, int | None, str], NodeSetting] = {}
    by_name = {edition.name: edition for edition in editions}
    for setting in settings:
        left, _, value = setting.partition("=")
        scope, _, name = left.rpartition(":")
        bus, _, node = scope.rpartition(":")
        if scope and not (node.isascii() and node.isdigit()):
            stop(f"--set {setting}: `{node}` is not a node; write NODE:NAME=VALUE, for example 3:{name}={value}")
        chosen: Edition | str = by_name.get(value, value) if name == EDITION else value
        if isinstance(chosen, str):
            check_value(editions, setting, name, value, f"{EDITION}={'|'.join(by_name)}")
        node_setting = NodeSetting(bus or None, int(node) if scope else None, name, chosen)
        if unique.setdefault(node_setting[:3], node_setting) != node_setting:
            stop(f"--set {setting}: `{left}` is already set to another value; remove one")
    return list(unique.values())
