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


class Probe:
    """The checks of the same bits: a number for each combination of their results."""

    def __init__(self, in_id: bool, parts: Parts) -> None:
        self.in_id = in_id
        self.checks: list[Check] = []
        self._parts = parts
        self._known: dict[int, int] = {}
        self._numbers: dict[tuple[Reason | None, ...], int] = {}
        ((shift, mask, _), *rest) = parts
        self._shift = shift
        self.width = mask.bit_length()
        self.start, self.end = shift // 8, (shift + self.width) // 8
        """The bytes, if it is an integer in whole bytes."""
        self.is_integer = not in_id and not rest and shift % 8 == 0 and self.width in _INTEGERS

    @functools.cached_property
    def limits(self) -> tuple[int, ...] | None:
        """The numbers at which a result changes; None if it depends on all bits."""
        steps = [check.steps for check in self.checks if check.steps is not None]
        if len(steps) < len(self.checks) or any(check.parts != self._parts for check in self.checks):
            return None
        return tuple(sorted({step for own in steps for step in own}))

    @functools.cached_property
    def table(self) -> bytes | None:
        """Numbers for all integers of at most 16 bits, equal ones for equal results; None if there are too many."""
        if self.limits is not None:
            return _table(self.limits, self.width) if self.width <= 16 and len(self.limits) < 256 else None
        return bytes(map(self.result, range(256))) if self.width == 8 else None

    def result_of(self, id_: int, data: bytes) -> int:
        """The number of the result for a frame."""
        return self.result(bits_at(self._parts, id_ if self.in_id else int.from_bytes(data, "little")))

    def result(self, bits: int) -> int:
        """The number of the result for these bits."""
        place = bits if self.limits is None else bisect_right(self.limits, bits)
        number = self._known.get(place)
        if number is None:
            reasons = tuple(
                check.reason(bits if check.parts == self._parts else bits_at(check.parts, bits << self._shift))
                for check in self.checks
            )
            number = self._numbers.setdefault(reasons, len(self._numbers))
            if len(self._known) < MAX_KNOWN:
                self._known[place] = number
        return number


def probes_of(forms: Iterable[Sequence[Check]]) -> list[Probe]:
    """The probes of all checks; those of bits within one byte are one probe."""
    probes: dict[tuple[bool, Parts], Probe] = {}
    for checks in forms:
        for check in checks:
            place = check.in_id, _whole_byte(check.parts)
            probes.setdefault(place, Probe(*place)).checks.append(check)
    return list(probes.values())


def _whole_byte(parts: Parts) -> Parts:
    """The byte that contains some bits; the bits themselves if they are in several."""
    ((shift, mask, _), *rest) = parts
    is_within = not rest and shift % 8 + mask.bit_length() <= 8
    return ((shift // 8 * 8, 0xFF, 0),) if is_within else parts


class Unpacker(NamedTuple):
    """A function that unpacks data into integers, and for each of these a mapping to results."""

    unpack: Callable[[bytes], tuple[Any, ...]]
    results: Sequence[Any]


def unpackers(probes: Sequence[Probe], length: int) -> list[Unpacker]:
    """Unpackers of data of a length for the probes of integers; several if their bytes overlap, at least one."""
    layers: list[list[_ByteRun]] = [[]]
    for part in _parts(probes):
        layer = next((known for known in layers if all(not part.overlaps(run) for run in known)), None)
        if layer is None:
            layers.append(layer := [])
        layer.append(part)
    return [_unpacker(layer, length) for layer in layers]


class _ByteRun(NamedTuple):
    """Consecutive bytes, the notation of `struct` for them, and their results."""

    start: int
    end: int
    notation: str
    results: Any

    def overlaps(self, run: _ByteRun) -> bool:
        return self.start < run.end and run.start < self.end


def _parts(probes: Sequence[Probe]) -> Iterator[_ByteRun]:
    """Integers, joined with checks of their bytes, and other bytes."""
    octets = {probe.start: probe for probe in probes if probe.width == 8}
    for probe in probes:
        if probe.width != 8:
            table = _with_octets(probe, octets) if probe.width == 16 else None
            yield _ByteRun(probe.start, probe.end, _INTEGERS[probe.width], table or _results(probe))
    for probe in octets.values():
        yield _ByteRun(probe.start, probe.end, "B", _results(probe))


def _with_octets(probe: Probe, octets: dict[int, Probe]) -> bytes | None:
    """The table of a probe of 16 bits, joined with those of its bytes, which are removed; None if it is too large."""
    own = [octets.get(at) for at in (probe.start, probe.start + 1)]
    joined = _joined(probe.table, *(octet and octet.table for octet in own)) if probe.table else None
    for octet in own if joined else ():
        if octet is not None:
            del octets[octet.start]
    return joined


def _unpacker(parts: Sequence[_ByteRun], length: int) -> Unpacker:
    """The unpacker of parts that do not overlap."""
    ordered = sorted(parts, key=lambda part: part.start)
    notation, at = "<", 0
    for part in ordered:
        notation += "x" * (part.start - at) + part.notation
        at = part.end
    return Unpacker(struct.Struct(notation + "x" * (length - at)).unpack, [part.results for part in ordered])


def _results(probe: Probe) -> Any:
    """A mapping of integers to results."""
    return probe.table or (_Results(probe) if probe.limits is None else _Spans(probe.limits))


class _Results(dict[int, int]):
    """The results of a probe by integer, remembered."""

    def __init__(self, probe: Probe) -> None:
        self._probe = probe

    def __missing__(self, bits: int) -> int:
        number = self._probe.result(bits)
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
def _joined(table: bytes, low: bytes | None, high: bytes | None) -> bytes | None:
    """A table of integers of 16 bits with the tables of their bytes: a number for each combination, if these fit a byte."""
    low, high = low or bytes(256), high or bytes(256)
    lows, highs = max(low) + 1, max(high) + 1
    if (max(table) + 1) * lows * highs > 256:
        return None
    blocks: dict[tuple[bytes, int], bytes] = {}
    for byte in range(256):
        own = table[byte << 8 : (byte + 1) << 8], high[byte]
        if own not in blocks:
            blocks[own] = bytes(
                (number * lows + low_number) * highs + own[1] for number, low_number in zip(own[0], low, strict=True)
            )
    return b"".join(blocks[table[byte << 8 : (byte + 1) << 8], high[byte]] for byte in range(256))
