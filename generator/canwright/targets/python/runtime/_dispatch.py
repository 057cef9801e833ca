"""Identification of frames, and of replies to requests."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar, Union, cast

from ._codec import CodecError, Message, Refusal, Request

Reader = Callable[[int, bytes], int]
"""Reads a number from id and data."""


class Select(NamedTuple):
    """A decision between messages: the case with the number that is read, or else `otherwise`."""

    read: Reader
    cases: Mapping[int, Node]
    otherwise: Node


Node = Union[Select, type[Message], Refusal]  # noqa: UP007 - `Node` in `Select` is a forward reference
"""A decision, the message that a frame is, or the reason for its rejection."""


def data_length(can_id: int, data: bytes) -> int:
    """The number of data bytes."""
    return len(data)


class Route:
    """The messages that share one rule from node to CAN id, and the decisions between them.

    `mask` are the bits of the id that messages fill in. `answers` are messages that identify a frame only if their
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
        self.length, self.selector, self.by_code = _direct(then)

    def node(self, can_id: int) -> tuple[bool, int | None]:
        """Whether an id belongs to this route, and its node."""
        rest = (can_id & ~self.mask) - self.base
        if self.nodes is None:
            return rest == 0, None
        node = rest // self.step
        return rest == node * self.step and node in self.nodes, node

    def message(self, can_id: int, data: bytes) -> type[Message]:
        """The message that a frame is. Raises CodecError (unknown_id, unknown_code, wrong_length)."""
        if len(data) == self.length:
            found = self.by_code.get(self.selector(can_id, data))
            if found is not None:
                return found
        node = self.then
        while isinstance(node, Select):
            node = node.cases.get(node.read(can_id, data), node.otherwise)
        if isinstance(node, Refusal):
            raise CodecError(node, self._refusal_text(node, can_id, data))
        return node

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


def _direct(then: Node) -> tuple[int, Reader, dict[int, type[Message]]]:
    """The most common length, its selector, and the messages identified by both; length -1 without any."""
    if isinstance(then, Select) and then.read is data_length and len(then.cases) == 1:
        ((length, by_code),) = then.cases.items()
        if isinstance(by_code, Select):
            return (
                length,
                by_code.read,
                {c: m for c, m in by_code.cases.items() if not isinstance(m, (Select, Refusal))},
            )
    return -1, data_length, {}


def _classes(node: Node) -> Iterator[type[Message]]:
    """The messages below a node."""
    if isinstance(node, Select):
        for below in (*node.cases.values(), node.otherwise):
            yield from _classes(below)
    elif not isinstance(node, Refusal):
        yield node


class Router:
    """All routes of one direction."""

    def __init__(self, direction: str, routes: tuple[Route, ...]) -> None:
        self.direction = direction
        self.routes = routes
        self.direct: dict[int, tuple[Route, int | None]] = {}
        for route in reversed(routes):
            if not route.mask and not route.extended and not route.remote:
                for node in [None] if route.nodes is None else route.nodes:
                    self.direct[route.base + (node or 0) * route.step] = (route, node)

    def find(self, can_id: int, extended: bool, remote: bool) -> tuple[Route, int | None]:
        """The route and the node of an id. Raises CodecError (unknown_id)."""
        if not extended and not remote:
            found = self.direct.get(can_id)
            if found is not None:
                return found
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


@dataclass(frozen=True)
class Answer:
    """The reply to a request: its class and its selectors, each with the accepted values.

    The reply comes from one of `nodes`; if there are none, from the node of the request. `request_node` and
    `reply_node` read the node from a field of the request and of the reply, each with a mask of the bits it has. An
    `echo` equals its request. `unused` are bits of the id that are 0 in the reply and that other messages fill in.
    """

    reply: type[Message]
    selectors: tuple[tuple[Reader, tuple[int, ...]], ...]
    nodes: tuple[int, ...]
    echo: bool
    unused: int = 0
    request_node: tuple[Reader, int] | None = None
    reply_node: tuple[Reader, int] | None = None


P = TypeVar("P")
R = TypeVar("R", bound=Message)


