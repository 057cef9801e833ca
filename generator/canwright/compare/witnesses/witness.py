"""A witness: one frame that an old host and a new node understand differently, and the sentence about it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from ...model import formatting
from ...model.types import Assignment
from ...semantics.frame import CanFrame
from ..change import Impact, SentenceArgument, Side, with_facts
from .paths import Paths

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
    "received-dropped": "the old host accepts it as {sent}; a host of the new edition rejects it: {reason}",
    "received-removed": "the old host expects {read}; the new node does not send it",
}
"""The sentences about witnesses, with names of facts in braces."""

_SILENT = ("ignored", "read", "unset")
"""The ends of the names of sentences about frames that are understood differently; the others are about errors."""

REASONS: Mapping[str, str] = {
    "frames": "no frame is understood differently",
    "combined": "no frame shows it, because another change affects the same frames first",
    "effects": "no frame shows it, because it is about what a node does",
    "setting": "no frame shows it, because it is about a setting",
    "several": "no frame shows it, because it is about several frames",
    "timing": "no frame shows it, because it is about time",
}
"""Why a change has no witness."""


def sentence(side: Side, about: str) -> str:
    """The name of the sentence about what a side sends or receives: `sent-read`, `received-read`."""
    return f"{'sent' if side is Side.SENDING else 'received'}-{about}"


class Witness(NamedTuple):
    """A frame, what both sides make of it, and the parameter values under which they do.

    `frame` is None if the frame that one side expects is never sent. `paths` lead to the definitions in both specs that it
    is about, and `commands` are the commands. If the frame does not exist, because only the receiver has its id or because
    the receiver decodes it as something else, the witness is about what remains after these differences are repaired.
    `is_of_field` is true if the frame is the expected message, and a field is not read as it was sent.
    """

    side: Side
    assignment: Assignment
    frame: CanFrame | None
    sentence: str
    facts: Mapping[str, SentenceArgument]
    commands: tuple[str, ...] = ()
    paths: Paths = frozenset()
    exists: bool = True
    is_of_field: bool = False

    @property
    def impact(self) -> Impact:
        """The impact on the old host."""
        return Impact.SILENT if self.sentence.endswith(_SILENT) else Impact.LOUD

    @property
    def sent(self) -> str:
        """The frame in the notation of can-utils, empty without one."""
        return "" if self.frame is None else formatting.sent(self.frame)

    @property
    def condition(self) -> str:
        """The parameter values: `model A; steps 18`; empty if the frame depends on none."""
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
