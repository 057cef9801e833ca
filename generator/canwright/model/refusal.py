"""The reasons for which frames and values are rejected."""

from __future__ import annotations

from enum import Enum


class Refusal(str, Enum):
    """The reason for which a frame or a value is rejected; the same in every target."""

    UNKNOWN_ID = "unknown_id"
    """No message of this direction has this CAN id."""
    UNKNOWN_CODE = "unknown_code"
    """A message has this id, but none has this code."""
    WRONG_LENGTH = "wrong_length"
    """The message has another DLC."""
    WRONG_CONSTANT = "wrong_constant"
    """A constant field has another value."""
    MISSING_PARAMETER = "missing_parameter"
    """The result depends on a parameter that is not given."""
    NO_SCALE = "no_scale"
    """The type has no scale; only its raw integer is known."""
    OUT_OF_RANGE = "out_of_range"
    """The value exceeds the range or the width of the type, or is none of its named values."""
    NOT_FINITE = "not_finite"
    """NaN or infinity."""
    UNKNOWN_NODE = "unknown_node"
    """The address has no such node."""
    NOT_ANSWER = "not_answer"
    """The reply does not belong to the request: other node, other code, or an echo that differs."""
    NOT_AVAILABLE = "not_available"
    """Nodes with these parameters do not have the command."""
    WRONG_CHECKSUM = "wrong_checksum"
    """A checksum is not that of the frame."""
    NO_VALUE = "no_value"
    """The raw integer means that there is no value. No frame is rejected for this, only a conversion to a number."""
    WRONG_MESSAGE = "wrong_message"
    """Receivers identify a frame with these values as another message."""
