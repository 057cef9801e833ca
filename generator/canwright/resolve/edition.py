"""Decoded spec to edition."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

from ..diagnostics.diagnostic import DocumentPath, SpecError
from ..document.document import Document
from ..language import edition as schema
from ..language.notation import LAST_ID, last_id
from ..model.edition import Edition
from ..model.message import Address, Command, Direction, Entry, IdRule, Table
from ..model.metadata import Bus, Effect, Erratum, Mode, Setting, State
from ..model.types import ImpliedTitle
from .discriminators import keyed_by_constants, with_claims, with_confusions
from .layouts import LayoutResolver
from .messages import CommandForm, MessageResolver
from .parameters import resolve_parameters, with_limits_of_ids
from .report import Limited, Report
from .titles import titled
from .types import deprecation, resolve_types


def resolve(document: Document, spec: schema.EditionSpec) -> Edition:
    """The edition of a spec. Raises SpecError with all findings."""
    report = Report(document, spec.languages)
    edition = _edition(report, spec)
    if report.number:
        raise SpecError(report.findings)
    return edition


def _edition(report: Report, spec: schema.EditionSpec) -> Edition:
    parameters = resolve_parameters(spec.parameters, spec.languages)
    types = resolve_types(report, spec, parameters)
    addresses = {name: _address(report, name, written) for name, written in spec.addresses.items()}
    settings = {
        name: Setting(
            name=name,
            only={p: tuple(v) for p, v in (written.only or {}).items()},
            title=titled(written.title, name),
            about=written.about,
        )
        for name, written in spec.settings.items()
    }
    effects = {
        name: Effect(
            name=name,
            level=written.level,
            consent=written.consent,
            repeat=written.repeat,
            kept=written.kept,
            title=titled(written.title, name),
            about=written.about,
        )
        for name, written in spec.effects.items()
    }
    modes = {
        name: Mode(
            name=name,
            bit_rates_kbps=tuple(written.bit_rates_kbps),
            default_kbps=written.default_kbps,
            title=titled(written.title, name),
            about=written.about,
        )
        for name, written in spec.bus.modes.items()
    }
    layouts = LayoutResolver(report, spec, parameters, types)
    messages = MessageResolver(report, spec, layouts, addresses)
    commands = [
        _command(report, written, form, messages, layouts, modes, settings, effects, spec.tables)
        for name, written in spec.commands.items()
        for form in messages.forms(name)
    ]
    resolved = with_confusions(with_claims(keyed_by_constants(commands)))
    return Edition(
        family=spec.family,
        name=spec.edition,
        date=spec.date or "",
        languages=tuple(spec.languages),
        title=titled(spec.title, spec.family),
        about=spec.about,
        manual=spec.manual,
        order=spec.byte_order,
        bus=Bus(
            host=spec.bus.host,
            dlc=spec.bus.dlc,
            frame_format=spec.bus.frame_format,
            max_nodes=spec.bus.max_nodes,
            reply_within_ms=spec.bus.reply_within_ms,
            answers_in_order=spec.bus.answers is not None,
            modes=tuple(modes.values()),
            manual=spec.bus.manual or "",
        ),
        parameters=with_limits_of_ids(report, spec, parameters, addresses.values(), resolved),
        settings=tuple(settings.values()),
        effects=tuple(effects.values()),
        states=tuple(
            State(
                name=name,
                is_initial=name == next(iter(spec.states)),
                entered_by=tuple(written.entered_by),
                prevents=tuple(effects[effect] for effect in written.prevents),
                title=titled(written.title, name),
                about=written.about,
            )
            for name, written in spec.states.items()
        ),
        addresses=tuple(addresses.values()),
        types=tuple({**types, **layouts.bare_types}.values()),
        layouts=messages.layouts,
        tables=tuple(
            Table(
                name=name,
                title=titled(written.title, name),
                about=written.about,
                manual=written.manual or "",
                path=("tables", name),
            )
            for name, written in spec.tables.items()
        ),
        commands=resolved,
        errata=tuple(
            Erratum(
                id=erratum.id,
                where=tuple(erratum.where),
                manual=erratum.manual,
                printed=erratum.printed,
                used=erratum.used,
                why=erratum.why,
            )
            for erratum in spec.errata
        ),
    )


def _command(
    report: Report,
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
    report.count(Limited.COMMANDS, 1, path)
    request, replies = messages.of(form)
    title = titled(written.title, form.command)
    only = layouts.only(path, written.only)
    command_effects = [effects[name] for name in written.effects]
    of = None
    if form.entry is not None and written.table is not None:
        entry = tables[written.table].entries[form.entry]
        at: DocumentPath = ("tables", written.table, "entries", form.entry)
        of = Entry(
            table=written.table,
            name=form.entry,
            renamed_from=entry.renamed_from,
            kind=entry.kind,
            title=titled(entry.title, form.entry),
            about=entry.about,
            manual=entry.manual or tables[written.table].manual or "",
            path=at,
        )
        whole = {language: f"{text}: {of.title[language]}" for language, text in title.items()}
        title = ImpliedTitle(whole) if isinstance(title, ImpliedTitle) else whole
        layout = written.request.layout if isinstance(written.request, schema.MessageSpec) else written.request
        if layout == schema.ENTRY:
            command_effects += [effects[name] for name in entry.effects]
        only |= layouts.only(at, entry.only)
    if request is not None and only:
        request = dataclasses.replace(request, only=only)
    return Command(
        name=form.name,
        short_spec_name=written.short_name or form.command,
        spec_name=form.command,
        previous_name=written.renamed_from,
        deprecated=deprecation(written.deprecated),
        entry=of,
        code=messages.code_of(form),
        address=messages.address_of(form.command),
        mode=written.mode or next(iter(modes), None),
        only=only,
        request=request,
        replies=replies,
        reply_within_ms=written.reply_within_ms,
        implemented=written.implemented,
        effects=tuple(command_effects),
        repeat=written.repeat,
        ends_motion=written.ends_motion,
        limited_by=tuple(settings[name] for name in written.limited_by),
        not_limited_by=tuple(settings[name] for name in written.not_limited_by),
        title=title,
        about=written.about,
        notes=tuple(written.notes),
        manual=written.manual or "",
        manual_name=written.manual_name or "",
        path=path,
    )


def _address(report: Report, name: str, written: schema.AddressSpec) -> Address:
    path: DocumentPath = ("addresses", name)
    request, reply = (_id_rule(report, path, written, direction) for direction in Direction)
    return Address(
        name=name,
        request=request,
        reply=reply,
        title=titled(written.title, name),
        about=written.about,
        manual=written.manual or "",
        path=path,
    )


def _id_rule(report: Report, address: DocumentPath, written: schema.AddressSpec, direction: Direction) -> IdRule:
    expression = written.id_of(direction)
    nodes = written.nodes if expression.node_step is not None else None
    limit = last_id(written.extended)
    rule = IdRule(
        base=expression.base,
        node_step=expression.node_step or 1,
        nodes=nodes,
        extended=written.extended,
        parameter=expression.parameter,
        parameter_step=expression.parameter_step,
    )
    highest = rule.highest
    if highest > limit:
        longer = "" if written.extended or highest > LAST_ID else ", or write `extended: true` for a 29-bit id"
        hint = f"check {'`id` and `nodes`' if nodes else 'the id'}{longer}"
        path = (*address, "id" if written.id is not None else direction.value)
        report.finding(path, "id-space", f"the id 0x{highest:X} exceeds the maximum of 0x{limit:X}", hint)
    return rule
