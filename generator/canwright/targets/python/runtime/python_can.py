"""Conversion to and from the messages of python-can."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar, overload

import can

from ._codec import CodecError, Message, Refusal

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
        dlc=message.DLC,
        data=None if message.REMOTE else message.encode(),
    )


@overload
def from_message(frame: can.Message, decode: Decoder[M], parameters: Any = None) -> M: ...
@overload
def from_message(frame: can.Message, decode: NodeDecoder[M]) -> M: ...
def from_message(frame: can.Message, decode: Any, parameters: Any = None) -> Any:
    """Decodes a frame of a python-can bus. Raises CodecError, also for error and CAN FD frames."""
    if frame.is_error_frame or frame.is_fd:
        kind = "an error frame" if frame.is_error_frame else "a CAN FD frame"
        raise CodecError(Refusal.UNKNOWN_ID, f"0x{frame.arbitration_id:X} is {kind}")
    known = () if parameters is None else (parameters,)
    return decode(
        frame.arbitration_id,
        frame.data,
        *known,
        extended=frame.is_extended_id,
        remote=frame.is_remote_frame,
    )
