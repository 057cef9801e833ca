"""The command matrix of an edition: one row for each field of each command, as the pages list them, with numbers apart."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.layout import ConstantRole, Field, FixedRole, Layout, NodeRole, ReservedRole
from ...model.message import Command, Direction, EchoReply, Key, KeyRole, Message, OtherReply
from ...model.types import Bound, Encoding, Linear, Member, Range, Type
from ..availability import is_available, values_of
from .labels import labels

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
    edition: Cell
    date: Cell


class Numbers(NamedTuple):
    """The numbers of a field under some parameter values."""

    only: Mapping[str, tuple[str, ...]]
    linear: Linear | None
    limits: Range | None


def rows(edition: Edition, language: str) -> Iterator[Row]:
    """The rows of an edition, with texts in a language of the labels."""
    for command in edition.commands:
        for direction in Direction:
            message = command.message(direction)
            if message is not None:
                yield from _Rows(edition, command, direction, message, language).all()


class _Rows:
    """The rows of one direction of a command."""

    def __init__(
        self, edition: Edition, command: Command, direction: Direction, message: Message, language: str
    ) -> None:
        self._edition = edition
        self._command = command
        self._message = message
        self._language = language
        self._labels = labels()[language]
        self._words = formatting.PlaceWords(*(self._labels[f"place_{name}"] for name in formatting.PlaceWords._fields))
        length = self._labels["remote"] if message.remote else self._labels["bytes"].format(message.dlc)
        answering = command.from_each if direction is Direction.REPLY else ()
        nodes = [node for node in message.id.nodes or () if not answering or node in answering]
        self._start = Row(
            *[""] * len(Row._fields),
        )._replace(
            command=command.name,
            title=command.title[language],
            code="" if command.code is None else formatting.constant(command.code),
            direction=self._labels[direction.value],
            answer=_answer(command, direction, self._labels),
            id=formatting.id_rule(message.id),
            nodes=formatting.numbers(nodes),
            frame=self._labels["semicolon"].join(
                (self._labels["extended" if message.id.extended else "standard"], length)
            ),
            only=self._condition(command.only),
            manual=self._section(command.manual),
            edition=edition.name,
            date=edition.date,
        )

    def all(self) -> Iterator[Row]:
        """The rows of the keys, then of the fields that exist where the command does; one row without any."""
        layout = self._message.layout
        fields = [field for field in layout.fields if is_available(layout, field, self._command)]
        for number, key in enumerate(self._message.keys):
            yield self._of_key(key, self._message.accepted_codes if number == 0 else ())
        for field in fields:
            yield from self._of_field(layout, field)
        if not self._message.keys and not fields:
            yield self._start

    def _of_key(self, key: Key, accepted: Sequence[int]) -> Row:
        meaning = [self._labels[_ROLES[key.role]]]
        if accepted:
            meaning.append(
                self._labels["accepted"].format(self._labels["comma"].join(map(formatting.constant, accepted)))
            )
        place = formatting.key_place(key, self._words)
        return self._start._replace(
            position=place.position,
            bits=Fraction(key.width),
            meaning=self._labels["semicolon"].join(meaning),
            raw=place.raw,
            fixed=_fixed(key.value),
        )

    def _of_field(self, layout: Layout, field: Field) -> Iterator[Row]:
        type_ = field.type
        meaning = [field.title[self._language], *self._of_role(field)]
        start = self._start._replace(
            bits=Fraction(type_.width),
            meaning=self._labels["semicolon"].join(filter(None, meaning)),
            fixed=_fixed(field.role.raw) if isinstance(field.role, FixedRole) else "",
            values=self._labels["semicolon"].join(
                self._member(type_, member) for member in (*type_.enum, *type_.flags)
            ),
            manual=self._section(field.manual or self._command.manual),
        )
        for place in formatting.field_places(field, self._words):
            for numbers in _numbers(self._edition, layout, field, self._command):
                yield start._replace(
                    position=place.position,
                    field=place.name,
                    raw=place.raw,
                    only=self._condition(numbers.only),
                    **(self._of_numbers(type_, numbers) if field.role.is_value and type_.is_number else {}),
                )

    def _of_role(self, field: Field) -> Iterator[str]:
        roles = {ConstantRole: "constant", ReservedRole: "reserved", NodeRole: "node"}
        label = roles.get(type(field.role))
        if label:
            yield self._labels[label]

    def _of_numbers(self, type_: Type, numbers: Numbers) -> Mapping[str, Cell]:
        linear, limits = numbers.linear, numbers.limits
        is_float = type_.encoding is Encoding.FLOAT
        cells: dict[str, Cell] = {"unit": type_.unit.symbol if type_.unit else ""}
        if limits and not is_float:
            cells |= {"raw_minimum": _bound(limits.low), "raw_maximum": _bound(limits.high)}
        if linear is None:
            return {**cells, "resolution": self._labels["not_given"]}
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

    def _member(self, type_: Type, member: Member) -> str:
        value = self._labels["bit"].format(member.value, 1 << member.value) if type_.flags else str(member.value)
        title = member.title.get(self._language, "")
        return self._labels["member"].format(value, member.name, title) if title else f"{value} = {member.name}"

    def _section(self, manual: str) -> str:
        """The section of the manual. A spreadsheet would read `2.10` as a number."""
        return self._labels["section"].format(manual) if manual[:1].isdigit() else manual

    def _condition(self, only: Mapping[str, tuple[str, ...]]) -> str:
        """`Model: A, B`, by the titles of the parameters."""
        texts = self._labels
        shown = ((self._edition.parameter(name).title[self._language], values) for name, values in only.items())
        listed = (texts["condition"].format(title, texts["comma"].join(values)) for title, values in shown)
        return texts["semicolon"].join(listed)


_ROLES = {KeyRole.CODE: "selector", KeyRole.INDEX: "index", KeyRole.CONSTANT: "constant"}


def _fixed(raw: int) -> Cell:
    """A code, or a negative number."""
    return formatting.constant(raw) if raw >= 0 else Fraction(raw)


def _answer(command: Command, direction: Direction, texts: Mapping[str, str]) -> str:
    """The form of a reply, or that a request has none."""
    if direction is Direction.REQUEST:
        return "" if command.replies else texts["no_reply"]
    forms = [texts["echo"] for reply in command.replies if isinstance(reply, EchoReply)]
    forms += [texts["other"].format(reply.of) for reply in command.replies if isinstance(reply, OtherReply)]
    if command.from_each:
        forms.append(texts["from_each"].format(formatting.numbers(command.from_each)))
    return texts["semicolon"].join(forms)


def _numbers(edition: Edition, layout: Layout, field: Field, command: Command) -> Iterator[Numbers]:
    """The numbers of a field, once for each combination of parameter values that makes a difference."""
    type_ = field.type
    limited = dict.fromkeys([*command.only, *([layout.parameter] if field.only and layout.parameter else [])])
    only = {name: values_of(name, layout, field, command) for name in limited}
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
