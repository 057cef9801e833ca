from __future__ import annotations

import copy
import dataclasses
import pickle
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import get_args

import pytest
from canwright.diagnostics.diagnostic import SpecError
from canwright.language.concept import keys
from canwright.language.messages import FieldSpec
from canwright.model.edition import Edition
from canwright.model.layout import ROLE_KEYS, Role, Segment
from canwright.model.message import Direction, EchoReply, OtherReply, OwnReply, SharedReply
from canwright.model.types import Bound, ByParameter, Linear, Range
from canwright.project.loader import specification
from canwright.semantics.decoder import linear_of

from ..spec_texts import MINIMAL, ROOT, edition, findings, marked, places

MIXER = (ROOT / "tests/specs/mixer/v2-2024-02.yaml").read_text("utf-8")


@pytest.fixture(scope="module")
def v2_35() -> Edition:
    return specification(ROOT / "spec/mwd_motor/v2.35.yaml").edition


def test_the_edition_has_every_command_of_the_manual(v2_35: Edition) -> None:
    codes = "80 88 81 A0 A1 A2 A3 A4 A5 A6 A7 A8 30 31 32 33 34 90 91 19 92 94 95 9A 9B 9C 9D"
    assert [c.code for c in v2_35.commands if c.code is not None] == [int(code, 16) for code in codes.split()]
    assert [c.name for c in v2_35.commands if c.code is None] == ["broadcast_torque"]
    assert [c.manual for c in v2_35.commands] == [*(f"2.{n}" for n in range(1, 28)), "3.1"]


def test_the_motion_feedback_is_one_layout_that_depends_on_the_series(v2_35: Edition) -> None:
    layouts = {c.name: c.reply.layout for c in v2_35.commands if c.reply}
    shared = [name for name, layout in layouts.items() if layout.name == "motion_feedback"]
    assert len(shared) == 11
    assert len({id(layouts[name]) for name in shared}) == 1
    assert [(v.values, [f.name for f in v.fields]) for v in layouts["set_speed"].variants] == [
        (("MS",), ["temperature", "power", "speed", "encoder"]),
        (("MF", "MH", "MG"), ["temperature", "iq", "speed", "encoder"]),
    ]


def test_scales_are_exact_or_unknown(v2_35: Edition) -> None:
    linear = next(t for t in v2_35.types if t.name == "torque_current").linear
    scales = {name: case and case.scale for name, case in linear.cases.items()}
    assert scales == {"MS": None, "MF": Fraction(33, 4096), "MH": None, "MG": Fraction(33, 2048)}


def test_a_request_that_only_reads_the_brake_does_not_switch_it() -> None:
    brake = specification(ROOT / "spec/mwd_motor/v2.36-2025-03.yaml").edition.command("brake")
    (effect,) = brake.effects
    assert [(field.name, member.name) for field, member in brake.exemptions(effect)] == [("action", "read")]


def test_a_value_without_an_unknown_effect(tmp_path: Path) -> None:
    text = MIXER.replace("without_effects: [blinks]", "without_effects: [blink]")
    assert text != MIXER
    (finding,) = findings(tmp_path, text)
    assert (finding.rule, finding.message) == ("unknown-reference", "there is no effect `blink`")
    assert finding.hint == "did you mean `blinks`?"


def test_reply_forms(v2_35: Edition) -> None:
    forms = {c.name: [type(reply) for reply in c.replies] for c in v2_35.commands}
    assert forms["motor_off"] == [EchoReply]
    assert forms["read_encoder"] == [OwnReply]
    assert forms["set_torque"] == [SharedReply]
    (broadcast,) = v2_35.command("broadcast_torque").replies
    assert isinstance(broadcast, OtherReply)
    assert (broadcast.of, broadcast.from_each) == ("set_torque", (1, 2, 3, 4))
    assert broadcast.message is v2_35.command("set_torque").reply


