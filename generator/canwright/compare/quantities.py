"""Changes of what bits mean: scales, offsets, units, ranges, members."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, NamedTuple, TypeVar

from ..model import formatting
from ..model.types import Assignment, Bound, ByParameter, Linear, Member, NoValue, Range, Type
from . import match
from .change import Impact, Keyword
from .collector import Attribute, Subject, listed

T = TypeVar("T")


@dataclass(frozen=True)
class Case(Generic[T]):
    """What two types have under some parameter values; `when` is empty, or ` [model A, B]`."""

    when: str
    assignments: tuple[Assignment, ...]
    old: T | None
    new: T | None


class Pair(NamedTuple):
    """A type of the old edition and its counterpart in the new one, and the name that people know it by."""

    subject: Subject
    name: str
    old: Type
    new: Type

    def add(self, rule: str, key: str, case: Case[T], old: str, new: str) -> None:
        """Adds a change of a number that may depend on parameters."""
        facts = {"name": self.name, "when": case.when, "old": old, "new": new}
        self.subject.at(key).add(rule, None, case.assignments, **facts)


_UNIT = Attribute[Type]("unit-changed", "unit", lambda t: t.unit.symbol if t.unit else Keyword("no unit"))
_PARAMETERS = Attribute[Type](
    "parameters-of-type-changed",
    "scale",
    lambda t: ", ".join((*t.parameters, *t.numbers)) or Keyword("nothing"),
)
_PLAUSIBLE = Attribute[Type](
    "plausible-changed",
    "plausible",
    lambda t: formatting.span(t.plausible, formatting.decimal) + _unit(t) if t.plausible else Keyword("not given"),
    lambda t: (t.plausible, t.plausible and t.unit),
)
_WITHOUT_EFFECTS = Attribute[Member](
    "member-effects-changed",
    "without_effects",
    lambda m: listed(m.without_effects),
    lambda m: {*m.without_effects},
    Impact.SILENT,
)


def compare(subject: Subject, name: str, old: Type, new: Type) -> None:
    """All changes of what a type means."""
    pair = Pair(subject, name, old, new)
    linear = [_scales(pair), _offsets(pair)]
    shows_parameters = any([*linear, _ranges(pair)])
    for key, members in old.members_by_key.items():
        _members(subject.at(key), name, members, new.members_by_key[key])
    subject.attributes((_UNIT,) if shows_parameters else (_UNIT, _PARAMETERS), old, new, name=name)
    subject.used().attributes([_PLAUSIBLE], old, new, name=name)


def _scale(linear: Linear | None) -> object:
    return linear and (linear.scale, linear.times)


def _scales(pair: Pair) -> bool:
    """Adds changes of scales; whether there are any of their values."""
    changed = False
    for case in _cases(pair.old.linear, pair.new.linear):
        old, new = case.old, case.new
        shown = _scale_shown(old, pair.old), _scale_shown(new, pair.new)
        if _scale(old) != _scale(new):
            pair.add("scale-changed", "scale", case, *shown)
            changed = True
        elif old and new and (old.printed or "1") != (new.printed or "1") and not old.is_identity:
            pair.add("scale-rewritten", "scale", case, *shown)
    return changed


def _offsets(pair: Pair) -> bool:
    """Adds changes of offsets; whether there are any."""
    cases = _cases(_offsets_of(pair.old.linear), _offsets_of(pair.new.linear))
    changed = [(case, case.old, case.new) for case in cases if case.old and case.new and case.old != case.new]
    for case, old, new in changed:
        pair.add("offset-changed", "offset", case, _offset_shown(old, pair.old), _offset_shown(new, pair.new))
    return bool(changed)


def _offsets_of(linear: ByParameter[Linear]) -> ByParameter[Linear]:
    """The offsets of some scales alone."""

    def offset(line: Linear | None) -> Linear | None:
        return line and Linear(Fraction(1), line.offset, line.times if line.offset else None)

    return linear.map(offset)


def _offset_shown(linear: Linear, type_: Type) -> str:
    return formatting.offset(linear, formatting.decimal) + _unit(type_)


def _scale_shown(linear: Linear | None, type_: Type) -> str:
    return Keyword("not given") if linear is None else f"{formatting.step(linear)}{_unit(type_)}"


def _unit(type_: Type) -> str:
    return f" {type_.unit.symbol}" if type_.unit else ""


def _ranges(pair: Pair) -> bool:
    """Adds changes of ranges; whether there are any."""
    changed = False
    if _same_values(pair.old, pair.new):
        return changed
    for case in _cases(pair.old.raw_range, pair.new.raw_range):
        old_range, new_range = case.old, case.new
        old, new = old_range or _whole(pair.old), new_range or _whole(pair.new)
        if old == new or old_range is new_range is None:
            continue
        changed = True
        shown = [
            Keyword("not limited") if limits is None else formatting.span(limits, formatting.decimal)
            for limits in (old_range, new_range)
        ]
        pair.add("range-changed", "raw_range", case, shown[0], shown[1])
    return changed


def _same_values(old: Type, new: Type) -> bool:
    """Whether the raw ranges differ only because the scales do: the same values are allowed, rounded to a raw integer."""
    dependents: tuple[ByParameter[Linear] | ByParameter[Range], ...]
    dependents = (old.linear, new.linear, old.raw_range, new.raw_range)
    parameters = {d.parameter for d in dependents} - {None}
    if old.linear == new.linear or len(parameters) > 1:
        return False
    names = {name: None for d in dependents for name in d.cases} or {"": None}
    assignments = [dict.fromkeys(parameters, name) for name in names]
    return all(
        _same_range((old.raw_range.at(a), new.raw_range.at(a)), (old.linear.at(a), new.linear.at(a)))
        for a in ({p: name for p, name in assignment.items() if p} for assignment in assignments)
    )


def _same_range(ranges: tuple[Range | None, Range | None], lines: tuple[Linear | None, Linear | None]) -> bool:
    (old, new), (old_line, new_line) = ranges, lines
    if old is None or new is None or old_line is None or new_line is None:
        return old is new
    step = max(abs(old_line.scale), abs(new_line.scale))
    before, after = formatting.in_unit(old, old_line), formatting.in_unit(new, new_line)
    return all(
        a.parameter == b.parameter
        and abs(a.constant - b.constant) <= step
        and abs(a.coefficient - b.coefficient) <= step
        for a, b in ((before.low, after.low), (before.high, after.high))
    )


def _whole(type_: Type) -> Range:
    low, high = type_.number_limits
    return Range(Bound(Fraction(low)), Bound(Fraction(high)))


def _cases(old: ByParameter[T], new: ByParameter[T]) -> Iterator[Case[T]]:
    """Where two differ, cases that differ alike together."""
    groups: dict[tuple[T | None, T | None], dict[str, Assignment]] = {}
    for name, assignment in _assignments(old, new):
        groups.setdefault((old.at(assignment), new.at(assignment)), {})[name] = assignment
    parameters = "" if len({old.parameter, new.parameter} - {None}) > 1 else f"{old.parameter or new.parameter} "
    for (before, after), known in groups.items():
        when = "" if list(known) == [""] else f" [{parameters}{', '.join(known)}]"
        yield Case(when, tuple(known.values()) if when else (), before, after)


def _assignments(old: ByParameter[T], new: ByParameter[T]) -> Iterator[tuple[str, Assignment]]:
    """Every value of the parameters that two depend on, with a name; in an order that does not depend on the specs."""
    if old.parameter and new.parameter and old.parameter != new.parameter:
        for a, b in itertools.product(_ordered(old.cases), _ordered(new.cases)):
            yield f"{old.parameter} {a} {new.parameter} {b}", {old.parameter: a, new.parameter: b}
        return
    parameter = old.parameter or new.parameter
    if parameter is None:
        yield "", {}
        return
    for name in _ordered({**old.cases, **new.cases}):
        if all(name in d.cases for d in (old, new) if d.parameter):
            yield name, {parameter: name}


def _ordered(names: Iterable[str]) -> list[str]:
    """Names in alphabetical order, numbers by their value."""
    return sorted(names, key=lambda name: (len(name) if name.isdecimal() else 0, name))


def _members(type_: Subject, name: str, old: tuple[Member, ...], new: tuple[Member, ...]) -> None:
    matched = match.members(old, new)
    replaced = matched.also(lambda a, b: _raws(a) == _raws(b))
    parents = type_.places

    def member(before: Member, after: Member) -> Subject:
        return type_.within((*parents[0], before.name), (*parents[1], after.name))

    for before, after in matched.pairs:
        same = member(before, after)
        same.renamed("member-renamed", before.name, after.name, name=name)
        if _raws(before) != _raws(after):
            facts = {"name": name, "member": after.name, "old": _raws(before), "new": _raws(after)}
            same.add("member-renumbered", **facts)
        same.attributes([_WITHOUT_EFFECTS], before, after, name=name, member=after.name)
        same.deprecation(after.name, before.deprecated, after.deprecated)
        same.texts(before, after)
    for before, after in replaced.pairs[len(matched.pairs) :]:
        facts = {"name": name, "value": _raws(before), "old": before.name, "new": after.name}
        member(before, after).add("member-replaced", **facts)
    for gone in replaced.removed:
        facts = {"name": name, "member": gone.name, "value": _raws(gone)}
        type_.within((*parents[0], gone.name), parents[1]).removed("member-removed", gone.deprecated, **facts)
    for fresh in replaced.added:
        facts = {"name": name, "member": fresh.name, "value": _raws(fresh)}
        type_.within(parents[0], (*parents[1], fresh.name)).add("member-added", **facts)


def _raws(member: Member) -> str:
    """The raw integer of a member, its bit, or its raw integers."""
    return formatting.no_value(member) if isinstance(member, NoValue) else str(member.value)
