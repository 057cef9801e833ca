"""A witness: one frame that an old host and a new node understand differently, and the sentence about it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

from ...diagnostics.diagnostic import DocumentPath
from ...model import formatting
from ...model.types import Assignment
from ...semantics.frame import CanFrame
from ..change import Fact, Impact, Side, with_facts

SENTENCES: Mapping[str, str] = {
    "sent-read": "the old host sends {sent}; the new node reads {read}",
    "sent-rejected": "the old host sends {sent}; the new node rejects it: {reason}",
    "sent-out-of-range": "the old host sends {sent}; the new node allows {allowed}",
    "sent-ignored": "the old host sends {sent}; the new node ignores it",
    "sent-unset": "the old host does not send `{name}`; the new node reads {read}",
    "sent-unavailable": "the old host sends {sent}; the new node does not support it",
    "sent-unanswered": "the old host sends {sent}; the new node does not reply",
    "received-read": "the new node sends {sent}; the old host reads {read}",
    "received-rejected": "the new node sends {sent}; the old host rejects it: {reason}",
    "received-unset": "the new node does not send `{name}`; the old host reads {read}",
    "received-missing": "the old host expects {read}; the new node sends it only on request",
    "received-removed": "the old host expects {read}; the new node does not send it",
}
"""The sentences about witnesses, with names of facts in braces."""

REASONS: Mapping[str, str] = {
    "frames": "no frame is understood differently",
    "combined": "no frame shows it, because another change affects the same frames first",
    "effects": "no frame shows it, because it is about what a node does",
    "setting": "no frame shows it, because it is about a setting",
    "timing": "no frame shows it, because it is about time",
}
"""Why a change has no witness."""


@dataclass(frozen=True)
class Witness:
    """A frame, what both sides make of it, and the parameter values under which they do.

    `frame` is None if the frame that one side expects is never sent.
    """

    side: Side
    impact: Impact
    assignment: Assignment
    frame: CanFrame | None
    sentence: str
    facts: Mapping[str, Fact]

    @property
    def sent(self) -> str:
        """The frame in the notation of can-utils, empty without one."""
        return "" if self.frame is None else formatting.sent(self.frame)

    @property
    def condition(self) -> str:
        """The parameter values: `series MG; encoder_bits 18`; empty if the frame depends on none."""
        return formatting.condition(
            {name: (formatting.parameter_value(value),) for name, value in self.assignment.items()}
        )

    def says(
        self,
        language: str = "en",
        sentence: str | None = None,
        words: Mapping[str, str] = MappingProxyType({}),
        escape: Callable[[str], str] = lambda text: text,
    ) -> str:
        """The frame and the sentence, or another one in `language` with its `words`, with the facts of this witness."""
        text = with_facts(sentence or SENTENCES[self.sentence], self.facts, language, words, escape)
        return f"{self.sent}: {text}" if self.sent else text


class Aspect(Enum):
    """The part of the behaviour that a witness is about."""

    ID = "id"
    """The CAN id alone: the node, or the address."""
    IDENTITY = "identity"
    """The message that a frame is, if its id is correct."""
    ANSWER = "answer"
    """Whether a frame is the reply to a request."""
    PRESENCE = "presence"
    """Whether a frame is sent or supported at all."""
    RAW = "raw"
    """The raw integer of a field."""
    VALUE = "value"
    """The value of a raw integer."""
    MEMBER = "member"
    """The name of a raw integer, or the names of its bits."""
    RANGE = "range"
    """Whether a raw integer is allowed."""


@dataclass(frozen=True)
class Observation:
    """A witness, and what it is about: the commands, the paths in both specs, and the members of an enum or of flags.

    Without `members` it is about any member. If the frame does not exist, because only the receiver has its id or because
    the receiver decodes it as something else, the observation is about what remains after these differences are repaired.
    """

    aspect: Aspect
    witness: Witness
    commands: tuple[str, ...]
    paths: tuple[DocumentPath, ...]
    members: tuple[str, ...] = ()
    exists: bool = True
