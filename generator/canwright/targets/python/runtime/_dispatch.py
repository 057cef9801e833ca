"""Identification of frames, and of replies to requests."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import takewhile
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar, Union, cast

from ._codec import CodecError, Message, Refusal, Request

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

Table = tuple[int, Mapping[int, Unpack]]
"""The position of a data byte, and `unpack` of the message for each value of that byte."""


class Route:
    """The messages that share one rule from node to CAN id, and the decisions between them.

    `mask` are the bits of the id that messages fill in. `answers` are messages that a frame can be only if their
    request is known; without it, the frame is another message of that code.
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
    ) -> None:
        self.base = base
        self.step = step
        self.nodes = nodes
        self.then = then
        self.mask = mask
        self.extended = extended
        self.remote = remote
        self.classes = frozenset((*_classes(then), *answers))

    def node(self, can_id: int) -> tuple[bool, int | None]:
        """Whether an id belongs to this route, and its node."""
        rest = (can_id & ~self.mask) - self.base
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
            raise CodecError(node, self._refusal_text(node, can_id, data))
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
            return 0, dict.fromkeys(range(256), node.unpack)
        if not isinstance(node.read, DataByte) or node.read.position >= length:
            return None
        return node.read.position, {value: self._unpack_below(then, length) for value, then in node.cases.items()}

    def _unpack_below(self, node: Node, length: int) -> Unpack:
        """What unpacks the frames that belong to a node."""
        if not isinstance(node, (Select, Refusal)):
            return node.unpack
        table = self._table(node, length)
        return self.unpack if table is None else _unpack_by(*table, self.unpack)

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


def _unpack_by(position: int, cases: Mapping[int, Unpack], otherwise: Unpack) -> Unpack:
    """The function that decides by a data byte."""

    def unpack(node: int | None, can_id: int, data: bytes, parameters: Any) -> Any:
        return cases.get(data[position], otherwise)(node, can_id, data, parameters)

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
        for route in takewhile(_can_be_listed, self.routes):
            tables = {} if route.remote else route.tables()
            for can_id, node in route.ids():
                self._listed.setdefault((can_id, route.extended, route.remote), (route, node))
                self._by_kind[route.extended, route.remote].setdefault(can_id, (node, tables))
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
        node: int | None
        unpack: Unpack | None
        try:
            by_id = self._by_kind[extended, remote] if extended or remote else self._by_id
            node, tables = by_id[can_id]
            position, cases = tables[len(data)]
            unpack = cases[data[position]]
        except KeyError:
            node = unpack = None
        if unpack is None:
            route, node = self.find(can_id, extended, remote)
            unpack = route.unpack
        message: M = unpack(node, can_id, data, parameters)
        return message

    def find(self, can_id: int, extended: bool, remote: bool) -> tuple[Route, int | None]:
        """The route and the node of an id. Raises CodecError (unknown_id)."""
        listed = self._listed.get((can_id, extended, remote))
        if listed is not None:
            return listed
        for route in self.routes:
            if (route.extended, route.remote) == (extended, remote):
                ours, node = route.node(can_id)
                if ours:
                    return route, node
        kind = ("29-bit " if extended else "") + ("remote " if remote else "")
        text = f"no {self.direction} has the {kind}id 0x{can_id:X}"
        other = next((route for route in self.routes if route.node(can_id)[0]), None)
        if other is not None:
            given = (("extended", extended, other.extended), ("remote", remote, other.remote))
            wanted = ", ".join(f"{name}={there}" for name, here, there in given if here != there)
            text += f"; with {wanted} there is one"
        raise CodecError(Refusal.UNKNOWN_ID, text)

    def ids(self, node: int) -> Iterator[tuple[int, int, bool, bool]]:
        """The ids of a node, each with its mask, whether it has 29 bits, and whether it is for remote frames."""
        for route in self.routes:
            if route.nodes is not None and node in route.nodes:
                yield route.base + node * route.step, route.mask, route.extended, route.remote


