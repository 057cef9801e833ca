"""The effects of requests that a user may not expect, and those that the state of a node prevents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..model.layout import Field
from ..model.message import Command
from ..model.metadata import Effect, Level, State
from .rows import RowForm


class FormEffects(NamedTuple):
    """The effects of the requests of one form of rows, each with the fields and raw integers without it.

    `entered` is the state that they lead to.
    """

    command: Command
    effects: Sequence[tuple[Effect, Sequence[tuple[int, int]]]]
    entered: State | None

    def of(self, fields: Sequence[Any]) -> list[Effect]:
        """The effects of a request with these raw integers and values."""
        return [effect for effect, without in self.effects if all(fields[2 * at] != raw for at, raw in without)]


@dataclass
class CountedRequests:
    """Requests with the same effects, or without them; `first` is the number of the first of them."""

    first: int
    count: int = 0


class Entered(NamedTuple):
    """The state of a node, and the request that led to it."""

    state: State
    command: Command
    number: int


@dataclass
class NodeEffects:
    """The effects of the requests to a node, as far as they are warnings, and the effects that its state prevented."""

    entered: Entered | None = None
    """The state after the last request that leads to one; before, it is unknown."""
    warnings: dict[tuple[Command, Effect], CountedRequests] = field(default_factory=dict)
    prevented: dict[tuple[Entered, Command, Effect], CountedRequests] = field(default_factory=dict)

    def add(self, form: FormEffects, fields: Sequence[Any], number: int) -> None:
        """Counts a request."""
        before = self.entered
        absent = {effect.name for effect in before.state.prevents} if before else set()
        for effect in form.of(fields):
            if before is not None and effect.name in absent:
                key = before, form.command, effect
                self.prevented.setdefault(key, CountedRequests(number)).count += 1
            elif effect.level is Level.WARNING:
                self.warnings.setdefault((form.command, effect), CountedRequests(number)).count += 1
        if form.entered is not None and (before is None or before.state is not form.entered):
            self.entered = Entered(form.entered, form.command, number)


def form_effects(form: RowForm, command: Command | None) -> FormEffects | None:
    """What the requests of a form of rows do; None if they do nothing that is counted."""
    if form.edition is None or command is None or form.message is not command.request:
        return None
    prevented = {effect.name for state in form.edition.states for effect in state.prevents}
    effects = [e for e in command.effects if e.level is Level.WARNING or e.name in prevented]
    entered = next((state for state in form.edition.states if command.spec_name in state.entered_by), None)
    if not effects and entered is None:
        return None
    return FormEffects(command, [(effect, _without(form, command, effect)) for effect in effects], entered)


def _without(form: RowForm, command: Command, effect: Effect) -> list[tuple[int, int]]:
    """The positions of columns, and their raw integers without an effect."""
    positions: dict[Field, int] = {column.field: at for at, column in enumerate(form.columns)}
    return [(positions[having], member.value) for having, member in command.exemptions(effect) if having in positions]
