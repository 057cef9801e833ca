"""Data for a site of the pages: its editions and commands, and what a search finds on which page."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ...language.units import read_units
from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field
from ...model.message import Command, Direction, IdRule
from ...model.metadata import Mode
from ...model.types import Encoding, Parameter, Type
from ...templating import resources
from ...templating.data_files import read_data
from ...templating.markup import script_text
from ..availability import is_available
from .links import COMMANDS, command_page, field_anchor
from .questions import question_records
from .tables import codes, index

FILE = "site.json"

Record = dict[str, Any]
"""An item that a search finds: `kind`, `name`, `pages` in the folder of the edition, with or without a section, and what
is known of its code, title, description, units, name in the manual (`printed`) and further `words`. Texts are by language and not
escaped."""


def site_data(listed: Sequence[tuple[str, Edition]], labels: Mapping[Edition, str]) -> str:
    """The file, as JSON with a line for each record; `listed` are editions with their folders, in the order of menus."""
    asked = ",\n".join(map(_json, question_records(edition for _, edition in listed)))
    lines = ",\n".join(_edition(folder, edition, labels[edition]) for folder, edition in listed)
    stops = [word for group in read_data(resources.TEMPLATES / "docs" / "stop_words.yaml") for word in group]
    return f'{{"synonyms": {_json(_synonyms())},\n"stops": {_json(stops)},\n"questions": [\n{asked}\n],\n"editions": [\n{lines}\n]}}\n'


def _edition(folder: str, edition: Edition, label: str) -> str:
    about = {
        "folder": folder,
        "family": edition.family,
        "name": label,
        "date": edition.date,
        "languages": list(edition.languages),
    }
    records = ",\n".join(_json({name: v for name, v in record.items() if v}) for record in _records(edition))
    return f'{_json(about)[:-1]}, "records": [\n{records}\n]}}'


def _json(value: object) -> str:
    return script_text(json.dumps(value, ensure_ascii=False))


def _synonyms() -> list[list[str]]:
    """Groups of words with one meaning, in any language: those of the field, of protocols and of units for one quantity.

    Symbols of one letter are left out, because they occur in names with another meaning, as `A` in "phase A".
    """
    files = (resources.TEMPLATES / "docs" / "synonyms.yaml", resources.SYNONYMS)
    of_quantity: dict[str, list[str]] = {}
    for unit in read_units()[1].values():
        names = dict.fromkeys((unit.symbol, unit.name, *unit.title.values()))
        of_quantity.setdefault(unit.quantity, []).extend(name for name in names if len(name) > 1)
    return [group for file in files for group in read_data(file)] + [
        group for group in of_quantity.values() if len(group) > 1
    ]


def _records(edition: Edition) -> Iterator[Record]:
    yield from _commands(edition)
    yield from _ids(edition)
    yield from _fields(edition)
    yield from _types(edition)
    for erratum in edition.errata:
        about = {lang: f"{erratum.used[lang]} {erratum.why[lang]}" for lang in edition.languages}
        pages = [f"errata#errata.{erratum.id}"]
        yield {"kind": "erratum", "name": erratum.id, "title": dict(erratum.printed), "about": about, "pages": pages}
    for effect in edition.effects:
        pages = [page_of(command) for command in edition.commands if effect in command.effects]
        yield {"kind": "effect", "name": effect.name, "title": dict(effect.title), "pages": list(dict.fromkeys(pages))}
    for kind, page, items in (
        ("parameter", "parameters", edition.parameters),
        ("setting", "index", edition.settings),
        ("mode", "bus", edition.bus.modes),
        ("neighbour", "bus", edition.bus.neighbours),
        ("state", "states", edition.states),
        ("table", "index", edition.tables),
    ):
        for item in items:
            pages = [f"{page}#{'bus.' if page == 'bus' else ''}{kind}s.{item.name}"]
            yield {
                "kind": kind,
                "name": item.name,
                "title": dict(item.title),
                "about": dict(item.about),
                "words": _rates(item)
                if isinstance(item, Mode)
                else _choices(item)
                if isinstance(item, Parameter)
                else [],
                "pages": pages,
            }


def _rates(mode: Mode) -> list[str]:
    """The bit rates of a mode as people write them: 500k, 500 kbps, 1M."""
    return [
        text
        for rate in mode.bit_rates_kbps
        for number, prefix in ((rate, "k"), (rate // 1000, "M") if rate % 1000 == 0 else (0, ""))
        if number
        for text in (f"{number} {prefix}", f"{number} {prefix}bps", f"{number} {prefix}bit/s")
    ]


def _choices(parameter: Parameter) -> list[str]:
    """The values of a parameter, by name and title."""
    return [text for value in parameter.values for text in (value.name, *value.title.values())]


def page_of(command: Command) -> str:
    """The place of a command in the folder of its edition: a page without suffix, or a section of it."""
    return COMMANDS + command_page(command).replace(".md", "", 1)


def _commands(edition: Edition) -> Iterator[Record]:
    """The commands, each followed by its entries if it has a table."""
    for name, forms in edition.groups.items():
        first = forms[0]
        yield {
            "kind": "command",
            "name": name,
            "printed": first.manual_name,
            "code": ", ".join(dict.fromkeys(code for form in forms for code in codes(form))),
            "title": dict(first.spec_title),
            "about": dict(first.about),
            "notes": [dict(note) for note in first.notes],
            "pages": [page_of(first).partition("#")[0]],
        }
        for form in forms:
            if form.entry:
                key = index(form.request or form.reply)
                yield {
                    "kind": "entry",
                    "name": form.name,
                    "code": key,
                    "title": dict(form.title),
                    "pages": [page_of(form)],
                }


def _ids(edition: Edition) -> Iterator[Record]:
    """The rules between nodes and ids: a search computes the node of an id."""
    by_rule: dict[IdRule, Record] = {}
    for address in edition.addresses:
        for direction in Direction:
            rule = address.rule(direction)
            if rule.parameter is not None:
                continue  # the node of an id depends on the device
            nodes = rule.nodes if rule.nodes is not None else range(1)
            numbers = {"base": rule.base, "step": rule.node_step, "first": nodes.start, "last": nodes.stop - 1}
            count = [f"{nodes.start} {nodes.stop - 1}"] if rule.nodes is not None else []
            item = {
                "kind": "id",
                "name": formatting.id_rule(rule),
                "title": dict(address.title),
                "ids": numbers,
                "words": count,
            }
            by_rule.setdefault(rule, {**item, "directions": [], "pages": ["bus"]})["directions"].append(direction.value)
    yield from by_rule.values()


def _fields(edition: Edition) -> Iterator[Record]:
    """Fields that differ in name, title or unit, with their rows in the pages of all commands that have them; requests first."""
    by_key: dict[tuple[object, ...], tuple[Field, dict[str, str]]] = {}
    shown = [(command, message) for command in edition.commands for message in command.messages]
    for command, message in sorted(shown, key=lambda pair: pair[1].direction is Direction.REPLY):
        for field in message.layout.fields:
            if not is_available(message.layout, field, command):
                continue
            unit = field.type.unit
            key = (field.name, field.manual_name, *field.title.items(), unit.name if unit else "")
            row = f"{COMMANDS}{command.spec_name}#{field_anchor(command, message.direction, field)}"
            by_key.setdefault(key, (field, {}))[1].setdefault(page_of(command), row)
    for field, rows in by_key.values():
        yield {
            "kind": "field",
            "name": field.name,
            "printed": field.manual_name,
            "title": dict(field.title),
            **_quantity(field.type),
            "pages": list(rows.values()),
        }


def _quantity(type_: Type) -> Record:
    """The unit of a type in each spelling, its resolution, and its limits."""
    unit = type_.unit
    return {
        "units": [unit.symbol, unit.name, *unit.title.values()] if unit else [],
        "words": [text for _, text in formatting.scale(type_) if unit]
        + list(dict.fromkeys(_limits(type_)))
        + _raw(type_),
    }


def _raw(type_: Type) -> list[str]:
    """The type of the raw integer, as C and this project write it: `int16_t`, `int16`, `i16`."""
    if type_.encoding is Encoding.FLOAT:
        return [f"f{type_.width}", f"float{type_.width}"]
    letter, sign = ("i", "") if type_.encoding is Encoding.SIGNED else ("u", "u")
    spelled = [f"{sign}int{type_.width}_t", f"{sign}int{type_.width}", f"{letter}{type_.width}", f"{type_.width} bit"]
    return [*spelled, "signed" if sign == "" else "unsigned"]


def _limits(type_: Type) -> Iterator[str]:
    """The ends of the ranges of a number as raw integers, and in its unit if they do not depend on the device."""
    for names, limits in type_.raw_range.distinct():
        if limits is None:
            continue
        yield f"{formatting.bound(limits.low)} {formatting.bound(limits.high)}"
        if not type_.unit or not limits.is_constant:
            continue
        for cases, linear in type_.linear.distinct():
            if linear is not None and linear.times is None and (not names or not cases or {*names} & {*cases}):
                values = formatting.in_unit(limits, linear)
                yield from (f"{formatting.bound(end)} {type_.unit.symbol}" for end in (values.low, values.high))


def _types(edition: Edition) -> Iterator[Record]:
    """Types with names and their values; values of other types are on the pages of the commands that have them."""
    of_type: dict[Type, list[str]] = {}
    printed: dict[Type, set[str]] = {}
    for command in edition.commands:
        for field in (field for message in command.messages for field in message.layout.fields):
            of_type.setdefault(field.type, []).append(page_of(command))
            printed.setdefault(field.type, set()).add(field.manual_name)
    for type_ in dict.fromkeys((*edition.types, *of_type)):
        is_named = type_.path[0] == "types"
        pages = [f"types#types.{type_.name}"] if is_named else list(dict.fromkeys(of_type.get(type_, ())))
        if is_named:
            titles = {"title": dict(type_.title), "about": dict(type_.about)}
            yield {"kind": "type", "name": type_.name, **titles, **_quantity(type_), "pages": pages}
        for key, members in type_.members_by_key.items():
            for member in members:
                titles = {"title": dict(member.title), "about": dict(member.about)}
                notes = [dict(type_.title), *({"": name} for name in sorted(printed.get(type_, ())) if name)]
                is_flag = key == "flags"
                raw = [f"bit {member.value}"] if is_flag else []
                raw.append(f"0x{1 << member.value if is_flag else member.value:02X}")
                yield {"kind": "value", "name": member.name, "words": raw, **titles, "notes": notes, "pages": pages}
