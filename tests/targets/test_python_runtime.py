"""The runtime of generated Python packages, tested as it is, with messages written by hand."""

from __future__ import annotations

import ast
import copy
import math
import pickle
import random
import sys
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from enum import IntEnum, IntFlag
from fractions import Fraction
from pathlib import Path
from struct import pack, unpack
from types import SimpleNamespace
from typing import Any, ClassVar

import can
import pytest
from canwright.model import refusal
from canwright.project.loader import specification
from canwright.targets.python.imports import NAMES, PUBLIC, Imports
from canwright.targets.python.module import SHARED
from canwright.targets.python.runtime import _codec, _dispatch
from canwright.targets.python.runtime._codec import (
    ArrayType,
    Bound,
    CodecError,
    Counter,
    EnumType,
    FieldAbsent,
    FlagsType,
    Float,
    Message,
    Number,
    OptionalFloat,
    Real,
    Refusal,
    Reply,
    Request,
    Scale,
    ToAll,
    ToNode,
    check_choice,
    check_number,
    checksum,
    constant,
    crc_of,
    merge,
    nearest,
    rounded,
    sum_of,
    to_odd,
    xor_of,
)
from canwright.targets.python.runtime._dispatch import (
    Answer,
    DataByte,
    Dispatcher,
    Node as DispatchNode,
    Route,
    Router,
    Select,
    data_length,
)
from canwright.targets.python.runtime.nodes import Node, Nodes
from canwright.targets.python.runtime.python_can import from_message, to_message
from canwright.targets.python.target import RUNTIME, PythonTarget

from ..spec_texts import ROOT


@dataclass(frozen=True)
class Parameters:
    size: int | None = None
    top: Real | None = None


UNKNOWN = Parameters()
LEVEL = Number(0, 0xFFFF, "%", scale=(1, 10, 0), limits=(Bound(0), Bound(1000)))


class Level(Message):
    """A field `level` in bytes 1 and 2."""

    __slots__ = ()

    CODE: ClassVar[int]
    NODES = (1, 4)
    DLC = 3
    DEFAULTS = UNKNOWN
    TYPES: ClassVar[Any] = {"level": LEVEL}

    def __init__(self, *, node: int, level: Real) -> None:
        self._node = self._known_node(node)
        self._parameters = UNKNOWN
        self._raws = (LEVEL.raw(level, UNKNOWN, "level"),)
        self._checked = True

    @classmethod
    def unpack(cls, node: int | None, can_id: int, data: bytes, parameters: Any) -> Any:
        self = cls.__new__(cls)
        self._node = node
        self._parameters = parameters
        self._raws = unpack("<xH", data)
        self._checked = False
        return self

    @property
    def level(self) -> float:
        return LEVEL.value(self._raws[0], self._parameters, "level")

    def encode_unchecked(self) -> bytes:
        return pack("<BH", self.CODE, self._raws[0])


class DimReply(Level, Reply):
    __slots__ = ()
    COMMAND, DIRECTION, ID, CODE = "dim", "reply", 0x200, 0x11


class DimRequest(Level, Request[DimReply]):
    __slots__ = ()
    COMMAND, DIRECTION, ID, CODE = "dim", "request", 0x100, 0x10


class EchoReply(Level, Reply):
    __slots__ = ()
    COMMAND, DIRECTION, ID, CODE = "echo", "reply", 0x200, 0x20


class EchoRequest(Level, Request[EchoReply]):
    __slots__ = ()
    COMMAND, DIRECTION, ID, CODE = "echo", "request", 0x100, 0x20


class SyncRequest(ToAll, Request[Message]):
    __slots__ = ()
    COMMAND, DIRECTION, ID, DLC, DATA = "sync", "request", 0x80, 1, b"\x01"


def code(can_id: int, data: bytes) -> int:
    return data[0]


def addressed(can_id: int, data: bytes) -> int:
    return data[1]


def by_code(length: int, cases: dict[int, DispatchNode]) -> Select:
    """Checks the length, then decides by the code."""
    return Select(data_length, {length: Select(code, cases, Refusal.UNKNOWN_CODE)}, Refusal.WRONG_LENGTH)


NODES = range(1, 5)
DISPATCHER: Dispatcher[Parameters, Message, Message] = Dispatcher(
    requests=(
        Route(0x100, 1, NODES, by_code(3, {0x10: DimRequest, 0x20: EchoRequest})),
        Route(0x80, 1, None, Select(data_length, {1: SyncRequest}, Refusal.WRONG_LENGTH)),
    ),
    replies=(
        Route(0x200, 1, NODES, by_code(3, {0x11: DimReply, 0x20: EchoReply})),
        Route(0x300, 1, NODES, Select(data_length, {3: EchoReply}, Refusal.WRONG_LENGTH)),
    ),
    answers={
        DimRequest: Answer(DimReply, ((code, (0x11,)),)),
        EchoRequest: Answer(EchoReply, ((code, (0x20,)),), echo=True),
    },
    unknown=UNKNOWN,
)


def rejected(refusal: Refusal, call: Callable[..., object], *arguments: object, **named: object) -> str:
    """The message of the CodecError that a call raises."""
    with pytest.raises(CodecError) as caught:
        call(*arguments, **named)
    assert caught.value.refusal is refusal
    return str(caught.value)


# The copies


def test_the_reasons_for_rejection_are_those_of_golden_frames() -> None:
    ours, model = ({r.name: r.value for r in reasons} for reasons in (Refusal, refusal.Refusal))
    assert list(ours.items()) == list(model.items())


def test_each_module_is_copied_behind_one_header_line(tmp_path: Path) -> None:
    spec = ROOT / "tests/specs/valve/v1.yaml"
    outputs = {o.path: o.text for o in PythonTarget().generate([specification(spec)], {})}
    assert {path.name for path in RUNTIME.glob("*.py")} == {"__init__.py", *SHARED}
    for name in SHARED:
        first, rest = outputs[f"valve/{name}"].split("\n", 1)
        assert (first, rest) == ("# Generated by canwright, do not edit.", (RUNTIME / name).read_text("utf-8"))


