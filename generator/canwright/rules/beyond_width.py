"""A range lies within what the bits hold."""

from __future__ import annotations

from .. import words
from ..model import Edition, Encoding
from .rule import Found


def check(edition: Edition) -> Found:
    for type_ in edition.types:
        if type_.encoding is Encoding.FLOAT:
            continue
        low, high = type_.raw_limits
        for _, limits in type_.raw_range.distinct():
            if limits is None:
                continue
            ends = [end.constant for end in (limits.low, limits.high) if end.parameter is None]
            if any(end < low or end > high for end in ends):
                text = (
                    f"the raw range {words.span(limits)} is not within {low}..{high}, all that {type_.width} bits hold"
                )
                yield (*type_.path, "raw_range"), text, "check the range, and sign and width in `raw`"
