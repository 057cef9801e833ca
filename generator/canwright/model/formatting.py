"""Numbers, ranges, positions and conditions as text; the same in every output."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple, Protocol, TypeVar

from .checksum import Arithmetic, ConstantBytes, DataBytes, Input
from .layout import (
    ChecksumRole,
    Field,
    Segment,
    Space,
    is_one_run,
    runs_of,
)
from .message import Command, FrameSequence, IdRule, Key
from .metadata import Effect, FrameFormat
from .sending import Occasion, Sending
from .types import PI, Assignment, Bound, Encoding, Linear, NoValue, Order, Parameter, Range, Text, Type

MAX_DIGITS = 24
"""So many characters of a number are read before it is rounded."""


def exact(number: Fraction) -> str:
    """A decimal of at most fifteen decimal places, else a quotient: `0.01`, `1/3`; a multiple of π as `2*π/65535`."""
    if number.denominator == 1:
        return str(number.numerator)
    turns = number / PI
    if _is_shorter(turns, number):
        divisor = f"/{turns.denominator}" if turns.denominator > 1 else ""
        return multiple(str(turns.numerator), "π") + divisor
    scaled, rest = divmod(abs(number.numerator) * 10**15, number.denominator)
    if rest:
        return f"{number.numerator}/{number.denominator}"
    digits = f"{scaled:016d}"
    sign = "-" if number.numerator < 0 else ""
    return f"{sign}{digits[:-15]}.{digits[-15:]}".rstrip("0")


def with_ascii_pi(text: str) -> str:
    """A text with `pi` instead of `π`, for files in ASCII."""
    return text.replace("π", "pi")


def _is_shorter(first: Fraction, second: Fraction) -> bool:
    """Whether a fraction has smaller numbers than another one."""
    sizes = (abs(f.numerator) * f.denominator for f in (first, second))
    return next(sizes) < next(sizes)


def constant(raw: int) -> str:
    """A constant in the notation of codes; a negative one as a decimal."""
    return f"0x{raw:02X}" if raw >= 0 else str(raw)


def raws(listed: range) -> str:
    """A raw integer or a range of them in the notation of constants: `0xFF`, `0xFF00..0xFFFF`."""
    ends = dict.fromkeys((listed[0], listed[-1]))
    return "..".join(map(constant, ends) if listed[0] >= 0 else map(str, ends))


def no_value(named: NoValue) -> str:
    """The raw integers of a name for no value: `0xFF`, `0xFF00..0xFFFF`, `NaN`."""
    return "NaN" if named.is_nan else raws(named.raws)


def decimal(number: Fraction) -> str:
    """A decimal; one of at most six significant digits after `≈` where that is rounded: `0.01`, `≈0.333333`."""
    written = exact(number)
    return written if "/" not in written and len(written) <= MAX_DIGITS else f"≈{float(number):.6g}"


def counted(count: int, noun: str) -> str:
    """`1 frame`, `2 frames`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def cited(section: str, name: str) -> str:
    """A section of the manual with the name that is printed there, or one of both."""
    return ", ".join(part for part in (section, name) if part)


def spoken(name: str) -> str:
    """The title of an item without one, from its name: `read_level` is `Read level`."""
    return name.replace("_", " ").capitalize()


def english(text: Text) -> str:
    """The English text, or the first there is."""
    return text.get("en") or next(iter(text.values()), "")


def multiple(number: str, parameter: str | None) -> str:
    """A number as a factor of a parameter: `2/65535*size`, `-size`; without a parameter the number itself."""
    if parameter is None:
        return number
    if parameter.startswith("/"):
        return number + parameter
    return {"1": parameter, "-1": f"-{parameter}"}.get(number, f"{number}*{parameter}")


def bound(end: Bound, written: Callable[[Fraction], str] = exact) -> str:
    """A bound of a range: `2048` or `100*size-1`."""
    if end.parameter is None:
        return written(end.constant)
    tail = f"{'+' if end.constant > 0 else '-'}{written(abs(end.constant))}" if end.constant else ""
    return multiple(written(end.coefficient), end.parameter) + tail


def step(linear: Linear) -> str:
    """The resolution (1 LSB) without its unit, as written in the spec: `33/2048`."""
    return multiple(linear.printed or exact(linear.scale), linear.times)


def parameter_value(value: str | Fraction) -> str:
    """The value of a parameter: the name of a choice, or an exact number."""
    return exact(value) if isinstance(value, Fraction) else value


def parameter_values(assignment: Assignment) -> dict[str, str]:
    """The values of parameters by name, as text."""
    return {name: parameter_value(value) for name, value in assignment.items()}


