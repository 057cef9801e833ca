"""Changes around the commands: addresses, bus, parameters, settings, errata."""

from __future__ import annotations

from collections.abc import Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from ..model.edition import Edition
from ..model.message import Address, Direction, IdRule
from ..model.metadata import Bus, Erratum, Mode, Setting
from ..model.types import Parameter, Text
from .change import Fact, Impact, Item, Said, Side
from .collector import BOTH_SIDES, Found, Use, differ, listed, section
from .match import Matched, T, by_name

_UNHIT = (Impact.SAFE, Use())


def compare(found: Found, old: Edition, new: Edition) -> None:
    """All changes that belong to no command."""
    _addresses(found, old.addresses, new.addresses)
    _bus(found, old.bus, new.bus)
    _parameters(found, old.parameters, new.parameters)
    _settings(found, old.settings, new.settings)
    for effect, now in by_name(old.effects, new.effects).pairs:
        item, path = Item("effect", effect.name), ("effects", effect.name)
        if effect.level is not now.level:
            facts = {"name": effect.name, "old": Said(effect.level.value), "new": Said(now.level.value)}
            place = (*path, "level")
            found.add("effect-level-changed", item, place, place, Impact.SAFE, Use(), **facts)
        found.texts(item, (path, path), effect, now)
    _errata(found, old, new)
    edition = Item("edition", "")
    found.title(edition, (("title",), ("title",)), (old.family, new.family), old.title, new.title)
    found.text("text-changed", edition, (("about",), ("about",)), old.family, old.about, new.about)
    found.text("title-changed", edition, (("manual",), ("manual",)), "manual", old.manual, new.manual)
    if set(old.languages) != set(new.languages):
        facts = {"old": listed(old.languages), "new": listed(new.languages)}
        found.add("languages-changed", edition, ("languages",), ("languages",), Impact.SAFE, Use(), **facts)


def _come_and_gone(
    found: Found, kind: str, path: DocumentPath, matched: Matched[T], lost: tuple[Impact, Use], new: tuple[Impact, Use]
) -> None:
    """What is gone and what is new at a path, each with how it hits and whom."""
    for gone in matched.removed:
        found.add(f"{kind}-removed", Item(kind, gone.name), (*path, gone.name), path, *lost, name=gone.name)
    for fresh in matched.added:
        found.add(f"{kind}-added", Item(kind, fresh.name), path, (*path, fresh.name), *new, name=fresh.name)


def _settings(found: Found, old: Sequence[Setting], new: Sequence[Setting]) -> None:
    settings = by_name(old, new)
    for one, other in settings.pairs:
        item, path = Item("setting", one.name), ("settings", one.name)
        found.texts(item, (path, path), one, other)
        if one.only != other.only:
            scopes = [formatting.condition(setting.only) or Said("all") for setting in (one, other)]
            facts = {"name": one.name, "old": scopes[0], "new": scopes[1]}
            place = (*path, "only")
            found.add("setting-scope-changed", item, place, place, Impact.SAFE, Use(), **facts)
    _come_and_gone(found, "setting", ("settings",), settings, _UNHIT, _UNHIT)


def _addresses(found: Found, old: Sequence[Address], new: Sequence[Address]) -> None:
    matched = by_name(old, new).also(lambda a, b: (a.request, a.reply) == (b.request, b.reply))
    for one, other in matched.pairs:
        item = Item("address", one.name)
        if one.name != other.name:
            found.renamed("address-renamed", item, one.path, other.path, BOTH_SIDES, old=one.name, new=other.name)
        if one.request == one.reply and other.request == other.reply:
            _rule(found, item, (one, other), tuple(Direction), one.request, other.request)
        else:
            _rule(found, item, (one, other), (Direction.REQUEST,), one.request, other.request)
            _rule(found, item, (one, other), (Direction.REPLY,), one.reply, other.reply)
        found.section(item, (one.path, other.path), one.manual, other.manual, Use())
        found.texts(item, (one.path, other.path), one, other)
    for gone in matched.removed:
        facts = {"name": gone.name, "old": formatting.id_rule(gone.request)}
        item = Item("address", gone.name)
        found.add("address-removed", item, gone.path, ("addresses",), Impact.LOUD, BOTH_SIDES, **facts)
    for fresh in matched.added:
        facts = {"name": fresh.name, "new": formatting.id_rule(fresh.request)}
        item = Item("address", fresh.name)
        found.add("address-added", item, ("addresses",), fresh.path, Impact.SAFE, Use(), **facts)


def _rule(
    found: Found,
    item: Item,
    pair: tuple[Address, Address],
    directions: tuple[Direction, ...],
    old: IdRule,
    new: IdRule,
) -> None:
    use = Use(tuple(map(Side.of, directions)))
    if (old.base, old.node_step, old.extended, old.nodes is None) != (
        *(new.base, new.node_step, new.extended),
        new.nodes is None,
    ):
        said = Said(" and ".join(d.value for d in directions))
        facts = {"direction": said, "old": _id(old), "new": _id(new)}
        places = [(*a.path, directions[0].value) for a in pair]
        impact = Impact.SILENT if _taken(old, new) else Impact.LOUD
        found.add("id-changed", item, places[0], places[1], impact, use, **facts)
    if old.nodes is not None and new.nodes is not None and old.nodes != new.nodes:
        facts = {"old": f"{old.nodes[0]}..{old.nodes[-1]}", "new": f"{new.nodes[0]}..{new.nodes[-1]}"}
        places = [(*a.path, "nodes") for a in pair]
        for side in use.sides:
            beyond = set(new.nodes) - set(old.nodes) if side is Side.RECEIVING else set(old.nodes) - set(new.nodes)
            impact = Impact.LOUD if beyond else Impact.SAFE
            found.add("nodes-changed", item, places[0], places[1], impact, Use((side,)), **facts)


