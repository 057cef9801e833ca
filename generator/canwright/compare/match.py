"""Matches the items of two editions: by name, then by what they mean."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from ..model import formatting
from ..model.edition import Edition
from ..model.layout import Field, Layout
from ..model.message import Command, Message
from ..model.types import Member, Text, Type


class Named(Protocol):
    @property
    def name(self) -> str: ...


class Titled(Named, Protocol):
    @property
    def title(self) -> Text: ...


T = TypeVar("T", bound=Named)


@dataclass(frozen=True)
class Matched(Generic[T]):
    """Pairs of old and new items, and the items without a counterpart."""

    pairs: tuple[tuple[T, T], ...]
    removed: tuple[T, ...]
    added: tuple[T, ...]

    def also(self, *tests: Callable[[T, T], bool]) -> Matched[T]:
        """As this, with what is left paired where a test holds, the first test first."""
        pairs, removed, added = list(self.pairs), list(self.removed), list(self.added)
        for test in tests:
            for old in list(removed):
                new = next((one for one in added if test(old, one)), None)
                if new is not None:
                    pairs.append((old, new))
                    removed.remove(old)
                    added.remove(new)
        return Matched(tuple(pairs), tuple(removed), tuple(added))


def by_name(old: Iterable[T], new: Iterable[T]) -> Matched[T]:
    """Things of one name are the same thing."""
    before, after = {one.name: one for one in old}, {one.name: one for one in new}
    return Matched(
        tuple((one, after[name]) for name, one in before.items() if name in after),
        tuple(one for name, one in before.items() if name not in after),
        tuple(one for name, one in after.items() if name not in before),
    )


def members(old: Sequence[Member], new: Sequence[Member]) -> Matched[Member]:
    """Members of one name; of one value, if their titles do not differ."""
    return by_name(old, new).also(lambda a, b: a.value == b.value and not is_retitled(a, b))


def is_retitled(old: Titled, new: Titled) -> bool:
    """Whether two items have different titles, of which at least one says more than the name."""
    return is_other(old.name, old.title, new.name, new.title)


def is_other(old: str, old_title: Text, new: str, new_title: Text) -> bool:
    """Whether the titles of two names differ, and at least one says more than the name."""
    given = any(set(t.values()) != {formatting.spoken(n)} for n, t in ((old, old_title), (new, new_title)))
    return given and any(old_title[language] != new_title[language] for language in old_title.keys() & new_title.keys())


def commands(old: Edition, new: Edition) -> Matched[Command]:
    """Commands of one name; of one code with the same bits, or fields of the same names; of one title and the same bits."""

    def same_fields(one: Command, other: Command) -> bool:
        return code_of(one) == code_of(other) and _names(one) == _names(other) and not _is_other_command(one, other)

    def same_frames(one: Command, other: Command) -> bool:
        return code_of(one) == code_of(other) and _content(one) == _content(other) and not _is_other_command(one, other)

    def same_title(one: Command, other: Command) -> bool:
        return one.title == other.title and _content(one) == _content(other)

    return by_name(old.commands, new.commands).also(same_frames, same_fields, same_title)


def fields(old: Layout, new: Layout) -> Matched[Field]:
    """Fields of one name, the same bits with the same meaning under another name, or of one type and title."""

    def same_bits(one: Field, other: Field) -> bool:
        same = one.elements == other.elements and _meaning(one.type) == _meaning(other.type) and one.only == other.only
        return same and not is_retitled(one, other)

    def same_title(one: Field, other: Field) -> bool:
        return one.type.name == other.type.name and one.title == other.title

    return by_name(old.fields, new.fields).also(same_bits, same_title)


def _is_other_command(old: Command, new: Command) -> bool:
    """Whether the title of the command, or of the entry of its table, says that two are different ones."""
    if old.entry and new.entry and is_retitled(old.entry, new.entry):
        return True
    return is_other(old.group, old.group_title, new.group, new.group_title)


def code_of(command: Command) -> tuple[object, ...]:
    """What distinguishes the frames of a command: address and keys."""
    message = command.request or command.reply
    keys = tuple((key.space, key.segments, key.value) for key in message.keys) if message else ()
    return (command.address, *keys)


def overlap(one: Field, other: Field) -> bool:
    """Whether two fields share bits."""
    return one.space is other.space and bool(_bits(one) & _bits(other))


def _bits(field: Field) -> set[int]:
    return {bit for element in field.elements for bit in element.bits}


def _content(command: Command) -> tuple[object, ...]:
    echo = command.is_echoed
    return (_fields(command.request), echo, None if echo else _fields(command.reply))


def _names(command: Command) -> tuple[set[str], set[str]]:
    request, reply = ({f.name for f in m.layout.fields} if m else set() for m in (command.request, command.reply))
    return request, reply


def _fields(message: Message | None) -> object:
    return message and {(f.elements, f.only, f.fixed, f.demanded, _meaning(f.type)) for f in message.layout.fields}


def _meaning(type_: Type) -> tuple[object, ...]:
    """All that makes a value of bits; not the names."""
    return (
        (type_.width, type_.encoding, type_.order, type_.unit and type_.unit.name),
        type_.linear.parameter,
        type_.linear.constant,
        tuple(type_.linear.cases.items()),
        tuple(member.value for member in type_.enum),
        tuple(flag.value for flag in type_.flags),
    )


def renamed(pairs: Iterable[tuple[str, str]], old: Sequence[Named], new: Sequence[Named]) -> dict[str, str]:
    """Old names to new ones, where the old name is gone and the new one was not there."""
    before, after = {one.name for one in old}, {one.name for one in new}
    return {a: b for a, b in pairs if a != b and a not in after and b not in before}
