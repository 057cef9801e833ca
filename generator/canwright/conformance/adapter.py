"""What every target must answer: decode this, encode this, does this answer that."""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import ClassVar

from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Direction, Message
from ..model.refusal import Refusal
from ..model.types import NO_PARAMETERS
from ..semantics.confusion import is_confused
from ..semantics.frame import CanFrame as CanFrame
from ..targets.base import EditionInput, Output

Raw = int | list[int]
Value = float | str | list[str] | list[float] | None
"""A number in its unit, an enum member's name, the names of set flags, an array of numbers, or None for no value."""

ExactValue = Fraction | str | list[Fraction | str]


@dataclass(frozen=True)
class Decoded:
    """What a target read: the command whose message it is, the node, every field, and which of several codes it has."""

    command: str
    node: int | None
    raw: Mapping[str, Raw]
    values: Mapping[str, Value]
    code: int | None = None


@dataclass(frozen=True)
class Refused:
    """A target's no, in the words of `Refusal`, with the field where there is one."""

    says: Refusal
    field: str | None = None


class Cannot(Exception):  # noqa: N818 - it is no error
    """The case needs something that the target has no words for; `name` is in the adapter's `cannot`."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


Parameters = Mapping[str, int | str | Fraction]


class Adapter(ABC):
    """One target for one edition, driven as its user would drive it.

    `cannot` lists what the target has no words for, by name, with the reason; it raises `Cannot` for such a case, and
    the runner counts those and shows them. `tolerance` is how far, in relation, a value may be off.
    """

    name: ClassVar[str]
    cannot: ClassVar[Mapping[str, str]] = {}
    tolerance: ClassVar[float] = 0.0
    reports_code: ClassVar[bool] = False
    """Whether a decoded message says which of several codes the frame has."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition

    @classmethod
    @abstractmethod
    def create(cls, specification: EditionInput, workdir: Path) -> Adapter:
        """The adapter of an edition; what it generates goes below `workdir`."""

    @abstractmethod
    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        """Decodes a frame as the message of the command `expected`; None decodes it by itself."""

    @abstractmethod
    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        """Encodes raw integers, with one of the accepted codes; None leaves it out."""

    @abstractmethod
    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused: ...

    @abstractmethod
    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None: ...

    def message_of(self, direction: Direction, command: str) -> Message:
        """The request or the reply of a command."""
        message = self.edition.command(command).message(direction)
        assert message is not None, f"{command} has no {direction.value}"
        return message


def means_another(message: Message, encoded: CanFrame | Refused) -> bool:
    """Whether a written frame is identified as another message."""
    if isinstance(encoded, Refused):
        return False
    return any(is_confused(confusion, encoded) for confusion in message.confusions)


class DecodeOnlyAdapter(Adapter):
    """A target that encodes nothing; `encode` is one of the names in its `cannot`."""

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        raise Cannot("encode")

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        raise Cannot("encode")


def assignment(parameters: Parameters) -> dict[str, str | Fraction]:
    """Parameters as the model has them."""
    return {name: str(value) if isinstance(value, int) else value for name, value in parameters.items()}


def write_files(outputs: Iterable[Output], workdir: Path) -> Path:
    """Writes what a target generates into a new folder."""
    into = workdir / str(next(_COUNT))
    for output in outputs:
        file = into / output.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(output.text, "utf-8")
    return into


_COUNT = itertools.count()


def joined_value(field: Field, raw: Raw) -> Value:
    """The value of a field with joined elements, for a target that has only these."""
    assert field.type.joined is not None and isinstance(raw, list)
    value = field.type.joined.value(raw)
    return float(value) if isinstance(value, Fraction) else value
