"""Identification of frames, and of replies to requests."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar, Union, cast

from ._codec import CodecError, Message, Refusal, Request, id_node, missing

if TYPE_CHECKING:
    from typing_extensions import Buffer

Reader = Callable[[int, bytes], int]
"""Reads a number from id and data."""


class DataByte:
    """Reads one data byte; 0 where the data is shorter."""

    def __init__(self, position: int) -> None:
        self.position = position

    def __call__(self, can_id: int, data: bytes) -> int:
        return data[self.position] if self.position < len(data) else 0


def data_length(can_id: int, data: bytes) -> int:
    """The number of data bytes."""
    return len(data)


class Select(NamedTuple):
    """A decision between messages: the case with the number that is read, or else `otherwise`."""

    read: Reader
    cases: Mapping[int, Node]
    otherwise: Node


Node = Union[Select, type[Message], Refusal]  # noqa: UP007 - `Node` in `Select` is a forward reference
"""A decision, the message that a frame is, or the reason for its rejection."""

Unpack = Callable[[int | None, int, bytes, Any], Any]
"""`unpack` of a message, or a function that finds the message and calls its `unpack`."""

Table = tuple[int, Sequence[Unpack]]
"""The position of a data byte, and `unpack` of the message for each value of that byte."""

BYTES = range(256)
"""The values of a data byte."""


class Route:
    """The messages that share one rule from node to CAN id, and the decisions between them.

    `mask` are the bits of the id that messages fill in. `answers` are messages that a frame can be only if their
    request is known; without it, the frame is another message of that code. `parameter_step` times the value of a
    `parameter` is added to each id.
    """

    def __init__(
        self,
        base: int,
        step: int,
        nodes: range | None,
        then: Node,
        *,
        mask: int = 0,
        extended: bool = False,
        remote: bool = False,
        answers: tuple[type[Message], ...] = (),
        parameter: str = "",
        parameter_step: int = 1,
    ) -> None:
        self.base = base
        self.parameter = parameter
        self.parameter_step = parameter_step
        self.step = step
        self.nodes = nodes
        self.then = then
        self.mask = mask
        self.kind = extended, remote
        self.classes = frozenset((*_classes(then), *answers))

    def offset(self, parameters: Any) -> int | None:
        """The part of the ids that is a parameter; None where that is unknown."""
        if not self.parameter:
            return 0
        value = getattr(parameters, self.parameter, None)
        return None if value is None else int(value) * self.parameter_step

    def node(self, can_id: int, parameters: Any = None) -> tuple[bool, int | None]:
        """Whether an id belongs to this route, and its node."""
        offset = self.offset(parameters)
        if offset is None:
            return False, None
        rest = (can_id & ~self.mask) - self.base - offset
        if self.nodes is None:
            return rest == 0, None
        node = rest // self.step
        return rest == node * self.step and node in self.nodes, node

    def ids(self) -> Iterator[tuple[int, int | None]]:
        """Every id of this route, without the bits of `mask`, and its node."""
        for node in [None] if self.nodes is None else self.nodes:
            yield self.base + (node or 0) * self.step, node

    def message(self, can_id: int, data: bytes) -> type[Message]:
        """The message that a frame is. Raises CodecError (unknown_id, unknown_code, wrong_length)."""
        node = self.then
        while isinstance(node, Select):
            node = node.cases.get(node.read(can_id, data), node.otherwise)
        if isinstance(node, Refusal):
            refusal = node
            raise CodecError(refusal, lambda: self._refusal_text(refusal, can_id, data))
        return node

    def unpack(self, node: int | None, can_id: int, data: bytes, parameters: Any) -> Any:
        """The message of a frame. Raises CodecError."""
        return self.message(can_id, data).unpack(node, can_id, data, parameters)

    def tables(self) -> dict[int, Table]:
        """The table of each data length of a message for which a data byte decides."""
        lengths = sorted({message.DLC for message in self.classes if message.DLC and not message.REMOTE})
        tables = ((length, self._table(self.then, length)) for length in lengths)
        return {length: table for length, table in tables if table is not None}

    def _table(self, node: Node, length: int) -> Table | None:
        """The decision of a node for data of one length; None if it is none by a data byte."""
        while isinstance(node, Select) and node.read is data_length:
            node = node.cases.get(length, node.otherwise)
        if isinstance(node, Refusal):
            return None
        if not isinstance(node, Select):
            return 0, [node.unpack] * len(BYTES)
        if not isinstance(node.read, DataByte) or node.read.position >= length:
            return None
        below = {value: self._unpack_below(then, length) for value, then in node.cases.items()}
        return node.read.position, [below.get(value, self.unpack) for value in BYTES]

    def _unpack_below(self, node: Node, length: int) -> Unpack:
        """What unpacks the frames that belong to a node."""
        if not isinstance(node, (Select, Refusal)):
            return node.unpack
        table = self._table(node, length)
        return self.unpack if table is None else _unpack_by(*table)

    def _refusal_text(self, refusal: Refusal, can_id: int, data: bytes) -> str:
        path = [self.then]
        while isinstance(node := path[-1], Select):
            path.append(node.cases.get(node.read(can_id, data), node.otherwise))
        selects = [node for node in path if isinstance(node, Select)]
        if refusal is Refusal.WRONG_LENGTH:
            lengths = next(node.cases for node in reversed(selects) if node.read is data_length)
            return f"0x{can_id:X} has {len(data)} data bytes, not {' or '.join(map(str, lengths))}"
        if refusal is Refusal.UNKNOWN_ID:
            return f"0x{can_id:X} has the bits 0x{selects[-1].read(can_id, data):X}, which are 0 in this message"
        codes = " and ".join(f"0x{node.read(can_id, data):02X}" for node in selects if node.read is not data_length)
        return f"0x{can_id:X} has the unknown code {codes}"


def _unpack_by(position: int, cases: Sequence[Unpack]) -> Unpack:
    """The function that decides by a data byte."""

    def unpack(node: int | None, can_id: int, data: bytes, parameters: Any) -> Any:
        return cases[data[position]](node, can_id, data, parameters)

    return unpack


def _classes(node: Node) -> Iterator[type[Message]]:
    """The messages below a node."""
    if isinstance(node, Select):
        for below in (*node.cases.values(), node.otherwise):
            yield from _classes(below)
    elif not isinstance(node, Refusal):
        yield node


P = TypeVar("P")
M = TypeVar("M", bound=Message)

MAX_IDS = 1 << 11
"""The most ids of a route that are listed; each 11-bit id fits in."""


Tables = tuple[int | None, dict[int, Table]]
"""The node of an id, and the table for each data length."""


class Router(Generic[P, M]):
    """All routes of one direction; `P` is the `Parameters` of the edition, `M` the messages that can be decoded.

    Most frames are found by look-ups that are made from the routes: the id leads to the node and to a table for each
    data length, a data byte leads to the message. All other frames are decided by the routes.
    """

    def __init__(self, direction: str, routes: Iterable[Route], unknown: P) -> None:
        self.direction = direction
        self.routes = tuple(routes)
        self._unknown = unknown
        self._listed: dict[tuple[int, bool, bool], tuple[Route, int | None]] = {}
        kinds = [(extended, remote) for extended in (False, True) for remote in (False, True)]
        self._by_kind: dict[tuple[bool, bool], dict[int, Tables]] = {kind: {} for kind in kinds}
        listed = tuple(takewhile(_can_be_listed, self.routes))
        self._unlisted = self.routes[len(listed) :]
        for route in listed:
            tables = {} if route.kind[1] else route.tables()
            for can_id, node in route.ids():
                self._listed.setdefault((can_id, *route.kind), (route, node))
                self._by_kind[route.kind].setdefault(can_id, (node, tables))
        self._by_id = self._by_kind[False, False]

    def decode(
        self, can_id: int, data: Buffer, parameters: P | None = None, *, extended: bool = False, remote: bool = False
    ) -> M:
        """Decodes a frame of this direction by itself; a reply is decoded without knowledge of its request.

        Raises CodecError when the frame is rejected, TypeError when `data` is not bytes-like.
        """
        if type(data) is not bytes:
            data = bytes(memoryview(data))
        if parameters is None:
            parameters = self._unknown
        by_id = self._by_kind[extended, remote] if extended or remote else self._by_id
        message: M
        listed = by_id.get(can_id)
        if listed is not None:
            node, tables = listed
            table = tables.get(len(data))
            if table is not None:
                position, cases = table
                message = cases[data[position]](node, can_id, data, parameters)
                return message
        route, node = self.find(can_id, extended, remote, parameters)
        message = route.unpack(node, can_id, data, parameters)
        return message

    def find(
        self, can_id: int, extended: bool, remote: bool, parameters: Any = None, only: type[Message] | None = None
    ) -> tuple[Route, int | None]:
        """The route and the node of an id, of any message or one.

        Raises CodecError: unknown_id, or missing_parameter if it may have an id then.
        """
        listed = self._listed.get((can_id, extended, remote))
        if listed is not None:
            return listed
        unknown = ""
        for route in self._unlisted:
            if route.kind == (extended, remote) and (only is None or only in route.classes):
                ours, node = route.node(can_id, parameters)
                if ours:
                    return route, node
                if route.offset(parameters) is None:
                    unknown = unknown or route.parameter
        if unknown:
            raise missing(unknown, None, f"whether 0x{can_id:X} is an id of a {self.direction}")
        raise CodecError(Refusal.UNKNOWN_ID, lambda: self._unknown_id_text(can_id, extended, remote))

    def _unknown_id_text(self, can_id: int, extended: bool, remote: bool) -> str:
        """Why no route has an id, and with which kind of frame one would."""
        kind = ("29-bit " if extended else "") + ("remote " if remote else "")
        text = f"no {self.direction} has the {kind}id 0x{can_id:X}"
        for route in self.routes:
            if route.node(can_id)[0]:
                given = zip(("extended", "remote"), (extended, remote), route.kind, strict=True)
                wanted = ", ".join(f"{name}={there}" for name, here, there in given if here != there)
                return f"{text}; with {wanted} there is one"
        return text

    def ids(self, node: int, parameters: Any = None) -> Iterator[tuple[int, int, bool, bool]]:
        """The ids of a node, each with its mask, whether it has 29 bits, and whether it is for remote frames.

        Those with an unknown parameter are left out.
        """
        for route in self.routes:
            offset = route.offset(parameters)
            if route.nodes is not None and node in route.nodes and offset is not None:
                yield route.base + node * route.step + offset, route.mask, *route.kind


def _can_be_listed(route: Route) -> bool:
    """Whether all ids of a route are few enough to be listed."""
    return not route.mask and not route.parameter and (route.nodes is None or len(route.nodes) <= MAX_IDS)


@dataclass(frozen=True)
class Answer:
    """The reply to a request: its class and its selectors, each with the accepted values.

    The reply comes from one of `nodes`; if there are none, from the node of the request. `request_node` and
    `reply_node` read the node from a field of the request and of the reply, each with a mask of the bits it has. An
    `echo` equals its request. `unused` are bits of the id that are 0 in the reply and that other messages fill in.
    """

    reply: type[Message]
    selectors: tuple[tuple[Reader, tuple[int, ...]], ...]
    nodes: tuple[int, ...] = ()
    echo: bool = False
    unused: int = 0
    request_node: tuple[Reader, int] | None = None
    reply_node: tuple[Reader, int] | None = None
    further: tuple[Answer, ...] = ()
    """The other replies that follow this one or come instead, each without further ones."""

    def fitting(self, check: Callable[[Answer], object]) -> Answer:
        """The first of the replies for which `check` raises no CodecError; this one if there is none."""
        for answer in (self, *self.further) if self.further else ():
            try:
                check(answer)
            except CodecError:
                continue
            return answer
        return self

    def check(
        self,
        sent: type[Message],
        to: int | None,
        request_id: int,
        request: bytes,
        node: int | None,
        reply_id: int,
        reply: bytes,
    ) -> None:
        """Checks that a reply answers a request, which went to node `to`. Raises CodecError (not_answer).

        `node` is that of the id of the reply.
        """
        mask = -1
        if self.request_node:
            to, mask = self.request_node[0](request_id, request), self.request_node[1]
        self.check_source(sent, to, mask, node, reply_id, reply)
        if self.echo and reply != request:
            raise not_answer(f"{sent.__name__} comes back as it was sent, this differs")

    def check_source(
        self, sent: type[Message], to: int | None, mask: int, node: int | None, can_id: int, data: bytes
    ) -> None:
        """Checks that a reply comes from the right node. Raises CodecError (not_answer).

        Of node `to` the bits of `mask` are known; it is None when the node of the request is unknown.
        """
        if self.nodes:
            expected, known = self.nodes, -1
        elif to is not None:
            expected, known = (to,), mask
        else:
            return
        if node is not None and node not in expected:
            _check_node(sent, node, expected, known)
        if self.reply_node:
            read, bits = self.reply_node
            _check_node(sent, read(can_id, data), expected, known & bits)


def _check_node(sent: type[Message], node: int, expected: tuple[int, ...], mask: int) -> None:
    """Checks that a node agrees with an expected one in the bits of a mask. Raises CodecError (not_answer)."""
    if all((node ^ number) & mask for number in expected):
        listed = " or ".join(map(str, expected))
        raise not_answer(f"{sent.__name__} went to node {listed}, this came from node {node}")


Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)


class Dispatcher(Generic[P, Q, M]):
    """Decodes the requests `Q` and the replies `M` of one edition; `P` is its `Parameters`."""

    def __init__(
        self,
        *,
        requests: Iterable[Route],
        replies: Iterable[Route],
        answers: Mapping[type[Message], Answer],
        nodes_in_data: Mapping[type[Message], Reader] = MappingProxyType({}),
        unknown: P,
    ) -> None:
        self.requests: Router[P, Q] = Router("request", requests, unknown)
        self.replies: Router[P, M] = Router("reply", replies, unknown)
        self._answers = answers
        self._nodes_in_data = nodes_in_data
        self._unknown = unknown

    def node_of(
        self,
        direction: str,
        can_id: int,
        data: Buffer | None = None,
        parameters: P | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> int | None:
        """The node in the id of a `request` or a `reply`, or else in its data; None without one.

        Raises CodecError: unknown_id, missing_parameter; with `data`, also unknown_code and wrong_length.
        """
        node, mask = self.node_bits_of(direction, can_id, data, parameters, extended=extended, remote=remote)
        return node if mask == -1 else None

    def node_bits_of(
        self,
        direction: str,
        can_id: int,
        data: Buffer | None = None,
        parameters: P | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> tuple[int, int]:
        """The node as `node_of` has it, or the low bits of it that the data contains; and a mask of the known bits.

        The mask is -1 if the node is known, 0 if nothing of it is. Raises CodecError as `node_of` does.
        """
        route, node = self._router(direction).find(can_id, extended, remote, parameters)
        if node is not None or data is None:
            return (0, 0) if node is None else (node, -1)
        data = bytes(memoryview(data))
        message = route.message(can_id, data)
        read = self._nodes_in_data.get(message)
        return (0, 0) if read is None else (read(can_id, data), message.NODE_MASK)

    def has_node_in_data(
        self,
        direction: str,
        can_id: int,
        parameters: P | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> bool:
        """Whether requests or replies with this id have their node, or its low bits, in the data.

        Raises CodecError (unknown_id, missing_parameter).
        """
        route, _ = self._router(direction).find(can_id, extended, remote, parameters)
        return not route.classes.isdisjoint(self._nodes_in_data)

    def _router(self, direction: str) -> Router[P, Any]:
        return self.requests if direction == "request" else self.replies

    def ids_of(self, direction: str, node: int, parameters: P | None = None) -> tuple[tuple[int, int, bool, bool], ...]:
        """The ids of a node, as a `request` or a `reply`, each with a mask of the bits that messages fill in.

        The last two items are True for a 29-bit id, and for remote frames. Ids with an unknown parameter are left out.
        """
        return tuple(self._router(direction).ids(node, parameters))

    def decode_answer(
        self,
        request: type[Request[R]] | Request[R],
        can_id: int,
        data: Buffer,
        parameters: P | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> R:
        """Decodes the reply to a request; to any request of a class if a class is given.

        Raises CodecError: not_answer when the frame does not answer the request, that no frame answers, or that goes to
        other nodes; for a class, the reason for which the frame is not its reply. Raises TypeError when `data` is not
        bytes-like.
        """
        if type(data) is not bytes:
            data = bytes(memoryview(data))
        message: Message | None
        sent: type[Message]
        message, sent = (None, request) if isinstance(request, type) else (request, type(request))
        answer = self._answers.get(sent) or self._answer(sent)
        if answer.further:
            answer = self._fitting(answer, request, can_id, data, (extended, remote), parameters)
        reply: Any = None
        if answer.reply_node is None:
            try:
                reply = self.replies.decode(can_id, data, parameters, extended=extended, remote=remote)
            except CodecError:
                reply = None  # what follows says why the frame is no answer
        if type(reply) is answer.reply:  # it identifies itself without the request, as most replies do
            node = id_node(reply)
        else:
            reply = None
            kind = extended, remote
            node = self._node_of_answer(answer, None if message is None else sent, can_id, data, kind, parameters)
        to = None if message is None else id_node(message)
        if message is not None and (answer.echo or answer.request_node):
            answer.check(sent, message.node, message.can_id, message.encode(), node, can_id, data)
        elif node != to or answer.nodes or answer.reply_node:
            answer.check_source(sent, to, -1, node, can_id, data)
        if reply is None:
            reply = answer.reply.unpack(node, can_id, data, self._unknown if parameters is None else parameters)
        return cast("R", reply)

    def replies_to(self, request: type[Message]) -> tuple[type[Message], ...]:
        """The classes of the replies to a request: those that follow each other, then those that come instead."""
        answer = self._answers.get(request)
        return (answer.reply, *(further.reply for further in answer.further)) if answer else ()

    def share_a_reply(self, one: type[Message], other: type[Message]) -> bool:
        """Whether one frame can answer requests of both classes."""
        ours, theirs = (self._answers.get(request) for request in (one, other))
        if ours is None or theirs is None:
            return False
        return any(_overlap(a, b) for a in (ours, *ours.further) for b in (theirs, *theirs.further))

    def _fitting(
        self,
        answer: Answer,
        request: type[Message] | Message,
        can_id: int,
        data: bytes,
        kind: tuple[bool, bool],
        parameters: P | None,
    ) -> Answer:
        """The reply to a request, or to any of a class, that a frame is; the first one if it is none."""

        def check(each: Answer) -> None:
            if isinstance(request, type):
                node = self._node_of_answer(each, None, can_id, data, kind, parameters)
                each.check_source(request, None, -1, node, can_id, data)
            else:
                sent = type(request)
                node = self._node_of_answer(each, sent, can_id, data, kind, parameters)
                each.check(sent, request.node, request.can_id, request.encode(), node, can_id, data)

        return answer.fitting(check)

    def check_reply(
        self,
        request_id: int,
        request: Buffer,
        reply_id: int,
        reply: Buffer,
        parameters: P | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
        reply_extended: bool | None = None,
        reply_remote: bool = False,
    ) -> None:
        """Checks that a frame answers a request. Raises CodecError (not_answer, or why the request is rejected).

        `extended` and `remote` describe the request; `reply_extended` is needed where the reply has another kind of id.
        Of the parameters, only those in ids matter.
        """
        request, reply = bytes(memoryview(request)), bytes(memoryview(reply))
        route, to = self.requests.find(request_id, extended, remote, parameters)
        sent = route.message(request_id, request)
        self._check_constants(sent, to, request_id, request)
        kind = (extended if reply_extended is None else reply_extended, reply_remote)

        def check(answer: Answer) -> None:
            node = self._node_of_answer(answer, sent, reply_id, reply, kind, parameters)
            answer.check(sent, to, request_id, request, node, reply_id, reply)

        check(self._answer(sent).fitting(check))

    def _check_constants(self, sent: type[Message], to: int | None, request_id: int, request: bytes) -> None:
        """Checks the constants of a request, whatever its parameters are. Raises CodecError (wrong_constant)."""
        try:
            sent.unpack(to, request_id, request, self._unknown)
        except CodecError as error:
            if error.refusal is not Refusal.MISSING_PARAMETER:
                raise

    def _answer(self, request: type[Message]) -> Answer:
        """The reply to a request. Raises CodecError (not_answer) when it has none."""
        answer = self._answers.get(request)
        if answer is None:
            raise not_answer(f"{request.__name__} has no reply")
        return answer

    def _node_of_answer(
        self,
        answer: Answer,
        sent: type[Message] | None,
        can_id: int,
        data: bytes,
        kind: tuple[bool, bool],
        parameters: P | None,
    ) -> int | None:
        """The node in the id of an answer. Raises CodecError when the frame is not the reply: not_answer if it was `sent`."""
        try:
            return self._node_of_reply(answer, can_id, data, kind, parameters)
        except CodecError as error:
            if sent is None:
                raise
            raise not_answer(f"{sent.__name__} is not answered by this: {error}") from error

    def _node_of_reply(
        self, answer: Answer, can_id: int, data: bytes, kind: tuple[bool, bool], parameters: P | None
    ) -> int | None:
        """The node that sent the reply of an answer. Raises CodecError when the frame is not this reply."""
        reply = answer.reply
        route, node = self.replies.find(can_id, *kind, parameters, reply)
        if reply not in route.classes:
            raise CodecError(Refusal.UNKNOWN_ID, f"0x{can_id:X} is no id of {reply.__name__}")
        if can_id & answer.unused:
            raise CodecError(Refusal.UNKNOWN_ID, f"0x{can_id:X} has bits that are 0 in every {reply.__name__}")
        if len(data) != reply.DLC and not kind[1]:
            raise CodecError(Refusal.WRONG_LENGTH, f"0x{can_id:X} has {len(data)} data bytes, not {reply.DLC}")
        for read, codes in answer.selectors:
            if read(can_id, data) not in codes:
                raise CodecError(Refusal.UNKNOWN_CODE, f"0x{can_id:X} does not have the code of {reply.__name__}")
        return node


def _overlap(one: Answer, other: Answer) -> bool:
    """Whether a frame can be both replies."""
    pairs = [(a, b) for read, a in one.selectors for also, b in other.selectors if read is also]
    return one.reply.DLC == other.reply.DLC and all(set(a) & set(b) for a, b in pairs)


def not_answer(text: str) -> CodecError:
    """The error for a frame that does not answer a request."""
    return CodecError(Refusal.NOT_ANSWER, text)
