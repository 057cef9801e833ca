"""Questions about a generated header besides frames: names, effects, limits, conversions, constants; and their answers.

The header says which functions and macros there are; the answers are computed from the model.
"""

from __future__ import annotations

import itertools
import math
import random
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import jinja2
from canwright.conformance.adapter import Parameters, Refused, assignment
from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import Encoding, Linear, Type, factors
from canwright.semantics.decoder import Rejection, linear_of
from canwright.semantics.encoder import Encoder
from canwright.targets.c.names import Names, layouts

from ...float_rule import nearest_integer
from ...verification.floating import DOUBLE, SINGLE, bits_of, is_finite, number_of
from .c_signatures import Stored, functions
from .reference import as_double

TEMPLATE = Path(__file__).with_name("c_facts.c.j2")

_MACRO = re.compile(r"^#define (\w+)[ ]+(\(?-?(?:0x[0-9A-Fa-f]+|\d+)[uUlL]*\)?)[ ]*(?:/\*.*)?$", re.MULTILINE)
_TYPE_FUNCTION = re.compile(r"(?P<stem>\w+?)_(?P<kind>valid|name|no_value|has_value|to_milli|from_milli|from_double)$")
_ADDRESS_FUNCTION = re.compile(r"(?P<stem>\w+?)_(?P<direction>request|reply)_(?P<kind>id|node)$")

_RAW = ("raw", "*raw")

SINGLE_ERROR = Fraction(7, 1 << 24)
"""The bound of conversions in single precision, relative to the magnitudes of value and offset."""

SMALLEST = Fraction(1, 1 << 148)
"""The bound of conversions next to 0."""

ARGUMENTS = {"parameters": "known", "raw": "raw", "value": "value", "id": "id", "node": "node", "found": "found"}


@dataclass(frozen=True)
class Fact:
    """What the program is asked, in words and parameters, and the words of the answer."""

    kind: str
    name: str
    parameters: Parameters
    rest: tuple[str, ...]
    answer: str


@dataclass(frozen=True)
class Single:
    """A conversion of single precision, to the bits of a float or from them, and what it may return."""

    type: str
    direction: str
    number: int
    parameters: Parameters
    least: Fraction
    most: Fraction
    reason: Refusal | None = None
    """The reason for which it may be refused."""
    is_refused: bool = False
    precision: int = 0
    """The bits of the fraction of a raw number in floating point; 0 for an integer."""

    def accepts(self, result: int | Refused) -> bool:
        """Whether a result is within the limits, or refused for the reason."""
        if isinstance(result, Refused):
            return result.says is self.reason
        precision = SINGLE if self.direction == "to" else self.precision
        number = number_of(result, precision) if precision else result
        return not self.is_refused and self.least <= number <= self.most


