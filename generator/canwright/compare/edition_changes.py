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
from ..model.metadata import Bus, Consent, Effect, Erratum, Mode, Repeat, Setting, State
from ..model.types import Parameter, Text
from .change import Impact, Item, Keyword, SentenceArgument, Side
from .collector import (
    BOTH_SIDES,
    Attribute,
    Collector,
    Subject,
    Titled,
    differing,
    given,
    listed,
    paths,
    scope,
    section,
)
from .match import Matched, by_name

T = TypeVar("T", bound=Titled)


def _fewer_rates(old: Mode, new: Mode) -> Impact:
    gone = set(old.bit_rates_kbps) - set(new.bit_rates_kbps)
    return Impact.LOUD if gone or new.default_kbps not in (None, old.default_kbps) else Impact.SAFE


def _other_format(old: Bus, new: Bus) -> Impact:
    """A program of CAN FD understands frames without bit rate switch, but may not know the data bit rate."""
    is_usual = old.frame_format.is_fd and new.frame_format.is_fd and not new.frame_format.switches_rate
    return Impact.SAFE if is_usual else Impact.LOUD


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
_FRAME_FORMAT = Attribute[Bus](
    "frame-format-changed", "frame_format", lambda b: Keyword(b.frame_format.value), impact=_other_format
)
_OF_BUS = (
    Attribute[Bus]("reply-time-changed", "reply_within_ms", lambda b: given(b.reply_within_ms)),
    Attribute[Bus]("max-nodes-changed", "max_nodes", lambda b: given(b.max_nodes)),
)
_ANSWERS = Attribute[Bus](
    "answers-changed",
    "answers",
    lambda b: Keyword("in the order of the requests" if b.answers_in_order else "in an unknown order"),
    impact=lambda _, new: Impact.SAFE if new.answers_in_order else Impact.SILENT,
)
_OF_MODE = (Attribute[Mode]("bit-rates-changed", "bit_rates_kbps", _rates, impact=_fewer_rates),)


def _more_consent(_: Effect, new: Effect) -> Impact:
    return Impact.SAFE if new.consent is Consent.NONE else Impact.SILENT


_OF_EFFECT = (Attribute[Effect]("effect-level-changed", "level", lambda e: Keyword(e.level.value)),)
_OF_SENDING_WITH_EFFECT = (
    Attribute[Effect]("consent-changed", "consent", lambda e: Keyword(e.consent.value), impact=_more_consent),
    Attribute[Effect](
        "effect-repeat-changed",
        "repeat",
        lambda e: Keyword(e.repeat.value),
        impact=lambda _, new: Impact.SILENT if new.repeat is Repeat.NEVER else Impact.SAFE,
    ),
    Attribute[Effect](
        "kept-changed",
        "kept",
        lambda e: Keyword(e.kept.value if e.kept else "unknown"),
        impact=lambda _, new: Impact.SILENT if new.kept else Impact.SAFE,
    ),
)
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
    for earlier, later in effects.pairs:
        path = ("effects", earlier.name)
        sending = Subject(collector, Item("effect", earlier.name), (path, path), (Side.SENDING,))
        sending.attributes(_OF_SENDING_WITH_EFFECT, earlier, later, name=earlier.name)
    _states(collector, old, new)
    _errata(collector, old, new)
    edition = Subject(collector, Item("edition", ""), ((), ()))
    edition.title(new.family, old.title, new.title)
    edition.text("text-changed", "about", old.family, old.about, new.about)
    edition.text("title-changed", "manual", "manual", old.manual, new.manual)
    edition.attributes(_OF_EDITION, old, new)


def _items(
    collector: Collector,
    kind: str,
    path: DocumentPath,
    matched: Matched[T],
    rows: Sequence[Attribute[T]] = (),
    sides: tuple[Side, ...] = (),
    removed: tuple[tuple[Side, ...], Impact | None] = ((), None),
    added: tuple[Side, ...] = (),
) -> None:
    """Changes of the attributes and texts of items of one kind; items that are removed and added."""

    def subject(item: T, sides: tuple[Side, ...]) -> Subject:
        return Subject(collector, Item(kind, item.name), ((*path, item.name),) * 2, sides)

    for old, new in matched.pairs:
        same = subject(old, sides)
        same.attributes(rows, old, new, name=old.name)
        same.texts(old, new)
    for gone in matched.removed:
        subject(gone, removed[0]).within((*path, gone.name), path).add(f"{kind}-removed", removed[1], name=gone.name)
    for fresh in matched.added:
        subject(fresh, added).within(path, (*path, fresh.name)).add(f"{kind}-added", name=fresh.name)


