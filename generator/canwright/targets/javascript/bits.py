"""JavaScript expressions that read and write bits of a frame, whose parts are `id` and `d`, the data."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ...model.layout import Segment, Space

_WORD = 32
"""The bits of an integer of shifts and masks."""
_NUMBER = 53
"""The bits of an exact number; a wider integer is a BigInt."""


def read(space: Space, segments: Iterable[Segment], width: int, length: int, signed: bool = False) -> str:
    """The raw integer in some segments of a frame of at least `length` data bytes; bytes beyond its data count as 0."""
    low, high = _words(segments)
    if width <= _WORD:
        return _word(space, low, width, length, signed)
    lower = in_parentheses(_word(space, low, _WORD, length, False)) if low else "0"
    higher = in_parentheses(_word(space, high, width - _WORD, length, signed))
    if width <= _NUMBER:
        return f"{higher} * 0x100000000 + {lower}"
    return f"(BigInt({higher}) << 32n) + BigInt({lower})"


def written(raw: str, width: int, segment: Segment) -> str:
    """The bits of a segment of a raw integer, at their position in their byte or in the id."""
    mask = f"0x{(1 << segment.width) - 1:X}"
    if width > _NUMBER:
        bits = f"Number({raw} >> {segment.raw_low}n & {mask}n)"
    elif not segment.raw_low:
        bits = f"{raw} & {mask}"
    elif width > _WORD:
        bits = f"Math.floor({raw} / 0x{1 << segment.raw_low:X}) & {mask}"
    else:
        bits = f"{raw} >>> {segment.raw_low} & {mask}"
    return f"({bits}) << {segment.low}" if segment.low else bits


def _words(segments: Iterable[Segment]) -> tuple[Sequence[Segment], Sequence[Segment]]:
    """The segments of the low 32 bits of a raw integer, and those of the high ones; what has bits of both is divided."""
    low: list[Segment] = []
    high: list[Segment] = []
    for s in segments:
        below = min(max(_WORD - s.raw_low, 0), s.width)
        if below:
            low.append(Segment(s.byte, s.low, below, s.raw_low))
        if below < s.width:
            high.append(Segment(s.byte, s.low + below, s.width - below, s.raw_low + below - _WORD))
    return low, high


def _word(space: Space, segments: Sequence[Segment], width: int, length: int, signed: bool) -> str:
    """An integer of at most 32 bits."""
    terms = list(_terms(space, segments, length))
    bits = " | ".join(terms)
    if signed and width < _WORD:
        return f"{in_parentheses(bits)} << {_WORD - width} >> {_WORD - width}"
    if not signed and any(s.raw_low + s.width == _WORD for s in segments):
        return f"{in_parentheses(bits)} >>> 0"
    return bits


def _terms(space: Space, segments: Sequence[Segment], length: int) -> Iterator[str]:
    for s in segments:
        bits = "id" if space is Space.ID else f"d[{s.byte}]"
        if s.low:
            bits += f" >>> {s.low}"
        if space is Space.ID or s.low + s.width < 8:
            bits += f" & 0x{(1 << s.width) - 1:X}"
        if s.raw_low:
            bits = f"{in_parentheses(bits)} << {s.raw_low}"
        elif " " not in bits and s.byte >= length:
            bits = f"({bits} | 0)"
        yield bits


def in_parentheses(expression: str) -> str:
    """An expression as an operand."""
    return f"({expression})" if " " in expression else expression
