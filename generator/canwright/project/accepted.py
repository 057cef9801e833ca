"""Accepted changes: a YAML file that lists changes which do not make `diff` fail, each with a reason.

A change is identified by the editions, its rule, its item and its facts; not by its position.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from ..compare import Change
from ..diagnostics.diagnostic import Diagnostic
from ..document.document import Document, read_document
from ..language.concept import Concept, Doc, Limits
from ..language.decoder import decode

_FACT = r"^[a-z_]+$"

Identity = tuple[str, str, str, tuple[tuple[str, str], ...]]


@dataclass(frozen=True, kw_only=True)
class AcceptedChange(Concept):
    """One accepted change."""

    editions: Annotated[str, Doc("The compared editions: `lamp v1 -> v2`.")]
    rule: Annotated[str, Doc("The rule of the change.")]
    item: Annotated[str, Doc("What is changed: `type level`.")]
    facts: Annotated[dict[Annotated[str, Limits(pattern=_FACT)], str], Doc("The facts of its message.")]
    reason: Annotated[str, Limits(pattern=r"\S"), Doc("Why the change is accepted.")]

    @property
    def identity(self) -> Identity:
        return self.editions, self.rule, self.item, tuple(sorted(self.facts.items()))


@dataclass(frozen=True, kw_only=True)
class AcceptedChanges(Concept):
    """The content of the file."""

    example = {"canwright": 1, "accepted": []}

    canwright: Annotated[Literal[1], Doc("Version of this language.")]
    accepted: Annotated[list[AcceptedChange], Doc("The accepted changes.")]


@dataclass(frozen=True)
class Baseline:
    """Accepted changes with their document, which is None for a file that does not exist yet."""

    accepted: tuple[AcceptedChange, ...] = ()
    document: Document | None = None

    @property
    def reasons(self) -> Mapping[Identity, str]:
        """Why a change is accepted, by its identity."""
        return {change.identity: change.reason for change in self.accepted}

    def unused(self, editions: Iterable[str], changes: Iterable[Identity]) -> list[Diagnostic]:
        """Warnings about entries for the compared editions without a change."""
        compared, identities = set(editions), set(changes)
        return [
            self.document.finding(
                ("accepted", i),
                "unused",
                f"no change from {change.editions} by `{change.rule}` of {change.item} has these facts",
                "remove the entry",
                warning=True,
            )
            for i, change in enumerate(self.accepted)
            if self.document and change.editions in compared and change.identity not in identities
        ]


def facts(change: Change) -> dict[str, str]:
    """The facts of a change in English."""
    return {name: change.says(sentence=f"{{{name}}}") for name in sorted(change.facts)}


def identity(editions: str, change: Change) -> Identity:
    """What identifies a change in the file."""
    return editions, change.rule.id, str(change.item), tuple(facts(change).items())


def read_baseline(file: Path) -> Baseline:
    """The accepted changes in a file. Raises SpecError with all findings, and OSError."""
    document, _ = read_document(file)
    return Baseline(tuple(decode(document, AcceptedChanges).value.accepted), document)


def baseline_text(accepted: Iterable[AcceptedChange]) -> str:
    """The file with these changes, sorted."""
    lines = ["canwright: 1", "accepted:"]
    for change in sorted(accepted, key=lambda change: change.identity):
        lines += [
            f"  - editions: {_quoted(change.editions)}",
            f"    rule: {change.rule}",
            f"    item: {_quoted(change.item)}",
        ]
        lines.append(
            "    facts: {" + ", ".join(f"{name}: {_quoted(fact)}" for name, fact in change.facts.items()) + "}"
        )
        lines.append(f"    reason: {_quoted(change.reason)}")
    if lines[-1] == "accepted:":
        lines[-1] = "accepted: []"
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
