"""Decoding of arrays of frames: the same for every protocol.

A generated module describes its edition with these classes; `Decoder` applies them to whole arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum, IntFlag
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
"""A column: one dimension, or two for a field that is an array."""
Words = NDArray[np.uint64]
"""The data bytes of each frame, the first in the lowest bits (`<u8`); bytes beyond the data are 0.

Two dimensions, with several integers for each frame, if frames have more than 8 bytes.
"""
ParameterValue = str | int | float | Fraction


class Kind(IntFlag):
    """The kind of a frame; 0 is a data frame with an 11-bit id."""

    EXTENDED = 1
    REMOTE = 2


class Direction(IntEnum):
    """The direction of a frame."""

    REQUEST = 0
    REPLY = 1
    UNKNOWN = 2
    """Frames of this direction are not decoded."""


class Refusal(IntEnum):
    """The reasons for which a frame is rejected, as message numbers below 0."""

    UNKNOWN_ID = -1
    UNKNOWN_CODE = -2
    WRONG_LENGTH = -3
    WRONG_CONSTANT = -4
    MISSING_PARAMETER = -5
    UNKNOWN_DIRECTION = -6
    WRONG_CHECKSUM = -7


@dataclass(frozen=True, eq=False, kw_only=True)
class Frames:
    """Frames as arrays of one length."""

    time: NDArray[np.int64]
    """Nanoseconds since the epoch or the start of the log."""
    bus: NDArray[np.uint16]
    """The position of the name in `buses`."""
    id: NDArray[np.uint32]
    kind: NDArray[np.uint8]
    """A `Kind`."""
    length: NDArray[np.uint8]
    """The number of data bytes."""
    data: Words
    direction: NDArray[np.uint8]
    """A `Direction`."""
    buses: tuple[str, ...] = ("",)

    def __len__(self) -> int:
        return self.id.size

    def take(self, rows: Any) -> Frames:
        """The frames at some positions, in a slice, or where a mask is True."""
        columns = ("time", "bus", "id", "kind", "length", "data", "direction")
        return replace(self, **{name: getattr(self, name)[rows] for name in columns})


def frames(
    id: Iterable[int],
    data: Sequence[bytes],
    direction: int | Iterable[int],
    *,
    time: Iterable[int] | None = None,
    bus: Sequence[str] | None = None,
    kind: int | Iterable[int] = 0,
) -> Frames:
    """Frames from Python values. `direction` and `kind` are one value for all frames, or one for each."""
    count = len(data)
    length = np.array([len(content) for content in data], np.uint8)
    words = words_of(length)
    padded = b"".join(content.ljust(8 * words, b"\0") for content in data)
    names = tuple(dict.fromkeys(bus)) if bus else ("",)
    return Frames(
        time=np.zeros(count, np.int64) if time is None else np.asarray(time, np.int64),
        bus=np.zeros(count, np.uint16) if bus is None else np.array([names.index(name) for name in bus], np.uint16),
        id=np.asarray(id, np.uint32),
        kind=np.broadcast_to(np.asarray(kind, np.uint8), count),
        length=length,
        data=np.frombuffer(padded, "<u8").reshape((count, words) if words > 1 else count),
        direction=np.broadcast_to(np.asarray(direction, np.uint8), count),
        buses=names,
    )


def words_of(lengths: Array) -> int:
    """The integers of 64 bits that the longest data has; at least one."""
    return max(1, -(-int(lengths.max(initial=0)) // 8))


class Parameter(NamedTuple):
    """A property of a node that no frame contains: one of `choices`, or a number between two limits.

    A `whole` number is a part of ids or constants.
    """

    choices: tuple[str, ...] = ()
    minimum: Fraction | None = None
    maximum: Fraction | None = None
    whole: bool = False

    def check(self, name: str, value: ParameterValue) -> None:
        """Raises ValueError for a value that is not allowed."""
        if self.choices:
            if str(value) not in self.choices:
                raise ValueError(f"{name} is {value!r}, but must be one of {', '.join(self.choices)}")
            return
        try:
            number = Fraction(value)
        except (ValueError, OverflowError):
            raise ValueError(f"{name} is {value!r}, but must be a finite number") from None
        if self.whole and number.denominator != 1:
            raise ValueError(f"{name} is {value!r}, but must be a whole number")
        if (self.minimum is not None and number < self.minimum) or (self.maximum is not None and number > self.maximum):
            raise ValueError(f"{name} is {value!r}, but must be between {self.minimum} and {self.maximum}")


Parameters = Mapping[str, ParameterValue]


class Scale(NamedTuple):
    """A conversion to a value: (raw * factor + addend) / divisor, multiplied by `times` if it is set: parameters as in `a*b/c`."""

    factor: int
    addend: int
    divisor: int
    times: str = ""

    def at(self, parameters: Parameters) -> Scale | None:
        """The scale under some parameters; None if its parameter is missing or not above 0."""
        if not self.times:
            return self
        number = Fraction(1)
        above, _, below = self.times.partition("/")
        for name in filter(None, (*above.split("*"), below)):
            value = Fraction(parameters.get(name, 0))
            if value <= 0:
                return None
            number = number / value if name == below else number * value
        return Scale(self.factor * number.numerator, self.addend * number.numerator, self.divisor * number.denominator)

    @property
    def is_identity(self) -> bool:
        return self == (1, 0, 1, "")

    def apply(self, raw: Array) -> Array:
        """The values of raw numbers, rounded once if the dividend has at most 53 bits."""
        values: Array = raw.astype(np.float64)
        if max(abs(self.factor), abs(self.addend), self.divisor) >= 1 << 53:
            values *= float(Fraction(self.factor, self.divisor))
            values += float(Fraction(self.addend, self.divisor))
            return values
        if self.factor != 1:
            values *= self.factor
        if self.addend:
            values += self.addend
        if self.divisor != 1:
            values /= self.divisor
        return values


@dataclass(frozen=True, kw_only=True)
class Type:
    """The conversion from raw integers to values.

    `scale` has one scale for each value of the parameter `scale_by`, or one under the empty key; None is an unknown scale.
    `names` are those of the members of an enum by code, of flags by bit number, or of numbers that have a name beside
    their value by raw integer. `no_values` are the first and the last raw integer of each name for no value of a number;
    its values are NaN.
    """

    unit: str = ""
    scale_by: str = ""
    scale: Mapping[str, Scale | None]
    is_float: bool = False
    is_enum: bool = False
    is_flags: bool = False
    names: Mapping[int, str] | None = None
    no_values: Mapping[str, tuple[int, int]] | None = None

    def no_value_names(self, raw: Array) -> Array:
        """The name for which each raw integer has no value; an empty text for a number."""
        if self.is_float:  # NaN of either sign
            raw = raw & raw.dtype.type(np.iinfo(raw.dtype).max // 2)
        names = np.full(raw.shape, "", f"<U{max(map(len, self.no_values or ('',)))}")
        for name, (first, last) in (self.no_values or {}).items():
            names[(raw >= first) & (raw <= last)] = name
        return names

    text: tuple[str, int] | None = None
    """The encoding and the padding, if the elements of a field are the bytes of a text."""
    is_digits: bool = False
    """Whether the elements of a field are the decimal digits of a number."""

    @property
    def is_named_number(self) -> bool:
        """Whether some raw integers have a name beside their value."""
        return bool(self.names) and not (self.is_enum or self.is_flags)

    @property
    def is_joined(self) -> bool:
        """Whether all elements of a field are one value."""
        return self.text is not None or self.is_digits

    def scale_at(self, parameters: Parameters) -> Scale | None:
        """The scale under some parameters; None if it is unknown or depends on a missing parameter."""
        scale = self.scale.get(str(parameters.get(self.scale_by, "")) if self.scale_by else "")
        return scale and scale.at(parameters)


PLAIN: Mapping[str, Scale | None] = {"": Scale(1, 0, 1)}


@dataclass(frozen=True)
class Field:
    """A field: its columns of values and of raw integers, the expression of its raw integers, and their type in NumPy.

    It exists if the parameter of the layout has one of the values `only`; always if that is empty. `count` is the number
    of elements of an array, 0 for a single value.
    """

    name: str
    raw_name: str
    read: Callable[[Words, Words], Array]
    dtype: str
    type: Type
    count: int = 0
    only: tuple[str, ...] = ()

    def has_other_values(self, scale: Scale | None) -> bool:
        """Whether its values under a scale are not its raw integers."""
        of = self.type
        return scale is not None and (of.is_float or of.is_joined or bool(of.no_values) or not scale.is_identity)


class Constant(NamedTuple):
    """Bits that must have one value, or that of a parameter; any other is rejected."""

    read: Callable[[Words, Words], Array]
    value: int
    only: tuple[str, ...] = ()
    parameter: str = ""


class Checksum:
    """The checksum of each frame, in a register of `width` bits: `poly` and `init` are aligned to it.

    `read` reads the field, `inputs` the bytes in their order; the arithmetic is `crc`, `sum` or `xor`.
    """

    def __init__(
        self,
        read: Callable[[Words, Words], Array],
        inputs: Callable[[Words, Words], tuple[Array | int, ...]],
        arithmetic: str,
        width: int,
        *,
        poly: int = 0,
        init: int = 0,
        reflected: bool = False,
        shift: int = 0,
        xor_out: int = 0,
    ) -> None:
        self._read, self._inputs, self._arithmetic, self._width = read, inputs, arithmetic, width
        self._init, self._reflected, self._shift, self._xor_out = init, reflected, shift, xor_out
        self._mask = np.uint64((1 << width) - 1)
        self._table = self._of_bytes(np.uint64(poly)) if arithmetic == "crc" else None

    def is_correct(self, words: Words, ids: Words) -> Array:
        """Whether the field of each frame is its checksum."""
        register = np.full(ids.shape, self._init, np.uint64)
        for byte in self._inputs(words, ids):
            register = self._next(register, np.asarray(byte, np.uint64))
        correct: Array = (register >> np.uint64(self._shift) ^ np.uint64(self._xor_out)) == self._read(words, ids)
        return correct

    def _next(self, register: Array, byte: Array) -> Array:
        """The registers after one more byte."""
        after: Array
        if self._table is None:
            after = register ^ byte if self._arithmetic == "xor" else register + byte & self._mask
        elif self._reflected:
            after = register >> np.uint64(8) ^ self._table[(register ^ byte) & np.uint64(0xFF)]
        else:
            index = register >> np.uint64(self._width - 8) ^ byte
            after = register << np.uint64(8) & self._mask ^ self._table[index]
        return after

    def _of_bytes(self, poly: np.uint64) -> Array:
        """The register after each byte, if it was 0 before."""
        one, top = np.uint64(1), np.uint64(self._width - 1)
        register = np.arange(256, dtype=np.uint64)
        if not self._reflected:
            register = register << np.uint64(self._width - 8)
        for _ in range(8):
            if self._reflected:
                register = register >> one ^ (register & one) * poly
            else:
                register = register << one & self._mask ^ (register >> top) * poly
        return register


@dataclass(frozen=True)
class Layout:
    """A table: the fields of one or several messages. `parameter` decides which fields exist; empty without one.

    Of `constants`, those that always exist and depend on no parameter come first.
    """

    name: str
    fields: tuple[Field, ...] = ()
    constants: tuple[Constant, ...] = ()
    checksum: Checksum | None = None
    parameter: str = ""


class Message(NamedTuple):
    """A request or a reply; its number is its position in `MESSAGES`. `code` is -1 without one.

    `node` reads the node from the data; None if the id has it, or if there is none. `sent` are the occasions on which it is
    sent, if they are stated: `cyclic`, `on_change`, `on_request`, `event`. A receiver treats a silence of `timeout_ms` as a
    failure. `frames` are the field with the number of the frame and the numbers, if there are several.
    """

    command: str
    direction: Direction
    code: int
    layout: int
    node: Callable[[Words, Words], Array] | None = None
    sent: tuple[str, ...] = ()
    every_ms: float | None = None
    timeout_ms: float | None = None
    frames: tuple[str, range] | None = None


class Select:
    """A decision on a value of each frame: the node of its case, else `otherwise`. A node that is an int is a message
    number, or a `Refusal`."""

    def __init__(
        self, read: Callable[[Words, Words, Array], Array], cases: Mapping[int, Node], otherwise: Node
    ) -> None:
        self._read = read
        self._values = values = np.array(sorted(cases), np.uint64)
        nodes = [*(cases[int(value)] for value in values), otherwise]
        self._subtrees = [(i, node) for i, node in enumerate(nodes) if isinstance(node, Select)]
        self._leaves = np.array([node if isinstance(node, int) else 0 for node in nodes], np.int16)
        self._table: Array | None = None
        self._leaf_of = self._leaves
        if not values.size or values[-1] < 1 << 16:
            self._table = np.full((int(values[-1]) if values.size else 0) + 2, len(values), np.int16)
            self._table[values.astype(np.intp)] = np.arange(len(values))
            self._leaf_of = self._leaves[self._table]

    def follow(self, words: Words, ids: Words, lengths: Array) -> Array:
        """The message number of each frame, or its refusal."""
        values = self._read(words, ids, lengths)
        result: Array
        if self._table is not None:
            places = np.minimum(values.astype(np.uint64), self._table.size - 1).astype(np.intp)
            if not self._subtrees:
                result = self._leaf_of[places]
                return result
            branches = self._table[places]
        else:
            places = np.searchsorted(self._values, values)
            places[places == self._values.size] = 0
            branches = np.where(self._values[places] == values, places, self._values.size)
        result = self._leaves[branches]
        for number, subtree in self._subtrees:
            rows = branches == number
            if rows.all():
                return subtree.follow(words, ids, lengths)
            if rows.any():
                result[rows] = subtree.follow(words[rows], ids[rows], lengths[rows])
        return result


Node = int | Select


@dataclass(frozen=True)
class Route:
    """The messages of one id rule and kind of frame; `mask` are the bits of the id that keys and fields fill.

    If `parameter` is set, `times` the value of that parameter is added to `base`.
    """

    base: int
    step: int
    nodes: range | None
    then: Node
    mask: int = 0
    kind: int = 0
    parameter: str = ""
    times: int = 1

    def at(self, parameters: Parameters) -> Route:
        """The route with the value of its parameter, if that is known."""
        if not self.parameter or self.parameter not in parameters:
            return self
        offset = int(Fraction(parameters[self.parameter])) * self.times
        return replace(self, base=self.base + offset, parameter="")

    def nodes_of(self, ids: Words) -> tuple[Array, Array]:
        """Which ids belong to this rule, and the node of each; -1 without nodes."""
        rest = ids & (0xFFFFFFFF ^ self.mask) if self.mask else ids
        if self.nodes is None:
            return rest == self.base, np.full(ids.size, -1, np.int32)
        nodes = rest.astype(np.int64) - self.base
        valid = np.ones(ids.size, np.bool_)
        if self.step > 1:
            nodes, remainder = np.divmod(nodes, self.step)
            valid = remainder == 0
        valid &= (nodes >= self.nodes.start) & (nodes < self.nodes.stop)
        if self.nodes.step > 1:
            valid &= (nodes - self.nodes.start) % self.nodes.step == 0
        return valid, nodes.astype(np.int32)


class Table(NamedTuple):
    """The frames of one layout as columns."""

    layout: Layout
    rows: NDArray[np.intp]
    """The positions of its frames among those that were decoded."""
    message: NDArray[np.int16]
    """The message number of each frame."""
    node: NDArray[np.int32]
    """The node of each frame, in its id or its data; -1 without one, and for one of more than 31 bits."""
    columns: dict[str, Array]
    """The values of each field, and its raw integers under the name with `_raw` if they were asked for and differ."""


class Decoded(NamedTuple):
    """Tables by the name of their layout, and the message number or the `Refusal` of every frame."""

    tables: dict[str, Table]
    message: NDArray[np.int16]


@dataclass(frozen=True, kw_only=True)
class Edition:
    """One edition of a protocol, as generated."""

    family: str
    name: str
    spec_hash: str
    parameters: Mapping[str, Parameter]
    layouts: tuple[Layout, ...]
    messages: tuple[Message, ...]
    requests: tuple[Route, ...]
    replies: tuple[Route, ...]
    words: int = 1
    """The integers of 64 bits that the data of the longest message has."""

    def decoder(self, parameters: Parameters | None = None, *, raw: bool = False) -> Decoder:
        """A decoder for nodes with these parameters. Raises ValueError for unknown parameters and values."""
        return Decoder(self, parameters or {}, raw=raw)


class Column(NamedTuple):
    """A column of a table: raw integers if `scale` is None."""

    name: str
    field: Field
    scale: Scale | None
    is_raw: bool


class Decoder:
    """Decodes arrays of frames. With `raw`, raw integers have columns of their own."""

    def __init__(self, edition: Edition, parameters: Parameters, *, raw: bool = False) -> None:
        self.edition = edition
        self.parameters = dict(parameters)
        for name, value in parameters.items():
            if name not in edition.parameters:
                known = ", ".join(edition.parameters) or "none"
                raise ValueError(
                    f"{edition.family} {edition.name} has no parameter {name}; its parameters are: {known}"
                )
            edition.parameters[name].check(name, value)
        self._routes = [[route.at(self.parameters) for route in way] for way in (edition.requests, edition.replies)]
        self.columns = {layout.name: self._columns(layout, raw) for layout in edition.layouts}
        """The columns of each layout, without those of the frame; None where a parameter that decides is missing."""
        self._layout_of = np.array([message.layout for message in edition.messages], np.int16)
        self._nodes_in_data = [
            (i, message.node) for i, message in enumerate(edition.messages) if message.node is not None
        ]

    def decode(self, frames: Frames) -> Decoded:
        """The tables of some frames. Frames of no message are in no table; `message` has the reason."""
        frames = self._with_words(frames)
        ids = frames.id.astype(np.uint64)
        message, node = self._dispatch(frames, ids, frames.direction)
        tables = {}
        if self._layout_of.size:
            layouts = np.where(message >= 0, self._layout_of[message], np.int16(-1))
            order = np.argsort(layouts, kind="stable")  # a radix sort: positions stay in the order of the frames
            counts = np.bincount(layouts + 1, minlength=len(self.edition.layouts) + 1)
            ends = np.cumsum(counts)
            for number, layout in enumerate(self.edition.layouts):
                rows = order[ends[number] : ends[number + 1]]
                table = self._table(layout, rows, frames.data, ids, message, node) if rows.size else None
                if table and table.rows.size:
                    tables[layout.name] = table
        return Decoded(tables, message)

    def nodes(self, frames: Frames) -> NDArray[np.int32]:
        """The node of each frame, from its id or its data; -1 without one, and for a frame of no message or direction."""
        frames = self._with_words(frames)
        return self._dispatch(frames, frames.id.astype(np.uint64), frames.direction)[1]

    def with_directions(self, frames: Frames) -> Frames:
        """The same frames, with a direction for those of unknown direction that only one direction has.

        A frame whose id, code and length both directions have keeps its direction: it depends on the other frames.
        """
        ids, own = frames.id.astype(np.uint64), self._with_words(frames)
        is_request, is_reply = (
            self._dispatch(own, ids, np.full(len(frames), way, np.uint8))[0] >= 0
            for way in (Direction.REQUEST, Direction.REPLY)
        )
        direction = frames.direction.copy()
        unknown = direction == Direction.UNKNOWN
        direction[unknown & is_request & ~is_reply] = Direction.REQUEST
        direction[unknown & is_reply & ~is_request] = Direction.REPLY
        return replace(frames, direction=direction)

    def _with_words(self, frames: Frames) -> Frames:
        """The same frames with the number of words that the edition has."""
        words = self.edition.words
        if frames.data.ndim == 1 and words == 1:
            return frames
        data = np.zeros((len(frames), words), "<u8")
        given = (frames.data if frames.data.ndim > 1 else frames.data[:, np.newaxis])[:, :words]
        data[:, : given.shape[1]] = given
        return replace(frames, data=data if words > 1 else data[:, 0])

    def _dispatch(self, frames: Frames, ids: Words, direction: Array) -> tuple[NDArray[np.int16], NDArray[np.int32]]:
        message = np.full(ids.size, Refusal.UNKNOWN_DIRECTION, np.int16)
        node = np.full(ids.size, -1, np.int32)
        for number, routes in enumerate(self._routes):
            rows = np.flatnonzero(direction == number)
            unknown = np.isin(frames.kind[rows], [route.kind for route in routes if route.parameter])
            message[rows] = np.where(unknown, np.int16(Refusal.MISSING_PARAMETER), np.int16(Refusal.UNKNOWN_ID))
            for route in routes:
                if not rows.size:
                    break
                if route.parameter:
                    continue
                own = ids[rows]
                valid, nodes = route.nodes_of(own)
                valid &= frames.kind[rows] == route.kind
                if not valid.any():
                    continue
                if valid.all():
                    matching, rows = rows, rows[:0]
                else:
                    matching, own, nodes, rows = rows[valid], own[valid], nodes[valid], rows[~valid]
                node[matching] = nodes
                then = route.then
                message[matching] = (
                    then if isinstance(then, int) else then.follow(frames.data[matching], own, frames.length[matching])
                )
        for number, read in self._nodes_in_data:
            rows = np.flatnonzero(message == number)
            if rows.size:
                node[rows] = read(frames.data[rows], ids[rows]).astype(np.uint32).view(np.int32).clip(-1)
        return message, node

    def _columns(self, layout: Layout, raw: bool) -> tuple[Column, ...] | None:
        value = self.parameters.get(layout.parameter)
        if layout.parameter and value is None:
            return None
        columns = []
        for field in layout.fields:
            if field.only and str(value) not in field.only:
                continue
            scale = field.type.scale_at(self.parameters)
            if scale is not None:
                columns.append(Column(field.name, field, scale, False))
            is_kept = raw or field.type.no_values or field.type.is_named_number  # the raw integers have the names
            if scale is None or (is_kept and field.has_other_values(scale)):
                columns.append(Column(field.raw_name, field, None, True))
        return tuple(columns)

    def _table(self, layout: Layout, rows: Array, data: Words, ids: Words, message: Array, node: Array) -> Table:
        words, own = data[rows], ids[rows]
        reasons = self._rejections(layout, words, own)
        correct = reasons == 0
        if not correct.all():
            message[rows] = np.where(correct, message[rows], reasons)
            rows, words, own = rows[correct], words[correct], own[correct]
        arrays: dict[str, Array] = {}
        raws: dict[str, Array] = {}
        for column in self.columns[layout.name] or ():
            field = column.field
            if field.name not in raws:
                raws[field.name] = np.ascontiguousarray(field.read(words, own), field.dtype)
            arrays[column.name] = values(raws[field.name], field.type, column.scale)
        return Table(layout, rows, message[rows], node[rows], arrays)

    def _rejections(self, layout: Layout, words: Words, ids: Words) -> Array:
        """The refusal of each frame of a layout, in the order of the checks; 0 without one."""
        reasons = np.zeros(ids.shape, np.int16)

        def reject(frames: Any, refusal: Refusal) -> None:
            reasons[(reasons == 0) & frames] = refusal

        def check(constant: Constant) -> None:
            value = self.parameters.get(constant.parameter, constant.value)
            if constant.parameter and constant.parameter not in self.parameters:
                reject(True, Refusal.MISSING_PARAMETER)
            else:
                reject(~_same(constant, int(Fraction(value)), words, ids), Refusal.WRONG_CONSTANT)

        always = [constant for constant in layout.constants if not (constant.only or constant.parameter)]
        for constant in always:
            check(constant)
        if layout.checksum is not None:
            reject(~layout.checksum.is_correct(words, ids), Refusal.WRONG_CHECKSUM)
        if layout.parameter and layout.parameter not in self.parameters:
            reject(True, Refusal.MISSING_PARAMETER)
        choice = str(self.parameters.get(layout.parameter))
        for constant in layout.constants[len(always) :]:
            if not constant.only or choice in constant.only:
                check(constant)
        return reasons


def _same(constant: Constant, value: int, words: Words, ids: Words) -> Array:
    """Which frames have the value of a constant, in each element of an array."""
    same: Array = constant.read(words, ids) == value
    every: Array = same if same.ndim == 1 else np.all(same, axis=1)
    return every


def values(raw: Array, type_: Type, scale: Scale | None) -> Array:
    """The values of raw integers; the integers themselves without a scale.

    NaN is a raw integer without a value, a float that is no finite number, and a number of decimal digits of which one
    exceeds 9.
    """
    if scale is None:
        return raw
    if type_.no_values and not type_.is_float:
        return np.where(type_.no_value_names(raw) == "", scale.apply(raw), np.nan)
    if type_.text is not None:
        return texts(raw, *type_.text)
    if type_.is_digits:
        number = raw.astype(np.float64) @ 10.0 ** np.arange(raw.shape[1] - 1, -1, -1)
        return np.where((raw > 9).any(axis=1), np.nan, number)
    if type_.is_float:
        with np.errstate(invalid="ignore"):  # a signaling NaN
            numbers = raw.view(f"f{raw.itemsize}").astype(np.float64)
        finite = np.isfinite(numbers)
        return np.where(finite, scale.apply(np.where(finite, numbers, 0.0)), np.nan)
    return raw if scale.is_identity else scale.apply(raw)


def texts(raw: Array, encoding: str, padding: int) -> Array:
    """The texts of rows of bytes: each ends before the first 0, and before the padding at its end."""
    found = np.empty(len(raw), object)
    end = bytes([padding])
    found[:] = [row.tobytes().partition(b"\0")[0].rstrip(end).decode(encoding, "replace") for row in raw]
    return found


def signed(raw: Array, width: int) -> Array:
    """Raw integers in two's complement of a width."""
    unused = 64 - width
    shifted: Array = (raw.astype(np.uint64) << unused).view(np.int64) >> unused
    return shifted


def stack(*elements: Array) -> Array:
    """The elements of an array field, one row for each frame."""
    return np.stack(elements, axis=1)
