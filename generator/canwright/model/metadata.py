"""Facts about a protocol other than its frames: effects, states, settings, the bus, errata."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from .types import Text


class Level(str, Enum):
    """The severity of an effect."""

    NOTE = "note"
    WARNING = "warning"
    DANGER = "danger"


class Consent(str, Enum):
    """What a program has to allow before it sends a command with an effect."""

    NONE = "none"
    MOTION = "motion"
    """Something moves, or is free to move."""
    WEAR = "wear"
    """Each time shortens the life of the node."""
    CONTACT = "contact"
    """The node may no longer be reached the same way."""


class Repeat(str, Enum):
    """What happens if a request is sent again because no reply came."""

    SAME = "same"
    """The same as if it was sent once."""
    NEVER = "never"
    """Something else, or that is unknown."""


class Kept(str, Enum):
    """How long a node keeps what a command writes."""

    RAM = "ram"
    """Until power-off."""
    ROM = "rom"
    """After power-off, too."""
    STAGED = "staged"
    """As `RAM`, until a command saves it."""
    SAVED = "saved"
    """What was staged before is kept after power-off from now on."""


class EndsMotion(str, Enum):
    """How a command ends the motion of a node."""

    STOP = "stop"
    SWITCH_OFF = "switch_off"


class FrameFormat(str, Enum):
    """The format of the frames that are sent on a bus: classic CAN, or CAN FD without or with bit rate switch."""

    CLASSIC = "classic"
    FD = "fd"
    FD_BRS = "fd_brs"

    @property
    def is_fd(self) -> bool:
        return self is not FrameFormat.CLASSIC

    @property
    def switches_rate(self) -> bool:
        """Whether the data are sent with the higher bit rate."""
        return self is FrameFormat.FD_BRS

    @property
    def lengths(self) -> tuple[int, ...]:
        """The possible numbers of data bytes, in ascending order."""
        return (*range(9), *((12, 16, 20, 24, 32, 48, 64) if self.is_fd else ()))

    @property
    def max_data_bytes(self) -> int:
        return self.lengths[-1]


@dataclass(frozen=True, eq=False, kw_only=True)
class Effect:
    """A side effect of a command, as data for tools and as a sentence for people."""

    name: str
    level: Level
    consent: Consent
    repeat: Repeat
    kept: Kept | None
    """None if a command with this effect writes nothing, or how long it is kept is unknown."""
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """A state of a node. `entered_by` are groups of commands; `prevents` are effects that commands do not have in it."""

    name: str
    is_initial: bool
    """Whether it is the state after power-up."""
    entered_by: tuple[str, ...]
    prevents: tuple[Effect, ...]
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Setting:
    """A limit that is configured on the node by other means than this protocol."""

    name: str
    only: Mapping[str, tuple[str, ...]]
    title: Text
    about: Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Mode:
    """A mode of the bus; commands of different modes exclude each other."""

    name: str
    bit_rates_kbps: tuple[int, ...]
    default_kbps: int | None
    title: Text
    about: Text


@dataclass(frozen=True, kw_only=True)
class Bus:
    """The settings of the bus that host and nodes share."""

    host: str
    dlc: int
    frame_format: FrameFormat
    max_nodes: int | None
    reply_within_ms: Fraction | None
    answers_in_order: bool
    """Whether a node answers requests in the order in which it receives them; False if that is unknown."""
    modes: tuple[Mode, ...]
    manual: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Erratum:
    """An error or omission of the manual, and what the spec uses instead. `where` are dotted paths into the spec."""

    id: str
    where: tuple[str, ...]
    manual: str
    printed: Text
    used: Text
    why: Text
