"""Verdicts follow from frames that one edition encodes and the other decodes; each finding shows such a frame."""

from __future__ import annotations

import functools
import tempfile
from pathlib import Path

import pytest
from canwright.compare import Category, Change, Impact, compare
from canwright.model.edition import Edition

from ..spec_texts import MINIMAL, ROOT, edition

V2_35 = (ROOT / "spec/mwd_motor/v2.35.yaml").read_text("utf-8")
V2_36 = (ROOT / "spec/mwd_motor/v2.36-2025-03.yaml").read_text("utf-8")
JOINT = (ROOT / "tests/specs/joint/v1.yaml").read_text("utf-8")
PUMP = (ROOT / "tests/specs/pump/v1.yaml").read_text("utf-8")
WINCH = (ROOT / "tests/verification/specs/windlass/v1.yaml").read_text("utf-8")
MIXER = (ROOT / "tests/specs/mixer/v2-2024-02.yaml").read_text("utf-8")


@functools.cache
def _original(text: str) -> Edition:
    with tempfile.TemporaryDirectory() as folder:
        return edition(Path(folder), text)


def _changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert text.count(old) == 1, (text.count(old), old)
        text = text.replace(old, new)
    return text


def found(folder: Path, text: str, *changes: tuple[str, str]) -> list[Change]:
    """The changes of bits and meaning."""
    whole = compare(_original(text), edition(folder, _changed(text, *changes)))
    return [c for c in whole if c.rule.category in (Category.WIRE, Category.VALUE)]


def verdicts(changes: list[Change]) -> dict[str, dict[str, str]]:
    """The impact on each side, by rule and item."""
    return {
        f"{change.rule.id} {change.item}": {side.value: impact.value for side, impact in change.verdicts.items()}
        for change in changes
    }


SILENT, LOUD = "silent", "loud"


def test_swapped_codes_are_silent_in_both_directions(tmp_path: Path) -> None:
    """Reading is answered as writing, and the old host takes the reply to one for the reply to the other."""
    swapped = [("code: 0xC0", "code: 0xFF"), ("code: 0xC1", "code: 0xC0"), ("code: 0xFF", "code: 0xC1")]
    changes = found(tmp_path, V2_36, *swapped)
    both = {"sending": SILENT, "receiving": SILENT}
    result = verdicts(changes)
    assert result["code-changed command read_control_parameter"] == both
    assert result["code-changed command write_control_parameter_ram"] == both
    read = next(c for c in changes if c.item.name == "read_control_parameter")
    assert read.witnesses[0].says() == (
        "141#C00A000000000000: the old host sends `read_control_parameter_angle_pid`; the new node reads "
        "`write_control_parameter_ram_angle_pid`: `kp = 0`, `ki = 0`, `kd = 0`"
    )


def test_swapped_indexes_are_silent(tmp_path: Path) -> None:
    swapped = [("index: 0x22", "index: 0xFF"), ("index: 0x23", "index: 0x22"), ("index: 0xFF", "index: 0x23")]
    result = verdicts(found(tmp_path, V2_36, *swapped))
    assert {rule.partition(" ")[0] for rule in result} == {"index-changed"}
    assert all(sides["sending"] == SILENT for sides in result.values())


def test_an_unused_index_is_loud(tmp_path: Path) -> None:
    (change,) = found(tmp_path, V2_36, ("index: 0x26", "index: 0x77"))
    assert (change.rule.id, change.impact) == ("index-changed", Impact.LOUD)
    assert change.witnesses[0].says().endswith("the new node rejects it: unknown code")


MARKERS = """\
canwright: 1
family: lamp
edition: v1
addresses:
  lamp: {id: 0x100 + node, nodes: 1..4}
  all: {id: 0x300}
  none: {id: 0x301}
commands:
  start: {request: {mark: {at: 0, raw: u32, constant: 0xFFFFFFFE}}, reply: none}
  stop: {request: {mark: {at: 0, raw: u32, constant: 0xFFFFFFFD}}, reply: none}
  dim: {request: {level: {at: 0, raw: u16}, speed: {at: 2, raw: u16}}, reply: none}
  every: {address: all, request: {level: {at: 0, raw: u16}}, reply: none}
  dark: {address: none, request: {time: {at: 0, raw: u16}, zero: {at: 2, raw: u8, constant: 0}}, reply: none}
  state: {address: none, request: none, reply: {level: {at: 0, raw: u16}}}
"""
START = "  start: {request: {mark: {at: 0, raw: u32, constant: 0xFFFFFFFE}}, reply: none}\n"


