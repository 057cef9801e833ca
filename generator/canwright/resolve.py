"""Schema to model: references, parameters, reply forms, bit positions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from . import schema
from .diagnostics import Diagnostic
from .model import (
    Address,
    Bus,
    Command,
    Edition,
    Effect,
    Entry,
    Erratum,
    IdRule,
    Mode,
    Path,
    Setting,
    Table,
)
from .notation import IdExpression
from .resolve_keys import keyed_by_constants, with_claims
from .resolve_layouts import LayoutResolver
from .resolve_messages import ENTRY, Form, MessageResolver
from .resolve_parameters import resolve_parameters
from .resolve_types import Context, read_units, resolve_types
from .source import Document

T = TypeVar("T")


def resolve(
    document: Document, spec: schema.EditionSpec, digest: str, dropped: frozenset[Path] = frozenset()
) -> tuple[Edition, list[Diagnostic]]:
    """The edition that a spec describes, and all findings; with any, the edition is only there to be checked further.

    `digest` is the hash of the document's text, `dropped` the parts of the document that `spec` lacks.
    """
    context = Context(document, tuple(spec.languages), [], dropped)
    return _edition(context, spec, digest), context.diagnostics


def _edition(context: Context, spec: schema.EditionSpec, digest: str) -> Edition:
    _, units = read_units()
    parameters = resolve_parameters(context, spec.parameters)
    types = resolve_types(context, spec, units, parameters)
    addresses = {name: _address(context, name, written) for name, written in spec.addresses.items()}
    settings = {
        name: Setting(
            name,
            {p: tuple(v) for p, v in (written.only or {}).items()},
            context.title(("settings", name), written.title, name),
            context.text(("settings", name, "about"), written.about),
        )
        for name, written in spec.settings.items()
    }
    effects = {
        name: Effect(
            name,
            written.level,
            context.title(("effects", name), written.title, name),
            context.text(("effects", name, "about"), written.about),
        )
        for name, written in spec.effects.items()
    }
    modes = {
        name: Mode(
            name,
            tuple(written.bit_rates_kbps),
            written.default_kbps,
            context.title(("bus", "modes", name), written.title, name),
            context.text(("bus", "modes", name, "about"), written.about),
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
        spec.family,
        spec.edition,
        spec.date or "",
        tuple(spec.languages),
        context.title((), spec.title, spec.family),
        context.text(("about",), spec.about),
        context.text(("manual",), spec.manual),
        digest,
        spec.byte_order,
        Bus(
            spec.bus.host,
            spec.bus.dlc,
            spec.bus.max_nodes,
            spec.bus.reply_within_ms,
            tuple(modes.values()),
            spec.bus.manual or "",
        ),
        tuple(parameters.values()),
        tuple(settings.values()),
        tuple(effects.values()),
        tuple(addresses.values()),
        tuple({**types, **layouts.bare_types}.values()),
        messages.layouts,
        tuple(_table(context, name, written) for name, written in spec.tables.items()),
        with_claims(keyed_by_constants(commands)),
        tuple(_erratum(context, i, written) for i, written in enumerate(spec.errata)),
    )


def _command(
    context: Context,
    written: schema.Command,
    form: Form,
    messages: MessageResolver,
    layouts: LayoutResolver,
    modes: Mapping[str, Mode],
    settings: Mapping[str, Setting],
    effects: Mapping[str, Effect],
    tables: Mapping[str, schema.Table],
) -> Command:
    path: Path = ("commands", form.command)
    request, reply = messages.of(form)
    title = context.title(path, written.title, form.command)
    only = layouts.only(path, written.only)
    does = _named(context, (*path, "effects"), "effect", written.effects, effects)
    of = None
    if form.entry is not None and written.table is not None:
        entry = tables[written.table].entries[form.entry]
        at: Path = ("tables", written.table, "entries", form.entry)
        of = Entry(
            written.table,
            form.entry,
            context.title(at, entry.title, form.entry),
            context.text((*at, "about"), entry.about),
            entry.manual or tables[written.table].manual or "",
            at,
        )
        title = {language: f"{text}: {of.title[language]}" for language, text in title.items()}
        asked = written.request.layout if isinstance(written.request, schema.MessageSpec) else written.request
        if asked == ENTRY:
            does += _named(context, (*at, "effects"), "effect", entry.effects, effects)
        only |= layouts.only(at, entry.only)
    return Command(
        form.name,
        form.command,
        of,
        messages.code_of(form),
        messages.address_of(form.command),
        _mode(context, path, written, modes),
        only,
        request,
        reply.message,
        reply.form,
        reply.of,
        reply.from_each,
        written.implemented,
        tuple(does),
        tuple(_named(context, (*path, "limited_by"), "setting", written.limited_by, settings)),
        tuple(_named(context, (*path, "not_limited_by"), "setting", written.not_limited_by, settings)),
        title,
        context.text((*path, "about"), written.about),
        tuple(context.text((*path, "notes", i), note) for i, note in enumerate(written.notes)),
        written.manual or "",
        path,
    )


def _table(context: Context, name: str, written: schema.Table) -> Table:
    path: Path = ("tables", name)
    title, about = context.title(path, written.title, name), context.text((*path, "about"), written.about)
    return Table(name, title, about, written.manual or "", path)


def _named(context: Context, path: Path, kind: str, names: Sequence[str], known: Mapping[str, T]) -> list[T]:
    found = [context.find((*path, i), kind, name, known) for i, name in enumerate(names)]
    return [item for item in found if item is not None]


def _mode(context: Context, path: Path, written: schema.Command, modes: Mapping[str, Mode]) -> str | None:
    if written.mode is not None:
        context.find((*path, "mode"), "mode", written.mode, modes)
        return written.mode
    return next(iter(modes), None)


def _address(context: Context, name: str, written: schema.Address) -> Address:
    path: Path = ("addresses", name)
    request, reply = written.request or written.id, written.reply or written.id
    if request is None or reply is None:
        lacking = "its id" if request is reply else "the id of requests" if request is None else "the id of replies"
        context.report(
            path, "missing-key", f"`{name}` says nothing of {lacking}", "write `id`, or `request` and `reply`"
        )
    elif written.id is not None and (written.request or written.reply):
        hint = "keep `id`, or `request` and `reply`"
        context.report(
            (*path, "id"), "address-id", "`id` is that of both directions, and one has its own", hint, key=True
        )
    elif written.nodes is not None and request.node_shift is None and reply.node_shift is None:
        hint = f"write the id with `node`, like 0x{request.base:X} + node, or leave `nodes` out"
        context.report((*path, "nodes"), "address-id", "there are nodes, but no id depends on `node`", hint, key=True)
    return Address(
        name,
        _id_rule(context, path, request or IdExpression(0, None), written),
        _id_rule(context, path, reply or IdExpression(0, None), written),
        context.title(path, written.title, name),
        context.text((*path, "about"), written.about),
        written.manual or "",
        path,
    )


def _id_rule(context: Context, path: Path, id_: IdExpression, written: schema.Address) -> IdRule:
    if id_.node_shift is not None and written.nodes is None:
        context.report(path, "missing-key", "the id depends on `node`, but `nodes` is missing", "nodes: 1..32")
    nodes = written.nodes if id_.node_shift is not None else None
    limit = 0x1FFFFFFF if written.extended else 0x7FF
    highest = id_.base + ((nodes[-1] << (id_.node_shift or 0)) if nodes else 0)
    if highest > limit:
        context.report(
            path, "id-space", f"the id reaches 0x{highest:X}, past 0x{limit:X}", "extended: true has 29 bits"
        )
    return IdRule(id_.base, id_.node_shift or 0, nodes, written.extended)


def _erratum(context: Context, index: int, written: schema.ErratumSpec) -> Erratum:
    path: Path = ("errata", index)
    for i, where in enumerate(written.where):
        if not context.document.holds(where):
            context.report((*path, "where", i), "unknown-reference", f"there is nothing at `{where}` in this file")
    return Erratum(
        written.id,
        tuple(written.where),
        written.manual,
        context.text((*path, "printed"), written.printed),
        context.text((*path, "used"), written.used),
        context.text((*path, "why"), written.why),
    )
