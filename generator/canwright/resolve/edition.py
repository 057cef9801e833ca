"""Decoded spec to edition."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, TypeVar

from ..diagnostics.diagnostic import Diagnostic, DocumentPath
from ..document.document import Document
from ..language import edition as schema, suggestions
from ..language.notation import LAST_ID, SHORT_ID, IdExpression
from ..model.edition import Edition
from ..model.message import Address, Command, Direction, Entry, IdRule, Table
from ..model.metadata import Bus, Effect, Erratum, Mode, Setting, State
from ..model.types import ImpliedTitle
from .affected import Affected
from .command_forms import CommandForm
from .context import Context
from .discriminators import keyed_by_constants, with_claims
from .layouts import LayoutResolver
from .limits import check_limits
from .messages import ENTRY, MessageResolver
from .parameters import resolve_parameters
from .types import deprecation, read_units, resolve_types

T = TypeVar("T")


class Unresolved(NamedTuple):
    """The findings of resolvers, and the paths of invalid values that are not texts."""

    findings: list[Diagnostic]
    paths: list[DocumentPath]
    references: list[DocumentPath]
    """The paths of unknown names."""


def resolve(
    document: Document, spec: schema.EditionSpec, digest: str, invalid: Iterable[DocumentPath] = ()
) -> tuple[Edition, Unresolved]:
    """The edition of a spec, and all findings; with findings, the edition is only for further checks.

    `digest` is the hash of the text, `invalid` are the paths of values that the decoder omitted. Raises SpecError for
    more commands or fields than are resolved.
    """
    check_limits(document, spec)
    context = Context(document, tuple(spec.languages), [], Affected(document.data, invalid))
    return _edition(context, spec, digest), Unresolved(context.findings, [*context.invalid], context.unknown)


def _edition(context: Context, spec: schema.EditionSpec, digest: str) -> Edition:
    _, units = read_units()
    parameters = resolve_parameters(context, spec.parameters)
    types = resolve_types(context, spec, units, parameters)
    addresses = {name: _address(context, i, name, written) for i, (name, written) in enumerate(spec.addresses.items())}
    settings = {
        name: Setting(
            name=name,
            only={p: tuple(v) for p, v in (written.only or {}).items()},
            title=context.title(("settings", name), written.title, name),
            about=context.text(("settings", name, "about"), written.about),
        )
        for name, written in spec.settings.items()
    }
    effects = {
        name: Effect(
            name=name,
            level=written.level,
            title=context.title(("effects", name), written.title, name),
            about=context.text(("effects", name, "about"), written.about),
        )
        for name, written in spec.effects.items()
    }
    modes = {
        name: Mode(
            name=name,
            bit_rates_kbps=tuple(written.bit_rates_kbps),
            default_kbps=written.default_kbps,
            title=context.title(("bus", "modes", name), written.title, name),
            about=context.text(("bus", "modes", name, "about"), written.about),
        )
        for name, written in spec.bus.modes.items()
    }
    layouts = LayoutResolver(context, spec.byte_order, parameters, types)
    messages = MessageResolver(context, spec, layouts, addresses)
    commands = [
        _command(context, written, form, messages, layouts, modes, settings, effects, spec.tables)
        for name, written in spec.commands.items()
        for form in messages.forms(name)
    ]
    return Edition(
        family=spec.family,
        name=spec.edition,
        date=spec.date or "",
        languages=tuple(spec.languages),
        title=context.title((), spec.title, spec.family),
        about=context.text(("about",), spec.about),
        manual=context.text(("manual",), spec.manual),
        hash=digest,
        order=spec.byte_order,
        bus=Bus(
            host=spec.bus.host,
            dlc=spec.bus.dlc,
            max_nodes=spec.bus.max_nodes,
            reply_within_ms=spec.bus.reply_within_ms,
            modes=tuple(modes.values()),
            manual=spec.bus.manual or "",
        ),
        parameters=tuple(parameters.values()),
        settings=tuple(settings.values()),
        effects=tuple(effects.values()),
        states=tuple(_state(context, spec, name, effects) for name in spec.states),
        addresses=tuple(addresses.values()),
        types=tuple({**types, **layouts.bare_types}.values()),
        layouts=messages.layouts,
        tables=tuple(_table(context, name, written) for name, written in spec.tables.items()),
        commands=with_claims(keyed_by_constants(commands)),
        errata=tuple(_erratum(context, i, written) for i, written in enumerate(spec.errata)),
    )


def _command(
    context: Context,
    written: schema.CommandSpec,
    form: CommandForm,
    messages: MessageResolver,
    layouts: LayoutResolver,
    modes: Mapping[str, Mode],
    settings: Mapping[str, Setting],
    effects: Mapping[str, Effect],
    tables: Mapping[str, schema.TableSpec],
) -> Command:
    path: DocumentPath = ("commands", form.command)
    request, replies = messages.of(form)
    title = context.title(path, written.title, form.command)
    only = layouts.only(path, written.only)
    command_effects = _named(context, (*path, "effects"), "effect", written.effects, effects)
    of = None
    if form.entry is not None and written.table is not None:
        entry = tables[written.table].entries[form.entry]
        at: DocumentPath = ("tables", written.table, "entries", form.entry)
        of = Entry(
            table=written.table,
            name=form.entry,
            renamed_from=entry.renamed_from,
            kind=entry.kind,
            title=context.title(at, entry.title, form.entry),
            about=context.text((*at, "about"), entry.about),
            manual=entry.manual or tables[written.table].manual or "",
            path=at,
        )
        whole = {language: f"{text}: {of.title[language]}" for language, text in title.items()}
        title = ImpliedTitle(whole) if isinstance(title, ImpliedTitle) else whole
        layout = written.request.layout if isinstance(written.request, schema.MessageSpec) else written.request
        if layout == ENTRY:
            command_effects += _named(context, (*at, "effects"), "effect", entry.effects, effects)
        only |= layouts.only(at, entry.only)
    return Command(
        name=form.name,
        short_spec_name=written.short_name or form.command,
        spec_name=form.command,
        previous_name=written.renamed_from,
        deprecated=deprecation(written.deprecated),
        entry=of,
        code=messages.code_of(form),
        address=messages.address_of(form.command),
        mode=_mode(context, path, written, modes),
        only=only,
        request=request,
        replies=replies,
        reply_within_ms=written.reply_within_ms,
        implemented=written.implemented,
        effects=tuple(command_effects),
        limited_by=tuple(_named(context, (*path, "limited_by"), "setting", written.limited_by, settings)),
        not_limited_by=tuple(_named(context, (*path, "not_limited_by"), "setting", written.not_limited_by, settings)),
        title=title,
        about=context.text((*path, "about"), written.about),
        notes=tuple(context.text((*path, "notes", i), note) for i, note in enumerate(written.notes)),
        manual=written.manual or "",
        path=path,
    )


def _state(context: Context, spec: schema.EditionSpec, name: str, effects: Mapping[str, Effect]) -> State:
    path: DocumentPath = ("states", name)
    written = spec.states[name]
    _named(context, (*path, "entered_by"), "command", written.entered_by, spec.commands)
    return State(
        name=name,
        is_initial=name == next(iter(spec.states)),
        entered_by=tuple(command for command in written.entered_by if command in spec.commands),
        prevents=tuple(_named(context, (*path, "prevents"), "effect", written.prevents, effects)),
        title=context.title(path, written.title, name),
        about=context.text((*path, "about"), written.about),
    )


def _table(context: Context, name: str, written: schema.TableSpec) -> Table:
    path: DocumentPath = ("tables", name)
    title, about = context.title(path, written.title, name), context.text((*path, "about"), written.about)
    return Table(name=name, title=title, about=about, manual=written.manual or "", path=path)


def _named(context: Context, path: DocumentPath, kind: str, names: Sequence[str], known: Mapping[str, T]) -> list[T]:
    items = (context.find((*path, i), kind, name, known) for i, name in enumerate(names))
    return [item for item in items if item is not None]


def _mode(context: Context, path: DocumentPath, written: schema.CommandSpec, modes: Mapping[str, Mode]) -> str | None:
    if written.mode is not None:
        context.find((*path, "mode"), "mode", written.mode, modes)
        return written.mode
    return next(iter(modes), None)


def _address(context: Context, number: int, name: str, written: schema.AddressSpec) -> Address:
    path: DocumentPath = ("addresses", name)
    unresolved = IdRule(base=LAST_ID + 1 + number, node_step=1, nodes=None, extended=True)
    """A unique id in place of an invalid one."""
    request, reply = written.request or written.id, written.reply or written.id
    if request is None or reply is None:
        missing = "id" if request is reply else "id of requests" if request is None else "id of replies"
        text = f"`{name}` has no {missing}"
        context.report(path, "missing-key", text, "write `id`, or `request` and `reply`", key=True)
    elif written.id is not None and (written.request or written.reply):
        hint = "keep `id`, or `request` and `reply`"
        context.report(
            (*path, "id"), "address-id", "`id` is for both directions, but one has its own id", hint, key=True
        )
    elif written.nodes is not None and request.node_step is None and reply.node_step is None:
        hint = f"write the id with `node`, for example 0x{request.base:X} + node, or omit `nodes`"
        context.report(
            (*path, "nodes"), "address-id", "no id depends on `node`, so `nodes` has no effect", hint, key=True
        )
    request_rule = _id_rule(context, _id_path(path, written, Direction.REQUEST), request, written, unresolved)
    reply_rule = _id_rule(context, _id_path(path, written, Direction.REPLY), reply, written, unresolved)
    if max(_highest(request_rule), _highest(reply_rule)) > SHORT_ID:
        request_rule, reply_rule = (dataclasses.replace(rule, extended=True) for rule in (request_rule, reply_rule))
    return Address(
        name=name,
        request=request_rule,
        reply=reply_rule,
        title=context.title(path, written.title, name),
        about=context.text((*path, "about"), written.about),
        manual=written.manual or "",
        path=path,
    )


def _id_path(address: DocumentPath, written: schema.AddressSpec, direction: Direction) -> DocumentPath:
    """The path of the id of one direction."""
    return (*address, "id" if getattr(written, direction.value) is None else direction.value)


def _id_rule(
    context: Context, path: DocumentPath, id_: IdExpression | None, written: schema.AddressSpec, unresolved: IdRule
) -> IdRule:
    if id_ is None:
        return unresolved
    if id_.node_step is not None and written.nodes is None:
        text = "the id depends on `node`, but `nodes` is missing"
        context.report(path[:-1], "missing-key", text, "write, for example, nodes: 1..32", key=True)
        return unresolved
    nodes = written.nodes if id_.node_step is not None else None
    limit = LAST_ID if written.extended else SHORT_ID
    rule = IdRule(base=id_.base, node_step=id_.node_step or 1, nodes=nodes, extended=written.extended)
    highest = _highest(rule)
    if highest > limit:
        longer = "" if written.extended or highest > LAST_ID else ", or write `extended: true` for a 29-bit id"
        hint = f"check {'`id` and `nodes`' if nodes else 'the id'}{longer}"
        context.report(path, "id-space", f"the id 0x{highest:X} exceeds the maximum of 0x{limit:X}", hint)
    return rule if highest <= LAST_ID else unresolved


def _highest(rule: IdRule) -> int:
    return rule.base + (rule.nodes[-1] * rule.node_step if rule.nodes else 0)


def _erratum(context: Context, index: int, written: schema.ErratumSpec) -> Erratum:
    path: DocumentPath = ("errata", index)
    for i, where in enumerate(written.where):
        if not context.document.contains(where) and not context.affected.may_hide(where):
            text = f"`{where}` is not a path of this file"
            context.report(
                (*path, "where", i), "unknown-reference", text, suggestions.place(where, context.document.data)
            )
    return Erratum(
        id=written.id,
        where=tuple(written.where),
        manual=written.manual,
        printed=context.text((*path, "printed"), written.printed),
        used=context.text((*path, "used"), written.used),
        why=context.text((*path, "why"), written.why),
    )
