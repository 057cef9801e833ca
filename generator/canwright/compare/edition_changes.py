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


def compare(collector: Collector, old: Edition, new: Edition) -> None:
    """All changes that belong to no command."""
    _addresses(collector, old.addresses, new.addresses)
    _bus(collector, old.bus, new.bus)
    _parameters(collector, old.parameters, new.parameters)
    _items(collector, "setting", ("settings",), by_name(old.settings, new.settings), _OF_SETTING)
    effects = by_name(old.effects, new.effects)  # others come and go with the commands that have them
    _items(collector, "effect", ("effects",), replace(effects, removed=(), added=()), _OF_EFFECT)
    _states(collector, old, new)
    _errata(collector, old, new)
    collector.title(_EDITION, (("title",), ("title",)), new.family, old.title, new.title)
    collector.text("text-changed", _EDITION, (("about",), ("about",)), old.family, old.about, new.about)
    collector.text("title-changed", _EDITION, (("manual",), ("manual",)), "manual", old.manual, new.manual)
    collector.attributes(_OF_EDITION, _EDITION, ((), ()), old, new, UNUSED)


def _items(
    collector: Collector,
    kind: str,
    path: DocumentPath,
    matched: Matched[T],
    rows: Sequence[Attribute[T]] = (),
    use: AffectedUsers = UNUSED,
    removed: tuple[AffectedUsers, Impact | None] = (UNUSED, None),
    added: AffectedUsers = UNUSED,
) -> None:
    """Changes of the attributes and texts of items of one kind; items that are removed and added."""
    for old, new in matched.pairs:
        item, places = Item(kind, old.name), ((*path, old.name), (*path, old.name))
        collector.attributes(rows, item, places, old, new, use, name=old.name)
        collector.texts(item, places, old, new)
    for gone in matched.removed:
        collector.add(f"{kind}-removed", Item(kind, gone.name), ((*path, gone.name), path), *removed, name=gone.name)
    for fresh in matched.added:
        collector.add(f"{kind}-added", Item(kind, fresh.name), (path, (*path, fresh.name)), added, name=fresh.name)


def _addresses(collector: Collector, old: Sequence[Address], new: Sequence[Address]) -> None:
    matched = by_name(old, new).also(lambda a, b: (a.request, a.reply) == (b.request, b.reply))
    for old_address, new_address in matched.pairs:
        item, places = Item("address", old_address.name), paths(old_address, new_address)
        collector.renamed("address-renamed", item, places, BOTH_SIDES, old=old_address.name, new=new_address.name)
        extended = [(a.request.extended, a.reply.extended) for a in (old_address, new_address)]
        if extended[0] != extended[1]:
            _extended(collector, item, old_address, new_address)
        if old_address.request == old_address.reply and new_address.request == new_address.reply:
            _rule(
                collector, item, (old_address, new_address), tuple(Direction), old_address.request, new_address.request
            )
        else:
            _rule(
                collector,
                item,
                (old_address, new_address),
                (Direction.REQUEST,),
                old_address.request,
                new_address.request,
            )
            _rule(collector, item, (old_address, new_address), (Direction.REPLY,), old_address.reply, new_address.reply)
        collector.section(item, places, old_address.manual, new_address.manual)
        collector.texts(item, places, old_address, new_address)
    for gone in matched.removed:
        facts = {"name": gone.name, "old": formatting.id_rule(gone.request)}
        places = gone.path, ("addresses",)
        collector.add("address-removed", Item("address", gone.name), places, BOTH_SIDES, **facts)
    for fresh in matched.added:
        facts = {"name": fresh.name, "new": formatting.id_rule(fresh.request)}
        places = ("addresses",), fresh.path
        collector.add("address-added", Item("address", fresh.name), places, UNUSED, **facts)


