"""`request`."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from ..diagnostics.unicode_safety import visible
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Message
from ..model.metadata import Consent
from ..model.types import Assignment
from ..recordings.bus_log import sentence
from ..semantics.configured import configured
from ..semantics.frame import CanFrame
from ..targets.selected_nodes import selected_nodes
from .bus import BusArguments, bus_options, opened_bus
from .command_view import find
from .common import FINDINGS, of_edition, read, spec_option, stop
from .encode import encoded, meaning_of, written_values
from .python_package import PythonPackage, model_frame, model_reply, only_edition
from .settings import assignment, known_values
from .terminal import print_text

TIMEOUT = 0.2
"""Seconds; longer than the default of programs, for adapters and systems that are slow."""


@click.command()
@click.argument("command")
@click.argument("values", nargs=-1, metavar="[FIELD=VALUE]...")
@spec_option
@click.option("--node", "nodes", required=True, metavar="NODES", help="The nodes to ask, such as 1 or 1..4.")
@click.option("--edition", help="The edition of the nodes.  [default: the only one]")
@click.option("--set", "settings", multiple=True, metavar="PARAMETER=VALUE", help="A parameter of the nodes.")
@click.option(
    "--allow",
    multiple=True,
    type=click.Choice([consent.value for consent in Consent if consent is not Consent.NONE]),
    help="An effect that is allowed; may be given several times.",
)
@click.option(
    "--timeout",
    type=click.FloatRange(min=0, min_open=True, max=3600),
    default=TIMEOUT,
    show_default=True,
    help="The time in seconds to wait for a reply, beyond the time that the specification states.",
)
@click.option("--measure", type=click.IntRange(min=2), metavar="N", help="Ask N times, and print the round trip.")
@bus_options
def request(
    command: str,
    values: Sequence[str],
    specs: Sequence[Path],
    nodes: str,
    edition: str | None,
    settings: Sequence[str],
    allow: Sequence[str],
    timeout: float,
    measure: int | None,
    bus_arguments: BusArguments,
) -> None:
    """Send a COMMAND to nodes on a bus, and print the replies in units.

    COMMAND and VALUES are those of `canwright encode`, which sends nothing. What moves a node, wears or changes it is sent
    only with the consent that `canwright show COMMAND` states. A node that moves is not stopped at the end. Options of the
    bus have the names of python-can's own commands; what is not given is in its configuration file can.conf.

    \b
      canwright request read_level --node 1 -i socketcan -c can0
      canwright request dim level=50 --node 1..4 --allow motion -i pcan -c PCAN_USBBUS1 -b 500000
      canwright request read_level --node 1 --measure 1000 -i socketcan -c can0

    Exit status: 0 if every node replied, 1 if a request was refused or has no reply, 2 if the command could not run or the
    bus does not work any more.
    """
    chosen = of_edition(read(specs, packaged=True), edition)
    specification = only_edition(chosen, "give the one of the nodes, which `canwright scan` finds: --edition")
    given = assignment([specification], settings)
    ours = configured(specification.edition, given)
    try:
        message, written = request_of(ours, command, given), written_values(values)
    except ValueError as error:
        stop(str(error))
    try:
        numbers = selected_nodes(nodes, [ours])
    except ValueError as error:
        stop(f"--node {visible(nodes)}: {error}")
    try:
        frames = encoded_frames(ours, message, numbers, written, given)
    except ValueError as error:
        print_text(f"canwright: {error}\n", error=True)
        sys.exit(FINDINGS)
    package = PythonPackage(specification, given)
    requests = [package.request(message, node, frame) for node, frame in frames.items()]
    if measure and (
        requests[0].REPLIES != 1 or requests[0].REPLIERS or any(package.client.effects_of(each) for each in requests)
    ):
        stop(f"--measure is for commands with one reply and without effects; {message.command} is none")
    errors: Sequence[Any]
    with opened_bus(bus_arguments) as bus:
        chosen_nodes, bit_rate = map(package.node, numbers), bus_arguments.get("bitrate")
        client = package.client.Client(bus, chosen_nodes, timeout=timeout, bit_rate=bit_rate, on_exit="nothing")
        with client:
            if measure:
                errors = [lacking for each in requests for lacking in _measured(client, each, measure)]
            else:
                replies, errors = exchanged(package, client, requests, " ".join(allow))
                for reply in replies:
                    print_text(meaning_of(ours, model_reply(ours, reply), model_frame(reply), given))
    for reason in errors:
        if isinstance(reason, package.client.BusLost):
            stop(sentence(reason.__cause__ or reason))
        is_refused = isinstance(reason, package.client.ConsentError)
        text = f"{reason.reason}. To allow this, write --allow {reason.consent}" if is_refused else str(reason)
        print_text(f"canwright: {text}\n", error=True)
    if any(not isinstance(error, package.client.ConsentError) for error in errors or [None]):
        stopping = stop_command(package, requests[0])
        if stopping:
            print_text(f"to stop: canwright request {stopping} --node {nodes} ...\n", error=True)
    if errors:
        sys.exit(FINDINGS)


def request_of(edition: Edition, written: str, given: Assignment) -> Message:
    """The request of a command. Raises ValueError without one, with several, or if its reply depends on an unknown parameter."""
    pairs, hint = find([edition], written)
    if not pairs:
        raise ValueError(f"there is no command `{visible(written)}`; {hint}")
    if len(pairs) > 1:
        names = ", ".join(command.name for _, command in pairs)
        raise ValueError(f"`{visible(written)}` is several commands; write one: {names}")
    command = pairs[0][1]
    if command.request is None:
        raise ValueError(f"{command.name} has no request; nodes send it by themselves")
    lacking = [name for name in command.reply_parameters if name not in given and not command.ends_motion]
    if lacking:
        needed = " or ".join(known_values([edition], name) for name in lacking)
        raise ValueError(f"the reply of {command.name} depends on {', '.join(lacking)}; give --set {needed}")
    return command.request


def encoded_frames(
    edition: Edition, message: Message, nodes: Sequence[int], written: Mapping[str, str], given: Assignment
) -> dict[int | None, CanFrame]:
    """The frames of a request by node, or that of a broadcast. Raises ValueError with the reason why there is none."""
    has_node = message.id.nodes is not None or message.node_in_data is not None
    frames: dict[int | None, CanFrame] = {}
    for node in nodes if has_node else (None,):
        frame = encoded(edition, message, node, written, given)
        if isinstance(frame, str):
            raise ValueError(frame)
        frames[node] = frame
    return frames


def exchanged(
    package: PythonPackage, client: Any, requests: Sequence[Any], allow: str
) -> tuple[Sequence[Any], Sequence[Any]]:
    """The replies, and the reason of each that is missing."""
    first = requests[0]
    try:
        if first.REPLIES and not first.REPLIERS:
            outcomes = client.cycle(requests, allow=allow)
            errors = [each.error for each in outcomes if each.error]
            return [reply for each in outcomes for reply in each.replies], errors
        if first.REPLIES:
            replies = client.gather(first, allow=allow)
            wanted = first.REPLIES * sum(node in client.nodes for node in first.REPLIERS)
            text = f"{len(replies)} of {wanted} replies to {first} came in time"
            return replies, [package.client.NoReply(text)] if len(replies) < wanted else []
        for each in requests:
            client.send(each, allow=allow)
    except (package.client.ClientError, ValueError) as error:  # ValueError: it is for one of several nodes
        return (), (error,)
    return (), ()


def _measured(client: Any, request: Any, times: int) -> Sequence[Any]:
    """Prints the round trip of a request; returns the last error if there was no reply in time."""
    trips: list[float] = []
    errors: list[Any] = []
    is_certain = True
    for _ in range(times):
        start = time.perf_counter()
        outcome = client.cycle((request,))[0]
        if outcome.error:
            errors.append(outcome.error)
        elif is_certain:  # after a missing reply another read comes first
            trips.append(1000 * (time.perf_counter() - start))
        is_certain = not outcome.error
    print_text(f"node {request.node}: {times - len(errors)} of {formatting.counted(times, 'request')} answered\n")
    if trips:
        trips.sort()
        p50, p99 = (trips[math.ceil(len(trips) * share) - 1] for share in (0.5, 0.99))
        print_text(f"  round trip: p50 {p50:.3f} ms, p99 {p99:.3f} ms, longest {trips[-1]:.3f} ms\n")
        advised = math.ceil(2 * trips[-1]) / 1000
        print_text(f"  time-out to use, twice the longest: {advised} s, as Client(..., timeout={advised})\n")
    return errors[-1:]


def stop_command(package: PythonPackage, request: Any) -> str | None:
    """The command that stops nodes, if a request may move them."""
    facts = package.edition.client_facts
    stop_request = facts.ends_motion.get("stop")
    may_move = any(facts.effects[name][1] == Consent.MOTION.value for name in package.client.effects_of(request))
    is_needed = may_move and stop_request and type(request) not in facts.ends_motion.values()
    return str(stop_request.COMMAND) if is_needed else None
