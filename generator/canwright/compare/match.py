"""Matches the items of two editions: by name, then by what they mean."""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from ..model.edition import Edition
from ..model.layout import Field, Layout, ReservedRole, Role
from ..model.message import Command, Message
from ..model.types import ImpliedTitle, Member, Text, Type


class Named(Protocol):
    @property
    def name(self) -> str: ...


class Titled(Named, Protocol):
    @property
    def title(self) -> Text: ...


class Renamable(Named, Protocol):
    @property
    def renamed_from(self) -> str | None: ...


R = TypeVar("R", bound=Renamable)
T = TypeVar("T", bound=Named)


@dataclass(frozen=True)
class Matched(Generic[T]):
    """Pairs of old and new items, and the items without a counterpart."""

    pairs: tuple[tuple[T, T], ...]
    removed: tuple[T, ...]
    added: tuple[T, ...]

    def also(self, *tests: Callable[[T, T], bool]) -> Matched[T]:
        """As this, with what is left paired where a test holds, the first test first; the order of keys does not matter."""
        pairs, removed, added = list(self.pairs), list(self.removed), list(self.added)
        for test in tests:
            for old in sorted(removed, key=_name):
                new = next((candidate for candidate in sorted(added, key=_name) if test(old, candidate)), None)
                if new is not None:
                    pairs.append((old, new))
                    removed.remove(old)
                    added.remove(new)
        return Matched(tuple(pairs), tuple(removed), tuple(added))


def _name(item: Named) -> str:
    return item.name


def by_name(old: Iterable[T], new: Iterable[T]) -> Matched[T]:
    """Things of one name are the same thing."""
    before, after = {item.name: item for item in old}, {item.name: item for item in new}
    return Matched(
        tuple((item, after[name]) for name, item in before.items() if name in after),
        tuple(item for name, item in before.items() if name not in after),
        tuple(item for name, item in after.items() if name not in before),
    )


def by_former_name(old: Iterable[T], new: Iterable[T], former_names: Callable[[T], Iterable[str]]) -> Matched[T]:
    """As `by_name`, but items with a former name match the item of that name in the other edition.

    A former name that both editions give to an item refers to an earlier edition.
    """
    before, after = {item.name: item for item in old}, {item.name: item for item in new}

    def stated(here: dict[str, T], there: dict[str, T]) -> Iterator[tuple[T, T]]:
        """Items with a former name, each with the item of that name in the other edition."""
        for item in here.values():
            same = there.get(item.name)
            names = set(former_names(item)) - set(former_names(same) if same is not None else ())
            former = next((there[name] for name in former_names(item) if name in names & there.keys()), None)
            if former is not None:
                yield item, former

    pairs = {id(was): (was, now) for now, was in stated(after, before)}
    taken = {id(now) for _, now in pairs.values()}
    for was, now in stated(before, after):
        if id(was) not in pairs and id(now) not in taken:
            pairs[id(was)] = was, now
            taken.add(id(now))
    rest = by_name(
        (item for item in before.values() if id(item) not in pairs),
        (item for item in after.values() if id(item) not in taken),
    )
    return Matched((*pairs.values(), *rest.pairs), rest.removed, rest.added)


def exchanged(
    pairs: Iterable[tuple[T, T]], new: Sequence[T], is_alike: Callable[[T, T], bool], is_same: Callable[[T, T], bool]
) -> list[tuple[T, T]]:
    """Things that have one another's names in the new edition: what is the same, bits included, has another name."""
    differing = {item.name: item for item, now in pairs if item.name == now.name and not is_alike(item, now)}
    swapped = [(item, b) for item in differing.values() for b in new if b.name != item.name and is_same(item, b)]
    return swapped if {b.name for _, b in swapped} == {a.name for a, _ in swapped} else []


def renamable(old: Iterable[R], new: Iterable[R]) -> Matched[R]:
    """Things of one name, or of a former name."""
    return by_former_name(old, new, lambda item: (item.renamed_from,) if item.renamed_from else ())


def same_title(first: Titled, second: Titled) -> bool:
    """Whether the specs give two things one title, or none."""
    return _is_same_title(first.title, second.title)


def _is_same_title(first: Text, second: Text) -> bool:
    return first == second or (isinstance(first, ImpliedTitle) and isinstance(second, ImpliedTitle))


def members(old: Sequence[Member], new: Sequence[Member]) -> Matched[Member]:
    """Members of one name or a former name; of one value and one title."""
    return renamable(old, new).also(lambda a, b: a.value == b.value and same_title(a, b))


@functools.lru_cache(maxsize=4096)
def member_names(old: Type, new: Type) -> Mapping[str, str]:
    """The names of the members of the new type, by those of the old one; cached."""
    pairs = (
        *members(old.enum, new.enum).pairs,
        *members(old.flags, new.flags).pairs,
        *members(old.no_values, new.no_values).pairs,
        *members(old.names, new.names).pairs,
    )
    return {before.name: after.name for before, after in pairs}


@functools.lru_cache(maxsize=4096)
def same_values(old: Type, new: Type) -> bool:
    """Whether two types give every raw integer the same value and allow the same ones; cached."""
    facts = [
        (
            (t.joined, t.width, t.encoding, t.order, t.unit and t.unit.name, t.linear, t.raw_range),
            frozenset((n.name, n.raws) for n in t.no_values),
            *(frozenset((m.name, m.value) for m in named) for named in (t.enum, t.flags)),
        )
        for t in (old, new)
    ]
    return facts[0] == facts[1]