def offset(linear: Linear, written: Callable[[Fraction], str] = exact) -> str:
    """The value of raw 0, without its unit."""
    return multiple(written(linear.offset), linear.times if linear.offset else None)


def span(limits: Range, written: Callable[[Fraction], str] = exact) -> str:
    """`-2048..2048`."""
    return f"{bound(limits.low, written)}..{bound(limits.high, written)}"


def in_unit(limits: Range, linear: Linear) -> Range:
    """The range of the values of a range of raw integers."""

    def value(end: Bound) -> Bound:
        worth = end.constant * linear.scale + linear.offset
        if linear.times is not None and worth:
            return Bound(Fraction(0), worth, linear.times)
        return Bound(worth, end.coefficient * linear.scale, end.parameter)

    low, high = value(limits.low), value(limits.high)
    return Range(low, high) if linear.scale > 0 else Range(high, low)


def allowed(parameter: Parameter) -> str:
    """The allowed values of a number parameter: `1..9`, `1 or more`, `9 or less`; empty for any."""
    low, high = parameter.minimum, parameter.maximum
    if low is not None and high is not None:
        return f"{exact(low)}..{exact(high)}"
    return f"{exact(low)} or more" if low is not None else f"{exact(high)} or less" if high is not None else ""


_LETTERS = {Encoding.UNSIGNED: "u", Encoding.SIGNED: "i", Encoding.FLOAT: "f"}


class PlaceWords(NamedTuple):
    """The words of positions and raw formats."""

    id: str = "id"
    bit: str = "bit"
    bits: str = "bits"
    big_endian: str = "big-endian"


ENGLISH = PlaceWords()


class SendingWords(NamedTuple):
    """The words of occasions and times of frames."""

    every: str = "every {} ms"
    cyclic: str = "cyclic"
    on_change: str = "on change"
    on_request: str = "on request"
    event: str = "on an event"
    timeout: str = "time-out {} ms"
    comma: str = ", "


ENGLISH_SENDING = SendingWords()


class ReplyWords(NamedTuple):
    """The words of several replies, and of a message in several frames."""

    further: str = "then the reply of {}"
    alternative: str = "or instead the reply of {}"
    frames: str = "several frames, in any order: `{}` is {}"
    comma: str = ", "


ENGLISH_REPLIES = ReplyWords()

W = TypeVar("W", PlaceWords, SendingWords, ReplyWords)


def words_of(kind: type[W], texts: Mapping[str, str], prefix: str) -> W:
    """The words among texts whose names start with `prefix` and `_`."""
    return kind(*(texts[f"{prefix}_{name}"] for name in kind._fields))


def further_replies(command: Command, words: ReplyWords = ENGLISH_REPLIES) -> Iterator[str]:
    """The replies besides the first one: `then the reply of serial_2`, `or instead the reply of abort`."""
    for text, replies in ((words.further, command.further_replies), (words.alternative, command.alternative_replies)):
        if replies:
            yield text.format(words.comma.join(reply.message.command for reply in replies))


def frame_numbers(sequence: FrameSequence, words: ReplyWords = ENGLISH_REPLIES) -> str:
    """The numbers of the frames of a message: `several frames, in any order: part is 1..3`."""
    return words.frames.format(sequence.field, f"{sequence.numbers[0]}..{sequence.numbers[-1]}")


def sending(of: Sending, words: SendingWords = ENGLISH_SENDING) -> str:
    """When a frame is sent: `every 100 ms, on request, time-out 500 ms`."""
    texts = {occasion: getattr(words, occasion.value) for occasion in of.occasions}
    if of.every_ms is not None:
        texts[Occasion.CYCLIC] = words.every.format(exact(of.every_ms))
    timeout = [] if of.timeout_ms is None else [words.timeout.format(exact(of.timeout_ms))]
    return words.comma.join([*texts.values(), *timeout])


class Place(NamedTuple):
    """Where the bits of a key or of an element of a field are; a key has no name."""

    position: str
    name: str
    raw: str


def key_place(key: Key, words: PlaceWords = ENGLISH) -> Place:
    """The place of a key."""
    order = f" {words.big_endian}" if key.order is Order.BIG and len(key.segments) > 1 else ""
    return Place(place(key.space, key.segments, words), "", f"u{key.width}{order}")


def field_places(field: Field, words: PlaceWords = ENGLISH) -> list[Place]:
    """The places of a field: one, or that of each element of an array."""
    return [
        Place(place(field.space, segments, words, field.type.order), name, raw_format(field.type, segments, words))
        for name, segments in elements(field)
    ]


