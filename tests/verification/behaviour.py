"""The behaviour of old and new bindings on one bus, from running the generated Python code of both editions.

Requests are encoded by the old bindings and decoded by the new ones; replies and frames without a request are encoded
by the new bindings and decoded by the old ones. No code of `canwright.compare` is used: which names correspond is
known from the edit.
"""

from __future__ import annotations

import functools
import itertools
import math
import random
import re
import struct
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from fractions import Fraction
from types import ModuleType
from typing import Any, NamedTuple

from canwright.model.edition import Edition
from canwright.model.layout import Segment, Space
from canwright.model.message import Command, Direction, Key, KeyRole, Message
from canwright.model.refusal import Refusal
from canwright.model.types import Encoding, Parameter
from canwright.semantics.frame import required_raw
from canwright.targets.base import EditionInput
from canwright.targets.python.target import RUNTIME, PythonTarget
from canwright.targets.python.text import attribute, class_name

SAFE, LOUD, SILENT = range(3)
NAMES = ("safe", "loud", "silent")
SENDING, RECEIVING = "sending", "receiving"
SIDES = (SENDING, RECEIVING)

PACKAGE = "canwright_behaviour"
"""The package of all modules here; it has the runtime that is the same for every edition."""

ALL_NODES = 40
"""A range of at most so many nodes is tested completely, of a larger one some nodes."""

VECTORS = 14
"""So many combinations of raw integers besides enum members and flags are tested for each message."""


@dataclass
class Names:
    """The new names of what an edit renames; None for what it replaces by something else.

    Fields and members are renamed wherever they occur, or in one command or type: `COMMAND.FIELD`, `TYPE.MEMBER`.
    """

    commands: Mapping[str, str | None] = field(default_factory=dict)
    fields: Mapping[str, str | None] = field(default_factory=dict)
    members: Mapping[str, str | None] = field(default_factory=dict)
    parameters: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, str] = field(default_factory=dict)

    def command(self, name: str) -> str | None:
        """The new name of a command, or of a form of it that belongs to an entry of a table."""
        return self.commands.get(name, name)

    def field(self, command: str, name: str) -> str | None:
        """The new name of a field; an element of an array keeps its number."""
        whole, bracket, number = name.partition("[")
        now = self.fields.get(f"{command}.{whole}", self.fields.get(whole, whole))
        return None if now is None else attribute(now) + bracket + number


class Frame(NamedTuple):
    """A CAN frame."""

    id: int
    data: bytes
    extended: bool
    remote: bool

    def __str__(self) -> str:
        return f"{self.id:0{8 if self.extended else 3}X}#{'R' if self.remote else self.data.hex().upper()}"


class Meaning(NamedTuple):
    """A decoded frame: its command, its node, and the values of its fields and of its constants.

    Each element of an array has a value of its own, under its number: what people call cell 2 is `cell[2]`, and the
    comments of generated code name the number of each element.
    """

    command: str
    node: int | None
    values: dict[str, Any]
    constants: Mapping[str, Any]

    def __str__(self) -> str:
        node = f" of node {self.node}" if self.node is not None else ""
        return f"{self.command}{node} {self.values}"


@dataclass
class Side:
    """What happens on one side: the verdict is at least `low` and at most `high`, each with a frame that shows it."""

    low: int = SAFE
    high: int = SAFE
    low_why: str = ""
    high_why: str = ""

    def add(self, verdict: int, why: str, *, certain: bool = True) -> None:
        if certain and verdict > self.low:
            self.low, self.low_why = verdict, why
        if verdict > self.high:
            self.high, self.high_why = verdict, why


@functools.cache
def _runtime() -> ModuleType:
    """The runtime that every generated package contains."""
    package = ModuleType(PACKAGE)
    package.__path__ = [str(RUNTIME)]
    sys.modules[PACKAGE] = package
    return package


_COUNT = itertools.count()