def test_the_runtime_depends_on_the_standard_library_only() -> None:
    third_party = {
        "python_can.py": {"can"},
        "client.py": {"can"},
        "client_asyncio.py": {"can"},
        "simulation.py": {"can"},
    }
    for name in SHARED:
        tree = ast.parse((RUNTIME / name).read_text("utf-8"))
        tree.body = [statement for statement in tree.body if not ast.unparse(statement).startswith("if TYPE_CHECKING:")]
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
        absolute = {a.name for node in imports if isinstance(node, ast.Import) for a in node.names}
        absolute |= {str(node.module) for node in imports if isinstance(node, ast.ImportFrom) and not node.level}
        relative = {f"{node.module}.py" for node in imports if isinstance(node, ast.ImportFrom) and node.level == 1}
        assert {module.split(".")[0] for module in absolute} - sys.stdlib_module_names == third_party.get(name, set())
        assert relative <= set(SHARED)
        assert all(node.level <= 1 for node in imports if isinstance(node, ast.ImportFrom))


def test_imports_contain_each_used_name_with_its_module() -> None:
    imports = Imports()
    for name in NAMES:
        assert imports.use(name) == name
    for module, names in imports.modules("runtime"):
        assert all(hasattr({"_codec": _codec, "_dispatch": _dispatch}[module], name) for name in names)
    assert dict(imports.modules("standard library"))["typing"] == [
        *("TYPE_CHECKING", "Any", "Literal", "NoReturn", "TypeAlias", "Union")
    ]
    assert list(Imports().modules("runtime")) == [("_codec", list(PUBLIC))]
    with pytest.raises(KeyError, match="Routes"):
        imports.use("Routes")


# Numbers


@pytest.mark.parametrize(
    ("value", "integer"),
    [
        (0.5, 1),
        (-0.5, -1),
        (1.5, 2),
        (2.5, 3),
        (0.49999999999999994, 0),
        (Fraction(7, 2), 4),
        (Decimal("2.5"), 3),
        (-7, -7),
        (2.0**60, 2**60),
    ],
)
def test_the_nearest_integer_ties_away_from_zero(value: Real, integer: int) -> None:
    numerator, denominator = value.as_integer_ratio()
    assert nearest(numerator, denominator) == nearest(-numerator, -denominator) == integer
    assert Number(-(2**62), 2**62).raw(value, UNKNOWN, "it") == integer


def test_a_number_converts_in_both_directions() -> None:
    offset = Number(-128, 127, scale=(-3, 2, Fraction(25, 4)))
    for raw in (-128, -1, 0, 1, 127):
        value = offset.value(raw, UNKNOWN, "it")
        assert value == float(Fraction(raw * -3, 2) + Fraction(25, 4))
        assert offset.raw(value, UNKNOWN, "it") == raw
    assert LEVEL.raw(99.95, UNKNOWN, "level") == 1000
    assert rejected(Refusal.OUT_OF_RANGE, LEVEL.raw, 100.1, UNKNOWN, "level") == (
        "level=100.1 % is out of range 0.0..100.0 % (raw 0..1000)"
    )
    assert rejected(Refusal.OUT_OF_RANGE, LEVEL.check, 1001, UNKNOWN, "level").startswith("level=raw 1001 is out of")
    assert "nan" in rejected(Refusal.NOT_FINITE, LEVEL.raw, math.nan, UNKNOWN, "level")
    with pytest.raises(TypeError, match="level='1' is no number"):
        LEVEL.raw("1", UNKNOWN, "level")


def test_a_float_that_can_have_no_value_has_a_range() -> None:
    whole = OptionalFloat(Float(32), {"lost": (0x7F800001, 0x7FFFFFFF)})
    assert whole.value_range(UNKNOWN) == (-math.inf, math.inf)
    percent = Float(32, limits=(Bound(0), Bound(100)))
    assert OptionalFloat(percent, {"lost": (0x7F800001, 0x7FFFFFFF)}).value_range(UNKNOWN) == (0.0, 100.0)


def test_a_value_that_looks_like_the_end_of_a_wide_range_is_rejected_with_its_raw_integer() -> None:
    """The floats of the last raw integers of 56 bits are those of raw integers beyond the range."""
    angle = Number(-(2**55), 2**55 - 1, "deg", scale=(1, 100, 0))
    for raw, sign in ((2**55 - 1, ""), (-(2**55), "-")):
        value = angle.value(raw, UNKNOWN, "it")
        assert rejected(Refusal.OUT_OF_RANGE, angle.raw, value, UNKNOWN, "it") == (
            f"it={sign}360287970189639.7 deg (raw {sign}36028797018963969) is out of range "
            "-360287970189639.7..360287970189639.7 deg (raw -36028797018963968..36028797018963967)"
        )
        assert angle.raw(Fraction(raw, 100), UNKNOWN, "it") == raw
    assert "(raw" not in rejected(Refusal.OUT_OF_RANGE, angle.raw, 1e300, UNKNOWN, "it").partition("is out of range")[0]


def test_a_float_counts_as_rounded_below_2_to_the_51_and_as_exact_from_there() -> None:
    """The offset is no float, so a quotient of floats is 1 more than the exact one."""
    offset = 2**60 + 1
    number = Number(0, 2**62, scale=(1, 1, offset))
    for raw, nearest_raw in ((2**50, 2**50), (2**51, 2**51 - 1), (2**52, 2**52 - 1)):
        assert number.raw(float(2**60 + raw), UNKNOWN, "it") == nearest_raw
        assert number.raw(2**60 + raw, UNKNOWN, "it") == raw - 1


