"""Every item that a spec defines is used.

An item is a type, layout, table, parameter, effect or setting, or an exemption from an effect.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..language.edition import EditionSpec, MessageSpec
from ..model.edition import Edition
from ..model.message import Message
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    spec, edition = subject.spec, subject.edition
    messages = list(edition.all_messages())
    fields = [f for m in messages for f in m.layout.fields]
    commands = edition.commands
    used: dict[str, set[str]] = {
        "types": {f.type.name for f in fields},
        "layouts": {m.layout.name for m in messages} | set(_extended(spec)),
        "tables": {c.table for c in spec.commands.values() if c.table},
        "effects": {e.name for c in commands for e in c.effects} | _of_entries(spec),
        "settings": {s.name for c in commands for s in (*c.limited_by, *c.not_limited_by)},
        "parameters": set(_parameters(edition, messages)),
    }
    written: dict[str, Iterable[str]] = {
        "types": spec.types,
        "layouts": spec.layouts,
        "tables": spec.tables,
        "effects": spec.effects,
        "settings": spec.settings,
        "parameters": spec.parameters,
    }
    for kind, names in written.items():
        for name in names:
            if name not in used[kind]:
                text = f"the {kind.removesuffix('s')} `{name}` is never used"
                yield Finding((kind, name), text, "use it or remove it", key=True)
    yield from _exemptions(edition)


def _exemptions(edition: Edition) -> Findings:
    """Values without an effect that no command with this value has."""
    had = {
        (f.type.name, e.name) for c in edition.commands if c.request for f in c.request.layout.fields for e in c.effects
    }
    for type_ in edition.types:
        for member in type_.enum:
            for i, effect in enumerate(member.without_effects):
                if (type_.name, effect) not in had:
                    path = (*type_.path, "enum", member.name, "without_effects", i)
                    yield Finding(path, f"no request with this value has the effect `{effect}`", "remove it")


def _of_entries(spec: EditionSpec) -> set[str]:
    return {name for table in spec.tables.values() for entry in table.entries.values() for name in entry.effects}


def _extended(spec: EditionSpec) -> Iterator[str]:
    """Layouts that messages extend with further fields; the layout of such a message has another name."""
    layouts = [entry.layout for table in spec.tables.values() for entry in table.entries.values()]
    messages = (message for command in spec.commands.values() for message in (command.request, command.reply))
    layouts += [message.layout for message in messages if isinstance(message, MessageSpec) and message.layout]
    yield from (layout for layout in layouts if isinstance(layout, str))


def _parameters(edition: Edition, messages: Iterable[Message]) -> Iterator[str]:
    for message in messages:
        yield from (*message.parameters, *message.layout.parameters)
        for field in message.layout.fields:
            yield from field.type.numbers
    for only in (*(c.only for c in edition.commands), *(s.only for s in edition.settings)):
        yield from only