def test_a_code_identifies_its_command(v2_35: Edition) -> None:
    codes = {m.command: m.identifying_codes for m in v2_35.messages(Direction.REPLY)}
    assert codes["read_status_1"] == (0x9A,)
    assert codes["clear_errors"] == (0x9B,)
    reply = v2_35.command("clear_errors").reply
    assert reply is not None
    assert (reply.keys[0].value, reply.accepted_codes) == (0x9A, (0x9B,))


def test_the_multi_turn_angle_has_seven_bytes(v2_35: Edition) -> None:
    reply = v2_35.command("read_multi_turn_angle").reply
    assert reply is not None
    (field,) = reply.layout.fields
    assert field.elements[0].segments == tuple(Segment(1 + i, 0, 8, 8 * i) for i in range(7))
    assert field.type.raw_limits == (-(2**55), 2**55 - 1)


def test_a_range_in_the_unit_is_converted_to_raw_integers(tmp_path: Path) -> None:
    text = MINIMAL.replace("scale: 0.1, raw_range: 0..1000", "scale: 0.3, offset: 1, range: 2..10")
    (level,) = edition(tmp_path, text).types
    assert level.linear == ByParameter.always(Linear(Fraction(3, 10), Fraction(1)))
    limits = level.raw_range.constant
    assert limits is not None
    assert [int(end.constant) for end in (limits.low, limits.high)] == [4, 30]