@pytest.mark.parametrize(("numerator", "denominator", "offset"), [(3, 10, Fraction(1, 7)), (3, 11, Fraction(17, 2))])
def test_integers_of_many_bits_become_the_nearest_raw_integer(
    numerator: int, denominator: int, offset: Fraction
) -> None:
    random_values = random.Random(1)
    scale = (numerator, denominator, offset)
    for bits in (31, 33, 40, *range(48, 56)):
        number = Number(-(2**62), 2**62, scale=scale, limits=(Bound(-(2**bits)), Bound(10)))
        for _ in range(200):
            value = -random_values.randrange(2**bits * numerator // denominator - 10)
            exact = (value - offset) * denominator / numerator
            assert number.raw(value, UNKNOWN, "it") == nearest(exact.numerator, exact.denominator)


def test_numbers_beyond_the_range_of_floats() -> None:
    assert (rounded(10**400), rounded(-(10**400)), rounded(Fraction(1, 4))) == (math.inf, -math.inf, 0.25)
    said = rejected(Refusal.OUT_OF_RANGE, LEVEL.raw, 10**400, UNKNOWN, "it")
    assert said == f"it={10**400} % is out of range 0.0..100.0 % (raw 0..1000)"
    too_long_to_print = rejected(Refusal.OUT_OF_RANGE, LEVEL.raw, 10**5000, UNKNOWN, "it")
    assert too_long_to_print == "it=a very large int % is out of range 0.0..100.0 % (raw 0..1000)"
    large, small = Number(0, 9, scale=(10**400, 1, 0)), Number(0, 9, scale=(1, 10**400, 0))
    said = rejected(Refusal.OUT_OF_RANGE, large.value, 1, UNKNOWN, "it")
    assert said == "it is larger than any float under these parameters"
    assert small.raw(Fraction(3, 10**400), UNKNOWN, "it") == 3
    with pytest.raises(ValueError, match="top is larger than any float; leave it out"):
        check_number(10**400, "top", 1, None)


@pytest.mark.parametrize("top", [1, Fraction(1, 2), 0.25, Decimal("0.001")])
def test_a_scale_is_multiplied_by_any_number_above_0(top: Any) -> None:
    number = Number(0, 255, scale=(1, 1, 0), times="top")
    given = SimpleNamespace(top=top)
    assert number.value(200, given, "it") == float(200 * Fraction(str(top)))
    assert number.raw(200 * Fraction(str(top)), given, "it") == 200
    for refused in (0, -1, Fraction(-1, 2)):
        rejected(Refusal.OUT_OF_RANGE, number.value, 1, SimpleNamespace(top=refused), "it")


class Count:
    """An integer without `as_integer_ratio`, as other packages have."""

    def __index__(self) -> int:
        return 7

    def __float__(self) -> float:
        return 7.0


def test_numbers_of_other_packages() -> None:
    assert LEVEL.raw(Count(), UNKNOWN, "it") == 70  # type: ignore[arg-type]
    for given in (True, Count()):
        checked = LEVEL.check(given, UNKNOWN, "it")  # type: ignore[arg-type]
        assert (checked, type(checked)) == (int(given), int)
    with pytest.raises(TypeError, match=r"it=1\.5 is no integer"):
        LEVEL.check(1.5, UNKNOWN, "it")  # type: ignore[arg-type]


def test_scale_and_range_depend_on_parameters() -> None:
    number = Number(
        *(-100, 100),
        scale={1: (1, 2, 0), 2: None, 3: (1, 100, 0)},
        scale_by="size",
        times={3: "top"},
        limits={1: (Bound(-10), Bound(0, 2, "top"))},
        limits_by="size",
    )
    assert number.value(5, Parameters(size=1), "it") == 2.5
    assert number.value(5, Parameters(size=3, top=0.3), "it") == 0.015
    assert number.raw(0.015, Parameters(size=3, top=0.3), "it") == 5
    rejected(Refusal.NO_SCALE, number.value, 5, Parameters(size=2), "it")
    rejected(Refusal.MISSING_PARAMETER, number.value, 5, UNKNOWN, "it")
    rejected(Refusal.MISSING_PARAMETER, number.value, 5, Parameters(size=3), "it")
    rejected(Refusal.OUT_OF_RANGE, number.value, 5, Parameters(size=3, top=-1), "it")
    rejected(Refusal.NOT_FINITE, number.value, 5, Parameters(size=3, top=math.inf), "it")
    assert number.raw_range(Parameters(size=1)) == (-10, 100)
    assert number.raw_range(Parameters(size=1, top=Fraction(15, 4))) == (-10, 7)
    assert number.raw_range(Parameters(size=2)) == number.raw_range(UNKNOWN) == (-100, 100)
    assert number.value_range(Parameters(size=1)) == (-5, 50)
    assert Number(0, 10, scale=(-1, 2, 0), limits=(Bound(-5), Bound(20))).value_range(UNKNOWN) == (-5, 0)
    rejected(Refusal.MISSING_PARAMETER, number.value_range, UNKNOWN)
    for zero in (0, Decimal(0)):
        rejected(Refusal.OUT_OF_RANGE, number.value, 5, Parameters(size=3, top=zero), "it")


def test_values_with_a_table_of_scales_are_the_nearest_floats() -> None:
    """Whatever factor, offset and number of bits a scale has, and whatever multiplies it."""
    scales: dict[int, Scale] = {
        1: (1, 4, 0),
        2: (1, 4, 1),
        3: (3, 1, 0),
        4: (2**53 + 1, 1, 0),
        5: (1, 1, 1),
        6: (3, 8, Fraction(1, 2)),
    }
    for bits in (8, 53, 54, 55):
        number = Number(0, 2**bits - 1, scale=scales, scale_by="size")
        for size, (numerator, denominator, offset) in scales.items():
            for raw in (1, 3, 2**bits - 1, 2**bits - 3, 2**bits // 3):
                exact = Fraction(raw * numerator, denominator) + offset
                assert number.value(raw, Parameters(size=size), "it") == float(exact)
    number = Number(0, 255, scale=scales, scale_by="size", times={1: "top"})
    assert number.value(100, Parameters(size=1, top=3), "it") == 75
    assert number.value(100, Parameters(size=2, top=3), "it") == 26


def test_a_scale_and_a_range_that_depend_on_two_parameters() -> None:
    scales, limits = {1: (1, 10, 0), 2: (1, 2, 0)}, {1: (Bound(0), Bound(50)), 2: (Bound(0), Bound(9))}
    number = Number(0, 255, scale=scales, scale_by="size", limits=limits, limits_by="top")
    for size, top, value, raw in ((1, 1, 5, 50), (2, 1, 25, 50), (1, 2, 0.9, 9), (2, 2, 4.5, 9)):
        parameters = Parameters(size=size, top=top)
        assert number.raw(value, parameters, "it") == raw
        rejected(Refusal.OUT_OF_RANGE, number.raw, value * 2, parameters, "it")


@pytest.mark.parametrize(("width", "layout"), [(32, "<f"), (64, "<d")])
def test_a_float_is_its_bit_pattern(width: int, layout: str) -> None:
    number = Float(width, "V", scale=(1, 2, 1), limits=(Bound(-5), Bound(5)))
    bits = int.from_bytes(pack(layout, 3.0), "little")
    assert number.value(bits, UNKNOWN, "it") == 2.5
    assert number.raw(2.5, UNKNOWN, "it") == bits
    assert number.check(bits, UNKNOWN, "it") == bits
    for end in (-5, 5):
        assert number.value(number.raw(end, UNKNOWN, "it"), UNKNOWN, "it") == end
    too_large = rejected(Refusal.OUT_OF_RANGE, number.raw, 5.5, UNKNOWN, "it")
    assert too_large == "it=5.5 V is out of range -5.0..5.0"
    rejected(Refusal.OUT_OF_RANGE, number.check, 1 << width, UNKNOWN, "it")
    rejected(Refusal.NOT_FINITE, number.check, (1 << width) - 1, UNKNOWN, "it")
    assert number.check(0, UNKNOWN, "it") == 0
    rejected(Refusal.OUT_OF_RANGE, number.raw, 10**400, UNKNOWN, "it")
    assert number.raw_range(UNKNOWN) == (0, 2**width - 1)
    assert Float(width).value_range(UNKNOWN) == (-math.inf, math.inf)
    said = rejected(Refusal.OUT_OF_RANGE, Float(width, scale=(1, 10**10, 0)).raw, 1e305, UNKNOWN, "it")
    assert said == "it=1e+305 is too large for its float"
    assert Float(width, scale=(3, 2, 1)).raw(Fraction(5, 2), UNKNOWN, "it") == int.from_bytes(pack(layout, 1), "little")
    rejected(Refusal.NO_SCALE, Float(width, scale=None).value, 0, UNKNOWN, "it")


@pytest.mark.parametrize("limits", [(Bound(2), Bound(0, 1, "top")), (Bound(0, 1, "top"), Bound(2))])
def test_a_float_is_checked_against_the_end_that_is_known(limits: tuple[Bound, Bound]) -> None:
    number = Float(64, limits=limits)
    outside = 1.5 if limits[0].parameter == "" else 2.5
    for convert, given in ((number.raw, outside), (number.check, int.from_bytes(pack("<d", outside), "little"))):
        rejected(Refusal.OUT_OF_RANGE, convert, given, UNKNOWN, "it")
        rejected(Refusal.OUT_OF_RANGE, convert, given, Parameters(top=2), "it")
    assert number.raw(2, UNKNOWN, "it") == number.raw(2.0, Parameters(top=2), "it")


def test_a_fraction_becomes_the_nearest_float_of_either_size() -> None:
    """Many are so close to the middle between two 32-bit floats that rounding twice is wrong."""
    random_values = random.Random(1)
    double, single = Float(64), Float(32)
    values = [Fraction(1, 10), Fraction(-1, 10), Fraction(1, 3), Fraction(3), Fraction(0)]
    for _ in range(300):
        middle = Fraction(2 * random_values.randrange(2**23, 2**24) + 1, 2 ** random_values.randrange(60))
        values += [sign * middle + Fraction(tiny, 2**120) for sign in (1, -1) for tiny in (1, -1)]
    for value in values:
        assert double.raw(value, UNKNOWN, "it") == int.from_bytes(pack("<d", float(value)), "little")
        raw = single.raw(value, UNKNOWN, "it")
        neighbours = [Fraction(single.value(raw + step, UNKNOWN, "it")) for step in (0, 1, -1) if raw + step >= 0]
        assert min(neighbours, key=lambda neighbour: abs(neighbour - value)) == neighbours[0]
        odd = to_odd(value)
        assert Fraction(odd) == value or pack("<d", odd)[0] & 1
        assert abs(Fraction(odd) - value) < math.ulp(odd)


class Color(IntEnum):
    RED = 1
    BLUE = 4


class Faults(IntFlag):
    HOT = 1
    COLD = 4


def test_checks_of_enums_flags_arrays_and_constants() -> None:
    color, faults, levels = EnumType(Color), FlagsType(Faults, 0x5), ArrayType(LEVEL, 2)
    assert (color.unit, faults.unit) == ("", "")
    assert (color.raw(Color.BLUE, UNKNOWN, "color"), color.check(4, UNKNOWN, "color")) == (4, 4)
    text = rejected(Refusal.OUT_OF_RANGE, color.check, 2, UNKNOWN, "color")
    assert text == "color=2 is none of the values 1, 4"
    assert (color.value(4, UNKNOWN, "color"), color.value(2, UNKNOWN, "color")) == (Color.BLUE, 2)
    assert (color.raw_range(UNKNOWN), faults.raw_range(UNKNOWN), levels.raw_range(UNKNOWN)) == (
        (1, 4),
        (0, 5),
        (0, 1000),
    )
    assert faults.raw(Faults.COLD, UNKNOWN, "errors") == 4
    assert repr(faults.value(5, UNKNOWN, "errors")) == repr(faults.value(5, UNKNOWN, "errors")) == repr(Faults(5))
    rejected(Refusal.OUT_OF_RANGE, faults.check, 2, UNKNOWN, "errors")
    assert levels.raw((1, 2), UNKNOWN, "level") == (10, 20)
    assert levels.value((10, 20), UNKNOWN, "level") == (1, 2)
    assert (levels.unit, levels.value_range(UNKNOWN)) == ("%", (0, 100))
    for convert in (levels.raw, levels.check):
        rejected(Refusal.OUT_OF_RANGE, convert, (1,), UNKNOWN, "level")
        with pytest.raises(TypeError, match="level=5 is no array; it needs 2 elements"):
            convert(5, UNKNOWN, "level")  # type: ignore[arg-type]
    rejected(Refusal.OUT_OF_RANGE, levels.check, (1, 1001), UNKNOWN, "level")
    constant(5, 5, "group")
    assert rejected(Refusal.WRONG_CONSTANT, constant, 4, 5, "group") == "group is 0x4, always 0x5 in this frame"
    assert merge(0x0102, 0xA00000, 3) == bytes([0xA2, 0x01, 0x00])


@pytest.mark.parametrize(
    ("compute", "check_value"),
    [
        pytest.param(crc_of(8, 0x1D, 0xFF, 0xFF), 0x4B, id="CRC-8/SAE-J1850"),
        pytest.param(crc_of(8, 0x8C, 0, 0, reflected=True), 0xA1, id="CRC-8/MAXIM-DOW"),
        pytest.param(crc_of(8, 0x60, 0, 7, shift=5), 0x4, id="CRC-3/GSM"),
        pytest.param(crc_of(8, 0x14, 0x1F, 0x1F, reflected=True), 0x19, id="CRC-5/USB"),
        pytest.param(crc_of(15, 0x4599, 0, 0), 0x059E, id="CRC-15/CAN"),
        pytest.param(crc_of(16, 0x1021, 0xFFFF, 0), 0x29B1, id="CRC-16/IBM-3740"),
        pytest.param(crc_of(32, 0xEDB88320, 0xFFFFFFFF, 0xFFFFFFFF, reflected=True), 0xCBF43926, id="CRC-32"),
        pytest.param(sum_of(8, 0, 0), 477 & 0xFF, id="sum"),
        pytest.param(sum_of(8, 0xFF, 0xFF), -477 & 0xFF, id="sum_negated"),
        pytest.param(sum_of(16, 1, 0xFFFF), 478 ^ 0xFFFF, id="sum of 16 bits"),
        pytest.param(xor_of(0, 0), 0x31, id="xor"),
        pytest.param(xor_of(0xF0, 0xFF), 0x31 ^ 0x0F, id="xor with other bits"),
    ],
)
def test_check_values_of_checksums(compute: Callable[[bytes], int], check_value: int) -> None:
    """Those of the public catalogue of CRC algorithms; the sum of the bytes of 123456789 is 477."""
    assert compute(b"123456789") == check_value


def test_a_checksum_is_compared() -> None:
    checksum(5, 5, "crc")
    text = "crc is 0x4, but the checksum of this frame is 0x1F"
    assert rejected(Refusal.WRONG_CHECKSUM, checksum, 4, 0x1F, "crc") == text


def test_a_counter_wraps_and_counts_missing_frames() -> None:
    counter = Counter(1, 14)
    assert [counter.next(value) for value in (0, 1, 13, 14, 15)] == [1, 2, 14, 1, 1]
    steps = {(1, 2): 1, (14, 1): 1, (3, 3): 0, (13, 2): 3, (2, 1): 13, (0, 1): 0, (1, 0): 0, (15, 1): 0, (14, 15): 0}
    assert {pair: counter.steps(*pair) for pair in steps} == steps


def test_checks_of_parameters() -> None:
    check_choice(None, "size", 1, 2)
    check_choice(2, "size", 1, 2)
    check_number(2, "top", 1, None)
    with pytest.raises(ValueError, match="size=3 is none of 1, 2"):
        check_choice(3, "size", 1, 2)
    with pytest.raises(ValueError, match="top=0 has to be at least 1"):
        check_number(0, "top", 1, None)


# Messages


def test_a_message_holds_raw_integers_and_compares_by_value() -> None:
    request = DimRequest(node=2, level=12.34)
    assert (request.can_id, request.encode(), request.level) == (0x102, b"\x10\x7b\x00", 12.3)
    assert (request.raw(), repr(request)) == ({"level": 123}, "DimRequest(node=2, level=12.3)")
    again = DimRequest.from_raw(node=2, level=123)
    assert (again, again.parameters) == (request, UNKNOWN)
    assert request != DimRequest(node=3, level=12.3)
    assert len({request, DimRequest(node=2, level=12.3)}) == 1
    rejected(Refusal.UNKNOWN_NODE, DimRequest, node=5, level=1)
    rejected(Refusal.OUT_OF_RANGE, DimRequest.from_raw, node=2, level=1001)
    with pytest.raises(TypeError, match="from_raw takes level"):
        DimRequest.from_raw(node=2)
    with pytest.raises(AttributeError, match="'DimRequest' object has no attribute 'label'"):
        _ = request.label  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match="Message is only a base class; use the class of a request or a reply"):
        Message.from_raw()
    for call in (lambda: Message.unpack(1, 0x101, b"", UNKNOWN), object.__new__(Message).encode_unchecked):
        with pytest.raises(TypeError, match="Message is only a base class"):
            call()


class Member(IntEnum):
    FIRST = 1
    LAST = 4


def test_a_node_is_an_integer_of_any_kind() -> None:
    for node in (True, Member.FIRST, Member.LAST):
        request = DimRequest(node=node, level=1)
        assert (request.node, type(request.node)) == (int(node), int)
    with pytest.raises(TypeError, match=r"node=2\.0 is no integer"):
        DimRequest(node=2.0, level=1)  # type: ignore[arg-type]


class OnlyRequest(DimRequest):
    __slots__ = ()
    NODES = (3, 3)


def test_an_address_with_one_node() -> None:
    assert OnlyRequest(node=3, level=1).can_id == 0x103
    for node in (2, 4, None):
        said = rejected(Refusal.UNKNOWN_NODE, OnlyRequest, node=node, level=1)
        assert said == f"there is no node {node}; nodes are 3..3"


class StopRequest(ToNode, Request[Message]):
    __slots__ = ()
    COMMAND, DIRECTION, ID, DLC, DATA, NODES = "stop", "request", 0x100, 1, b"\x30", (1, 4)


def test_a_message_without_fields() -> None:
    for request, can_id, data in ((SyncRequest(), 0x80, b"\x01"), (StopRequest(node=2), 0x102, b"\x30")):
        assert (request.can_id, request.encode(), request.raw(), request.values()) == (can_id, data, {}, {})
        assert request == type(request).from_raw(node=request.node)
    assert repr(StopRequest(node=2)) == "StopRequest(node=2)"


def test_a_message_is_immutable_and_copied() -> None:
    request = DimRequest(node=2, level=12.3)
    for name in ("node", "parameters", "can_id", "level"):
        with pytest.raises(AttributeError, match=rf"DimRequest is immutable, so {name} cannot be changed; replace\(\)"):
            setattr(request, name, 1)
        with pytest.raises(AttributeError, match=rf"DimRequest is immutable, so {name} cannot be changed; replace\(\)"):
            delattr(request, name)
    for again in (copy.copy(request), copy.deepcopy(request), pickle.loads(pickle.dumps(request))):
        assert (type(again), again, again.parameters) == (DimRequest, request, UNKNOWN)
    assert request.replace(node=3, level=5) == DimRequest(node=3, level=5)
    assert request.replace(parameters=Parameters(size=1)).parameters == Parameters(size=1)
    assert request == DimRequest(node=2, level=12.3)
    rejected(Refusal.OUT_OF_RANGE, request.replace, level=101)
    rejected(Refusal.UNKNOWN_NODE, request.replace, node=5)
    with pytest.raises(TypeError, match="DimRequest has no label; it has level"):
        request.replace(label=1)


def test_what_is_out_of_range_is_decoded_and_written_back_but_not_encoded() -> None:
    data = b"\x10\xe9\x03"
    decoded = DISPATCHER.requests.decode(0x102, data)
    assert (decoded.raw(), decoded.values(), decoded.encode_unchecked()) == ({"level": 1001}, {"level": 100.1}, data)
    rejected(Refusal.OUT_OF_RANGE, decoded.encode)
    rejected(Refusal.OUT_OF_RANGE, decoded.check)
    rejected(Refusal.OUT_OF_RANGE, decoded.replace, node=3)
    assert decoded.replace(level=1).encode() == b"\x10\x0a\x00"
    rejected(Refusal.UNKNOWN_NODE, DimRequest.unpack(9, 0x109, b"\x10\x00\x00", UNKNOWN).encode)
    rejected(Refusal.UNKNOWN_NODE, DimRequest.from_raw, level=1)
    with pytest.raises(CodecError) as caught:
        decoded.encode()
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.refusal, again.field) == (str(caught.value), Refusal.OUT_OF_RANGE, "level")
    with pytest.raises(TypeError, match="SyncRequest has no node, its id is fixed"):
        SyncRequest.from_raw(node=1)