def raw_format(type_: Type, segments: tuple[Segment, ...] = (), words: PlaceWords = ENGLISH) -> str:
    """`i16`, `i16 big-endian` if it spans several bytes in that order, or `u8 (ascii7)` for an element of a text."""
    spans = len(segments) > 1 or type_.width > 8
    order = f" {words.big_endian}" if type_.order is Order.BIG and spans else ""
    joined = f" ({type_.joined.facts})" if type_.joined else ""
    return f"{_LETTERS[type_.encoding]}{type_.width}{order}{joined}"


def place(space: Space, segments: tuple[Segment, ...], words: PlaceWords = ENGLISH, order: Order | None = None) -> str:
    """The position of bits: `DATA[4..5]`, `DATA[3] bits 0..3`, `id bits 5..10`.

    Of several runs in a byte order, each has its bits of the raw integer: `DATA[2..3] [15:0], DATA[4] bits 5..7 [18:16]`.
    """
    if space is Space.ID:
        return f"{words.id} {_bits(segments[0].low, segments[0].width, words)}"
    if order is not None and not is_one_run(segments, order):
        return ", ".join(f"{_place(run, words)} {_raw_bits(run)}" for run in runs_of(segments, order))
    return _place(segments, words)


def _raw_bits(run: Sequence[Segment]) -> str:
    """`[15:0]`, or `[7]`."""
    ends = dict.fromkeys((run[-1].raw_low + run[-1].width - 1, run[0].raw_low))
    return f"[{':'.join(map(str, ends))}]"


def _place(segments: Sequence[Segment], words: PlaceWords) -> str:
    ordered = sorted(segments, key=lambda s: s.byte)
    if all(s.width == 8 for s in ordered):
        first, last = ordered[0].byte, ordered[-1].byte
        return f"DATA[{first}]" if first == last else f"DATA[{first}..{last}]"
    return ", ".join(f"DATA[{s.byte}]" + ("" if s.width == 8 else f" {_bits(s.low, s.width, words)}") for s in ordered)


def _bits(low: int, width: int, words: PlaceWords) -> str:
    return f"{words.bit} {low}" if width == 1 else f"{words.bits} {low}..{low + width - 1}"