def test_frames_with_the_old_constant_become_set_points(tmp_path: Path) -> None:
    (change,) = found(tmp_path, MARKERS, ("0xFFFFFFFE", "0xFFFFFFFB"))
    assert (change.rule.id, change.item.name, change.impact) == ("constant-changed", "start", Impact.SILENT)
    assert change.witnesses[0].says() == (
        "101#FEFFFFFF00000000: the old host sends `start`; the new node reads `dim`: `level = 65534`, `speed = 65535`"
    )
    assert "dim" in {name for w in change.witnesses for name in (w.says().split("`")[1],)}, "set-points are now `start`"


def test_swapped_constants_are_silent(tmp_path: Path) -> None:
    swapped = [("0xFFFFFFFE", "0xFFFFFFFB"), ("0xFFFFFFFD", "0xFFFFFFFE"), ("0xFFFFFFFB", "0xFFFFFFFD")]
    result = verdicts(found(tmp_path, MARKERS, *swapped))
    assert result == {f"constant-changed command {name}": {"sending": SILENT} for name in ("start", "stop")}


def test_swapped_constants_show_their_own_frames_and_replies_that_stay_are_safe(tmp_path: Path) -> None:
    swapped = [("FFFC}", "FFF0}"), ("FFFD}", "FFFC}"), ("FFF0}", "FFFD}")]
    enable, disable = found(tmp_path, JOINT, *swapped)
    for change, name in ((enable, "enable"), (disable, "disable")):
        assert {side.value: impact.value for side, impact in change.verdicts.items()} == {"sending": SILENT}
        assert f"the old host sends `{name}`" in change.witnesses[0].says()


def test_another_reply_form_is_one_finding_with_its_code_and_length(tmp_path: Path) -> None:
    form = "reply: {code: 0x45, accept: [0x05], layout: {length: {at: 0, type: length}, pull: {at: 4, type: pull}}}"
    (change,) = found(tmp_path, WINCH, (form, "reply: state"))
    assert (change.rule.id, verdicts([change])) == (
        "reply-form-changed",
        {"reply-form-changed command measure": {"receiving": SILENT}},
    )


def test_a_renamed_constant_is_only_a_renamed_field(tmp_path: Path) -> None:
    renamed = edition(tmp_path, MARKERS.replace("mark:", "marker:"))
    assert {c.rule.id for c in compare(_original(MARKERS), renamed)} == {"field-renamed"}


def test_frames_of_a_removed_command_become_set_points(tmp_path: Path) -> None:
    (change,) = found(tmp_path, MARKERS, (START, ""))
    assert (change.rule.id, change.impact) == ("command-removed", Impact.SILENT)
    assert "reads `dim`" in change.witnesses[0].says()


def test_a_new_constant_changes_the_meaning_of_set_points_with_its_value(tmp_path: Path) -> None:
    (change,) = found(tmp_path, MARKERS.replace(START, ""), ("  stop:", f"{START}  stop:"))
    assert (change.rule.id, change.impact) == ("command-added", Impact.SILENT)
    assert "sends `dim`: `level = 65534`, `speed = 65535`; the new node reads `start`" in change.witnesses[0].says()


def test_swapped_fixed_ids_are_silent(tmp_path: Path) -> None:
    swapped = [("id: 0x300", "id: 0x302"), ("id: 0x301", "id: 0x300"), ("id: 0x302", "id: 0x301")]
    result = verdicts(found(tmp_path, MARKERS, *swapped))
    assert result["id-changed address all"]["sending"] == SILENT
    assert result["id-changed address none"]["sending"] == SILENT


def test_a_further_accepted_code_is_loud(tmp_path: Path) -> None:
    (change,) = found(tmp_path, MIXER, ("accept: [0x20, 0x22]", "accept: [0x20, 0x22, 0x77]"))
    assert (change.rule.id, change.impact) == ("accept-changed", Impact.LOUD)


