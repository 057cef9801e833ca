"""The impact of each change, from the witnesses that it explains."""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..model.refusal import Refusal
from .catalogue import CHANGES
from .change import Category, Change, Impact, Item, Side, Word, worst
from .witnesses.witness import Aspect, Observation, Witness

MAX_WITNESSES = 16
"""So many witnesses of one change are kept; the worst of each side first."""

_IDENTIFIED = frozenset({Aspect.IDENTITY, Aspect.ANSWER})
_SUPPORTED = frozenset({Aspect.IDENTITY, Aspect.ANSWER, Aspect.PRESENCE})
_CONTENT = frozenset({Aspect.RAW, Aspect.VALUE, Aspect.MEMBER, Aspect.RANGE})
_ID = frozenset({Aspect.ID})
_RAW = frozenset({Aspect.RAW})

_EXPLAINS: dict[str, frozenset[Aspect]] = {
    "id-changed": _ID,
    "nodes-changed": _ID,
    "address-added": frozenset(),
    "address-removed": _ID | _SUPPORTED,
    "command-added": frozenset(),
    "command-removed": _SUPPORTED,
    "command-repurposed": _SUPPORTED,
    "code-changed": _IDENTIFIED,
    "code-taken": _IDENTIFIED,
    "code-moved": _IDENTIFIED,
    "index-moved": _IDENTIFIED,
    "index-changed": _IDENTIFIED,
    "entry-added": frozenset(),
    "entry-removed": _SUPPORTED,
    "entry-repurposed": _SUPPORTED,
    "table-of-command-changed": _SUPPORTED | _CONTENT,
    "kind-changed": _IDENTIFIED,
    "reply-code-changed": _IDENTIFIED,
    "accept-changed": _IDENTIFIED,
    "reply-form-changed": _SUPPORTED | _CONTENT,
    "request-changed": _SUPPORTED | _CONTENT,
    "repliers-changed": frozenset({Aspect.ANSWER}),
    "address-of-command-changed": _ID | _IDENTIFIED,
    "dlc-changed": _IDENTIFIED,
    "frame-kind-changed": _IDENTIFIED,
    "availability-changed": frozenset({Aspect.PRESENCE}),
    "field-added": _RAW,
    "field-removed": _RAW,
    "field-replaced": _CONTENT,
    "field-moved": _RAW,
    "field-condition-changed": _RAW,
    "holds-changed": frozenset({Aspect.RAW, Aspect.ANSWER}),
    "constant-changed": _RAW,
    "array-changed": _RAW,
    "width-changed": _CONTENT,
    "sign-changed": _CONTENT,
    "encoding-changed": _CONTENT,
    "field-format-changed": _CONTENT,
    "byte-order-changed": _RAW,
    "field-meaning-changed": _CONTENT,
    "scale-changed": frozenset({Aspect.VALUE}),
    "offset-changed": frozenset({Aspect.VALUE}),
    "unit-changed": frozenset({Aspect.VALUE}),
    "range-changed": frozenset({Aspect.RANGE}),
    "member-added": frozenset({Aspect.MEMBER}),
    "member-removed": frozenset({Aspect.MEMBER}),
    "member-renumbered": frozenset({Aspect.MEMBER}),
    "member-replaced": frozenset({Aspect.MEMBER}),
}
"""The aspects that each kind of change explains; other kinds have no witness."""
_ADDITIONS = ("command-added", "entry-added", "address-added")
_ANY_SIDE = (*_ADDITIONS, "command-removed", "entry-removed", "request-changed", "availability-changed")
_OF_LENGTH = ("field-added", "field-moved", "field-removed", "field-replaced")
"""Changes of fields that come with another length."""
_WHOLE = ("reply-form-changed", "request-changed", "table-of-command-changed")
"""Changes that replace all fields of a command."""
_ORDER = list(Impact)
_WRONG_LENGTH = Word(Refusal.WRONG_LENGTH.value.replace("_", " "))


