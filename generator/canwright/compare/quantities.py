"""Changes of what bits mean: scales, offsets, units, ranges, members."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.types import Bound, Dependent, Linear, Member, Range, Type
from .change import Impact, Item, Said, Side
from .collector import Found, Use
from .match import by_name

T = TypeVar("T")


@dataclass(frozen=True)
class Pair:
    """A type of the old edition and what it is in the new one, under the name that people know it by."""

    old: Type
    new: Type
    item: Item
    name: str
    old_path: DocumentPath
    new_path: DocumentPath
    use: Use

    def add(self, found: Found, rule: str, impact: Impact, key: str, /, **facts: str) -> None:
        found.add(
            rule, self.item, (*self.old_path, key), (*self.new_path, key), impact, self.use, name=self.name, **facts
        )


def compare(found: Found, pair: Pair) -> None:
    """All changes of what a type means."""
    old, new = pair.old, pair.new
    _scales(found, pair)
    if old.unit != new.unit:
        facts = {key: t.unit.symbol if t.unit else Said("no unit") for key, t in (("old", old), ("new", new))}
        pair.add(found, "unit-changed", Impact.SILENT, "unit", **facts)
    _ranges(found, pair)
    for key, before, after in (("enum", old.enum, new.enum), ("flags", old.flags, new.flags)):
        _members(found, pair, key, before, after)
    needed = [(*type_.parameters, *type_.numbers) for type_ in (old, new)]
    if needed[0] != needed[1]:
        facts = {key: ", ".join(names) or Said("nothing") for key, names in zip(("old", "new"), needed, strict=True)}
        pair.add(found, "parameters-of-type-changed", Impact.BUILD, "scale", **facts)


def _scales(found: Found, pair: Pair) -> None:
    def step(linear: Linear | None) -> tuple[object, object]:
        """Scale and offset, each with what it is a multiple of."""
        if linear is None:
            return None, (Fraction(0), None)
        return (linear.scale, linear.times), (linear.offset, linear.times if linear.offset else None)

    old, new = pair.old.linear, pair.new.linear
    for when, one, other in _cases(old, new, lambda a, b: step(a)[0] == step(b)[0]):
        facts = {"when": when, "old": _worth(one, pair.old), "new": _worth(other, pair.new)}
        pair.add(found, "scale-changed", Impact.SILENT, "scale", **facts)
    for when, one, other in _cases(old, new, lambda a, b: not a or not b or step(a)[1] == step(b)[1]):
        sides = ((one, pair.old), (other, pair.new))
        told = [(formatting.offset(linear) if linear else "0") + _unit(type_) for linear, type_ in sides]
        facts = {"when": when, "old": told[0], "new": told[1]}
        pair.add(found, "offset-changed", Impact.SILENT, "offset", **facts)
    for when, one, other in _cases(old, new, lambda a, b: a != b or not a or not b or a.printed == b.printed):
        facts = {"when": when, "old": _worth(one, pair.old), "new": _worth(other, pair.new)}
        pair.add(found, "scale-rewritten", Impact.SAFE, "scale", **facts)


def _worth(linear: Linear | None, type_: Type) -> str:
    return Said("not given") if linear is None else f"{formatting.step(linear)}{_unit(type_)}"


def _unit(type_: Type) -> str:
    return f" {type_.unit.symbol}" if type_.unit else ""


def _ranges(found: Found, pair: Pair) -> None:
    def whole(type_: Type, limits: Range | None) -> Range:
        low, high = type_.raw_limits
        return limits or Range(Bound(Fraction(low)), Bound(Fraction(high)))

    for when, one, other in _cases(pair.old.raw_range, pair.new.raw_range, lambda a, b: a == b):
        old, new = whole(pair.old, one), whole(pair.new, other)
        if old == new or (one is None and other is None):
            continue
        hit = (Side.SENDING in pair.use.sides and not _within(old, new)) or (
            Side.RECEIVING in pair.use.sides and not _within(new, old)
        )
        impact = Impact.SILENT if hit else Impact.SAFE
        told = [Said("not limited") if limits is None else formatting.span(limits) for limits in (one, other)]
        facts = {"when": when, "old": told[0], "new": told[1]}
        pair.add(found, "range-changed", impact, "raw_range", **facts)


def _within(inner: Range, outer: Range) -> bool:
    """Whether a range surely lies in another."""
    if (inner.low.parameter, inner.high.parameter) != (outer.low.parameter, outer.high.parameter):
        return False
    if (inner.low.coefficient, inner.high.coefficient) != (outer.low.coefficient, outer.high.coefficient):
        return False
    return outer.low.constant <= inner.low.constant and inner.high.constant <= outer.high.constant


def _cases(
    old: Dependent[T], new: Dependent[T], same: Callable[[T | None, T | None], bool]
) -> Iterator[tuple[str, T | None, T | None]]:
    """Where two differ, cases that differ alike together: (` [series A, B]` or nothing, old, new)."""
    parameter = old.parameter or new.parameter
    if old.parameter and new.parameter and old.parameter != new.parameter:
        parameter = None
    names = [n for n in {**old.cases, **new.cases} if all(n in d.cases for d in (old, new) if d.parameter)]
    groups: list[tuple[list[str], T | None, T | None]] = []
    for name in names if parameter else [""]:
        at = {parameter or "": name}
        one, other = old.at(at), new.at(at)
        if not same(one, other):
            known = next((group for group in groups if group[1:] == (one, other)), None)
            if known is None:
                groups.append(([name], one, other))
            else:
                known[0].append(name)
    for group, one, other in groups:
        yield (f" [{parameter} {', '.join(group)}]" if parameter else ""), one, other


def _members(found: Found, pair: Pair, key: str, old: tuple[Member, ...], new: tuple[Member, ...]) -> None:
    matched = by_name(old, new).also(lambda a, b: a.value == b.value)
    sides = pair.use.sides
    for one, other in matched.pairs:
        places = (*pair.old_path, key, one.name), (*pair.new_path, key, other.name)
        if one.name != other.name:
            facts = {"name": pair.name, "old": one.name, "new": other.name}
            found.renamed("member-renamed", pair.item, *places, pair.use, **facts)
        if one.value != other.value:
            facts = {"name": pair.name, "member": other.name, "old": str(one.value), "new": str(other.value)}
            found.add("member-renumbered", pair.item, *places, Impact.SILENT, pair.use, **facts)
        found.texts(pair.item, places, one, other)
    for gone in matched.removed:
        impact = Impact.SILENT if Side.SENDING in sides else Impact.SAFE
        where = (*pair.old_path, key, gone.name), (*pair.new_path, key)
        facts = {"name": pair.name, "member": gone.name, "value": str(gone.value)}
        found.add("member-removed", pair.item, *where, impact, pair.use, **facts)
    for fresh in matched.added:
        unseen = Impact.SILENT if key == "flags" else Impact.LOUD
        impact = unseen if Side.RECEIVING in sides else Impact.SAFE
        where = (*pair.old_path, key), (*pair.new_path, key, fresh.name)
        facts = {"name": pair.name, "member": fresh.name, "value": str(fresh.value)}
        found.add("member-added", pair.item, *where, impact, pair.use, **facts)
