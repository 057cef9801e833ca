"""The published English pages, parsed back into what a decoder needs. Nothing but their text is read."""

from __future__ import annotations

import functools
import operator
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

PI = Fraction(245850922, 78256779)
"""π as the guide of the language states it."""


def tables(page: str) -> Iterator[tuple[str, list[list[str]]]]:
    """Every table of a page with the heading above it; its rows without the separator."""
    heading, rows = "", list[list[str]]()
    for line in [*page.splitlines(), ""]:
        if line.startswith("|"):
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]
            if not all(re.fullmatch(r"-+", cell) for cell in cells):
                rows.append(cells)
            continue
        if rows:
            yield heading, rows
            rows = []
        if line.startswith("#"):
            heading = re.sub(r"<[^>]*>", "", line).lstrip("# ").replace("\\", "")


def forms(page: str, name: str) -> Iterator[tuple[str, str]]:
    """The forms of a command with their names: one for each entry, or the page itself."""
    first, *sections = re.split(r'^## <a id="entries\.(\w+)"></a>', page, flags=re.MULTILINE)
    if not sections:
        yield name, first
    for entry, text in zip(sections[::2], sections[1::2], strict=True):
        yield f"{name}_{entry}", f"## {text}"


def plain(cell: str) -> str:
    """The text of the first code span of a cell."""
    match = re.search(r"`([^`]*)`", cell)
    return match.group(1) if match else ""


def cases(cell: str) -> dict[str, str | None]:
    """`MF: 16.5/2048 A`, one line a case; the key is empty where there is one case, the value None for "not given"."""
    cases: dict[str, str | None] = {}
    for line in filter(None, cell.split("<br>")):
        names, colon, _ = line.partition(": ")
        for name in names.split(", ") if colon else [""]:
            cases[name] = None if line.endswith("not given") else plain(line)
    return cases


def rational(text: str) -> Fraction:
    """`0.01`, `16.5/2048`, `-3`, `2*π/65535`."""
    if "π" in text:
        return rational(re.sub(r"(?<=\d)\*π", "", text).replace("π", "1")) * PI
    above, _, below = text.partition("/")
    return Fraction(above) / Fraction(below or "1")


@dataclass(frozen=True)
class Scale:
    """value = raw * step + offset, both so many times a parameter where there is one."""

    step: Fraction
    offset: Fraction
    parameter: str = ""


def _multiple(text: str) -> tuple[Fraction, str]:
    """`2/65535*size`, `-size`, or a number without a parameter."""
    match = re.fullmatch(r"(?:(.+?)\*|(-?))([a-z]\w*(?:\*[a-z]\w*)?(?:/[a-z]\w*)?)|(.+)(/[a-z]\w*)", text)
    if match is None:
        return rational(text), ""
    if match[5]:
        return rational(match[4]), match[5]
    return rational(match[1] or f"{match[2]}1"), match[3]


def scale(text: str | None) -> Scale | None:
    """`0.1 °C, offset -40 °C`."""
    if text is None:
        return None
    match = re.fullmatch(r"(\S+?)(?: [^\s,]+)?(?:, offset (\S+)(?: \S+)?)?", text)
    assert match, text
    step, parameter = _multiple(match[1])
    offset, same = _multiple(match[2]) if match[2] else (Fraction(0), parameter)
    assert parameter == same, text
    return Scale(step, offset, parameter)


@dataclass(frozen=True)
class End:
    """An end of a range: a number, or `factor * parameter + number`."""

    number: Fraction
    factor: Fraction
    parameter: str

    def at(self, parameters: Mapping[str, int | str | Fraction]) -> Fraction | None:
        if not self.parameter:
            return self.number
        given = parameters.get(self.parameter)
        return None if given is None else self.number + self.factor * Fraction(str(given))


def ends(text: str) -> tuple[End, End]:
    """`0..36000*gear_ratio-1`."""
    low, high = (_end(part) for part in text.split(".."))
    return low, high


def _end(text: str) -> End:
    match = re.fullmatch(r"(.*[a-z]\w*)([+-].+)?", text)
    if match is None:
        return End(rational(text), Fraction(0), "")
    factor, parameter = _multiple(match[1])
    return End(rational(match[2] or "0"), factor, parameter)


@dataclass(frozen=True)
class Bits:
    """Where a raw integer is: pairs of its bits and bits of the data or of the id."""

    in_id: bool
    numbers: tuple[tuple[int, int], ...]

    def read(self, can_id: int, data: bytes) -> int:
        word = can_id if self.in_id else int.from_bytes(data, "little")
        return sum((word >> bit & 1) << i for i, bit in self.numbers)

    def write(self, raw: int) -> int:
        return sum((raw >> i & 1) << bit for i, bit in self.numbers)


