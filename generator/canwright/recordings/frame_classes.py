"""Classes of frames: what the frames of one id, length and key bits can be, and how a bus decides on their directions."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

from ..model.edition import Edition
from ..model.layout import Space
from ..model.message import Command, Direction, IdRule, Message
from ..model.types import Type
from ..semantics.bits import data_bits
from ..semantics.decoder import Decoder, Identified, Rejection, rejects_checked
from ..semantics.exchange import check_reply, exchange_plans
from ..semantics.frame import (
    CanFrame,
    Parts,
    bits_at,
    has_id,
    has_id_rule,
    is_message,
    node_in_id,
    node_of,
    parts_of,
    wrong_constants,
)
from ..semantics.plan import CheckParameter, MaskedBits, message_plan, only_by_request
from ..semantics.valid_raws import FlagBits, NamedRaws, RawInterval, valid_raws
from .bus_behaviour import Behaviour

WINDOW = 2_000_000
"""The time in ns within which a request is answered, unless the spec or the log shows a longer one."""
SOON = WINDOW // 4
"""The time in ns within which most replies come, where neither the spec nor the log shows another one."""
MAX_CLASSES = 1 << 16
"""The maximum number of ids and of classes of an edition that are remembered."""
IS_REQUEST, IS_REPLY, IS_REGULAR = 1, 2, 4
"""The bits of `DirectionRule.content`: the data has the constants of the request, or of a reply; a program that obeys the
spec can send it as the request."""


class Channel(NamedTuple):
    """The source of replies: an edition, the number of one of its id rules, and the node; None if any."""

    edition: Edition
    rule: int
    node: int | None


class Opened(NamedTuple):
    """A channel on which a request is answered, and the number of replies there, at most."""

    channel: Channel
    replies: int


Limit = tuple[Parts, Callable[[Any], Any]]
"""Bits of the data that do not all have a meaning: the bits, and whether a raw integer is allowed."""


@dataclass(frozen=True, eq=False)
class MessageForm:
    """A message that a frame can be; `constants` is None if a constant in the id differs.

    Data with other `constants` is rejected. Data with other `reserved` bits, or beyond the limits, is not sent by a
    program that obeys the spec, but received. Data is one integer, or an array of them.
    """

    message: Message
    node: int | None
    constants: MaskedBits | None
    reserved: MaskedBits
    limits: tuple[Limit, ...]

    def has_constants(self, data: Any) -> Any:
        """Whether all constants have their values."""
        return self.constants is not None and data & self.constants.mask == self.constants.value

    def is_regular(self, data: Any) -> Any:
        """Whether a program that obeys the spec can send this data."""
        regular = data & self.reserved.mask == self.reserved.value
        for parts, allows in self.limits:
            if regular is False:
                break
            regular = regular & allows(bits_at(parts, data))
        return regular


class IdClass(NamedTuple):
    """The nodes that an id can mean, and the data bits that identify a frame: all keys, and the node if the id has none.

    `only` is the direction of all frames with this id; None if it has both. A reply answers a request that opened one of
    `answers`.
    """

    nodes: tuple[int | None, ...]
    key_bits: int
    only: Direction | None
    answers: tuple[Channel, ...]


@dataclass(eq=False, kw_only=True)
class FrameClass:
    """The messages of an edition that a frame can be, by its id, its length, its keys and the node in its data.

    A request is answered on the channels `opens`. `identified` are the results of the dispatch plan.
    """

    edition: Edition
    decoder: Decoder
    of_id: IdClass
    identified: Mapping[Direction, Identified | Rejection]
    request: MessageForm | None
    replies: tuple[MessageForm, ...]
    opens: tuple[Opened, ...]
    with_checks: frozenset[Message]
    _replies_to: dict[FrameClass, Identified | None] = field(default_factory=dict)

    @property
    def forms(self) -> Sequence[MessageForm]:
        """The messages, replies first."""
        return [*self.replies, *([self.request] if self.request else [])]

    @cached_property
    def command(self) -> Command:
        """The command of the request."""
        assert self.request is not None
        return self.edition.command(self.request.message.command)

    @cached_property
    def is_echoed(self) -> bool:
        """Whether the node sends the request back."""
        return self.request is not None and self.command.is_echoed

    @cached_property
    def alternatives(self) -> frozenset[Message]:
        """The replies that a node sends instead of others."""
        return frozenset(reply.message for reply in self.command.replies if reply.is_alternative)

    @cached_property
    def has_node_in_data(self) -> bool:
        """Whether the node in the data of the request or of a reply decides which frames answer it."""
        plans = exchange_plans(self.edition)[self.request.message] if self.request else ()
        return any(plan.asked is not None or plan.reported is not None for plan in plans)

    @cached_property
    def is_certain(self) -> bool:
        """Whether the data does not decide which frames answer a frame of this class, but for an echo."""
        if self.request is None:
            return True
        identified = self.identified[Direction.REQUEST]
        is_request = isinstance(identified, Identified) and identified.message is self.request.message
        return is_request and self.request.message not in self.with_checks and not self.has_node_in_data

    def reply_to(self, asking: FrameClass, request: CanFrame, reply: CanFrame) -> Identified | None:
        """The message with which a frame of this class answers a request of class `asking`; None if it does not."""
        if asking.has_node_in_data or (asking.is_echoed and request.data != reply.data):
            return _answer(self.decoder, request, reply)
        if asking not in self._replies_to:
            self._replies_to[asking] = _answer(self.decoder, request, reply)
        return self._replies_to[asking]

    def rejection(self, direction: Direction, frame: CanFrame) -> Rejection | None:
        """The reason why a frame is no message of a direction; None if it is one."""
        identified = self.identified[direction]
        if isinstance(identified, Rejection):
            return identified
        return rejects_checked(identified.message, frame, {}) if identified.message in self.with_checks else None


class DirectionRule:
    """How the directions of the frames of a class are decided on a bus of some behaviour.

    `only` is the direction of all frames with this id, and that of all frames of the log if it is `by_log`. `window` is
    the time in ns within which the request is answered.
    """

    def __init__(self, frame_class: FrameClass, behaviour: Behaviour, window: int | None) -> None:
        self.frame_class = frame_class
        self.behaviour = behaviour
        self.by_log = frame_class.of_id.only is None and behaviour.only is not None
        self.only = frame_class.of_id.only or behaviour.only
        self.request = frame_class.request
        self._own_time: int | None = None
        if self.request is not None:
            within = frame_class.command.reply_within_ms
            self._own_time = None if within is None else int(within * 1_000_000)
            message, reserved = self.request.message, self.request.reserved
            value = next((bits.value for bits in behaviour.old_bits if bits.request is message), reserved.value)
            # Bits that each reply reserves, too, do not show that a frame is one.
            of_replies = functools.reduce(operator.or_, (~reply.reserved.mask for reply in frame_class.replies), 0)
            mask = 0 if value is None else reserved.mask & of_replies
            self.request = replace(self.request, reserved=MaskedBits(mask, (value or 0) & mask))
        self.window = max(bus_window(frame_class.edition, behaviour, window), self._own_time or 0)

    @cached_property
    def _is_shared(self) -> bool:
        """Whether all data can be a reply, and be a request but for its reserved bits and limits."""
        forms = self.frame_class.forms
        free = not any(form.constants is None or form.constants.mask for form in forms)
        return self.request is not None and len(forms) > 1 and free

    def content(self, data: Any) -> Any:
        """What data can be, in the bits IS_REQUEST, IS_REPLY and IS_REGULAR; data is one integer, or an array."""
        if self.only is not None:
            return 0  # the content does not matter
        if self._is_shared:
            assert self.request is not None
            return self.request.is_regular(data) * IS_REGULAR | (IS_REQUEST | IS_REPLY)
        bits: Any = 0
        if self.request is not None:
            bits = self.request.has_constants(data) * IS_REQUEST | self.request.is_regular(data) * IS_REGULAR
        for form in self.frame_class.replies:
            bits = bits | form.has_constants(data) * IS_REPLY
        return bits

    @cached_property
    def within(self) -> int:
        """The time in ns within which the reply is expected, at most the window; a later frame can be a request.

        That of the spec; of the log if replies take longer. Shorter ones show less, because some pairs are wrong.
        """
        stated, usual = self._stated_time, self.behaviour.reply_time or 0
        is_by_time = any(bits.value is None for bits in self.behaviour.old_bits)
        if self._own_time is None and (is_by_time or usual > (stated or WINDOW)):
            return min(self.window, self.late_after or SOON)
        return min(self.window, stated or SOON)

    @cached_property
    def late_after(self) -> int | None:
        """The time in ns after which a reply is late: by the spec and, half as long again as nine of ten take, by the log.

        None if neither is known.
        """
        if self._own_time is not None or self.behaviour.reply_time is None:
            return self._stated_time
        return max(self._stated_time or 0, self.behaviour.reply_time * 3 // 2)

    @property
    def _stated_time(self) -> int | None:
        """The time of the command, or twice that of the bus, because the reply has to be sent too."""
        within = self.frame_class.edition.bus.reply_within_ms
        if self._own_time is not None or within is None or self.request is None:
            return self._own_time
        return int(2 * within * 1_000_000)


def bus_window(edition: Edition, behaviour: Behaviour, window: int | None) -> int:
    """The time in ns within which a request is answered, but for commands with a reply time of their own.

    That which is given; None for the time that suits the edition and the bus.
    """
    if window is not None:
        return window
    return max(WINDOW, int(2 * (edition.bus.reply_within_ms or 0) * 1_000_000), 2 * (behaviour.reply_time or 0))


class FrameClasses:
    """Finds the classes of the frames of one edition."""

    def __init__(self, edition: Edition) -> None:
        self.edition = edition
        self._decoder = Decoder(edition)
        self._with_checks = frozenset(
            message
            for message in edition.all_messages()
            if any(not isinstance(check, CheckParameter) for check in message_plan(message).checks)
        )
        rules = dict.fromkeys(reply.id for reply in edition.messages(Direction.REPLY))
        self._rules = {rule: number for number, rule in enumerate(rules)}
        self._answers = only_by_request(edition)
        self._ids: dict[tuple[int, bool, bool], IdClass] = {}
        self._classes: dict[tuple[int, bool, bool, int, int], FrameClass] = {}

    def id_class(self, frame: CanFrame) -> IdClass:
        """What the id of a frame can mean; without nodes if it is no id of this edition."""
        id_ = frame.id, frame.extended, frame.remote
        if id_ not in self._ids:
            if len(self._ids) >= MAX_CLASSES:
                self._ids.clear()
            having = [message for message in self.edition.all_messages() if has_id_rule(message, frame)]
            in_data = [message.node_bits for message in having if message.id.nodes is None]
            runs = [*(key for message in having for key in message.keys), *(bits for bits in in_data if bits)]
            nodes = dict.fromkeys(node_in_id(message, frame) for message in having)
            exact = [message for message in having if has_id(message, frame)] or having
            directions = {message.direction for message in exact}
            sources = [(m.id, node_in_id(m, frame)) for m in exact if m.direction is Direction.REPLY]
            self._ids[id_] = IdClass(
                tuple(nodes),
                data_bits((run.space, run.segments) for run in runs),
                next(iter(directions)) if len(directions) == 1 else None,
                tuple(dict.fromkeys(self._channel(rule, n) for rule, node in sources for n in (node, None))),
            )
        return self._ids[id_]

    def of(self, frame: CanFrame) -> FrameClass:
        """The class of a frame."""
        bits = int.from_bytes(frame.data, "little") & self.id_class(frame).key_bits
        known = (frame.id, frame.extended, frame.remote, len(frame.data), bits)
        if known not in self._classes:
            if len(self._classes) >= MAX_CLASSES:
                self._classes.clear()
            self._classes[known] = self._class(frame)
        return self._classes[known]

    def _class(self, frame: CanFrame) -> FrameClass:
        identified = {direction: self._decoder.identify(direction, frame) for direction in Direction}
        known = {each.message.direction: each.message for each in identified.values() if isinstance(each, Identified)}
        reply, asking = known.get(Direction.REPLY), known.get(Direction.REQUEST)
        answers = [answer for answer in self._answers if answer is not reply and is_message(answer, frame)]
        request = form_of(asking, frame) if asking else None
        return FrameClass(
            edition=self.edition,
            decoder=self._decoder,
            of_id=self.id_class(frame),
            identified=identified,
            request=request,
            replies=tuple(form_of(message, frame) for message in (reply, *answers) if message),
            opens=self._opens(request) if request else (),
            with_checks=self._with_checks,
        )

    def _opens(self, request: MessageForm) -> tuple[Opened, ...]:
        command = self.edition.command(request.message.command)
        nodes = command.from_each or (request.node,)
        opened: dict[Channel, int] = {}
        for reply in command.replies:
            rule = reply.message.id
            for node in nodes:
                channel = self._channel(rule, node if rule.nodes is not None else None)
                opened[channel] = opened.get(channel, 0) + (0 if reply.is_alternative else reply.frames)
        return tuple(Opened(channel, max(1, frames)) for channel, frames in opened.items())

    def _channel(self, rule: IdRule, node: int | None) -> Channel:
        return Channel(self.edition, self._rules[rule], node)


frame_classes = functools.lru_cache(maxsize=32)(FrameClasses)
"""The classes of the frames of an edition, found once for all logs."""


def _answer(decoder: Decoder, request: CanFrame, reply: CanFrame) -> Identified | None:
    answer = check_reply(decoder, request, reply)
    return answer if isinstance(answer, Identified) else None


def form_of(message: Message, frame: CanFrame) -> MessageForm:
    """A message that a frame can be by its id, its length and its keys."""
    always = [f for f in message.layout.fields if not f.only]
    plan = message_plan(message)
    in_id = [f for f in plan.required if f.space is Space.ID and not f.only]
    limited = [(f, _allows(f.type)) for f in always if f.is_given and f.space is Space.DATA]
    return MessageForm(
        message=message,
        node=node_of(message, frame),
        constants=None if wrong_constants(in_id, frame) else plan.constants,
        reserved=MaskedBits(0, 0) if frame.remote else plan.reserved,
        limits=tuple((parts_of(e.segments), allows) for f, allows in limited if allows for e in f.elements),
    )


def _allows(type_: Type) -> Callable[[Any], Any] | None:
    """Whether the raw bits of a type are valid under some parameters; None if all are.

    The function takes one integer, or an array of unsigned ones.
    """
    full = 1 << type_.width
    cases = [case for _, case in valid_raws(type_).distinct()]
    if isinstance(cases[0], FlagBits):
        unnamed = (full - 1) & ~cases[0].mask
        return lambda bits: bits & unnamed == 0
    if isinstance(cases[0], NamedRaws):
        return _any_of([_is_between(run.start, run.stop - 1, full) for run in cases[0].runs])
    spans = [case for case in cases if isinstance(case, RawInterval) and not (case.low_bound or case.high_bound)]
    if len(spans) < len(cases):
        return None
    limits = min(span.low for span in spans), max(span.high for span in spans)
    if limits == type_.number_limits:
        return None
    return _any_of([_is_between(*limits, full), *(_is_between(r[0], r[-1], full) for r in spans[0].no_values)])


def _any_of(tests: Sequence[Callable[[Any], Any]]) -> Callable[[Any], Any]:
    """Whether raw bits pass one of the tests."""
    if len(tests) == 1:
        return tests[0]
    return lambda bits: functools.reduce(operator.or_, [test(bits) for test in tests])


def _is_between(low: int, high: int, full: int) -> Callable[[Any], Any]:
    """Whether raw bits, of which there are `full`, are in a range; negative numbers are in two's complement."""
    if low > high:
        return lambda bits: bits < 0
    offset, mask, span = -low % full, full - 1, high - low
    return lambda bits: (bits + offset) & mask <= span
