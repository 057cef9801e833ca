"""Renamed items, and the old edition with the names of the new one."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Layout, ParameterRole
from ..model.message import Command, IdRule, Message
from ..model.metadata import Effect, Mode, Setting
from ..model.types import Bound, ByParameter, ImpliedTitle, Linear, Member, Parameter
from .change import Item
from .collector import BOTH_SIDES, Collector, Subject
from .match import Matched, Named, by_name

_WORD = re.compile("[a-z][a-z0-9_]*")
T = TypeVar("T", bound=Named)


@dataclass
class _Names:
    """Old names to new ones; the values of a parameter under its new name."""

    of: dict[type[object], dict[str, str]] = field(default_factory=dict)
    values: dict[str, dict[str, str]] = field(default_factory=dict)

    def new(self, kind: type[object], name: str) -> str:
        return self.of.get(kind, {}).get(name, name)

    def value(self, parameter: str | None, name: str) -> str:
        return self.values.get(self.new(Parameter, parameter or ""), {}).get(name, name)

    def scope(self, only: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
        return {self.new(Parameter, p): tuple(self.value(p, value) for value in values) for p, values in only.items()}


def compare(collector: Collector, old: Edition, new: Edition) -> Edition:
    """All renames of what commands name; the old edition as it would be with the new names."""
    names = _Names()
    _renamed(collector, names, Parameter, ("parameters",), _parameters(old, new))
    for old_parameter, new_parameter in _parameters(old, new).pairs:
        if old_parameter.is_numeric or new_parameter.is_numeric:
            continue
        for value, now in (
            by_name(old_parameter.values, new_parameter.values).also(lambda a, b: a.title == b.title).pairs
        ):
            if value.name != now.name:
                names.values.setdefault(new_parameter.name, {})[value.name] = now.name
                places = (
                    ("parameters", old_parameter.name, "values", value.name),
                    ("parameters", new_parameter.name, "values", now.name),
                )
                parameter = Subject(collector, Item("parameter", old_parameter.name), places, BOTH_SIDES)
                parameter.renamed("parameter-value-renamed", value.name, now.name, name=new_parameter.name)
    settings = by_name(old.settings, new.settings).also(_same_title, _same_use(old, new, lambda c: c.limited_by))
    _renamed(collector, names, Setting, ("settings",), settings)
    effects = by_name(old.effects, new.effects).also(_same_title, _same_use(old, new, lambda c: c.effects))
    _renamed(collector, names, Effect, ("effects",), effects)
    modes = by_name(old.bus.modes, new.bus.modes).also(
        lambda a, b: (a.bit_rates_kbps, a.default_kbps) == (b.bit_rates_kbps, b.default_kbps)
    )
    _renamed(collector, names, Mode, ("bus", "modes"), modes)
    if not names.of and not names.values:
        return old
    renamed: Edition = _in(names, old)
    return renamed


def _parameters(old: Edition, new: Edition) -> Matched[Parameter]:
    def same_values(earlier: Parameter, later: Parameter) -> bool:
        bounds = (earlier.minimum, earlier.maximum) == (later.minimum, later.maximum)
        return bounds and {v.name for v in earlier.values} == {v.name for v in later.values}

    return by_name(old.parameters, new.parameters).also(_same_title, same_values)


def _same_title(first: Parameter | Setting | Effect, second: Parameter | Setting | Effect) -> bool:
    return first.title == second.title


def _same_use(
    old: Edition, new: Edition, names: Callable[[Command], tuple[Setting, ...] | tuple[Effect, ...]]
) -> Callable[[Setting | Effect, Setting | Effect], bool]:
    """Whether two are named by the same commands, and by any."""

    def users(edition: Edition, name: str) -> set[str]:
        return {c.name for c in edition.commands if any(named.name == name for named in names(c))}

    return lambda earlier, later: bool(users(old, earlier.name)) and users(old, earlier.name) == users(new, later.name)


def _renamed(collector: Collector, names: _Names, kind: type[object], path: DocumentPath, matched: Matched[T]) -> None:
    word = kind.__name__.lower()
    for old, new in matched.pairs:
        if old.name != new.name:
            names.of.setdefault(kind, {})[old.name] = new.name
            was, now = (*path, old.name), (*path, new.name)
            subject = Subject(collector, Item(word, old.name), (was, now), BOTH_SIDES)
            subject.renamed(f"{word}-renamed", old.name, new.name)
            collector.moved[now] = was


def _in(names: _Names, part: Any) -> Any:
    """A part of the old edition in new names; the same object where nothing has another name."""
    if isinstance(part, tuple):
        made = tuple(_in(names, item) for item in part)
        return part if all(a is b for a, b in zip(part, made, strict=True)) else made
    if not dataclasses.is_dataclass(part) or isinstance(part, type):
        return part
    facts = {f.name: getattr(part, f.name) for f in dataclasses.fields(part)}
    changed = {name: _in(names, fact) for name, fact in facts.items()} | _own(names, part)
    return part if all(changed[name] is fact for name, fact in facts.items()) else dataclasses.replace(part, **changed)


def _own(names: _Names, part: Any) -> dict[str, Any]:
    """The facts of one thing that are names, or are kept under names."""
    if isinstance(part, (Parameter, Setting, Effect, Mode)):
        name = names.new(type(part), part.name)
        own: dict[str, Any] = {"name": name}
        if name != part.name and isinstance(part.title, ImpliedTitle):
            own["title"] = ImpliedTitle.fromkeys(part.title, formatting.spoken(name))
        if isinstance(part, Parameter):
            own["values"] = tuple(dataclasses.replace(v, name=names.value(part.name, v.name)) for v in part.values)
        if isinstance(part, Setting):
            own["only"] = names.scope(part.only)
        return own
    if isinstance(part, Command):
        return {"only": names.scope(part.only), "mode": part.mode and names.new(Mode, part.mode)}
    if isinstance(part, Message):
        return {"only": names.scope(part.only)}
    if isinstance(part, Member):
        return {"without_effects": tuple(names.new(Effect, name) for name in part.without_effects)}
    if isinstance(part, (Bound, IdRule, ParameterRole)):
        return {"parameter": part.parameter and names.new(Parameter, part.parameter)}
    if isinstance(part, Linear):
        return {"times": part.times and _WORD.sub(lambda name: names.new(Parameter, name[0]), part.times)}
    if isinstance(part, ByParameter) and part.parameter is not None:
        cases = {names.value(part.parameter, name): _in(names, case) for name, case in part.cases.items()}
        return {"parameter": names.new(Parameter, part.parameter), "cases": cases}
    if isinstance(part, Layout) and part.parameter is not None:
        return _layout(names, part, part.parameter)
    return {}


def _layout(names: _Names, layout: Layout, parameter: str) -> dict[str, Any]:
    def values(old: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(names.value(parameter, value) for value in old)

    fields = {f.name: dataclasses.replace(_in(names, f), only=values(f.only)) for f in layout.fields}
    variants = tuple(
        dataclasses.replace(v, values=values(v.values), fields=tuple(fields[f.name] for f in v.fields))
        for v in layout.variants
    )
    return {"parameter": names.new(Parameter, parameter), "fields": tuple(fields.values()), "variants": variants}
