"""Matches the items of two editions: by name, then by what they mean."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from ..model.edition import Edition
from ..model.layout import Field, Layout
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
                new = next((one for one in sorted(added, key=_name) if test(old, one)), None)
                if new is not None:
                    pairs.append((old, new))
                    removed.remove(old)
                    added.remove(new)
        return Matched(tuple(pairs), tuple(removed), tuple(added))


def _name(item: Named) -> str:
    return item.name


def by_name(old: Iterable[T], new: Iterable[T]) -> Matched[T]:
    """Things of one name are the same thing."""
    before, after = {one.name: one for one in old}, {one.name: one for one in new}
    return Matched(
        tuple((one, after[name]) for name, one in before.items() if name in after),
        tuple(one for name, one in before.items() if name not in after),
        tuple(one for name, one in after.items() if name not in before),
    )


def by_former_name(old: Iterable[T], new: Iterable[T], former_names: Callable[[T], Iterable[str]]) -> Matched[T]:
    """As `by_name`, but items with a former name match the item of that name in the other edition.

    A former name that both editions give to an item refers to an earlier edition.
    """
    before, after = {one.name: one for one in old}, {one.name: one for one in new}

    def stated(here: dict[str, T], there: dict[str, T]) -> Iterator[tuple[T, T]]:
        """Items with a former name, each with the item of that name in the other edition."""
        for one in here.values():
            same = there.get(one.name)
            names = set(former_names(one)) - set(former_names(same) if same is not None else ())
            former = next((there[name] for name in former_names(one) if name in names & there.keys()), None)
            if former is not None:
                yield one, former

    pairs = {id(was): (was, now) for now, was in stated(after, before)}
    taken = {id(now) for _, now in pairs.values()}
    for was, now in stated(before, after):
        if id(was) not in pairs and id(now) not in taken:
            pairs[id(was)] = was, now
            taken.add(id(now))
    rest = by_name(
        (one for one in before.values() if id(one) not in pairs),
        (one for one in after.values() if id(one) not in taken),
    )
    return Matched((*pairs.values(), *rest.pairs), rest.removed, rest.added)


def exchanged(
    pairs: Iterable[tuple[T, T]], new: Sequence[T], is_alike: Callable[[T, T], bool], is_same: Callable[[T, T], bool]
) -> list[tuple[T, T]]:
    """Things that have one another's names in the new edition: what is the same, bits included, has another name."""
    differing = {one.name: one for one, now in pairs if one.name == now.name and not is_alike(one, now)}
    found = [(one, b) for one in differing.values() for b in new if b.name != one.name and is_same(one, b)]
    return found if {b.name for _, b in found} == {a.name for a, _ in found} else []


def renamable(old: Iterable[R], new: Iterable[R]) -> Matched[R]:
    """Things of one name, or of a former name."""
    return by_former_name(old, new, lambda one: (one.renamed_from,) if one.renamed_from else ())


def same_title(one: Titled, other: Titled) -> bool:
    """Whether the specs give two things one title, or none."""
    return _is_same_title(one.title, other.title)


def _is_same_title(one: Text, other: Text) -> bool:
    return one == other or (isinstance(one, ImpliedTitle) and isinstance(other, ImpliedTitle))


def members(old: Sequence[Member], new: Sequence[Member]) -> Matched[Member]:
    """Members of one name or a former name; of one value and one title."""
    return renamable(old, new).also(lambda a, b: a.value == b.value and same_title(a, b))


