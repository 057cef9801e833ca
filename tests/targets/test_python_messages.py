"""Every class of every spec in Python: what it encodes, refuses and writes back, and how its code is laid out."""

from __future__ import annotations

import copy
import math
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from canwright.conformance.python import PythonAdapter, load
from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Direction, Message
from canwright.model.types import Assignment, Parameter, Type
from canwright.project.loader import specification
from canwright.semantics.decoder import Decoded, Decoder, Rejection
from canwright.semantics.encoder import Encoder, Encoders
from canwright.semantics.frame import CanFrame
from canwright.targets.python.text import attribute, class_name

from ..semantics.random_frames import random_frames
from ..spec_texts import MINIMAL, SPECS, called
from .test_python import write

FRAMES = 4000


class Package:
    """The generated package of a spec, and sets of parameters that use all values of each choice."""

    def __init__(self, spec: Path, folder: Path) -> None:
        self.edition: Edition = specification(spec).edition
        self.module: ModuleType = load(write(folder, spec), self.edition)
        adapter = PythonAdapter(self.edition, self.module)
        choices = {p.name: _values(p) for p in self.edition.parameters}
        count = max(map(len, choices.values()), default=1)
        assignments = [{name: values[i % len(values)] for name, values in choices.items()} for i in range(count)]
        self.assignments = [(assignment, adapter.parameters(assignment)) for assignment in assignments]

    def cls(self, message: Message) -> Any:
        return getattr(self.module, class_name(message.name))


def _values(parameter: Parameter) -> list[str]:
    if parameter.whole and parameter.minimum is not None and parameter.maximum is not None:
        return [str(n) for n in (parameter.minimum, (parameter.minimum + parameter.maximum) // 2, parameter.maximum)]
    numbers = (parameter.minimum, parameter.maximum, Fraction(5, 2))
    return [v.name for v in parameter.values] or [str(float(n)) for n in numbers if n is not None and n > 0]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], Package]:
    made: dict[Path, Package] = {}

    def of(spec: Path) -> Package:
        if spec not in made:
            made[spec] = Package(spec, tmp_path_factory.mktemp("python"))
        return made[spec]

    return of


def _attributes(raws: Mapping[str, int | list[int]]) -> dict[str, int | tuple[int, ...]]:
    return {attribute(name): tuple(raw) if isinstance(raw, list) else raw for name, raw in raws.items()}


def _outcome(
    module: ModuleType, make: Callable[..., Any], /, *arguments: object, **named: object
) -> tuple[int, bytes] | tuple[str, str | None]:
    """Id and data of the message that a call makes and that is encoded, or the reason and the field of its rejection."""
    try:
        message = make(*arguments, **named)
        return message.can_id, message.encode()
    except module.CodecError as error:
        return error.refusal.value, error.field


def _expected(encoded: CanFrame | Rejection) -> tuple[int, bytes] | tuple[str, str | None]:
    if isinstance(encoded, Rejection):
        return encoded.reason.value, attribute(encoded.field) if encoded.field else None
    return encoded.id, encoded.data