def test_optional_fields_are_required_or_absent() -> None:
    request = DimRequest(node=2, level=1)
    assert request._raws_of(level=1.5) == (15,)
    with pytest.raises(TypeError, match="DimRequest needs level"):
        request._raws_of(level=None)
    with pytest.raises(FieldAbsent, match="DimRequest has no power"):
        request._raws_of(level=1, power=1)


class Variants(DimRequest):
    """Level, and power or light at the same place."""

    __slots__ = ()
    DEPENDS = ("size",)
    TYPES: ClassVar[Any] = {"level": LEVEL, "power": LEVEL, "light": LEVEL}
    VARIANTS = (("level", "power"), ("level", "light"), ("level", None))
    VARIANT_BY = "size"
    VARIANT_OF: ClassVar[Any] = {1: 0, 2: 1, 3: 2}


def test_fields_of_different_variants_are_different() -> None:
    first, second = (Variants.from_raw(node=1, level=1, parameters=Parameters(size=1), power=7) for _ in range(2))
    third = Variants.from_raw(node=1, level=1, parameters=Parameters(size=2), light=7)
    assert (first.raw(), third.raw()) == ({"level": 1, "power": 7}, {"level": 1, "light": 7})
    assert (first == second, first == third, hash(first) == hash(second)) == (True, False, True)
    assert Variants.from_raw(node=1, level=1, parameters=Parameters(size=3)).fields() == ("level",)
    rejected(Refusal.MISSING_PARAMETER, Variants.from_raw, node=1, level=1)


