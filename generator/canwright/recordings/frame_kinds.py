"""What the frames of one id, length and key bits can be, in each direction; computed once for each such kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from ..model.edition import Edition
from ..model.layout import Element, Field, ReservedRole, Space
from ..model.message import Direction, IdRule, Message
from ..model.types import Type
from ..semantics.candidates import Candidates
from ..semantics.decoder import Decoder, Identified, Rejection, rejects_constants
from ..semantics.exchange import check_reply
from ..semantics.frame import CanFrame, data_bits, has_id_rule, node_of, raw_of


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


@dataclass(frozen=True, eq=False)
class Form:
    """A message that a frame can be. Other `constants` are rejected; other `reserved` bits are ignored by a receiver."""

    message: Message
    node: int | None
    constants: Bits
    reserved: Bits
    limits: tuple[tuple[Field, Callable[[int], bool]], ...]
    """Fields with names or a range, and whether a raw integer has a name or is in the range."""

    def has_constants(self, data: int) -> bool:
        return data & self.constants.mask == self.constants.value

    def is_regular(self, data: int, frame: CanFrame) -> bool:
        """Whether a sender that obeys the spec can send this data: reserved bits, names and ranges."""
        if data & self.reserved.mask != self.reserved.value:
            return False
        for limited, allows in self.limits:
            raw = raw_of(limited, frame)
            if not (all(map(allows, raw)) if isinstance(raw, list) else allows(raw)):
                return False
        return True


@dataclass(eq=False, kw_only=True)
class FrameKind:
    """The messages of an edition that a frame can be, by its id, its length and the bits of all keys.

    A request is answered on the channels `opens`; a reply answers a request that opened one of `answers`. `identified`
    are the results of the dispatch plan. `only` is the direction of all frames with this id; None if it has both.
    """

    edition: Edition
    decoder: Decoder
    identified: Mapping[Direction, Identified | Rejection]
    only: Direction | None
    request: Form | None
    replies: tuple[Form, ...]
    opens: tuple[Opened, ...]
    answers: tuple[Channel, ...]
    _replies_to: dict[FrameKind, Identified | None] = field(default_factory=dict)

    @cached_property
    def is_distinct(self) -> bool:
        """Whether a reply can set bits that the request reserves."""
        reserved = self.request.reserved.mask if self.request else -1
        return any(reserved & ~reply.reserved.mask for reply in self.replies)

    @cached_property
    def is_echoed(self) -> bool:
        """Whether the node sends the request back."""
        return self.request is not None and self.edition.command(self.request.message.command).is_echoed

    @cached_property
    def _has_node_in_data(self) -> bool:
        assert self.request is not None
        reply = self.edition.command(self.request.message.command).reply
        return any(message.node_bits for message in (self.request.message, reply) if message)

    def reply_to(self, asking: FrameKind, request: CanFrame, reply: CanFrame) -> Identified | None:
        """The message with which a frame of this kind answers a request of kind `asking`; None if it does not."""
        if asking.is_echoed and request.data != reply.data:
            return None
        if asking._has_node_in_data:
            return _answer(self.decoder, request, reply)
        if asking not in self._replies_to:
            self._replies_to[asking] = _answer(self.decoder, request, reply)
        return self._replies_to[asking]

    def rejection(self, direction: Direction, frame: CanFrame) -> Rejection | None:
        """The reason why a frame is no message of a direction; None if it is one."""
        found = self.identified[direction]
        return found if isinstance(found, Rejection) else rejects_constants(found.message, frame, {})


class FrameKinds:
    """Finds the kinds of the frames of one edition; `number` distinguishes the editions of a log."""

    def __init__(self, edition: Edition, number: int) -> None:
        self.edition = edition
        self.number = number
        self._decoder = Decoder(edition)
        self._candidates = Candidates(edition)
        rules = dict.fromkeys(reply.id for reply in edition.messages(Direction.REPLY))
        self._rules = {rule: index for index, rule in enumerate(rules)}

    def nodes(self, frame: CanFrame) -> Sequence[int | None]:
        """The nodes that the id of a frame can mean; empty if it is no id of this edition."""
        return list(dict.fromkeys(node_of(m, frame) for m in self.edition.all_messages() if has_id_rule(m, frame)))

    def key_bits(self, frame: CanFrame) -> int:
        """The data bits of all keys of the messages with the id of a frame."""
        having = [message for message in self.edition.all_messages() if has_id_rule(message, frame)]
        return data_bits((key.space, key.segments) for message in having for key in message.keys)

    def kind(self, frame: CanFrame) -> FrameKind:
        """The kind of a frame."""
        identified = {direction: self._decoder.identify(direction, frame) for direction in Direction}
        forms = [_form(message, frame) for message in self._candidates.of(frame)]
        requests = [form for form in forms if form.message.direction is Direction.REQUEST]
        having = [message for message in self.edition.all_messages() if has_id_rule(message, frame)]
        directions = {message.direction for message in having}
        sources = [(message.id, node_of(message, frame)) for message in having if message.direction is Direction.REPLY]
        return FrameKind(
            edition=self.edition,
            decoder=self._decoder,
            identified=identified,
            only=directions.pop() if len(directions) == 1 else None,
            request=requests[0] if requests else None,
            replies=tuple(form for form in forms if form.message.direction is Direction.REPLY),
            opens=self._opens(requests[0]) if requests else (),
            answers=tuple(dict.fromkeys(self._channel(rule, n) for rule, node in sources for n in (node, None))),
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


def _form(message: Message, frame: CanFrame) -> Form:
    fields = message.layout.fields
    always = [f for f in fields if not f.only]
    ignored = [f for f in always if isinstance(f.role, ReservedRole)]
    free = data_bits((f.space, e.segments) for f in fields if f not in ignored for e in f.elements)
    keys = data_bits((key.space, key.segments) for key in message.keys)
    everything = (1 << 8 * len(frame.data)) - 1
    return Form(
        message=message,
        node=node_of(message, frame),
        constants=_bits(f for f in always if f.demanded is not None),
        reserved=Bits(everything & ~(free | keys), _bits(ignored).value),
        limits=tuple((f, _allows(f.type)) for f in always if f.fixed is None and _is_limited(f.type)),
    )


def _bits(fields: Iterable[Field]) -> Bits:
    """The data bits of fields that always have the same raw value."""
    mask = value = 0
    for one in fields:
        for element in one.elements if one.space is Space.DATA and one.fixed is not None else ():
            mask |= data_bits([(one.space, element.segments)])
            value |= _placed(element, one.fixed or 0)
    return Bits(mask, value)


def _placed(element: Element, raw: int) -> int:
    return sum((raw >> s.raw_low & (1 << s.width) - 1) << s.byte * 8 + s.low for s in element.segments)


def _is_limited(type_: Type) -> bool:
    return bool(type_.enum or type_.flags or type_.raw_range.parameter or type_.raw_range.constant)


def _allows(type_: Type) -> Callable[[int], bool]:
    """Whether a sender can send a raw integer, under some parameters."""
    if type_.enum:
        return frozenset(member.value for member in type_.enum).__contains__
    if type_.flags:
        unnamed = ~sum(1 << flag.value for flag in type_.flags)
        return lambda raw: not raw & unnamed
    spans = [span for _, span in type_.raw_range.distinct()]
    if any(span is None or not span.is_constant for span in spans):
        return lambda _: True
    low = min(span.low.constant for span in spans if span)
    high = max(span.high.constant for span in spans if span)
    return lambda raw: low <= raw <= high
