"""Golden frames: bytes and their expected values, from a named source, and frames that must be rejected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

from .message import Direction
from .refusal import Refusal
from .types import Assignment, Text

Single = Fraction | str
Value = Single | list[Single]
"""A number in a unit, or a name; a list of an array and of flags."""
RawValue = int | list[int]


@dataclass(frozen=True, kw_only=True)
class Sourced:
    """The source of an entry, empty if it is unreviewed, and what is known about the node."""

    source: str = ""
    manual: str = ""
    note: Text = field(default_factory=dict)
    parameters: Assignment = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class CheckedFrame:
    """A frame of an entry: one to decode, or one of an exchange."""

    id: int
    extended: bool = False
    remote: bool = False
    data: bytes


@dataclass(frozen=True, kw_only=True)
class GoldenFrame(CheckedFrame, Sourced):
    """A request or reply of a command, and its meaning.

    Decoding `id` and `data` returns exactly `node`, `raw` and `values`. Encoding `raw` returns exactly `id` and `data`,
    and so does encoding `values` if all of them are given. `decode_only` disables the check of the encoder.
    """

    direction: Direction
    command: str
    node: int | None = None
    raw: Mapping[str, RawValue] = field(default_factory=dict)
    values: Mapping[str, Value] = field(default_factory=dict)
    decode_only: bool = False


@dataclass(frozen=True, kw_only=True)
class RefusedFrame(CheckedFrame, Sourced):
    """A frame that every target must reject, and the reason."""

    decode: Direction
    says: Refusal


@dataclass(frozen=True, kw_only=True)
class RefusedValues(Sourced):
    """Values that every target must reject, and the reason."""

    encode: Direction
    command: str
    node: int | None = None
    raw: Mapping[str, RawValue] = field(default_factory=dict)
    values: Mapping[str, Value] = field(default_factory=dict)
    says: Refusal
    field_name: str | None = None


@dataclass(frozen=True, kw_only=True)
class Exchange(Sourced):
    """A request and a later frame: its reply, or the reason that it is not one."""

    request: CheckedFrame
    reply: CheckedFrame
    says: Refusal | None = None


@dataclass(frozen=True, kw_only=True)
class GoldenFrames:
    """The golden frames of one edition; `sources` are their sources by name, a plain text for all languages."""

    sources: Mapping[str, Text | str]
    frames: Sequence[GoldenFrame]
    refused: Sequence[RefusedFrame | RefusedValues] = ()
    exchanges: Sequence[Exchange] = ()

    @property
    def entries(self) -> Mapping[tuple[str, int], Sourced]:
        """All entries by their paths in the file."""
        lists: Mapping[str, Sequence[Sourced]] = {
            "frames": self.frames,
            "refused": self.refused,
            "exchanges": self.exchanges,
        }
        return {(key, i): entry for key, entries in lists.items() for i, entry in enumerate(entries)}

    @property
    def unreviewed(self) -> Sequence[tuple[str, int]]:
        """The paths of the entries without a source."""
        return [path for path, entry in self.entries.items() if not entry.source]

    @cached_property
    def reviewed(self) -> GoldenFrames:
        """The entries with a source, which are examples and evidence."""
        return GoldenFrames(
            sources=self.sources,
            frames=[frame for frame in self.frames if frame.source],
            refused=[entry for entry in self.refused if entry.source],
            exchanges=[entry for entry in self.exchanges if entry.source],
        )

    @cached_property
    def of_command(self) -> Mapping[tuple[str, Direction], Sequence[GoldenFrame]]:
        """The frames of each direction of a command."""
        frames: dict[tuple[str, Direction], list[GoldenFrame]] = {}
        for frame in self.frames:
            frames.setdefault((frame.command, frame.direction), []).append(frame)
        return frames
