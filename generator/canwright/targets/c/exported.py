"""The names that users of the headers write, for `canwright diff`, with `…_` for the prefix of family and edition."""

from __future__ import annotations

from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from .messages import Messages, addresses
from .names import Names, layouts, member
from .types import TypeView, types

Exported = tuple[DocumentPath, str]


def exported_names(edition: Edition) -> Iterator[Exported]:
    """Every name, with the path of its item; that of a declaration before those of its functions."""
    names = Names(edition)
    prefixes = names.lower(""), names.upper("")
    for path, name in _names(names, edition):
        yield path, f"…_{name[len(prefixes[0]) :]}" if name.startswith(prefixes) else name


def _names(names: Names, edition: Edition) -> Iterator[Exported]:
    yield from _parameters(names, edition)
    yield from ((("effects", effect.name), names.upper("effect", effect.name)) for effect in edition.effects)
    used = {address.name: address for address in edition.addresses}
    for view in addresses(names, edition, Messages(names, edition)):
        path = used[view.name].path
        yield from ((path, macro.name) for macro in view.nodes)
        for rule in view.rules:
            yield from (
                (path, n) for n in ((rule.id_function, rule.node_function) if rule.has_nodes else (rule.id_macro,))
            )
    views = {view.name: view for view in types(names, edition)}
    for type_ in (t for t in edition.types if t.path[0] == "types"):
        stem = names.type_stem(type_)
        key = "enum" if type_.enum else "flags"
        members = {names.upper(stem, m.name): (*type_.path, key, m.name) for m in (*type_.enum, *type_.flags)}
        if names.lower(stem) in views:
            yield from ((members.get(name, type_.path), name) for name in _type(views[names.lower(stem)]))
    for layout in layouts(edition):
        varying = [field for field in layout.fields if field.role.is_value]
        if varying:
            yield layout.path, names.lower(layout.name, "t")
        for field in varying:
            yield field.path, member(field.name)
            yield field.path, names.upper("field", field.name)
    for command in edition.commands:
        yield command.path, names.command(command.name)
        if command.code is not None:
            yield command.path, names.upper(command.name, "code")
    for message in edition.all_messages():
        if any(field.role.is_value for field in message.layout.fields):
            yield message.path, names.lower(message.name, "t")
            yield message.path, f".{member(names.short(message.command))}"
        yield from ((message.path, names.lower(message.name, ending)) for ending in ("encode", "decode"))


def _parameters(names: Names, edition: Edition) -> Iterator[Exported]:
    for parameter in edition.parameters:
        path: DocumentPath = ("parameters", parameter.name)
        yield path, f".{member(parameter.name)}"
        if parameter.is_choice:
            yield path, names.lower(parameter.name, "t")
            yield path, names.upper(parameter.name, "unknown")
        values = parameter.values
        yield from (((*path, "values", v.name), names.upper(parameter.name, v.name)) for v in values)


def _type(view: TypeView) -> Iterator[str]:
    """The functions of a type and its macros."""
    conversions = (("milli", view.milli), ("double", view.double), ("float", view.single))
    for number, conversion in conversions:
        yield from (f"{view.name}_{way}_{number}" for way in ("to", "from") if conversion is not None)
    functions = (("name", view.names), ("first_flag", view.is_flags), ("valid", view.valid))
    yield from (f"{view.name}_{ending}" for ending, exists in functions if exists)
    yield from (macro.name for macro in view.macros)