def bits(place: str, raw: str) -> Bits:
    """`DATA[4..5]` of `i16`, `DATA[3] bits 0..3, DATA[4]` of `u12 big-endian`, `id bits 5..10`."""
    parts = []
    for part in place.split(", "):
        match = re.fullmatch(
            r"(id|DATA\[(\d+)(?:\.\.(\d+))?\])(?: bits? (\d+)(?:\.\.(\d+))?)?(?: \[(?:\d+:)?(\d+)\])?", part
        )
        assert match, place
        low, high = int(match[4] or 0), int(match[5] or match[4] or 7)
        if match[1] == "id":
            return Bits(True, tuple(enumerate(range(low, high + 1))))
        first = int(match[2])
        own = [[byte * 8 + bit for bit in range(low, high + 1)] for byte in range(first, int(match[3] or first) + 1)]
        if match[6] is not None:  # a run that states its bits of the raw integer
            own.sort(reverse=raw.endswith("big-endian"))
            labelled = [bit for byte in own for bit in byte]
            parts.append([(int(match[6]) + i, bit) for i, bit in enumerate(labelled)])
            continue
        parts += [[(-1, bit) for bit in byte] for byte in own]
    if raw.endswith("big-endian"):
        parts.reverse()
    every = [pair for part in parts for pair in part]
    return Bits(False, tuple((i if raw_bit < 0 else raw_bit, bit) for i, (raw_bit, bit) in enumerate(every)))


@dataclass(frozen=True)
class Checksum:
    """`crc8_sae_j1850 (poly 0x1D, init 0xFF, xor_out 0xFF) over 5A, DATA[0..6], id big-endian`."""

    name: str
    parameters: Mapping[str, int]
    is_reflected: bool
    inputs: tuple[str, ...]

    def of(self, can_id: int, extended: bool, data: bytes, own: Bits) -> int:
        """The checksum of a frame, as long as its own bits, which count as 0."""
        width = len(own.numbers)
        cleared = (int.from_bytes(data, "little") & ~own.write(-1)).to_bytes(len(data), "little")
        every = b"".join(_input(part, can_id, extended, cleared) for part in self.inputs)
        mask = (1 << width) - 1
        if self.name.startswith("sum"):
            return {"sum": sum(every), "sum_inverted": ~sum(every), "sum_negated": -sum(every)}[self.name] & mask
        if self.name.startswith("xor"):
            return functools.reduce(operator.xor, every, mask if self.name == "xor_inverted" else 0)
        poly, init = 1 << width | self.parameters["poly"], self.parameters.get("init", 0)
        # the remainder of the polynomial whose highest coefficients are those of the initial value and of the first bits
        bits = [byte >> (i if self.is_reflected else 7 - i) & 1 for byte in every for i in range(8)] + [0] * width
        for i in range(width):
            bits[i] ^= init >> (width - 1 - i) & 1
        for start in range(len(bits) - width):
            if bits[start]:
                for i in range(width + 1):
                    bits[start + i] ^= poly >> (width - i) & 1
        rest = bits[-width:][:: -1 if self.is_reflected else 1]
        return int("".join(map(str, rest)), 2) ^ self.parameters.get("xor_out", 0)


def _input(part: str, can_id: int, extended: bool, data: bytes) -> bytes:
    if part == "id bits 0..7":
        return bytes([can_id & 0xFF])
    if part.startswith("id "):
        return can_id.to_bytes(4 if extended else 2, "big" if part == "id big-endian" else "little")
    places = re.fullmatch(r"DATA\[(\d+)(?:\.\.(\d+))?\]", part)
    return data[int(places[1]) : int(places[2] or places[1]) + 1] if places else bytes.fromhex(part)


def checksum(text: str) -> Checksum | None:
    """The checksum of a description; None without one."""
    match = re.search(r"Checksum, .*: `(\w+)(?: \(([^)]*)\))? over ([^`]*)`", text)
    if match is None:
        return None
    parameters = dict(part.split() for part in (match[2] or "").split(", ") if " " in part)
    return Checksum(
        match[1],
        {name: int(number, 16) for name, number in parameters.items()},
        "reflected" in (match[2] or ""),
        tuple(match[3].split(", ")),
    )


@dataclass(frozen=True)
class FieldRow:
    """A field, or one element of an array, as its row says."""

    name: str
    index: int | None
    type: str
    raw: str
    bits: Bits
    scales: Mapping[str, Scale | None]
    ranges: Mapping[str, tuple[End, End]]
    constant: int | None
    checked: bool
    only: tuple[str, tuple[str, ...]]
    holds_node: bool
    has_low_bits: bool
    """Of the number of the node."""
    checksum: Checksum | None
    is_parameter: str
    """The parameter that is the constant, while it is unknown."""


@dataclass(frozen=True)
class Key:
    """The selector: where it is, what is sent, what else is taken."""

    bits: Bits
    value: int
    accepted: tuple[int, ...]