def test_a_big_endian_array_of_12_bit_elements(tmp_path: Path) -> None:
    text = MINIMAL.replace("request: {level: {at: 2, type: level}}", "request: {a: {at: 1.3, raw: u12, array: 1..2}}")
    request = edition(tmp_path, "byte_order: big\n" + text).commands[0].request
    assert request is not None
    first, second = request.layout.fields[0].elements
    assert (first.index, first.bits) == (1, (*range(16, 24), *range(8, 12)))
    assert second.index == 2
    assert second.segments == (Segment(4, 4, 4, 0), Segment(3, 0, 8, 4))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("type: level", "type: lever", "unknown-reference: lever"),
        ('unit: "%"', "unit: percent", "unknown-reference: percent"),
        ("reply: echo", "reply: leyout", "unknown-reference: leyout"),
        ("    reply: echo\n", "", "missing-reply: dim"),
        ("reply: echo", "reply: {of: dim}", "circular-reference: dim"),
        ("selector: {at: 0, raw: u8}\n", "", "no-selector: 0x10"),
        ("code: 0x10", "code: 0x110", "code-width: 0x110"),
        ("0x100 + node", "0x7FE + node", "id-space: 0x7FE + node"),
        (", nodes: 1..4", "", "missing-key: lamp"),
        ("type: level}", "type: level, only: {series: [A]}}", "unknown-reference: series"),
        ("scale: 0.1", "scale: {by: size, A: 1}", "unknown-reference: size"),
        ("at: 2, type", "at: 7, type", "beyond-frame: 7"),
        ("at: 2, type", "at: 0, type", "overlap: 0"),
        ("scale: 0.1", "scale: 0", "zero-scale: 0"),
        ("raw_range: 0..1000", "raw_range: 0..65536", "beyond-width: 0..65536"),
        ("raw_range: 0..1000", "enum: {a: {value: 1}, b: {value: 1}}", "member-value: {"),
        ("raw_range: 0..1000", "flags: {a: {bit: 16}}", "member-value: {"),
    ],
)
def test_position_of_a_semantic_error(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in MINIMAL
    assert expected in marked(findings(tmp_path, MINIMAL.replace(old, new, 1)))


def test_colliding_addresses_are_reported(tmp_path: Path) -> None:
    text = MINIMAL.replace("nodes: 1..4}}", "nodes: 1..4}, all: {id: 0x102}}")
    assert marked(findings(tmp_path, text)) == ["id-collision: 0x102"]


def test_a_text_without_a_language_is_reported(tmp_path: Path) -> None:
    text = MINIMAL.replace("edition: v1", "edition: v1\nlanguages: [en, zh]\ntitle: {en: Lamps}")
    assert places(findings(tmp_path, text)) == ["5:8 missing-language"]


PACKED = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
parameters: {size: {values: {small: {}, large: {}, odd: {}}}, color: {values: {warm: {}, cold: {}}}}
types:
  angle: {raw: u16, unit: deg, scale: {by: size, small: 20/65535, large: 50/65535, odd: none}, offset: {by: size, small: -10, large: -25, odd: 0}}
  height: {raw: u8, unit: mm, offset: {by: size, small: -1/2, large: 4, odd: none}}
commands:
  aim: {code: 1, manual: "1", request: {angle: {at: 2, type: angle}, low: {at: 4, type: height}}, reply: none}
"""


def test_an_offset_may_depend_on_a_parameter(tmp_path: Path) -> None:
    angle, height = edition(tmp_path, PACKED).types
    assert angle.linear == ByParameter(
        parameter="size",
        constant=None,
        cases={
            "small": Linear(Fraction(20, 65535), Fraction(-10)),
            "large": Linear(Fraction(50, 65535), Fraction(-25)),
            "odd": None,
        },
    )
    assert height.linear.at({"size": "small"}) == Linear(Fraction(1), Fraction(-1, 2))
    assert height.linear.at({"size": "odd"}) is None
    contradictory = PACKED.replace(
        "offset: {by: size, small: -10, large: -25, odd: 0}", "offset: {by: color, warm: 1, cold: 2}"
    )
    assert marked(findings(tmp_path, contradictory)) == ["two-parameters: {"]
    assert marked(findings(tmp_path, PACKED.replace(", odd: none}}\ncommands", "}}\ncommands"))) == [
        "incomplete-choice: offset"
    ]


def test_the_default_title_of_a_field_is_its_name(tmp_path: Path) -> None:
    def titles(text: str) -> list[str]:
        (command,) = edition(tmp_path, text).commands
        return [field.title["en"] for field in command.request.layout.fields] if command.request else []

    assert titles(PACKED) == ["Angle", "Low"]
    assert titles(PACKED.replace("raw: u8, unit: mm", "raw: u8, title: Above the desk, unit: mm")) == [
        "Angle",
        "Above the desk",
    ]


OBJECTS = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
tables:
  objects:
    index: {at: 1, raw: u16}
    entries:
      mode: {index: 1, kind: byte, layout: {mode: {at: 4, raw: u8}}}
      level: {index: 2, kind: word, commands: [read], layout: {level: {at: 4, raw: u16}}}
commands:
  read: {code: 0x40, table: objects, manual: "1", reply: {layout: entry, code: {byte: 0x4F, word: 0x4B}}}
  write: {code: {byte: 0x2F, word: 0x2B}, table: objects, manual: "1", request: entry, reply: {code: 0x60}}
"""


def test_codes_by_the_kind_of_an_entry(tmp_path: Path) -> None:
    commands = edition(tmp_path, OBJECTS).commands
    assert [(c.name, c.code, c.reply and c.reply.keys[0].value) for c in commands] == [
        ("read_mode", 0x40, 0x4F),
        ("read_level", 0x40, 0x4B),
        ("write_mode", 0x2F, 0x60),
    ]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("index: 1, kind: byte", "index: 1", "missing-key: mode"),
        ("kind: word", "kind: wrod", "unknown-reference: wrod"),
        ("commands: [read]", "commands: [reed]", "unknown-reference: reed"),
        ("write: {code: {byte: 0x2F, word: 0x2B}, table: objects", "write: {code: {a: 1}", "entry-of-nothing: {"),
    ],
)
def test_unknown_kinds_and_commands_of_an_entry_are_reported(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in OBJECTS
    assert expected in marked(findings(tmp_path, OBJECTS.replace(old, new)))


def test_a_constant_distinguishes_a_message_from_one_without_a_code(tmp_path: Path) -> None:
    """A frame with the code but without the constant is the message without a code."""
    text = MINIMAL.replace(
        "commands:\n",
        "commands:\n"
        "  state: {manual: '2', request: none, reply: {place: {at: 0, raw: u32}}}\n"
        "  ask: {code: 0x33, manual: '2', reply: {zero: {at: 1, raw: u8, constant: 0}, found: {at: 4, raw: u8}}}\n",
    )
    ask = edition(tmp_path, text).command("ask").reply
    assert ask is not None
    assert [(key.name, key.value) for key in ask.keys] == [("code", 0x33), ("zero", 0)]


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda original: pickle.loads(pickle.dumps(original))])
def test_a_copied_edition_refers_to_its_own_layouts(v2_35: Edition, copied: Callable[[Edition], Edition]) -> None:
    assert all(v2_35.of_layout(message.layout) for message in v2_35.all_messages())
    copied_edition = copied(v2_35)
    assert [m.name for m in copied_edition.all_messages()] == [m.name for m in v2_35.all_messages()]
    assert all(m in copied_edition.of_layout(m.layout) for m in copied_edition.all_messages())


