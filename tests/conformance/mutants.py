"""Small changes of a spec, each of which means another protocol: what a replay of golden frames must notice."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

from canwright.model.metadata import FrameFormat

Data = dict[Any, Any]
Change = Callable[[Data], None]
Mutant = tuple[str, Change]
Path = tuple[str | int, ...]


def _states_every_length(data: Data) -> bool:
    """Whether each request and reply has a length of its own."""
    halves = [command.get(half, {}) for command in data["commands"].values() for half in ("request", "reply")]
    return all(isinstance(half, dict) and ("dlc" in half or "of" in half) for half in halves if half != "none")


def mutants(data: Data) -> Iterator[Mutant]:
    """Every address, selector, type, field, index, code and reply form of a spec, changed a little."""
    order = data.get("byte_order", "little")
    yield _set(("byte_order",), "little" if order == "big" else "big")
    if not _states_every_length(data):
        yield _set(("bus", "dlc"), 7)
    for name, address in data["addresses"].items():
        yield from _address(("addresses", name), address)
    if "selector" in data:
        yield from _selector(("selector",), data["selector"])
    numbers = [name for name, parameter in data.get("parameters", {}).items() if "number" in parameter]
    for name, type_ in data.get("types", {}).items():
        yield from _multiples(("types", name), type_, numbers)
        only_in_id = all(str(field["at"]).startswith("id.") for field in _fields_of(data, name))
        yield from _type(("types", name), type_, "" if only_in_id else order)
    for name, layout in data.get("layouts", {}).items():
        yield from _fields(("layouts", name, "fields"), layout["fields"])
    for name, table in data.get("tables", {}).items():
        yield from _table(("tables", name), table)
    halves = [half for c in data["commands"].values() for half in (c, c.get("request"), c.get("reply"))]
    written = [half.get("code") for half in halves if isinstance(half, dict)]
    codes = {code for entry in written for code in (entry.values() if isinstance(entry, dict) else (entry,))}
    free = next(number for number in range(1, 1 << 8) if number not in codes)
    for name, command in data["commands"].items():
        yield from _command(("commands", name), command, free)


def _fields_of(part: object, type_: str) -> Iterator[Data]:
    """Every field of a type, anywhere in a spec."""
    if isinstance(part, dict):
        if "at" in part and part.get("type") == type_:
            yield part
        for inner in part.values():
            yield from _fields_of(inner, type_)


def _address(path: Path, address: Data) -> Iterator[Mutant]:
    for key in ("id", "request", "reply"):
        if key not in address:
            continue
        written = str(address[key])
        is_number = re.fullmatch("[0-9xA-Fa-f]+", written)
        moved = f"0x{int(written, 0) ^ 2:X}" if is_number else f"{written} + 0x400"
        yield _set((*path, key), moved)
        if "<<" in written:
            yield _set((*path, key), written.replace("<< ", "<< 1"))
        elif "*" in written:
            yield _set((*path, key), re.sub(r"([0-9]+) \* node|node \* ([0-9]+)", "node * 11", written))
        elif "node" in written:
            yield _set((*path, key), written.replace("node", "node << 1"))
    yield _set((*path, "extended"), not address.get("extended", False))
    if "nodes" in address:
        low, high = map(int, address["nodes"].split(".."))
        for changed in ((low, high + 1), (low, high - 1), (low + 1, high), *([(low - 1, high)] if low else [])):
            yield _set((*path, "nodes"), f"{changed[0]}..{changed[1]}")
    if "alternative_replies" in address:
        yield _drop((*path, "alternative_replies"))
    for key in ("selector", "reply_selector"):
        if key in address:
            yield from _selector((*path, key), address[key])


def _selector(path: Path, selector: Data) -> Iterator[Mutant]:
    for at in _moved(selector["at"]):
        yield _set((*path, "at"), at)
    if not str(selector["at"]).startswith("id."):  # in an id, a bit that is not selected by has to be 0 as well
        yield _set((*path, "raw"), f"u{int(selector['raw'][1:]) - 1}")


def _table(path: Path, table: Data) -> Iterator[Mutant]:
    for name, entry in table["entries"].items():
        at = (*path, "entries", name)
        index = entry["index"]
        if isinstance(index, list):
            for i in range(len(index)):
                yield _set((*at, "index"), [n + 0x50 if i == j else n for j, n in enumerate(index)])
        else:
            yield _set((*at, "index"), index + 0x50)
        if "kind" in entry:
            yield _set((*at, "kind"), next(e["kind"] for e in table["entries"].values() if e["kind"] != entry["kind"]))
        if "commands" in entry:
            yield _drop((*at, "commands"))
        if isinstance(entry["layout"], dict):
            yield from _fields((*at, "layout"), entry["layout"])


def _code(path: Path, code: int | Data, free: int) -> Iterator[Mutant]:
    """Another code; where there is one for each kind of entry, another for each."""
    if isinstance(code, dict):
        yield from (_set((*path, kind), free) for kind in code)
    else:
        yield _set(path, free)


MESSAGE_KEYS = {
    *("layout", "fields", "of", "from_each", "code", "accept", "address", "dlc", "remote"),
    *("every_ms", "timeout_ms", "sent", "frames"),
}
"""The keys of a request or a reply that is more than its fields."""


def _command(path: Path, command: Data, free: int) -> Iterator[Mutant]:
    if "code" in command:
        yield from _code((*path, "code"), command["code"], free)
    for key in ("further_replies", "alternative_replies"):
        if key in command:
            yield _drop((*path, key))
    for half in ("request", "reply"):
        written = command.get(half)
        if written == "echo":
            yield _set((*path, half), "none")
        if not isinstance(written, dict):
            continue
        if not MESSAGE_KEYS & set(written):
            yield from _fields((*path, half), written)
            continue
        for key in ("layout", "fields"):
            if isinstance(written.get(key), dict):
                yield from _fields((*path, half, key), written[key])
        yield from _frame((*path, half), written, free)


def _frame(path: Path, written: Data, free: int) -> Iterator[Mutant]:
    """All of a request or a reply but its fields."""
    if "of" not in written:
        lengths = FrameFormat.FD.lengths
        number = lengths.index(written.get("dlc", FrameFormat.CLASSIC.max_data_bytes))
        if not written.get("remote"):
            yield _set(
                (*path, "dlc"), lengths[number + 1 if number < FrameFormat.CLASSIC.max_data_bytes else number - 1]
            )
        yield _set((*path, "remote"), not written.get("remote", False))
    if "code" in written:
        yield from _code((*path, "code"), written["code"], free)
    for i in range(len(written.get("accept", ()))):
        yield _set((*path, "accept"), [n for j, n in enumerate(written["accept"]) if j != i])
    for field, numbers in written.get("frames", {}).items():
        first, last = map(int, numbers.split(".."))
        yield _set((*path, "frames", field), f"{first}..{last - 1}")
    if "from_each" in written:
        low, high = written["from_each"].split("..")
        yield _set((*path, "from_each"), f"{low}..{int(high) + 1}")
        yield _set((*path, "from_each"), f"{low}..{int(high) - 1}")


def _fields(path: Path, fields: Data) -> Iterator[Mutant]:
    for name, field in fields.items():
        at = (*path, name)
        yield _drop(at)
        for place in _moved(field["at"]):
            yield _set((*at, "at"), place)
        if "only" in field:
            yield _drop((*at, "only"))
        if "holds" in field:
            yield _drop((*at, "holds"))
        yield from _role(at, field)
        if "array" in field:
            low, high = map(int, field["array"].split(".."))
            yield _set((*at, "array"), f"{low}..{high - 1}")
        if "raw" in field and not {"constant", "reserved"} & set(field):
            yield from _raw((*at, "raw"), field["raw"])
    for first, second in zip(list(fields), list(fields)[1:], strict=False):
        if fields[first]["at"] != fields[second]["at"]:  # in one place under two parameter values: nothing would change
            yield f"{_dotted(path)} {first}<->{second}", _swap(path, first, second)


def _role(at: Path, field: Data) -> Iterator[Mutant]:
    if "constant" in field:
        constant = field["constant"]
        yield _set((*at, "constant"), constant ^ 1 if isinstance(constant, int) else 1)
    if "reserved" in field:
        yield _set((*at, "reserved"), field["reserved"] ^ 1)
        yield f"{_dotted(at)} checked", _renamed(at, "reserved", "constant")
    if "counter" in field:
        yield from (_set((*at, "counter"), span) for span in _spans(field["counter"]))
    if "checksum" in field:
        yield from _checksum((*at, "checksum"), field["checksum"])


def _checksum(path: Path, checksum: Data) -> Iterator[Mutant]:
    if "poly" in checksum:
        yield _set((*path, "poly"), checksum["poly"] ^ 2)
        yield from (_set((*path, key), checksum.get(key, 0) ^ 1) for key in ("init", "xor_out"))
        yield _set((*path, "reflected"), not checksum.get("reflected", False))
    else:
        yield _set((*path, "algorithm"), "sum_inverted" if checksum["algorithm"] != "sum_inverted" else "sum")
    if isinstance(checksum["over"], list):
        yield _set((*path, "over"), checksum["over"][-1])


def _type(path: Path, type_: Data, order: str) -> Iterator[Mutant]:
    """`order` is that of the edition; empty where no byte order matters."""
    joined = re.fullmatch("(ascii|utf8_|bcd)([0-9]+)", type_["raw"])
    if joined:
        yield from _joined(path, type_, joined[1], int(joined[2]), order)
        return
    raw, is_number = type_["raw"], "enum" not in type_ and "flags" not in type_
    if "flags" not in type_:
        yield from _raw((*path, "raw"), raw)
    if int(raw[1:]) > 8 and order:
        yield _set((*path, "byte_order"), "little" if type_.get("byte_order", order) == "big" else "big")
    is_float = raw[0] == "f"
    if is_number and not is_float:
        yield _set((*path, "offset"), 1 if type_.get("offset", 0) != 1 else 2)
    scale = type_.get("scale", 1)
    if isinstance(scale, dict):
        yield from (
            _set((*path, "scale", case), 2 if scale[case] == 1 else 1)
            for case in scale
            if case != "by" and scale[case] != "none"
        )
    elif is_number and not is_float:
        yield _set((*path, "scale"), 2 if scale == 1 else 1)
    yield from _ranges(path, type_)
    if is_float and "no_value" in type_:
        yield _drop((*path, "no_value"))
    elif len(type_.get("no_value", ())) > 1:
        yield from (_drop((*path, "no_value", name)) for name in type_["no_value"])
    for kind, key in (("enum", "value"), ("flags", "bit"), ("names", "value")):
        for member, entry in type_.get(kind, {}).items():
            at, value = ((), entry) if isinstance(entry, int) else ((key,), entry[key])
            yield _set((*path, kind, member, *at), value + 2)


def _joined(path: Path, type_: Data, kind: str, count: int, order: str) -> Iterator[Mutant]:
    """A text in another encoding, of another length or with other padding; digits of another number or in another order."""
    if kind != "bcd":
        yield _set((*path, "raw"), f"{'utf8_' if kind == 'ascii' else 'ascii'}{count}")
    elif count > 2 and order:
        yield _set((*path, "byte_order"), "little" if type_.get("byte_order", order) == "big" else "big")
    if count > 1:
        yield _set((*path, "raw"), f"{kind}{count - 1}")
    if "padding" in type_:
        yield _set((*path, "padding"), type_["padding"] ^ 1)


def _ranges(path: Path, type_: Data) -> Iterator[Mutant]:
    for key in ("range", "raw_range"):
        limits = type_.get(key)
        if isinstance(limits, dict):
            for case in limits:
                if case != "by" and limits[case] != "none":
                    yield from (_set((*path, key, case), changed) for changed in _spans(limits[case]))
        elif limits is not None:
            yield _drop((*path, key))
            yield from (_set((*path, key), changed) for changed in _spans(limits))


def _multiples(path: Path, type_: Data, numbers: Sequence[str]) -> Iterator[Mutant]:
    """Another parameter, none, and twice as much of it, wherever the scale is a multiple of one."""
    keys = [key for key in ("scale", "offset", "range") if key in type_]
    names = [name for name in numbers if re.search(rf"\b{name}\b", str(type_.get("scale")))]
    for name in names:
        for told, replacement in (*((n, n) for n in numbers if n != name), ("1", "1"), ("twice", f"2*{name}")):
            written = {key: _replaced(type_[key], name, replacement) for key in keys}
            yield f"{_dotted(path)}.scale {name} as {told}", _change_all(path, written)
        if "offset" in type_:
            yield _drop((*path, "offset"))


def _replaced(written: object, name: str, replacement: str) -> object:
    """A number, or a number of each case, with something else for a parameter; what it is multiplied with is kept."""
    if isinstance(written, dict):
        return {case: entry if case == "by" else _replaced(entry, name, replacement) for case, entry in written.items()}

    def number(match: re.Match[str]) -> str:
        factor = Fraction(match[1].rstrip("*") + ("" if match[1].endswith("*") else "1"))
        parameter = replacement.removeprefix("2*")
        factor *= 2 if parameter != replacement else 1
        return str(factor) if parameter == "1" else f"{factor}*{parameter}"

    return re.sub(rf"(-?[0-9][0-9.]*(?:/[0-9]+)?\*|-?)\b{name}\b", number, str(written))


def _change_all(path: Path, written: Data) -> Change:
    def change(data: Data) -> None:
        _walk(data, path).update(written)

    return change


def _raw(path: Path, raw: str) -> Iterator[Mutant]:
    """Another sign, and another width; a float of another width."""
    joined = re.fullmatch("(ascii|utf8_|bcd)([0-9]+)", raw)
    if joined:
        yield from _joined(path[:-1], {}, joined[1], int(joined[2]), "")
        return
    width = int(raw[1:])
    if raw[0] == "f":
        yield _set(path, "f64" if width == 32 else "f32")
        return
    yield _set(path, ("u" if raw[0] == "i" else "i") + raw[1:])
    if width > 1:
        yield _set(path, f"{raw[0]}{width - 1}")


def _spans(limits: str) -> Iterator[str]:
    """A range with each of its ends moved by one, or without what depends on a parameter."""
    low, high = limits.split("..")
    if low.lstrip("-").isdigit():
        yield f"{int(low) + 1}..{high}"
        if int(low):
            yield f"{int(low) - 1}..{high}"
    if high.lstrip("-").isdigit():
        yield f"{low}..{int(high) - 1}"
        yield f"{low}..{int(high) + 1}"
    elif high.lstrip("-")[0].isdigit() and "." not in high:
        yield f"{low}..{high.replace('*', '0*', 1)}"
    elif "*" not in high:
        yield f"{low}..1/2*{high}"
    else:
        yield f"{low}..2*{high.partition('*')[2]}"


def _moved(at: object) -> Iterator[object]:
    """The places a step before and behind: a byte, or a bit where one is given; several runs in another order."""
    if isinstance(at, list):
        yield at[::-1]
        return
    text = str(at)
    if text.startswith("id."):
        bit = int(text[3:])
        yield from (f"id.{n}" for n in (bit - 1, bit + 1) if n >= 0)
    elif "." in text:
        byte, bit = map(int, text.split("."))
        yield from (f"{n // 8}.{n % 8}" for n in (byte * 8 + bit - 1, byte * 8 + bit + 1) if n >= 0)
    else:
        yield from (str(n) for n in (int(text) - 1, int(text) + 1) if n >= 0)


def _set(path: Path, value: object) -> Mutant:
    def change(data: Data) -> None:
        for step in path[:-1]:
            data = data.setdefault(step, {})
        data[path[-1]] = value

    return f"{_dotted(path)} {value}", change


def _drop(path: Path) -> Mutant:
    def change(data: Data) -> None:
        del _walk(data, path[:-1])[path[-1]]

    return f"{_dotted(path)} gone", change


def _swap(path: Path, first: str, second: str) -> Change:
    def change(data: Data) -> None:
        fields = _walk(data, path)
        fields[first]["at"], fields[second]["at"] = fields[second]["at"], fields[first]["at"]

    return change


def _renamed(path: Path, old: str, new: str) -> Change:
    def change(data: Data) -> None:
        inner = _walk(data, path)
        inner[new] = inner.pop(old)

    return change


def _walk(data: Data, path: Path) -> Data:
    for step in path:
        data = data[step]
    return data


def _dotted(path: Path) -> str:
    return ".".join(map(str, path))