# Dispatch


def test_a_frame_is_decoded_by_its_id_and_selector() -> None:
    assert DISPATCHER.requests.decode(0x103, b"\x10\x01\x00") == DimRequest(node=3, level=0.1)
    assert DISPATCHER.replies.decode(0x203, b"\x11\x01\x00", Parameters(size=1)).parameters == Parameters(size=1)
    assert type(DISPATCHER.requests.decode(0x80, b"\x01")) is SyncRequest
    rejected(Refusal.UNKNOWN_ID, DISPATCHER.requests.decode, 0x105, b"\x10\x01\x00")
    rejected(Refusal.UNKNOWN_ID, DISPATCHER.requests.decode, 0x103, b"\x10\x01\x00", extended=True)
    assert DISPATCHER.requests.decode(0x103, b"\x10\x01\x00").parameters == UNKNOWN
    rejected(Refusal.UNKNOWN_CODE, DISPATCHER.requests.decode, 0x103, b"\x12\x01\x00")
    rejected(Refusal.WRONG_LENGTH, DISPATCHER.requests.decode, 0x103, b"\x10\x01")
    assert DISPATCHER.node_of("reply", 0x204) == 4
    assert DISPATCHER.node_of("request", 0x80) is None
    assert DISPATCHER.ids_of("request", 1) == ((0x101, 0, False, False),)
    assert DISPATCHER.ids_of("request", 9) == ()


