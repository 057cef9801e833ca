"""Messages that a receiver cannot distinguish have one layout."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from itertools import islice
from operator import or_
from typing import NamedTuple

from ..language.edition import EditionSpec
from ..model.edition import Edition
from ..model.layout import Space
from ..model.message import Direction, Message
from ..semantics.bits import placed
from . import bit_patterns, can_ids
from .duplicate_code import without_duplicates
from .rule import CheckInput, Finding, Findings, RelatedItem

MAX_PAIRS = 2000
"""The maximum number of ambiguous pairs that findings are about; there are more only if very many commands are wrong."""

_ID_KEYS = 32
_DATA = 2 * _ID_KEYS
"""Where the bits of keys stand: behind the id, those in the id first, as many as the id has room for."""


def check(subject: CheckInput) -> Findings:
    try:
        yield from _findings(subject)
    except bit_patterns.TooManyPairsError:
        text = "the messages of these commands have too much in common to compare every two of them"
        hint = "distinguish commands by one selector, or split the protocol; there may be further ambiguous messages"
        yield Finding(("commands",), text, hint, key=True)


def _findings(subject: CheckInput) -> Findings:
    edition = subject.edition
    without_code: set[str] = set()
    """Commands reported as lacking a code; their ambiguous replies follow from that and are not reported."""
    for direction in Direction:
        messages = {m.command: m for m in edition.messages(direction)}
        groups = {name: edition.command(name).spec_name for name in messages}
        partners: dict[str, set[str]] = {}
        first = dict(zip(reversed(groups.values()), reversed(messages.values()), strict=True))
        for later, earlier in islice(_ambiguous(edition, direction), MAX_PAIRS):
            pair = groups[later.command], groups[earlier.command]
            if without_code.isdisjoint(pair):
                for group, its in (pair, pair[::-1]):
                    partners.setdefault(group, set()).add(its)
        order = {group: place for place, group in enumerate(reversed(first))}
        while partners:
            most = max(partners, key=lambda group: (len(partners[group]), order[group]))
            confused = partners.pop(most)
            for group in confused - {most}:
                partners[group].discard(most)
            partners = {group: left for group, left in partners.items() if left}
            names = sorted(confused, key=order.__getitem__)
            yield _finding(
                first[most],
                [first[name] for name in names],
                _without_explicit_request(subject.spec, direction, [most, *names]),
            )
            if edition.command(first[most].command).code is None:
                without_code.add(most)


class _Frames(NamedTuple):
    """The frames of a message: ids, bits of the id that vary, keys, and bits of fields."""

    message: Message
    ids: range
    free_bits: int
    keys: bit_patterns.Known
    fields: int


def _ambiguous(edition: Edition, direction: Direction) -> Iterator[tuple[Message, Message]]:
    """Every pair of different messages that one frame can be. Commands that repeat a code have findings already."""
    unique = {command.name for command in without_duplicates(edition.commands)}
    frames = [_frames(message) for message in edition.messages(direction) if message.command in unique]
    for i, j in bit_patterns.pairs([_known(later) for later in frames]):
        later, earlier = frames[i], frames[j]
        if later.message.layout is not earlier.message.layout and _same_frame(later, earlier):
            yield later.message, earlier.message


def _frames(message: Message) -> _Frames:
    keys = bit_patterns.Known(
        sum(_at(key.space, placed(key.segments, -1)) for key in message.keys),
        sum(_at(key.space, placed(key.segments, key.value)) for key in message.keys),
    )
    fields = reduce(or_, (_at(f.space, placed(e.segments, -1)) for f in message.layout.fields for e in f.elements), 0)
    return _Frames(message, can_ids.of_message(message), can_ids.free_bits(message), keys, fields)


def _at(space: Space, bits: int) -> int:
    return bits << (_ID_KEYS if space is Space.ID else _DATA)


def _without_explicit_request(spec: EditionSpec, direction: Direction, commands: Sequence[str]) -> str:
    """The first command with a reply but without a code and `request`; its request may not exist. Empty without one."""
    written = {name: spec.commands[name] for name in commands if direction is Direction.REQUEST}
    bare = (
        name
        for name, command in written.items()
        if command.code is None and command.request is None and command.reply != "none"
    )
    return next(bare, "")


def _finding(message: Message, partners: Sequence[Message], implicit: str) -> Finding:
    shown = partners[:SHOWN]
    more = f" and {len(partners) - SHOWN} more" if len(partners) > SHOWN else ""
    names = ", ".join(f"`{partner.command}`" for partner in shown) + more
    those = "that" if len(partners) == 1 else "those"
    text = f"this {message.direction.value} cannot be distinguished from {those} of {names}, but their fields differ"
    hint = "give it a different code, id, dlc or constant, or use one layout for both"
    if implicit:
        hint = f"if nodes send `{implicit}` without a request, write `request: none` there; else {hint}"
    related = tuple(
        RelatedItem((*partner.path, "code"), f"the {message.direction.value} of `{partner.command}`", key=True)
        for partner in shown
    )
    return Finding((*message.path, "code"), text, hint, key=True, related=related)


SHOWN = 3
"""The maximum number of messages in a finding."""


def _known(frames: _Frames) -> bit_patterns.Known:
    """The known bits of a frame of a message: those of the id, then those of the keys."""
    mask, value = can_ids.known(frames.ids, frames.free_bits)
    return bit_patterns.Known(mask | frames.keys.mask, value | frames.keys.value)


def _same_frame(first: _Frames, second: _Frames) -> bool:
    message, second_message = first.message, second.message
    if (message.id.extended, message.remote) != (second_message.id.extended, second_message.remote):
        return False
    if (
        (message.id, first.keys) == (second_message.id, second.keys)
        and message.dlc != second_message.dlc
        and not message.remote
    ):
        return False
    if (first.keys.value ^ second.keys.value) & first.keys.mask & second.keys.mask:
        return False
    if _is_remainder(first, second) or _is_remainder(second, first):
        return False
    return can_ids.meet(first.ids, second.ids, first.free_bits | second.free_bits) is not None


def _is_remainder(first: _Frames, second: _Frames) -> bool:
    """Whether a message is every frame except the other: it has fields at the additional keys of the other."""
    own, further = first.keys.mask, second.keys.mask
    return not own & ~further and bool(first.fields & further & ~own)