def _addresses(collector: Collector, old: Sequence[Address], new: Sequence[Address]) -> None:
    matched = by_name(old, new).also(lambda a, b: (a.request, a.reply) == (b.request, b.reply))
    for before, after in matched.pairs:
        address = Subject(collector, Item("address", before.name), paths(before, after), BOTH_SIDES)
        address.renamed("address-renamed", before.name, after.name)
        extended = [(a.request.extended, a.reply.extended) for a in (before, after)]
        if extended[0] != extended[1]:
            facts = {"direction": Keyword("request and reply"), "old": _ids(before), "new": _ids(after)}
            address.at("extended").add("id-changed", **facts)
        if before.request == before.reply and after.request == after.reply:
            _rule(address, "id", tuple(Direction), before.request, after.request)
        else:
            _rule(address, "request", (Direction.REQUEST,), before.request, after.request)
            _rule(address, "reply", (Direction.REPLY,), before.reply, after.reply)
        address.section(before.manual, after.manual)
        address.texts(before, after)
    for gone in matched.removed:
        address = Subject(collector, Item("address", gone.name), (gone.path, ("addresses",)), BOTH_SIDES)
        address.add("address-removed", name=gone.name, old=formatting.id_rule(gone.request))
    for fresh in matched.added:
        address = Subject(collector, Item("address", fresh.name), (("addresses",), fresh.path))
        address.add("address-added", name=fresh.name, new=formatting.id_rule(fresh.request))


def _rule(address: Subject, key: str, directions: tuple[Direction, ...], old: IdRule, new: IdRule) -> None:
    """Adds changes of the ids and of the nodes of an address in some directions."""
    address = address.used(*map(Side.of, directions))
    before, after = (replace(r, nodes=r.nodes and range(1), extended=False) for r in (old, new))
    if before != after:
        direction = Keyword(" and ".join(d.value for d in directions))
        address.at(key).add("id-changed", direction=direction, old=_id(old), new=_id(new))
    if old.nodes is not None and new.nodes is not None and old.nodes != new.nodes:
        facts = {"old": f"{old.nodes[0]}..{old.nodes[-1]}", "new": f"{new.nodes[0]}..{new.nodes[-1]}"}
        address.at("nodes").add("nodes-changed", **facts)


def _ids(address: Address) -> SentenceArgument:
    request, reply = _id(address.request), _id(address.reply)
    return request if request == reply else (request, ", ", reply)


def _id(rule: IdRule) -> SentenceArgument:
    return (formatting.id_rule(rule), *((" (", Keyword("29 bits"), ")") if rule.extended else ()))


def _bus(collector: Collector, old: Bus, new: Bus) -> None:
    bus = Subject(collector, Item("bus", ""), (("bus",), ("bus",)))
    bus.used(*BOTH_SIDES).at("host").renamed("host-renamed", old.host, new.host)
    bus.section(old.manual, new.manual)
    modes = by_name(old.modes, new.modes)
    _items(collector, "mode", ("bus", "modes"), modes, _OF_MODE, BOTH_SIDES, (BOTH_SIDES, Impact.LOUD))
    bus.used(*BOTH_SIDES).attributes([_FRAME_FORMAT], old, new)
    bus.attributes(_OF_BUS, old, new)
    bus.used(Side.SENDING).attributes([_ANSWERS], old, new)


def _parameters(collector: Collector, old: Sequence[Parameter], new: Sequence[Parameter]) -> None:
    matched = by_name(old, new)
    for before, after in matched.pairs:
        path = ("parameters", before.name, "values")
        parameter = Subject(collector, Item("parameter", before.name), (path, path))
        values = by_name(before.values, after.values)
        for value, now in values.pairs:
            parameter.at(value.name).texts(value, now)
        for value in values.removed:
            gone = parameter.used(*BOTH_SIDES).within((*path, value.name), path)
            gone.add("parameter-value-removed", name=before.name, value=value.name)
        for value in values.added:
            fresh = parameter.within(path, (*path, value.name))
            fresh.add("parameter-value-added", name=before.name, value=value.name)
    _items(collector, "parameter", ("parameters",), matched, _OF_PARAMETER, BOTH_SIDES, (BOTH_SIDES, None), BOTH_SIDES)


def _states(collector: Collector, old: Edition, new: Edition) -> None:
    now = {c.previous_name: c.spec_name for c in new.commands if c.previous_name}
    before = [
        replace(state, entered_by=tuple(now.get(name, name) for name in state.entered_by)) for state in old.states
    ]
    _items(collector, "state", ("states",), by_name(before, new.states), _OF_STATE, (Side.SENDING,))


def _errata(collector: Collector, old: Edition, new: Edition) -> None:
    before, after = ({e.id: (i, e) for i, e in enumerate(edition.errata)} for edition in (old, new))
    for id_ in dict.fromkeys((*before, *after)):
        (i, was), (j, now) = before.get(id_, (None, None)), after.get(id_, (None, None))
        erratum = Subject(collector, Item("erratum", id_), (_erratum(i), _erratum(j)))
        if now is None:
            erratum.add("erratum-removed", name=id_)
        elif was is None:
            erratum.add("erratum-added", name=id_, used=now.used)
        elif any(differing(a, b) for a, b in zip(_texts(was), _texts(now), strict=True)):
            erratum.add("erratum-changed", name=id_, used=now.used)
        elif (was.where, was.manual) != (now.where, now.manual):
            erratum.add("erratum-moved", name=id_, old=_about(was), new=_about(now))


def _erratum(number: int | None) -> DocumentPath:
    return ("errata",) if number is None else ("errata", number)


def _about(erratum: Erratum) -> SentenceArgument:
    return (listed(erratum.where), " (", Keyword("section"), " ", section(erratum.manual), ")")


def _texts(erratum: Erratum) -> tuple[Text, Text, Text]:
    return erratum.printed, erratum.used, erratum.why
