"""The generated Python package of an edition, imported: the command line has the client and the simulation of programs."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..conformance import modules
from ..conformance.adapter import write_files
from ..conformance.python import PythonAdapter
from ..model.edition import Edition
from ..model.message import Direction, Message
from ..model.types import Assignment
from ..resolve import number_parameters
from ..semantics.frame import CanFrame
from ..targets.base import EditionInput
from ..targets.python.target import TARGET
from ..targets.python.text import class_name
from .common import stop


def only_edition(specifications: Sequence[EditionInput], remedy: str) -> EditionInput:
    """The only one of the editions; stops if there are several, with what to write."""
    if len(specifications) > 1:
        names = ", ".join(item.edition.name for item in specifications)
        stop(f"the frames of {names} differ; {remedy}")
    return specifications[0]


class PythonPackage:
    """The modules of the package, and the parameters of the nodes of a bus."""

    def __init__(self, specification: EditionInput, given: Assignment) -> None:
        edition = specification.edition
        names = (edition.identifier, "nodes", "client", "simulation")
        with tempfile.TemporaryDirectory(prefix="canwright-") as folder:
            package = write_files(TARGET.packages([specification]), Path(folder))
            self.edition, self._nodes, self.client, self.simulation = modules.load(
                package, *(f"{edition.family}.{name}" for name in names)
            )
        adapter = PythonAdapter(edition, self.edition)
        self._parameters = adapter.parameters(number_parameters.assignment([edition], given))

    def node(self, number: int) -> Any:
        """A `Node` with the parameters."""
        return self._nodes.Node(self.edition, number, self._parameters)

    def request(self, message: Message, node: int | None, frame: CanFrame) -> Any:
        """The request in a frame."""
        class_ = getattr(self.edition, class_name(message.name))
        return class_.unpack(node, frame.id, frame.data, self._parameters)


def model_frame(message: Any) -> CanFrame:
    """The frame of a decoded message, bit for bit."""
    return CanFrame(message.can_id, message.encode_unchecked(), extended=message.EXTENDED, remote=message.REMOTE)


def model_reply(edition: Edition, message: Any) -> Message:
    """The reply of the model that a message of the package is."""
    replies = (m for m in edition.all_messages() if m.direction is Direction.REPLY)
    return next(reply for reply in replies if class_name(reply.name) == type(message).__name__)
