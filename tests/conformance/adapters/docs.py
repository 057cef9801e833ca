"""The published pages as a decoder: whoever reads them has all it takes."""

from __future__ import annotations

import math
import re
import struct
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

from canwright.conformance.adapter import (
    Adapter,
    CanFrame,
    Cannot,
    Decoded,
    ExactValue,
    Parameters,
    Raw,
    Refused,
    Value,
    means_another,
)
from canwright.model.edition import Edition
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS
from canwright.targets.base import EditionInput
from canwright.targets.docs.target import DocsTarget

from .docs_tables import FieldRow, MessagePage, Scale, forms, message, plain, tables


class DocsAdapter(Adapter):
    """Answers from the tables of the English pages alone."""

    name = "docs"
    cannot: ClassVar[Mapping[str, str]] = {
        "availability": "the nodes that have a command are in a sentence above its tables, not in a table",
        "confusion": "the tables have the values of each message, not those with which a receiver identifies another one",
    }

    def __init__(self, edition: Edition, pages: Mapping[str, str]) -> None:
        super().__init__(edition)
        self._members: dict[str, dict[str, int]] = {}
        self._flags: set[str] = set()
        self._no_values: dict[str, dict[str, range]] = {}
        self._named: dict[str, dict[str, int]] = {}
        self._choices: dict[str, list[str]] = {}
        self._messages: dict[tuple[Direction, str], MessagePage] = {}
        for path, text in pages.items():
            if path.endswith("/types.md"):
                self._read_types(text)
            elif path.endswith("/parameters.md"):
                self._choices = {n: [plain(r[0]) for r in rows[1:]] for n, rows in tables(text)}
            elif "/commands/" in path:
                for name, form in forms(text, Path(path).stem):
                    self._read_command(name, form)
        self._in_id: defaultdict[tuple[Direction, object], int] = defaultdict(int)
        """The bits of the id that are fields or keys of any page with the same rule."""
        for (direction, _), page in self._messages.items():
            self._in_id[direction, page.rule] |= page.in_id

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> DocsAdapter:
        """Reads the generated pages back."""
        pages = {output.path: output.text for output in DocsTarget().generate([specification], {})}
        return cls(specification.edition, {path: text for path, text in pages.items() if path.startswith("en/")})

    def _read_types(self, text: str) -> None:
        for heading, rows in tables(text):
            if rows[0][0] == "Without a value":
                self._no_values[heading] = {plain(row[1]): _integers(plain(row[0])) for row in rows[1:]}
            if rows[0][0] == "Named raw integer":
                self._named[heading] = {plain(row[1]): int(plain(row[0]), 0) for row in rows[1:]}
            if rows[0][0] in ("Value", "Bit"):
                self._members[heading] = {plain(row[1]): int(plain(row[0]), 0) for row in rows[1:]}
                if rows[0][0] == "Bit":
                    self._flags.add(heading)

    def _read_command(self, name: str, text: str) -> None:
        sections = [(heading, rows) for heading, rows in tables(text) if heading in ("Request", "Reply")]
        rows_of: dict[Direction, list[list[str]]] = {}
        for direction in Direction:
            here = [rows for heading, rows in sections if heading.lower() == direction.value]
            if here and "Id" in here[0][0]:
                facts = dict(zip(*here[0], strict=True))
                if "Fields" in facts:
                    here[1:] = [rows_of[Direction.REQUEST]]
                rows_of[direction] = here[1] if len(here) > 1 else [[]]
                self._messages[direction, name] = message(here[0], rows_of[direction])

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        of_direction = [(n, m) for (d, n), m in self._messages.items() if d is direction]
        pages = [(n, m.at(parameters), self._in_id[direction, m.rule]) for n, m in of_direction]
        ours = [(name, page, self._node(page, frame, in_id)) for name, page, in_id in pages]
        ours = [(name, page, node) for name, page, node in ours if node != ()]
        if not ours:
            open_ = any(m.parameter and (m.extended, m.remote) == (frame.extended, frame.remote) for _, m, _ in pages)
            wanted = next((m for n, m, _ in pages if n == expected), None)
            is_open = open_ if wanted is None else bool(wanted.parameter)
            return Refused(Refusal.MISSING_PARAMETER if is_open else Refusal.UNKNOWN_ID)
        if all(len(frame.data) != page.dlc for _, page, _ in ours) and not frame.remote:
            return Refused(Refusal.WRONG_LENGTH)
        if expected is not None:
            ours = [entry for entry in ours if entry[0] == expected]
        rank = {"sent": 0, "accepted": 1}
        fits = [
            (rank[fit], -len(page.keys), len(frame.data) != page.dlc, i)
            for i, (_, page, _) in enumerate(ours)
            if (fit := _fit(page, frame))
        ]
        if not fits:
            return Refused(Refusal.UNKNOWN_CODE)
        name, page, node = ours[min(fits)[-1]]
        if self._node(page, frame, page.in_id) == ():
            return Refused(Refusal.UNKNOWN_ID)
        if len(frame.data) != page.dlc and not frame.remote:
            return Refused(Refusal.WRONG_LENGTH)
        rows = self._rows(page, parameters)
        refused = _refused_always(page, frame)
        if refused:
            return refused
        if isinstance(rows, Refused):
            return rows
        known = [row for row in rows if not row.is_parameter]
        if _has_wrong_constant(known, frame):
            return Refused(Refusal.WRONG_CONSTANT)
        if known != rows:
            return Refused(Refusal.MISSING_PARAMETER)
        holder = next((row for row in page.rows if row.holds_node and not row.has_low_bits), None)
        in_data = _raw(holder, frame) if holder and page.nodes is None else None
        return self._decoded(
            name,
            node[0] if in_data is None else in_data,
            [r for r in rows if r.constant is None and not r.checksum],
            frame,
            parameters,
        )

    def _decoded(
        self, name: str, node: int | None, rows: Sequence[FieldRow], frame: CanFrame, parameters: Parameters
    ) -> Decoded:
        raw: dict[str, Raw] = {}
        values: dict[str, Value] = {}
        for row in rows:
            integer = _raw(row, frame)
            value = self._value(row, integer, parameters)
            if row.index is None:
                raw[row.name] = integer
                if not isinstance(value, Refused):
                    values[row.name] = value
            else:
                raw[row.name] = [*raw.get(row.name, []), integer]  # type: ignore[misc]
                values[row.name] = [*values.get(row.name, []), value]  # type: ignore[misc]
        for row in rows:
            if _JOINED.search(row.raw):
                values[row.name] = _joined(row, raw[row.name])
        return Decoded(name, node, raw, values)

    def _value(self, row: FieldRow, raw: int, parameters: Parameters) -> Value | Refused:
        if row.type in self._members:
            names = self._members[row.type]
            if row.type in self._flags:
                return [name for name, bit in names.items() if raw >> bit & 1]
            return next((name for name, value in names.items() if value == raw), None)
        named = self._no_value(row, raw)
        if named is not None:
            return named
        scale = self._scale(row, parameters)
        if isinstance(scale, Refused):
            return None if scale.says is Refusal.NO_SCALE else scale
        if row.raw.startswith("f"):
            number = _float(row, raw)
            return float(Fraction(number) * scale.step + scale.offset) if math.isfinite(number) else number
        return float(raw * scale.step + scale.offset)

    def _no_value(self, row: FieldRow, raw: int) -> str | None:
        """The name for which a raw integer has no value."""
        is_nan = row.raw[0] == "f" and math.isnan(_float(row, raw))
        return next((n for n, raws in self._no_values.get(row.type, {}).items() if raw in raws or is_nan), None)

    def _scale(self, row: FieldRow, parameters: Parameters) -> Scale | Refused:
        case = self._case(row.scales, parameters)
        if case is None:
            return Refused(Refusal.MISSING_PARAMETER, row.name)
        scale = row.scales[case]
        if scale is None:
            return Refused(Refusal.NO_SCALE, row.name)
        above, _, below = scale.parameter.partition("/")
        names = [name for name in (*above.split("*"), below) if name]
        if any(name not in parameters for name in names):
            return Refused(Refusal.MISSING_PARAMETER, row.name)
        times = Fraction(1)
        for name in names:
            number = Fraction(str(parameters[name]))
            times = times / number if name == below else times * number
        return Scale(scale.step * times, scale.offset * times)

    def _case(self, cases: Mapping[str, object], parameters: Parameters) -> str | None:
        """The case that the parameters lead to."""
        if "" in cases:
            return ""
        return next((str(v) for n, v in parameters.items() if str(v) in cases and n in self._choices), None)

    def _rows(self, page: MessagePage, parameters: Parameters) -> list[FieldRow] | Refused:
        """The fields that are there under the parameters."""
        needed = {row.only[0] for row in page.rows if row.only[0]}
        if any(name not in parameters for name in needed):
            return Refused(Refusal.MISSING_PARAMETER)
        return [row for row in page.rows if not row.only[0] or str(parameters[row.only[0]]) in row.only[1]]

    @staticmethod
    def _node(page: MessagePage, frame: CanFrame, in_id: int) -> tuple[int | None, ...]:
        """The node of a frame, in a tuple; an empty one when the id is of no page with these bits of fields and keys."""
        if (page.extended, page.remote) != (frame.extended, frame.remote) or page.parameter:
            return ()
        rest = (frame.id & ~in_id) - page.base
        if page.nodes is None:
            return (None,) if rest == 0 else ()
        node, beside = divmod(rest, page.step)
        return (node,) if not beside and node in page.nodes else ()

    def encode_raw(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        raw: Mapping[str, Raw],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        if any(parameters.get(n, only[0]) not in only for n, only in self.message_of(direction, command).only.items()):
            raise Cannot("availability")
        page = self._messages[direction, command].at(parameters)
        if code is not None:
            first, *further = page.keys
            if code not in (first.value, *first.accepted):
                return Refused(Refusal.UNKNOWN_CODE)
            page = replace(page, keys=(replace(first, value=code), *further))
        encoded = self._encode(page, node, raw, parameters)
        if means_another(self.message_of(direction, command), encoded):
            raise Cannot("confusion")
        return encoded

    def _encode(
        self, page: MessagePage, node: int | None, raw: Mapping[str, Raw], parameters: Parameters
    ) -> CanFrame | Refused:
        rows = self._rows(page, parameters)
        if page.parameter and page.nodes is not None and node not in page.nodes:
            return Refused(Refusal.UNKNOWN_NODE)
        if page.parameter:
            return Refused(Refusal.MISSING_PARAMETER)
        if isinstance(rows, Refused):
            return rows
        if page.nodes is not None and node not in page.nodes:
            return Refused(Refusal.UNKNOWN_NODE)
        can_id, word = page.base + (node or 0) * page.step, 0
        parts = [(key.bits, key.value) for key in page.keys]
        seen: dict[str, int] = {}
        for row in (row for row in rows if not row.checksum):
            given = raw[row.name] if row.constant is None else row.constant
            integer = given[seen.get(row.name, 0)] if isinstance(given, list) else given
            seen[row.name] = seen.get(row.name, 0) + 1
            refusal = self._refusal(row, integer, parameters) if row.constant is None else None
            if refusal is not None:
                return Refused(refusal, row.name)
            parts.append((row.bits, integer))
        if any(row.is_parameter for row in rows):
            return Refused(Refusal.MISSING_PARAMETER)
        for bits, integer in parts:
            can_id, word = (can_id | bits.write(integer), word) if bits.in_id else (can_id, word | bits.write(integer))
        data = b"" if page.remote else word.to_bytes(page.dlc, "little")
        for row in (row for row in rows if row.checksum):
            assert row.checksum
            word |= row.bits.write(row.checksum.of(can_id, page.extended, data, row.bits))
            data = word.to_bytes(page.dlc, "little")
        return CanFrame(can_id, data, page.extended, page.remote)

    def _refusal(self, row: FieldRow, raw: int, parameters: Parameters) -> Refusal | None:
        is_float = row.raw[0] == "f" and self._no_value(row, raw) is None
        if is_float and not math.isfinite(_float(row, raw)):
            return Refusal.NOT_FINITE
        return None if self._allowed(row, raw, parameters) else Refusal.OUT_OF_RANGE

    def _allowed(self, row: FieldRow, raw: int, parameters: Parameters) -> bool:
        width = int(row.raw[1:].split()[0])
        low, high = (-(1 << width - 1), (1 << width - 1) - 1) if row.raw[0] == "i" else (0, (1 << width) - 1)
        if not low <= raw <= high:
            return False
        if row.type in self._members:
            values = self._members[row.type].values()
            return not raw & ~sum(1 << bit for bit in values) if row.type in self._flags else raw in values
        case = self._case(row.ranges, parameters)
        if case is None or self._no_value(row, raw) is not None:
            return True
        value = Fraction(raw)
        if row.raw[0] == "f":
            scale = self._scale(row, parameters)
            if isinstance(scale, Refused):
                return True
            value = Fraction(_float(row, raw)) * scale.step + scale.offset
        bottom, top = (end.at(parameters) for end in row.ranges[case])
        return (bottom is None or value >= bottom) and (top is None or value <= top)

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
        code: int | None = None,
    ) -> CanFrame | Refused:
        rows = self._rows(self._messages[direction, command], parameters)
        if isinstance(rows, Refused):
            return rows
        raw: dict[str, Raw] = {}
        for row in rows:
            if (
                row.constant is not None
                or row.checksum
                or (row.name in raw and (row.index is None or _JOINED.search(row.raw)))
            ):
                continue
            given = values[row.name]
            if _JOINED.search(row.raw):
                elements = _elements(row, given)
                if isinstance(elements, Refused):
                    return elements
                raw[row.name] = elements
                continue
            index = len(raw.get(row.name, [])) if row.index is not None else 0  # type: ignore[arg-type]
            is_array = row.index is not None and isinstance(given, list)
            integer = self._to_raw(row, given[index] if is_array else given, parameters)  # type: ignore[index]
            if isinstance(integer, Refused):
                return integer
            raw[row.name] = integer if row.index is None else [*raw.get(row.name, []), integer]  # type: ignore[misc]
        return self.encode_raw(direction, command, node, raw, parameters, code)

    def _to_raw(self, row: FieldRow, value: ExactValue, parameters: Parameters) -> int | Refused:
        if row.type in self._members and not isinstance(value, Fraction):
            names = self._members[row.type]
            return sum(1 << names[str(n)] for n in value) if isinstance(value, list) else names[value]
        named = self._no_values.get(row.type, {})
        if isinstance(value, str) and value in named:
            return (1 << int(row.raw[1:].split()[0]) - 1) - 1 if row.raw[0] == "f" else named[value][-1]
        if isinstance(value, str) and value in self._named.get(row.type, {}):
            return self._named[row.type][value]
        scale = self._scale(row, parameters)
        if isinstance(scale, Refused):
            return scale
        if value in ("nan", "inf", "-inf"):
            return Refused(Refusal.NOT_FINITE, row.name)
        assert isinstance(value, Fraction)
        if row.raw[0] == "f":
            return _float_bits(row, float((value - scale.offset) / scale.step))
        exact = (value - scale.offset) / scale.step
        size = math.floor(abs(exact) + Fraction(1, 2))
        nearest = size if exact >= 0 else -size
        return nearest if self._no_value(row, nearest) is None else Refused(Refusal.OUT_OF_RANGE, row.name)

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        sent = self._sent(request, parameters)
        if isinstance(sent, Refused):
            return sent
        name, node = sent
        refused = _refused_always(self._messages[Direction.REQUEST, name], request)
        if refused:
            return refused
        page = self._messages.get((Direction.REPLY, name))
        pages = [page, *(self._messages[Direction.REPLY, command] for command in page.others)] if page else []
        answers = [self._is_reply(name, node, page, each.at(parameters), request, reply) for each in pages if page]
        return None if any(answers) else Refused(Refusal.NOT_ANSWER)

    def _is_reply(
        self, name: str, node: int | None, first: MessagePage, page: MessagePage, request: CanFrame, reply: CanFrame
    ) -> bool:
        """Whether a frame is the reply of a page to the request of a command, whose `first` reply names the repliers."""
        from_node = self._node(page, reply, page.in_id)
        if from_node == () or not _fit(page, reply) or len(reply.data) != page.dlc:
            return False
        asked, told = _held(self._messages[Direction.REQUEST, name], request), _held(page, reply)
        to, bits = ((node, -1), asked or (node, -1))[1 if not first.from_each else 0]
        expected = first.from_each or ((to,) if to is not None else ())
        for source, has in ((from_node[0], -1), told or (None, 0)):
            if source is not None and expected and all((source ^ sender) & bits & has for sender in expected):
                return False
        return not page.is_echo or request.data == reply.data

    def _sent(self, frame: CanFrame, parameters: Parameters) -> tuple[str, int | None] | Refused:
        known = {name: page.at(parameters) for name, page in self._messages.items()}
        pages = sorted(known.items(), key=lambda entry: -len(entry[1].keys))
        for (direction, name), page in pages:
            if (
                direction is Direction.REQUEST
                and (node := self._node(page, frame, page.in_id)) != ()
                and _fit(page, frame)
            ):
                return name, node[0]
        is_open = any(page.parameter for (direction, _), page in pages if direction is Direction.REQUEST)
        return Refused(Refusal.MISSING_PARAMETER if is_open else Refusal.UNKNOWN_CODE)