@pytest.mark.parametrize(
    ("direction", "said"),
    [
        (
            "request",
            "101#1500000000000000: the old host sends `dim`: `level = 0 %`; the new node rejects it: unknown code",
        ),
        (
            "reply",
            "201#1500000000000000: the old host accepts it as `dim`; a host of the new edition rejects it: unknown code",
        ),
    ],
)
def test_a_removed_accepted_code_is_loud(direction: str, said: str, tmp_path: Path) -> None:
    text = ACCEPTING.replace(direction + ": {", direction + ": {accept: [0x14, 0x15], ")
    (change,) = found(tmp_path, text, ("[0x14, 0x15]", "[0x14]"))
    assert (change.rule.id, change.impact, change.witnesses[0].says()) == ("accept-changed", Impact.LOUD, said)
    assert not found(tmp_path, text, ("[0x14, 0x15]", "[0x15, 0x14]"))[0].witnesses


def test_an_accepted_code_that_becomes_the_code_is_still_accepted(tmp_path: Path) -> None:
    changes = found(tmp_path, MIXER, ("code: 0x21\n      accept: [0x20, 0x22]", "code: 0x20\n      accept: [0x22]"))
    assert {change.rule.id: change.impact for change in changes}["accept-changed"] is Impact.SAFE


def test_a_periodic_frame_that_has_to_be_requested_is_loud(tmp_path: Path) -> None:
    periodic = "  state: {address: none, request: none, reply:"
    (change,) = found(
        tmp_path,
        MARKERS,
        (periodic, periodic.replace("request: none", "request: {ask: {at: 2, raw: u8, constant: 1}}")),
    )
    assert (change.rule.id, change.impact) == ("request-changed", Impact.LOUD)
    assert change.witnesses[0].says() == "the old host expects `state`; the new node sends it only on request"


def test_a_new_value_of_an_enum_is_silent(tmp_path: Path) -> None:
    (change,) = found(
        tmp_path, V2_36, ('      "off": {value: 0x10', '      starting: {value: 0x20}\n      "off": {value: 0x10')
    )
    assert (change.rule.id, change.impact, [s.value for s in change.sides]) == (
        "member-added",
        Impact.SILENT,
        ["receiving"],
    )
    assert change.witnesses[0].says() == (
        "181#9A00000000002000: the new node sends `read_status_1`: `motor_state = starting`; the old host reads `motor_state = 32`"
    )


def test_availability_for_more_nodes_is_safe_and_for_fewer_loud(tmp_path: Path) -> None:
    text = MINIMAL.replace('manual: "1"', "only: {size: [a]}") + "parameters: {size: {values: [a, b]}}\n"
    (more,) = found(tmp_path, text, ("[a]}", "[a, b]}"))
    assert (more.rule.id, more.impact) == ("availability-changed", Impact.SAFE)
    (fewer,) = found(tmp_path, text.replace("[a]}", "[a, b]}"), ("size: [a, b]}", "size: [a]}"))
    assert (fewer.impact, fewer.witnesses[0].condition) == (Impact.LOUD, "size b")


ACCEPTING = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {request: 0x100 + node, reply: 0x200 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
types: {level: {raw: u16, unit: "%", scale: 0.1}}
commands:
  dim: {code: 0x10, request: {layout: {level: {at: 2, type: level}}}, reply: {layout: {level: {at: 2, type: level}}}}
"""
ENUM = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
types:
  mode: {raw: u8, enum: {dark: {value: 0, title: Dark lamp}, bright: {value: 1, title: Bright lamp}}}
  faults: {raw: u8, flags: {hot: {bit: 0, title: Lamp too hot}}}
commands:
  start: {code: 0x10, title: Switch the lamp on, reply: none}
  read:
    code: 0x11
    reply: {mode: {at: 1, type: mode}, faults: {at: 2, type: faults}, level: {at: 3, raw: u8, title: Brightness}}
"""


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("start: {code: 0x10, title: Switch the lamp on", "erase: {code: 0x10, title: Erase", "command-repurposed"),
        ("bright: {value: 1, title: Bright lamp}", "broken: {value: 1, title: Broken lamp}", "member-replaced"),
        ("hot: {bit: 0, title: Lamp too hot}", "cold: {bit: 0, title: Lamp too cold}", "member-replaced"),
        ("level: {at: 3, raw: u8, title: Brightness}", "age: {at: 3, raw: u8, title: Hours}", "field-replaced"),
    ],
)
def test_reuse_under_another_name_and_title_is_silent(old: str, new: str, rule: str, tmp_path: Path) -> None:
    (change,) = found(tmp_path, ENUM, (old, new))
    assert (change.rule.id, change.impact) == (rule, Impact.SILENT)
    assert change.witnesses