def _id(rule: IdRule) -> Fact:
    return (formatting.id_rule(rule), *((" (", Said("29 bits"), ")") if rule.extended else ()))


def _taken(old: IdRule, new: IdRule) -> bool:
    """Whether an id of one node now is that of another."""
    if old.extended is not new.extended or old.nodes is None or new.nodes is None:
        return False
    node = {new.base + n * new.node_step: n for n in new.nodes}
    return any(node.get(old.base + n * old.node_step, n) != n for n in old.nodes)


def _bus(found: Found, old: Bus, new: Bus) -> None:
    item = Item("bus", "")
    if old.host != new.host:
        names = {"old": old.host, "new": new.host}
        found.renamed("host-renamed", item, ("bus", "host"), ("bus", "host"), BOTH_SIDES, **names)
    found.section(item, (("bus",), ("bus",)), old.manual, new.manual, Use())
    matched = by_name(old.modes, new.modes)
    for one, other in matched.pairs:
        _mode(found, Item("mode", one.name), one, other)
    _come_and_gone(found, "mode", ("bus", "modes"), matched, (Impact.LOUD, BOTH_SIDES), _UNHIT)
    for rule, key, a, b in (
        ("reply-time-changed", "reply_within_ms", old.reply_within_ms, new.reply_within_ms),
        ("max-nodes-changed", "max_nodes", old.max_nodes, new.max_nodes),
    ):
        if a != b:
            facts = {key: Said("not given") if n is None else str(n) for key, n in (("old", a), ("new", b))}
            found.add(rule, item, ("bus", key), ("bus", key), Impact.SAFE, Use(), **facts)


def _mode(found: Found, item: Item, old: Mode, new: Mode) -> None:
    path = ("bus", "modes", old.name)
    another = old.default_kbps != new.default_kbps
    if set(old.bit_rates_kbps) != set(new.bit_rates_kbps) or another:
        facts = {"old": _rates(old), "new": _rates(new)}
        gone = set(old.bit_rates_kbps) - set(new.bit_rates_kbps) or (another and new.default_kbps is not None)
        place = (*path, "bit_rates_kbps")
        found.add("bit-rates-changed", item, place, place, Impact.LOUD if gone else Impact.SAFE, BOTH_SIDES, **facts)
    found.texts(item, (path, path), old, new)


def _rates(mode: Mode) -> Fact:
    rates = listed(sorted(mode.bit_rates_kbps, reverse=True))
    return rates if mode.default_kbps is None else (rates, " (", Said("default"), f" {mode.default_kbps})")


def _parameters(found: Found, old: Sequence[Parameter], new: Sequence[Parameter]) -> None:
    matched = by_name(old, new)
    _come_and_gone(found, "parameter", ("parameters",), matched, (Impact.BUILD, BOTH_SIDES), (Impact.BUILD, BOTH_SIDES))
    for one, other in matched.pairs:
        item, path = Item("parameter", one.name), ("parameters", one.name)
        at = (*path, "values")
        values = by_name(one.values, other.values)
        for value, now in values.pairs:
            found.texts(item, ((*at, value.name), (*at, now.name)), value, now)
        for value in values.removed:
            facts = {"name": one.name, "value": value.name}
            found.add("parameter-value-removed", item, (*at, value.name), at, Impact.BUILD, BOTH_SIDES, **facts)
        for value in values.added:
            facts = {"name": one.name, "value": value.name}
            found.add("parameter-value-added", item, at, (*at, value.name), Impact.SAFE, Use(), **facts)
        if (one.minimum, one.maximum) != (other.minimum, other.maximum):
            facts = {"name": one.name, "old": _bounds(one), "new": _bounds(other)}
            place = (*path, "number")
            found.add("parameter-bounds-changed", item, place, place, Impact.SILENT, BOTH_SIDES, **facts)
        found.texts(item, (path, path), one, other)


def _bounds(parameter: Parameter) -> str:
    ends = [formatting.exact(end) if end is not None else "" for end in (parameter.minimum, parameter.maximum)]
    return "..".join(ends)


def _errata(found: Found, old: Edition, new: Edition) -> None:
    before, after = ({e.id: (i, e) for i, e in enumerate(edition.errata)} for edition in (old, new))
    for id_ in dict.fromkeys((*before, *after)):
        item = Item("erratum", id_)
        (i, one), (j, other) = before.get(id_, (None, None)), after.get(id_, (None, None))
        places: list[DocumentPath] = [("errata",) if n is None else ("errata", n) for n in (i, j)]
        if other is None:
            found.add("erratum-removed", item, places[0], places[1], Impact.SAFE, Use(), name=id_)
        elif one is None:
            found.add("erratum-added", item, places[0], places[1], Impact.SAFE, Use(), name=id_, used=other.used)
        elif any(differ(a, b) for a, b in zip(_texts(one), _texts(other), strict=True)):
            found.add("erratum-changed", item, places[0], places[1], Impact.SAFE, Use(), name=id_, used=other.used)
        elif (one.where, one.manual) != (other.where, other.manual):
            about = [(listed(e.where), " (", Said("section"), " ", section(e.manual), ")") for e in (one, other)]
            facts: dict[str, Fact] = {"name": id_, "old": about[0], "new": about[1]}
            found.add("erratum-moved", item, places[0], places[1], Impact.SAFE, Use(), **facts)


def _texts(erratum: Erratum) -> tuple[Text, Text, Text]:
    return erratum.printed, erratum.used, erratum.why
