"""The generated Python package of an edition, imported: the command line has the client and the simulation of programs."""

from __future__ import annotations

import importlib
import runpy
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..conformance import modules
from ..conformance.adapter import write_files
from ..conformance.python import PythonAdapter
from ..diagnostics.diagnostic import nearest
from ..diagnostics.unicode_safety import visible
from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Direction, Message
from ..model.types import Assignment
from ..recordings.bus_log import sentence
from ..resolve import number_parameters
from ..semantics.decoder import Rejection
from ..semantics.encoder import Encoder
from ..semantics.frame import CanFrame
from ..targets.base import EditionInput
from ..targets.python.client_facts import node_variables
from ..targets.python.target import TARGET
from ..targets.python.text import attribute, class_name
from .common import full_name, stop
from .encode import advice, written_raw


def only_edition(specifications: Sequence[EditionInput], remedy: str) -> EditionInput:
    """The only one of the editions; stops if there are several, with what to write."""
    if len(specifications) > 1:
        names = ", ".join(full_name(item.edition) for item in specifications)
        stop(f"the frames of {names} differ; {remedy}")
    return specifications[0]


class PythonPackage:
    """The modules of the package, and the parameters of the nodes of a bus."""

    def __init__(self, specification: EditionInput, given: Assignment, behaviour: str | None = None) -> None:
        """`behaviour` is that of simulated nodes, as FILE.py:CLASS."""
        edition = specification.edition
        self._model, self._given = edition, given
        names = (edition.identifier, "nodes", "client", "simulation")
        with tempfile.TemporaryDirectory(prefix="canwright-") as folder:
            package = write_files(TARGET.packages([specification]), Path(folder))
            with modules.importable(package, edition.family):
                self.edition, self._nodes, self.client, self.simulation = (
                    importlib.import_module(f"{edition.family}.{name}") for name in names
                )
                self.behaviour = _class_in(behaviour) if behaviour else self.simulation.Behaviour
        adapter = PythonAdapter(edition, self.edition)
        self._parameters = adapter.parameters(number_parameters.assignment([edition], given))

    def node(self, number: int) -> Any:
        """A `Node` with the parameters."""
        return self._nodes.Node(self.edition, number, self._parameters)

    def first_values(self, written: Mapping[str, str]) -> dict[str, Any]:
        """The values of variables of a node, as they are written. Stops at what no reply contains."""
        known = {
            variable: (reply.message, field)
            for command in reversed(self._model.commands)
            for reply in command.replies
            for field, variable in node_variables(command, reply.message).items()
        }
        return {name: self._first_value(name, text, known) for name, text in written.items()}

    def _first_value(self, name: str, text: str, known: Mapping[str, tuple[Message, Field]]) -> Any:
        if name not in known:
            hint = nearest(name, known) or f"replies contain {', '.join(sorted(known))}"
            stop(f"no reply contains `{visible(name)}`; {hint}")
        message, field = known[name]
        raw = written_raw(Encoder(self._given), field, text)
        if isinstance(raw, Rejection):
            raw = advice(self._model, raw, field, self._given)
        if isinstance(raw, str):
            stop(f"{name}={visible(text)}: {raw}")
        class_, own = getattr(self.edition, class_name(message.name)), attribute(field.name)
        try:
            return class_.TYPES[own].value(raw, self._parameters, own)
        except self.edition.CodecError:  # it has no scale
            return raw

    def request(self, message: Message, node: int | None, frame: CanFrame) -> Any:
        """The request in a frame."""
        class_ = getattr(self.edition, class_name(message.name))
        return class_.unpack(node, frame.id, frame.data, self._parameters)


def _class_in(written: str) -> Any:
    """The class that FILE.py:CLASS names. Stops if there is none."""
    path, _, name = written.rpartition(":")
    try:
        names = runpy.run_path(path)
    except Exception as error:  # any, of a file of the user
        stop(f"--behaviour {visible(written)}: {type(error).__name__}: {sentence(error)}; write FILE.py:CLASS")
    if not isinstance(names.get(name), type):
        classes = [name for name, value in names.items() if isinstance(value, type)]
        hint = nearest(name, classes) or "write FILE.py:CLASS"
        stop(f"--behaviour {visible(written)}: there is no class `{visible(name)}` in the file; {hint}")
    return names[name]


def model_frame(message: Any) -> CanFrame:
    """The frame of a decoded message, bit for bit."""
    return CanFrame(message.can_id, message.encode_unchecked(), extended=message.EXTENDED, remote=message.REMOTE)


def model_reply(edition: Edition, message: Any) -> Message:
    """The reply of the model that a message of the package is."""
    replies = (m for m in edition.all_messages() if m.direction is Direction.REPLY)
    return next(reply for reply in replies if class_name(reply.name) == type(message).__name__)
