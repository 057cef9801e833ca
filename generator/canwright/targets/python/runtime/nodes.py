"""The nodes of one bus, each with its edition."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Protocol, TypeVar

from ._codec import CodecError, Message, Refusal

M = TypeVar("M", bound=Message)


class Edition(Protocol):
    """A module of this package; choose the one of your firmware."""

    @property
    def EDITION(self) -> str: ...  # noqa: N802

    @property
    def UNKNOWN(self) -> Any: ...  # noqa: N802

    def decode_request(
        self, can_id: int, data: bytes, parameters: Any = ..., *, extended: bool = ..., remote: bool = ...
    ) -> Message: ...

    def decode_reply(
        self, can_id: int, data: bytes, parameters: Any = ..., *, extended: bool = ..., remote: bool = ...
    ) -> Message: ...

    def node_of(self, direction: str, can_id: int, *, extended: bool = ..., remote: bool = ...) -> int | None: ...

    def ids_of(self, direction: str, node: int) -> Iterable[tuple[int, int, bool, bool]]: ...


class Node:
    """A node: its edition, its number, and its `Parameters` of that edition."""

    def __init__(self, edition: Edition, node: int, parameters: Any = None) -> None:
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
        """A message to or from this node, of a class of its edition. Raises CodecError and TypeError."""
        if message.__module__ != getattr(self.edition, "__name__", None):
            raise TypeError(f"{message.__module__}.{message.__name__} is of another edition than {self!r}")
        known = {"parameters": self.parameters} if "parameters" in message.__init__.__annotations__ else {}
        return _made(message, node=self.node, **values, **known)

    def has(self, direction: str, can_id: int, extended: bool = False, remote: bool = False) -> bool:
        """Whether an id belongs to this node, as a `request` to it or a `reply` from it."""
        try:
            node = self.edition.node_of(direction, can_id, extended=extended, remote=remote)
        except CodecError:
            return False
        return node is None or node == self.node

    def ids_of(self, direction: str) -> Iterable[tuple[int, int, bool, bool]]:
        """The ids of this node, as a `request` or a `reply`; see the function of the edition."""
        return self.edition.ids_of(direction, self.node)

    def decode_request(self, can_id: int, data: bytes, *, extended: bool = False, remote: bool = False) -> Message:
        """Decodes a request to this node. Raises CodecError."""
        return self.edition.decode_request(can_id, data, self.parameters, extended=extended, remote=remote)

    def decode_reply(self, can_id: int, data: bytes, *, extended: bool = False, remote: bool = False) -> Message:
        """Decodes a reply from this node. Raises CodecError."""
        return self.edition.decode_reply(can_id, data, self.parameters, extended=extended, remote=remote)


class Nodes:
    """The nodes of one bus. Each frame is decoded by the edition of the node that sent it.

    Raises ValueError when two nodes would reply with the same id.
    """

    def __init__(self, nodes: Iterable[Node]) -> None:
        self._nodes = tuple(nodes)
        self._by_edition: dict[int, tuple[Edition, dict[int | None, tuple[int, Node]]]] = {}
        taken: list[tuple[Node, int, int, tuple[bool, bool]]] = []
        for place, one in enumerate(self._nodes):
            _, by_number = self._by_edition.setdefault(id(one.edition), (one.edition, {None: (place, one)}))
            by_number.setdefault(one.node, (place, one))
            own = [(one, can_id, mask, (extended, remote)) for can_id, mask, extended, remote in one.ids_of("reply")]
            for _, can_id, mask, kind in own:
                for other, other_id, other_mask, other_kind in taken:
                    if kind == other_kind and not (can_id ^ other_id) & ~(mask | other_mask):
                        raise ValueError(
                            f"{other!r} and {one!r} both reply with the id 0x{can_id:X}; give one another number"
                        )
            taken += own

    def __iter__(self) -> Iterator[Node]:
        return iter(self._nodes)

    def decode_request(self, can_id: int, data: bytes, *, extended: bool = False, remote: bool = False) -> Message:
        """Decodes a request with the edition of the node it goes to. Raises CodecError."""
        node = self._of("request", can_id, extended, remote)
        return node.decode_request(can_id, data, extended=extended, remote=remote)

    def decode_reply(self, can_id: int, data: bytes, *, extended: bool = False, remote: bool = False) -> Message:
        """Decodes a reply with the edition of the node that sent it. Raises CodecError."""
        node = self._of("reply", can_id, extended, remote)
        return node.decode_reply(can_id, data, extended=extended, remote=remote)

    def _of(self, direction: str, can_id: int, extended: bool, remote: bool) -> Node:
        """The first node with an id. Each edition is asked once, no matter how many nodes use it."""
        found: list[tuple[int, Node]] = []
        for edition, by_number in self._by_edition.values():
            try:
                number = edition.node_of(direction, can_id, extended=extended, remote=remote)
            except CodecError:
                continue
            if number in by_number:
                found.append(by_number[number])
        if not found:
            raise CodecError(Refusal.UNKNOWN_ID, f"no node of this bus has a {direction} with the id 0x{can_id:X}")
        return min(found, key=lambda one: one[0])[1]


def _made(build: Callable[..., M], **values: Any) -> M:
    return build(**values)