def _can_be_listed(route: Route) -> bool:
    """Whether all ids of a route are few enough to be listed."""
    return not route.mask and (route.nodes is None or len(route.nodes) <= MAX_IDS)


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

    def check_source(
        self, request: type[Message], to: int | None, mask: int, node: int | None, can_id: int, data: bytes
    ) -> None:
        """Checks that a reply comes from the right node. Raises CodecError (not_answer).

        `node` is that of the id of the reply. The request went to node `to`, of which the bits of `mask` are known; None
        when its node is unknown.
        """
        expected, known = (self.nodes, -1) if self.nodes else (() if to is None else (to,), mask)
        sources = [(node, known)]
        if self.reply_node:
            read, bits = self.reply_node
            sources.append((read(can_id, data), known & bits))
        for source, bits in sources:
            if source is not None and expected and all((source ^ one) & bits for one in expected):
                listed = " or ".join(map(str, expected))
                raise not_answer(f"{request.__name__} went to node {listed}, this came from node {source}")


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
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> int | None:
        """The node in the id of a `request` or a `reply`, or else in its data; None without one.

        Raises CodecError: unknown_id; with `data`, also unknown_code and wrong_length.
        """
        route, node = self._router(direction).find(can_id, extended, remote)
        if node is not None or data is None:
            return node
        data = bytes(memoryview(data))
        read = self._nodes_in_data.get(route.message(can_id, data))
        return None if read is None else read(can_id, data)

    def has_node_in_data(self, direction: str, can_id: int, *, extended: bool = False, remote: bool = False) -> bool:
        """Whether requests or replies with this id have their node in the data. Raises CodecError (unknown_id)."""
        route, _ = self._router(direction).find(can_id, extended, remote)
        return not route.classes.isdisjoint(self._nodes_in_data)

    def _router(self, direction: str) -> Router[P, Any]:
        return self.requests if direction == "request" else self.replies

    def ids_of(self, direction: str, node: int) -> tuple[tuple[int, int, bool, bool], ...]:
        """The ids of a node, as a `request` or a `reply`, each with a mask of the bits that messages fill in.

        The last two items are True for a 29-bit id, and for remote frames.
        """
        return tuple(self._router(direction).ids(node))

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
        data = bytes(memoryview(data))
        if isinstance(request, type):
            answer = self._answer(request)
            node = self._node_of_answer(answer, can_id, data, extended, remote)
            answer.check_source(request, None, -1, node, can_id, data)
        else:
            answer = self._answer(type(request))
            sent = (type(request), request.node, request.can_id, request.encode())
            node = self._answering_node(*sent, can_id, data, extended, remote)
        known = self._unknown if parameters is None else parameters
        return cast(R, answer.reply.unpack(node, can_id, data, known))

    def check_reply(
        self,
        request_id: int,
        request: Buffer,
        reply_id: int,
        reply: Buffer,
        *,
        extended: bool = False,
        remote: bool = False,
        reply_extended: bool | None = None,
        reply_remote: bool = False,
    ) -> None:
        """Checks that a frame answers a request. Raises CodecError (not_answer, or why the request is rejected).

        `extended` and `remote` describe the request; `reply_extended` is needed where the reply has another kind of id.
        """
        request, reply = bytes(memoryview(request)), bytes(memoryview(reply))
        route, to = self.requests.find(request_id, extended, remote)
        sent = route.message(request_id, request)
        self._check_constants(sent, to, request_id, request)
        kind = (extended if reply_extended is None else reply_extended, reply_remote)
        self._answering_node(sent, to, request_id, request, reply_id, reply, *kind)

    def _check_constants(self, sent: type[Message], to: int | None, request_id: int, request: bytes) -> None:
        """Checks the constants of a request, whatever its parameters are. Raises CodecError (wrong_constant)."""
        try:
            sent.unpack(to, request_id, request, self._unknown)
        except CodecError as error:
            if error.refusal is not Refusal.MISSING_PARAMETER:
                raise

    def _answering_node(
        self,
        sent: type[Message],
        to: int | None,
        request_id: int,
        request: bytes,
        reply_id: int,
        reply: bytes,
        extended: bool,
        remote: bool,
    ) -> int | None:
        """The node that answers a request which was sent to node `to`. Raises CodecError (not_answer)."""
        answer = self._answer(sent)
        try:
            node = self._node_of_answer(answer, reply_id, reply, extended, remote)
        except CodecError as error:
            raise not_answer(f"{sent.__name__} is not answered by this: {error}") from error
        mask = -1
        if answer.request_node:
            to, mask = answer.request_node[0](request_id, request), answer.request_node[1]
        answer.check_source(sent, to, mask, node, reply_id, reply)
        if answer.echo and reply != request:
            raise not_answer(f"{sent.__name__} comes back as it was sent, this differs")
        return node

    def _answer(self, request: type[Message]) -> Answer:
        """The reply to a request. Raises CodecError (not_answer) when it has none."""
        answer = self._answers.get(request)
        if answer is None:
            raise not_answer(f"{request.__name__} has no reply")
        return answer

    def _node_of_answer(self, answer: Answer, can_id: int, data: bytes, extended: bool, remote: bool) -> int | None:
        """The node that sent the reply of an answer. Raises CodecError when the frame is not this reply."""
        reply = answer.reply
        route, node = self.replies.find(can_id, extended, remote)
        if reply not in route.classes:
            raise CodecError(Refusal.UNKNOWN_ID, f"0x{can_id:X} is no id of {reply.__name__}")
        if can_id & answer.unused:
            raise CodecError(Refusal.UNKNOWN_ID, f"0x{can_id:X} has bits that are 0 in every {reply.__name__}")
        if len(data) != reply.DLC and not remote:
            raise CodecError(Refusal.WRONG_LENGTH, f"0x{can_id:X} has {len(data)} data bytes, not {reply.DLC}")
        for read, codes in answer.selectors:
            if read(can_id, data) not in codes:
                raise CodecError(Refusal.UNKNOWN_CODE, f"0x{can_id:X} does not have the code of {reply.__name__}")
        return node


def not_answer(text: str) -> CodecError:
    """The error for a frame that does not answer a request."""
    return CodecError(Refusal.NOT_ANSWER, text)