def checksum(role: ChecksumRole) -> str:
    """`crc8_sae_j1850 (poly 0x1D, init 0xFF, xor_out 0xFF) over 5A, DATA[0..6]`; a sum is its name only."""
    of, name = role.algorithm, role.name
    if of.arithmetic is Arithmetic.CRC:
        digits = -(-(of.width or 0) // 4)
        numbers = {"poly": of.poly, "init": of.init, "xor_out": of.xor_out}
        listed = [f"{key} 0x{number:0{digits}X}" for key, number in numbers.items() if number or key == "poly"]
        name = f"{name or 'crc'} ({', '.join([*listed, *['reflected'] * of.is_reflected])})"
    return f"{name} over {', '.join(map(_checksum_input, role.inputs))}"


def _checksum_input(part: Input) -> str:
    if isinstance(part, ConstantBytes):
        return part.data.hex(" ").upper()
    if isinstance(part, DataBytes):
        return f"DATA[{part.first}]" if part.first == part.last else f"DATA[{part.first}..{part.last}]"
    return "id bits 0..7" if part.is_low else f"id {part.order.value}-endian"


NOT_GIVEN = "not given"
"""The text of an unknown scale."""


def scale(
    type_: Type, among: Sequence[str] = (), offset_word: str = ", offset ", unit: str | None = None
) -> Sequence[tuple[str, str]]:
    """Resolutions (1 LSB): (parameter values, `25/65535 rad, offset -12.5 rad`); the former are empty if it is constant.

    If `among` contains values of that parameter, the others are left out. `offset_word` precedes an offset. `unit` is
    printed instead of the symbol of the unit. An unknown scale is `not given`. Of a float without a scale, it is the unit.
    """
    cases = (type_.linear.constant, *type_.linear.cases.values())
    printed = tuple(linear.printed for linear in cases if linear is not None)
    symbol = type_.unit.symbol if type_.unit else ""
    return _scale(type_, tuple(among), offset_word, symbol if unit is None else unit, printed)


@functools.lru_cache(maxsize=1 << 12)
def _scale(
    type_: Type, among: tuple[str, ...], offset_word: str, symbol: str, printed: tuple[str, ...]
) -> Sequence[tuple[str, str]]:
    """Cached by `printed` too: types that differ only in the notation of their scales are equal."""
    unit = f" {symbol}" if symbol else ""

    def worth(linear: Linear | None) -> str:
        if linear is None:
            return NOT_GIVEN
        if type_.is_bare_float:
            return symbol
        added = f"{offset_word}{offset(linear)}{unit}" if linear.offset else ""
        return f"{step(linear)}{unit}{added}"

    kept = [(_among(names, among), linear) for names, linear in type_.linear.distinct()]
    return [(", ".join(names), worth(linear)) for names, linear in kept if names is not None]


def _among(names: Sequence[str], among: Sequence[str]) -> Sequence[str] | None:
    """The names that are in `among`; None if all of them are left out."""
    if not names or not among:
        return names
    return [name for name in names if name in among] or None


@functools.lru_cache(maxsize=1 << 12)
def ranges(type_: Type, among: tuple[str, ...] = ()) -> Sequence[tuple[str, str]]:
    """Allowed raw integers: (parameter values, `-2048..2048`); `among` as for `scale`."""
    kept = [(_among(names, among), limits) for names, limits in type_.raw_range.distinct()]
    return [(", ".join(names), span(limits)) for names, limits in kept if limits is not None and names is not None]


def with_cases(alternatives: Iterable[tuple[str, str]], separator: str = ", ") -> str:
    """What `scale` and `ranges` return as text, each with the parameter values that lead to it: `-2048..2048 (small)`."""
    return separator.join(f"{what} ({values})" if values else what for values, what in alternatives)


class Sent(Protocol):
    """A frame on the bus."""

    @property
    def id(self) -> int: ...
    @property
    def extended(self) -> bool: ...
    @property
    def remote(self) -> bool: ...
    @property
    def data(self) -> bytes: ...


def sent(frame: Sent) -> str:
    """A frame in the notation of can-utils: `12B#0102`, `0000012B#0102` with a 29-bit id, `12B#R` for a remote one.

    One of more than 8 bytes is `12B##0` and its data: a frame of CAN FD without bit rate switch, which every receiver reads.
    """
    id_ = f"{frame.id:08X}" if frame.extended else f"{frame.id:03X}"
    mark = "#" if len(frame.data) <= _CLASSIC_BYTES else "##0"
    return f"{id_}{mark}{'R' if frame.remote else frame.data.hex().upper()}"


_CLASSIC_BYTES = FrameFormat.CLASSIC.max_data_bytes


def bus_id(id_: int, extended: bool, remote: bool) -> str:
    """The id of a recorded frame: `0x141`, `0x00000141` with 29 bits, `0x141 remote`."""
    return f"0x{id_:0{8 if extended else 1}X}{' remote' if remote else ''}"


def id_range(ids: range) -> str:
    """`0x300`, `0x241..0x260`."""
    return "..".join(f"0x{end:X}" for end in dict.fromkeys((ids[0], ids[-1])))


def numbers(listed: Iterable[int]) -> str:
    """Ascending numbers, of which consecutive ones are a range: `1..3, 7`."""
    runs: list[list[int]] = []
    for number in listed:
        if runs and runs[-1][-1] == number - 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(str(run[0]) if len(run) == 1 else f"{run[0]}..{run[-1]}" for run in runs)


def condition(only: Mapping[str, tuple[str, ...]]) -> str:
    """A condition on parameters: `model A, B`; empty without one."""
    return "; ".join(f"{name} {', '.join(values)}" for name, values in only.items())


def exemptions(command: Command, effect: Effect) -> str:
    """The values of the request with which a command does not have an effect: `action = read`; empty without any."""
    return ", ".join(f"{field.name} = {member.name}" for field, member in command.exemptions(effect))


def effect(title: str, command: Command, effect: Effect) -> str:
    """The English title of an effect of a command, with the values without it."""
    values = exemptions(command, effect)
    return f"{title} (not with {values})" if values else title


def elements(field: Field) -> list[tuple[str, tuple[Segment, ...]]]:
    """The elements of a field, each with its name and bits: `level`, or `level[1]`, `level[2]`, … for an array."""
    return [(field.name if e.index is None else f"{field.name}[{e.index}]", e.segments) for e in field.elements]


def id_rule(rule: IdRule) -> str:
    """An id rule: `0x100 + node`, `(host_id << 8) + node`, `node * 10`, or a fixed id."""
    named = [(rule.parameter, rule.parameter_step)] if rule.parameter else []
    named += [("node", rule.node_step)] if rule.nodes is not None else []
    is_alone = len(named) == 1 and not rule.base
    terms = [_multiple_in_id(name, step, is_alone=is_alone) for name, step in named]
    return " + ".join(terms if terms and not rule.base else [f"0x{rule.base:X}", *terms])


def _multiple_in_id(name: str, step: int, *, is_alone: bool) -> str:
    if step == 1:
        return name
    shift = f"{name} << {step.bit_length() - 1}"
    return f"{name} * {step}" if step.bit_count() > 1 else shift if is_alone else f"({shift})"
