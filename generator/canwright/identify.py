"""Which editions a recorded exchange fits.

No frame says the edition, so this looks for what an edition does not allow: ids, codes, lengths, reserved bits, names
and ranges. Where two editions explain a log alike, it says so.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from . import words
from .compare import Impact, Side, compare
from .interpret import CanFrame, has_id, is_message, node_of, raw_of, value_of, wrong_constants
from .model import Assignment, Direction, Edition, Field, Message, Space, Type, Variant

WEAK = 1
"""Unusual: a reserved byte that is not 0, a raw integer beyond its printed range."""
UNNAMED = 2
"""Flags without a name: drives set more than manuals tell."""
IMPLAUSIBLE = 3
"""A value that no working node reports."""
STRONG = 4
"""Not in this edition: an id, a code, a length, a name."""
LEAD = 3
"""How much more has to speak against every other edition before one is named."""
SHARE = Fraction(1, 20)
"""A reason that fewer of the frames of its kind give is taken for noise."""


@dataclass(frozen=True)
class Reason:
    """What speaks against an edition. `kind` are the frames among which it is counted."""

    points: int
    kind: str
    text: str


@dataclass(frozen=True)
class Evidence:
    """A reason, how many frames give it out of how many of their kind, and the first of them."""

    reason: Reason
    count: int
    among: int
    example: CanFrame


@dataclass(frozen=True)
class Candidate:
    """An edition, and all that speaks against it."""

    edition: Edition
    against: tuple[Evidence, ...]
    explained: int

    @property
    def score(self) -> int:
        return sum(e.reason.points for e in self.against if Fraction(e.count, e.among) >= SHARE)


@dataclass(frozen=True)
class Finding:
    """What there is to say of one node. `editions` are those that fit; one when it can be told.

    `tell` are commands whose replies would tell the editions that fit apart.
    """

    node: int | None
    frames: int
    candidates: tuple[Candidate, ...]
    editions: tuple[Edition, ...]
    tell: tuple[str, ...]


def identify(frames: Iterable[CanFrame], editions: Sequence[Edition]) -> tuple[list[Finding], int]:
    """What fits each node, and how many frames belong to no edition. All editions are of one family."""
    by_node: dict[int | None, list[CanFrame]] = {}
    foreign = 0
    for frame in frames:
        nodes = [node_of(m, frame) for e in editions for m in e.all_messages() if has_id(m, frame)]
        if nodes:
            by_node.setdefault(next((n for n in nodes if n is not None), None), []).append(frame)
        else:
            foreign += 1
    ordered = sorted(by_node.items(), key=lambda item: (item[0] is None, item[0] or 0))
    return [_finding(node, own, editions) for node, own in ordered], foreign


def _finding(node: int | None, frames: Sequence[CanFrame], editions: Sequence[Edition]) -> Finding:
    candidates = sorted((_candidate(edition, frames) for edition in editions), key=lambda c: c.score)
    best = candidates[0].score
    fitting = tuple(c.edition for c in candidates if c.score < best + LEAD)
    if best >= STRONG:
        fitting = ()
    return Finding(node, len(frames), tuple(candidates), fitting, _tell(fitting))


def _tell(fitting: Sequence[Edition]) -> tuple[str, ...]:
    """Commands whose replies differ between the editions that fit."""
    if len(fitting) < 2:
        return ()
    changes = [change for other in fitting[1:] for change in compare(fitting[0], other)]
    counts = Counter(
        name
        for change in changes
        if Side.RECEIVING in change.sides and change.impact is not Impact.SAFE and change.rule.id != "range-changed"
        for name in change.used_by
    )
    common = [{c.group for c in edition.commands} for edition in fitting]
    return tuple(name for name, _ in counts.most_common() if all(name in known for known in common))


def _candidate(edition: Edition, frames: Sequence[CanFrame]) -> Candidate:
    counts: dict[Reason, list[CanFrame]] = {}
    kinds: dict[str, int] = {}
    explained = 0
    for frame in frames:
        kind, reasons = best_reading(edition, frame)
        kinds[kind] = kinds.get(kind, 0) + 1
        explained += not reasons
        for reason in reasons:
            counts.setdefault(reason, []).append(frame)
    against = [Evidence(r, len(found), kinds[r.kind], found[0]) for r, found in counts.items()]
    against.sort(key=lambda e: (-e.reason.points, -e.count))
    return Candidate(edition, tuple(against), explained)


def best_reading(edition: Edition, frame: CanFrame) -> tuple[str, list[Reason]]:
    """What a frame is taken for in an edition, and what speaks against it: of all readings, the one with the least."""
    of_id = [m for m in edition.all_messages() if has_id(m, frame)]
    if not of_id:
        kind = f"0x{frame.id:X}"
        return kind, [Reason(STRONG, kind, f"{kind} is no id of this edition")]
    replies_first = sorted(of_id, key=lambda m: m.direction is Direction.REQUEST)
    readings = [
        (message.name, list(_against(message, variant, frame)))
        for message in replies_first
        if is_message(message, frame)
        for variant in message.layout.variants
    ]
    if readings:
        return min(readings, key=lambda reading: sum(reason.points for reason in reading[1]))
    kind = f"0x{frame.id:X} {frame.data[:1].hex().upper()}"
    code = f" that starts with {frame.data[:1].hex().upper()}" if frame.data else ""
    return kind, [Reason(STRONG, kind, f"it has no frame of {len(frame.data)} bytes{code} on 0x{frame.id:X}")]


def _against(message: Message, variant: Variant, frame: CanFrame) -> Iterator[Reason]:
    where = f"{message.direction.value} of {message.command}"
    for field in wrong_constants(variant, frame):
        yield Reason(STRONG, message.name, f"{where}: `{field.name}` is not {field.constant}")
    reserved = _reserved(message, variant, frame)
    if reserved:
        places = ", ".join(f"DATA[{byte}]" for byte in reserved)
        yield Reason(min(WEAK * len(reserved), STRONG), message.name, f"{where}: {places} should be 0")
    for field in variant.fields:
        if field.constant is None:
            yield from _field(message, where, field, frame)


def _reserved(message: Message, variant: Variant, frame: CanFrame) -> list[int]:
    """The bytes with a bit that is not 0 and that neither a key nor a field has."""
    known = {
        s.byte * 8 + s.low + i
        for k in message.keys
        if k.space is Space.DATA
        for s in k.segments
        for i in range(s.width)
    }
    known |= {bit for f in variant.fields if f.space is Space.DATA for e in f.elements for bit in e.bits}
    return [
        at for at, byte in enumerate(frame.data) if any(byte >> i & 1 and at * 8 + i not in known for i in range(8))
    ]


def _field(message: Message, where: str, field: Field, frame: CanFrame) -> Iterator[Reason]:
    found = raw_of(field, frame)
    for raw in found if isinstance(found, list) else [found]:
        type_, named = field.type, f"{where}: `{field.name}`"
        if type_.enum and all(member.value != raw for member in type_.enum):
            yield Reason(STRONG, message.name, f"{named} has a value without a name")
        elif type_.flags and raw & ~sum(1 << flag.value for flag in type_.flags):
            yield Reason(UNNAMED, message.name, f"{named} has bits without a name")
        elif not _is_plausible(type_, raw):
            limits = words.span(type_.plausible) if type_.plausible else ""
            unit = f" {type_.unit.symbol}" if type_.unit else ""
            yield Reason(IMPLAUSIBLE, message.name, f"{named} is not within a plausible {limits}{unit}")
        elif not _is_in_range(type_, raw):
            yield Reason(WEAK, message.name, f"{named} is beyond its range")


def _assignments(parameter: str | None, cases: Iterable[str]) -> list[Assignment]:
    return [{parameter: case} for case in cases] if parameter else [{}]


def _is_plausible(type_: Type, raw: int) -> bool:
    if type_.plausible is None:
        return True
    low, high = type_.plausible.low.constant, type_.plausible.high.constant
    values = [value_of(type_, raw, a) for a in _assignments(type_.linear.parameter, type_.linear.cases)]
    return any(not isinstance(value, Fraction) or low <= value <= high for value in values)


def _is_in_range(type_: Type, raw: int) -> bool:
    """Whether a raw integer is in the range under some parameter; one that a number decides is not judged."""
    spans = [type_.raw_range.at(a) for a in _assignments(type_.raw_range.parameter, type_.raw_range.cases)]
    return any(s is None or not s.is_constant or s.low.constant <= raw <= s.high.constant for s in spans)
