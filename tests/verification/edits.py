"""Edits of a spec as people make them when a protocol changes, each with the names that it changes."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..conformance.mutants import mutants
from .behaviour import Names

Data = dict[Any, Any]
Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Edit:
    """A change of a spec's data. `nothing` means that the new spec says the same in other words."""

    name: str
    change: Callable[[Data], None]
    names: Names = field(default_factory=Names)
    nothing: bool = False


def edits(data: Data) -> Iterator[Edit]:
    """All edits of a spec; some of them make it invalid."""
    for name, change in mutants(data):
        yield Edit(name, change)
    yield from _codes(data)
    yield from _commands(data)
    yield from _replies(data)
    yield from _tables(data)
    yield from _addresses(data)
    yield from _types(data)
    yield from _fields(data)
    yield from _layouts(data)
    yield from _parameters(data)
    yield from _split(data)
    yield from _other_constants(data)
    yield from _exchanged_names(data)
    yield from _removed_keys(data)
    yield from _arrays(data)
    yield from _shared_replies(data)
    yield from _same(data)


def at(data: Data, path: Path) -> Any:
    """The part of a spec at a path."""
    part: Any = data
    for step in path:
        part = part[step]
    return part


def _dotted(path: Path) -> str:
    return ".".join(map(str, path))


def put(path: Path, value: Any) -> Callable[[Data], None]:
    """Sets a key."""

    def change(data: Data) -> None:
        at(data, path[:-1])[path[-1]] = copy.deepcopy(value)

    return change


def drop(path: Path) -> Callable[[Data], None]:
    """Removes a key."""

    def change(data: Data) -> None:
        del at(data, path[:-1])[path[-1]]

    return change


def swap(first: Path, second: Path) -> Callable[[Data], None]:
    """Exchanges two values."""

    def change(data: Data) -> None:
        a, b = at(data, first[:-1]), at(data, second[:-1])
        a[first[-1]], b[second[-1]] = b[second[-1]], a[first[-1]]

    return change


def both(*changes: Callable[[Data], None]) -> Callable[[Data], None]:
    """Several changes at once."""

    def change(data: Data) -> None:
        for step in changes:
            step(data)

    return change


def rename(path: Path, new: str) -> Callable[[Data], None]:
    """Renames a key; its place among the others stays."""

    def change(data: Data) -> None:
        mapping = at(data, path[:-1])
        items = [(new if key == path[-1] else key, value) for key, value in mapping.items()]
        mapping.clear()
        mapping.update(items)

    return change


def _references(part: Any, key: str, old: str, new: str) -> None:
    """Replaces a name wherever the value of a key refers to it."""
    if isinstance(part, dict):
        for name, value in part.items():
            if name == key and value == old:
                part[name] = new
            elif name == key and isinstance(value, list):
                part[name] = [new if item == old else item for item in value]
            else:
                _references(value, key, old, new)
    elif isinstance(part, list):
        for item in part:
            _references(item, key, old, new)


def rename_command(old: str, new: str) -> Callable[[Data], None]:
    """Renames a command and the references to it."""

    def change(data: Data) -> None:
        rename(("commands", old), new)(data)
        _references(data["commands"], "of", old, new)
        for table in data.get("tables", {}).values():
            _references(table["entries"], "commands", old, new)

    return change


def forms(data: Data, command: str) -> list[str]:
    """The names of a command, one for each entry of its table."""
    table = data["commands"][command].get("table")
    if table is None:
        return [command]
    entries = data["tables"][table]["entries"].items()
    return [f"{command}_{name}" for name, entry in entries if command in entry.get("commands", [command])]


def _renamed_forms(data: Data, old: str, new: str | None) -> dict[str, str | None]:
    return {form: new and new + form.removeprefix(old) for form in forms(data, old)}


def _free(data: Data) -> int:
    used = repr(data)
    return next(n for n in range(0x66, 0x100) if f": {n}," not in used and f": {n}}}" not in used)