def test_data_is_bytes_like() -> None:
    wide = memoryview(array("H", [int.from_bytes(b"\x10\x01", sys.byteorder)]))
    short: Router[Parameters, Message] = Router(
        "request", [Route(0x100, 1, NODES, Select(data_length, {2: StopRequest}, Refusal.WRONG_LENGTH))], UNKNOWN
    )
    assert short.decode(0x102, wide) == StopRequest(node=2)
    for decode in (DISPATCHER.requests.decode, lambda *frame: DISPATCHER.decode_answer(DimRequest, *frame)):
        with pytest.raises(TypeError, match="a bytes-like object is required"):
            decode(0x80, [1])  # type: ignore[arg-type]
    for frames in ((0x101, [0x10, 1, 0], 0x201, b"\x11\x01\x00"), (0x101, b"\x10\x01\x00", 0x201, [0x11, 1, 0])):
        with pytest.raises(TypeError, match="a bytes-like object is required"):
            DISPATCHER.check_reply(*frames)


def test_an_id_of_another_kind_is_named() -> None:
    router: Router[Parameters, Message] = Router(
        "request",
        [
            Route(0x80, 1, None, SyncRequest),
            Route(0x100, 1, NODES, DimRequest, extended=True),
            Route(0x100, 1, NODES, StopRequest, remote=True),
        ],
        UNKNOWN,
    )
    assert type(router.decode(0x102, b"", remote=True)) is StopRequest
    for can_id, extended, remote, text in (
        (0x80, True, False, "no request has the 29-bit id 0x80; with extended=False there is one"),
        (0x80, True, True, "no request has the 29-bit remote id 0x80; with extended=False, remote=False there is one"),
        (0x102, False, False, "no request has the id 0x102; with extended=True there is one"),
        (0x105, False, True, "no request has the remote id 0x105"),
    ):
        assert rejected(Refusal.UNKNOWN_ID, router.find, can_id, extended, remote) == text


