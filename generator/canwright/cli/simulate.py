"""`simulate`."""

from __future__ import annotations

import sys
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from ..diagnostics.unicode_safety import visible
from ..language import notation
from ..model.formatting import counted
from ..recordings.bus_log import errors_of_use, lost, sentence
from ..targets.selected_nodes import selected_nodes
from . import INTERRUPTED
from .bus import BusArguments, bus_options, opened_bus, returns_own_frames
from .common import of_edition, read, spec_option, stop
from .encode import written_values
from .settings import assignment
from .terminal import print_text

SECONDS = click.FloatRange(min=0, max=3600)


class Rate(click.ParamType):  # type: ignore[type-arg]
    """A share such as 1% or 0.01."""

    name = "rate"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            share = notation.rational(str(value).removesuffix("%")) / (100 if str(value).endswith("%") else 1)
        except ValueError:
            share = notation.number("-1")
        if not 0 <= share <= 1:
            self.fail(f"`{visible(str(value))}` is not a share from 0 to 1; write it as 1% or 0.01", param, ctx)
        return float(share)


_FAULTS = (
    ("loss", Rate(), "Requests and replies that are lost, such as 1%."),
    ("late", Rate(), "Replies that come late."),
    ("late-by", SECONDS, "How late they come, in seconds.  [default: 0.05]"),
    ("twice", Rate(), "Replies that are sent twice."),
    ("corrupt", Rate(), "Replies in which one bit is wrong."),
    ("echo", Rate(), "Requests that come back to their sender before the reply."),
    ("silence", Rate(), "Requests after which the node is silent."),
    ("silent-for", SECONDS, "How long it is silent, in seconds.  [default: 1]"),
    ("power-loss", Rate(), "Requests before which the node starts again, with its first values."),
    ("seed", int, "Another number gives other faults.  [default: 1]"),
)
"""The options of `Faults` of the package."""


def _fault_options(function: Callable[..., None]) -> Callable[..., None]:
    for name, type_, text in reversed(_FAULTS):
        function = click.option(f"--{name}", type=type_, help=text)(function)
    return function


@click.command()
@click.argument("words", nargs=-1, metavar="[EDITION] [NAME=VALUE]...")
@spec_option
@click.option("--node", "nodes", required=True, metavar="NODES", help="The nodes, such as 1..4 or 1,3.")
@click.option("--set", "settings", multiple=True, metavar="PARAMETER=VALUE", help="A parameter of the nodes.")
@click.option("--delay", type=SECONDS, default=0.0, help="The time from a request to its reply, in seconds.")
@click.option("--behaviour", metavar="FILE.py:CLASS", help="A class of yours that changes the values as time passes.")
@_fault_options
@bus_options
def simulate(
    words: Sequence[str],
    specs: Sequence[Path],
    nodes: str,
    settings: Sequence[str],
    delay: float,
    behaviour: str | None,
    bus_arguments: BusArguments,
    **faults: Any,
) -> None:
    """Answer on a bus as nodes of an EDITION do, without hardware.

    The nodes answer each request as the specification says, and keep what is written: these are the simulated nodes of the
    generated Python package. Nothing moves by itself: for that, --behaviour names a class as in the README of that package, of
    which each node gets an object. NAME=VALUE is the first value of a field of a reply, in its unit. Options of the bus have the
    names of python-can's own commands; what is not given is in its configuration file can.conf. Ctrl-C ends and prints what was
    counted.

    \b
      canwright simulate v1 --node 1..4 -i socketcan -c vcan0
      canwright simulate v1 level=50 --node 1..4 -i udp_multicast --loss 1%

    Exit status: 130 after Ctrl-C, 2 if the bus cannot be opened or does not work any more, or if the class raises an error.
    """
    from .python_package import PythonPackage, only_edition

    editions = [word for word in words if "=" not in word]
    if len(editions) > 1:
        stop(f"`{visible(editions[1])}` is not a value; write NAME=VALUE")
    specification = only_edition(
        of_edition(read(specs, packaged=True), next(iter(editions), None)),
        "write the one to simulate: canwright simulate EDITION",
    )
    family, name = specification.edition.family, specification.edition.name
    try:
        numbers = selected_nodes(nodes, [specification.edition])
    except ValueError as error:
        stop(f"--node {visible(nodes)}: {error}")
    package = PythonPackage(specification, assignment([specification], settings), behaviour)
    try:
        values = package.first_values(written_values([word for word in words if "=" in word]))
    except ValueError as error:
        stop(str(error))
    chosen = package.simulation.Faults(**{key: value for key, value in faults.items() if value is not None})
    with opened_bus(bus_arguments) as bus, _warnings_as_lines():
        simulated, own_frames = map(package.node, numbers), returns_own_frames(bus_arguments)
        options = {"delay": delay, "faults": chosen, "own_frames": own_frames}
        simulation = package.simulation.Simulation(bus, simulated, package.behaviour, **options)
        for node in simulation.nodes.values():
            node.start_with(values)
        listed = f"node {nodes}" if len(numbers) == 1 else f"nodes {nodes}"
        print_text(f"{family} {name}, {listed}; Ctrl-C ends\n", error=True)
        try:
            simulation.run()
        except KeyboardInterrupt:
            pass
        except Exception as error:
            if place := _place_in(behaviour, error):
                stop(f"--behaviour {visible(place)}: {type(error).__name__}: {sentence(error)}")
            if not isinstance(error, errors_of_use()):
                raise
            stop(lost(error))
        finally:
            received = f"{counted(simulation.received, 'frame')} received"
            text = f"{received}, {simulation.answered} sent, {simulation.rejected} of no request to these nodes"
            print_text(f"{text}\n")
    sys.exit(INTERRUPTED)


def _place_in(behaviour: str | None, error: Exception) -> str:
    """Where the file of a behaviour raised an error, as FILE.py:LINE; empty if something else did."""
    file = behaviour.rpartition(":")[0] if behaviour else ""
    calls = traceback.extract_tb(error.__traceback__)
    return next((f"{file}:{call.lineno}" for call in reversed(calls) if file and call.filename == file), "")


@contextmanager
def _warnings_as_lines() -> Iterator[None]:
    """Prints the requests that a node cannot answer, each once."""
    with warnings.catch_warnings():
        warnings.simplefilter("default", UserWarning)
        warnings.showwarning = lambda message, *_: print_text(
            f"canwright: {message}; here, give --set PARAMETER=VALUE\n", error=True
        )
        yield
