"""The nodes of one bus, each with its edition."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from ._codec import ClientFacts, CodecError, Message, Refusal

if TYPE_CHECKING:
    from typing_extensions import Buffer

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message, covariant=True)
A = TypeVar("A", bound=Message, covariant=True)


class Edition(Protocol[Q, A]):
    """A module of this package; choose the one of your firmware. `Q` are its requests, `A` its replies."""

    @property
    def EDITION(self) -> str: ...  # noqa: N802

    @property
    def REPLY_WITHIN_MS(self) -> float | None: ...  # noqa: N802

    @property
    def client_facts(self) -> ClientFacts: ...

    @property
    def decode_answer(self) -> Any: ...

    def replies_to(self, request: type[Message]) -> tuple[type[Message], ...]: ...

    def share_a_reply(self, one: type[Message], other: type[Message]) -> bool: ...

    @property
    def UNKNOWN(self) -> Any: ...  # noqa: N802

    def decode_request(
        self, can_id: int, data: Buffer, parameters: Any = ..., *, extended: bool = ..., remote: bool = ...
    ) -> Q: ...

    def decode_reply(
        self, can_id: int, data: Buffer, parameters: Any = ..., *, extended: bool = ..., remote: bool = ...
    ) -> A: ...

    def node_bits_of(
        self,
        direction: str,
        can_id: int,
        data: Buffer | None = ...,
        parameters: Any = ...,
        *,
        extended: bool = ...,
        remote: bool = ...,
    ) -> tuple[int, int]: ...

    def has_node_in_data(
        self, direction: str, can_id: int, parameters: Any = ..., *, extended: bool = ..., remote: bool = ...
    ) -> bool: ...

    def ids_of(self, direction: str, node: int, parameters: Any = ...) -> Iterable[tuple[int, int, bool, bool]]: ...


class Node(Generic[Q, A]):
    """A node: its edition, its number, and its `Parameters` of that edition."""

    def __init__(self, edition: Edition[Q, A], node: int, parameters: Any = None) -> None:
        self.edition = edition
        self.node = node
        self.parameters = edition.UNKNOWN if parameters is None else parameters
        if type(self.parameters) is not type(edition.UNKNOWN):
            made_for = type(self.parameters).__module__
            raise TypeError(
                f"these parameters are of {made_for}, the node speaks {edition.EDITION}; use its Parameters"
            )

    def __repr__(self) -> str:
        return f"Node({self.edition.EDITION}, {self.node})"

    def make(self, message: type[M], **values: Any) -> M:
        """A message to or from this node, of a class of its edition.

        Raises CodecError, also where nodes with these parameters do not have the command (not_available), and TypeError.
        A message without a node, such as a broadcast, is for every node on the bus; only its values are computed with the
        parameters of this node. The field that contains the node is set, too.
        """
        self.check(message)
        if "node" in values or "parameters" in values or message.NODE_FIELD in values:
            names = " and ".join(name for name in ("node", "parameters", message.NODE_FIELD) if name in values)
            raise TypeError(f"{self!r} sets {names} itself; leave it out")
        taken = message.__init__.__annotations__
        if "node" in taken:
            values["node"] = self.node
        if "parameters" in taken:
            values["parameters"] = self.parameters
        if message.NODE_FIELD:
            values[message.NODE_FIELD] = self.node & message.NODE_MASK
        build: Callable[..., M] = message
        return build(**values)

    def check(self, message: type[Message]) -> None:
        """Raises TypeError for a class of another edition, and CodecError if this node does not have its command."""
        if message.__module__ != getattr(self.edition, "__name__", None):
            raise TypeError(f"{message.__module__}.{message.__name__} is of another edition than {self!r}")
        message.check_available(self.parameters)

    def ids_of(self, direction: str) -> Iterable[tuple[int, int, bool, bool]]:
        """The ids of this node, as a `request` or a `reply`; see the function of the edition."""
        return self.edition.ids_of(direction, self.node, self.parameters)

    def decode_request(self, can_id: int, data: Buffer, *, extended: bool = False, remote: bool = False) -> Q:
        """Decodes a request to this node. Raises CodecError."""
        return self.edition.decode_request(can_id, data, self.parameters, extended=extended, remote=remote)

    def decode_reply(self, can_id: int, data: Buffer, *, extended: bool = False, remote: bool = False) -> A:
        """Decodes a reply from this node. Raises CodecError."""
        return self.edition.decode_reply(can_id, data, self.parameters, extended=extended, remote=remote)


class Numbering:
    """The counters of one sender: those of each message to or from each node increase separately."""

    def __init__(self) -> None:
        self._sent: dict[tuple[type[Message], int | None], dict[str, Any]] = {}

    def next(self, message: M) -> M:
        """The message to send: the first of its class and node as it is, each further one with the next counters.

        Raises CodecError as `check` does; the counters do not increase then.
        """
        if not message.COUNTERS:
            return message
        key = type(message), message.node
        sent = self._sent.get(key, {})
        counters = {name: counter.next(sent[name]) for name, counter in message.COUNTERS.items() if name in sent}
        message = message.replace(**{name: value for name, value in counters.items() if name in message.fields()})
        self._sent[key] = sent | {name: raw for name, raw in message.raw().items() if name in message.COUNTERS}
        return message


Key = int | tuple[int, bool, bool]
"""A CAN id; with `extended` and `remote` where one of them is True."""

MAX_KNOWN_IDS = 1 << 11
"""The most ids whose nodes are stored, or that are stored because no node has them; each 11-bit id of a direction fits in."""


class Nodes(Generic[Q, A]):
    """The nodes of one bus. Each frame is decoded by the edition and with the parameters of its node.

    A frame without a node in its id and its data, such as a broadcast, belongs to every node whose edition has that id.
    It is decoded with the parameters that are the same in all of them; the others are unknown. A frame that belongs to
    nodes of two editions is rejected (unknown_node): decode it with each of `nodes_of`, or with the one you want.

    Raises ValueError when two nodes would reply with the same id.
    """

    def __init__(self, nodes: Iterable[Node[Q, A]]) -> None:
        self._nodes = tuple(nodes)
        self._kinds = {(id(one.edition), one.parameters): one.edition for one in self._nodes}
        """Editions with the parameters of nodes, which ids may contain."""
        self._requests: dict[Key, tuple[Edition[Q, A], Any]] = {}
        self._replies: dict[Key, tuple[Edition[Q, A], Any]] = {}
        self._foreign: set[tuple[str, Key]] = set()
        taken: list[tuple[Node[Q, A], int, int, tuple[bool, bool]]] = []
        for one in self._nodes:
            own = [(one, can_id, mask, (extended, remote)) for can_id, mask, extended, remote in one.ids_of("reply")]
            for _, can_id, mask, kind in own:
                for other, other_id, other_mask, other_kind in taken:
                    if kind == other_kind and not (can_id ^ other_id) & ~(mask | other_mask):
                        raise ValueError(
                            f"{other!r} and {one!r} both reply with the id 0x{can_id:X}; give one another number"
                        )
            taken += own

    def __iter__(self) -> Iterator[Node[Q, A]]:
        return iter(self._nodes)

    def nodes_of(
        self,
        direction: str,
        can_id: int,
        data: Buffer | None = None,
        *,
        extended: bool = False,
        remote: bool = False,
    ) -> tuple[Node[Q, A], ...]:
        """The nodes that a `request` goes to, or that a `reply` comes from: all that its id and its data allow.

        If the data has the low bits of a node only, these are the nodes with these bits.
        """
        numbers: dict[tuple[int, Any], tuple[int, int]] = {}
        for kind, edition in self._kinds.items():
            try:
                numbers[kind] = edition.node_bits_of(direction, can_id, data, kind[1], extended=extended, remote=remote)
            except CodecError as error:
                if error.refusal not in (Refusal.UNKNOWN_ID, Refusal.MISSING_PARAMETER):
                    numbers[kind] = 0, 0
        known = ((one, numbers.get((id(one.edition), one.parameters))) for one in self._nodes)
        return tuple(one for one, bits in known if bits and not (one.node ^ bits[0]) & bits[1])

    def decode_request(self, can_id: int, data: Buffer, *, extended: bool = False, remote: bool = False) -> Q:
        """Decodes a request with the edition of the node it goes to. Raises CodecError."""
        key = (can_id, extended, remote) if extended or remote else can_id
        edition, parameters = self._requests.get(key) or self._edition("request", self._requests, key, data)
        return edition.decode_request(can_id, data, parameters, extended=extended, remote=remote)

    def decode_reply(self, can_id: int, data: Buffer, *, extended: bool = False, remote: bool = False) -> A:
        """Decodes a reply with the edition of the node that sent it. Raises CodecError."""
        key = (can_id, extended, remote) if extended or remote else can_id
        edition, parameters = self._replies.get(key) or self._edition("reply", self._replies, key, data)
        return edition.decode_reply(can_id, data, parameters, extended=extended, remote=remote)

    def _edition(
        self, direction: str, known: dict[Key, tuple[Edition[Q, A], Any]], key: Key, data: Buffer
    ) -> tuple[Edition[Q, A], Any]:
        """The edition and the parameters for a frame, which are stored in `known` for its id. Raises CodecError."""
        can_id, extended, remote = (key, False, False) if isinstance(key, int) else key
        is_foreign = (direction, key) in self._foreign
        having_id = () if is_foreign else self.nodes_of(direction, can_id, extended=extended, remote=remote)
        if not having_id:
            if len(self._foreign) < MAX_KNOWN_IDS:
                self._foreign.add((direction, key))
            raise CodecError(Refusal.UNKNOWN_ID, f"no node of this bus has a {direction} with the id 0x{can_id:X}")
        kinds = {(id(one.edition), one.parameters): one.edition for one in having_id}
        is_in_data = any(
            edition.has_node_in_data(direction, can_id, parameters, extended=extended, remote=remote)
            for (_, parameters), edition in kinds.items()
        )
        found = self.nodes_of(direction, can_id, data, extended=extended, remote=remote) if is_in_data else having_id
        if not found:
            raise CodecError(
                Refusal.UNKNOWN_NODE, f"this {direction} with the id 0x{can_id:X} is of no node of this bus"
            )
        edition = found[0].edition
        other = next((one for one in found if one.edition is not edition), None)
        if other is not None:
            text = f"0x{can_id:X} is a {direction} of {found[0]!r} and of {other!r}; decode it with one of these nodes"
            raise CodecError(Refusal.UNKNOWN_NODE, text)
        result = edition, _common([one.parameters for one in found])
        if not is_in_data and len(known) < MAX_KNOWN_IDS:
            known[key] = result
        return result


def _common(parameters: Sequence[Any]) -> Any:
    """The parameters with those known that are the same in all."""
    first = parameters[0]
    names = [field.name for field in fields(first)]
    differing = [name for name in names if any(getattr(one, name) != getattr(first, name) for one in parameters)]
    return replace(first, **dict.fromkeys(differing)) if differing else first
