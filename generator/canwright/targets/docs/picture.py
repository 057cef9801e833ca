"""A picture of a frame, as SVG: a row for each byte or for a field of whole bytes, bits only where a byte is divided."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model import formatting
from ...model.layout import Segment, Space, Variant
from ...model.message import IdRule, Message
from ...templating.markup import xml

LEFT, CELL, ROW, MORE, TOP = 88, 33, 30, 10, 22
"""Widths of the names of rows and of a bit; heights of a byte, of each further byte, and of the numbers of bits."""
_LETTER = 8
_STYLE = (
    "text{font:14px ui-monospace,monospace;fill:#1f2328;text-anchor:middle;dominant-baseline:central}"
    ".n{fill:#59636e;font-size:12px}.e{text-anchor:end}rect{stroke:#8b949e}.g{fill:#fff;stroke:none}.r{fill:#f6f8fa}"
    ".k{fill:#ffe8b3}.a{fill:#d3e8ff}.b{fill:#d8f3dc}"
    "@media(prefers-color-scheme:dark){text{fill:#e6edf3}.n{fill:#9198a1}rect{stroke:#6e7681}"
    ".g{fill:#0d1117;stroke:none}.r{fill:#161b22}.k{fill:#5c4400}.a{fill:#123a63}.b{fill:#15452a}}"
)


class _Run(NamedTuple):
    """Adjacent bits of one byte with one label. `name` is that of the key or the field."""

    byte: int
    low: int
    width: int
    name: str
    label: str
    style: str
    raw_low: int = 0


class _Byte(NamedTuple):
    """Up to eight bits: a byte of the data, or a part of the id. `rest` has the values of unassigned bits."""

    title: str
    width: int
    rest: int


class Drawing(NamedTuple):
    """A picture without its title."""

    size: str
    body: str
    has_fields: bool
    has_free_bits: bool
    """Whether some data bit belongs to no key and to no field."""

    def svg(self, title: str) -> str:
        """The picture, with a title in SVG."""
        head = f'<svg xmlns="http://www.w3.org/2000/svg" {self.size} role="img"><title>{title}</title>'
        return f"{head}<style>{_STYLE}</style>\n{self.body}\n</svg>\n"


class Drawings:
    """Draws frames with their fields: the id if it contains keys or fields, and the data bytes."""

    def __init__(self) -> None:
        self._fields: dict[tuple[Variant, int], tuple[_Run, ...]] = {}
        """Runs by variant, which many messages share, and number of parts of the id above it."""

    def drawing(self, message: Message, variant: Variant) -> Drawing:
        parts = _id_parts(message, variant)
        key = (variant, len(parts))
        if key not in self._fields:
            self._fields[key] = tuple(_fields(variant, len(parts)))
        return _drawn(parts, message.dlc, tuple(_keys(message, len(parts))), self._fields[key])


@functools.lru_cache(maxsize=1 << 10)
def _drawn(parts: tuple[_Byte, ...], dlc: int, keys: tuple[_Run, ...], fields: tuple[_Run, ...]) -> Drawing:
    """A picture, which many commands and most editions share."""
    listed = (*parts, *(_Byte(f"DATA[{byte}]", 8, 0) for byte in range(dlc)))
    runs = (*keys, *fields)
    taken = {(run.byte, run.low + i) for run in runs for i in range(run.width)}
    free = [[bit for bit in range(byte.width) if (i, bit) not in taken] for i, byte in enumerate(listed)]
    rows = list(_rows(listed, runs, free))
    ruler = any(row.cells for row in rows)
    y, body = TOP if ruler else 8, []
    if ruler:
        body += [
            f'<text class="n" x="{LEFT + (7 - b) * CELL + CELL // 2}" y="{TOP // 2 + 1}">{b}</text>' for b in range(8)
        ]
    for row in rows:
        height = ROW + MORE * min(row.span - 1, 3)
        body.append(f'<text class="n e" x="{LEFT - 8}" y="{y + height // 2}">{row.title}</text>')
        body += [_box(run, y, height) for run in row.cells or [row.whole]]
        y += height
    width = LEFT + 8 * CELL + 4
    frame = f'<rect class="g" x="0" y="0" width="{width}" height="{y + 8}" rx="6"/>'
    size = f'viewBox="0 0 {width} {y + 8}" width="{width}" height="{y + 8}"'
    return Drawing(size, "\n".join([frame, *body]), bool(fields), any(free[len(parts) :]))


class _Row(NamedTuple):
    """A row of a picture: `span` whole bytes with one label, or one byte divided into `cells`."""

    title: str
    span: int
    whole: _Run
    cells: Sequence[_Run]


def _rows(listed: Sequence[_Byte], runs: Sequence[_Run], free: Sequence[Sequence[int]]) -> Iterator[_Row]:
    """Neighbouring bytes of one field, or without any, share a row."""
    of_byte = [[run for run in runs if run.byte == i] for i in range(len(listed))]
    i = 0
    while i < len(listed):
        byte, here = listed[i], of_byte[i]
        is_whole = len(here) == 1 and here[0].width == 8
        is_free = not here and byte.width == 8 and byte.title.startswith("DATA")
        end = i + 1
        if is_whole or is_free:
            while end < len(listed) and _continues(here, of_byte[end], end - i, listed[end]):
                end += 1
            label = (here[0].name if end > i + 1 else here[0].label) if here else "0"
            style = here[0].style if here else "r"
            yield _Row(_title(listed[i:end]), end - i, _Run(i, 0, 8, label, label, style), ())
        else:
            rest = [_Run(i, bit, 1, "", str(byte.rest >> bit & 1), "r") for bit in free[i]]
            yield _Row(byte.title, 1, _Run(i, 0, 8, "", "", ""), [*here, *rest])
        i = end


def _continues(first: Sequence[_Run], here: Sequence[_Run], distance: int, byte: _Byte) -> bool:
    """Whether a byte has the next eight bits of the same little-endian field, or is free as the first one."""
    if not first or not here:
        return not first and not here and byte.title.startswith("DATA")
    run = here[0]
    same = (run.name, run.raw_low) == (first[0].name, first[0].raw_low + 8 * distance)
    return len(here) == 1 and run.width == 8 and run.style != "k" and same


def _title(listed: Sequence[_Byte]) -> str:
    first, last = listed[0].title, listed[-1].title
    return first if first == last else f"{first[:-1]}..{last[5:]}"


def _id_parts(message: Message, variant: Variant) -> tuple[_Byte, ...]:
    """The id from its upper bits down, eight to a row; empty if the id contains only base and node."""
    if Space.ID not in {*(key.space for key in message.keys), *(field.space for field in variant.fields)}:
        return ()
    width, base = (29 if message.id.extended else 11), message.id.base
    lows = reversed(range(0, width, 8))
    return tuple(_Byte(f"id {min(low + 8, width) - 1}..{low}", min(8, width - low), base >> low & 0xFF) for low in lows)


def _keys(message: Message, parts: int) -> Iterator[_Run]:
    for key in message.keys:
        yield from _places(key.space, key.segments, f"0x{key.value:02X}", "k", parts)
    rule = message.id
    if parts and rule.parameter is not None:
        last = (1 << 29 if rule.extended else 1 << 11) - 1
        low = (rule.parameter_step & -rule.parameter_step).bit_length() - 1
        above = [bit for bit in range(low, last.bit_length()) if message.id_mask >> bit & 1]
        free = range(low, min(above, default=last.bit_length()))
        of_node = _node(rule, rule.nodes) if rule.nodes is not None else None
        own = [bit for bit in free if of_node is None or not of_node.low <= bit < of_node.low + of_node.width]
        ends = [bit for i, bit in enumerate(own) if bit == own[0] + i]
        yield from _places(Space.ID, [Segment(0, ends[0], len(ends), 0)] if ends else [], rule.parameter, "k", parts)
    if parts and message.id.nodes is not None:
        yield from _places(Space.ID, [_node(message.id, message.id.nodes)], "node", "k", parts)


def _fields(variant: Variant, parts: int) -> Iterator[_Run]:
    places = [(f.space, name, segments) for f in variant.fields for name, segments in formatting.elements(f)]
    for i, (space, name, segments) in enumerate(places):
        yield from _places(space, segments, name, "ab"[i % 2], parts)


def _node(rule: IdRule, nodes: range) -> Segment:
    """The bits of the id that depend on the node."""
    low = (rule.node_step & -rule.node_step).bit_length() - 1
    return Segment(0, low, max(1, (nodes[-1] * rule.node_step).bit_length() - low), 0)


def _places(space: Space, segments: Sequence[Segment], name: str, style: str, parts: int) -> Iterator[_Run]:
    """The runs of segments; if there are several, each label states its raw bits."""
    runs = []
    for s in segments:
        bit, end = s.low, s.low + s.width
        while bit < end:
            width = min(end, bit // 8 * 8 + 8) - bit
            byte = parts - 1 - bit // 8 if space is Space.ID else parts + s.byte
            runs.append((byte, bit % 8, width, s.raw_low + bit - s.low))
            bit += width
    for byte, low, width, raw_low in runs:
        part = "" if len(runs) == 1 else f" [{raw_low + width - 1}:{raw_low}]"
        yield _Run(byte, low, width, name, name + part, style, raw_low)


def _box(run: _Run, y: int, height: int) -> str:
    x, width = LEFT + (8 - run.low - run.width) * CELL, run.width * CELL
    fitting = max(1, (width - 6) // _LETTER)
    label = run.label
    if len(label) > fitting:  # the raw bits alone, else the start of the name
        bits = label[len(run.name) + 1 :]
        label = bits if 0 < len(bits) <= fitting else label[: max(1, fitting - 1)] + "…"
    return (
        f'<rect class="{run.style}" x="{x}" y="{y}" width="{width}" height="{height}"/>'
        f'<text x="{x + width // 2}" y="{y + height // 2}">{xml(label)}</text>'
    )
