"""One DBC file in cantools: reads a frame of its direction, and writes one."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import cantools
from cantools.database import Database, DecodeError, EncodeError
from cantools.database.can import Message as CanMessage, Signal

from ..model.edition import Edition
from ..model.layout import Field
from ..model.message import Command, Direction, Message
from ..model.refusal import Refusal
from ..semantics.decoder import failed_checks
from ..semantics.encoder import Encoder
from ..semantics.frame import has_id
from ..semantics.plan import CheckMeaning, message_plan
from ..targets.dbc.frames import Part
from ..targets.dbc.limits import limit
from ..targets.dbc.names import LETTER, message_endings, node_name, reserved_name
from ..targets.dbc.text import fitting
from ..targets.dbc.view import EXTENDED
from .adapter import CanFrame, Cannot, Decoded, ExactValue, Parameters, Raw, Refused, assignment, joined_value
from .dbc_fields import Data, Number, cell_of_selector, cells, values_of

_ID = re.compile(r'(?:BO_|BO_TX_BU_|VAL_|SIG_VALTYPE_|SG_MUL_VAL_|CM_ (?:BO_|SG_)|BA_ "\w+" (?:BO_|SG_)) (\d+) ')


def load(text: str) -> Database:
    """What cantools makes of a file."""
    database = cantools.database.load_string(text, "dbc", strict=True)
    assert isinstance(database, Database)
    return database


class DbcMessages:
    """The messages of a file by name, each loaded when it is asked for, since cantools takes long for a whole file."""

    def __init__(self, text: str) -> None:
        lines = text.splitlines(keepends=True)
        owners: list[int | None] = []
        for line in lines:
            match = _ID.match(line)
            owners.append(owners[-1] if line.startswith(" SG_ ") else int(match[1]) if match else None)
        self._lines = list(zip(owners, lines, strict=True))
        long_names = dict(re.findall(r'^BA_ "SystemMessageLongSymbol" BO_ (\d+) "(\w+)";$', text, re.MULTILINE))
        self.names = {
            long_names.get(str(owner), line.split()[2].rstrip(":")): owner
            for owner, line in self._lines
            if owner is not None and line.startswith("BO_ ")
        }
        self._loaded: dict[int, CanMessage] = {}
        self._owned: dict[str, dict[str, int]] = {}

    def owned_by(self, owner: str) -> Mapping[str, int]:
        """The ids of the messages whose names start with what matches `owner` and `_`, by the rest of the name."""
        if owner not in self._owned:
            matches = ((re.match(f"{owner}_", name), name, number) for name, number in self.names.items())
            self._owned[owner] = {name[match.end() :]: number for match, name, number in matches if match}
        return self._owned[owner]

    def message(self, number: int) -> CanMessage:
        """The message with an id as it is in the file."""
        if number not in self._loaded:
            (self._loaded[number],) = load(self._text_of(number)).messages
        return self._loaded[number]

    def _text_of(self, number: int) -> str:
        """The file without the lines of other messages."""
        return "".join(line for owner, line in self._lines if owner in (None, number))


class DbcFile:
    def __init__(self, edition: Edition, text: str, is_of_table: bool) -> None:
        self._edition = edition
        self._is_of_table = is_of_table
        self._messages = DbcMessages(text)
        self._numbers = {*self._messages.names.values()}

    def read(self, direction: Direction, frame: CanFrame) -> Decoded | Refused:
        number = frame.id | (EXTENDED if frame.extended else 0)
        if number not in self._numbers:
            return Refused(Refusal.UNKNOWN_ID)
        can_message = self._messages.message(number)
        if (fitting(self._edition.bus.host) in can_message.senders) is not (direction is Direction.REQUEST):
            return Refused(Refusal.UNKNOWN_ID)
        try:
            numbers = _mapping(can_message.decode(frame.data, decode_choices=False, scaling=False, allow_excess=False))
            shown = _mapping(can_message.decode(frame.data))
            if any(math.isnan(number) for number in numbers.values()):
                raise Cannot("not_finite")
        except DecodeError as error:
            if "data size" not in str(error):
                return Refused(Refusal.UNKNOWN_CODE)
            same_id = (message for message in self._edition.messages(direction) if has_id(message, frame))
            if any(message.dlc == len(frame.data) for message in same_id):
                raise Cannot("lengths") from None
            return Refused(Refusal.WRONG_LENGTH)
        selector = _selector(can_message)
        name = shown[selector.name] if selector else can_message.name.partition("_")[2]
        is_named = not isinstance(name, (int, float))
        command = self._command(str(name)) if is_named else self._command_of_others(direction, frame, shown)
        if command is None:
            raise Cannot("selectors_apart")
        message = message_of(command, direction)
        if not self._is_of_table and len(self._part(message, None).selectors) > 1:
            raise Cannot("selectors_apart")
        if message.dlc != can_message.length:
            raise Cannot("lengths")
        return self._decoded(message, frame, can_message, numbers, shown, selector)

    def _decoded(
        self,
        message: Message,
        frame: CanFrame,
        can_message: CanMessage,
        numbers: Mapping[str, Number],
        shown: Mapping[str, object],
        selector: Signal | None,
    ) -> Decoded:
        raw, values = {}, {}
        part = self._part(message, numbers[selector.name] if selector else None)
        for check, _ in failed_checks(message, frame, {}):
            raise Cannot(limit(check))
        for field in message.layout.fields:
            places = cells(can_message, part, field) or (cell_of_selector(selector, field) if selector else [])
            if places:
                read = [place.raw(numbers) for place in places]
                if field.is_given:
                    raw[field.name] = read if field.is_array else read[0]
                    values[field.name] = joined_value(field, read) if field.type.joined else values_of(places, shown)
                    numbered = read if field.type.no_values and not field.type.joined else ()
                    texts = [place.value(shown) for place in places] if numbered else ()
                    pairs = zip(numbered, texts, strict=True)
                    if any(field.type.no_value(raw) for raw, text in pairs if not isinstance(text, str)):
                        raise Cannot("no_value_ranges")
        in_data = message.node_in_data
        node = _node(message, can_message) if in_data is None else raw[in_data.name]
        assert not isinstance(node, list)
        return Decoded(message.command, node, raw, values)

    def _part(self, message: Message, code: Number | None) -> Part:
        """A message with a code that its selector contains; None is the usual one."""
        values = None if code is None or len(message.keys) != 1 else [int(code)]
        return Part(self._edition.command(message.command), message, values)

    def _command(self, name: str) -> Command | None:
        """The command of a text, which ends in the code where a command has several, or in the direction.

        None for a text that several commands of a table share.
        """
        known = {command.name: command for command in self._edition.commands}
        return known.get(name) or known.get(name.rpartition("_")[0])

    def _command_of_others(self, direction: Direction, frame: CanFrame, shown: Mapping[str, object]) -> Command | None:
        """The command without a code whose signals, without a code in their names, follow the selector."""
        if not any(name.startswith(f"{LETTER[direction]}_") for name in [*shown][1:]):
            return None
        alike = (m for m in self._edition.messages(direction) if has_id(m, frame) and not self._part(m, None).selectors)
        return next((self._edition.command(message.command) for message in alike), None)

    def _code(
        self,
        message: Message,
        selector: Signal,
        given: Mapping[str, Raw] | Mapping[str, ExactValue],
        given_code: int | None,
    ) -> int | None:
        """What the selector holds for a message; None when the file does not have it, or shows raw bits in its place."""
        choices = {int(value): str(text) for value, text in (selector.choices or {}).items()}
        selectors = self._part(message, None).selectors
        if not selectors:
            value = next((given[f.name] for f in message.layout.fields if cell_of_selector(selector, f)), 0)
            assert isinstance(value, (int, Fraction))
            if value in choices:
                raise Cannot("other_code")
            return int(value)
        if self._is_of_table and given_code is None:
            return next((value for value, text in choices.items() if text == message.command), None)
        code = message.keys[0].value if given_code is None else given_code
        return code if len(selectors) == 1 and code in choices else None

    def write(
        self,
        message: Message,
        node: int | None,
        given: Mapping[str, Raw] | Mapping[str, ExactValue],
        parameters: Parameters,
        given_code: int | None,
        scaled: bool,
    ) -> CanFrame | Refused | None:
        """The frame, or why not; None when the file lacks the command."""
        of_node = self._messages.owned_by(node_name(message.address, node))
        named = of_node or self._messages.owned_by(node_name(message.address, None) + r"\d*")
        endings = message_endings(self._part(message, None))
        number = next((named[ending] for ending in endings if ending in named), None)
        can_message = None if number is None else self._messages.message(number)
        selector = _selector(can_message) if can_message else None
        code = self._code(message, selector, given, given_code) if selector else None
        if can_message is None or (selector and code is None):
            return None
        if not of_node:
            return Refused(Refusal.UNKNOWN_NODE)
        if message.dlc != can_message.length:
            raise Cannot("lengths")
        data: Data = {selector.name: code} if selector and code is not None else {}
        part = self._part(message, code)
        data |= {signal.name: 0 for signal in can_message.signals if signal.name == reserved_name(part)}
        plan = message_plan(message)
        for field in message.layout.fields:
            if field.type.joined and scaled:
                raise Cannot("joined")
            sent = [plan.sent.get(field, 0)] * len(field.elements)
            value = given.get(field.name) if field.is_given else sent
            elements: Sequence[Any] = value if isinstance(value, list) and not field.type.flags else [value]
            for place, element in zip(cells(can_message, part, field), elements, strict=False):
                put = place.put_raw if not field.is_given or not scaled else place.put_value
                refused = None if element is None else put(data, element, parameters)
                if refused:
                    return refused
        checked = _checked(part, can_message, data, scaled, parameters)
        # whether values mean another message depends on them, so `means_another` decides that
        limits = filter(None, (limit(step) for step in plan.encoding if not isinstance(step, CheckMeaning)))
        for name in limits if isinstance(checked, CanFrame) else ():
            raise Cannot(name)
        return checked


def message_of(command: Command, direction: Direction) -> Message:
    message = command.request if direction is Direction.REQUEST else command.reply
    assert message is not None
    return message


def _checked(
    part: Part, can_message: CanMessage, data: Data, scaled: bool, parameters: Parameters
) -> CanFrame | Refused:
    """What cantools makes of the signals, or says of them; Cannot for what it lets pass and the spec does not."""
    layout = part.message.layout
    places = ((f, place) for f in layout.fields for place in cells(can_message, part, f))
    fields = {signal.name: f for f, place in places for signal, _, _ in place.signals}
    infinite = [name for name, value in data.items() if isinstance(value, float) and value - value != 0]
    try:
        encoded = CanFrame(
            can_message.frame_id, can_message.encode(data, scaling=scaled, strict=True), can_message.is_extended_frame
        )
    except (EncodeError, ValueError, OverflowError) as error:
        if infinite:
            return Refused(Refusal.NOT_FINITE, fields[infinite[0]].name)
        if "is required" in str(error) or "not required" in str(error):
            return Refused(Refusal.MISSING_PARAMETER, layout.parameter)
        named = re.search(r'signal "(\w+)"', str(error))
        names = [field.name for field in fields.values()]
        if named and not _is_another_wrong(part, can_message, data, named[1], scaled, parameters):
            names = [fields[named[1]].name]
        return Refused(Refusal.OUT_OF_RANGE, names[0] if len(names) == 1 else None)
    if infinite:
        raise Cannot("not_finite")
    _refuse_all_unchecked(part, can_message, encoded.data, parameters)
    numbers = _mapping(can_message.decode(encoded.data, decode_choices=False, scaling=False))
    for field in layout.fields if scaled else ():
        for place in cells(can_message, part, field):
            if field.type.no_value(place.raw(numbers)) and not isinstance(data[place.signal.name], str):
                raise Cannot("no_value_numbers")
    return encoded


def _is_another_wrong(
    part: Part, can_message: CanMessage, data: Data, name: str, scaled: bool, parameters: Parameters
) -> bool:
    """Whether a field besides that of the signal which cantools names is wrong: it does not always name the first."""
    signal = can_message.get_signal_by_name(name)
    lowest = signal.minimum or 0
    right = lowest if scaled else signal.conversion.numeric_scaled_to_raw(lowest)
    try:
        encoded = can_message.encode({**data, name: right}, scaling=scaled, strict=True)
        _refuse_all_unchecked(part, can_message, encoded, parameters)
    except (EncodeError, Cannot):
        return True
    return False


def _refuse_all_unchecked(part: Part, can_message: CanMessage, encoded: bytes, parameters: Parameters) -> None:
    """Raises Cannot if a field has a raw integer that the spec forbids and cantools takes."""
    numbers = _mapping(can_message.decode(encoded, decode_choices=False, scaling=False))
    for field in part.message.layout.fields:
        for place in cells(can_message, part, field):
            direction = Direction.REPLY if place.is_divided else part.message.direction
            _refuse_unchecked(direction, field, place.raw(numbers), parameters)


def _refuse_unchecked(direction: Direction, field: Field, raw: int, parameters: Parameters) -> None:
    """Raises Cannot for a raw integer that the spec forbids and an encoder with a DBC takes."""
    if Encoder(assignment(parameters)).rejects_raw(field, raw):
        if field.type.enum or field.type.flags:
            raise Cannot("unnamed")
        if direction is Direction.REPLY:
            raise Cannot("reply_limits")


def _node(message: Message, can_message: CanMessage) -> int | None:
    number = can_message.name.partition("_")[0].removeprefix(node_name(message.address, None))
    return int(number) if number else None


def _selector(message: CanMessage) -> Signal | None:
    return next((signal for signal in message.signals if signal.is_multiplexer), None)


def _mapping(decoded: object) -> dict[str, Number]:
    assert isinstance(decoded, dict)
    return decoded
