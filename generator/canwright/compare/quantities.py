"""Changes of what bits mean: scales, offsets, units, ranges, members."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, TypeVar

from ..model import formatting
from ..model.types import Assignment, Bound, ByParameter, Linear, Member, Range, Type
from . import match
from .change import Impact, Item, Keyword
from .collector import AffectedUsers, Attribute, Collector, Places, at, listed

T = TypeVar("T")


@dataclass(frozen=True)
class Case(Generic[T]):
    """What two types have under some parameter values; `when` is empty, or ` [series A, B]`."""

    when: str
    assignments: tuple[Assignment, ...]
    old: T | None
    new: T | None


@dataclass(frozen=True)
class Pair:
    """A type of the old edition and its counterpart in the new one, and the name that people know it by."""

    old: Type
    new: Type
    item: Item
    name: str
    places: Places
    use: AffectedUsers

    def add(self, collector: Collector, rule: str, key: str, case: Case[T], old: str, new: str) -> None:
        """Adds a change of a number that may depend on parameters."""
        facts = {"name": self.name, "when": case.when, "old": old, "new": new}
        collector.add(rule, self.item, at(self.places, key), self.use, None, case.assignments, **facts)


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


def compare(collector: Collector, pair: Pair) -> None:
    """All changes of what a type means."""
    old, new = pair.old, pair.new
    linear = [_scales(collector, pair), _offsets(collector, pair)]
    shows_parameters = any([*linear, _ranges(collector, pair)])
    for key, before, after in (("enum", old.enum, new.enum), ("flags", old.flags, new.flags)):
        _members(collector, pair, key, before, after)
    rows = (_UNIT,) if shows_parameters else (_UNIT, _PARAMETERS)
    collector.attributes(rows, pair.item, pair.places, old, new, pair.use, name=pair.name)
    collector.attributes(
        [_PLAUSIBLE], pair.item, pair.places, old, new, AffectedUsers((), pair.use.commands), name=pair.name
    )


def _scale(linear: Linear | None) -> object:
    return linear and (linear.scale, linear.times)


def _scales(collector: Collector, pair: Pair) -> bool:
    """Adds changes of scales; whether there are any of their values."""
    changed = False
    for case in _cases(pair.old.linear, pair.new.linear):
        old, new = case.old, case.new
        shown = _scale_shown(old, pair.old), _scale_shown(new, pair.new)
        if _scale(old) != _scale(new):
            pair.add(collector, "scale-changed", "scale", case, *shown)
            changed = True
        elif old and new and (old.printed or "1") != (new.printed or "1") and not old.is_identity:
            pair.add(collector, "scale-rewritten", "scale", case, *shown)
    return changed


def _offsets(collector: Collector, pair: Pair) -> bool:
    """Adds changes of offsets; whether there are any."""
    changed = False
    for case in _cases(_offsets_of(pair.old.linear), _offsets_of(pair.new.linear)):
        old, new = case.old, case.new
        if old is not None and new is not None and old != new:
            shown = _offset_shown(old, pair.old), _offset_shown(new, pair.new)
            pair.add(collector, "offset-changed", "offset", case, *shown)
            changed = True
    return changed


def _offsets_of(linear: ByParameter[Linear]) -> ByParameter[Linear]:
    """The offsets of some scales alone."""

    def offset(line: Linear | None) -> Linear | None:
        return line and Linear(Fraction(1), line.offset, line.times if line.offset else None)

    cases = {name: offset(line) for name, line in linear.cases.items()}
    return ByParameter(parameter=linear.parameter, constant=offset(linear.constant), cases=cases)


def _offset_shown(linear: Linear, type_: Type) -> str:
    return formatting.offset(linear, formatting.decimal) + _unit(type_)


def _scale_shown(linear: Linear | None, type_: Type) -> str:
    return Keyword("not given") if linear is None else f"{formatting.step(linear)}{_unit(type_)}"


def _unit(type_: Type) -> str:
    return f" {type_.unit.symbol}" if type_.unit else ""


def _ranges(collector: Collector, pair: Pair) -> bool:
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
        pair.add(collector, "range-changed", "raw_range", case, shown[0], shown[1])
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
    low, high = type_.raw_limits
    return Range(Bound(Fraction(low)), Bound(Fraction(high)))


def _cases(old: ByParameter[T], new: ByParameter[T]) -> Iterator[Case[T]]:
    """Where two differ, cases that differ alike together."""
    groups: list[tuple[list[str], list[Assignment], T | None, T | None]] = []
    for name, assignment in _assignments(old, new):
        before, after = old.at(assignment), new.at(assignment)
        known = next((group for group in groups if group[2:] == (before, after)), None)
        if known is None:
            groups.append(([name], [assignment], before, after))
        else:
            known[0].append(name)
            known[1].append(assignment)
    parameters = "" if len({old.parameter, new.parameter} - {None}) > 1 else f"{old.parameter or new.parameter} "
    for names, assignments, before, after in groups:
        when = "" if names == [""] else f" [{parameters}{', '.join(names)}]"
        yield Case(when, tuple(assignments) if when else (), before, after)


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


def _members(collector: Collector, pair: Pair, key: str, old: tuple[Member, ...], new: tuple[Member, ...]) -> None:
    matched = match.members(old, new)
    parents = at(pair.places, key)
    for old_member, new_member in matched.pairs:
        places = (*parents[0], old_member.name), (*parents[1], new_member.name)
        facts = {"name": pair.name, "old": old_member.name, "new": new_member.name}
        collector.renamed("member-renamed", pair.item, places, pair.use, **facts)
        if old_member.value != new_member.value:
            facts = {
                "name": pair.name,
                "member": new_member.name,
                "old": str(old_member.value),
                "new": str(new_member.value),
            }
            collector.add("member-renumbered", pair.item, places, pair.use, **facts)
        collector.attributes(
            [_WITHOUT_EFFECTS],
            pair.item,
            places,
            old_member,
            new_member,
            pair.use,
            name=pair.name,
            member=new_member.name,
        )
        collector.deprecation(pair.item, places, new_member.name, old_member.deprecated, new_member.deprecated)
        collector.texts(pair.item, places, old_member, new_member)
    replaced = matched.also(lambda a, b: a.value == b.value)
    for old_member, new_member in replaced.pairs[len(matched.pairs) :]:
        places = (*parents[0], old_member.name), (*parents[1], new_member.name)
        facts = {"name": pair.name, "value": str(old_member.value), "old": old_member.name, "new": new_member.name}
        collector.add("member-replaced", pair.item, places, pair.use, **facts)
    for gone in replaced.removed:
        facts = {"name": pair.name, "member": gone.name, "value": str(gone.value)}
        places = (*parents[0], gone.name), parents[1]
        collector.removed("member-removed", pair.item, places, pair.use, gone.deprecated, **facts)
    for fresh in replaced.added:
        facts = {"name": pair.name, "member": fresh.name, "value": str(fresh.value)}
        collector.add("member-added", pair.item, (parents[0], (*parents[1], fresh.name)), pair.use, **facts)