@pytest.mark.parametrize(
    ("old", "new"), [("start:", "begin:"), ("bright: {", "light: {"), ("hot: {", "heat: {"), ("level: {", "light: {")]
)
def test_a_name_alone_is_no_change_of_meaning(old: str, new: str, tmp_path: Path) -> None:
    assert not found(tmp_path, ENUM, (old, new))


def test_a_narrower_range_is_loud_for_a_sender_and_a_wider_one_safe_for_a_receiver(tmp_path: Path) -> None:
    text = MINIMAL.replace("reply: echo", "reply: {level: {at: 2, type: level}}")
    (narrower,) = found(tmp_path, text, ("0..1000", "0..900"))
    assert (narrower.impact, [s.value for s in narrower.sides]) == (Impact.LOUD, ["sending"])
    assert narrower.witnesses[0].says() == (
        "101#1000E80300000000: the old host sends `dim`: `level = 100 %`; the new node allows 0..90 %"
    )
    (wider,) = found(tmp_path, text, ("0..1000", "0..1100"))
    assert wider.impact is Impact.SAFE


def test_every_edition_agrees_with_itself() -> None:
    for text in (V2_35, V2_36, JOINT, PUMP, MIXER):
        assert compare(_original(text), _original(text)) == ()


def test_negative_members_that_become_flags_are_silent(tmp_path: Path) -> None:
    enum, flags = "i8, enum: {by_hand: -1, none: 0}", "u8, flags: {by_hand: 1, none: 0}"
    text = MINIMAL.replace("types:\n", f"types:\n  mode: {{raw: {enum}}}\n").replace(
        "reply: echo", "reply: {mode: {at: 1, type: mode}}"
    )
    changes = found(tmp_path, text, (enum, flags))
    assert changes
    assert {Impact.SILENT} == {change.impact for change in changes}


def test_a_renamed_command_keeps_the_replies_that_refer_to_it(tmp_path: Path) -> None:
    further = "  stop: {code: 0x7F, title: Stop, reply: {of: dim}}\n"
    text = MINIMAL.replace("reply: echo", "reply: {level: {at: 2, type: level}}") + further
    renamed = ("  dim:", "  fade:"), ("of: dim}", "of: fade}")
    assert not found(tmp_path, text, *renamed)


def test_the_reply_of_another_command_is_no_answer(tmp_path: Path) -> None:
    """The old host identifies it as what it is, and receives no reply to its request."""
    further = "  stop: {code: 0x7F, title: Stop, reply: {raw_level: {at: 1, raw: u8}}}\n"
    text = MINIMAL.replace("reply: echo", "reply: {level: {at: 2, type: level}}") + further
    (change,) = found(tmp_path, text, ("{raw_level: {at: 1, raw: u8}}", "{of: dim}"))
    assert verdicts([change]) == {"reply-form-changed command stop": {"receiving": "loud"}}


def test_an_echo_instead_of_fields_at_the_same_bits_is_silent(tmp_path: Path) -> None:
    further = (
        "  fill: {code: 0x7F, title: Fill, request: {amount: {at: 1, raw: u8}}, reply: {left: {at: 1, raw: u8}}}\n"
    )
    (change,) = found(tmp_path, MINIMAL + further, ("reply: {left: {at: 1, raw: u8}}", "reply: echo"))
    assert verdicts([change]) == {"reply-form-changed command fill": {"receiving": "silent"}}


DOSER = (ROOT / "tests/verification/specs/doser/v1.yaml").read_text("utf-8")
RINSE = '  rinse: {code: 2, manual: "1", request: {layout: {doser: {at: 1, raw: u8, holds: node}'