MULTIPLES = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
parameters: {top: {number: {}}, side: {number: {}}, size: {values: [small, large]}, bits: {values: [14, 15]}}
types:
  angle: {raw: u16, unit: deg, scale: 2/65535*top, offset: -top, range: -0.5*top..top}
  width: {raw: u8, unit: mm, scale: {by: size, small: 1/255*top, large: 0.5}, raw_range: 0..2*side}
  bare: {raw: u8, range: 0..bits}
commands:
  aim:
    code: 1
    manual: "1"
    request: {angle: {at: 2, type: angle}, width: {at: 4, type: width}, bare: {at: 5, type: bare}}
    reply: none
"""


def test_a_scale_may_be_a_multiple_of_a_number(tmp_path: Path) -> None:
    text = MULTIPLES.replace("raw_range: 0..2*side", "raw_range: 0..200").replace("0..bits", "0..side")
    angle, width, bare = edition(tmp_path, text).types
    line = angle.linear.constant
    assert line == Linear(Fraction(2, 65535), Fraction(-1), "top")
    assert line and line.at({"top": Fraction(25, 2)}) == Linear(Fraction(5, 13107), Fraction(-25, 2))
    assert line.at({"side": Fraction(1)}) is None
    assert angle.raw_range == ByParameter.always(Range(Bound(Fraction(16384)), Bound(Fraction(65535))))
    assert (angle.numbers, width.numbers, bare.numbers, bare.times) == (("top",), ("top",), ("side",), ())
    assert width.linear.at({"size": "large"}) == Linear(Fraction(1, 2), Fraction(0))
    assert linear_of(angle, {"top": "12.5"}) == Linear(Fraction(5, 13107), Fraction(-25, 2))
    assert [linear_of(angle, given) for given in ({}, {"top": "0"}, {"top": "-1"}, {"top": "x"})] == [None] * 4


def test_position_of_an_invalid_multiple(tmp_path: Path) -> None:
    assert places(findings(tmp_path, MULTIPLES)) == ["9:90 two-parameters", "10:26 parameter-kind"]
    valid = MULTIPLES.replace("raw_range: 0..2*side", "raw_range: 0..200").replace("0..bits", "0..side")
    for old, new, place in (
        ("2/65535*top", "2/65535*tip", "8:39 unknown-reference"),
        ("2/65535*top", "2/65535*size", "8:39 parameter-kind"),
        ("small: 1/255*top", "small: 1/255*tip", "9:55 unknown-reference"),
        ("offset: -top", "offset: -tip", "8:60 unknown-reference"),
        ("offset: -top", "offset: -side", "8:60 two-parameters"),
        ("offset: -top", "offset: -180", "8:60 two-parameters"),
        ("2/65535*top", "2/65535", "8:56 two-parameters"),
        ("-0.5*top..top", "-0.5*side..side", "8:73 two-parameters"),
        ("-0.5*top..top", "-180..180", "8:73 two-parameters"),
        ("-0.5*top..top", "-0.5*top+1..top", "8:73 two-parameters"),
        ("-0.5*top..top", "top..-top", "8:73 value"),
        ("-0.5*top..top", "-0.5*top..tip", "8:73 unknown-reference"),
        ("raw: u16, unit", "raw: f32, unit", "8:39 parameter-kind"),
        ("range: -0.5*top..top", "plausible: 1..2", "8:77 parameter-kind"),
        ("0..side}", "0..side, plausible: 0..side}", "10:46 parameter-kind"),
        ("2/65535*top", "0*top", "8:39 zero-scale"),
        ("top: {number: {}}", "top: {number: {max: 0}}", "6:34 parameter-range"),
        ("offset: -top, range: -0.5*top..top", "range: 0..3*top", "8:59 beyond-width"),
    ):
        assert old in valid
        assert place in places(findings(tmp_path, valid.replace(old, new, 1))), new
    assert findings(tmp_path, valid) == []


def test_a_golden_frame_has_valid_parameters(tmp_path: Path) -> None:
    spec = ROOT / "tests/specs/arm/v1.yaml"
    (tmp_path / "v1.yaml").write_text(spec.read_text("utf-8"), "utf-8")
    golden = spec.with_name("v1.frames.yaml").read_text("utf-8")
    for number, message in (
        ("0", "`p_max` must be above 0"),
        ("101", "`p_max` must be at most 100"),
        ("much", "`much` is not a number"),
        ("", "`` is not a number"),
    ):
        invalid = golden.replace("p_max: 95.5", f'p_max: "{number}"')
        assert invalid != golden
        (tmp_path / "v1.frames.yaml").write_text(invalid, "utf-8")
        with pytest.raises(SpecError) as error:
            specification(tmp_path / "v1.yaml")
        assert message in str(error.value)
    (tmp_path / "v1.frames.yaml").write_text(golden.replace("p_max: 95.5", 'p_max: "191/2"'), "utf-8")
    specification(tmp_path / "v1.yaml")


def test_a_constant_that_overlaps_the_selector_is_reported(tmp_path: Path) -> None:
    """It remains a field, although its value distinguishes messages."""
    text = (ROOT / "tests/specs/joint/v1.yaml").read_text("utf-8")
    assert findings(tmp_path, text) == []
    text = text.replace("zero: {at: 1, raw: u8, constant: 0}", "zero: {at: 2, raw: u8, constant: 0}", 1)
    assert marked(findings(tmp_path, text)) == ["overlap: 2"]


def test_each_role_but_that_of_a_value_has_a_key_of_a_field() -> None:
    assert {role.key for role in get_args(Role)} == {"", *ROLE_KEYS}
    assert set(ROLE_KEYS) <= set(keys(FieldSpec))


@pytest.mark.parametrize(("role", "place"), [("reserved: 3", "reserved"), ("holds: node", "holds")])
def test_a_field_has_one_role(tmp_path: Path, role: str, place: str) -> None:
    text = (ROOT / "tests/specs/joint/v1.yaml").read_text("utf-8")
    text = text.replace("zero: {at: 1, raw: u8, constant: 0}", f"zero: {{at: 1, raw: u8, constant: 0, {role}}}", 1)
    assert marked(findings(tmp_path, text)) == [f"field-type: {place}"]


def test_plausible_values_include_the_limits_exact_or_rounded(v2_35: Edition) -> None:
    voltage = next(t for t in v2_35.types if t.plausible)
    tenth = dataclasses.replace(voltage, plausible=Range(Bound(Fraction(1, 10)), Bound(Fraction(3, 10))))
    assert all(map(tenth.is_plausible, (Fraction(1, 10), 0.1, 0.3, Fraction(3, 10), None, "on", ["hot"])))
    assert not any(map(tenth.is_plausible, (Fraction(9, 100), 0, 0.31, float("nan"))))
    assert dataclasses.replace(voltage, plausible=None).is_plausible(float("inf"))