def _pairs(items: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    yield from itertools.pairwise(items)
    if len(items) > 2:
        yield items[0], items[-1]


def _titled(text: str) -> dict[str, str]:
    return {"en": text, "zh": text}


def _title(data: Data, text: str) -> Any:
    return _titled(text) if data.get("languages", ["en"]) != ["en"] else text


def _codes(data: Data) -> Iterator[Edit]:
    """Codes that are exchanged, reused or moved."""
    coded = [name for name, c in data["commands"].items() if isinstance(c.get("code"), int)]
    for first, second in _pairs(coded):
        path = ("commands", first, "code"), ("commands", second, "code")
        yield Edit(f"codes of {first} and {second} swapped", swap(*path))
    for a, b, c in zip(coded, coded[1:], coded[2:], strict=False):
        codes = [data["commands"][n]["code"] for n in (b, c, a)]
        yield Edit(
            f"codes of {a}, {b}, {c} rotated",
            both(*(put(("commands", n, "code"), code) for n, code in zip((a, b, c), codes, strict=True))),
        )
    kinds = [name for name, c in data["commands"].items() if isinstance(c.get("code"), dict)]
    for name in kinds:
        for first, second in itertools.pairwise(data["commands"][name]["code"]):
            yield Edit(
                f"codes {first} and {second} of {name} swapped",
                swap(("commands", name, "code", first), ("commands", name, "code", second)),
            )
    for first, second in _pairs(list(data["commands"])):
        if "code" not in data["commands"][first] and "code" not in data["commands"][second]:
            a, b = data["commands"][first].get("address"), data["commands"][second].get("address")
            if a and b and a != b:
                yield Edit(
                    f"addresses of {first} and {second} swapped",
                    swap(("commands", first, "address"), ("commands", second, "address")),
                )


def _commands(data: Data) -> Iterator[Edit]:
    """Commands that are removed, added, renamed, or replaced by others with the same code."""
    free = _free(data)
    for name, command in data["commands"].items():
        path = ("commands", name)
        yield Edit(f"{name} removed", drop(path), Names(commands=_renamed_forms(data, name, None)))
        yield Edit(
            f"{name} renamed",
            rename_command(name, f"{name}_2"),
            Names(commands=_renamed_forms(data, name, f"{name}_2")),
        )
        reused = both(
            put((*path, "title"), _title(data, "Calibrate the scale")), rename_command(name, "calibrate_scale")
        )
        yield Edit(f"{name} reused with another title", reused, Names(commands=_renamed_forms(data, name, None)))
        if isinstance(command.get("code"), int):
            added = {k: v for k, v in command.items() if k in ("address", "request", "reply", "manual", "table")}
            yield Edit(
                f"{name} reused, and moved to another code",
                both(
                    put((*path, "code"), free),
                    put(("commands", "fresh"), {**added, "code": command["code"], "title": _title(data, "Fresh one")}),
                ),
            )
            yield Edit(
                f"fresh command beside {name}", put(("commands", "fresh"), {**copy.deepcopy(command), "code": free})
            )
            yield Edit(
                f"{name} removed, a fresh command with its code",
                both(
                    drop(path),
                    put(
                        ("commands", "fresh"),
                        {
                            **{k: v for k, v in command.items() if k in ("address", "code", "manual")},
                            "title": _title(data, "Fresh one"),
                            "reply": "none",
                        },
                    ),
                ),
                Names(commands=_renamed_forms(data, name, None)),
            )
        if command.get("request") == "none":
            yield Edit(f"{name} must be requested", drop((*path, "request")))
            yield Edit(
                f"{name} must be requested with data", put((*path, "request"), {"which": {"at": 1, "raw": "u8"}})
            )
        elif command.get("reply") not in ("echo", "none"):
            yield Edit(f"{name} is sent by itself", put((*path, "request"), "none"))
        if "implemented" not in command:
            yield Edit(f"{name} not implemented", put((*path, "implemented"), False))
        choices = {n: list(p["values"]) for n, p in data.get("parameters", {}).items() if "values" in p}
        for parameter, values in list(choices.items())[:1]:
            if "only" not in command:
                yield Edit(f"{name} only for some", put((*path, "only"), {parameter: values[:1]}))
            else:
                yield Edit(f"{name} for all", drop((*path, "only")))
                mine = command["only"].get(parameter, [])
                for value in (v for v in values if v not in mine):
                    yield Edit(f"{name} for {value}, too", put((*path, "only", parameter), [*mine, value]))
    for first, second in _pairs(list(data["commands"])):
        yield Edit(f"names of {first} and {second} swapped", _swap_names(first, second))


def _swap_names(first: str, second: str) -> Callable[[Data], None]:
    return both(
        rename_command(first, "swapped_name"), rename_command(second, first), rename_command("swapped_name", second)
    )


def _replies(data: Data) -> Iterator[Edit]:
    """Forms, codes and layouts of replies."""
    free = _free(data)
    names = list(data["commands"])
    for name, command in data["commands"].items():
        path = ("commands", name, "reply")
        reply = command.get("reply")
        forms_: tuple[Any, ...] = ("none", "echo", {})
        for form in forms_:
            if reply != form and command.get("request") != "none":
                yield Edit(f"{name} replies {form or 'without fields'}", put(path, form))
        for layout in list(data.get("layouts", {}))[:3]:
            if reply != layout:
                yield Edit(f"{name} replies with the layout {layout}", put(path, layout))
        for source in names[:1] + names[-1:]:
            target = data["commands"][source].get("reply")
            if (
                source != name
                and command.get("request") != "none"
                and isinstance(target, (dict, str))
                and target not in ("none", "echo")
            ) and not (isinstance(target, dict) and "of" in target):
                yield Edit(f"{name} replies as {source}", put(path, {"of": source}))
        yield from _own_reply(data, name, free)
    for first, second in itertools.pairwise(names):
        a, b = data["commands"][first].get("reply"), data["commands"][second].get("reply")
        if a != b and a is not None and b is not None:
            yield Edit(
                f"replies of {first} and {second} swapped",
                swap(("commands", first, "reply"), ("commands", second, "reply")),
            )


def _own_reply(data: Data, name: str, free: int) -> Iterator[Edit]:
    """Codes and fields of the reply of one command."""
    command = data["commands"][name]
    path, reply, names = ("commands", name, "reply"), command.get("reply"), list(data["commands"])
    if isinstance(reply, dict):
        long = {"layout", "fields", "of", "from_each", "code", "accept", "address", "dlc", "remote"} & set(reply)
        if not long and reply:
            yield Edit(f"{name} replies with another code", put(path, {"layout": reply, "code": free}))
        if "accept" in reply:
            yield Edit(f"{name} accepts one more", put((*path, "accept"), [*reply["accept"], free]))
            yield Edit(f"{name} accepts nothing else", drop((*path, "accept")))
            for another in names:
                code = data["commands"][another].get("code")
                if isinstance(code, int) and code not in reply["accept"]:
                    yield Edit(
                        f"{name} accepts the code of {another}", put((*path, "accept"), [*reply["accept"], code])
                    )
                    break
        elif "layout" in reply and isinstance(command.get("code"), int) and "of" not in reply:
            yield Edit(f"{name} accepts {free}", put((*path, "accept"), [free]))
        if "code" in reply:
            yield Edit(f"{name} replies with the usual code", drop((*path, "code")))
        if "of" in reply:
            yield Edit(f"{name} has a reply of its own", put(path, {"own": {"at": 1, "raw": "u8"}}))
    elif reply == "echo":
        yield Edit(f"{name} replies with a number", put(path, {"own": {"at": 1, "raw": "u8"}}))


def _unnamed(layout: Any) -> Any:
    """The fields of a layout without their names: other names alone are no other meaning."""
    return list(layout.values()) if isinstance(layout, dict) else None


def _tables(data: Data) -> Iterator[Edit]:
    """Entries of tables."""
    for table, definition in data.get("tables", {}).items():
        path = ("tables", table, "entries")
        users = [n for n, c in data["commands"].items() if c.get("table") == table]
        for a, b in _pairs(list(definition["entries"])):
            yield Edit(f"{table}: indexes of {a} and {b} swapped", swap((*path, a, "index"), (*path, b, "index")))
            if _unnamed(definition["entries"][a]["layout"]) != _unnamed(definition["entries"][b]["layout"]):
                yield Edit(f"{table}: layouts of {a} and {b} swapped", swap((*path, a, "layout"), (*path, b, "layout")))
        for entry in definition["entries"]:

            def named(new: str | None, entry: str = entry, users: Sequence[str] = users) -> Names:
                return Names(commands={f"{u}_{entry}": new and f"{u}_{new}" for u in users})

            yield Edit(f"{table}: {entry} removed", drop((*path, entry)), named(None))
            yield Edit(f"{table}: {entry} renamed", rename((*path, entry), f"{entry}_2"), named(f"{entry}_2"))
            yield Edit(
                f"{table}: {entry} reused with another title",
                both(
                    put((*path, entry, "title"), _title(data, "Light of the lamp")),
                    rename((*path, entry), "brightness"),
                ),
                named(None),
            )
            if len(users) > 1 and "commands" not in definition["entries"][entry]:
                yield Edit(f"{table}: {entry} only with {users[0]}", put((*path, entry, "commands"), users[:1]))
        if len(users) > 1:
            codes = [("commands", u, "code") for u in users[:2]]
            if all("code" in data["commands"][u] for u in users[:2]):
                yield Edit(f"{table}: codes of {users[0]} and {users[1]} swapped", swap(*codes))
        index = definition["index"]
        for i, part in enumerate(index if isinstance(index, list) else [index]):
            key: Path = ("tables", table, "index", i) if isinstance(index, list) else ("tables", table, "index")
            width = int(str(part["raw"])[1:])
            if width > 8:
                yield Edit(f"{table}: index big-endian", put((*key, "byte_order"), "big"))
            yield Edit(f"{table}: index moved", put((*key, "at"), int(str(part["at"]).split(".")[0]) + 1))


def _addresses(data: Data) -> Iterator[Edit]:
    """Ids that are exchanged, added, given to others."""
    addresses = data["addresses"]
    yield from _exchanged_ids(addresses)
    for name, command in data["commands"].items():
        for address in addresses:
            if command.get("address", next(iter(addresses))) != address:
                yield Edit(f"{name} uses the address {address}", put(("commands", name, "address"), address))


def _exchanged_ids(addresses: Data) -> Iterator[Edit]:
    """Ids and nodes of addresses."""
    for first, second in itertools.combinations(addresses, 2):
        for key in ("id", "request", "reply"):
            if key in addresses[first] and key in addresses[second]:
                yield Edit(
                    f"{key} of addresses {first} and {second} swapped",
                    swap(("addresses", first, key), ("addresses", second, key)),
                )
    for name, address in addresses.items():
        path = ("addresses", name)
        if "request" in address and "reply" in address:
            yield Edit(f"request and reply ids of {name} swapped", swap((*path, "request"), (*path, "reply")))
        for key in ("id", "request", "reply"):
            if "node" in str(address.get(key, "")):
                for step in (1, 8, 0x20):
                    yield Edit(f"{key} of {name} + {step}", put((*path, key), f"{address[key]} + {step}"))
        if "nodes" in address:
            low, high = map(int, address["nodes"].split(".."))
            yield Edit(f"nodes of {name} halved", put((*path, "nodes"), f"{low}..{(low + high) // 2}"))
        renamed = both(rename(path, f"{name}_2"), lambda d, n=name: _references(d, "address", n, f"{n}_2"))  # type: ignore[misc]
        yield Edit(f"address {name} renamed", renamed)


def _uses(data: Data, type_: str) -> int:
    return repr(data).count(f"'type': '{type_}'")


def _member(member: Any, key: str) -> int:
    value: int = member[key] if isinstance(member, dict) else member
    return value


def _types(data: Data) -> Iterator[Edit]:
    """Units, scales, members."""
    units = ["V", "A", "deg", "s", "Hz"]
    for name, type_ in data.get("types", {}).items():
        path = ("types", name)
        if "enum" not in type_ and "flags" not in type_:
            unit = next(u for u in units if u != type_.get("unit"))
            yield Edit(f"unit of {name} is {unit}", put((*path, "unit"), unit))
            if "unit" in type_:
                yield Edit(f"unit of {name} removed", drop((*path, "unit")))
            scale = type_.get("scale", 1)
            if isinstance(scale, (int, float)):
                yield Edit(f"scale of {name} times 10", put((*path, "scale"), scale * 10))
                yield Edit(f"sign of {name} turned", put((*path, "scale"), -scale))
            yield from _cases(name, type_)
            if "offset" not in type_ and not isinstance(scale, dict):
                yield Edit(f"offset of {name} is 40", put((*path, "offset"), 40))
            if str(type_["raw"])[0] != "f" and type_["raw"][1:] in ("32", "64"):
                yield Edit(f"{name} is a float", put((*path, "raw"), f"f{type_['raw'][1:]}"))
        yield from _members(data, name, type_)
        renamed = both(rename(path, f"{name}_2"), lambda d, n=name: _references(d, "type", n, f"{n}_2"))  # type: ignore[misc]
        yield Edit(f"type {name} renamed", renamed)


def _cases(name: str, type_: Data) -> Iterator[Edit]:
    """Scales and ranges that depend on a parameter."""
    path: Path = ("types", name)
    scale = type_.get("scale")
    if isinstance(scale, dict):
        cases = [c for c in scale if c != "by"]
        for a, b in _pairs(cases):
            if scale[a] != scale[b]:
                yield Edit(f"scales {a} and {b} of {name} swapped", swap((*path, "scale", a), (*path, "scale", b)))
        for case in cases:
            new = "none" if scale[case] != "none" else "1/10"
            yield Edit(f"scale {case} of {name} is {new}", put((*path, "scale", case), new))
    if isinstance(type_.get("raw_range"), dict):
        cases = [c for c in type_["raw_range"] if c != "by"]
        for a, b in _pairs(cases):
            yield Edit(f"ranges {a} and {b} of {name} swapped", swap((*path, "raw_range", a), (*path, "raw_range", b)))


def _members(data: Data, name: str, type_: Data) -> Iterator[Edit]:
    for kind, key in (("enum", "value"), ("flags", "bit")):
        members = type_.get(kind)
        if not members:
            continue
        path = ("types", name, kind)
        values = [_member(entry, key) for entry in members.values()]
        high = int(type_["raw"][1:]) - (type_["raw"][0] == "i")
        top = (1 << high) if kind == "enum" else int(type_["raw"][1:])
        free = next((n for n in range(1, top) if n not in values), None)
        text = {"title": _title(data, "Park the load")}
        if free is not None:
            yield Edit(f"{kind} {name}: parking added", put((*path, "parking"), {key: free, **text}))
        for a, b in _pairs(list(members)):
            if all(isinstance(members[m], int) == isinstance(members[a], int) for m in (a, b)):
                steps = () if isinstance(members[a], int) else (key,)
                yield Edit(f"{kind} {name}: {a} and {b} swapped", swap((*path, a, *steps), (*path, b, *steps)))
        for member, entry in members.items():
            yield Edit(f"{kind} {name}: {member} removed", drop((*path, member)))
            yield Edit(
                f"{kind} {name}: {member} renamed",
                rename((*path, member), f"{member}_2"),
                Names(members={member: f"{member}_2"}),
            )
            yield Edit(
                f"{kind} {name}: {member} reused with another title",
                both(put((*path, member), {key: _member(entry, key), **text}), rename((*path, member), "parking")),
                Names(members={member: None}),
            )
            if free is not None:
                yield Edit(
                    f"{kind} {name}: {member} moved, its value reused",
                    both(
                        put((*path, member), free if isinstance(entry, int) else {**entry, key: free}),
                        put((*path, "parking"), {key: _member(entry, key), **text}),
                    ),
                )


def _all_fields(data: Data) -> Iterator[tuple[Path, Data, list[str]]]:
    """Every group of fields with its path, and the commands that have them."""
    for name, layout in data.get("layouts", {}).items():
        yield ("layouts", name, "fields"), layout["fields"], []
    for name, table in data.get("tables", {}).items():
        for entry, definition in table["entries"].items():
            if isinstance(definition["layout"], dict):
                yield ("tables", name, "entries", entry, "layout"), definition["layout"], []
    for name, command in data["commands"].items():
        for half in ("request", "reply"):
            part = command.get(half)
            if not isinstance(part, dict):
                continue
            long = {"layout", "fields", "of", "from_each", "code", "accept", "address", "dlc", "remote"} & set(part)
            if not long:
                yield ("commands", name, half), part, [name]
            for key in ("layout", "fields"):
                if isinstance(part.get(key), dict):
                    yield ("commands", name, half, key), part[key], [name]


def _fields(data: Data) -> Iterator[Edit]:
    """Fields that are renamed, replaced, exchanged, added."""
    unique = repr(data)
    for path, fields, _ in _all_fields(data):
        for name, definition in fields.items():
            here = (*path, name)
            only_here = unique.count(f"'{name}': {{'at'") == 1
            fixed = {"constant", "reserved"} & set(definition)
            if only_here:
                new = f"{name}_2"
                yield Edit(f"{_dotted(here)} renamed", rename(here, new), Names(fields={name: new}))
                kept = {k: v for k, v in definition.items() if k in ("at", "array", "only", *fixed)}
                if not fixed:
                    raw = definition["raw"] if "raw" in definition else data["types"][definition["type"]]["raw"]
                    if "holds" not in definition:
                        yield Edit(
                            f"{_dotted(here)} reused with another title",
                            both(
                                put(here, {**definition, "title": _title(data, "Wind direction")}), rename(here, "wind")
                            ),
                            Names(fields={name: None}),
                        )
                        yield Edit(
                            f"{_dotted(here)} replaced by another field",
                            both(
                                put(here, {**kept, "raw": raw, "title": _title(data, "Wind direction")}),
                                rename(here, "wind"),
                            ),
                            Names(fields={name: None}),
                        )
            yield from _field(data, here, definition)
        for a, b in _pairs(list(fields)):
            if fields[a]["at"] == fields[b]["at"]:
                continue
            yield Edit(f"{_dotted(path)}: names of {a} and {b} swapped", _swap_keys(path, a, b))
        for position in range(8):
            yield Edit(
                f"{_dotted(path)}: field at {position} added",
                put((*path, "fresh_field"), {"at": position, "raw": "u8"}),
            )


def _field(data: Data, here: Path, definition: Data) -> Iterator[Edit]:
    """One field that becomes constant or reserved, exists under other parameters, or has another type."""
    name, fixed = here[-1], {"constant", "reserved"} & set(definition)
    if "constant" in definition:
        yield Edit(f"{_dotted(here)} becomes a value", drop((*here, "constant")))
        yield Edit(f"{_dotted(here)} constant renamed", rename(here, f"{name}_2"))
    elif not fixed and "holds" not in definition and "array" not in definition:
        plain = {**definition, "constant": 1}
        if "type" not in definition:
            yield Edit(f"{_dotted(here)} becomes a constant", put(here, plain))
        yield Edit(
            f"{_dotted(here)} becomes reserved",
            put(
                here,
                {
                    "at": definition["at"],
                    "raw": definition["raw"] if "raw" in definition else data["types"][definition["type"]]["raw"],
                    "reserved": 0,
                },
            ),
        )
    if "only" in definition:
        parameter, values = next(iter(definition["only"].items()))
        every = list(data["parameters"][parameter]["values"])
        for value in (v for v in every if v not in values):
            yield Edit(f"{_dotted(here)} for {value}, too", put((*here, "only"), {parameter: [*values, value]}))
        if len(values) > 1:
            yield Edit(f"{_dotted(here)} only for {values[0]}", put((*here, "only"), {parameter: values[:1]}))
    if "type" in definition:
        raw = data["types"][definition["type"]]["raw"]
        for other_name, other_type in data["types"].items():
            if other_type["raw"] == raw and other_name != definition["type"]:
                yield Edit(f"{_dotted(here)} has the type {other_name}", put((*here, "type"), other_name))
                break


def _raw_of(data: Data, field: Data) -> str:
    """The raw format of a field, its own or that of its type."""
    return str(field["raw"] if "raw" in field else data["types"][field["type"]]["raw"])


def _is_big(data: Data, field: Data) -> bool:
    type_ = data["types"][field["type"]] if "type" in field else field
    return bool(type_.get("byte_order", data.get("byte_order", "little")) == "big")


def _split(data: Data) -> Iterator[Edit]:
    """Fields that become narrower, with and without other fields in the bits that become free."""
    for path, fields, _ in _all_fields(data):
        for name, definition in fields.items():
            raw = _raw_of(data, definition)
            width = int(raw[1:]) if raw[1:].isdigit() else 0  # a text or decimal digits
            if (
                raw[0] == "f"
                or not width
                or width % 8
                or isinstance(definition["at"], str)
                or {"holds", "array"} & set(definition)
            ):
                continue
            here, byte = (*path, name), definition["at"]
            texts = {k: v for k, v in definition.items() if k in ("title", "only", "constant", "reserved")}
            order = {"byte_order": "big"} if _is_big(data, definition) else {}
            for low in (width - 8, 8) if width > 16 else (width // 2,):
                high = width - low
                starts = (byte + high // 8, byte) if order else (byte, byte + low // 8)
                if low % 8 or high % 8:
                    starts = (byte, f"{byte}.{low}")
                kept = {**texts, "at": starts[0], "raw": f"{raw[0]}{low}", **(order if low > 8 else {})}
                rest: Data = {"at": starts[1], "raw": f"u{high}", **(order if high > 8 else {})}
                rest |= {k: v for k, v in texts.items() if k == "only"}
                yield Edit(f"{_dotted(here)} narrowed to {low} bits", put(here, kept))
                fresh = put((*path, "faults_2"), rest)
                yield Edit(f"{_dotted(here)} narrowed to {low} bits, a field beside it", both(put(here, kept), fresh))
                constant = put((*path, "faults_2"), {**rest, "constant": 5})
                yield Edit(
                    f"{_dotted(here)} narrowed to {low} bits, a constant beside it", both(put(here, kept), constant)
                )
            if not order or width == 8:
                kept = {**texts, "at": byte, "raw": f"{raw[0]}{width - 1}"}
                bit: Data = {"at": f"{byte + width // 8 - 1}.7", "raw": "u1"}
                bit |= {k: v for k, v in texts.items() if k == "only"}
                yield Edit(
                    f"{_dotted(here)} gives its top bit to a field",
                    both(put(here, kept), put((*path, "is_valid"), bit)),
                )


def _other_constants(data: Data) -> Iterator[Edit]:
    """Fields that become constants, and constants that become fields, with and without a unit or a scale."""
    units: dict[str, Data] = {"plain": {}, "unit": {"unit": "V"}, "scale": {"scale": 0.5}, "offset": {"offset": 3}}
    for path, fields, _ in _all_fields(data):
        for name, definition in fields.items():
            raw = _raw_of(data, definition)
            if raw[0] == "f" or not raw[1:].isdigit() or {"holds", "array", "reserved"} & set(definition):
                continue
            here = (*path, name)
            order = {"byte_order": "big"} if _is_big(data, definition) and int(raw[1:]) > 8 else {}
            own = {
                "at": definition["at"],
                "raw": raw,
                **order,
                **{k: v for k, v in definition.items() if k in ("title", "only")},
            }
            if "constant" in definition:
                for kind, keys in units.items():
                    yield Edit(f"{_dotted(here)} becomes a value: {kind}", put(here, {**own, **keys}))
                continue
            for value in (0, 1):
                for kind, keys in units.items():
                    unsigned = {**own, "raw": f"u{raw[1:]}", "constant": value, **keys}
                    yield Edit(f"{_dotted(here)} becomes the constant {value}: {kind}", put(here, unsigned))


def _exchanged_names(data: Data) -> Iterator[Edit]:
    """Entries and members that exchange their names."""
    for table, definition in data.get("tables", {}).items():
        path: Path = ("tables", table, "entries")
        for a, b in _pairs(list(definition["entries"])):
            yield Edit(f"{table}: names of {a} and {b} swapped", _swap_keys(path, a, b))
    for name, type_ in data.get("types", {}).items():
        for kind in ("enum", "flags"):
            for a, b in _pairs(list(type_.get(kind, {}))):
                yield Edit(f"{kind} {name}: names of {a} and {b} swapped", _swap_keys(("types", name, kind), a, b))
    for a, b in _pairs(list(data.get("types", {}))):
        yield Edit(f"names of types {a} and {b} swapped", _swap_keys(("types",), a, b))
    for a, b in _pairs(list(data.get("layouts", {}))):
        yield Edit(f"names of layouts {a} and {b} swapped", _swap_keys(("layouts",), a, b))


def _arrays(data: Data) -> Iterator[Edit]:
    """Arrays that become single fields, have other numbers or elements, and fields that become arrays."""
    for path, fields, _ in _all_fields(data):
        for name, definition in fields.items():
            here = (*path, name)
            if "array" in definition:
                yield Edit(f"{_dotted(here)} is no array", drop((*here, "array")))
                first, last = map(int, definition["array"].split(".."))
                for low, high in ((0, last - first), (first + 1, last + 1), (first, last - 1), (first, last + 1)):
                    yield Edit(
                        f"{_dotted(here)} has the elements {low}..{high}", put((*here, "array"), f"{low}..{high}")
                    )
            elif not {"holds", "constant", "reserved"} & set(definition) and _raw_of(data, definition) == "u16":
                halves = {**{k: v for k, v in definition.items() if k != "type"}, "raw": "u8", "array": "1..2"}
                yield Edit(f"{_dotted(here)} is an array", put(here, halves))


def _shared_replies(data: Data) -> Iterator[Edit]:
    """Replies that become those of other commands, or the same fields of the command itself."""
    for name, command in data["commands"].items():
        reply = command.get("reply")
        if isinstance(reply, dict) and isinstance(reply.get("of"), str):
            fields = data["commands"][reply["of"]].get("reply")
            if isinstance(fields, str) or (isinstance(fields, dict) and "of" not in fields):
                yield Edit(f"{name} replies with the fields of {reply['of']}", put(("commands", name, "reply"), fields))
            for another in data["commands"]:
                if another not in (name, reply["of"]):
                    yield Edit(f"{name} replies as {another} does", put(("commands", name, "reply"), {"of": another}))


_NEEDED = ("canwright", "family", "edition", "at", "code", "id", "title", "manual")
"""Keys that a spec cannot do without, or that are texts."""


def _removed_keys(data: Data) -> Iterator[Edit]:
    """Every key of a spec that is no name, removed."""
    for path in _keys(data, ()):
        yield Edit(f"{_dotted(path)} removed", drop(path))


def _keys(part: Any, path: Path) -> Iterator[Path]:
    if isinstance(part, dict):
        for key, inner in part.items():
            if isinstance(key, str) and key not in _NEEDED and len(path) != 1:
                yield (*path, key)
            yield from _keys(inner, (*path, key))


_ORDERED = ("addresses", "states", "modes")
"""Where the first key has a meaning of its own: the usual address, the initial state, the usual mode."""


def reordered(part: Any, order: Callable[[list[Any]], Sequence[Any]], name: Any = "") -> Any:
    """Data of a spec with its keys in another order, where the order has no meaning."""
    if isinstance(part, list):
        return [reordered(item, order) for item in part]
    if not isinstance(part, dict):
        return part
    keys = list(part) if name in _ORDERED else order(list(part))
    return {key: reordered(part[key], order, key) for key in keys}


def _swap_keys(path: Path, first: str, second: str) -> Callable[[Data], None]:
    return both(
        rename((*path, first), "swapped_name"), rename((*path, second), first), rename((*path, "swapped_name"), second)
    )


def _layouts(data: Data) -> Iterator[Edit]:
    """Layouts that move into commands and out of them."""
    for name, layout in data.get("layouts", {}).items():
        for command, definition in data["commands"].items():
            for half in ("request", "reply"):
                if definition.get(half) == name:
                    yield Edit(
                        f"layout {name} inline in the {half} of {command}",
                        put(("commands", command, half), layout["fields"]),
                    )
        renamed = both(rename(("layouts", name), f"{name}_2"), lambda d, n=name: _rename_layout(d, n))  # type: ignore[misc]
        yield Edit(f"layout {name} renamed", renamed)
    for command, definition in data["commands"].items():
        for half in ("request", "reply"):
            part = definition.get(half)
            if isinstance(part, dict) and part and all(isinstance(f, dict) and "at" in f for f in part.values()):
                yield Edit(
                    f"{half} of {command} in a layout",
                    both(
                        lambda d: d.setdefault("layouts", {}),
                        put(("layouts", "shared_one"), {"fields": part}),
                        put(("commands", command, half), "shared_one"),
                    ),
                )


def _rename_layout(data: Data, name: str) -> None:
    for command in data["commands"].values():
        for half in ("request", "reply"):
            part = command.get(half)
            if part == name:
                command[half] = f"{name}_2"
            elif isinstance(part, dict) and part.get("layout") == name:
                part["layout"] = f"{name}_2"
    for table in data.get("tables", {}).values():
        for entry in table["entries"].values():
            if entry["layout"] == name:
                entry["layout"] = f"{name}_2"


def _rename_parameter(old: str, new: str) -> Callable[[Data], None]:
    def change(data: Data) -> None:
        rename(("parameters", old), new)(data)

        def walk(part: Any) -> None:
            if isinstance(part, dict):
                if part.get("by") == old:
                    part["by"] = new
                only = part.get("only")
                if isinstance(only, dict) and old in only:
                    part["only"] = {new if k == old else k: v for k, v in only.items()}
                for key, value in part.items():
                    if isinstance(value, str) and key in ("scale", "offset", "range", "raw_range"):
                        part[key] = value.replace(old, new)
                    walk(value)
            elif isinstance(part, list):
                for item in part:
                    walk(item)

        walk(data)

    return change


def _rename_value(parameter: str, values: dict[str, str]) -> Callable[[Data], None]:
    """Renames values of a parameter wherever they are used."""

    def change(data: Data) -> None:
        def renamed(mapping: Data) -> None:
            items = [(values.get(str(k), k), v) for k, v in mapping.items()]
            mapping.clear()
            mapping.update(items)

        renamed(data["parameters"][parameter]["values"])

        def walk(part: Any) -> None:
            if isinstance(part, dict):
                if part.get("by") == parameter:
                    renamed(part)
                only = part.get("only")
                if isinstance(only, dict) and parameter in only:
                    only[parameter] = [values.get(str(v), v) for v in only[parameter]]
                for value in part.values():
                    walk(value)
            elif isinstance(part, list):
                for item in part:
                    walk(item)

        walk(data)

    return change


def _parameters(data: Data) -> Iterator[Edit]:
    for name, parameter in data.get("parameters", {}).items():
        yield Edit(
            f"parameter {name} renamed", _rename_parameter(name, f"{name}_2"), Names(parameters={name: f"{name}_2"})
        )
        values = parameter.get("values")
        if isinstance(values, dict):
            first, *_, last = values
            yield Edit(
                f"value {first} of {name} renamed", _rename_value(name, {first: "Z9"}), Names(values={first: "Z9"})
            )
            if first != last:
                yield Edit(
                    f"values {first} and {last} of {name} swapped", _rename_value(name, {first: last, last: first})
                )
                yield Edit(
                    f"parameter {name} renamed, cases swapped",
                    both(_rename_value(name, {first: last, last: first}), _rename_parameter(name, f"{name}_2")),
                    Names(parameters={name: f"{name}_2"}),
                )


def _same(data: Data) -> Iterator[Edit]:
    """The same protocol in other words."""
    for name, type_ in data.get("types", {}).items():
        if "scale" not in type_ and "enum" not in type_ and "flags" not in type_:
            yield Edit(f"scale of {name} written as 1", put(("types", name, "scale"), 1), nothing=True)
        if isinstance(type_.get("scale"), dict):
            keys = list(type_["scale"])
            turned = {k: type_["scale"][k] for k in (keys[0], *reversed(keys[1:]))}
            yield Edit(f"cases of {name} in another order", put(("types", name, "scale"), turned), nothing=True)
    modes = data.get("bus", {}).get("modes")
    if isinstance(modes, dict) and len(modes) > 1:
        yield Edit("modes in another order", put(("bus", "modes"), dict(reversed(modes.items()))), nothing=True)
    for part in ("commands", "types", "layouts"):
        if len(data.get(part, {})) > 1:
            yield Edit(f"{part} in another order", put((part,), dict(reversed(data[part].items()))), nothing=True)
    count = 0
    for path, fields, _ in _all_fields(data):
        for name, definition in fields.items():
            if "raw" in definition and not {"constant", "reserved", "holds"} & set(definition) and count < 6:
                count += 1
                type_ = {"raw": definition["raw"]}
                if "byte_order" in definition:
                    type_["byte_order"] = definition["byte_order"]
                field = {
                    **{k: v for k, v in definition.items() if k not in ("raw", "byte_order")},
                    "type": "plain_number",
                }
                yield Edit(
                    f"{_dotted((*path, name))} as a type",
                    both(
                        lambda d: d.setdefault("types", {}),
                        put(("types", "plain_number"), type_),
                        put((*path, name), field),
                    ),
                    nothing=True,
                )
