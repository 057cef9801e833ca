"""A picture of the bits of a frame, as SVG: a row a byte, bit 7 on the left."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ... import words
from ...model import Message, Space, Variant
from .text import xml

CELL, ROW, LEFT, TOP = 44, 34, 84, 26
_STYLE = (
    "text{font:12px ui-monospace,monospace;fill:#1f2328;text-anchor:middle;dominant-baseline:central}"
    ".n{fill:#59636e}.e{text-anchor:end}rect{stroke:#8b949e}.g{fill:#fff;stroke:none}.r{fill:#f6f8fa}.k{fill:#ffe8b3}.a{fill:#d3e8ff}.b{fill:#d8f3dc}"
    "@media(prefers-color-scheme:dark){text{fill:#e6edf3}.n{fill:#9198a1}rect{stroke:#6e7681}.g{fill:#0d1117;stroke:none}.r{fill:#161b22}"
    ".k{fill:#5c4400}.a{fill:#123a63}.b{fill:#15452a}}"
)


@dataclass(frozen=True)
class _Run:
    """Adjacent bits of one byte that belong together."""

    byte: int
    low: int
    width: int
    label: str
    style: str


def svg(message: Message, variant: Variant, title: str) -> str:
    """The data bytes of a frame with its fields; what no field covers is shown as reserved."""
    runs = list(_runs(message, variant))
    taken = {(r.byte, r.low + i) for r in runs for i in range(r.width)}
    width, height = LEFT + 8 * CELL + 8, TOP + message.dlc * ROW + 8
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f'role="img"><title>{xml(title)}</title><style>{_STYLE}</style>'
    ]
    parts.append(f'<rect class="g" x="0" y="0" width="{width}" height="{height}" rx="6"/>')
    parts += [f'<text class="n" x="{LEFT + (7 - b) * CELL + CELL // 2}" y="{TOP // 2}">{b}</text>' for b in range(8)]
    for byte in range(message.dlc):
        y = TOP + byte * ROW
        parts.append(f'<text class="n e" x="{LEFT - 10}" y="{y + ROW // 2}">DATA[{byte}]</text>')
        free = [bit for bit in range(8) if (byte, bit) not in taken]
        parts += [_box(_Run(byte, bit, 1, "0", "r")) for bit in free]
    parts += map(_box, runs)
    return "\n".join([*parts, "</svg>"]) + "\n"


def _runs(message: Message, variant: Variant) -> Iterator[_Run]:
    for key in message.keys:
        if key.space is Space.DATA:
            for s in key.segments:
                yield _Run(s.byte, s.low, s.width, f"0x{key.value:02X}", "k")
    places = [place for f in variant.fields if f.space is Space.DATA for place in words.elements(f)]
    for i, (name, segments) in enumerate(places):
        for s in segments:
            part = "" if len(segments) == 1 else f" [{s.raw_low + s.width - 1}:{s.raw_low}]"
            yield _Run(s.byte, s.low, s.width, name + part, "ab"[i % 2])


def _box(run: _Run) -> str:
    x, y, width = LEFT + (8 - run.low - run.width) * CELL, TOP + run.byte * ROW, run.width * CELL
    fitting = max(1, (width - 6) // 7)
    label = run.label if len(run.label) <= fitting else run.label[: max(1, fitting - 1)] + "…"
    return (
        f'<rect class="{run.style}" x="{x}" y="{y}" width="{width}" height="{ROW}"/>'
        f'<text x="{x + width // 2}" y="{y + ROW // 2}">{xml(label)}</text>'
    )
