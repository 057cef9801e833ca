"""The command matrix of an edition: one row for each field of each command, as the pages list them, with numbers apart."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from types import MappingProxyType
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import Field, Layout
from ...model.message import Command, Direction, EchoReply, Key, KeyRole, Message, OtherReply
from ...model.types import Bound, Encoding, Linear, Member, NoValue, Range, Type
from ...semantics.frame import sent_id_rule
from ..availability import is_available, values_of
from ..field_contents import contents

Cell = str | Fraction
"""A text, or an exact number; both can be in one column, for a bound that depends on a parameter."""


class Row(NamedTuple):
    """One field of one direction of a command, or one key, which has no name.

    A field whose numbers depend on a parameter has one row for each of them.
    """

    command: Cell
    title: Cell
    code: Cell
    direction: Cell
    answer: Cell
    id: Cell
    nodes: Cell
    frame: Cell
    position: Cell
    bits: Cell
    field: Cell
    meaning: Cell
    raw: Cell
    fixed: Cell
    raw_minimum: Cell
    raw_maximum: Cell
    resolution: Cell
    offset: Cell
    unit: Cell
    printed: Cell
    minimum: Cell
    maximum: Cell
    values: Cell
    only: Cell
    manual: Cell
    manual_name: Cell
    edition: Cell
    date: Cell


NO_CONDITION: Mapping[str, tuple[str, ...]] = MappingProxyType({})


class Numbers(NamedTuple):
    """The numbers of a field under some parameter values."""

    only: Mapping[str, tuple[str, ...]]
    linear: Linear | None
    limits: Range | None


def rows(shown: Shown) -> Iterator[Row]:
    """The rows of an edition."""
    for command in shown.edition.commands:
        for message in command.messages:
            yield from rows_of(shown, command, message)


def rows_of(shown: Shown, command: Command, message: Message) -> Iterator[Row]:
    """The rows of one direction: of its keys, then of the fields that exist where the command does; one without any."""
    start, layout, content = _start(shown, command, message), message.layout, contents(message)
    fields = [field for field in layout.fields if is_available(layout, field, command)]
    for number, key in enumerate(message.keys):
        yield _of_key(shown, start, key, message.accepted_codes if number == 0 else ())
    for field in fields:
        fixed = _fixed(content[field].written) if field in content else ""
        yield from _of_field(shown, start._replace(fixed=fixed), command, layout, field)
    if not message.keys and not fields:
        yield start


def _sending(message: Message, labels: Mapping[str, str]) -> Iterator[str]:
    """When the message is sent, and the numbers of its frames, if these are stated."""
    if message.sending is not None:
        yield formatting.sending(message.sending, formatting.words_of(formatting.SendingWords, labels, "sending"))
    if message.sequence is not None:
        yield formatting.frame_numbers(message.sequence, formatting.words_of(formatting.ReplyWords, labels, "replies"))


class Shown:
    """Facts of an edition as cells, in a language and with its labels."""

    def __init__(self, edition: Edition, language: str, labels: Mapping[str, str]) -> None:
        self.edition = edition
        self.language = language
        self.labels = labels
        self.words = formatting.words_of(formatting.PlaceWords, labels, "place")

    def list(self, texts: Iterable[str]) -> str:
        """The texts that are not empty in one cell."""
        return self.labels["semicolon"].join(filter(None, texts))

    def numbers(self, type_: Type, numbers: Numbers) -> Mapping[str, Cell]:
        """The cells of the numbers; a type without a range has the limits of its raw format."""
        linear, limits = numbers.linear, numbers.limits
        is_float = type_.encoding is Encoding.FLOAT
        cells: dict[str, Cell] = {"unit": type_.unit.symbol if type_.unit else ""}
        if limits is None and not is_float and type_.joined is None:
            limits = Range(*(Bound(Fraction(raw)) for raw in type_.raw_limits))
        if limits and not is_float:
            cells |= {"raw_minimum": _bound(limits.low), "raw_maximum": _bound(limits.high)}
        if type_.joined is not None:
            return cells
        if linear is None:
            return {**cells, "printed": self.labels["not_given"]}
        if limits:
            values = limits if is_float else formatting.in_unit(limits, linear)
            cells |= {"minimum": _bound(values.low), "maximum": _bound(values.high)}
        step = linear.scale if linear.times is None else formatting.step(linear)
        offset = linear.offset if linear.times is None else formatting.offset(linear)
        is_printed = isinstance(step, Fraction) and formatting.step(linear) != formatting.exact(step)
        return {
            **cells,
            "resolution": step,
            "offset": offset,
            "printed": f"× {formatting.step(linear)}" if is_printed else "",
        }

    def section(self, manual: str) -> str:
        """The section of the manual. A spreadsheet would read `2.10` as a number."""
        return self.labels["section"].format(manual) if manual[:1].isdigit() else manual

    def condition(self, only: Mapping[str, tuple[str, ...]]) -> str:
        """`Model: A, B`, by the titles of the parameters."""
        shown = ((self.edition.parameter(name).title[self.language], values) for name, values in only.items())
        listed = (self.labels["condition"].format(title, self.labels["comma"].join(values)) for title, values in shown)
        return self.list(listed)


def _start(shown: Shown, command: Command, message: Message) -> Row:
    """What every row of one direction of a command has."""
    edition, labels, direction = shown.edition, shown.labels, message.direction
    length = labels["remote"] if message.remote else labels["bytes"].format(message.dlc)
    length += ", CAN FD" if edition.bus.frame_format.is_fd else ""
    answering = command.from_each if direction is Direction.REPLY else ()
    nodes = [node for node in message.id.nodes or () if not answering or node in answering]
    kind = labels["extended" if message.id.extended else "standard"]
    return Row(*[""] * len(Row._fields))._replace(
        command=command.name,
        title=command.title[shown.language],
        code="" if command.code is None else formatting.constant(command.code),
        direction=labels[direction.value],
        answer=_answer(command, direction, labels),
        id=formatting.id_rule(sent_id_rule(message)),
        nodes=formatting.numbers(nodes),
        frame=shown.list((kind, length, *_sending(message, labels))),
        only=shown.condition(command.only),
        manual=shown.section(command.manual),
        edition=edition.name,
        date=edition.date,
    )


def _of_key(shown: Shown, start: Row, key: Key, accepted: Sequence[int]) -> Row:
    labels, place = shown.labels, formatting.key_place(key, shown.words)
    further = labels["accepted"].format(labels["comma"].join(map(formatting.constant, accepted))) if accepted else ""
    return start._replace(
        position=place.position,
        bits=Fraction(key.width),
        meaning=shown.list((labels[_ROLES[key.role]], further)),
        raw=place.raw,
        fixed=_fixed(key.value),
    )


def _of_field(shown: Shown, start: Row, command: Command, layout: Layout, field: Field) -> Iterator[Row]:
    """The rows of a field, for each element and each combination of parameter values with its own numbers."""
    type_, role = field.type, field.role.key
    start = start._replace(
        bits=Fraction(type_.width),
        meaning=shown.list((field.title[shown.language], shown.labels[role] if role else "")),
        values=shown.list(_member(shown, type_, member) for member in type_.members),
        manual=shown.section(field.manual or command.manual),
        manual_name=field.manual_name,
    )
    limited = dict.fromkeys([*command.only, *([layout.parameter] if field.only and layout.parameter else [])])
    only = {name: values_of(name, layout, field, command) for name in limited}
    for place in formatting.field_places(field, shown.words):
        for numbers in numbers_of(shown.edition, type_, only):
            yield start._replace(
                position=place.position,
                field=place.name,
                raw=place.raw,
                only=shown.condition(numbers.only),
                **(shown.numbers(type_, numbers) if field.is_given and type_.is_number else {}),
            )


def _member(shown: Shown, type_: Type, member: Member) -> str:
    value = formatting.no_value(member) if isinstance(member, NoValue) else str(member.value)
    value = shown.labels["bit"].format(member.value, 1 << member.value) if type_.flags else value
    title = member.title.get(shown.language, "")
    return shown.labels["member"].format(value, member.name, title) if title else f"{value} = {member.name}"


_ROLES = {KeyRole.CODE: "selector", KeyRole.INDEX: "index", KeyRole.CONSTANT: "constant"}


def _fixed(content: int | str) -> Cell:
    """A code, a negative number, or a text."""
    if isinstance(content, str):
        return content
    return formatting.constant(content) if content >= 0 else Fraction(content)


def _answer(command: Command, direction: Direction, texts: Mapping[str, str]) -> str:
    """The form of a reply, or that a request has none."""
    if direction is Direction.REQUEST:
        return "" if command.replies else texts["no_reply"]
    forms = [texts["echo"] for reply in command.replies if isinstance(reply, EchoReply)]
    forms += [texts["other"].format(reply.of) for reply in command.replies[:1] if isinstance(reply, OtherReply)]
    forms += formatting.further_replies(command, formatting.words_of(formatting.ReplyWords, texts, "replies"))
    if command.from_each:
        forms.append(texts["from_each"].format(formatting.numbers(command.from_each)))
    return texts["semicolon"].join(forms)


def numbers_of(edition: Edition, type_: Type, only: Mapping[str, tuple[str, ...]] = NO_CONDITION) -> Iterator[Numbers]:
    """The numbers of a type, once for each combination of parameter values that makes a difference."""
    names = type_.parameters
    choices = [only.get(name) or tuple(value.name for value in edition.parameter(name).values) for name in names]
    groups: dict[tuple[Linear | None, Range | None], list[tuple[str, ...]]] = {}
    for values in itertools.product(*choices):
        assignment = dict(zip(names, values, strict=True))
        key = type_.linear.at(assignment), type_.raw_range.at(assignment)
        groups.setdefault(key, []).append(values)
    for (linear, limits), combinations in groups.items():
        if len(groups) == 1:
            yield Numbers(only, linear, limits)
        elif len(names) == 1:
            yield Numbers({**only, names[0]: tuple(value for (value,) in combinations)}, linear, limits)
        else:
            for values in combinations:
                among = {name: (value,) for name, value in zip(names, values, strict=True)}
                yield Numbers({**only, **among}, linear, limits)


def _bound(end: Bound) -> Cell:
    return end.constant if end.parameter is None else formatting.bound(end)
