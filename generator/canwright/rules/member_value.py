"""The values of an enum and the bits of flags are distinct and fit."""

from __future__ import annotations

from ..model import Edition, Member, Path, Type
from .rule import Found


def check(edition: Edition) -> Found:
    for type_ in edition.types:
        low, high = type_.raw_limits
        yield from _members(type_, "enum", type_.enum, low, high)
        yield from _members(type_, "flags", type_.flags, 0, type_.width - 1)


def _members(type_: Type, key: str, members: tuple[Member, ...], low: int, high: int) -> Found:
    first: dict[int, str] = {}
    for member in members:
        path: Path = (*type_.path, key, member.name)
        if member.value in first:
            yield path, f"`{member.name}` and `{first[member.value]}` are both {member.value}", "give each its own"
        elif not low <= member.value <= high:
            yield path, f"{member.value} is not within {low}..{high}, all that {type_.width} bits hold", ""
        first.setdefault(member.value, member.name)
