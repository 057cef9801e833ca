"""Conversion to and from the messages of python-can, and recognition of the frames that a program sent itself."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, overload

import can

from ._codec import CodecError, Message, Refusal
from .exchange import LATER_COPY, Copies, Frame

if TYPE_CHECKING:
    from typing_extensions import Buffer

M = TypeVar("M", bound=Message, covariant=True)


class Decoder(Protocol[M]):
    """`decode_request` or `decode_reply` of an edition, or `partial(decode_answer, SomeRequest)`."""

    def __call__(self, can_id: int, data: Buffer, parameters: Any = ..., *, extended: bool, remote: bool) -> M: ...


class NodeDecoder(Protocol[M]):
    """`decode_request` or `decode_reply` of `Node` or `Nodes`, which know the parameters."""

    def __call__(self, can_id: int, data: Buffer, *, extended: bool, remote: bool) -> M: ...


def to_message(message: Message) -> can.Message:
    """A frame for a python-can bus."""
    return can.Message(
        arbitration_id=message.can_id,
        is_extended_id=message.EXTENDED,
        is_remote_frame=message.REMOTE,
        is_fd=message.FD,
        bitrate_switch=message.BIT_RATE_SWITCH,
        dlc=message.DLC,
        data=None if message.REMOTE else message.encode(),
    )


@overload
def from_message(frame: can.Message, decode: Decoder[M], parameters: Any = None) -> M: ...
@overload
def from_message(frame: can.Message, decode: NodeDecoder[M]) -> M: ...
def from_message(frame: can.Message, decode: Any, parameters: Any = None) -> Any:
    """Decodes a frame of a python-can bus. Raises CodecError, also for error frames, and for CAN FD frames of a classic bus.

    It does not matter who sent the frame: a request that the bus returns can be decoded as a reply. See `OwnFrames`.
    """
    if frame.is_error_frame:
        raise CodecError(Refusal.UNKNOWN_ID, f"0x{frame.arbitration_id:X} is an error frame")
    known = () if parameters is None else (parameters,)
    message: Message = decode(
        frame.arbitration_id,
        frame.data,
        *known,
        extended=frame.is_extended_id,
        remote=frame.is_remote_frame,
    )
    if frame.is_fd and not message.FD:
        raise CodecError(Refusal.UNKNOWN_ID, f"0x{frame.arbitration_id:X} is a CAN FD frame")
    return message


def decoded(decode: NodeDecoder[M], frame: Frame) -> M | None:
    """The message in a frame; None if it is rejected, also one of CAN FD for a classic bus."""
    can_id, extended, remote, fd, data = frame
    try:
        message: Any = decode(can_id, data, extended=extended, remote=remote)
    except CodecError:
        return None
    return message if message.FD or not fd else None


class OwnFrames:
    """Sends on a bus, and recognizes the frames that the bus returns.

    Where requests and replies have the same ids, a returned request is also a valid reply. Whether a bus returns frames
    depends on the adapter, its driver and its settings; `is_rx` of a frame does not identify own frames on every adapter.
    """

    def __init__(self, bus: can.BusABC, *, are_returned: bool) -> None:
        self.bus = bus
        self.are_returned = are_returned
        self._copies = Copies(are_returned)

    @classmethod
    def learn(cls, bus: can.BusABC, request: Message, decode: Decoder[Any], timeout: float) -> OwnFrames:
        """Sends a request to learn whether it comes back besides its reply, which has to differ from it.

        `decode` is `partial(decode_answer, request)`. Raises TimeoutError if neither comes within a time in seconds,
        because nothing is certain then: without another node on the bus, a frame is neither sent nor returned.
        """
        sent = frame_of(to_message(request))
        is_returned = is_answered = False
        bus.send(to_message(request))
        deadline = monotonic() + timeout
        while (left := deadline - monotonic()) > 0 and (frame := bus.recv(left)) is not None:
            if frame_of(frame) == sent:
                is_returned = True
            elif not is_answered and decoded(decode, frame_of(frame)) is not None:
                is_answered = True
                deadline = min(deadline, monotonic() + LATER_COPY)
        if not (is_returned or is_answered):
            raise TimeoutError(f"no reply to {request}")
        return cls(bus, are_returned=is_returned)

    def send(self, message: Message) -> None:
        """Sends a frame. Raises what the bus raises."""
        frame = to_message(message)
        self._copies.add(frame_of(frame))
        try:
            self.bus.send(frame)
        except can.CanError:
            self.is_own(frame)
            raise

    def is_own(self, frame: can.Message) -> bool:
        """Whether a received frame is one that was sent. Each counts once, so an equal one, such as an echo, is not."""
        return self._copies.take(frame_of(frame))


def frame_of(message: can.Message) -> Frame:
    """What a frame and its copy have in common; the id is -1 for error frames, which are never sent."""
    can_id = -1 if message.is_error_frame else message.arbitration_id
    return can_id, message.is_extended_id, message.is_remote_frame, message.is_fd, bytes(message.data)