def _rule(
    collector: Collector,
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
        collector.add("id-changed", item, at(paths(*pair), key), AffectedUsers(sides), **facts)
    if old.nodes is not None and new.nodes is not None and old.nodes != new.nodes:
        facts = {"old": f"{old.nodes[0]}..{old.nodes[-1]}", "new": f"{new.nodes[0]}..{new.nodes[-1]}"}
        collector.add("nodes-changed", item, at(paths(*pair), "nodes"), AffectedUsers(sides), **facts)


def _extended(collector: Collector, item: Item, old: Address, new: Address) -> None:
    """Adds the change of the width of all ids of an address."""

    def ids(address: Address) -> SentenceArgument:
        request, reply = _id(address.request), _id(address.reply)
        return request if request == reply else (request, ", ", reply)

    facts = {"direction": Keyword("request and reply"), "old": ids(old), "new": ids(new)}
    collector.add("id-changed", item, at(paths(old, new), "extended"), BOTH_SIDES, **facts)


def _id(rule: IdRule) -> SentenceArgument:
    return (formatting.id_rule(rule), *((" (", Keyword("29 bits"), ")") if rule.extended else ()))


def _bus(collector: Collector, old: Bus, new: Bus) -> None:
    places = ("bus",), ("bus",)
    collector.renamed("host-renamed", _BUS, at(places, "host"), BOTH_SIDES, old=old.host, new=new.host)
    collector.section(_BUS, places, old.manual, new.manual)
    modes = by_name(old.modes, new.modes)
    _items(collector, "mode", ("bus", "modes"), modes, _OF_MODE, BOTH_SIDES, (BOTH_SIDES, Impact.LOUD))
    collector.attributes(_OF_BUS, _BUS, places, old, new, UNUSED)


def _parameters(collector: Collector, old: Sequence[Parameter], new: Sequence[Parameter]) -> None:
    matched = by_name(old, new)
    for old_parameter, new_parameter in matched.pairs:
        item, path = Item("parameter", old_parameter.name), ("parameters", old_parameter.name, "values")
        values = by_name(old_parameter.values, new_parameter.values)
        for value, now in values.pairs:
            collector.texts(item, ((*path, value.name), (*path, now.name)), value, now)
        for value in values.removed:
            facts = {"name": old_parameter.name, "value": value.name}
            collector.add("parameter-value-removed", item, ((*path, value.name), path), BOTH_SIDES, **facts)
        for value in values.added:
            facts = {"name": old_parameter.name, "value": value.name}
            collector.add("parameter-value-added", item, (path, (*path, value.name)), UNUSED, **facts)
    _items(collector, "parameter", ("parameters",), matched, _OF_PARAMETER, BOTH_SIDES, (BOTH_SIDES, None), BOTH_SIDES)


def _states(collector: Collector, old: Edition, new: Edition) -> None:
    now = {c.previous_name: c.spec_name for c in new.commands if c.previous_name}
    before = [
        replace(state, entered_by=tuple(now.get(name, name) for name in state.entered_by)) for state in old.states
    ]
    _items(collector, "state", ("states",), by_name(before, new.states), _OF_STATE, AffectedUsers((Side.SENDING,)))


def _errata(collector: Collector, old: Edition, new: Edition) -> None:
    before, after = ({e.id: (i, e) for i, e in enumerate(edition.errata)} for edition in (old, new))
    for id_ in dict.fromkeys((*before, *after)):
        (i, old_erratum), (j, new_erratum) = before.get(id_, (None, None)), after.get(id_, (None, None))
        rule: str | None = None
        facts: dict[str, SentenceArgument] = (
            {"name": id_} if new_erratum is None else {"name": id_, "used": new_erratum.used}
        )
        if new_erratum is None:
            rule = "erratum-removed"
        elif old_erratum is None:
            rule = "erratum-added"
        elif any(differing(a, b) for a, b in zip(_texts(old_erratum), _texts(new_erratum), strict=True)):
            rule = "erratum-changed"
        elif (old_erratum.where, old_erratum.manual) != (new_erratum.where, new_erratum.manual):
            rule, facts = "erratum-moved", {"name": id_, "old": _about(old_erratum), "new": _about(new_erratum)}
        if rule is not None:
            places = (_erratum(i), _erratum(j))
            collector.add(rule, Item("erratum", id_), places, UNUSED, **facts)


def _erratum(number: int | None) -> DocumentPath:
    return ("errata",) if number is None else ("errata", number)


def _about(erratum: Erratum) -> SentenceArgument:
    return (listed(erratum.where), " (", Keyword("section"), " ", section(erratum.manual), ")")


def _texts(erratum: Erratum) -> tuple[Text, Text, Text]:
    return erratum.printed, erratum.used, erratum.why
