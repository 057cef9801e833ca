"""What the frames of one id, length and key bits can be, in each direction; computed once for each such kind."""

from __future__ import annotations

import functools
import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

from ..model.edition import Edition
from ..model.layout import Field, ReservedRole, Space
from ..model.message import Direction, IdRule, Message
from ..model.types import Encoding, Type
from ..semantics.bits import data_bits
from ..semantics.candidates import Candidates
from ..semantics.decoder import Decoder, Identified, Rejection, rejects_constants
from ..semantics.exchange import check_reply
from ..semantics.frame import (
    CanFrame,
    Parts,
    bits_at,
    has_id,
    has_id_rule,
    node_in_id,
    node_of,
    parts_of,
    wrong_constants,
)
from .bus_behaviour import Behaviour

WINDOW = 2_000_000
"""The time in ns within which a request is answered, unless the spec or the log shows a longer one."""


class Channel(NamedTuple):
    """The source of replies: the numbers of an edition and of one of its id rules, and the node; None if any."""

    edition: int
    rule: int
    node: int | None


class Opened(NamedTuple):
    """A channel on which a request is answered, and the number of replies."""

    channel: Channel
    replies: int


class Bits(NamedTuple):
    """Some bits of the data, read as one little-endian integer, and their values."""

    mask: int
    value: int


class Limit(NamedTuple):
    """Bits of the data that do not all have a meaning: the bits, and whether a raw integer is allowed."""

    parts: Parts
    allows: Callable[[Any], Any]


@dataclass(frozen=True, eq=False)
class Form:
    """A message that a frame can be; `has_constants` is false if a constant in the id differs.

    Data with other `constants` is rejected. Data with other `reserved` bits, or beyond the limits, is not sent by a
    program that obeys the spec, but received.
    """

    message: Message
    node: int | None
    constants: Bits | None
    reserved: Bits
    limits: tuple[Limit, ...]

    def has_constants(self, data: Any) -> Any:
        """Whether all constants have their values in data, which is one integer or an array."""
        return self.constants is not None and data & self.constants.mask == self.constants.value

    def is_regular(self, data: int) -> bool:
        """Whether a program that obeys the spec can send this data."""
        if data & self.reserved.mask != self.reserved.value:
            return False
        return all(allows(bits_at(parts, data)) for parts, allows in self.limits)