def test_ids_with_bits_that_messages_fill_in_come_before_later_ones() -> None:
    first = Route(0x100, 1, NODES, DimRequest, mask=0x400)
    for later in (Route(0x500, 1, NODES, DimRequest, mask=0x800), Route(0x501, 1, None, SyncRequest)):
        assert Router("request", [first, later], UNKNOWN).find(0x501, False, False) == (first, 1)


def test_a_code_that_decides_before_the_length() -> None:
    then = Select(DataByte(0), {0x10: DimRequest, 3: StopRequest}, Refusal.UNKNOWN_CODE)
    router: Router[Parameters, Message] = Router("request", [Route(0x100, 1, NODES, then)], UNKNOWN)
    assert router.decode(0x101, b"\x10\x0a\x00") == DimRequest(node=1, level=1)
    assert router.decode(0x101, b"\x03\x0a\x00") == StopRequest(node=1)


def test_an_answer_comes_from_the_node_of_the_request() -> None:
    answer = DISPATCHER.decode_answer(DimRequest, 0x201, b"\x11\x01\x00")
    assert type(answer) is DimReply
    rejected(Refusal.UNKNOWN_CODE, DISPATCHER.decode_answer, DimRequest, 0x201, b"\x20\x01\x00")
    for other_id in (0x101, 0x301):
        rejected(Refusal.UNKNOWN_ID, DISPATCHER.decode_answer, DimRequest, other_id, b"\x11\x01\x00")
    rejected(Refusal.NOT_ANSWER, DISPATCHER.decode_answer, SyncRequest, 0x201, b"\x11\x01\x00")
    DISPATCHER.check_reply(0x101, b"\x10\x01\x00", 0x201, b"\x11\x02\x00")
    DISPATCHER.check_reply(0x101, b"\x20\x01\x00", 0x201, b"\x20\x01\x00")
    for request, reply_id, reply in (
        (b"\x10\x01\x00", 0x202, b"\x11\x02\x00"),
        (b"\x10\x01\x00", 0x201, b"\x20\x02\x00"),
        (b"\x20\x01\x00", 0x201, b"\x20\x02\x00"),
    ):
        rejected(Refusal.NOT_ANSWER, DISPATCHER.check_reply, 0x101, request, reply_id, reply)
    rejected(Refusal.NOT_ANSWER, DISPATCHER.check_reply, 0x80, b"\x01", 0x201, b"\x11\x02\x00")
    rejected(Refusal.UNKNOWN_CODE, DISPATCHER.check_reply, 0x101, b"\x12\x01\x00", 0x201, b"\x11\x02\x00")


@pytest.mark.parametrize(
    ("answer", "source", "accepted"),
    [
        (Answer(DimReply, (), (2, 3)), 0x203, True),
        (Answer(DimReply, (), (2, 3)), 0x201, False),
        (Answer(DimReply, (), request_node=(addressed, 0xFF)), 0x202, True),
        (Answer(DimReply, (), request_node=(addressed, 0xFF)), 0x201, False),
        (Answer(DimReply, (), reply_node=(addressed, 0xFF)), 0x201, True),
        (Answer(DimReply, (), (2,), reply_node=(addressed, 0xFF)), 0x202, False),
        (Answer(DimReply, (), (2,), reply_node=(addressed, 0xFC)), 0x202, True),
    ],
)
def test_the_node_of_an_answer_may_be_listed_or_in_a_field(answer: Answer, source: int, accepted: bool) -> None:
    route = DISPATCHER.requests.routes[0]
    dispatcher: Dispatcher[Parameters, Message, Message] = Dispatcher(
        requests=[route], replies=DISPATCHER.replies.routes, answers={DimRequest: answer}, unknown=UNKNOWN
    )
    frames = (0x101, b"\x10\x02\x00", source, b"\x11\x01\x00")
    if accepted:
        dispatcher.check_reply(*frames)
    else:
        assert "went to node" in rejected(Refusal.NOT_ANSWER, dispatcher.check_reply, *frames)


def test_the_answer_to_any_request_of_a_class_comes_from_a_listed_node() -> None:
    dispatcher: Dispatcher[Parameters, Message, Message] = Dispatcher(
        requests=DISPATCHER.requests.routes,
        replies=DISPATCHER.replies.routes,
        answers={DimRequest: Answer(DimReply, (), (2, 3))},
        unknown=UNKNOWN,
    )
    assert dispatcher.decode_answer(DimRequest, 0x203, b"\x11\x01\x00").node == 3
    said = rejected(Refusal.NOT_ANSWER, dispatcher.decode_answer, DimRequest, 0x201, b"\x11\x01\x00")
    assert said == "DimRequest went to node 2 or 3, this came from node 1"


