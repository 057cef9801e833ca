"""The self-test of an edition: its golden frames as tables, and the calls that replay them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple, TypeVar

from ...model.edition import Edition
from ...model.golden_frames import (
    CheckedFrame,
    GoldenFrame,
    GoldenFrames,
    RawValue,
    RefusedFrame,
    RefusedValues,
    Sourced,
)
from ...model.layout import Field, Layout
from ...model.message import Direction, Message
from ...model.refusal import Refusal
from ...semantics.decoder import Decoder, Identified
from ...semantics.frame import can_frame, code_of, node_of
from ..base import EditionInput
from .choices import parameter_literal
from .expressions import braces, integer
from .layouts import initializer, literals
from .text import WIDTH
from .view import EditionView

EXTENDED, REMOTE = 1 << 31, 1 << 30
UNIQUE, ENCODED, REQUEST, REPLY, MESSAGE, ASKED, ANSWER = 1, 2, 4, 5, 6, 7, 8
"""The kinds of cases, as `canwright_selftest.h` defines them."""

Known = Mapping[str, int | str | Fraction]
Raws = Mapping[str, RawValue]
T = TypeVar("T")


class Case(NamedTuple):
    """A row of the table; `golden` is None for the request before a reply, which is no case of its own."""

    comment: str
    row: str
    golden: Sourced | None

    @property
    def text(self) -> str:
        """The row with its comment beside it, or above if there is too little space."""
        text = f"{self.row}, /* {self.comment} */"
        return text if len(text) <= WIDTH - 8 else f"/* {self.comment} */\n        {self.row},"


def has_self_test(specification: EditionInput) -> bool:
    """True if there are golden frames to replay."""
    return specification.frames is not None and bool(specification.frames.frames)


class SelfTest:
    """The table of the golden frames of an edition, and the functions that its cases call.

    Omitted are values in units, and raw integers that the members of a struct cannot contain.
    """

    def __init__(self, edition: Edition, frames: GoldenFrames, view: EditionView) -> None:
        self._edition, self._frames, self._view = edition, frames, view
        self._names = view.names
        self._decoder = Decoder(edition)
        self._messages: dict[Message, int] = {}
        self._raws: dict[Layout, dict[str, int]] = {}
        self._known: dict[str, int] = {}
        self.cases: list[Case] = []
        number = 1
        every = (map(self._frame, frames.frames), self._rejections(), self._refusals(), self._exchanges())
        for case in itertools.chain(*every):
            self.cases.append(case._replace(comment=f"{number}: {case.comment}"))
            number += case.golden is not None
        self.layouts = [
            (view.message(edition.of_layout(layout)[0]).layout, _table(layout), entries)
            for layout, entries in self._raws.items()
        ]
        """Each layout of cases, with the name of the table of their raw integers, and its entries."""
        numbers = {layout: number for number, layout in enumerate(self._raws, 1)}
        self.messages = [(view.message(m), numbers.get(m.layout, 0), _table(m.layout)) for m in self._messages]
        """Each message with the number and the name of the table of its raw integers."""
        self.directions = [direction for direction in view.directions if direction.decode]
        self.parameters = list(self._known)

    def _frame(self, frame: GoldenFrame) -> Case:
        message, can = self._message(frame.direction, frame.command), can_frame(frame)
        alone = self._decoder.identify(frame.direction, can, frame.parameters)
        is_unique = isinstance(alone, Identified) and alone.message is message
        text = self._row(
            (UNIQUE if is_unique else 0) | (0 if frame.decode_only else ENCODED),
            frame,
            frame.parameters,
            node=node_of(message, can, frame.parameters) or 0,
            message=_index(self._messages, message),
            raws=self._raw_index(message, frame.raw, code_of(message, can)),
        )
        return Case(f"{frame.direction.value} of {frame.command}", text, frame)

    def _rejections(self) -> Iterator[Case]:
        for entry in self._frames.refused:
            if isinstance(entry, RefusedFrame) and self._edition.messages(entry.decode):
                kind = REQUEST if entry.decode is Direction.REQUEST else REPLY
                text = self._row(kind, entry, entry.parameters, status=entry.says.name)
                yield Case(f"{entry.decode.value}: {entry.says.value}", text, entry)

    def _refusals(self) -> Iterator[Case]:
        """Raw integers that the function of a message rejects; it does not ask whether the node has the command."""
        for entry in self._frames.refused:
            if isinstance(entry, RefusedValues) and not entry.values and entry.says is not Refusal.NOT_AVAILABLE:
                message = self._message(entry.encode, entry.command)
                if all(_fits(f, entry.raw.get(f.name, 0)) for f in message.layout.given):
                    text = self._row(
                        MESSAGE,
                        None,
                        entry.parameters,
                        node=entry.node or 0,
                        message=_index(self._messages, message),
                        raws=self._raw_index(message, entry.raw, None),
                        field=self._names.upper("field", entry.field_name) if entry.field_name else "0",
                        status=entry.says.name,
                    )
                    yield Case(f"{entry.encode.value} of {entry.command}: {entry.says.value}", text, entry)

    def _exchanges(self) -> Iterator[Case]:
        for entry in self._frames.exchanges if self._view.answers else ():
            status = entry.says.name if entry.says else "OK"
            yield Case("a request", self._row(ASKED, entry.request, {}), None)
            known = entry.parameters if self._view.check_reply_parameters else {}
            text = self._row(ANSWER, entry.reply, known, status=status)
            yield Case(f"and a reply: {status.lower()}", text, entry)

    def _row(
        self,
        kind: int,
        frame: GoldenFrame | RefusedFrame | CheckedFrame | None,
        known: Known,
        *,
        node: int = 0,
        message: int = 0,
        raws: int = 0,
        field: str = "0",
        status: str = "",
    ) -> str:
        """A case, with four data bytes in a word; words of 0 at the end are left out."""
        flags = frame and (EXTENDED if frame.extended else 0) | (REMOTE if frame.remote else 0)
        data = frame.data[: self._edition.bus.frame_format.max_data_bytes] if frame else b""
        words = [data[at : at + 4].ljust(4, b"\0").hex().upper() for at in range(0, len(data.rstrip(b"\0")) or 1, 4)]
        stored = braces(f"0x{frame.id | (flags or 0):X}u" if frame else "0u", braces(*(f"0x{w}u" for w in words)))
        indices = (message, raws, field, self._parameters(known), len(frame.data) if frame else 0, kind)
        return braces(stored, f"{node}u", *map(str, indices), f"CANWRIGHT_{status}" if status else "0")

    def _message(self, direction: Direction, command: str) -> Message:
        message = self._edition.command(command).message(direction)
        if message is None:
            raise ValueError(f"{command} has no {direction.value}")
        return message

    def _raw_index(self, message: Message, raws: Raws, code: int | None) -> int:
        """The index of raw integers, and of a code, in the table of the layout; 0 without members."""
        fields, member = message.layout.given, self._view.message(message).layout.code
        if not fields and member is None:
            return 0
        texts = [initializer(f, literals(f, raws.get(f.name, 0)).values()) for f in fields]
        texts += [member.stored(message, code)] if member else []
        return _index(self._raws.setdefault(message.layout, {}), braces(*texts))

    def _parameters(self, known: Known) -> int:
        """The index of parameters in their table; 0 if the edition has none."""
        values = (parameter_literal(self._names, p, known.get(p.name)) for p in self._edition.parameters)
        return _index(self._known, braces(*values)) if self._edition.parameters else 0


def _table(layout: Layout) -> str:
    """The name of the table of a layout, which no other variable has."""
    return f"raws_{layout.name}"


def _index(numbers: dict[T, int], item: T) -> int:
    """The number of an item, which is added if it is new."""
    return numbers.setdefault(item, len(numbers))


def _fits(field: Field, raw: RawValue) -> bool:
    if isinstance(raw, list) and len(raw) != len(field.elements):
        return False
    return integer(field.type).holds(*(raw if isinstance(raw, list) else [raw]))
