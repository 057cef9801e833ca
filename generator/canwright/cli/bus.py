"""A bus of python-can as an argument: options with the names of python-can's own commands, and how it is opened."""

from __future__ import annotations

import contextlib
import functools
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from ..diagnostics.diagnostic import nearest
from ..diagnostics.unicode_safety import visible
from ..recordings.bus_log import sentence
from .common import stop

if TYPE_CHECKING:
    import can

BusArguments = Mapping[str, Any]
"""The arguments of `can.Bus`; what is not given comes from python-can's configuration file."""

EXAMPLE = "-i socketcan -c can0 -b 1000000"

_OPTIONS = (
    click.option("-i", "--interface", help="The interface of python-can, such as socketcan, pcan or slcan."),
    click.option("-c", "--channel", help="The channel of the interface, such as can0."),
    click.option("-b", "--bitrate", type=click.IntRange(min=1), help="The bit rate in bit/s."),
    click.option("--fd", is_flag=True, default=None, help="Open the bus for CAN FD."),
    click.option("--data-bitrate", type=click.IntRange(min=1), help="The bit rate of the data of CAN FD."),
    click.option(
        "--bus-kwargs",
        multiple=True,
        metavar="NAME=VALUE",
        help="A further argument of the interface; may be given several times.",
    ),
)


def bus_options(function: Callable[..., None]) -> Callable[..., None]:
    """The options of a bus; the command gets them as `bus_arguments`. Options that are not given are in `can.conf`."""

    @functools.wraps(function)
    def command(*arguments: Any, bus_kwargs: Sequence[str], **options: Any) -> None:
        given = {name: options.pop(name) for name in ("interface", "channel", "bitrate", "fd", "data_bitrate")}
        known = {name: value for name, value in given.items() if value is not None}
        function(*arguments, bus_arguments=known | _further(bus_kwargs), **options)

    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def _further(written: Sequence[str]) -> dict[str, str]:
    further: dict[str, str] = {}
    for item in written:
        name, equals, value = item.partition("=")
        name = name.replace("-", "_")
        if not equals or not name.isidentifier():
            stop(f"--bus-kwargs {visible(item)}: write NAME=VALUE, for example --bus-kwargs serial=1234")
        further[name] = value
    return further


@contextlib.contextmanager
def opened_bus(arguments: BusArguments) -> Iterator[can.BusABC]:
    """The bus; stops if it cannot be opened. Its own messages are not printed."""
    import can

    logging.getLogger("can").setLevel(logging.CRITICAL + 1)
    try:
        can.util.load_config(config={**arguments})
    except can.CanInterfaceNotImplementedError as error:
        written = arguments.get("interface") or ""
        hint = nearest(written, sorted(can.VALID_INTERFACES)) or f"give {EXAMPLE}, or write can.conf of python-can"
        stop(f"no bus: {sentence(error)}; {hint}")
    try:
        bus = can.Bus(**arguments)
    except Exception as error:  # each interface has its own
        stop(f"the bus cannot be opened: {sentence(error)}")
    try:
        yield bus
    finally:
        with contextlib.suppress(Exception):  # of a bus that is lost
            bus.shutdown()


def returns_own_frames(arguments: BusArguments) -> bool:
    """Whether a bus object gets the frames that it sends itself."""
    import can

    config = can.util.load_config(config={**arguments})
    return config["interface"] == "udp_multicast" or bool(config.get("receive_own_messages"))