def test_a_request_that_no_longer_asks_one_node_is_answered_by_others(tmp_path: Path) -> None:
    (change,) = found(tmp_path, DOSER, (RINSE, RINSE.replace(", holds: node", "")))
    assert verdicts([change]) == {"holds-changed command rinse": {"receiving": LOUD}}
    assert change.witnesses[0].says() == (
        "06F#0200000000000000: the new node sends `rinse`; the old host rejects it: not answer"
    )


def test_a_repurposed_command_explains_commands_that_share_its_reply(tmp_path: Path) -> None:
    purge = RINSE.replace("  rinse: {", "  purge: {title: Purge the pipe, ")
    (change,) = found(tmp_path, DOSER, (RINSE, purge), ("of: rinse", "of: purge"))
    assert verdicts([change]) == {"command-repurposed command rinse": {"sending": SILENT, "receiving": SILENT}}


def test_another_title_repurposes_a_command_even_if_it_repeats_the_name(tmp_path: Path) -> None:
    (change,) = found(tmp_path, DOSER, ("  pause: {code: 7", "  lock: {title: Lock, code: 7"))
    assert (change.rule.id, change.impact) == ("command-repurposed", Impact.SILENT)
    assert not found(tmp_path, DOSER, ("  pause: {code: 7", "  lock: {code: 7"))


def test_exchanged_names_of_fields_are_one_finding_for_each(tmp_path: Path) -> None:
    reply = "reply: {flow: {at: 1, type: flow}, state: {at: 5, type: state}}"
    changes = found(tmp_path, DOSER, (reply, "reply: {state: {at: 1, type: flow}, flow: {at: 5, type: state}}"))
    assert [(c.rule.id, c.impact) for c in changes] == [("field-replaced", Impact.SILENT)] * 2
    assert changes[0].says() == "DATA[1..4] now contains `state` (was `flow`)"


def test_exchanged_names_of_commands_are_one_finding_for_each(tmp_path: Path) -> None:
    names = [("  read_flow: ", "  other: "), ("  set_nozzles: ", "  read_flow: "), ("  other: ", "  set_nozzles: ")]
    changes = found(tmp_path, DOSER, *names)
    assert [(c.rule.id, c.impact) for c in changes] == [("command-repurposed", Impact.SILENT)] * 2


def test_a_reply_without_fields_is_one_finding(tmp_path: Path) -> None:
    reply = "reply: {layout: {state: {at: 1, type: state}}, code: 8}"
    (change,) = found(tmp_path, DOSER, (reply, "reply: {}"))
    assert change.says() == "the reply form is `{}` (was `fields`)"
    assert verdicts([change]) == {"reply-form-changed command pause": {"receiving": LOUD}}


def test_fields_that_can_look_like_an_echo_are_silent(tmp_path: Path) -> None:
    """Of most values the old host notices that the reply is no echo; of some it does not."""
    dose = "volume: {at: 2, type: volume}}, reply: echo}"
    (change,) = found(tmp_path, DOSER, (dose, dose.replace("echo", "{state: {at: 1, type: state}}")))
    assert verdicts([change]) == {"reply-form-changed command dose": {"receiving": SILENT}}


def test_the_byte_order_of_an_index_is_one_finding(tmp_path: Path) -> None:
    press = (ROOT / "tests/specs/press/v1.yaml").read_text("utf-8")
    (change,) = found(tmp_path, press, ("index: {at: 0, raw: u16}", "index: {at: 0, raw: u16, byte_order: big}"))
    assert verdicts([change]) == {"byte-order-changed table settings": {"sending": LOUD, "receiving": LOUD}}


def test_the_byte_order_of_an_edition_is_one_finding_though_a_selector_gets_other_bits(tmp_path: Path) -> None:
    text = MINIMAL.replace("selector: {at: 0, raw: u8}", "selector: {at: 0, raw: u5}")
    (change,) = found(tmp_path, text, ("edition: v1", "edition: v1\nbyte_order: big"))
    assert (change.rule.id, str(change.item)) == ("byte-order-changed", "edition")


def test_values_that_only_another_parameter_value_allows_are_tried(tmp_path: Path) -> None:
    sizes = "scale: {by: size, small: 0.1, big: none}, raw_range: {by: size, small: 0..100, big: none}"
    text = MINIMAL.replace("scale: 0.1, raw_range: 0..1000", sizes)
    text += "parameters: {size: {values: [small, big]}}\n"
    (change,) = found(tmp_path, text, ("{raw: u16,", "{raw: i16,"))
    assert verdicts([change]) == {"sign-changed type level": {"sending": SILENT, "receiving": SILENT}}
    assert {witness.condition for witness in change.witnesses} == {"size big"}


