"""What every target must answer: decode this, encode this, does this answer that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.semantics.decoder import CanFrame as CanFrame

Raw = int | list[int]
Value = float | str | list[str] | list[float] | None
"""A number in its unit, an enum member's name, the names of set flags, an array of numbers, or None for no value."""

ExactValue = Fraction | str | list[Fraction | str]


@dataclass(frozen=True)
class Decoded:
    """What a target read: the command, the node and every field."""

    command: str
    node: int | None
    raw: Mapping[str, Raw]
    values: Mapping[str, Value]


@dataclass(frozen=True)
class Encoded:
    """What a target wrote."""

    id: int
    data: bytes
    extended: bool = False
    remote: bool = False


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


Parameters = Mapping[str, int | str]


class Adapter(Protocol):
    """One target, driven as its user would drive it.

    `cannot` lists what the target has no words for, by name, with the reason; it raises `Cannot` for such a case, and
    the runner counts those and shows them. `tolerance` is how far, in relation, a value may be off.
    `answering` is the command whose reply the host waits for; None reads the frame without knowing.
    """

    name: str
    cannot: Mapping[str, str]
    tolerance: float

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, answering: str | None
    ) -> Decoded | Refused: ...

    def encode_raw(
        self, direction: Direction, command: str, node: int | None, raw: Mapping[str, Raw], parameters: Parameters
    ) -> Encoded | Refused: ...

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
    ) -> Encoded | Refused: ...

    def answers(self, request: CanFrame, reply: CanFrame) -> Refused | None: ...
