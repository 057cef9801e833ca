"""NumPy expressions that read the bits of fields and keys from arrays; the form is chosen at generation time.

`words` are the data bytes of each frame as little-endian integers of 64 bits, `ids` the ids.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...model.layout import Element, Field, Segment, Space
from ...model.message import BitRun
from ...model.types import Encoding, Type
from ...semantics.checksum import FrameByte

WORD_BITS = 64
"""The bits of the integers that contain the data."""
WORD_BYTES = WORD_BITS // 8
_VIEWED = (8, 16, 32, 64)
"""The widths that NumPy can read in place."""


def dtype(type_: Type) -> str:
    """The smallest integers of NumPy that have all raw values of a type."""
    size = next(width // 8 for width in _VIEWED if type_.width <= width)
    return f"{'i' if type_.encoding is Encoding.SIGNED else 'u'}{size}"


class FrameReads(NamedTuple):
    """The expressions for frames of some length: with one word a frame, `words` has one dimension, else two."""

    words: int

    @classmethod
    def of(cls, edition: Edition) -> FrameReads:
        """Those for the longest frame of an edition."""
        longest = max((message.dlc for message in edition.all_messages()), default=0)
        return cls(max(1, -(-longest // WORD_BYTES)))

    def field(self, field: Field) -> str:
        """The raw integers of a field; two dimensions for an array."""
        elements = [self._element(field, element) for element in field.elements]
        return f"stack({', '.join(elements)})" if field.is_array else elements[0]

    def key(self, key: BitRun) -> str:
        """The unsigned values of a key."""
        return self._in_place(key.segments, key.space, "u", key.width) or self._assembled(key.segments, key.space)

    def byte(self, byte: FrameByte) -> str:
        """The values of a byte of the frame."""
        return self._in_place(byte.segments, byte.space, "u", 8) or self._assembled(byte.segments, byte.space)

    def _element(self, field: Field, element: Element) -> str:
        is_signed = field.type.encoding is Encoding.SIGNED
        viewed = self._in_place(element.segments, field.space, "i" if is_signed else "u", field.type.width)
        if viewed:
            return viewed
        raw = self._assembled(element.segments, field.space)
        return f"signed({raw}, {field.type.width})" if is_signed else raw

    def _in_place(self, segments: Sequence[Segment], space: Space, kind: str, width: int) -> str:
        """A view of the data; empty for bits that are no aligned integer of a width that NumPy has."""
        size = width // 8
        if space is Space.ID or width not in _VIEWED or any(s.width != 8 for s in segments):
            return ""
        places = [s.byte for s in sorted(segments, key=lambda s: s.raw_low)]
        first = min(places)
        little, big = list(range(first, first + size)), list(range(first + size - 1, first - 1, -1))
        if first % size or places not in (little, big):
            return ""
        order = "" if size == 1 else "<" if places == little else ">"
        viewed = f'words.view("{order}{kind}{size}")'
        if self.words > 1:
            return f"{viewed}[:, {first // size}]"
        return viewed if size == WORD_BYTES else f"{viewed}[{first // size} :: {WORD_BYTES // size}]"

    def _assembled(self, segments: Sequence[Segment], space: Space) -> str:
        """Unsigned integers by shifts and masks, one for each run of bits that are adjacent in a word and in the integer."""
        parts = []
        for low, count, raw_low in _runs(segments):
            word, bit = divmod(low, WORD_BITS)
            source = "ids" if space is Space.ID else "words" if self.words == 1 else f"words[:, {word}]"
            shifted = f"{source} >> {bit}" if bit else source
            is_rest = space is Space.DATA and bit + count == WORD_BITS
            masked = shifted if is_rest else f"{shifted} & 0x{(1 << count) - 1:X}"
            parts.append(f"({masked}) << {raw_low}" if raw_low else masked)
        return parts[0] if len(parts) == 1 else " | ".join(f"({part})" for part in parts)


def _runs(segments: Sequence[Segment]) -> Iterator[tuple[int, int, int]]:
    """Lowest bit in the frame, width, and lowest bit in the integer; no run continues in another word."""
    run: tuple[int, int, int] | None = None
    for s in sorted(segments, key=lambda s: s.raw_low):
        low = s.byte * 8 + s.low
        if run and low % WORD_BITS and run[0] + run[1] == low and run[2] + run[1] == s.raw_low:
            run = (run[0], run[1] + s.width, run[2])
        else:
            if run:
                yield run
            run = (low, s.width, s.raw_low)
    if run:
        yield run