class Dispatcher(Generic[P]):
    """Finds the message of a frame in one edition; `P` is the `Parameters` of the edition."""

    def __init__(
        self,
        *,
        requests: Iterable[Route],
        replies: Iterable[Route],
        answers: Mapping[type[Message], Answer],
        unknown: P,
    ) -> None:
        self._requests = Router("request", tuple(requests))
        self._replies = Router("reply", tuple(replies))
        self._answers = answers
        self._unknown = unknown

    def node_of(self, direction: str, can_id: int, *, extended: bool = False, remote: bool = False) -> int | None:
        """The node of the id of a `request` or a `reply`; None without one. Raises CodecError (unknown_id)."""
        return self._router(direction).find(can_id, extended, remote)[1]

    def ids_of(self, direction: str, node: int) -> tuple[tuple[int, int, bool, bool], ...]:
        """The ids of a node, as a `request` or a `reply`, each with a mask of the bits that messages fill in.

        The last two items are True for a 29-bit id, and for remote frames.
        """
        return tuple(self._router(direction).ids(node))

    def _router(self, direction: str) -> Router:
        return self._requests if direction == "request" else self._replies

    def decode_request(
        self, can_id: int, data: bytes, parameters: P | None = None, *, extended: bool = False, remote: bool = False
    ) -> Message:
        """Decodes a request. Raises CodecError."""
        route, node = self._requests.find(can_id, extended, remote)
        known = self._unknown if parameters is None else parameters
        return route.message(can_id, data).unpack(node, can_id, data, known)

    def decode_reply(
        self, can_id: int, data: bytes, parameters: P | None = None, *, extended: bool = False, remote: bool = False
    ) -> Message:
        """Decodes a reply without knowing its request. Raises CodecError."""
        route, node = self._replies.find(can_id, extended, remote)
        known = self._unknown if parameters is None else parameters
        return route.message(can_id, data).unpack(node, can_id, data, known)

    def decode_answer(
        self,
        request: type[Request[R]],
        can_id: int,
        data: bytes,
        parameters: P | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> R:
        """Decodes the reply to a request of that class. Raises CodecError, unknown_code when it answers another."""
        answer = self._answers.get(request)
        if answer is None:
            raise not_answer(f"{request.__name__} has no reply")
        node = self._node_of_answer(answer, can_id, data, extended, remote)
        known = self._unknown if parameters is None else parameters
        return cast(R, answer.reply.unpack(node, can_id, data, known))

    def check_reply(
        self,
        request_id: int,
        request: bytes,
        reply_id: int,
        reply: bytes,
        *,
        extended: bool = False,
        remote: bool = False,
        reply_extended: bool | None = None,
        reply_remote: bool = False,
    ) -> None:
        """Checks that a frame answers a request. Raises CodecError (not_answer, or why the request is rejected).

        `extended` and `remote` describe the request; `reply_extended` is needed where the reply has another kind of id.
        """
        route, node = self._requests.find(request_id, extended, remote)
        sent = route.message(request_id, request)
        answer = self._answers.get(sent)
        if answer is None:
            raise not_answer(f"{sent.__name__} has no reply")
        reply_extended = extended if reply_extended is None else reply_extended
        try:
            from_node = self._node_of_answer(answer, reply_id, reply, reply_extended, reply_remote)
        except CodecError as error:
            raise not_answer(f"{sent.__name__} is not answered by this: {error}") from error
        to, mask = (node, -1)
        if answer.request_node and not answer.nodes:
            to, mask = answer.request_node[0](request_id, request), answer.request_node[1]
        expected = answer.nodes or (() if to is None else (to,))
        sources = [(from_node, mask)]
        if answer.reply_node:
            sources.append((answer.reply_node[0](reply_id, reply), mask & answer.reply_node[1]))
        for source, bits in sources:
            if source is not None and expected and all((source ^ one) & bits for one in expected):
                raise not_answer(f"{sent.__name__} went to node {to}, this came from node {source}")
        if answer.echo and reply != request:
            raise not_answer(f"{sent.__name__} comes back as it was sent, this differs")

    def _node_of_answer(self, answer: Answer, can_id: int, data: bytes, extended: bool, remote: bool) -> int | None:
        """The node that sent the reply of an answer. Raises CodecError when the frame is not this reply."""
        reply = answer.reply
        route, node = self._replies.find(can_id, extended, remote)
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