def _integers(text: str) -> range:
    """`0xFE00..0xFEFF` or one of them; none for NaN."""
    if text == "NaN":
        return range(0)
    first, _, last = text.partition("..")
    return range(int(first, 0), int(last or first, 0) + 1)


_JOINED = re.compile(r"\((ascii|utf8_|bcd)(\d+)(?:, padding 0x([0-9A-F]{2}))?\)")
"""What the table says of a text, or of a number of decimal digits."""


def _joined(row: FieldRow, raw: Any) -> Value:
    kind, _, padding = _JOINED.search(row.raw).groups()  # type: ignore[union-attr]
    if kind == "bcd":
        return None if max(raw) > 9 else float("".join(map(str, raw)))
    content = bytes(raw[: raw.index(0)] if 0 in raw else raw)
    while content and content[-1] == int(padding or "00", 16):
        content = content[:-1]
    return str(content, "ascii" if kind == "ascii" else "utf-8", "replace")


def _elements(row: FieldRow, value: ExactValue) -> list[int] | Refused:
    kind, digits, padding = _JOINED.search(row.raw).groups()  # type: ignore[union-attr]
    count, refused = int(digits), Refused(Refusal.OUT_OF_RANGE, row.name)
    if kind == "bcd":
        if isinstance(value, str):
            return Refused(Refusal.NOT_FINITE, row.name)
        assert isinstance(value, Fraction)
        nearest = math.floor(abs(value) + Fraction(1, 2)) * (1 if value > 0 else -1)
        return [nearest // 10**place % 10 for place in range(count)][::-1] if 0 <= nearest < 10**count else refused
    try:
        content = str(value).encode("ascii" if kind == "ascii" else "utf-8")
    except UnicodeEncodeError:
        return refused
    end = int(padding or "00", 16)
    if len(content) > count or 0 in content or content.endswith(bytes([end])):
        return refused
    return [*content, *[end] * (count - len(content))]


def _held(page: MessagePage, frame: CanFrame) -> tuple[int, int] | None:
    """The node that a field of a frame holds, and which bits of it there are; None without such a field."""
    row = next((row for row in page.rows if row.holds_node), None)
    return None if row is None else (_raw(row, frame), (1 << len(row.bits.numbers)) - 1)


def _fit(page: MessagePage, frame: CanFrame) -> str:
    """Whether the selectors of a page are those of a frame: `sent`, `accepted`, or not at all."""
    fit = "sent"
    for key in page.keys:
        value = key.bits.read(frame.id, frame.data)
        if value != key.value:
            if value not in key.accepted:
                return ""
            fit = "accepted"
    return fit


def _refused_always(page: MessagePage, frame: CanFrame) -> Refused | None:
    """The reason against a frame whatever the parameters are: a constant or the checksum."""
    if _has_wrong_constant([row for row in page.rows if not row.only[0] and not row.is_parameter], frame):
        return Refused(Refusal.WRONG_CONSTANT)
    for row in page.rows:
        if row.checksum and _raw(row, frame) != row.checksum.of(frame.id, frame.extended, frame.data, row.bits):
            return Refused(Refusal.WRONG_CHECKSUM)
    return None


def _has_wrong_constant(rows: Sequence[FieldRow], frame: CanFrame) -> bool:
    return any(row.checked and row.constant is not None and _raw(row, frame) != row.constant for row in rows)


def _raw(row: FieldRow, frame: CanFrame) -> int:
    raw = row.bits.read(frame.id, frame.data)
    width = 1 + max(raw_bit for raw_bit, _ in row.bits.numbers)
    return raw - (1 << width) if row.raw[0] == "i" and raw >> width - 1 else raw


def _formats(row: FieldRow) -> tuple[str, str]:
    return ("<I", "<f") if re.match("f32", row.raw) else ("<Q", "<d")


def _float(row: FieldRow, raw: int) -> float:
    bits, number = _formats(row)
    value: float = struct.unpack(number, struct.pack(bits, raw))[0]
    return value


def _float_bits(row: FieldRow, value: float) -> int | Refused:
    bits, number = _formats(row)
    try:
        raw: int = struct.unpack(bits, struct.pack(number, value))[0]
    except OverflowError:
        return Refused(Refusal.OUT_OF_RANGE, row.name)
    return raw