@dataclass(eq=False, kw_only=True)
class FrameKind:
    """The messages of an edition that a frame can be, by its id, its length, its keys and the node in its data.

    A request is answered on the channels `opens`; a reply answers a request that opened one of `answers`. `identified`
    are the results of the dispatch plan. `only` is the direction of all frames with this id; None if it has both. It is
    that of all frames of the log `by_log`.
    `reply_time` is that of most replies on its bus. If `has_old_bits`, reserved bits of the request can have any value.
    """

    edition: Edition
    decoder: Decoder
    identified: Mapping[Direction, Identified | Rejection]
    only: Direction | None
    by_log: bool
    request: Form | None
    replies: tuple[Form, ...]
    opens: tuple[Opened, ...]
    answers: tuple[Channel, ...]
    with_constants: frozenset[Message]
    window: int
    """The time in ns within which the request is answered."""
    reply_time: int | None
    has_old_bits: bool
    is_by_time: bool
    """Whether old bits leave directions on the bus to the times."""
    _replies_to: dict[FrameKind, Identified | None] = field(default_factory=dict)

    @cached_property
    def is_distinct(self) -> bool:
        """Whether a reply can have data that the request does not allow."""
        if self.request is None or self.request.limits:
            return True
        return any(self.request.reserved.mask & ~reply.reserved.mask for reply in self.replies)

    @cached_property
    def is_shared(self) -> bool:
        """Whether a frame of any data can be a reply, and be a request but for its reserved bits and limits."""
        forms = [*self.replies, *([self.request] if self.request else [])]
        return (
            self.only is None
            and len(forms) > 1
            and not any(form.constants is None or form.constants.mask for form in forms)
            and self.request is not None
        )

    @cached_property
    def is_echoed(self) -> bool:
        """Whether the node sends the request back."""
        return self.request is not None and self.edition.command(self.request.message.command).is_echoed

    @cached_property
    def has_node_in_data(self) -> bool:
        """Whether the node in the data of the request or of its reply decides which frames answer it."""
        assert self.request is not None
        reply = self.edition.command(self.request.message.command).reply
        return any(message.node_bits for message in (self.request.message, reply) if message)

    def reply_to(self, asking: FrameKind, request: CanFrame, reply: CanFrame) -> Identified | None:
        """The message with which a frame of this kind answers a request of kind `asking`; None if it does not."""
        if asking.is_echoed and request.data != reply.data:
            return None
        if asking.has_node_in_data:
            return _answer(self.decoder, request, reply)
        if asking not in self._replies_to:
            self._replies_to[asking] = _answer(self.decoder, request, reply)
        return self._replies_to[asking]

    @cached_property
    def within(self) -> int:
        """The time in ns within which the reply is expected, at most the window; a later frame can be a request.

        That of the spec; of the log if replies take longer. Shorter ones show less, because some pairs are wrong.
        """
        stated, usual = self._stated_time, self.reply_time or 0
        if self._own_time is None and (self.is_by_time or usual > (stated or WINDOW)):
            return min(self.window, self.late_after or WINDOW // 4)
        return min(self.window, stated or WINDOW // 4)

    @cached_property
    def late_after(self) -> int | None:
        """The time in ns after which a reply is late: by the spec and, half as long again as nine of ten take, by the log.

        None if neither is known.
        """
        if self._own_time is not None or self.reply_time is None:
            return self._stated_time
        return max(self._stated_time or 0, self.reply_time * 3 // 2)

    @cached_property
    def _stated_time(self) -> int | None:
        """The time of the command, or twice that of the bus, because the reply has to be sent too."""
        within = self.edition.bus.reply_within_ms
        if self._own_time is not None or within is None or self.request is None:
            return self._own_time
        return int(2 * within * 1_000_000)

    @cached_property
    def _own_time(self) -> int | None:
        """The reply time of the command, if it has one of its own."""
        if self.request is None:
            return None
        within = self.edition.command(self.request.message.command).reply_within_ms
        return None if within is None else int(within * 1_000_000)

    def rejection(self, direction: Direction, frame: CanFrame) -> Rejection | None:
        """The reason why a frame is no message of a direction; None if it is one."""
        found = self.identified[direction]
        if isinstance(found, Rejection):
            return found
        return rejects_constants(found.message, frame, {}) if found.message in self.with_constants else None


class FrameKinds:
    """Finds the kinds of the frames of one edition; `number` distinguishes the editions of a log.

    A request is answered within `window` ns; None for the time that suits the edition and the bus.
    """

    def __init__(self, edition: Edition, number: int, window: int | None) -> None:
        self.edition = edition
        self.number = number
        self._window = window
        self._decoder = Decoder(edition)
        self._candidates = Candidates(edition)
        self._with_constants = frozenset(
            m for m in edition.all_messages() if any(f.role.is_checked for f in m.layout.fields)
        )
        rules = dict.fromkeys(reply.id for reply in edition.messages(Direction.REPLY))
        self._rules = {rule: index for index, rule in enumerate(rules)}

    def nodes(self, frame: CanFrame) -> Sequence[int | None]:
        """The nodes that the id of a frame can mean; empty if it is no id of this edition."""
        return list(dict.fromkeys(node_in_id(m, frame) for m in self.edition.all_messages() if has_id_rule(m, frame)))

    def key_bits(self, frame: CanFrame) -> int:
        """The data bits that identify a frame: all keys, and the node where the id has none."""
        having = [message for message in self.edition.all_messages() if has_id_rule(message, frame)]
        nodes = [message.node_bits for message in having if message.id.nodes is None]
        runs = [*(key for message in having for key in message.keys), *(bits for bits in nodes if bits is not None)]
        return data_bits((run.space, run.segments) for run in runs)

    def kind(self, frame: CanFrame, behaviour: Behaviour) -> FrameKind:
        """The kind of a frame on a bus."""
        identified = {direction: self._decoder.identify(direction, frame) for direction in Direction}
        forms = [form_of(message, frame) for message in self._candidates.of(frame)]
        requests = [form for form in forms if form.message.direction is Direction.REQUEST]
        old = behaviour.old_bits_of(requests[0].message) if requests else None
        if old is not None:
            mask = requests[0].reserved.mask if old.value is not None else 0
            requests[0] = replace(requests[0], reserved=Bits(mask, (old.value or 0) & mask))
        having = [message for message in self.edition.all_messages() if has_id(message, frame)]
        having = having or [message for message in self.edition.all_messages() if has_id_rule(message, frame)]
        directions = {message.direction for message in having}
        sources = [
            (message.id, node_in_id(message, frame)) for message in having if message.direction is Direction.REPLY
        ]
        return FrameKind(
            edition=self.edition,
            decoder=self._decoder,
            identified=identified,
            only=next(iter(directions)) if len(directions) == 1 else behaviour.only,
            by_log=len(directions) > 1 and behaviour.only is not None,
            request=requests[0] if requests else None,
            replies=tuple(form for form in forms if form.message.direction is Direction.REPLY),
            opens=self._opens(requests[0]) if requests else (),
            answers=tuple(dict.fromkeys(self._channel(rule, n) for rule, node in sources for n in (node, None))),
            with_constants=self._with_constants,
            window=self._window_of(requests[0].message if requests else None, behaviour),
            reply_time=behaviour.reply_time,
            has_old_bits=old is not None and old.value is None,
            is_by_time=any(bits.value is None for bits in behaviour.old_bits),
        )

    def _window_of(self, request: Message | None, behaviour: Behaviour) -> int:
        own = self.edition.command(request.command).reply_within_ms if request else None
        return max(self.bus_window(behaviour), int((own or 0) * 1_000_000))

    def bus_window(self, behaviour: Behaviour) -> int:
        """The time in ns within which a request is answered, but for commands with a reply time of their own."""
        if self._window is not None:
            return self._window
        return max(
            WINDOW, int(2 * (self.edition.bus.reply_within_ms or 0) * 1_000_000), 2 * (behaviour.reply_time or 0)
        )

    def _opens(self, request: Form) -> tuple[Opened, ...]:
        command = self.edition.command(request.message.command)
        if command.reply is None:
            return ()
        rule, nodes = command.reply.id, command.from_each or (request.node,)
        if rule.nodes is None:
            return (Opened(self._channel(rule, None), len(nodes)),)
        return tuple(Opened(self._channel(rule, node), 1) for node in nodes)

    def _channel(self, rule: IdRule, node: int | None) -> Channel:
        return Channel(self.number, self._rules[rule], node)


def _answer(decoder: Decoder, request: CanFrame, reply: CanFrame) -> Identified | None:
    found = check_reply(decoder, request, reply)
    return found if isinstance(found, Identified) else None


def form_of(message: Message, frame: CanFrame) -> Form:
    """A message that a frame can be by its id, its length and its keys."""
    fields = message.layout.fields
    always = [f for f in fields if not f.only]
    ignored = [f for f in always if isinstance(f.role, ReservedRole)]
    constant = [f for f in always if f.role.is_checked]
    free = data_bits((f.space, e.segments) for f in fields if f not in ignored for e in f.elements)
    keys = data_bits((key.space, key.segments) for key in message.keys)
    in_id = [f for f in constant if f.space is Space.ID]
    limited = [(f, _allows(f.type)) for f in always if f.role.is_value and f.space is Space.DATA]
    return Form(
        message=message,
        node=node_of(message, frame),
        constants=None if wrong_constants(in_id, frame) else _bits(constant),
        reserved=Bits((1 << 8 * len(frame.data)) - 1 & ~(free | keys), _bits(ignored).value),
        limits=tuple(Limit(parts_of(e.segments), allows) for f, allows in limited if allows for e in f.elements),
    )


def _bits(fields: Iterable[Field]) -> Bits:
    """The data bits of fields that always have the same raw value."""
    mask = value = 0
    for one in fields:
        for element in one.elements if one.space is Space.DATA else ():
            for shift, ones, position in parts_of(element.segments):
                mask |= ones << shift
                value |= ((one.role.sent_raw or 0) >> position & ones) << shift
    return Bits(mask, value)


def _allows(type_: Type) -> Callable[[Any], Any] | None:
    """Whether the raw bits of a type have a name, or are in the range of some parameters; None if all are.

    The function takes one integer, or an array of unsigned ones.
    """
    full = 1 << type_.width
    if type_.flags:
        unnamed = (full - 1) & ~sum(1 << flag.value for flag in type_.flags)
        return lambda bits: bits & unnamed == 0
    if type_.enum:
        codes = sorted({member.value % full for member in type_.enum})
        if codes[-1] - codes[0] == len(codes) - 1:
            return _is_between(codes[0], codes[-1], full)
        return lambda bits: functools.reduce(operator.or_, [bits == code for code in codes])
    spans = [span for _, span in type_.raw_range.distinct()]
    if type_.encoding is Encoding.FLOAT or not all(span is not None and span.is_constant for span in spans):
        return None
    low = math.ceil(min(span.low.constant for span in spans if span is not None))
    high = math.floor(max(span.high.constant for span in spans if span is not None))
    least, most = type_.raw_limits
    return _is_between(max(low, least), min(high, most), full)


def _is_between(low: int, high: int, full: int) -> Callable[[Any], Any]:
    """Whether raw bits, of which there are `full`, are in a range; negative numbers are in two's complement."""
    if low > high:
        return lambda bits: bits < 0
    offset, mask, span = -low % full, full - 1, high - low
    return lambda bits: (bits + offset) & mask <= span
