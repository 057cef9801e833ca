"""A picture of the bits of a frame, as SVG: a row a byte, bit 7 on the left."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model import formatting
from ...model.layout import Segment, Space, Variant
from ...model.message import IdRule, Message
from ...templating.markup import xml

CELL, ROW, LEFT, TOP = 44, 34, 96, 26
_STYLE = (
    "text{font:12px ui-monospace,monospace;fill:#1f2328;text-anchor:middle;dominant-baseline:central}"
    ".n{fill:#59636e}.e{text-anchor:end}rect{stroke:#8b949e}.g{fill:#fff;stroke:none}.r{fill:#f6f8fa}.k{fill:#ffe8b3}.a{fill:#d3e8ff}.b{fill:#d8f3dc}"
    "@media(prefers-color-scheme:dark){text{fill:#e6edf3}.n{fill:#9198a1}rect{stroke:#6e7681}.g{fill:#0d1117;stroke:none}.r{fill:#161b22}"
    ".k{fill:#5c4400}.a{fill:#123a63}.b{fill:#15452a}}"
)


class _Run(NamedTuple):
    """Adjacent bits of one row with one label."""

    row: int
    low: int
    width: int
    label: str
    style: str


class _Row(NamedTuple):
    """Up to eight bits: a byte of the data, or a part of the id. `rest` has the values of unassigned bits."""

    title: str
    width: int
    rest: int


class Drawing(NamedTuple):
    """A picture without its title, the only part that depends on the language."""

    size: str
    body: str
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
        """Runs by variant, which many messages share, and number of id rows above it."""

    def drawing(self, message: Message, variant: Variant) -> Drawing:
        """The frame of a message under some parameter values."""
        id_rows = _id_rows(message, variant)
        key = (variant, len(id_rows))
        if key not in self._fields:
            self._fields[key] = tuple(_fields(variant, len(id_rows)))
        return _drawn(id_rows, message.dlc, (*_keys(message, len(id_rows)), *self._fields[key]))


@functools.lru_cache(maxsize=1 << 10)
def _drawn(id_rows: tuple[_Row, ...], dlc: int, runs: tuple[_Run, ...]) -> Drawing:
    """A picture, which many commands and most editions share."""
    rows = (*id_rows, *(_Row(f"DATA[{byte}]", 8, 0) for byte in range(dlc)))
    taken = {(run.row, run.low + i) for run in runs for i in range(run.width)}
    free = [[bit for bit in range(row.width) if (i, bit) not in taken] for i, row in enumerate(rows)]
    width, height = LEFT + 8 * CELL + 8, TOP + len(rows) * ROW + 8
    parts = [f'<rect class="g" x="0" y="0" width="{width}" height="{height}" rx="6"/>']
    parts += [f'<text class="n" x="{LEFT + (7 - b) * CELL + CELL // 2}" y="{TOP // 2}">{b}</text>' for b in range(8)]
    for i, row in enumerate(rows):
        parts.append(f'<text class="n e" x="{LEFT - 10}" y="{TOP + i * ROW + ROW // 2}">{row.title}</text>')
        parts += [_box(_Run(i, bit, 1, str(row.rest >> bit & 1), "r")) for bit in free[i]]
    parts += map(_box, runs)
    size = f'viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
    return Drawing(size, "\n".join(parts), any(free[len(id_rows) :]))


def _id_rows(message: Message, variant: Variant) -> tuple[_Row, ...]:
    """The id from its upper bits down, eight to a row; empty if the id contains only base and node."""
    if Space.ID not in {*(key.space for key in message.keys), *(field.space for field in variant.fields)}:
        return ()
    width, base = (29 if message.id.extended else 11), message.id.base
    lows = reversed(range(0, width, 8))
    return tuple(_Row(f"id {min(low + 8, width) - 1}..{low}", min(8, width - low), base >> low & 0xFF) for low in lows)


def _keys(message: Message, id_rows: int) -> Iterator[_Run]:
    for key in message.keys:
        yield from _places(key.space, key.segments, f"0x{key.value:02X}", "k", id_rows)
    if id_rows and message.id.nodes is not None:
        yield from _places(Space.ID, [_node(message.id, message.id.nodes)], "node", "k", id_rows)


def _fields(variant: Variant, id_rows: int) -> Iterator[_Run]:
    places = [(f.space, name, segments) for f in variant.fields for name, segments in formatting.elements(f)]
    for i, (space, name, segments) in enumerate(places):
        yield from _places(space, segments, name, "ab"[i % 2], id_rows)


def _node(rule: IdRule, nodes: range) -> Segment:
    """The bits of the id that depend on the node."""
    low = (rule.node_step & -rule.node_step).bit_length() - 1
    return Segment(0, low, max(1, (nodes[-1] * rule.node_step).bit_length() - low), 0)


def _places(space: Space, segments: Sequence[Segment], label: str, style: str, id_rows: int) -> Iterator[_Run]:
    """The runs of segments; if there are several, each label states its raw bits."""
    found = []
    for s in segments:
        bit, end = s.low, s.low + s.width
        while bit < end:
            width = min(end, bit // 8 * 8 + 8) - bit
            row = id_rows - 1 - bit // 8 if space is Space.ID else id_rows + s.byte
            found.append((row, bit % 8, width, s.raw_low + bit - s.low))
            bit += width
    for row, low, width, raw_low in found:
        part = "" if len(found) == 1 else f" [{raw_low + width - 1}:{raw_low}]"
        yield _Run(row, low, width, label + part, style)


def _box(run: _Run) -> str:
    x, y, width = LEFT + (8 - run.low - run.width) * CELL, TOP + run.row * ROW, run.width * CELL
    fitting = max(1, (width - 6) // 7)
    label = run.label if len(run.label) <= fitting else run.label[: max(1, fitting - 1)] + "…"
    return (
        f'<rect class="{run.style}" x="{x}" y="{y}" width="{width}" height="{ROW}"/>'
        f'<text x="{x + width // 2}" y="{y + ROW // 2}">{xml(label)}</text>'
    )
