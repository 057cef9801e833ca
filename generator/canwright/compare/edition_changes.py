"""Changes outside commands: addresses, bus, parameters, settings, effects, states, errata, texts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TypeVar

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Address, Direction, IdRule
from ..model.metadata import Bus, Effect, Erratum, Mode, Setting, State
from ..model.types import Parameter, Text
from .change import Impact, Item, Keyword, SentenceArgument, Side
from .collector import (
    BOTH_SIDES,
    UNUSED,
    AffectedUsers,
    Attribute,
    Collector,
    Titled,
    at,
    differing,
    given,
    listed,
    paths,
    scope,
    section,
)
from .match import Matched, by_name

T = TypeVar("T", bound=Titled)

_EDITION, _BUS = Item("edition", ""), Item("bus", "")


def _fewer_rates(old: Mode, new: Mode) -> Impact:
    gone = set(old.bit_rates_kbps) - set(new.bit_rates_kbps)
    return Impact.LOUD if gone or new.default_kbps not in (None, old.default_kbps) else Impact.SAFE


def _rates(mode: Mode) -> SentenceArgument:
    rates = listed(sorted(mode.bit_rates_kbps, reverse=True))
    return rates if mode.default_kbps is None else (rates, " (", Keyword("default"), f" {mode.default_kbps})")


def _ends(parameter: Parameter) -> tuple[Fraction | None, Fraction | None]:
    return parameter.minimum, parameter.maximum


def _bounds(parameter: Parameter) -> str:
    return "..".join("" if end is None else formatting.decimal(end) for end in _ends(parameter))


def _entered_by(state: State) -> SentenceArgument:
    if not state.is_initial:
        return listed(state.entered_by)
    return (Keyword("power-up"), *(f", {name}" for name in state.entered_by))


_OF_EDITION = (
    Attribute[Edition]("languages-changed", "languages", lambda e: listed(e.languages), lambda e: set(e.languages)),
)
_OF_BUS = (
    Attribute[Bus]("reply-time-changed", "reply_within_ms", lambda b: given(b.reply_within_ms)),
    Attribute[Bus]("max-nodes-changed", "max_nodes", lambda b: given(b.max_nodes)),
)
_OF_MODE = (Attribute[Mode]("bit-rates-changed", "bit_rates_kbps", _rates, impact=_fewer_rates),)
_OF_EFFECT = (Attribute[Effect]("effect-level-changed", "level", lambda e: Keyword(e.level.value)),)
_OF_SETTING = (Attribute[Setting]("setting-scope-changed", "only", lambda s: scope(s.only)),)
_OF_STATE = (
    Attribute[State]("state-entry-changed", "entered_by", _entered_by, impact=Impact.SILENT),
    Attribute[State](
        "state-effects-changed", "prevents", lambda s: listed(e.name for e in s.prevents), impact=Impact.SILENT
    ),
)
_OF_PARAMETER = (Attribute[Parameter]("parameter-bounds-changed", "number", _bounds, _ends, Impact.SILENT),)


def compare(found: Collector, old: Edition, new: Edition) -> None:
    """All changes that belong to no command."""
    _addresses(found, old.addresses, new.addresses)
    _bus(found, old.bus, new.bus)
    _parameters(found, old.parameters, new.parameters)
    _items(found, "setting", ("settings",), by_name(old.settings, new.settings), _OF_SETTING)
    effects = by_name(old.effects, new.effects)  # others come and go with the commands that have them
    _items(found, "effect", ("effects",), replace(effects, removed=(), added=()), _OF_EFFECT)
    _states(found, old, new)
    _errata(found, old, new)
    found.title(_EDITION, (("title",), ("title",)), new.family, old.title, new.title)
    found.text("text-changed", _EDITION, (("about",), ("about",)), old.family, old.about, new.about)
    found.text("title-changed", _EDITION, (("manual",), ("manual",)), "manual", old.manual, new.manual)
    found.attributes(_OF_EDITION, _EDITION, ((), ()), old, new, UNUSED)


def _items(
    found: Collector,
    kind: str,
    path: DocumentPath,
    matched: Matched[T],
    rows: Sequence[Attribute[T]] = (),
    use: AffectedUsers = UNUSED,
    removed: tuple[AffectedUsers, Impact | None] = (UNUSED, None),
    added: AffectedUsers = UNUSED,
) -> None:
    """Changes of the attributes and texts of items of one kind; items that are removed and added."""
    for one, other in matched.pairs:
        item, places = Item(kind, one.name), ((*path, one.name), (*path, one.name))
        found.attributes(rows, item, places, one, other, use, name=one.name)
        found.texts(item, places, one, other)
    for gone in matched.removed:
        found.add(f"{kind}-removed", Item(kind, gone.name), ((*path, gone.name), path), *removed, name=gone.name)
    for fresh in matched.added:
        found.add(f"{kind}-added", Item(kind, fresh.name), (path, (*path, fresh.name)), added, name=fresh.name)


def _addresses(found: Collector, old: Sequence[Address], new: Sequence[Address]) -> None:
    matched = by_name(old, new).also(lambda a, b: (a.request, a.reply) == (b.request, b.reply))
    for one, other in matched.pairs:
        item, places = Item("address", one.name), paths(one, other)
        found.renamed("address-renamed", item, places, BOTH_SIDES, old=one.name, new=other.name)
        extended = [(a.request.extended, a.reply.extended) for a in (one, other)]
        if extended[0] != extended[1]:
            _extended(found, item, one, other)
        if one.request == one.reply and other.request == other.reply:
            _rule(found, item, (one, other), tuple(Direction), one.request, other.request)
        else:
            _rule(found, item, (one, other), (Direction.REQUEST,), one.request, other.request)
            _rule(found, item, (one, other), (Direction.REPLY,), one.reply, other.reply)
        found.section(item, places, one.manual, other.manual)
        found.texts(item, places, one, other)
    for gone in matched.removed:
        facts = {"name": gone.name, "old": formatting.id_rule(gone.request)}
        places = gone.path, ("addresses",)
        found.add("address-removed", Item("address", gone.name), places, BOTH_SIDES, **facts)
    for fresh in matched.added:
        facts = {"name": fresh.name, "new": formatting.id_rule(fresh.request)}
        places = ("addresses",), fresh.path
        found.add("address-added", Item("address", fresh.name), places, UNUSED, **facts)


def _rule(
    found: Collector,
    item: Item,
    pair: tuple[Address, Address],
    directions: tuple[Direction, ...],
    old: IdRule,
    new: IdRule,
) -> None:
    sides = tuple(map(Side.of, directions))
    before, after = ((r.base, r.node_step, r.nodes is None) for r in (old, new))
    if before != after:
        facts = {"direction": Keyword(" and ".join(d.value for d in directions)), "old": _id(old), "new": _id(new)}
        key = directions[0].value if len(directions) == 1 else "id"
        found.add("id-changed", item, at(paths(*pair), key), AffectedUsers(sides), **facts)
    if old.nodes is not None and new.nodes is not None and old.nodes != new.nodes:
        facts = {"old": f"{old.nodes[0]}..{old.nodes[-1]}", "new": f"{new.nodes[0]}..{new.nodes[-1]}"}
        found.add("nodes-changed", item, at(paths(*pair), "nodes"), AffectedUsers(sides), **facts)


def _extended(found: Collector, item: Item, old: Address, new: Address) -> None:
    """Adds the change of the width of all ids of an address."""

    def ids(address: Address) -> SentenceArgument:
        request, reply = _id(address.request), _id(address.reply)
        return request if request == reply else (request, ", ", reply)

    facts = {"direction": Keyword("request and reply"), "old": ids(old), "new": ids(new)}
    found.add("id-changed", item, at(paths(old, new), "extended"), BOTH_SIDES, **facts)


def _id(rule: IdRule) -> SentenceArgument:
    return (formatting.id_rule(rule), *((" (", Keyword("29 bits"), ")") if rule.extended else ()))


def _bus(found: Collector, old: Bus, new: Bus) -> None:
    places = ("bus",), ("bus",)
    found.renamed("host-renamed", _BUS, at(places, "host"), BOTH_SIDES, old=old.host, new=new.host)
    found.section(_BUS, places, old.manual, new.manual)
    modes = by_name(old.modes, new.modes)
    _items(found, "mode", ("bus", "modes"), modes, _OF_MODE, BOTH_SIDES, (BOTH_SIDES, Impact.LOUD))
    found.attributes(_OF_BUS, _BUS, places, old, new, UNUSED)


def _parameters(found: Collector, old: Sequence[Parameter], new: Sequence[Parameter]) -> None:
    matched = by_name(old, new)
    for one, other in matched.pairs:
        item, path = Item("parameter", one.name), ("parameters", one.name, "values")
        values = by_name(one.values, other.values)
        for value, now in values.pairs:
            found.texts(item, ((*path, value.name), (*path, now.name)), value, now)
        for value in values.removed:
            facts = {"name": one.name, "value": value.name}
            found.add("parameter-value-removed", item, ((*path, value.name), path), BOTH_SIDES, **facts)
        for value in values.added:
            facts = {"name": one.name, "value": value.name}
            found.add("parameter-value-added", item, (path, (*path, value.name)), UNUSED, **facts)
    _items(found, "parameter", ("parameters",), matched, _OF_PARAMETER, BOTH_SIDES, (BOTH_SIDES, None), BOTH_SIDES)


def _states(found: Collector, old: Edition, new: Edition) -> None:
    now = {c.previous_name: c.spec_name for c in new.commands if c.previous_name}
    before = [replace(one, entered_by=tuple(now.get(name, name) for name in one.entered_by)) for one in old.states]
    _items(found, "state", ("states",), by_name(before, new.states), _OF_STATE, AffectedUsers((Side.SENDING,)))


def _errata(found: Collector, old: Edition, new: Edition) -> None:
    before, after = ({e.id: (i, e) for i, e in enumerate(edition.errata)} for edition in (old, new))
    for id_ in dict.fromkeys((*before, *after)):
        (i, one), (j, other) = before.get(id_, (None, None)), after.get(id_, (None, None))
        rule: str | None = None
        facts: dict[str, SentenceArgument] = {"name": id_} if other is None else {"name": id_, "used": other.used}
        if other is None:
            rule = "erratum-removed"
        elif one is None:
            rule = "erratum-added"
        elif any(differing(a, b) for a, b in zip(_texts(one), _texts(other), strict=True)):
            rule = "erratum-changed"
        elif (one.where, one.manual) != (other.where, other.manual):
            rule, facts = "erratum-moved", {"name": id_, "old": _about(one), "new": _about(other)}
        if rule is not None:
            places = (_erratum(i), _erratum(j))
            found.add(rule, Item("erratum", id_), places, UNUSED, **facts)


def _erratum(number: int | None) -> DocumentPath:
    return ("errata",) if number is None else ("errata", number)


def _about(erratum: Erratum) -> SentenceArgument:
    return (listed(erratum.where), " (", Keyword("section"), " ", section(erratum.manual), ")")


def _texts(erratum: Erratum) -> tuple[Text, Text, Text]:
    return erratum.printed, erratum.used, erratum.why
