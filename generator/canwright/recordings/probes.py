"""The results of all checks of a frame at once: its data are unpacked into integers, which are looked up."""

from __future__ import annotations

import functools
import struct
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from ..semantics.frame import Parts, bits_at
from .checks import Check, Reason

MAX_KNOWN = 1 << 12
"""The maximum number of results that are remembered of each probe."""
_INTEGERS = {8: "B", 16: "H", 32: "I", 64: "Q"}
"""The notation of `struct` for unsigned integers, by width."""


Unpack = Callable[[bytes], tuple[Any, ...]]


class Probe:
    """The checks of the same bits: a number for each combination of their results."""

    def __init__(self, in_id: bool, parts: Parts) -> None:
        self.in_id = in_id
        self.parts = parts
        self.checks: list[Check] = []
        ((shift, mask, _), *rest) = parts
        self.shift, self.width = shift, mask.bit_length()
        self.start, self.end = shift // 8, (shift + self.width) // 8
        """The bytes, if it is an integer in whole bytes."""
        self.is_integer = not in_id and not rest and shift % 8 == 0 and self.width in _INTEGERS

    @functools.cached_property
    def results(self) -> Any:
        """A mapping from the bits to the number of their result; bytes, if the integer has 8 or 16 bits."""
        steps = [check.steps for check in self.checks if check.steps is not None and check.parts == self.parts]
        if len(steps) < len(self.checks):
            results = _Results(self)
            return bytes(map(results.__getitem__, range(256))) if self.is_integer and self.width == 8 else results
        limits = tuple(sorted({step for own in steps for step in own}))
        has_table = self.is_integer and self.width <= 16 and len(limits) < 256
        return _table(limits, self.width) if has_table else _Spans(limits)

    def result_of(self, id_: int, data: bytes) -> int:
        """The number of the result for a frame."""
        number: int = self.results[bits_at(self.parts, id_ if self.in_id else int.from_bytes(data, "little"))]
        return number


class Probes:
    """All probes of frames of a length; those of bits within one byte are one probe.

    `unpack` unpacks the data into integers, each of which has a mapping to `results`; `others` are read one by one.
    """

    def __init__(self, forms: Iterable[Sequence[Check]], length: int) -> None:
        probes: dict[tuple[bool, Parts], Probe] = {}
        for checks in forms:
            for check in checks:
                place = check.in_id, _whole_byte(check.parts)
                probes.setdefault(place, Probe(*place)).checks.append(check)
        unpacked = [probe for probe in probes.values() if probe.is_integer and probe.end <= length]
        self.others = [probe for probe in probes.values() if probe not in unpacked]
        layers: list[list[_Integer]] = []
        """Integers that do not overlap; the data is unpacked once for each layer."""
        for integer in sorted(_integers(unpacked)):
            free = next((layer for layer in layers if layer[-1].end <= integer.start), None)
            if free is None:
                layers.append([integer])
            else:
                free.append(integer)
        unpack = struct.Struct("<" + "".join(_notation(layer, length) for layer in layers)).unpack
        times = len(layers)
        self.unpack: Unpack = unpack if times == 1 else lambda data: unpack(data * times)
        self.results: list[Any] = [integer.results for layer in layers for integer in layer]


def _whole_byte(parts: Parts) -> Parts:
    """The byte that contains some bits; the bits themselves if they are in several."""
    ((shift, mask, _), *rest) = parts
    is_within = not rest and shift % 8 + mask.bit_length() <= 8
    return ((shift // 8 * 8, 0xFF, 0),) if is_within else parts


class _Integer(NamedTuple):
    """Consecutive bytes that are read as one integer, and the numbers of its results."""

    start: int
    end: int
    results: Any


def _integers(probes: Sequence[Probe]) -> Iterator[_Integer]:
    """The integers of probes; one of 16 bits is joined with its bytes if the results of both fit a table."""
    octets = {probe.start: probe for probe in probes if probe.width == 8}
    for probe in probes:
        if probe.width != 8:
            own = [octets[at].results if at in octets else bytes(256) for at in (probe.start, probe.start + 1)]
            joined = _joined(probe.results, *own) if isinstance(probe.results, bytes) else None
            yield _Integer(probe.start, probe.end, joined or probe.results)
            for at in (probe.start, probe.start + 1) if joined else ():
                octets.pop(at, None)
    yield from (_Integer(probe.start, probe.end, probe.results) for probe in octets.values())


def _notation(layer: Sequence[_Integer], length: int) -> str:
    """The notation of `struct` for data of a length, in which the bytes between the integers are skipped."""
    ends = [0, *(integer.end for integer in layer)]
    parts = [f"{own.start - end}x{_INTEGERS[8 * (own.end - own.start)]}" for own, end in zip(layer, ends, strict=False)]
    return "".join(parts) + f"{length - ends[-1]}x"


class _Results(dict[int, int]):
    """The results of a probe by integer, remembered."""

    def __init__(self, probe: Probe) -> None:
        self._probe = probe
        self._numbers: dict[tuple[Reason | None, ...], int] = {}

    def __missing__(self, bits: int) -> int:
        parts, shift = self._probe.parts, self._probe.shift
        reasons = tuple(
            check.reason(bits if check.parts == parts else bits_at(check.parts, bits << shift))
            for check in self._probe.checks
        )
        number = self._numbers.setdefault(reasons, len(self._numbers))
        if len(self) < MAX_KNOWN:
            self[bits] = number
        return number


class _Spans:
    """The number of limits up to an integer."""

    def __init__(self, limits: Sequence[int]) -> None:
        self._limits = limits

    def __getitem__(self, bits: int) -> int:
        return bisect_right(self._limits, bits)


@functools.lru_cache(maxsize=64)
def _table(limits: tuple[int, ...], width: int) -> bytes:
    """The number of limits up to each integer of a width."""
    ends = [0, *limits, 1 << width]
    return b"".join(bytes([number]) * (end - start) for number, (start, end) in enumerate(pairwise(ends)))


@functools.lru_cache(maxsize=64)
def _joined(table: bytes, low: bytes, high: bytes) -> bytes | None:
    """A table of integers of 16 bits with the tables of their bytes: a number for each combination, if these fit a byte."""
    lows, highs = max(low) + 1, max(high) + 1
    if (max(table) + 1) * lows * highs > 256:
        return None

    @functools.cache
    def block(numbers: bytes, of_high: int) -> bytes:
        return bytes((number * lows + of_low) * highs + of_high for number, of_low in zip(numbers, low, strict=True))

    return b"".join(block(table[byte << 8 : (byte + 1) << 8], high[byte]) for byte in range(256))
