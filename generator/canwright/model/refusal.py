"""Why a frame or a value is refused."""

from __future__ import annotations

from enum import Enum


class Refusal(str, Enum):
    """Why a frame or a value is refused; the same words in every target."""

    UNKNOWN_ID = "unknown_id"
    """No message of this direction has this CAN id."""
    UNKNOWN_CODE = "unknown_code"
    """The id is known, the selector's value is not."""
    WRONG_LENGTH = "wrong_length"
    """The message has another DLC."""
    WRONG_CONSTANT = "wrong_constant"
    """A constant field holds something else."""
    MISSING_PARAMETER = "missing_parameter"
    """The answer depends on a parameter that was not given."""
    NO_SCALE = "no_scale"
    """There is a raw integer, and no way to a value."""
    OUT_OF_RANGE = "out_of_range"
    """The value is beyond the range, the bits, or the names of the type."""
    NOT_FINITE = "not_finite"
    """NaN or infinity."""
    UNKNOWN_NODE = "unknown_node"
    """The address has no such node."""
    NOT_ANSWER = "not_answer"
    """The reply does not belong to the request: other node, other code, or an echo that differs."""
