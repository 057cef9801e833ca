"""A list of names or codes has no duplicates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import EditionSpec, MemberSpec, MessageSpec
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    for path, values in _lists(subject.spec):
        first: dict[object, int] = {}
        for i, value in enumerate(values):
            if value in first:
                related = RelatedItem((*path, first[value]), "the first one")
                yield Finding((*path, i), f"duplicate value {value}", "remove one", related=(related,))
            first.setdefault(value, i)
    for name, command in subject.spec.commands.items():
        limited_by = {*command.limited_by}
        for i, setting in enumerate(command.not_limited_by):
            if setting in limited_by:
                at: DocumentPath = ("commands", name, "not_limited_by", i)
                earlier: DocumentPath = ("commands", name, "limited_by", command.limited_by.index(setting))
                text = f"`{setting}` is also in `limited_by`"
                yield Finding(at, text, "remove one of them", related=(RelatedItem(earlier, "the other one"),))
    for message in subject.edition.all_messages():
        for i, code in enumerate(message.accepted_codes):
            if message.keys and code == message.keys[0].value:
                text = f"0x{code:02X} is already the code of this message"
                yield Finding((*message.path, "accept", i), text, "remove it; `accept` is for additional codes")


def _lists(spec: EditionSpec) -> Iterator[tuple[DocumentPath, Sequence[object]]]:
    yield ("languages",), spec.languages
    for name, mode in spec.bus.modes.items():
        yield ("bus", "modes", name, "bit_rates_kbps"), mode.bit_rates_kbps
    for name, setting in spec.settings.items():
        yield from ((("settings", name, "only", p), v) for p, v in (setting.only or {}).items())
    for name, type_ in spec.types.items():
        for member_name, member in (type_.enum or {}).items():
            if isinstance(member, MemberSpec):
                yield ("types", name, "enum", member_name, "without_effects"), member.without_effects
    for name, command in spec.commands.items():
        path: DocumentPath = ("commands", name)
        yield (*path, "effects"), command.effects
        yield (*path, "limited_by"), command.limited_by
        yield (*path, "not_limited_by"), command.not_limited_by
        yield from (((*path, "only", p), v) for p, v in (command.only or {}).items())
        for key, message in (("request", command.request), ("reply", command.reply)):
            if isinstance(message, MessageSpec):
                yield (*path, key, "accept"), message.accept or ()
    for name, table in spec.tables.items():
        for entry_name, entry in table.entries.items():
            at: DocumentPath = ("tables", name, "entries", entry_name)
            yield (*at, "commands"), entry.commands or ()
            yield (*at, "effects"), entry.effects
            yield from (((*at, "only", p), v) for p, v in (entry.only or {}).items())
    for i, erratum in enumerate(spec.errata):
        yield ("errata", i, "where"), erratum.where