def test_a_constant_of_a_layout_is_reported_at_its_line(tmp_path: Path) -> None:
    constant = "zero: {at: 1, raw: u8, constant: 0}"
    (change,) = found(tmp_path, JOINT, (constant, constant.replace("constant: 0", "constant: 1")))
    assert change.new == ("commands", "read_word", "reply", "layout", "zero", "constant")


def test_set_points_that_only_another_parameter_value_allows_can_become_a_marker(tmp_path: Path) -> None:
    level = "{raw: u16, raw_range: {by: size, small: 0..100, big: none}}"
    text = MARKERS.replace("level: {at: 0, raw: u16}, speed", "level: {at: 0, type: level}, speed")
    text += f"types: {{level: {level}}}\nparameters: {{size: {{values: [small, big]}}}}\n"
    (change,) = found(tmp_path, text, ("0xFFFFFFFE", "0xFFFFFFFB"))
    assert any(w.condition == "size big" and "sends `dim`" in w.says() for w in change.witnesses)


def test_a_frame_with_unknown_bits_in_its_id_is_loud(tmp_path: Path) -> None:
    press = (ROOT / "tests/specs/press/v1.yaml").read_text("utf-8")
    (change,) = found(tmp_path, press, ("host: {raw: u8", "host: {raw: u7"))
    assert (change.rule.id, change.impact) == ("width-changed", Impact.LOUD)


def test_a_request_that_is_rejected_has_no_reply(tmp_path: Path) -> None:
    """Without the other message, a constant no longer distinguishes; the new node still rejects another value."""
    oven = (ROOT / "tests/verification/specs/oven/v1.yaml").read_text("utf-8")
    (change,) = found(tmp_path, oven, (oven[oven.index("  erase_recipe:") :], ""))
    assert verdicts([change]) == {"command-removed command erase_recipe": {"sending": LOUD}}


STATUS = """
  status: {code: 0x20, reply: {level: {at: 2, type: level}, power: {at: 4, raw: u16}}}
  reset: {code: 0x21, reply: {of: status}}
"""


@pytest.mark.parametrize(
    ("fields", "item"),
    [
        ("power: {at: 4, raw: u8}, faults: {at: 5, raw: u8}", "field-added command status"),
        ("power: {at: 4, raw: u15}, is_hot: {at: 5.7, raw: u1}", "width-changed command status"),
        ("power: {at: 4, raw: u8}, mode: {at: 5, raw: u8, constant: 3}", "field-added command status"),
    ],
)
def test_new_fields_in_the_bits_of_a_field_are_silent(fields: str, item: str, tmp_path: Path) -> None:
    changes = found(tmp_path, MINIMAL + STATUS, ("power: {at: 4, raw: u16}", fields))
    assert verdicts(changes)[item] == {"receiving": SILENT}
    assert any("reads `power = " in w.says() for c in changes for w in c.witnesses)


def test_a_constant_without_the_unit_of_a_field_is_silent(tmp_path: Path) -> None:
    constant = "level: {at: 2, raw: u16, constant: 1}, power"
    changes = found(tmp_path, MINIMAL + STATUS, ("level: {at: 2, type: level}, power", constant))
    assert {"receiving": SILENT} in verdicts(changes).values()
    says = [w.says() for c in changes for w in c.witnesses]
    assert "101#2000010000000000: the new node sends `status`: `level = 1`; the old host reads `level = 0.1 %`" in says


def test_a_shared_reply_affects_all_commands_that_have_it(tmp_path: Path) -> None:
    (change,) = found(tmp_path, MINIMAL + STATUS, ("power: {at: 4, raw: u16}", "power: {at: 5, raw: u16}"))
    assert change.used_by == ("status", "reset")


def test_exchanged_names_of_entries_are_silent(tmp_path: Path) -> None:
    names = [("      top_speed: {", "      other: {"), ("      brake_delay: {", "      top_speed: {")]
    changes = found(tmp_path, WINCH, *names, ("      other: {", "      brake_delay: {"))
    assert {c.impact for c in changes if c.witnesses} == {Impact.SILENT}
    assert "entry settings.top_speed" in {str(c.item) for c in changes}