class Binding:
    """The generated Python module of an edition, and its edition."""

    def __init__(self, item: EditionInput) -> None:
        _runtime()
        self.edition: Edition = item.edition
        path = f"{item.edition.family}/{item.edition.identifier}.py"
        self.text = next(o.text for o in PythonTarget().generate([item], {}) if o.path == path)
        self.module = ModuleType(f"{PACKAGE}.edition_{next(_COUNT)}")
        self.module.__package__ = PACKAGE
        sys.modules[self.module.__name__] = self.module
        try:
            exec(compile(self.text, path, "exec"), self.module.__dict__)
        finally:
            del sys.modules[self.module.__name__]
        self._depends: dict[Any, bool] = {}
        for message in item.edition.all_messages():
            self.of(message).CONSTANTS = dict(_constants(message))
            self.of(message).NUMBERS = {
                attribute(f.name): [e.index for e in f.elements] for f in message.layout.fields if f.is_array
            }

    @functools.cached_property
    def parts(self) -> dict[str, str]:
        """The text of each class and type, and under an empty name what decides between classes."""
        texts: dict[str, str] = {"": ""}
        helpers: dict[str, str] = {}
        for part in re.split(r"(?m)^(?=\S)", self.text):
            name = re.match(r"(?:class )?(\w+)", part)
            if name is None:
                continue
            if re.match(r"_[A-Z]+_\d+ = ", part):
                helpers[name[1]] = part.partition(" = ")[2]
            elif re.match(r"class |_?[A-Za-z]+ = \w+Type|[A-Z_0-9]+ = (Number|Integer|Float)", part):
                texts[name[1]] = part
            elif name[1].startswith(("_d", "_r", "_b", "_i")):
                texts[""] += part
        for name_, part in texts.items():
            texts[name_] = re.sub(r"_[A-Z]+_\d+", lambda m: helpers.get(m[0], m[0]), part)
        return texts

    @functools.cached_property
    def _words(self) -> dict[str, set[str]]:
        return {name: set(re.findall(r"\w+", text)) for name, text in self.parts.items() if name}

    def changed_since(self, old: Binding) -> set[str]:
        """The classes that are not the same as before, and an empty name if what decides between them is not."""
        changed = {name for name, text in self.parts.items() if old.parts.get(name) != text}
        changed |= old.parts.keys() - self.parts.keys()
        while True:
            more = {n for b in (self, old) for n, words in b._words.items() if n not in changed and words & changed}
            if not more:
                return changed
            changed |= more

    def of(self, message: Message) -> Any:
        """The class of a message."""
        return getattr(self.module, class_name(message.name))

    def parameters(self, assignment: Mapping[str, Any]) -> Any:
        """The `Parameters` of an assignment."""
        given = {}
        for parameter in self.edition.parameters:
            value = assignment.get(parameter.name)
            if value is not None:
                choice = parameter.is_choice and not parameter.is_numeric
                given[attribute(parameter.name)] = (
                    getattr(self.module, class_name(parameter.name))(value) if choice else value
                )
        return self.module.Parameters(**given)

    def decode(self, direction: Direction, frame: Frame, parameters: Any) -> Any:
        """A message, or the reason for its rejection."""
        decode = self.module.decode_request if direction is Direction.REQUEST else self.module.decode_reply
        try:
            return decode(frame.id, frame.data, parameters, extended=frame.extended, remote=frame.remote)
        except self.module.CodecError as error:
            return error

    def answer(self, request: Any, frame: Frame, parameters: Any) -> Any:
        """The answer to a request, or the reason for its rejection."""
        try:
            return self.module.decode_answer(
                request, frame.id, frame.data, parameters, extended=frame.extended, remote=frame.remote
            )
        except self.module.CodecError as error:
            return error

    def depends(self, cls: Any) -> bool:
        """Whether the meaning of a message depends on parameters."""
        if cls not in self._depends:
            types = [getattr(t, "type", t) for t in cls.TYPES.values()]
            self._depends[cls] = bool(cls.VARIANT_BY) or any(
                getattr(t, "scale_by", "") or getattr(t, "times", "") or getattr(t, "limits_by", "") for t in types
            )
        return self._depends[cls]


def frame_of(message: Any) -> Frame:
    """The frame of a message. Raises CodecError."""
    return Frame(message.can_id, message.encode(), message.EXTENDED, message.REMOTE)


def meaning(message: Any) -> Meaning:
    """The values of all fields in units; the raw integer where there is no scale."""
    raws = message.raw()
    values = {}
    for name, raw in raws.items():
        type_, numbers = message.TYPES[name], message.__class__.NUMBERS.get(name)
        if numbers is None:
            values[name] = _value(type_, raw, message.parameters, name)
        else:
            each = (_value(type_.type, element, message.parameters, name) for element in raw)
            values |= {f"{name}[{number}]": value for number, value in zip(numbers, each, strict=True)}
    return Meaning(message.COMMAND, message.node, values, message.__class__.__dict__.get("CONSTANTS", {}))


def _constants(message: Message) -> Iterator[tuple[str, Any]]:
    """The constants of a message with their values: numbers without a unit. That of a float is given by its bits."""
    yield from ((attribute(k.name), (k.value, "")) for k in message.keys if k.role is KeyRole.CONSTANT)
    for constant in (f for f in message.layout.fields if required_raw(f) is not None):
        raw, type_ = required_raw(constant) or 0, constant.type
        value = _float(raw, type_.width) if type_.encoding is Encoding.FLOAT else raw
        yield attribute(constant.name), (value, "")