@dataclass(frozen=True)
class MessagePage:
    """One direction of a command page."""

    base: int
    step: int
    nodes: range | None
    extended: bool
    remote: bool
    dlc: int
    is_echo: bool
    from_each: tuple[int, ...]
    others: tuple[str, ...]
    keys: tuple[Key, ...]
    rows: tuple[FieldRow, ...]
    parameter: str = ""
    """The parameter in the id."""
    parameter_step: int = 1

    def at(self, parameters: Mapping[str, int | str | Fraction]) -> MessagePage:
        """The page with the value of the parameters in id and constants, as far as they are known."""
        rows = tuple(
            replace(row, constant=int(str(parameters[row.is_parameter])), is_parameter="")
            if row.is_parameter in parameters
            else row
            for row in self.rows
        )
        if self.parameter not in parameters:
            return replace(self, rows=rows)
        base = self.base + int(str(parameters[self.parameter])) * self.parameter_step
        return replace(self, base=base, parameter="", parameter_step=1, rows=rows)

    @property
    def rule(self) -> tuple[object, ...]:
        """What tells the node from the id; pages with the same rule share their ids."""
        return self.base, self.step, self.nodes, self.extended, self.remote, self.parameter, self.parameter_step

    @property
    def in_id(self) -> int:
        """The bits of the id that are fields or keys."""
        places = [*(key.bits for key in self.keys), *(row.bits for row in self.rows)]
        return sum(1 << bit for bit in {bit for place in places if place.in_id for _, bit in place.numbers})


OTHERS = ("Followed by the reply of", "Or, instead, the reply of")
"""The columns with the commands whose replies also answer a request."""


def message(facts: Sequence[Sequence[str]], rows: Sequence[Sequence[str]]) -> MessagePage:
    """A direction of a command page from its two tables."""
    said = dict(zip(*facts, strict=True))
    lines = [dict(zip(rows[0], row, strict=True)) for row in rows[1:]]
    base, steps = _id(plain(said["Id"]))
    step = steps.pop("node", 1)
    first, last = plain(said["Nodes"]).split("..") if "Nodes" in said else ("", "")
    each = plain(said.get("One reply from each of", ""))
    return MessagePage(
        base,
        step,
        range(int(first), int(last) + 1) if first else None,
        "29-bit" in said["Frame"],
        "remote frame" in said["Frame"],
        int(plain(said["Frame"])),
        said.get("Form") == "The request is returned unchanged",
        tuple(int(node) for node in each.split(", ") if node),
        tuple(re.findall(r"\[(\w+)\]\(", "".join(map(said.get, OTHERS, [""] * len(OTHERS))))),
        tuple(_key(line) for line in lines if not line.get("Field")),
        tuple(_field(line) for line in lines if line.get("Field")),
        *next(iter(steps.items()), ("", 1)),
    )


def _id(text: str) -> tuple[int, dict[str, int]]:
    """The number in an id, and the factors of node and parameter."""
    base, steps = 0, dict[str, int]()
    for term in text.split(" + "):
        name = re.match(r"\(?([a-z]\w*)", term)
        if name:
            shift, factor = term.partition(" << ")[2], term.partition(" * ")[2]
            steps[name[1]] = 1 << int(shift.strip(")")) if shift else int(factor or 1)
        else:
            base = int(term, 0)
    return base, steps


def _key(line: Mapping[str, str]) -> Key:
    accepted = tuple(int(code, 16) for code in re.findall(r"`0x([0-9A-F]+)`", line["Description"]))
    raw, _, value = line["Raw"].partition("<br>")
    return Key(bits(plain(line["Position"]), plain(raw)), int(plain(value), 0), accepted)


def _scales(text: str, *, is_float: bool) -> Mapping[str, Scale | None]:
    """Those of a column; a float without a number there is its own value, in a unit or without one."""
    if is_float and not re.search(r"\d", text):
        return {"": Scale(Fraction(1), Fraction(0))}
    return {name: scale(case) for name, case in cases(text).items()}


def _field(line: Mapping[str, str]) -> FieldRow:
    match = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", plain(line["Field"]))
    assert match, line["Field"]
    parameter, _, values = plain(line.get("Only", "")).partition(" ")
    raw, _, raw_range = line["Raw"].partition("<br>")
    is_float = plain(raw).startswith("f")
    limits = line.get("Value range", "") if is_float else raw_range
    is_constant = raw_range and ".." not in raw_range
    is_parameter = plain(raw_range) if is_constant and re.match("[a-z]", plain(raw_range)) else ""
    constant = int(plain(raw_range), 0) if is_constant and not is_parameter else 0 if is_parameter else None
    linked = re.search(r"types\.md#types\.(\w+)", line["Field"])
    return FieldRow(
        match[1],
        int(match[2]) if match[2] else None,
        linked[1] if linked else "",
        plain(raw),
        bits(plain(line["Position"]), plain(raw)),
        _scales(line.get("Resolution (1 LSB)", ""), is_float=is_float),
        {}
        if constant is not None
        else {name: ends(text.partition(" ")[0] if is_float else text) for name, text in cases(limits).items() if text},
        constant,
        "ignored when received" not in line.get("Value range", ""),
        (parameter, tuple(values.split(", "))),
        "node number" in line["Description"],
        "low bits of the node number" in line["Description"],
        checksum(line["Description"]),
        is_parameter,
    )
