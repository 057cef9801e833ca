"""What is known of a protocol besides its frames: effects, settings, the bus, errata. A part of the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from .types import Text


class Level(str, Enum):
    """How much an effect matters to whoever sends the command."""

    NOTE = "note"
    WARNING = "warning"
    DANGER = "danger"


@dataclass(frozen=True, eq=False, kw_only=True)
class Effect:
    """What sending a command does besides its reply, as data for tools and a sentence for people."""

    name: str
    level: Level
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Setting:
    """A limit that is set on the node by other means than this protocol."""

    name: str
    only: Mapping[str, tuple[str, ...]]
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Mode:
    """A way to run the bus; commands of different modes exclude each other."""

    name: str
    bit_rates_kbps: tuple[int, ...]
    default_kbps: int | None
    title: Text
    about: Text


@dataclass(frozen=True, kw_only=True)
class Bus:
    """What host and nodes must agree on before the first frame."""

    host: str
    dlc: int
    max_nodes: int | None
    reply_within_ms: Fraction | None
    modes: tuple[Mode, ...]
    manual: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Erratum:
    """Where the manual is wrong or silent, and what the spec does about it. `where` are dotted paths into the spec."""

    id: str
    where: tuple[str, ...]
    manual: str
    printed: Text
    used: Text
    why: Text