class Facts:
    """The facts of one header and its edition."""

    def __init__(self, edition: Edition, header: str) -> None:
        self._edition = edition
        self._prefix = f"{edition.family}_{edition.identifier}_".lower()
        self._functions = {
            name.removeprefix(self._prefix): function
            for name, function in functions(header).items()
            if name.startswith(self._prefix)
        }
        self._macros = [match[1] for match in _MACRO.finditer(header) if not match[1].endswith(("_SPEC", "_VERSION"))]
        names = self._names = Names(edition)
        fields = dict.fromkeys(f.name for layout in layouts(edition) for f in layout.fields if f.is_given)
        self._commands = {"": names.command("none"), **{c.name: names.command(c.name) for c in edition.commands}}
        self._fields = {"": names.upper("field", "none"), **{name: names.upper("field", name) for name in fields}}
        if names.lower("field_name") not in functions(header):
            self._fields = {}
        self._macros += [*self._enumerators()]
        self._types = {names.type_stem(type_): type_ for type_ in edition.types}
        self._chance = random.Random(1)

    def code(self) -> str:
        """The part of the program that answers."""
        effects = self._functions.get("command_effects")
        available = self._functions.get("command_available")
        template = jinja2.Environment(undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
        return template.from_string(TEMPLATE.read_text("utf-8")).render(
            prefix=self._prefix,
            fd="fd_" if self._edition.bus.frame_format.is_fd else "",
            functions=[*self._type_functions(), *self._address_functions()],
            commands=[{"name": name, "enumerator": enumerator} for name, enumerator in self._commands.items()],
            fields=[{"name": name, "enumerator": enumerator} for name, enumerator in self._fields.items()],
            effects=[{"name": name, "macro": macro} for name, macro in self._effects().items()] if effects else [],
            available=available.call({"command": "COMMAND", "parameters": "known"}) if available else "",
            macros=self._macros,
        )

    def _effects(self) -> dict[str, str]:
        start = f"{self._prefix}effect_".upper()
        return {macro.removeprefix(start).lower(): macro for macro in self._macros if macro.startswith(start)}

    def _type_functions(self) -> Iterator[dict[str, Any]]:
        for name, function in self._functions.items():
            match = _TYPE_FUNCTION.match(name)
            if (
                match
                and match["kind"] in ("valid", "name", "no_value", "has_value", "from_double")
                and match["stem"] in self._types
            ):
                yield {
                    "kind": match["kind"],
                    "name": match["stem"],
                    "call": function.call(ARGUMENTS),
                    "stored": Stored(
                        next(t for p, t in zip(function.parameters, function.types, strict=True) if p in _RAW).rstrip(
                            " *"
                        )
                    ),
                    "signed": self._types[match["stem"]].encoding is Encoding.SIGNED,
                }

    def _address_functions(self) -> Iterator[dict[str, Any]]:
        for name, function in self._functions.items():
            match = _ADDRESS_FUNCTION.match(name)
            if match and all(p.lstrip("*") in ("id", "node", "found") for p in function.parameters):
                yield {
                    "kind": match["kind"],
                    "name": f"{match['stem']}_{match['direction']}",
                    "call": function.call(ARGUMENTS),
                }

    def all(self) -> Iterator[Fact]:
        """All questions with their answers."""
        for number, refusal in enumerate(("ok", *(refusal.value for refusal in Refusal))):
            yield Fact("status", "-", {}, (str(number),), refusal)
        yield Fact("status", "-", {}, ("99",), "?")
        most = self._edition.bus.frame_format.max_data_bytes
        yield Fact("clear", "-", {}, (), "A5A5A5A5A5" + "00" * (3 + most))
        sizes = (0, 1, most - 1, most)
        for size, another, place in itertools.product(sizes, sizes, range(most + 1)):
            yield Fact(
                "same", "-", {}, (str(size), str(another), str(place)), str(int(size == another and place >= size))
            )
        yield from self._of_commands()
        for name in self._fields:
            yield Fact("field", f"[{name}]", {}, (), f"[{name}]")
        yield from self._of_macros()
        for entry in self._address_functions():
            yield from self._of_address(entry["kind"], entry["name"])
        for entry in self._type_functions():
            yield from self._of_type(entry["kind"], entry["name"])
        yield from self._of_zero()
        for name in self._functions:
            match = _TYPE_FUNCTION.match(name)
            if match and match["kind"] == "to_milli" and match["stem"] in self._types:
                yield from self._of_milli(self._types[match["stem"]])

    def assignments(self, *names: str) -> Iterator[Parameters]:
        """All combinations of the values of some parameters, unknown included."""
        if not names:
            yield {}
            return
        parameter = self._edition.parameter(names[0])
        values = [value.name for value in parameter.values] or ["1", "3.5", "900"]
        for rest in self.assignments(*names[1:]):
            yield rest
            yield from ({**rest, parameter.name: value} for value in values)

    def _zeros(self, type_: Type) -> Iterator[Parameters]:
        """Parameters under which the number that multiplies the scale is 0, which a C program can set."""
        for parameters in self.assignments(*type_.parameters):
            linear = type_.linear.at(Encoder(parameters).assignment)
            if linear is not None and linear.times is not None:
                yield {**parameters, **dict.fromkeys(type_.numbers, "1"), factors(linear.times).names[-1]: "0"}

    def _of_zero(self) -> Iterator[Fact]:
        """A scale of 0 is refused."""
        answer = Refusal.OUT_OF_RANGE.value
        for stem, type_ in self._types.items():
            for parameters in self._zeros(type_):
                if f"{stem}_from_double" in self._functions:
                    yield from (Fact("from_double", stem, parameters, (text,), answer) for text in ("1.0", "nan"))
                if f"{stem}_to_milli" in self._functions:
                    for direction in ("to", "from"):
                        yield Fact("milli", type_.name, parameters, (direction, "1"), answer)

    def _of_commands(self) -> Iterator[Fact]:
        effects = {name: 1 << place for place, name in enumerate(self._effects())}
        has_effects, available = "command_effects" in self._functions, "command_available" in self._functions
        only = dict.fromkeys(name for command in self._edition.commands for name in command.only) if available else {}
        known = {command.name: command for command in self._edition.commands}
        for name in self._commands:
            command = known.get(name)
            its = [effect.name for effect in command.effects] if command else []
            mask = sum(effects[effect] for effect in its) if has_effects else 0
            for parameters in self.assignments(*only):
                words = [f"[{name}]"]
                words += [f"{mask:X}", *(effect for effect in effects if effect in its)] if has_effects else []
                if available:
                    words.append(str(int(command.available(assignment(parameters)) if command else True)))
                yield Fact("command", f"[{name}]", parameters, (), " ".join(words))

    def _of_macros(self) -> Iterator[Fact]:
        """The constants whose values the model has."""
        values = self._constants()
        for name in self._macros:
            if name in values:
                yield Fact("macro", name, {}, (), str(values[name]))

    def _constants(self) -> dict[str, int]:
        names = self._names
        constants = self._enumerators()
        for place, name in enumerate(self._effects()):
            constants[names.upper("effect", name)] = 1 << place
        for address in self._edition.addresses:
            for direction in Direction:
                rule = address.rule(direction)
                if rule.nodes is not None:
                    constants[names.upper(address.name, "node_min")] = rule.nodes[0]
                    constants[names.upper(address.name, "node_max")] = rule.nodes[-1]
                else:
                    flag = 1 << 31 if rule.extended else 0
                    constants[names.upper(address.name, direction.value, "id")] = rule.base | flag
        if self._edition.bus.reply_within_ms is not None:
            constants[names.upper("reply_within_us")] = math.ceil(self._edition.bus.reply_within_ms * 1000)
        for command in self._edition.commands:
            if command.code is not None:
                constants[self._names.upper(command.name, "code")] = command.code
        for stem, type_ in self._types.items():
            constants |= {names.upper(stem, member.name): member.value for member in type_.enum}
            constants |= {names.upper(stem, flag.name): 1 << flag.value for flag in type_.flags}
            constants |= {names.upper(stem, n.name): n.raws[-1] for n in type_.no_values}
            constants |= {names.upper(stem, m.name): m.value for m in type_.names}
            constants |= {names.upper(stem, n.name, "first"): n.raws[0] for n in type_.no_values}
            linear = type_.linear.constant
            if linear is not None:
                constants[names.upper(stem, "scale_num")] = linear.scale.numerator
                constants[names.upper(stem, "scale_den")] = linear.scale.denominator
                constants[names.upper(stem, "offset_num")] = linear.offset.numerator
                constants[names.upper(stem, "offset_den")] = linear.offset.denominator
            constants |= self._ranges(stem, type_)
        return constants

    def _enumerators(self) -> dict[str, int]:
        """Enumerators: 0 for none and unknown, codes of commands, values of parameters."""
        enumerators = {self._commands[""]: 0} | ({self._fields[""]: 0} if self._fields else {})
        times = Counter(command.code for command in self._edition.commands)
        for command in self._edition.commands:
            if command.code and times[command.code] == 1 and command.code < 1 << 15:
                enumerators[self._commands[command.name]] = command.code
        for parameter in (p for p in self._edition.parameters if p.is_choice):
            enumerators[self._names.upper(parameter.name, "unknown")] = 0
            own = [value.number for value in parameter.values if value.number and 0 < value.number < 1 << 15]
            numbers = own if len(own) == len(parameter.values) else range(1, len(parameter.values) + 1)
            for value, number in zip(parameter.values, numbers, strict=True):
                enumerators[self._names.upper(parameter.name, value.name)] = int(number)
        return enumerators

    def _ranges(self, stem: str, type_: Type) -> dict[str, int]:
        """The ends of the range of a type, and of each of its cases."""
        ranges: dict[str, int] = {}
        if type_.encoding is not Encoding.FLOAT:
            spans = {"": type_.raw_range.constant, **{f"_{n}": span for n, span in type_.raw_range.cases.items()}}
            for case, span in spans.items():
                low, high = type_.raw_limits
                if span is not None and span.low.parameter is None:
                    low = max(low, math.ceil(span.low.constant))
                if span is not None and span.high.parameter is None:
                    high = min(high, math.floor(span.high.constant))
                ranges[self._names.upper(stem, f"raw_min{case}")] = low
                ranges[self._names.upper(stem, f"raw_max{case}")] = high
        return ranges

    def _of_address(self, kind: str, name: str) -> Iterator[Fact]:
        """Nodes and ids at both ends and beyond."""
        address, _, direction = name.rpartition("_")
        rule = self._edition.address(address).rule(Direction(direction))
        if rule.nodes is None:
            return
        flag = 1 << 31 if rule.extended else 0
        filled = 0
        for message in self._edition.of_rule(Direction(direction), rule):
            filled |= message.id_mask
        nodes = {rule.nodes[0] - 1, rule.nodes[0], rule.nodes[0] + 1, rule.nodes[-1], rule.nodes[-1] + 1, 0, 2**32 - 1}
        nodes |= {rule.nodes[-1] - 1, rule.nodes[len(rule.nodes) // 2]}
        for node in sorted(node for node in nodes if node >= 0):
            id_ = rule.base + node * rule.node_step | flag
            if kind == "id":
                answer = f"{id_:X}" if node in rule.nodes else Refusal.UNKNOWN_NODE.value
                yield Fact("id", name, {}, (f"{node:X}",), answer)
            for wrong in (0, 1, 2, rule.node_step // 2, 1 << 30, 1 << 31) if kind == "node" else ():
                asked = (id_ ^ wrong) & 0xFFFFFFFF
                rest = (asked & ~filled ^ flag) - rule.base
                asked_node = rest // rule.node_step
                fits = rest % rule.node_step == 0 and asked_node in rule.nodes
                yield Fact("node", name, {}, (f"{asked:X}",), f"{asked_node:X}" if fits else Refusal.UNKNOWN_ID.value)

    def _of_type(self, kind: str, stem: str) -> Iterator[Fact]:
        type_ = self._types[stem]
        if kind == "name":
            names = {member.value: member.name for member in type_.enum}
            low, high = _container(type_)
            near = {value + step for value in names for step in (-1, 0, 1)}
            for raw in sorted(raw for raw in near if low <= raw <= high):
                yield Fact("name", stem, {}, (str(raw),), names.get(raw, "NULL"))
            return
        if kind == "from_double":
            yield from self._of_double(stem, type_)
            return
        if kind in ("no_value", "has_value"):
            for raw in self._raws(Encoder({}), type_):
                named = next((n.name for n in type_.no_values if n.has(raw)), "NULL")
                yield Fact(kind, stem, {}, (str(raw),), named if kind == "no_value" else str(int(named == "NULL")))
            return
        for parameters in self.assignments(*type_.parameters, *type_.numbers):
            encoder = Encoder(parameters)
            for raw in self._raws(encoder, type_):
                valid = encoder.rejects_raw(self._field(type_), raw) is None
                yield Fact("valid", stem, parameters, (str(raw),), str(int(valid)))

    def _field(self, type_: Type) -> Field:
        return next(f for m in self._edition.all_messages() for f in m.layout.fields if f.type is type_)

    def _raws(self, encoder: Encoder, type_: Type) -> list[int]:
        """Raw integers at the ends of what is valid, of the bits and of the type in C, and beyond."""
        low, high = type_.raw_limits
        ends = {low, high, 0, *(member.value for member in type_.enum), *(1 << flag.value for flag in type_.flags)}
        if type_.flags:
            ends |= {1 << bit for bit in range(type_.width)}
        ends |= {end for named in type_.no_values for end in (named.raws[0], named.raws[-1])}
        span = type_.raw_range.at(encoder.assignment)
        if span is not None:
            numbers = {n: Fraction(v) for n, v in encoder.assignment.items() if n in type_.numbers}
            for bound in (span.low.at(numbers), span.high.at(numbers)):
                if bound is not None and type_.encoding is not Encoding.FLOAT:
                    ends |= {math.floor(bound), math.ceil(bound)}
                elif bound is not None:
                    bits = encoder.nearest_raw(self._field(type_), bound)
                    ends |= {bits} if isinstance(bits, int) else set()
        least, most = _container(type_)
        near = {end + step for end in (*ends, least, most) for step in (-1, 0, 1)}
        near |= {self._chance.randint(low, high) for _ in range(4)}
        return sorted(raw for raw in near if least <= raw <= most)

    def _floats(self, type_: Type, linear: Linear, encoder: Encoder, parameters: Parameters) -> Iterator[Single]:
        """The values of raw numbers in floating point, and the numbers of these values and of those next to them."""
        precision, field = SINGLE if type_.width == 32 else DOUBLE, self._field(type_)
        raws = (raw for raw in self._raws(encoder, type_) if is_finite(raw, precision))
        for raw, number in ((raw, number_of(raw, precision)) for raw in raws):
            exact = number * linear.scale + linear.offset
            error = SINGLE_ERROR * (abs(number * linear.scale) + abs(linear.offset)) + SMALLEST
            if abs(exact) >= 1 << 127:
                continue
            yield Single(type_.name, "to", raw, parameters, exact - error, exact + error)
            bits = bits_of(exact, SINGLE)
            for given in filter(lambda near: is_finite(near, SINGLE), {bits, max(bits - 1, 0), bits + 1}):
                back = (number_of(given, SINGLE) - linear.offset) / linear.scale
                error = SINGLE_ERROR * (abs(back) + abs(linear.offset / linear.scale)) + SMALLEST
                ends = back - error, back + error
                values = (at * linear.scale + linear.offset for at in (*ends, back))
                answers = [_answer(encoder, field, encoder.nearest_raw(field, value)) for value in values]
                is_valid = [answer.isdecimal() for answer in answers]
                reason = None if all(is_valid) else Refusal.OUT_OF_RANGE
                is_refused = not any(is_valid)
                yield Single(type_.name, "from", given, parameters, *ends, reason, is_refused, precision)

    def _of_double(self, stem: str, type_: Type) -> Iterator[Fact]:
        """The raw integers of doubles at, between and beyond the ends of a type."""
        field = self._field(type_)
        for parameters in self.assignments(*type_.parameters, *type_.numbers):
            encoder = Encoder(parameters)
            linear = linear_of(type_, encoder.assignment)
            values: list[float] = [0.0, -0.0, 1e300, -1e300, 2.0**63, -(2.0**63), 2.0**64, 5e-324]
            if linear is not None and type_.encoding is not Encoding.FLOAT:
                ends = {raw + step for raw in self._raws(encoder, type_) for step in (-1, 0, 1)}
                parts = (Fraction(0), Fraction(1, 2), Fraction(-1, 2))
                values += [float((end + part) * linear.scale + linear.offset) for end in ends for part in parts]
                values += [math.nextafter(value, way) for value in values[8:] for way in (-math.inf, math.inf)]
            for value in dict.fromkeys(values):
                nearest = encoder.nearest_raw(field, as_double(Fraction(value), type_, encoder.assignment))
                answer = _answer(encoder, field, nearest)
                yield Fact("from_double", stem, parameters, (repr(value),), answer)
            for text in ("nan", "inf", "-inf"):
                nearest = encoder.nearest_raw(field, text)
                assert isinstance(nearest, Rejection)
                yield Fact("from_double", stem, parameters, (text,), nearest.reason.value)

    def filter_macros(self) -> list[str]:
        """The constants of filters."""
        return [name for name in self._macros if name.endswith(("_FILTER_ID", "_FILTER_MASK"))]

    def singles(self) -> Iterator[Single]:
        """Conversions of single precision, at, between and beyond the ends of each type."""
        for stem, type_ in self._types.items():
            if f"{stem}_to_float" in self._functions:
                for parameters in self.assignments(*type_.parameters, *type_.numbers):
                    yield from self._singles(type_, parameters)
                zeros = (("to", 1), ("from", 1), ("from", 0x7FC00000))
                for parameters, (direction, bits) in itertools.product(self._zeros(type_), zeros):
                    nothing = Fraction(0)
                    yield Single(
                        type_.name, direction, bits, parameters, nothing, nothing, Refusal.OUT_OF_RANGE, is_refused=True
                    )

    def _singles(self, type_: Type, parameters: Parameters) -> Iterator[Single]:
        encoder, zero = Encoder(parameters), Fraction(0)
        field, linear = self._field(type_), linear_of(type_, encoder.assignment)
        if linear is None:
            nearest = encoder.nearest_raw(field, zero)
            assert isinstance(nearest, Rejection)
            for direction in ("to", "from"):
                yield Single(type_.name, direction, 0, parameters, zero, zero, nearest.reason, is_refused=True)
            return
        for bits in (0x7F800000, 0xFF800000, 0x7FC00000, 0x7F800001):
            yield Single(type_.name, "from", bits, parameters, zero, zero, Refusal.NOT_FINITE, is_refused=True)
        if type_.encoding is Encoding.FLOAT:
            yield from self._floats(type_, linear, encoder, parameters)
            return
        low, high = type_.raw_limits
        numbers = {0, 1, 1 << 31, 0x7F7FFFFF, 0xFF7FFFFF, 0x4F000000, 0xCF000000, 0x5F000000, 0xDF000000, 0x5F800000}
        for raw in self._raws(encoder, type_):
            exact = raw * linear.scale
            error = SINGLE_ERROR * (abs(exact) + abs(linear.offset))
            exact += linear.offset
            if low <= raw <= high:
                is_named = type_.no_value(raw) is not None
                reason = Refusal.NO_VALUE if is_named else None
                yield Single(type_.name, "to", raw, parameters, exact - error, exact + error, reason, is_named)
            for part in (-1, -Fraction(1, 2), 0, Fraction(1, 2), 1):
                bits = bits_of(exact + part * linear.scale, SINGLE)
                numbers |= {bits, max(bits - 1, 0), bits + 1}
        for bits in sorted(numbers):
            number = number_of(bits, SINGLE)
            back = (number - linear.offset) / linear.scale
            error = SINGLE_ERROR * (abs(number) + abs(linear.offset)) / abs(linear.scale)
            ends = (nearest_integer(back - error), nearest_integer(back + error))
            is_valid = [encoder.rejects_raw(field, end) is None and not type_.no_value(end) for end in ends]
            reason = None if all(is_valid) else Refusal.OUT_OF_RANGE
            limits = Fraction(ends[0]), Fraction(ends[1])
            is_refused = not any(is_valid)
            yield Single(type_.name, "from", bits, parameters, min(limits), max(limits), reason, is_refused=is_refused)

    def milli_beyond(self) -> Iterator[Fact]:
        """Thousandths of raw integers that the type in C contains and the type of the spec does not."""
        for stem, type_ in self._types.items():
            least, most = _container(type_)
            low, high = type_.raw_limits
            raws = {raw for raw in (least, low - 1, high + 1, most) if least <= raw <= most and not low <= raw <= high}
            if f"{stem}_to_milli" not in self._functions:
                continue
            for parameters, raw in itertools.product(self.assignments(*type_.parameters, *type_.numbers), sorted(raws)):
                linear = linear_of(type_, Encoder(parameters).assignment)
                if linear is not None:
                    answer = _rounded((raw * linear.scale + linear.offset) * 1000)
                    yield Fact("milli", type_.name, parameters, ("to", str(raw)), str(answer))

    def _of_milli(self, type_: Type) -> Iterator[Fact]:
        """Thousandths of the ends of a type, and the raw integers of thousandths around them."""
        field = self._field(type_)
        for parameters in self.assignments(*type_.parameters, *type_.numbers):
            encoder = Encoder(parameters)
            at_zero = encoder.nearest_raw(field, Fraction(0))
            low, high = type_.raw_limits
            for raw in (raw for raw in self._raws(encoder, type_) if low <= raw <= high):
                if type_.no_value(raw):
                    yield Fact("milli", type_.name, parameters, ("to", str(raw)), Refusal.NO_VALUE.value)
                    continue
                if isinstance(at_zero, Rejection):
                    for direction in ("to", "from"):
                        yield Fact("milli", type_.name, parameters, (direction, str(raw)), at_zero.reason.value)
                    continue
                linear = type_.linear.at(encoder.assignment)
                assert linear is not None
                numbers = {n: Fraction(v) for n, v in encoder.assignment.items() if n in type_.times}
                linear = linear.at(numbers)
                assert linear is not None
                exact = (raw * linear.scale + linear.offset) * 1000
                yield Fact("milli", type_.name, parameters, ("to", str(raw)), str(_rounded(exact)))
                half = abs(linear.scale) * 500
                near = {math.floor(exact + part) + step for part in (-half, 0, half) for step in (-1, 0, 1)}
                width = 1 + max(map(abs, _container(type_))).bit_length()
                near |= {math.floor(exact + way * linear.scale * 500 * (1 << width)) for way in (-2, -1, 1, 2)}
                for milli in sorted(near):
                    answer = _answer(encoder, field, encoder.nearest_raw(field, Fraction(milli, 1000)))
                    yield Fact("milli", type_.name, parameters, ("from", str(milli)), answer)


def _answer(encoder: Encoder, field: Field, nearest: int | Rejection) -> str:
    """What a conversion from a number returns, whose nearest raw integer is known: one without a value is out of range."""
    if isinstance(nearest, int) and field.type.no_value(nearest):
        return Refusal.OUT_OF_RANGE.value
    rejection = nearest if isinstance(nearest, Rejection) else encoder.rejects_raw(field, nearest)
    return rejection.reason.value if rejection else str(nearest)


def _rounded(number: Fraction) -> int:
    size = math.floor(abs(number) + Fraction(1, 2))
    return size if number >= 0 else -size


def _container(type_: Type) -> tuple[int, int]:
    """What the integer of C holds."""
    width = next(w for w in (8, 16, 32, 64) if type_.width <= w)
    if type_.encoding is Encoding.SIGNED:
        return -(1 << (width - 1)), (1 << (width - 1)) - 1
    return 0, (1 << width) - 1