def judged(changes: Sequence[Change], observations: Sequence[Observation]) -> tuple[Change, ...]:
    """The changes with their witnesses and impacts; observations that no change explains are changes of their own."""
    index = _Index(observations)
    wrong_lengths = frozenset(_place(o) for o in observations if o.witness.facts.get("reason") == _WRONG_LENGTH)
    explained: set[int] = set()
    found: list[list[int] | None] = []
    for change in changes:
        aspects = _EXPLAINS.get(change.rule.id)
        numbers = None if aspects is None else [n for n in index.of(change) if observations[n].aspect in aspects]
        explained.update(numbers or ())
        found.append(numbers)
    for is_likely in (True, False):  # what decides on messages also has effects on the other side
        for change, known in zip(changes, found, strict=True):
            if known is not None and (_decides(change) and change.rule.id not in _ADDITIONS) is is_likely:
                others = (*index.of_commands(change), *index.of_surroundings(change))
                known += (n for n in others if n not in explained and _may_cause(change, observations[n]))
        explained.update(n for numbers in found for n in numbers or ())
    causes = [
        numbers for numbers, change in zip(found, changes, strict=True) if numbers is not None and _decides(change)
    ]
    if len(causes) == 1:  # what else is understood differently can have no other cause
        causes[0] += (n for n, o in enumerate(observations) if n not in explained and o.aspect in _IDENTIFIED | _ID)
        explained.update(causes[0])
    made = [
        change
        if numbers is None
        else _with(
            change,
            _effective(change, [observations[n] for n in _own_first(change, observations, numbers)], wrong_lengths),
        )
        for change, numbers in zip(changes, found, strict=True)
    ]
    return (*made, *_unexplained(o for n, o in enumerate(observations) if n not in explained))


def _own_first(change: Change, observations: Sequence[Observation], numbers: Iterable[int]) -> list[int]:
    """The numbers of observations, first those of frames of the commands that a change affects."""
    return sorted(dict.fromkeys(numbers), key=lambda n: observations[n].commands[0] not in change.used_by)


def _decides(change: Change) -> bool:
    """Whether a change decides on which message a frame is."""
    return change.rule.id in _ADDITIONS or bool(_EXPLAINS[change.rule.id] & (_IDENTIFIED | _ID))


def _place(observation: Observation) -> tuple[Side, str]:
    """The frames that an observation is about."""
    return observation.witness.side, observation.commands[0]


def _effective(
    change: Change, observations: Sequence[Observation], wrong_lengths: Collection[tuple[Side, str]]
) -> list[Observation]:
    """The observations that count; where a change replaces fields, none of fields in frames that are rejected."""
    if change.rule.id in _OF_LENGTH:
        return [o for o in observations if o.aspect not in _CONTENT or _place(o) not in wrong_lengths]
    rejected = {o.witness.side for o in observations if (o.aspect, o.witness.impact) == (Aspect.IDENTITY, Impact.LOUD)}
    without = rejected if change.rule.id in _WHOLE else ()
    return [o for o in observations if not (o.witness.side in without and o.aspect in _CONTENT)]


def _may_cause(change: Change, observation: Observation) -> bool:
    """Whether a change affects the other side, as that of an echo, or makes a frame another message."""
    aspects = _EXPLAINS[change.rule.id] | (_ID if change.rule.id in _WHOLE else frozenset())
    by_others = change.rule.id in _ADDITIONS or bool(aspects & (_CONTENT | _ID))
    if change.rule.id == "constant-changed":  # a value that becomes a constant loses its unit and its scale
        aspects |= _CONTENT
    return observation.aspect in (_IDENTIFIED | aspects if by_others else aspects)


