"""Names in C: each edition has its own prefix, so that one program can use several editions; collisions are reported.

Every name with file scope is that of an item of the spec with an ending from the tables here.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import reduce
from operator import or_

from ...diagnostics.diagnostic import DocumentPath
from ...model import formatting
from ...model.checksum import Arithmetic
from ...model.edition import Edition
from ...model.layout import Layout
from ...model.message import Direction, Message
from ...model.sending import microseconds
from ...model.types import Parameter, Type
from ...semantics.checksum import ChecksumPlan
from ...semantics.plan import message_plan
from ...semantics.valid_raws import valid_raws
from ..base import Named, NameProblem, clashes
from .text import MacroView

SHARED = ("canwright.h", "canwright_exact.h", "canwright_float.h", "canwright_print.h", "canwright_selftest.h")
"""The headers that are the same for every protocol."""

FD = "canwright_fd.h"
"""The header for editions with CAN FD."""

TEXT = "canwright_text.h"
"""The header for editions with texts or decimal digits."""

PARTS = ("", "_float", "_print")
"""The endings of the names of the headers of an edition."""


def patterns(edition: Edition) -> Mapping[tuple[str, ...], Sequence[Message]]:
    """The messages that differ only in length and codes, by the parts of their common name.

    These are address and direction, and a number from the second pattern on.
    """
    alike: dict[tuple[object, ...], list[Message]] = {}
    for m in edition.all_messages():
        places = tuple((key.space, key.width, key.segments) for key in m.keys)
        alike.setdefault((m.address, m.direction, m.remote, m.id_mask, places), []).append(m)
    named: dict[tuple[str, ...], list[Message]] = {}
    for messages in alike.values():
        name = (messages[0].address, messages[0].direction.value)
        names = itertools.chain([name], ((*name, str(number)) for number in itertools.count(2)))
        named[next(free for free in names if free not in named)] = messages
    return named


def address_mask(edition: Edition, address: str, direction: Direction) -> int:
    """Bits of the id that keys and fields fill in some message of this direction."""
    here = edition.address(address)
    rule = here.rule(direction)
    return reduce(or_, (m.id_mask for m in edition.of_rule(direction, rule)), 0)


C_WORDS = (
    "alignas alignof auto bool break case char const constexpr continue default do double else enum extern false float "
    "for goto if inline int long nullptr register restrict return short signed sizeof static static_assert struct "
    "switch thread_local true typedef typeof typeof_unqual union unsigned void volatile while"
)
CXX_WORDS = (
    "and and_eq asm bitand bitor catch char8_t char16_t char32_t class co_await co_return co_yield compl concept "
    "const_cast consteval constinit decltype delete dynamic_cast explicit export friend mutable namespace new noexcept "
    "not not_eq operator or or_eq private protected public reinterpret_cast requires static_cast template this throw "
    "try typeid typename using virtual wchar_t xor xor_eq"
)
LOWER_CASE_MACROS = (
    "assert complex emit errno far foreach forever i386 imaginary interface linux near offsetof signals slots small "
    "stderr stdin stdout unix"
)
"""Macros of the standard library, of compilers, of Windows, and of Qt."""
TYPES_OF_MEMBERS = "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t"
"""C++ forbids a member with the name of a type that the same struct uses."""
RESERVED = frozenset(f"{C_WORDS} {CXX_WORDS} {LOWER_CASE_MACROS} {TYPES_OF_MEMBERS} frame_code".split())

TYPE_ENDINGS = (
    *("_to_milli", "_from_milli", "_to_double", "_from_double", "_to_float", "_from_float"),
    *("_name", "_first_flag", "_valid", "_write", "_no_value", "_has_value"),
)
SCALE_MACROS = ("UNIT", "SCALE_NUM", "SCALE_DEN", "OFFSET_NUM", "OFFSET_DEN")
FIRST = "first"
"""The ending of the macro of the first of several raw integers without a value."""
LAYOUT_ENDINGS = ("_t", "_check", "_pack", "_unpack", "_show")
COUNTER_ENDINGS = ("_next", "_steps")
MESSAGE_ENDINGS = ("_encode", "_decode")
ADDRESS_ENDINGS = (
    *("_request_id", "_request_node", "_request_match_id", "_request_filter"),
    *("_reply_id", "_reply_node", "_reply_match_id", "_reply_filter"),
)
PATTERN_ENDINGS = ("_match", "_stamp")
ADDRESS_MACROS = (
    *("_NODE_MIN", "_NODE_MAX"),
    *("_REQUEST_ID", "_REQUEST_FILTER_ID", "_REQUEST_FILTER_MASK"),
    *("_REPLY_ID", "_REPLY_FILTER_ID", "_REPLY_FILTER_MASK"),
)
PARTS_OF_FUNCTIONS = ("_check", "_pack", "_unpack", "_show", "_write", "_match", "_stamp", "_sum")
"""The endings of functions that others call."""
SIGNIFICANT = 63
"""C99 guarantees that this many initial characters of a name are significant."""

EDITION_NAMES = (
    *("parameters_t", "field_t", "field_name", "command_t", "command_name", "command_effects", "command_available"),
    *("any_request_t", "any_reply_t", "any_request_check", "any_reply_check", "identify_request", "identify_reply"),
    *("decode_request", "decode_reply", "check_reply", "print_request", "print_reply"),
    *("H", "FLOAT_H", "HPP", "PRINT_H", "SELFTEST_H"),
    *("FIELD_NONE", "COMMAND_NONE", "SPEC", "SPEC_HASH", "EDITION", "REPLY_WITHIN_US"),
    *("selftest", "selftest_message", "selftest_raws_t", "selftest_read", "selftest_same", "selftest_t"),
)


class Names:
    """The names of one edition."""

    def __init__(self, edition: Edition) -> None:
        self._prefix = f"{edition.family}_{edition.identifier}".lower()
        self._short = dict(_short_names(edition))
        self._types = _type_stems(edition)

    def lower(self, name: str, *parts: str) -> str:
        return self._joined(name, *parts).lower()

    def upper(self, name: str, *parts: str) -> str:
        return self._joined(name, *parts).upper()

    def command(self, command: str) -> str:
        """The enumerator of a command."""
        return self.upper("command", self.short(command))

    def short(self, name: str) -> str:
        """The short form of the name of a command or a message, if it has one."""
        return self._short.get(name, name)

    def facts(self, message: Message) -> Iterator[MacroView]:
        """The macros of a message: of its period, of its time-out, and of its frames if there are several."""
        facts: list[tuple[str, int, str]] = []
        if message.sending and message.sending.every_ms is not None:
            facts.append(("every_us", microseconds(message.sending.every_ms), "Nominal period, in microseconds."))
        if message.sending and message.sending.timeout_ms is not None:
            doc = "Silence that the receiver treats as a failure, in microseconds."
            facts.append(("timeout_us", microseconds(message.sending.timeout_ms), doc))
        if message.sequence:
            numbers, of = message.sequence.numbers, f"`{message.sequence.field}` of the {message.direction.value}"
            doc = f"Maximum number of frames. They come in any order, numbered in {of}."
            facts.append(("first_frame", numbers[0], f"Number of the first frame, in {of}."))
            facts.append(("frames", len(numbers), doc))
        return (MacroView(self.upper(message.name, name), f"{number}u", doc) for name, number, doc in facts)

    def crc(self, plan: ChecksumPlan) -> str:
        """The function for one more byte of a CRC."""
        return self.lower("crc", str(plan.width), f"{plan.poly:X}", *(["reflected"] if plan.is_reflected else []))

    def type_stem(self, type_: Type) -> str:
        """The part of the names of a type that stands for it: its name, `speed`, or with its raw format, `speed_i16`."""
        return self._types[type_.name]

    def _joined(self, name: str, *parts: str) -> str:
        return "_".join((self._prefix, self.short(name), *parts))


def _short_names(edition: Edition) -> Iterator[tuple[str, str]]:
    """The names of commands and messages, each with its short form."""
    short = {command.name: command.short_name for command in edition.commands}
    yield from short.items()
    for message in edition.all_messages():
        yield message.name, short[message.command] + message.name.removeprefix(message.command)


def _type_stems(edition: Edition) -> Mapping[str, str]:
    """The stem of each type, so that no field of another type has its name.

    Otherwise `speed_to_double(request.speed)` would compile for a field `speed` of another type. A new edition with such
    a field renames the functions, so programs for the previous edition do not compile with it.
    """
    types_of: dict[str, set[str]] = {}
    for field in (f for layout in layouts(edition) for f in layout.given):
        types_of.setdefault(field.name, set()).add(field.type.name)
    stems = {type_.name: type_.name for type_ in edition.types}
    for type_ in edition.types:
        raw = f"{type_.name}_{formatting.raw_format(type_).split()[0]}"
        candidates = (raw if number == 1 else f"{raw}_{number}" for number in itertools.count(1))
        if types_of.get(type_.name, set()) - {type_.name}:
            free = (c for c in candidates if not types_of.get(c, set()) - {type_.name} and c not in stems.values())
            stems[type_.name] = next(free)
    return stems


def member(name: str) -> str:
    """A name of the spec as a member of a struct."""
    return f"{name}_" if name in RESERVED else name


def layouts(edition: Edition) -> list[Layout]:
    """The layouts that messages use; the shared ones first, in spec order."""
    used = [message.layout for message in edition.all_messages()]
    shared = [layout for layout in edition.layouts if edition.of_layout(layout)]
    return list(dict.fromkeys((*shared, *used)))


def problems(edition: Edition) -> Iterator[NameProblem]:
    """Different items of an edition that would have one name in C, and names that a compiler may take for one."""
    names = list(defined(edition))
    yield from clashes(names, "C")
    yield from _long_names(names)
    for layout in layouts(edition):
        yield from clashes(((member(f.name), f"the field `{f.name}`", f.path) for f in layout.fields), "C")


def _long_names(names: Iterable[Named]) -> Iterator[NameProblem]:
    """The first name of each path that starts like another name: C compilers need not distinguish more characters."""
    owners: dict[str, str] = {}
    reported: set[DocumentPath] = set()
    for name, what, path in names:
        owner = owners.setdefault(name[:SIGNIFICANT], name)
        if owner != name and path not in reported:
            reported.add(path)
            text = f"the first {SIGNIFICANT} characters of `{name}` in C ({what}) are those of `{owner}`"
            yield NameProblem(path, text, "use a shorter name, or `short_name` for a command")


def defined(edition: Edition) -> Iterator[Named]:
    """Every name with file scope, its item, and the path of the item."""
    names = Names(edition)
    for name in EDITION_NAMES:
        yield names.upper(name) if name.isupper() else names.lower(name), "a name in every edition", ()
    for parameter in edition.parameters:
        yield from parameter_names(names, parameter)
    for address in edition.addresses:
        what = f"the address `{address.name}`"
        yield from ((names.upper(address.name) + e, what, address.path) for e in ADDRESS_MACROS)
        yield from ((names.lower(address.name) + e, what, address.path) for e in ADDRESS_ENDINGS)
    for parts, messages in patterns(edition).items():
        address = edition.address(messages[0].address)
        what, path = f"the address `{address.name}`", address.path
        yield from ((names.lower(*parts) + e, what, path) for e in PATTERN_ENDINGS)
    for type_ in edition.types:
        yield from ((name, f"the type `{type_.name}`", path) for name, path in _type(names, type_))
    for effect in edition.effects:
        yield names.upper("effect", effect.name), f"the effect `{effect.name}`", ("effects", effect.name)
    for layout in layouts(edition):
        what = _layout(layout)
        yield from ((name, what, path) for name, path in _layout_names(names, layout))
        yield from ((names.upper("field", f.name), f"the field name `{f.name}`", f.path) for f in layout.fields)
    yield from _crcs(names, edition)
    for command in edition.commands:
        for name in (names.command(command.name), names.upper(command.name, "code")):
            yield name, f"the command `{command.name}`", command.path
    for message in edition.all_messages():
        yield from ((fact.name, f"a number of `{message.name}`", message.path) for fact in names.facts(message))
        what = f"the {message.direction.value} of `{message.command}`"
        own = message.name == message.layout.name
        yield names.lower(message.name, "t"), _layout(message.layout) if own else what, message.path
        yield from ((names.lower(message.name) + e, what, message.path) for e in MESSAGE_ENDINGS)


def _crcs(names: Names, edition: Edition) -> Iterator[Named]:
    for check in filter(None, (message_plan(message).checksum for message in edition.all_messages())):
        if check.checksum.arithmetic is Arithmetic.CRC:
            yield names.crc(check.checksum), "a CRC", check.field.path


def _layout_names(names: Names, layout: Layout) -> Iterator[tuple[str, DocumentPath]]:
    """The names of the functions of a layout, of its counters and of its checksum."""
    yield from ((names.lower(layout.name) + e, layout.path) for e in LAYOUT_ENDINGS)
    for field in layout.fields:
        if field.counter:
            yield from ((names.lower(layout.name, field.name) + e, field.path) for e in COUNTER_ENDINGS)
        if field.checksum:
            yield names.lower(layout.name, "sum"), field.path


def _layout(layout: Layout) -> str:
    return f"the shared layout `{layout.name}`" if layout.shared else f"`{'.'.join(map(str, layout.path))}`"


def parameter_names(names: Names, parameter: Parameter) -> Iterator[Named]:
    """The names of the type and of the values of a parameter, as `defined` yields them."""
    what, path = f"the parameter `{parameter.name}`", ("parameters", parameter.name)
    if parameter.is_choice:
        yield names.lower(parameter.name, "t"), what, path
        yield names.upper(parameter.name, "unknown"), what, path
    for value in parameter.values:
        what = f"the value `{value.name}` of `{parameter.name}`"
        yield names.upper(parameter.name, value.name), what, (*path, "values", value.name)


def _type(names: Names, type_: Type) -> Iterator[tuple[str, DocumentPath]]:
    """The names of the functions of a type, of its ranges and scale, and of its members."""
    stem, path = names.type_stem(type_), type_.path
    cases = [(), *((case,) for case in valid_raws(type_).cases)]
    yield from ((names.lower(stem) + ending, path) for ending in TYPE_ENDINGS)
    yield from ((names.upper(stem, ending, *case), path) for ending in ("RAW_MIN", "RAW_MAX") for case in cases)
    if type_.is_number:
        yield from ((names.upper(stem, ending), path) for ending in SCALE_MACROS)
    for key, members in type_.members_by_key.items():
        yield from ((names.upper(stem, m.name), (*path, key, m.name)) for m in members)
    yield from ((names.upper(stem, n.name, FIRST), path) for n in type_.no_values if len(n.raws) > 1 and not n.is_nan)
