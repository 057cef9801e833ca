"""The impact of each change, from the witnesses about the definitions that it changes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence

from ..diagnostics.diagnostic import DocumentPath
from .catalogue import CHANGES
from .change import Category, Change, Impact, Item, Side, worst
from .witnesses.witness import Witness

MAX_WITNESSES = 16
"""So many witnesses of one change are kept; the worst of each side first."""
_ORDER = list(Impact)


def with_verdicts(changes: Sequence[Change], witnesses: Iterable[Witness]) -> tuple[Change, ...]:
    """The changes with their witnesses and impacts; witnesses that no change explains are changes of their own."""
    causes = _Causes(changes)
    left = [witness for witness in witnesses if not causes.explain(witness)]
    unexplained = [witness for witness in left if not causes.explain_with_the_only_cause(witness)]
    made = (
        _with(change, causes.explained[n]) if change.rule.has_witnesses else change for n, change in enumerate(changes)
    )
    return (*made, *_unexplained(unexplained))


class _Causes:
    """Changes by the paths that they change, with the witnesses that they explain."""

    def __init__(self, changes: Sequence[Change]) -> None:
        self.explained: dict[int, list[Witness]] = defaultdict(list)
        self._changes = changes
        self._at: dict[DocumentPath, list[int]] = defaultdict(list)
        self._known: dict[frozenset[DocumentPath], list[int]] = {}
        for number, change in enumerate(changes):
            if change.rule.has_witnesses and not _adds_item(change):
                for path in _paths(change):
                    self._at[path].append(number)

    def explain(self, witness: Witness) -> bool:
        """Whether changes at the paths of a witness explain it, or of the bits of its commands; they are its causes."""
        numbers = [n for n in self._of_paths(witness.paths) if _applies(self._changes[n], witness)]
        numbers = numbers or [n for n, change in enumerate(self._changes) if _may_cause(change, witness)]
        for number in numbers:
            self.explained[number].append(witness)
        return bool(numbers)

    def explain_with_the_only_cause(self, witness: Witness) -> bool:
        """Whether a single change decides which message a frame is; frames that are understood differently are due to it."""
        deciding = [n for n, change in enumerate(self._changes) if self._decides(n, change)]
        if len(deciding) != 1 or witness.is_of_field:
            return False
        self.explained[deciding[0]].append(witness)
        return True

    def _decides(self, number: int, change: Change) -> bool:
        return _adds_item(change) or any(not witness.is_of_field for witness in self.explained[number])

    def _of_paths(self, paths: frozenset[DocumentPath]) -> list[int]:
        if paths not in self._known:
            above = {path[:end] for path in paths for end in range(len(path) + 1)}
            self._known[paths] = sorted({number for path in above for number in self._at.get(path, ())})
        return self._known[paths]


def _adds_item(change: Change) -> bool:
    """Whether a change adds the item that it belongs to, so that it explains only what changes of other items do not."""
    return change.rule.id == f"{change.item.kind}-added"


def _paths(change: Change) -> set[DocumentPath]:
    """The paths of what a change is about; of what is added or removed, the path in the edition that has it."""
    old = None if change.rule.id.endswith("-added") else change.old
    new = None if change.rule.id.endswith("-removed") else change.new
    return {path for path in (old, new) if path is not None}


def _applies(change: Change, witness: Witness) -> bool:
    """Whether the parameter values of a witness are those of a change."""
    known = witness.assignment
    return not change.cases or any(all(known.get(p, v) == v for p, v in case.items()) for case in change.cases)


def _may_cause(change: Change, witness: Witness) -> bool:
    """Whether a change of the bits of a command, or of all, can make a frame another message."""
    if not change.rule.has_witnesses or change.rule.category is not Category.WIRE:
        return False
    return change.item.kind == "edition" or not {*change.used_by}.isdisjoint(witness.commands)


def _with(change: Change, witnesses: Iterable[Witness]) -> Change:
    """A change with the verdicts that witnesses give, and with those whose frames exist, the worst of each side first."""
    known = _effective(change, sorted(witnesses, key=lambda w: w.commands[0] not in change.used_by))
    verdicts = {side: worst(w.impact for w in known if w.side is side) for side in Side}
    verdicts = {side: impact for side, impact in verdicts.items() if impact is not Impact.SAFE}
    ordered = sorted((w for w in known if w.exists), key=lambda w: (_ORDER.index(w.impact), list(Side).index(w.side)))
    leading = {(w.side, w.impact): w for w in reversed(ordered)}.values()
    first = sorted(leading, key=ordered.index)
    rest = [w for w in ordered if not any(w is shown for shown in first)]
    return change._replace(verdicts=verdicts, witnesses=(*first, *rest)[:MAX_WITNESSES])


def _effective(change: Change, witnesses: Sequence[Witness]) -> Sequence[Witness]:
    """The witnesses that count; where a change replaces a message, none of fields in frames that are rejected."""
    if (change.old or change.new or ())[-1:] not in {("request",), ("reply",), ("table",)}:
        return witnesses
    return [w for w in witnesses if w.exists or not w.is_of_field]


def _unexplained(witnesses: Iterable[Witness]) -> Iterator[Change]:
    """A change for each command whose witnesses have no other explanation."""
    groups: dict[str, list[Witness]] = defaultdict(list)
    for witness in witnesses:
        groups[witness.commands[0]].append(witness)
    for command, of_command in groups.items():
        path = ("commands", command)
        change = Change(
            CHANGES["frames-affected"], Item("command", command), {"name": command}, path, path, {}, (command,)
        )
        yield _with(change, of_command)


def reason_without_witness(change: Change) -> str:
    """The key of the reason why a change of bits or of meaning has no witness; empty with one, and for names and texts."""
    if change.witnesses or change.rule.category in (Category.API, Category.DOC):
        return ""
    return change.rule.without_witness or ("combined" if change.verdicts else "frames")


def examples(change: Change) -> tuple[Witness, ...]:
    """A witness for each side that a change affects, with the worst impact of the side."""
    first: dict[Side, Witness] = {}
    for witness in change.witnesses:
        first.setdefault(witness.side, witness)
    return tuple(first.values())