class _Index:
    """Observations by commands, and by the paths that they are about."""

    def __init__(self, observations: Sequence[Observation]) -> None:
        self._observations = observations
        self._by_command: dict[str, list[int]] = defaultdict(list)
        self._at: dict[DocumentPath, list[int]] = defaultdict(list)
        for number, observation in enumerate(observations):
            for command in observation.commands:
                self._by_command[command].append(number)
            for path in observation.paths:
                self._at[path].append(number)

    def of(self, change: Change) -> list[int]:
        """The observations about the item of a change."""
        aspects = _EXPLAINS[change.rule.id]
        numbers = [n for n in self._of_paths(change) if self._fits(change, n)]
        if change.item.kind != "entry":
            of_fields = change.item.kind in ("edition", "bus") or change.rule.id in _WHOLE
            numbers += (
                n
                for n in self.of_commands(change)
                if self._has_side(change, n)
                if of_fields or self._observations[n].aspect in aspects - _CONTENT - _ID
            )
            if change.rule.id == "address-of-command-changed":
                numbers += (n for n in self.of_commands(change) if self._observations[n].aspect is Aspect.ID)
        return list(dict.fromkeys(numbers))

    def of_commands(self, change: Change) -> list[int]:
        """The observations about the commands of a change."""
        return [n for command in change.used_by for n in self._by_command.get(command, ())]

    def of_surroundings(self, change: Change) -> Iterable[int]:
        """The observations that a change outside commands can cause."""
        if change.item.kind == "edition":
            return range(len(self._observations))
        return self._of_paths(change) if change.item.kind == "address" else ()

    def _of_paths(self, change: Change) -> Iterator[int]:
        kind = change.rule.id
        old = None if kind.endswith("-added") else change.old
        new = None if kind.endswith("-removed") else change.new
        for path in filter(None, (old, new)):
            for end in range(1, len(path) + 1):
                yield from self._at.get(path[:end], ())

    def _fits(self, change: Change, number: int) -> bool:
        """Whether parameter values and member are those of a change."""
        observation = self._observations[number]
        known = observation.witness.assignment
        if change.cases and not any(all(known.get(p, v) == v for p, v in case.items()) for case in change.cases):
            return False
        member = {str(change.facts[name]) for name in ("member", "old", "new") if name in change.facts}
        if change.rule.id.startswith("member-") and observation.members and not member & {*observation.members}:
            return False
        return change.item.kind != "address" or self._has_side(change, number)

    def _has_side(self, change: Change, number: int) -> bool:
        side = self._observations[number].witness.side
        return change.rule.id in _ANY_SIDE or not change.sides or side in change.sides


def _with(change: Change, observations: Sequence[Observation]) -> Change:
    """A change with the verdicts that observations give, and with the witnesses that exist, the worst of each side first."""
    found = [(o.witness.side, o.witness.impact) for o in observations]
    verdicts = {side: worst(impact for of, impact in found if of is side) for side in Side}
    verdicts = {side: impact for side, impact in verdicts.items() if impact is not Impact.SAFE}
    shown = (o.witness for o in observations if o.exists)
    ordered = sorted(shown, key=lambda w: (_ORDER.index(w.impact), list(Side).index(w.side)))
    first = dict.fromkeys((w.side, w.impact) for w in ordered)
    leading = [next(w for w in ordered if (w.side, w.impact) == kind) for kind in first]
    rest = [w for w in ordered if not any(w is one for one in leading)]
    kept = tuple((*leading, *rest)[:MAX_WITNESSES])
    return dataclasses.replace(change, verdicts=verdicts, witnesses=kept)


def _unexplained(observations: Iterable[Observation]) -> Iterator[Change]:
    """A change for each command whose observations have no other explanation."""
    groups: dict[str, list[Observation]] = defaultdict(list)
    for observation in observations:
        groups[observation.commands[0]].append(observation)
    for command, found in groups.items():
        item, path = Item("command", command), ("commands", command)
        facts = {"name": command}
        change = Change(CHANGES["frames-affected"], item, facts, path, path, {}, (command,))
        yield _with(change, found)


def reason_without_witness(change: Change) -> str:
    """The key of the reason why a change of bits or of meaning has no witness; empty with one, and for names and texts."""
    if change.witnesses or change.rule.category in (Category.API, Category.DOC):
        return ""
    if change.rule.id in _EXPLAINS:
        return "combined" if change.verdicts else "frames"
    return _REASONS.get(change.rule.id, "setting")


_REASONS = {
    "implemented-changed": "effects",
    "effects-changed": "effects",
    "member-effects-changed": "effects",
    "limits-changed": "effects",
    "state-entry-changed": "effects",
    "state-effects-changed": "effects",
    "reply-time-changed": "timing",
}


def examples(change: Change) -> tuple[Witness, ...]:
    """A witness for each side that a change affects, with the worst impact of the side."""
    found: dict[Side, Witness] = {}
    for witness in change.witnesses:
        found.setdefault(witness.side, witness)
    return tuple(found.values())