def test_messages_of_one_code_differ_by_length_further_selectors_or_bits_of_the_id() -> None:
    class Short(DimRequest):
        DLC = 2

    by_length = Select(data_length, {2: Short, 3: DimRequest}, Refusal.WRONG_LENGTH)
    short_or_long = Route(0x100, 1, NODES, Select(code, {0x10: by_length}, Refusal.UNKNOWN_CODE))
    assert short_or_long.message(0x101, bytes([0x10, 0])) is Short
    assert short_or_long.message(0x101, bytes([0x10, 0, 0])) is DimRequest
    assert (
        rejected(Refusal.WRONG_LENGTH, short_or_long.message, 0x101, bytes([0x10]))
        == "0x101 has 1 data bytes, not 2 or 3"
    )
    by_more = Route(0x100, 1, NODES, by_code(3, {0x10: Select(addressed, {7: DimRequest}, EchoRequest)}))
    assert by_more.message(0x101, bytes([0x10, 7, 0])) is DimRequest
    assert by_more.message(0x101, bytes([0x10, 8, 0])) is EchoRequest
    assert (
        rejected(Refusal.UNKNOWN_CODE, by_more.message, 0x101, bytes([0x1F, 8, 0])) == "0x101 has the unknown code 0x1F"
    )
    unused = Select(lambda can_id, data: can_id & 0x400, {0: DimRequest}, Refusal.UNKNOWN_ID)
    by_bits = Route(0x100, 1, NODES, unused, mask=0x400)
    assert Router("request", (by_bits,), UNKNOWN).find(0x501, False, False) == (by_bits, 1)
    assert by_bits.message(0x101, bytes(3)) is DimRequest
    assert "the bits 0x400," in rejected(Refusal.UNKNOWN_ID, by_bits.message, 0x501, bytes(3))


def test_a_key_beyond_short_data_is_0() -> None:
    second = Select(DataByte(1), {0: SyncRequest, 7: DimRequest}, Refusal.UNKNOWN_CODE)
    either = Select(data_length, {1: second, 3: second}, Refusal.WRONG_LENGTH)
    router: Router[Parameters, Message] = Router("request", [Route(0x100, 1, NODES, either)], UNKNOWN)
    assert type(router.decode(0x101, b"\x01")) is SyncRequest
    assert type(router.decode(0x101, b"\x10\x07\x00")) is DimRequest
    rejected(Refusal.UNKNOWN_CODE, router.decode, 0x101, b"\x10\x08\x00")


# Nodes and python-can


def speaking(name: str) -> Any:
    """An edition with the messages above."""
    return SimpleNamespace(
        EDITION=name,
        UNKNOWN=UNKNOWN,
        __name__=__name__,
        decode_request=DISPATCHER.requests.decode,
        decode_reply=DISPATCHER.replies.decode,
        node_bits_of=DISPATCHER.node_bits_of,
        has_node_in_data=DISPATCHER.has_node_in_data,
        ids_of=DISPATCHER.ids_of,
    )


def test_a_bus_finds_the_node_of_a_frame() -> None:
    edition, newer_edition = speaking("v1"), speaking("v2")
    first = Node(edition, 1, Parameters(size=3))
    bus = Nodes([first, Node(edition, 2)])
    assert first.make(DimRequest, level=1) == DimRequest(node=1, level=1)
    assert [bus.nodes_of("reply", can_id) for can_id in (0x201, 0x203, 0x300)] == [(first,), (), ()]
    assert bus.decode_reply(0x201, b"\x11\x01\x00").parameters == Parameters(size=3)
    assert bus.decode_reply(0x202, b"\x11\x01\x00").parameters == UNKNOWN
    rejected(Refusal.UNKNOWN_ID, bus.decode_reply, 0x203, b"\x11\x01\x00")
    assert type(bus.decode_request(0x80, b"\x01")) is type(first.make(SyncRequest)) is SyncRequest
    assert first.decode_reply(0x201, b"\x11\x01\x00").parameters == Parameters(size=3)
    assert first.decode_request(0x101, b"\x10\x01\x00") == DimRequest(node=1, level=0.1)
    with pytest.raises(ValueError, match="both reply with the id 0x201"):
        Nodes([first, Node(edition, 1)])
    mixed = Nodes([first, Node(newer_edition, 5)])
    said = rejected(Refusal.UNKNOWN_NODE, mixed.decode_request, 0x80, b"\x01")
    assert said == "0x80 is a request of Node(v1, 1) and of Node(v2, 5); decode it with one of these nodes"
    edition.ids_of = lambda direction, node, parameters: ((0x200 + node, 0x0F, False, False),)
    with pytest.raises(ValueError, match="both reply with the id 0x202"):
        Nodes([first, Node(edition, 2)])
    edition.ids_of = lambda direction, node, parameters: (
        (0x200, 0x0F, False, False) if node == 1 else (0x205, 0, False, False),
    )
    with pytest.raises(ValueError, match="both reply with the id 0x205"):
        Nodes([first, Node(edition, 2)])


def test_messages_of_python_can() -> None:
    request = DimRequest(node=2, level=12.3)
    frame = to_message(request)
    assert (frame.arbitration_id, bytes(frame.data), frame.is_extended_id) == (0x102, b"\x10\x7b\x00", False)
    assert from_message(frame, DISPATCHER.requests.decode) == request
    assert from_message(frame, DISPATCHER.requests.decode, Parameters(size=1)).parameters == Parameters(size=1)
    for kind in ("is_error_frame", "is_fd", "is_extended_id"):
        fields: dict[str, Any] = {
            "arbitration_id": 0x102,
            "data": request.encode(),
            "is_extended_id": False,
            kind: True,
        }
        message = can.Message(**fields)
        rejected(Refusal.UNKNOWN_ID, from_message, message, DISPATCHER.requests.decode)