def test_a_frame_with_a_node_in_its_data_has_its_fixed_id(tmp_path: Path) -> None:
    valve = (ROOT / "tests/specs/valve/v1.yaml").read_text("utf-8")
    field = "{valve: {at: 2, raw: u16, byte_order: big, holds: node}}"
    changes = found(tmp_path, valve, (field, field.replace(", byte_order: big", "")))
    frames = [w.frame for c in changes for w in c.witnesses]
    assert {frame.id for frame in frames if frame is not None} == {0x7E5}


def test_values_are_decimals(tmp_path: Path) -> None:
    scaled = MINIMAL.replace("scale: 0.1", "scale: 1/3")
    changes = found(tmp_path, scaled, ("scale: 1/3", "scale: 1/7"))
    says = [w.says() for c in changes for w in c.witnesses]
    assert (
        "101#1000010000000000: the old host sends `dim`: `level = ≈0.333333 %`; the new node reads `level = ≈0.142857 %`"
        in says
    )


def test_bounds_and_offsets_are_decimals(tmp_path: Path) -> None:
    text = MINIMAL.replace("raw_range: 0..1000", "offset: 1/3")
    (change,) = found(tmp_path, text, ("offset: 1/3", "offset: 1/7"))
    assert change.says() == "the offset of `level` is ≈0.142857 % (was ≈0.333333 %)"
    raw = "raw_range: 0..100*channels-1, unit: mm, scale: 0.01"
    text = _changed(MIXER, (raw, "range: 0..7*channels, unit: mm, scale: 0.03"))
    says = [c.says() for c in found(tmp_path, text, ("0..7*channels", "0..8*channels"))]
    assert says == ["the raw range of `place` is 0..≈266.667*channels (was 0..≈233.333*channels)"]


def test_allowed_values_are_in_the_unit(tmp_path: Path) -> None:
    changes = found(tmp_path, MIXER, ("0..100*channels-1", "0..50*channels-1"))
    allowed = {w.condition: w.says().partition("the new node ")[2] for c in changes for w in c.witnesses}
    assert allowed == {"channels 13": "allows 0..6.49 mm", "channels 64": "allows 0..31.99 mm"}


@pytest.mark.parametrize(
    ("old", "new", "impact"),
    [
        ("range: -200..200, ", "range: -200..20, ", Impact.LOUD),
        ("range: -200..200, ", "range: -199.5..200, ", Impact.LOUD),
        ("", "range: -200..20, ", Impact.LOUD),
        ("range: -200..20, ", "range: -200..200, ", Impact.SAFE),
    ],
)
def test_the_bounds_of_floats_are_tried(tmp_path: Path, old: str, new: str, impact: Impact) -> None:
    """None of the usual samples 1, -100 and 0 is outside the narrower ranges."""
    text = MINIMAL.replace("raw: u16", "raw: f32").replace("raw_range: 0..1000", f"{old}title: Level")
    changes = found(tmp_path, text, (f"{old}title", f"{new}title"))
    assert [change.impact for change in changes] == [impact]


def test_offsets_that_are_printed_alike_differ(tmp_path: Path) -> None:
    text = MINIMAL.replace("scale: 0.1", "scale: 0.1, offset: 1/3")
    assert {c.rule.id for c in found(tmp_path, text, ("1/3", "1000000001/3000000000"))} == {"offset-changed"}


def test_elements_of_arrays_are_shown_with_their_numbers(tmp_path: Path) -> None:
    """The value of motor 1 must not drive motor 2, although it is the first element in both editions."""
    (change,) = found(tmp_path, V2_35, ("array: 1..4", "array: 2..5"))
    assert change.impact is Impact.SILENT
    assert change.witnesses[0].says() == (
        "280#0100000000000000: the old host sends `broadcast_torque`: `iq[1..4] = 0.016 A, 0 A, 0 A, 0 A`; "
        "the new node reads `iq[2..5] = 0.016 A, 0 A, 0 A, 0 A`"
    )