def commands(old: Edition, new: Edition) -> Matched[Command]:
    """Commands of one name or a former name; of one title and one code with the same bits, or fields of the same names.

    What has another name and another title has another meaning.
    """

    before, after = ({n for c in edition.commands for n in (c.spec_name, c.name)} for edition in (old, new))

    def may_be_renamed(earlier: Command, later: Command) -> bool:
        if earlier.name in after or later.name in before:
            return False
        return earlier.spec_name == later.spec_name or not (earlier.spec_name in after or later.spec_name in before)

    def same_names(earlier: Command, later: Command) -> bool:
        return code_of(earlier) == code_of(later) and _same_titles(earlier, later) and may_be_renamed(earlier, later)

    def same_fields(earlier: Command, later: Command) -> bool:
        return same_names(earlier, later) and _names(earlier) == _names(later)

    def same_frames(earlier: Command, later: Command) -> bool:
        return same_names(earlier, later) and _content(earlier) == _content(later)

    def same_purpose(earlier: Command, later: Command) -> bool:
        return earlier.title == later.title and _content(earlier) == _content(later) and may_be_renamed(earlier, later)

    def is_alike(earlier: Command, later: Command) -> bool:
        return _content(earlier) == _content(later)

    def differ_in_name(earlier: Command, later: Command) -> bool:
        return code_of(earlier) == code_of(later) and is_alike(earlier, later)

    matched = by_former_name(old.commands, new.commands, lambda command: command.former_names)
    exchanged_names = {command.name for command, _ in exchanged(matched.pairs, new.commands, is_alike, differ_in_name)}
    pairs, apart = ([p for p in matched.pairs if (p[0].name in exchanged_names) is kind] for kind in (False, True))
    removed, added = (*matched.removed, *(a for a, _ in apart)), (*matched.added, *(b for _, b in apart))
    return Matched(tuple(pairs), removed, added).also(same_frames, same_fields, same_purpose)


def _same_titles(old: Command, new: Command) -> bool:
    if old.entry is not None and new.entry is not None and not same_title(old.entry, new.entry):
        return False
    return _is_same_title(old.spec_title, new.spec_title)


@functools.lru_cache(maxsize=4096)
def fields(old: Layout, new: Layout) -> Matched[Field]:
    """Fields of one name or a former name; with the same bits, meaning and title; or of one type and title. Cached."""

    def same_bits(earlier: Field, later: Field) -> bool:
        same_values = _meaning(earlier.type) == _meaning(later.type) and same_title(earlier, later)
        return earlier.elements == later.elements and same_values and earlier.only == later.only

    def same_type(earlier: Field, later: Field) -> bool:
        return earlier.type.name == later.type.name and earlier.title == later.title

    return renamable(old.fields, new.fields).also(same_bits, same_type)


def exchanged_fields(old: Layout, new: Layout) -> list[tuple[Field, Field]]:
    """The fields that have one another's names, by their bits."""

    def is_alike(earlier: Field, later: Field) -> bool:
        return _meaning(earlier.type) == _meaning(later.type)

    def has_same_bits(earlier: Field, later: Field) -> bool:
        return _bits_and_meaning(earlier) == _bits_and_meaning(later)

    return exchanged(fields(old, new).pairs, new.fields, is_alike, has_same_bits)


@functools.lru_cache(maxsize=4096)
def code_of(command: Command) -> tuple[object, ...]:
    """What distinguishes the frames of a command: address and keys. Cached."""
    message = command.request or command.reply
    return command.address, frozenset((key.space, key.segments, key.value) for key in message.keys) if message else ()


def overlap(first: Field, second: Field) -> bool:
    """Whether two fields share bits."""
    return first.space is second.space and bool(_bits(first) & _bits(second))


def _bits(field: Field) -> set[int]:
    return {bit for element in field.elements for bit in element.bits}


def _content(command: Command) -> tuple[object, ...]:
    echo = command.is_echoed
    return (_fields(command.request), echo, None if echo else _fields(command.reply))


def _names(command: Command) -> tuple[set[str], set[str]]:
    request, reply = ({f.name for f in m.layout.fields} if m else set() for m in (command.request, command.reply))
    return request, reply


def _fields(message: Message | None) -> object:
    return message and content(message.layout)


def content(layout: Layout, without: Collection[str] = ()) -> object:
    """The bits of a layout with their meaning; not the names. The fields named in `without` do not count."""
    return {_bits_and_meaning(f) for f in layout.fields if f.name not in without}


def _bits_and_meaning(field: Field) -> tuple[object, ...]:
    return field.space, field.elements, field.only, fixed(field), _meaning(field.type)


def fixed(field: Field) -> Role | None:
    """What is sent in a field, and required, that users do not give; None for a value."""
    return None if field.is_given else field.role


def has_meaning(field: Field) -> bool:
    """Whether a receiver does anything with the bits of a field."""
    return not isinstance(field.role, ReservedRole)


def _meaning(type_: Type) -> tuple[object, ...]:
    """All that makes a value of bits; not the names."""
    return (
        (type_.width, type_.encoding, type_.order, type_.unit and type_.unit.name),
        type_.linear.parameter,
        type_.linear.constant,
        frozenset(type_.linear.cases.items()),
        frozenset(member.value for member in type_.enum),
        frozenset(flag.value for flag in type_.flags),
        frozenset(no_value.raws for no_value in type_.no_values),
    )


def renamed(pairs: Iterable[tuple[str, str]], old: Sequence[Named], new: Sequence[Named]) -> dict[str, str]:
    """Old names to new ones, where the old name is gone and the new one was not there."""
    before, after = {item.name for item in old}, {item.name for item in new}
    return {a: b for a, b in pairs if a != b and a not in after and b not in before}
