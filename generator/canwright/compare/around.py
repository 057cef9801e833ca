"""Changes around the commands: addresses, bus, parameters, settings, errata."""

from __future__ import annotations

from collections.abc import Sequence

from .. import words
from ..model import Address, Bus, Direction, Edition, IdRule, Mode, Parameter, Path
from .change import Impact, Item, Side
from .found import Found, Use, listed
from .match import by_name

_BOTH = Use((Side.SENDING, Side.RECEIVING))


def compare(found: Found, old: Edition, new: Edition) -> None:
    """All changes that belong to no command."""
    _addresses(found, old.addresses, new.addresses)
    _bus(found, old.bus, new.bus)
    _parameters(found, old.parameters, new.parameters)
    settings = by_name(old.settings, new.settings)
    for gone in settings.removed:
        found.add(
            "setting-removed",
            Item("setting", gone.name),
            ("settings", gone.name),
            ("settings",),
            Impact.SAFE,
            Use(),
            name=gone.name,
        )
    for fresh in settings.added:
        found.add(
            "setting-added",
            Item("setting", fresh.name),
            ("settings",),
            ("settings", fresh.name),
            Impact.SAFE,
            Use(),
            name=fresh.name,
        )
    _errata(found, old, new)
    edition = Item("edition", "")
    found.title(edition, (("title",), ("title",)), (old.family, new.family), old.title, new.title)
    found.text("text-changed", edition, (("about",), ("about",)), old.family, old.about, new.about)


def _addresses(found: Found, old: Sequence[Address], new: Sequence[Address]) -> None:
    matched = by_name(old, new).also(lambda a, b: (a.request, a.reply) == (b.request, b.reply))
    for one, other in matched.pairs:
        item = Item("address", one.name)
        if one.name != other.name:
            found.renamed("address-renamed", item, one.path, other.path, _BOTH, old=one.name, new=other.name)
        for direction, a, b, side in (
            (Direction.REQUEST, one.request, other.request, Side.SENDING),
            (Direction.REPLY, one.reply, other.reply, Side.RECEIVING),
        ):
            _rule(found, item, (one, other), direction, a, b, Use((side,)))
        places = ((*one.path, "title"), (*other.path, "title"))
        found.title(item, places, (one.name, other.name), one.title, other.title)
    for gone in matched.removed:
        facts = {"name": gone.name, "old": words.id_rule(gone.request)}
        item = Item("address", gone.name)
        found.add("address-removed", item, gone.path, ("addresses",), Impact.LOUD, _BOTH, **facts)
    for fresh in matched.added:
        facts = {"name": fresh.name, "new": words.id_rule(fresh.request)}
        item = Item("address", fresh.name)
        found.add("address-added", item, ("addresses",), fresh.path, Impact.SAFE, Use(), **facts)


def _rule(
    found: Found, item: Item, pair: tuple[Address, Address], direction: Direction, old: IdRule, new: IdRule, use: Use
) -> None:
    if (old.base, old.node_shift, old.extended, old.nodes is None) != (
        *(new.base, new.node_shift, new.extended),
        new.nodes is None,
    ):
        facts = {"direction": direction.value, "old": words.id_rule(old), "new": words.id_rule(new)}
        places = [(*a.path, direction.value) for a in pair]
        found.add("id-changed", item, places[0], places[1], Impact.LOUD, use, **facts)
    if old.nodes is not None and new.nodes is not None and old.nodes != new.nodes:
        beyond = set(new.nodes) - set(old.nodes) if Side.RECEIVING in use.sides else set(old.nodes) - set(new.nodes)
        impact = Impact.LOUD if beyond else Impact.SAFE
        facts = {"old": f"{old.nodes[0]}..{old.nodes[-1]}", "new": f"{new.nodes[0]}..{new.nodes[-1]}"}
        places = [(*a.path, "nodes") for a in pair]
        found.add("nodes-changed", item, places[0], places[1], impact, use, **facts)


