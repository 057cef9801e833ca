"""Checks each frame that a comparison prints: what generated code of the sender and of the receiver reads in it.

A witness states what one side sends, and what the other side reads. Both statements are read back from their text and
compared with the decoded frame: the command, each value in its unit, each member.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

from canwright.compare import Change
from canwright.compare.change import SentenceArgument, with_facts
from canwright.compare.witnesses.witness import Witness
from canwright.model.edition import Edition
from canwright.model.layout import ReservedRole, Space
from canwright.model.message import Direction, Message
from canwright.model.types import Assignment
from canwright.targets.python.text import attribute

from .behaviour import Binding, Frame, Meaning, Names, meaning

_FIELD = re.compile(r"`(\w+)(?:\[(\d+)(?:\.\.(\d+))?\])? = ([^`]*)`")
_COMMAND = re.compile(r"`(\w+)`")


_PRINTED = ("scale-changed", "scale-rewritten", "field-format-changed", "field-meaning-changed")
"""Changes with resolutions, which are shown in the notation of the spec."""


def wrong_witnesses(changes: tuple[Change, ...], old: Binding, new: Binding, names: Names) -> Iterator[str]:
    """What generated code contradicts in the witnesses of some changes."""
    for change in changes:
        if change.rule.id not in _PRINTED and re.search(r"\d/\d", change.says()):
            yield f"{change.rule.id}: a fraction: {change.says()}"
        for witness in change.witnesses:
            if re.search(r"\d/\d", witness.says()):
                yield f"{change.rule.id}: a fraction: {witness.says()}"
            if witness.frame is not None:
                yield from (f"{change.rule.id}: {text}" for text in _wrong(witness, old, new, names))


def _text(fact: SentenceArgument | None) -> str:
    return "" if fact is None else with_facts("{fact}", {"fact": fact}, "en", {}, str)


def _wrong(witness: Witness, old: Binding, new: Binding, names: Names) -> Iterator[str]:
    assert witness.frame is not None
    sent, read = _text(witness.facts.get("sent")), _text(witness.facts.get("read"))
    is_request = witness.sentence.startswith("sent-")
    direction = Direction.REQUEST if is_request else Direction.REPLY
    sender, receiver = (old, new) if is_request else (new, old)
    frame = Frame(witness.frame.id, witness.frame.data, witness.frame.extended, witness.frame.remote)
    command = _COMMAND.match(sent or read)
    if command is None:
        yield f"no command in {witness.says()}"
        return
    known = [_parameters(b, witness.assignment, names, is_old=b is old) for b in (sender, receiver)]
    written = _as(sender, direction, command[1], frame, known[0], is_sender=True)
    if sent and written is None:
        yield f"{command[1]} is not sent so: {witness.says()}"
    elif written is not None:
        yield from (f"{text}, sent: {witness.says()}" for text in _differences(sent, written))
    allowed = re.fullmatch(r"≈?(\S+)\.\.≈?(\S+)( .*)?", _text(witness.facts.get("allowed")))
    if allowed is not None:
        values = [v for _, _, _, texts in _FIELD.findall(sent) for v in texts.split(", ")]
        if all(float(allowed[1]) <= float(v.partition(" ")[0].lstrip("≈")) <= float(allowed[2]) for v in values):
            yield f"a value in the range: {witness.says()}"
    if read:
        whole = _COMMAND.match(read)
        now = whole[1] if whole else _counterpart(command[1], sender, receiver, names, is_request=is_request)
        seen = _as(receiver, direction, now, frame, known[1]) if now else None
        if seen is None:
            yield f"{now} is not read so: {witness.says()}"
        else:
            yield from (f"{text}, read: {witness.says()}" for text in _differences(read, seen))


def _parameters(binding: Binding, assignment: Assignment, names: Names, *, is_old: bool) -> Any:
    """The parameters that a witness states; others have values that the comparison does not use."""
    given: dict[str, Any] = {}
    former = {now: was for was, now in names.parameters.items()}
    values = {now: was for was, now in names.values.items()}
    for parameter in binding.edition.parameters:
        stated = assignment.get(parameter.name)
        if is_old and stated is None:
            stated = assignment.get(names.parameters.get(parameter.name, parameter.name))
        if stated is not None and is_old and former:
            stated = values.get(str(stated), stated)
        if parameter.is_choice:
            chosen = next((v for v in parameter.values if v.name == stated), parameter.values[-1])
            given[parameter.name] = chosen.number if parameter.is_numeric else chosen.name
        else:
            low = parameter.minimum or 0
            given[parameter.name] = float(stated) if stated is not None else float(low) + 0.37
    return binding.parameters(given)


def _counterpart(command: str, sender: Binding, receiver: Binding, names: Names, *, is_request: bool) -> str | None:
    """The command of the receiver with the same meaning."""
    if is_request:
        return names.command(command)
    former = {now: was for was, now in names.commands.items() if now is not None}
    return former.get(command, command)


def _as(
    binding: Binding, direction: Direction, command: str, frame: Frame, parameters: Any, *, is_sender: bool = False
) -> Meaning | None:
    """A frame as a message of a command; None if it is none, or if the sender does not send these bits."""
    definition = next((c for c in binding.edition.commands if c.name == command), None)
    message = None if definition is None else definition.message(direction)
    if definition is None or message is None:
        return None
    cls = binding.of(message)
    ignored = 0 if is_sender else _reserved_bits_of_id(message)
    nodes = range(cls.NODES[0], cls.NODES[1] + 1) if hasattr(cls, "NODES") else [None]
    accepted: Meaning | None = None
    for node in nodes:
        try:
            decoded = cls.unpack(node, frame.id, frame.data, parameters)
            sent = not is_sender or message.accepted_codes or definition.is_echoed or decoded.encode() == frame.data
            if not sent or cls.EXTENDED is not frame.extended:
                continue
            if not (decoded.can_id ^ frame.id) & ~ignored:
                return meaning(decoded)
            if message.accepted_codes and accepted is None:  # its id can contain another code
                accepted = meaning(decoded)
        except ValueError:
            continue
    return accepted


def _reserved_bits_of_id(message: Message) -> int:
    """The bits of the id that a receiver ignores."""
    reserved = (f for f in message.layout.fields if f.space is Space.ID and isinstance(f.role, ReservedRole))
    return sum(1 << bit for field in reserved for element in field.elements for bit in element.bits)


def _differences(text: str, decoded: Meaning) -> Iterator[str]:
    """The statements of a text that a decoded frame does not confirm."""
    for name, first, last, value in _FIELD.findall(text):
        field = attribute(name)
        names = [f"{field}[{number}]" for number in range(int(first), int(last or first) + 1)] if first else [field]
        if any(known not in {*decoded.values, *decoded.constants} for known in names):
            yield f"no field {', '.join(names)}"
            continue
        values = [decoded.values.get(known, decoded.constants.get(known)) for known in names]
        texts = value.split(", ") if first else [value]
        if len(texts) != len(values) or not all(map(_is_value, texts, values)):
            yield f"{name} is {values}"
    node = re.search(r"node (\d+)", text)
    if node is not None and decoded.node is not None and int(node[1]) != decoded.node:
        yield f"the node is {decoded.node}"


def _is_value(text: str, known: Any) -> bool:
    if known[0] == "member":
        return bool(text == known[1].lower())
    if known[0] == "flags":
        parts = set(text.split(" + ")) - {"0"}
        return parts == {name.lower() for name in known[1]} | ({str(known[2])} if known[2] else set())
    if known[0] == "unnamed":
        return text == str(int(known[1]))
    if known[0] == "raw":
        return text == str(known[1])
    if not math.isfinite(known[0]):
        return text == "not finite"
    number, _, unit = text.partition(" ")
    if unit != _SYMBOLS.get(known[1], known[1]):
        return False
    about = number.startswith("≈")
    return math.isclose(float(number.lstrip("≈")), known[0], rel_tol=1e-5 if about else 1e-12, abs_tol=1e-300)


_SYMBOLS: dict[str, str] = {}


def learn_units(*editions: Edition) -> None:
    """Remembers the symbols of the units of some editions."""
    _SYMBOLS.update({t.unit.name: t.unit.symbol for e in editions for t in _types(e) if t.unit is not None})


def _types(edition: Edition) -> Iterator[Any]:
    yield from edition.types
    yield from (f.type for m in edition.all_messages() for f in m.layout.fields)