def commands(old: Edition, new: Edition) -> Matched[Command]:
    """Commands of one name or a former name; of one title and one code with the same bits, or fields of the same names.

    What has another name and another title has another meaning.
    """

    before, after = ({n for c in edition.commands for n in (c.spec_name, c.name)} for edition in (old, new))

    def may_be_renamed(one: Command, other: Command) -> bool:
        if one.name in after or other.name in before:
            return False
        return one.spec_name == other.spec_name or not (one.spec_name in after or other.spec_name in before)

    def same_names(one: Command, other: Command) -> bool:
        return code_of(one) == code_of(other) and _same_titles(one, other) and may_be_renamed(one, other)

    def same_fields(one: Command, other: Command) -> bool:
        return same_names(one, other) and _names(one) == _names(other)

    def same_frames(one: Command, other: Command) -> bool:
        return same_names(one, other) and _content(one) == _content(other)

    def same_purpose(one: Command, other: Command) -> bool:
        return one.title == other.title and _content(one) == _content(other) and may_be_renamed(one, other)

    def is_alike(one: Command, other: Command) -> bool:
        return _content(one) == _content(other)

    def differ_in_name(one: Command, other: Command) -> bool:
        return code_of(one) == code_of(other) and is_alike(one, other)

    matched = by_former_name(old.commands, new.commands, lambda command: command.former_names)
    others = {one.name for one, _ in exchanged(matched.pairs, new.commands, is_alike, differ_in_name)}
    pairs, apart = ([p for p in matched.pairs if (p[0].name in others) is kind] for kind in (False, True))
    removed, added = (*matched.removed, *(a for a, _ in apart)), (*matched.added, *(b for _, b in apart))
    return Matched(tuple(pairs), removed, added).also(same_frames, same_fields, same_purpose)


def _same_titles(one: Command, other: Command) -> bool:
    if one.entry is not None and other.entry is not None and not same_title(one.entry, other.entry):
        return False
    return _is_same_title(one.spec_title, other.spec_title)


def fields(old: Layout, new: Layout) -> Matched[Field]:
    """Fields of one name or a former name; with the same bits, meaning and title; or of one type and title."""

    def same_bits(one: Field, other: Field) -> bool:
        same_values = _meaning(one.type) == _meaning(other.type) and same_title(one, other)
        return one.elements == other.elements and same_values and one.only == other.only

    def same_type(one: Field, other: Field) -> bool:
        return one.type.name == other.type.name and one.title == other.title

    return renamable(old.fields, new.fields).also(same_bits, same_type)


def exchanged_fields(old: Layout, new: Layout) -> list[tuple[Field, Field]]:
    """The fields that have one another's names, by their bits."""

    def is_alike(one: Field, other: Field) -> bool:
        return _meaning(one.type) == _meaning(other.type)

    def has_same_bits(one: Field, other: Field) -> bool:
        return _bits_and_meaning(one) == _bits_and_meaning(other)

    return exchanged(fields(old, new).pairs, new.fields, is_alike, has_same_bits)


def code_of(command: Command) -> tuple[object, ...]:
    """What distinguishes the frames of a command: address and keys."""
    message = command.request or command.reply
    return command.address, frozenset((key.space, key.segments, key.value) for key in message.keys) if message else ()


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
    return message and content(message.layout)


def content(layout: Layout, without: Collection[str] = ()) -> object:
    """The bits of a layout with their meaning; not the names. The fields named in `without` do not count."""
    return {_bits_and_meaning(f) for f in layout.fields if f.name not in without}


def _bits_and_meaning(field: Field) -> tuple[object, ...]:
    return field.space, field.elements, field.only, field.role.sent_raw, field.role.required_raw, _meaning(field.type)


def _meaning(type_: Type) -> tuple[object, ...]:
    """All that makes a value of bits; not the names."""
    return (
        (type_.width, type_.encoding, type_.order, type_.unit and type_.unit.name),
        type_.linear.parameter,
        type_.linear.constant,
        frozenset(type_.linear.cases.items()),
        frozenset(member.value for member in type_.enum),
        frozenset(flag.value for flag in type_.flags),
    )


def renamed(pairs: Iterable[tuple[str, str]], old: Sequence[Named], new: Sequence[Named]) -> dict[str, str]:
    """Old names to new ones, where the old name is gone and the new one was not there."""
    before, after = {one.name for one in old}, {one.name for one in new}
    return {a: b for a, b in pairs if a != b and a not in after and b not in before}