def _bus(found: Found, old: Bus, new: Bus) -> None:
    item = Item("bus", "")
    matched = by_name(old.modes, new.modes)
    for one, other in matched.pairs:
        _mode(found, Item("mode", one.name), one, other)
    for gone in matched.removed:
        found.add(
            "mode-removed",
            Item("mode", gone.name),
            ("bus", "modes", gone.name),
            ("bus", "modes"),
            Impact.LOUD,
            _BOTH,
            name=gone.name,
        )
    for fresh in matched.added:
        found.add(
            "mode-added",
            Item("mode", fresh.name),
            ("bus", "modes"),
            ("bus", "modes", fresh.name),
            Impact.SAFE,
            Use(),
            name=fresh.name,
        )
    for rule, key, a, b in (
        ("reply-time-changed", "reply_within_ms", old.reply_within_ms, new.reply_within_ms),
        ("max-nodes-changed", "max_nodes", old.max_nodes, new.max_nodes),
    ):
        if a != b:
            facts = {"old": "none" if a is None else str(a), "new": "none" if b is None else str(b)}
            found.add(rule, item, ("bus", key), ("bus", key), Impact.SAFE, Use(), **facts)


def _mode(found: Found, item: Item, old: Mode, new: Mode) -> None:
    path = ("bus", "modes", old.name)
    if set(old.bit_rates_kbps) != set(new.bit_rates_kbps) or old.default_kbps != new.default_kbps:
        facts = {"old": _rates(old), "new": _rates(new)}
        gone = set(old.bit_rates_kbps) - set(new.bit_rates_kbps) or old.default_kbps != new.default_kbps
        place = (*path, "bit_rates_kbps")
        found.add("bit-rates-changed", item, place, place, Impact.LOUD if gone else Impact.SAFE, _BOTH, **facts)
    found.title(item, ((*path, "title"), (*path, "title")), (old.name, new.name), old.title, new.title)
    found.text("text-changed", item, ((*path, "about"), (*path, "about")), old.name, old.about, new.about)


def _rates(mode: Mode) -> str:
    rates = listed(sorted(mode.bit_rates_kbps, reverse=True))
    return rates if mode.default_kbps is None else f"{rates} (default {mode.default_kbps})"


def _parameters(found: Found, old: Sequence[Parameter], new: Sequence[Parameter]) -> None:
    matched = by_name(old, new)
    for gone in matched.removed:
        found.add(
            "parameter-removed",
            Item("parameter", gone.name),
            ("parameters", gone.name),
            ("parameters",),
            Impact.BUILD,
            _BOTH,
            name=gone.name,
        )
    for fresh in matched.added:
        found.add(
            "parameter-added",
            Item("parameter", fresh.name),
            ("parameters",),
            ("parameters", fresh.name),
            Impact.BUILD,
            _BOTH,
            name=fresh.name,
        )
    for one, other in matched.pairs:
        item, path = Item("parameter", one.name), ("parameters", one.name)
        at = (*path, "values")
        values = by_name(one.values, other.values)
        for value in values.removed:
            facts = {"name": one.name, "value": value.name}
            found.add("parameter-value-removed", item, (*at, value.name), at, Impact.BUILD, _BOTH, **facts)
        for value in values.added:
            facts = {"name": one.name, "value": value.name}
            found.add("parameter-value-added", item, at, (*at, value.name), Impact.SAFE, Use(), **facts)
        if (one.minimum, one.maximum) != (other.minimum, other.maximum):
            facts = {"name": one.name, "old": _bounds(one), "new": _bounds(other)}
            place = (*path, "number")
            found.add("parameter-bounds-changed", item, place, place, Impact.SILENT, _BOTH, **facts)
        found.title(item, ((*path, "title"), (*path, "title")), (one.name, other.name), one.title, other.title)
        found.text("text-changed", item, ((*path, "about"), (*path, "about")), one.name, one.about, other.about)


def _bounds(parameter: Parameter) -> str:
    ends = [words.exact(end) if end is not None else "" for end in (parameter.minimum, parameter.maximum)]
    return "..".join(ends)


def _errata(found: Found, old: Edition, new: Edition) -> None:
    before, after = ({e.id: (i, e) for i, e in enumerate(edition.errata)} for edition in (old, new))
    for id_ in dict.fromkeys((*before, *after)):
        item = Item("erratum", id_)
        (i, one), (j, other) = before.get(id_, (None, None)), after.get(id_, (None, None))
        places: list[Path] = [("errata",) if n is None else ("errata", n) for n in (i, j)]
        if other is None:
            found.add("erratum-removed", item, places[0], places[1], Impact.SAFE, Use(), name=id_)
        elif one is None:
            found.add("erratum-added", item, places[0], places[1], Impact.SAFE, Use(), name=id_, used=other.used)
        elif (one.printed, one.used, one.why) != (other.printed, other.used, other.why):
            found.add("erratum-changed", item, places[0], places[1], Impact.SAFE, Use(), name=id_, used=other.used)