def _float(raw: int, width: int) -> float:
    value: float = struct.unpack({32: "<f", 64: "<d"}[width], raw.to_bytes(width // 8, "little"))[0]
    return value


def _value(type_: Any, raw: Any, parameters: Any, name: str) -> Any:
    try:
        value = type_.value(raw, parameters, name)
    except ValueError as error:
        return ("raw", raw, type_.unit, getattr(error, "refusal", ""))
    if isinstance(value, IntFlag):
        enum = type(value)
        named = frozenset(m.name for m in enum if m.name and int(m) & int(value))
        return ("flags", named, int(value) & ~type_.mask)
    if isinstance(value, IntEnum):
        return ("member", value.name)
    if hasattr(type_, "members"):
        return ("unnamed", value)
    return (value, type_.unit)


def _same(old: Any, new: Any, names: Names) -> bool:
    if old == new and not names.members:
        return True
    if old[0] == "member" == new[0]:
        renamed = names.members.get(old[1].lower(), old[1].lower())
        return renamed is not None and renamed.upper() == new[1]
    if old[0] == "flags" == new[0]:
        renamed_all = {names.members.get(name.lower(), name.lower()) for name in old[1]}
        return None not in renamed_all and {str(n).upper() for n in renamed_all} == set(new[1]) and old[2] == new[2]
    if isinstance(old[0], str) or isinstance(new[0], str):
        return bool(old == new)
    a, b = old[0], new[0]
    if old[1] != new[1]:
        return False
    return a == b or (isinstance(a, float) and math.isnan(a) and math.isnan(b)) or math.isclose(a, b, rel_tol=1e-9)


def difference(old: Meaning, new: Meaning, names: Names, *, receiving: bool) -> str:
    """What one message means to one side and not to the other; empty if it means the same to both.

    A field that only the sender of a reply knows makes no difference to the host.
    """
    if names.command(old.command) != new.command:
        return f"{old.command} or {new.command}"
    if old.node is not None and new.node is not None and old.node != new.node:
        return f"node {old.node} or {new.node}"
    seen = set()
    for name, value in old.values.items():
        now = names.field(old.command, name)
        if now is not None and now in new.constants:
            if not _same(value, new.constants[now], names):
                return f"{name} = {value} or the constant {new.constants[now]}"
            continue
        if now is None or now not in new.values:
            return f"{name} = {value} or no such field"
        seen.add(now)
        if not _same(value, new.values[now], names):
            return f"{name} = {value} or {new.values[now]}"
    extra = [name for name in new.values if name not in seen]
    for name in [name for name in extra if name in old.constants]:
        extra.remove(name)
        constant = old.constants[name]
        if not _same(constant, new.values[name], names):
            return f"the constant {name} = {constant} or {new.values[name]}"
    if extra and not receiving:
        return f"{extra[0]} = {new.values[extra[0]]} or no such field"
    return ""


def _values_of(parameter: Parameter, number: int = 0) -> list[Any]:
    """Values of a parameter; a `number` that differs from those of others."""
    if not parameter.is_choice:
        low = parameter.minimum or 0
        high = parameter.maximum if parameter.maximum is not None else low + 50
        chosen = low + (high - low) * Fraction(2 + number % 8, 11)
        return [int(chosen) if parameter.whole else float(chosen)]
    return [v.number if parameter.is_numeric else v.name for v in parameter.values]


def assignments(old: Edition, new: Edition, names: Names) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Parameters of one node in both editions; each value at least once."""
    there = {p.name: p for p in new.parameters}
    options: list[tuple[str | None, str | None, list[tuple[Any, Any]]]] = []
    for number, parameter in enumerate(old.parameters):
        now = there.pop(names.parameters.get(parameter.name, parameter.name), None)
        values = _values_of(parameter, number)
        if now is None:
            options.append((parameter.name, None, [(value, None) for value in values]))
            continue
        known = set(_values_of(now)) if now.is_choice else None
        pairs = [(v, names.values.get(str(v), v)) for v in values]
        options.append((parameter.name, now.name, [(a, b) for a, b in pairs if known is None or b in known]))
    options += [(None, p.name, [(None, value) for value in _values_of(p)]) for p in there.values()]
    count = max((len(pairs) for _, _, pairs in options), default=1)
    assigned = []
    for i in range(max(count, 1)):
        before: dict[str, Any] = {}
        after: dict[str, Any] = {}
        for old_name, new_name, pairs in options:
            if not pairs:
                continue
            a, b = pairs[i % len(pairs)]
            if old_name is not None:
                before[old_name] = a
            if new_name is not None and b is not None:
                after[new_name] = b
        assigned.append((before, after))
    return assigned


def nodes_of(cls: Any) -> list[int | None]:
    """All nodes of a message, or some of many."""
    if not hasattr(cls, "NODES"):
        return [None]
    low, high = cls.NODES
    if high - low < ALL_NODES:
        return list(range(low, high + 1))
    chosen = {low, low + 1, (low + high) // 2, high - 1, high, low + 5, *(1 << k for k in range(12))}
    return sorted(n for n in chosen if low <= n <= high)


def _raws(type_: Any, parameters: Any, dice: random.Random) -> list[Any]:
    """Raw integers of a field: limits, members, bits, random ones."""
    if hasattr(type_, "count"):
        raws = _raws(type_.type, parameters, dice)
        return [tuple(raws[(i + j) % len(raws)] for j in range(type_.count)) for i in range(len(raws))]
    if hasattr(type_, "members"):
        return list(type_.members)[:24]
    if hasattr(type_, "mask"):
        bits = [1 << k for k in range(type_.mask.bit_length()) if type_.mask >> k & 1]
        return [0, type_.mask, *bits[:24]]
    if hasattr(type_, "_number"):
        return _floats(type_, parameters)
    low, high = type_.raw_range(parameters)
    if low > high:
        return []
    near = {low, high, (low + high) // 2, dice.randint(low, high), dice.randint(low, high), 0, 1, -1, low + 1, high - 1}
    return sorted(n for n in near if low <= n <= high)


def _floats(type_: Any, parameters: Any) -> list[int]:
    low, high = type_.value_range(parameters)
    numbers = [0.0, 1.0, -1.0, 1.5, 37.25, low, high, (low + high) / 2]
    packer = struct.Struct("<f" if type_.high < 1 << 32 else "<d")
    raws = []
    for number in numbers:
        try:
            bits = int.from_bytes(packer.pack(number), "little")
            raws.append(type_.check(bits, parameters, "f"))
        except (ValueError, OverflowError):
            continue
    return raws


def messages_of(cls: Any, parameters: Any, dice: random.Random, holds: str = "") -> Iterator[Any]:
    """Messages of a class: limits and random raw integers of each field for one node, and one set of them for each.

    `holds` is the field that contains a node.
    """
    nodes = nodes_of(cls)
    node = dice.choice(nodes)
    empty = cls.__new__(cls)
    empty._parameters = parameters
    try:
        fields = empty.fields()
    except ValueError:
        return
    candidates = {name: [1, 2, 3] if name == holds else _raws(cls.TYPES[name], parameters, dice) for name in fields}
    if any(not raws for raws in candidates.values()):
        return
    base = {name: dice.choice(raws) for name, raws in candidates.items()}
    vectors = [{name: raws[i % len(raws)] for name, raws in candidates.items()} for i in (0, -1)]
    for name, raws in candidates.items():
        vectors += [{**base, name: raw} for raw in raws[:VECTORS]]
    vectors += [{name: dice.choice(raws) for name, raws in candidates.items()} for _ in range(3 if fields else 0)]
    for vector in vectors if fields else [{}]:
        yield cls.from_raw(node=node, parameters=parameters, **vector)
    for number in nodes:
        yield cls.from_raw(node=number, parameters=parameters, **base)


def holder(message: Message) -> str:
    """The field of a message that contains a node, as the generated code calls it; empty without one."""
    bits = message.node_bits
    return attribute(bits.name) if bits is not None else ""


def available(command: Command, assignment: Mapping[str, Any]) -> bool:
    """Whether nodes with these parameters have a command and it is implemented."""
    return command.available({n: str(v) for n, v in assignment.items()})


class Old:
    """The bindings of the old edition with their requests and periodic frames, used for many edits."""

    def __init__(self, item: EditionInput, seed: int = 1) -> None:
        self.binding = Binding(item)
        self.edition = item.edition
        self.seed = seed
        self._sent: dict[str, list[tuple[Any, Any, Frame, Meaning]]] = {}

    def sent(self, assignment: Mapping[str, Any]) -> list[tuple[Command, Any, Any, Frame, Meaning]]:
        """Requests with their frames and what the old edition itself reads in them."""
        key = repr(assignment)
        if key not in self._sent:
            self._sent[key] = list(self._make(assignment))  # type: ignore[arg-type]
        return self._sent[key]  # type: ignore[return-value]

    def _make(self, assignment: Mapping[str, Any]) -> Iterator[tuple[Command, Any, Any, Frame, Meaning]]:
        known = self.binding.parameters(assignment)
        for command in self.edition.commands:
            if command.request is None or not available(command, assignment):
                continue
            cls = self.binding.of(command.request)
            dice = random.Random(f"{self.seed} {command.name}")
            for message in messages_of(cls, known, dice, holder(command.request)):
                sent = self.seen(command, message, known)
                if sent is not None:
                    yield sent

    def seen(self, command: Command, message: Any, known: Any) -> Any:
        frame = frame_of(message)
        again = self.binding.decode(Direction.REQUEST, frame, known)
        return None if isinstance(again, ValueError) else (command, message, known, frame, meaning(again))


@dataclass
class Behaviour:
    """What old and new bindings do together, by side."""

    sides: dict[str, Side] = field(default_factory=lambda: {side: Side() for side in SIDES})
    names_differ: bool = False


def behaviour(old: Old, new: Binding, names: Names) -> Behaviour:
    """The verdict of each side."""
    return _Run(old, new, names).run()


class _Run:
    def __init__(self, old: Old, new: Binding, names: Names) -> None:
        self.old, self.new, self.names = old, new, names
        self.found = Behaviour()
        self.sending, self.receiving = self.found.sides[SENDING], self.found.sides[RECEIVING]
        self.new_commands = {c.name: c for c in new.edition.commands}
        self.now = {c.name: names.command(c.name) for c in old.edition.commands}
        self.dice = random.Random(1)
        self.replies: dict[Any, list[Any]] = {}
        self.done: set[Any] = set()
        self.changed = new.changed_since(old.binding)

    def run(self) -> Behaviour:
        pairs = assignments(self.old.edition, self.new.edition, self.names)
        for number, (before, after) in enumerate(pairs):
            known = self.new.parameters(after)
            first = number == 0
            reread = self.old.binding.parameters(before)
            answered: set[Any] = set()
            for command, message, mine, frame, meant in self._requests(before):
                depends = self.old.binding.depends(type(message))
                heard = self.new.decode(Direction.REQUEST, frame, known)
                if not first and not depends and not isinstance(heard, ValueError):
                    reply = self.new_commands[heard.COMMAND].reply
                    theirs = command.reply
                    if not (
                        self.new.depends(type(heard))
                        or (reply and self.new.depends(self.new.of(reply)))
                        or (theirs and self.old.binding.depends(self.old.binding.of(theirs)))
                        or self.new_commands[heard.COMMAND].only
                        or command.only
                    ):
                        continue
                self._request(command, message, mine, frame, meant, heard, after, answered, known)
            self._direct(before, after, known, reread)
            self._periodic(before, after, known, reread)
        self.found.names_differ = _exported(self.old.binding) != _exported(self.new)
        return self.found

    def _requests(self, before: Mapping[str, Any]) -> Iterator[tuple[Command, Any, Any, Frame, Meaning]]:
        counts: dict[str, int] = {}
        for sent in self.old.sent(before):
            command = sent[0]
            counts[command.name] = counts.get(command.name, 0) + 1
            if counts[command.name] <= self._limit(command):
                yield sent
        yield from self._with_constants(before)
        if "" not in self.changed:
            return
        keys = {(m.id, _keys(m)) for m in self.old.edition.messages(Direction.REQUEST)}
        fresh = [m for m in self.new.edition.messages(Direction.REQUEST) if (m.id, _keys(m)) not in keys]
        if not fresh:
            return
        last: dict[str, int] = {}
        for command, message, known, frame, _ in list(self.old.sent(before)):
            last[command.name] = last.get(command.name, 0) + 1
            for added in fresh:
                if message._raws and last[command.name] <= 6:
                    yield from self._overlaid(command, message, known, frame, added)

    def _with_constants(self, before: Mapping[str, Any]) -> Iterator[tuple[Command, Any, Any, Frame, Meaning]]:
        """Requests with the constants that the new edition demands in them."""
        counts: dict[str, int] = {}
        for command, message, known, frame, _ in list(self.old.sent(before)):
            now = self.new_commands.get(self.now[command.name] or "")
            if now is None or now.request is None or class_name(now.request.name) not in self.changed:
                continue
            demanded = [f for f in now.request.layout.fields if required_raw(f) is not None and not f.is_array]
            counts[command.name] = counts.get(command.name, 0) + 1
            if demanded and counts[command.name] <= VECTORS:
                parts = [(f.space, f.elements[0].segments, required_raw(f) or 0) for f in demanded]
                yield from self._changed_to(command, message, known, frame, placed(frame, parts))

    def _limit(self, command: Command) -> int:
        """So many requests of a command are worth a test."""
        assert command.request is not None
        now = self.new_commands.get(self.now[command.name] or "")
        if now is None or now.request is None or class_name(command.request.name) in self.changed:
            return 1 << 30
        if now.implemented != command.implemented or now.only != command.only:
            return 1 << 30
        replies = [class_name(c.reply.name) for c in (command, now) if c.reply is not None]
        return 6 if "" in self.changed else 1 if set(replies) & self.changed else 0

    def _overlaid(self, command: Command, message: Any, known: Any, frame: Frame, another: Message) -> Iterator[Any]:
        """The request with the keys of another message in its fields, if it remains the same request."""
        if frame.remote or frame.extended != another.id.extended or another.dlc != len(frame.data):
            return
        yield from self._changed_to(command, message, known, frame, overlay(frame, another.keys))

    def _changed_to(self, command: Command, message: Any, known: Any, frame: Frame, changed: Frame) -> Iterator[Any]:
        """A request as another frame, if it remains the same request."""
        if changed == frame:
            return
        again = self.old.binding.decode(Direction.REQUEST, changed, known)
        if type(again) is not type(message):
            return
        try:
            if frame_of(again) != changed:
                return
        except ValueError:
            return
        yield command, again, known, changed, meaning(again)

    def _request(
        self,
        command: Command,
        message: Any,
        mine: Any,
        frame: Frame,
        meant: Meaning,
        heard: Any,
        after: Mapping[str, Any],
        answered: set[Any],
        known: Any,
    ) -> None:
        """One request of the old host to a new node, and its answer."""
        sure = command.implemented
        if isinstance(heard, ValueError):
            missing = getattr(heard, "refusal", None) == Refusal.MISSING_PARAMETER.value
            self.sending.add(LOUD, f"{frame} {meant}: {heard}", certain=sure and not missing)
            if command.replies:
                self.receiving.add(LOUD, f"{frame}: no answer", certain=False)
            return
        theirs = self.new_commands[heard.COMMAND]
        understood = meaning(heard)
        differs = difference(meant, understood, self.names, receiving=False)
        if differs:
            self.sending.add(SILENT, f"{frame} is {meant}; new {understood}: {differs}", certain=sure)
            if command.replies and self.now.get(meant.command) != understood.command:
                self.receiving.add(SILENT, f"{frame}: the answer to another request", certain=False)
        elif not theirs.implemented or not available(theirs, after):
            self.sending.add(LOUD, f"{frame} {meant}: not available", certain=sure)
            return
        elif self._refused(heard):
            self.sending.add(SILENT, f"{frame} {meant}: out of range", certain=False)
        wrong = bool(differs) or not sure
        key = (command.name, heard.COMMAND, message.node, _asked(theirs, heard))
        if key in answered:
            return
        answered.add(key)
        if not theirs.replies:
            if command.replies:
                self.receiving.add(LOUD, f"{frame} {meant}: no answer", certain=not wrong)
                self.sending.add(LOUD, f"{frame} {meant}: no answer", certain=False)
            return
        if set(command.from_each) - {*theirs.from_each}:
            self.receiving.add(LOUD, f"{frame} {meant}: no answer from some nodes", certain=not wrong)
        for reply in self._replies(theirs, heard, known):
            self._reply(command, message, mine, reply, theirs, known, certain=not wrong)

    def _refused(self, message: Any) -> bool:
        try:
            message.check()
        except ValueError:
            return True
        return False

    def _replies(self, command: Command, request: Any, known: Any) -> Iterator[Any]:
        """Replies of a new node to a request that it has decoded."""
        assert command.reply is not None
        cls = self.new.of(command.reply)
        if command.is_echoed:
            try:
                data = request.encode()
            except ValueError:
                return
            message = self.new.decode(Direction.REPLY, frame_of(request), known)
            if isinstance(message, cls):
                yield message
            else:
                asked = _asked(command, request) if hasattr(cls, "NODES") else None
                for node in nodes_of(cls) if asked is None else [asked]:
                    yield cls.unpack(node, request.can_id, data, known)
            return
        key = (cls, repr(known))
        if key not in self.replies:
            self.replies[key] = list(messages_of(cls, known, random.Random(f"1 {command.reply.name}")))
        asked = _asked(command, request)
        sources: list[int | None] = [*command.from_each] or [asked]
        inside = holder(command.reply)
        for message in self.replies[key]:
            for node in sources:
                values: dict[str, Any] = {"node": node} if hasattr(cls, "NODES") and node is not None else {}
                if inside and node is not None:
                    values[inside] = node
                try:
                    reply = message.replace(**values) if values else message
                    frame = frame_of(reply)
                except ValueError:
                    continue
                if not isinstance(self.new.answer(request, frame, known), ValueError):
                    yield reply
            if (repr(type(request)), cls) in self.done:
                break
        self.done.add((repr(type(request)), cls))

    def _reply(
        self, command: Command, request: Any, mine: Any, message: Any, theirs: Command, known: Any, *, certain: bool
    ) -> None:
        """One reply of a new node to a request of an old host."""
        try:
            frame = frame_of(message)
        except ValueError:
            return
        meant = meaning(message)
        for sent in self._accepted(frame, theirs):
            self._heard(command, theirs, request, mine, sent, meant, known, certain=certain)

    def _accepted(self, frame: Frame, command: Command) -> Iterator[Frame]:
        """The frame with each code that the reply may have."""
        yield frame
        reply = command.reply
        if reply is not None and reply.keys and reply.accepted_codes:
            for code in reply.accepted_codes:
                key = reply.keys[0]
                if code != key.value:
                    yield overlay(frame, [key], code)

    def _heard(
        self,
        command: Command,
        theirs: Command,
        request: Any,
        mine: Any,
        frame: Frame,
        meant: Meaning,
        known: Any,
        *,
        certain: bool,
    ) -> None:
        """One reply as the old host receives it; `theirs` is the command that the new node replies to."""
        alone = self._alone(frame, mine, known)
        if not command.replies:
            if alone:
                self.receiving.add(SILENT, alone, certain=False)
            return
        answer = self.old.binding.answer(request, frame, mine)
        if isinstance(answer, ValueError):
            lost = getattr(answer, "refusal", None) == Refusal.MISSING_PARAMETER.value
            self.receiving.add(LOUD, f"{frame} {meant}: {answer}", certain=certain and not lost)
            if alone:
                self.receiving.add(SILENT, alone, certain=False)
            return
        heard = meaning(answer)
        same = self.names.command(heard.command)
        if self.now.get(command.name) == theirs.name and same is not None:
            meant = meant._replace(command=same)  # of both editions the answer, whichever command it belongs to
        differs = difference(heard, meant, self.names, receiving=True)
        if differs:
            self.receiving.add(SILENT, f"{frame} is {meant}; old {heard}: {differs}", certain=certain)
        elif self._refused(answer):
            self.receiving.add(SILENT, f"{frame} {meant}: out of range", certain=False)
        elif alone:
            self.receiving.add(SILENT, alone, certain=False)

    def _alone(self, frame: Frame, mine: Any, known: Any) -> str:
        """How the meaning of a reply differs for those who do not know its request; empty if it does not."""
        heard = self.old.binding.decode(Direction.REPLY, frame, mine)
        meant = self.new.decode(Direction.REPLY, frame, known)
        if isinstance(heard, ValueError) or isinstance(meant, ValueError):
            return ""
        old, new = meaning(heard), meaning(meant)
        differs = difference(old, new, self.names, receiving=True)
        return f"{frame} is {new}; old {old}: {differs}" if differs else ""

    def _direct(self, before: Mapping[str, Any], after: Mapping[str, Any], known: Any, mine: Any) -> None:
        """Replies of new nodes whose request has not been understood: what else may be reported."""
        for command in self.old.edition.commands:
            theirs = self.new_commands.get(self.now[command.name] or "")
            if command.request is None or not command.replies:
                continue
            if theirs is None or theirs.reply is None:
                self.receiving.add(LOUD, f"{command.name}: no answer", certain=False)
                continue
            cls, old_cls = self.new.of(theirs.reply), self.old.binding.of(command.request)
            unchanged = not {cls.__name__, old_cls.__name__} & self.changed
            if unchanged and "" not in self.changed:
                continue
            made = messages_of(cls, known, random.Random(f"1 {theirs.reply.name}"))
            for message in itertools.islice(made, 4 if unchanged else None):
                try:
                    frame = frame_of(message)
                except ValueError:
                    continue
                if theirs.request is None:
                    continue
                if isinstance(self.new.answer(self.new.of(theirs.request), frame, known), ValueError):
                    continue
                answer = self.old.binding.answer(old_cls, frame, mine)
                meant, alone = meaning(message), self._alone(frame, mine, known)
                if alone:  # a new host has sent the request, and the old one hears the reply
                    self.receiving.add(SILENT, alone, certain=False)
                if isinstance(answer, ValueError):
                    self.receiving.add(LOUD, f"{frame} {meant}: {answer}", certain=False)
                elif difference(meaning(answer), meant, self.names, receiving=True):
                    self.receiving.add(SILENT, f"{frame} is {meant}; old {meaning(answer)}", certain=False)

    def _periodic(self, before: Mapping[str, Any], after: Mapping[str, Any], known: Any, mine: Any) -> None:
        """Frames that new nodes send by themselves, and those that old hosts wait for."""
        was = {now: name for name, now in self.now.items()}
        for theirs in self.new.edition.commands:
            if theirs.request is not None or theirs.reply is None:
                continue
            if not theirs.implemented or not available(theirs, after):
                continue
            old_name = was.get(theirs.name)
            before_command = self.old.edition.command(old_name) if old_name else None
            cls = self.new.of(theirs.reply)
            unchanged = cls.__name__ not in self.changed
            if unchanged and "" not in self.changed:
                continue
            made = messages_of(cls, known, random.Random(f"1 {theirs.reply.name}"))
            for message in itertools.islice(made, 8 if unchanged else None):
                try:
                    frame = frame_of(message)
                except ValueError:
                    continue
                for sent in self._accepted(frame, theirs):
                    self._published(before_command, sent, meaning(message), mine, known)
        for command in self.old.edition.commands:
            if command.request is not None or command.reply is None or not available(command, before):
                continue
            theirs_now = self.new_commands.get(self.now[command.name] or "")
            gone = theirs_now is None or theirs_now.reply is None or theirs_now.request is not None
            if gone or (theirs_now is not None and not (theirs_now.implemented and available(theirs_now, after))):
                self.receiving.add(LOUD, f"{command.name} is no longer sent without a request")

    def _published(self, command: Command | None, frame: Frame, meant: Meaning, mine: Any, known: Any) -> None:
        """One frame that a new node sends by itself."""
        heard = self.old.binding.decode(Direction.REPLY, frame, mine)
        if isinstance(heard, ValueError):
            if command is not None:
                cls = self.old.binding.of(command.reply) if command.reply else None
                nodes = getattr(cls, "NODES", None)
                certain = meant.node is None or nodes is None or nodes[0] <= meant.node <= nodes[1]
                self.receiving.add(LOUD, f"{frame} {meant}: {heard}", certain=certain)
            return
        alone = self.new.decode(Direction.REPLY, frame, known)
        if not isinstance(alone, ValueError):
            meant = meaning(alone)
        differs = difference(meaning(heard), meant, self.names, receiving=True)
        if differs:
            self.receiving.add(SILENT, f"{frame} is {meant}; old {meaning(heard)}: {differs}")
        elif self._refused(heard):
            self.receiving.add(SILENT, f"{frame} {meant}: out of range", certain=False)


def _asked(command: Command, request: Any) -> int | None:
    """The node that a request asks."""
    inside = holder(command.request) if command.request is not None else ""
    return request.raw()[inside] if inside else request.node  # type: ignore[no-any-return]


def _keys(message: Message) -> tuple[Any, ...]:
    return tuple((k.space, k.segments, k.value) for k in message.keys)


def overlay(frame: Frame, keys: Iterable[Key], value: int | None = None) -> Frame:
    """A frame with the values of some keys."""
    return placed(frame, [(key.space, key.segments, key.value if value is None else value) for key in keys])


def placed(frame: Frame, parts: Iterable[tuple[Space, Iterable[Segment], int]]) -> Frame:
    """A frame with raw integers in some bits."""
    data, can_id = bytearray(frame.data), frame.id
    for space, segments, raw in parts:
        for segment in segments:
            bits = (raw >> segment.raw_low & (1 << segment.width) - 1) << segment.low
            mask = (1 << segment.width) - 1 << segment.low
            if space is Space.ID:
                can_id = can_id & ~mask | bits
            elif segment.byte < len(data):
                data[segment.byte] = data[segment.byte] & ~mask | bits
    return Frame(can_id, bytes(data), frame.extended, frame.remote)


def _exported(binding: Binding) -> dict[str, Any]:
    """The names that programs use."""
    module = binding.module
    names: dict[str, Any] = {}
    for name in module.__all__:
        value = getattr(module, name)
        names[name] = None
        if isinstance(value, type) and hasattr(value, "TYPES"):
            names[name] = sorted(value.TYPES)
        elif isinstance(value, type) and issubclass(value, (IntEnum, IntFlag)):
            names[name] = sorted(value.__members__)
        elif name == "Parameters":
            names[name] = sorted(value.__dataclass_fields__)
    return names
