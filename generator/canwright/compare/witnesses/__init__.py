"""Witness frames: what an old host and a new node make of one another's frames, by running both editions.

Belongs here: which frames are tried, how the meaning of two readings is compared, and the sentence about a witness.
"""

from __future__ import annotations

from ...model.edition import Edition
from .behaviour import Behaviour
from .witness import (
    REASONS as REASONS,
    SENTENCES as SENTENCES,
    Aspect as Aspect,
    Observation as Observation,
    Witness as Witness,
)


def observe(old: Edition, new: Edition) -> tuple[Observation, ...]:
    """Every way found in which an old host and a new node misunderstand one another."""
    return tuple(Behaviour(old, new).observations())