def _decoded(package: Package) -> Iterator[tuple[Decoded, Any, Encoder]]:
    """Random frames as the reference decoder and the package decode them, with the encoder for their parameters."""
    decoder, encoders = Decoder(package.edition), Encoders()
    for i, frame in enumerate(random_frames(package.edition, FRAMES)):
        assignment, parameters = package.assignments[i // 7 % len(package.assignments)]
        for direction in Direction:
            reference = decoder.decode(direction, frame, assignment)
            if isinstance(reference, Decoded) and _is_available(reference.message, assignment):
                decode = getattr(package.module, f"decode_{direction.value}")
                decoded = decode(frame.id, frame.data, parameters, extended=frame.extended, remote=frame.remote)
                yield reference, decoded, encoders.for_parameters(assignment)


def _is_available(message: Message, assignment: Assignment) -> bool:
    """Whether a node with these parameters has the command, which a class does not ask: `Node.make` does."""
    return all(assignment.get(name, values[0]) in values for name, values in message.only.items())


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_a_decoded_frame_is_encoded_or_refused_as_its_raw_integers_are(
    spec: Path, package: Callable[[Path], Package]
) -> None:
    ours = package(spec)
    outcomes = set()
    for reference, decoded, encoder in _decoded(ours):
        assert (type(decoded), decoded.raw()) == (ours.cls(reference.message), _attributes(reference.raws))
        expected = _expected(encoder.encode_raws(reference.message, reference.node, reference.raws, reference.code))
        node = {} if reference.node is None else {"node": reference.node}
        given = {"parameters": decoded.parameters, "frame_code": reference.code, **node, **decoded.raw()}
        assert _outcome(ours.module, copy.copy, decoded) == expected
        assert _outcome(ours.module, type(decoded).from_raw, **given) == expected
        assert _outcome(ours.module, decoded.replace) == expected
        outcomes.add(type(expected[0]))
    assert int in outcomes


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_a_decoded_message_names_its_fields_out_of_range(spec: Path, package: Callable[[Path], Package]) -> None:
    ours = package(spec)
    for reference, decoded, encoder in _decoded(ours):
        fields = encoder.fields(reference.message) or {}
        invalid = {
            attribute(name) for name, field in fields.items() if encoder.rejects_raw(field, reference.raws[name])
        }
        outside = decoded.out_of_range()
        assert outside.keys() == invalid
        assert all(reason.startswith(name) for name, reason in outside.items())
        assert ("out_of_range=" in repr(decoded)) is bool(invalid)


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_a_decoded_frame_is_written_back_and_copied(spec: Path, package: Callable[[Path], Package]) -> None:
    ours = package(spec)
    for reference, decoded, _ in _decoded(ours):
        data = decoded.encode_unchecked()
        again = decoded.unpack(reference.node, decoded.can_id, data, decoded.parameters)
        assert (again, again.encode_unchecked(), again.can_id) == (decoded, data, decoded.can_id)
        assert decoded.values().keys() == decoded.raw().keys() == set(decoded.fields())
        assert copy.copy(decoded) == copy.deepcopy(decoded) == decoded


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_no_class_needs_parameters_for_raw_integers(spec: Path, package: Callable[[Path], Package]) -> None:
    ours, encoder = package(spec), Encoder({})
    for message in ours.edition.all_messages():
        cls = ours.cls(message)
        node = message.id.nodes[0] if message.id.nodes is not None else None
        given = {} if node is None else {"node": node}
        if encoder.fields(message) is None:
            with pytest.raises(ours.module.CodecError, match="is not given; pass Parameters") as caught:
                cls.from_raw(**given)
            assert caught.value.refusal is ours.module.Refusal.MISSING_PARAMETER
            continue
        raws = {name: _valid(field) for name, field in (encoder.fields(message) or {}).items()}
        expected = _expected(encoder.encode_raws(message, node, raws))
        if message.parameters:  # in its id or in its constants
            assert expected[0] == "missing_parameter"
            assert _outcome(ours.module, cls.from_raw, **given, **_attributes(raws)) == expected
            continue
        made = cls.from_raw(**given, **_attributes(raws))
        assert (made.can_id, made.encode()) == expected
        for name in (*cls.TYPES, *(f"{name}_raw" for name in cls.TYPES), "node", "parameters", "can_id"):
            with pytest.raises(AttributeError, match=rf"{cls.__name__} is immutable.*replace\(\)"):
                setattr(made, name, 1)
            with pytest.raises(AttributeError, match=rf"{cls.__name__} is immutable.*replace\(\)"):
                delattr(made, name)
        assert cls.__match_args__ == tuple(cls.TYPES) if cls.TYPES else made.fields() == ()


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_the_node_is_checked_before_the_fields(spec: Path, package: Callable[[Path], Package]) -> None:
    ours = package(spec)
    assignment, parameters = ours.assignments[0]
    encoder = Encoder(assignment)
    compared = 0
    for message in ours.edition.all_messages():
        fields = encoder.fields(message)
        if message.id.nodes is None or not fields or not _is_available(message, assignment):
            continue
        node = message.id.nodes[-1] + 1
        valid = {name: _valid(field) for name, field in fields.items()}
        beyond = {name: _invalid(field) for name, field in fields.items()}
        made = ours.cls(message).from_raw(node=message.id.nodes[0], parameters=parameters, **_attributes(valid))
        for attribute_, value in (("_node", node), ("_raws", tuple(beyond.values())), ("_checked", False)):
            object.__setattr__(made, attribute_, value)
        expected = encoder.encode_raws(message, node, beyond)
        assert isinstance(expected, Rejection)
        assert (
            _outcome(ours.module, copy.copy, made)
            == (expected.reason.value, expected.field)
            == ("unknown_node", "node")
        )
        number = next((name for name, field in fields.items() if field.type.is_number), None)
        if number is not None:
            given = [math.nan] * len(fields[number].elements) if fields[number].is_array else math.nan
            with pytest.raises(ours.module.CodecError) as caught:
                made.replace(node=node, **{attribute(number): given})
            assert caught.value.refusal is ours.module.Refusal.UNKNOWN_NODE
        compared += 1
    assert compared


def _invalid(field: Field) -> int | list[int]:
    """Beyond every raw integer of a field."""
    raw = 1 << field.type.width
    return [raw] * len(field.elements) if field.is_array else raw


def _valid(field: Field) -> int | list[int]:
    raw = _smallest(field.type)
    return [raw] * len(field.elements) if field.is_array else raw


def _smallest(type_: Type) -> int:
    """The valid raw integer that is nearest to 0."""
    if type_.enum:
        return type_.enum[0].value
    span = type_.raw_range.at({})
    low = span.low.at({}) if span else None
    return max(0, int(low)) if low is not None and type_.encoding.value != "float" else 0


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_types_have_unit_and_range(spec: Path, package: Callable[[Path], Package]) -> None:
    ours = package(spec)
    for assignment, parameters in ours.assignments:
        encoder = Encoder(assignment)
        for message in ours.edition.all_messages():
            for name, field in (encoder.fields(message) or {}).items():
                type_ = ours.cls(message).TYPES[attribute(name)]
                assert type_.unit == (field.type.unit.name if field.type.unit else "")
                low, high = type_.raw_range(parameters)
                if field.type.is_number and field.type.encoding.value != "float":
                    outside = (low - 1, high + 1) if not field.is_array else ()
                    assert all(encoder.rejects_raw(field, raw) or field.type.no_value(raw) for raw in outside)
                    assert not any(map(field.type.no_value, (low, high)))
                    assert not any(encoder.rejects_raw(field, raw) for raw in (low, high) if not field.is_array)


LONG = "a" * 36
LONG_NAMES = f"""\
canwright: 1
family: lamp
edition: v1
title: "says \\"no\\" to 'quotes'"
addresses: {{lamp: {{id: 0x100 + node, nodes: 1..4}}}}
selector: {{at: 0, raw: u8}}
parameters: {{{LONG}: {{values: [{", ".join(f"v{i}{'b' * 24}" for i in range(9))}]}}}}
effects: {{{", ".join(f"{LONG}{i}: {{level: note}}" for i in range(4))}}}
types:
  {LONG}_b: {{raw: i12, scale: {{by: {LONG}, {", ".join(f"v{i}{'b' * 24}: 1/{i + 3}" for i in range(9))}}}}}
  {LONG}_c: {{raw: u4, enum: {{{LONG[:30]}: 3}}}}
  {LONG}_d: {{raw: u4, flags: {{{LONG[:30]}: 3}}}}
commands:
  {LONG[:40]}_dim:
    code: 0x10
    effects: [{", ".join(f"{LONG}{i}" for i in range(4))}]
    request:
      {LONG}_e: {{at: 1.4, type: {LONG}_b, array: 1..2}}
      {LONG}_f: {{at: 4.4, type: {LONG}_c, array: 1..5, only: {{{LONG}: [v0{"b" * 24}, v1{"b" * 24}]}}}}
      {LONG}_g: {{at: 4.4, type: {LONG}_d, only: {{{LONG}: [v2{"b" * 24}]}}}}
    reply: echo
"""


def test_generated_code_is_formatted(tmp_path: Path) -> None:
    for spec in SPECS:
        write(tmp_path / called(spec), spec)
    spec = tmp_path / "long.yaml"
    spec.write_text(LONG_NAMES, "utf-8")
    write(tmp_path / "long", spec)
    files = [str(file) for file in tmp_path.rglob("*.py")]
    command = (sys.executable, "-m", "ruff", "format", "--isolated", "--line-length", "120", "--diff", *files)
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout[:4000] + result.stderr


NAMED = ("id", "type", "max", "match", "range", "data", "found", "variant", "cls", "round", "list", "floor", "raws")
RENAMED = ("class", "encode", "values", "check", "raw", "int", "property", "tuple")


def test_only_names_that_cannot_be_attributes_are_changed(tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    for names in (NAMED, RENAMED):
        for half in (names[:7], names[7:]):
            fields = ", ".join(f"{name}: {{at: {i + 1}, raw: u8}}" for i, name in enumerate(half))
            spec.write_text(MINIMAL.replace("{level: {at: 2, type: level}}", f"{{{fields}}}"), "utf-8")
            lamp = load(write(tmp_path / half[0], spec), specification(spec).edition)
            keywords = [name if names is NAMED else f"{name}_" for name in half]
            values = dict(zip(keywords, range(1, 8), strict=False))
            request = lamp.DimRequest(node=1, **values)
            assert request.encode() == bytes([0x10, *values.values()]).ljust(8, b"\0")
            read = lamp.decode_request(0x101, request.encode())
            assert (read, read.values(), read.raw()) == (request, values, values)
            assert [getattr(read, name) for name in keywords] == list(values.values())
            mypy = (sys.executable, "-m", "mypy", "--strict", "--warn-unreachable", "lamp/v1.py")
            done = subprocess.run(mypy, cwd=tmp_path / half[0], capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout


def test_the_elements_of_an_array_have_numbers_or_nodes(package: Callable[[Path], Package], tmp_path: Path) -> None:
    spec = tmp_path / "v1.yaml"
    text = MINIMAL.replace("level: {at: 2, type: level}", "level: {at: 2, type: level, array: 1..3}")
    spec.write_text(text, "utf-8")
    lamp = load(write(tmp_path, spec), specification(spec).edition)
    assert "Elements: [0] is number 1, [1] is number 2, [2] is number 3." in lamp.DimRequest.level.__doc__
    broadcasts = 0
    for ours in map(package, SPECS):
        for command in ours.edition.commands:
            if command.request is not None and command.request.layout.fields and command.from_each:
                cls, broadcasts = ours.cls(command.request), broadcasts + 1
                docs = " ".join(f"{getattr(cls, name).__doc__}".replace("\n", " ") for name in cls.TYPES)
                assert all(f"] is node {node}" in " ".join(docs.split()) for node in command.from_each)
    assert broadcasts