def test_a_further_element_of_a_reply_is_safe(tmp_path: Path) -> None:
    (change,) = found(tmp_path, MIXER, ("type: balance, array: 0..3", "type: balance, array: 0..4"))
    assert (change.rule.id, change.impact) == ("array-changed", Impact.SAFE)


def test_a_reply_of_another_command_written_as_its_own_is_safe(tmp_path: Path) -> None:
    """The answer to a request has the same values, and the same bits."""
    press = (ROOT / "tests/specs/press/v1.yaml").read_text("utf-8")
    enable = 'enable: {code: 3, manual: "3", request: addressed, reply: '
    changes = found(tmp_path, press, (enable + "{of: press}", enable + "{layout: status, code: 2}"))
    assert [c.impact for c in changes] == [Impact.SAFE]


def test_a_constant_that_decides_on_the_same_bits_as_markers_rejects_frames(tmp_path: Path) -> None:
    changes = found(tmp_path, JOINT, ("damping: {at: 5, type: damping}", "damping: {at: 5, raw: u12, constant: 0}"))
    (change,) = (c for c in changes if c.rule.id == "constant-changed")
    assert change.impact is not Impact.SAFE
    assert any(w.says().endswith("the new node rejects it: unknown code") for w in change.witnesses)


def test_the_echo_of_a_request_has_its_constants(tmp_path: Path) -> None:
    text = MINIMAL.replace("{level:", "{slot: {at: 1, raw: u8, constant: 1}, level:")
    (change,) = found(tmp_path, text, (", constant: 1", ""))
    assert (change.rule.id, change.impact) == ("constant-changed", Impact.SAFE)


def test_only_frames_that_exist_are_shown(tmp_path: Path) -> None:
    """A field of a command with another code: the new node rejects the frames of the old host."""
    both = ("    code: 0x10", "    code: 0x11"), ("at: 2", "at: 4")
    changes = found(tmp_path, MINIMAL, *both)
    (moved,) = (c for c in changes if c.rule.id == "field-moved")
    assert moved.impact is Impact.SILENT
    assert moved.witnesses == ()


def test_a_float_that_becomes_a_constant_keeps_its_meaning(tmp_path: Path) -> None:
    """A constant is the raw integer of its type: the old host reads the float that these bits are."""
    changes = found(tmp_path, JOINT, ("reply: {code: 0x7B, layout: {limit: {at: 4, raw: f32}}}", CONSTANT_LIMIT))
    assert verdicts(changes) == {"constant-changed command get_limit": {}}
    integer = CONSTANT_LIMIT.replace("f32", "u32")
    changes = found(tmp_path, JOINT, ("reply: {code: 0x7B, layout: {limit: {at: 4, raw: f32}}}", integer))
    assert verdicts(changes)["encoding-changed command get_limit"] == {"receiving": SILENT}


CONSTANT_LIMIT = "reply: {code: 0x7B, layout: {limit: {at: 4, raw: f32, constant: 1}}}"


def test_a_frame_that_is_accepted_shows_what_the_new_node_ignores(tmp_path: Path) -> None:
    """Most values of a field in the id make the id unknown; the value 0 does not, and is ignored in silence."""
    old = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4, extended: true}}
commands:
  dim: {request: {host: {at: id.16, raw: u4}, group: {at: id.20, raw: u4}}, reply: none}
"""
    new = old.replace("request: {host: {at: id.16, raw: u4}, group: {at: id.20, raw: u4}}", "request: {}")
    (change,) = compare(edition(tmp_path, old), edition(tmp_path, new))
    assert (change.rule.id, change.impact) == ("request-changed", Impact.SILENT)
    assert change.witnesses[0].sent.startswith("00000101#")


def test_a_name_for_nan_is_silent_for_receivers_and_its_witness_has_nan(tmp_path: Path) -> None:
    floats = MINIMAL.replace("raw: u16", "raw: f32").replace(", raw_range: 0..1000", "")
    changes = found(tmp_path, floats, ("scale: 0.1", "scale: 0.1, no_value: {absent: nan}"))
    (change,) = (change for change in changes if change.rule.id == "member-added")
    assert change.impact is Impact.SILENT
    assert change.facts["value"] == "NaN"
    assert change.witnesses[0].says() == (
        "101#1000FFFFFFFF0000: the new node sends `dim`: `level = absent`; the old host reads `level = not finite`"
    )
