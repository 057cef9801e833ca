"""The four editions: what their manuals differ in, line by line, is what a comparison finds, and nothing else.

Each line was taken from the manuals themselves and stands for one row of what is publicly known of these editions. Two
such rows say something else than the comparison does, and the comparison is right:

- The first byte of the reply to 0x9B, 0x9A in the first edition and 0x9B later, is listed as a silent break. It
  does not: bindings of the first edition take either byte, so that nothing breaks.
- The ampere scale, 33/2048 and then 66/4096, is listed as different. It is the same number, so only the writing changed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import pytest
from canwright.compare import Category, Change, compare
from canwright.model.edition import Edition
from canwright.project.loader import specification

from ..spec_texts import ROOT

A, B, C = "v2.35-2024-02", "v2.36-2024-11", "v2.36-2025-03"
ALL = (A, B, C)


@dataclass(frozen=True)
class Line:
    """A difference from v2.35: in which editions, and what the comparison says of it, as `item: sentence`."""

    what: str
    editions: tuple[str, ...]
    says: tuple[str, ...]


LINES = (
    Line(
        "replies come from ids of their own",
        (B, C),
        ("address motor: the reply id is `0x180 + node` (was `0x140 + node`)",),
    ),
    Line(
        "gains and acceleration are gone",
        ALL,
        (
            "command read_pid: `read_pid` (0x30) is removed",
            "command write_pid_ram: `write_pid_ram` (0x31) is removed",
            "command write_pid_rom: `write_pid_rom` (0x32) is removed",
            "command read_acceleration: `read_acceleration` (0x33) is removed",
            "command write_acceleration_ram: `write_acceleration_ram` (0x34) is removed",
        ),
    ),
    Line(
        "control parameters by index, B0 and B1",
        (A,),
        (
            "command read_control_parameter: `read_control_parameter` (0xB0) is added",
            "command write_control_parameter_ram: `write_control_parameter_ram` (0xB1) is added",
        ),
    ),
    Line(
        "control parameters by index, C0 and C1",
        (B, C),
        (
            "command read_control_parameter: `read_control_parameter` (0xC0) is added",
            "command write_control_parameter_ram: `write_control_parameter_ram` (0xC1) is added",
        ),
    ),
    Line(
        "settings that are staged and saved",
        (C,),
        (
            "command read_stored_setting: `read_stored_setting` (0x40) is added",
            "command stage_stored_setting: `stage_stored_setting` (0x42) is added",
            "command save_stored_settings: `save_stored_settings` (0x44) is added",
        ),
    ),
    Line("the encoder can be calibrated", (C,), ("command calibrate_encoder: `calibrate_encoder` (0x18) is added",)),
    Line(
        "the encoder zero cannot be written any more",
        (B, C),
        ("command write_encoder_offset_rom: `write_encoder_offset_rom` (0x91) is removed",),
    ),
    Line(
        "95 sets the angle that it carries",
        (A, B),
        (
            "command clear_angle: the code of `clear_angle` (0x95) now means `set_angle`: "
            "Set multi-turn angle of the present position",
        ),
    ),
    Line(
        "95 carries nothing, sets the zero and stops",
        (C,),
        (
            "command clear_angle: the code of `clear_angle` (0x95) now means `set_zero_ram`: "
            "Set present position as zero in RAM",
        ),
    ),
    Line(
        "9A has the voltage elsewhere and finer, a current and a state",
        ALL,
        (
            "layout status_1: `voltage` is moved from DATA[3..4] to DATA[2..3]",
            "type voltage: `voltage` is signed (was unsigned)",
            "type voltage: the resolution of `voltage` is 0.01 V (was 0.1 V)",
            "layout status_1: `current` is added at DATA[4..5]",
            "layout status_1: `motor_state` is added at DATA[6]",
        ),
    ),
    Line(
        "9A has eight error bits",
        (B, C),
        tuple(
            f"type error_flags: `{name}` ({bit}) is added to `error_flags`"
            for name, bit in (
                ("over_voltage", 1),
                ("driver_overheat", 2),
                ("over_current", 4),
                ("short_circuit", 5),
                ("stall", 6),
                ("input_lost", 7),
            )
        ),
    ),
    Line(
        "9B is answered with 9B",
        ALL,
        (
            "command clear_errors: the reply code is 0x9B (was 0x9A)",
            "command clear_errors: further accepted codes: none (was 0x9B)",
        ),
    ),
    Line(
        "MS reports more power, and no range is printed for the current that is reported",
        ALL,
        (
            "layout motion_feedback: `power` has the type `output_power` (was `power`): raw range -1000..1000 (was -850..850)",
            "layout motion_feedback: `iq` has the type `measured_torque_current` (was `torque_current`): "
            "raw range not limited (was -2048..2048)",
        ),
    ),
    Line(
        "9D has the scale of the motion replies, and nothing for MS",
        ALL,
        (
            "command read_status_3: the command is available for series MF, MH, MG (was all)",
            "type phase_current: the resolution of `phase_current` [series MH, MS] is not given (was 1/64 A)",
            "type phase_current: the resolution of `phase_current` [series MF] is 33/4096 A (was 1/64 A)",
            "type phase_current: the resolution of `phase_current` [series MG] is 66/4096 A (was 1/64 A)",
        ),
    ),
    Line("there is a brake", ALL, ("command brake: `brake` (0x8C) is added",)),
    Line(
        "A2 carries a limit of the current",
        (B, C),
        (
            "command set_speed: `iq_limit` is added at DATA[2..3]",
            "command set_speed: limited by: max_speed, max_acceleration; "
            "was: max_speed, max_acceleration, max_torque_current, max_power",
        ),
    ),
    Line(
        "speed with a limit is a command of its own",
        (A,),
        ("command set_speed_limited: `set_speed_limited` (0xAD) is added",),
    ),
    Line(
        "the broadcast is gone",
        ALL,
        (
            "address broadcast: the address `broadcast`, `0x280`, is removed",
            "command broadcast_torque: `broadcast_torque` is removed",
        ),
    ),
)

SAME = {
    ALL: (
        *("motor_off", "motor_on", "motor_stop", "set_power", "set_torque", "move_to_angle", "move_to_angle_at_speed"),
        *("turn_to_angle", "turn_to_angle_at_speed", "move_by_angle", "move_by_angle_at_speed", "read_encoder"),
        *("write_position_as_zero_rom", "read_multi_turn_angle", "read_single_turn_angle", "read_status_2"),
    )
}
"""Commands whose own lines say that nothing changed."""

LATER = {
    (A, B): (
        "address motor: the reply id is `0x180 + node` (was `0x140 + node`)",
        "command read_control_parameter: the code is 0xC0 (was 0xB0)",
        "command set_speed: `iq_limit` is added at DATA[2..3]",
        "command set_speed: limited by: max_speed, max_acceleration; was: max_speed, max_acceleration, max_torque_current, max_power",
        "command set_speed_limited: `set_speed_limited` (0xAD) is removed",
        "command write_control_parameter_ram: the code is 0xC1 (was 0xB1)",
        "command write_encoder_offset_rom: `write_encoder_offset_rom` (0x91) is removed",
        "entry control_parameters.acceleration_limit: `acceleration_limit`, index 0x0C, is removed",
        "entry control_parameters.angle_pid: `angle_pid`, index 0x0A, is added",
        "entry control_parameters.current_pid: `current_pid`, index 0x0C, is added",
        "entry control_parameters.current_ramp: `current_ramp`, index 0x24, is added",
        "entry control_parameters.max_angle: `max_angle`, index 0x22, is added",
        "entry control_parameters.max_torque_current: `max_torque_current`, index 0x1E, is added",
        "entry control_parameters.speed_limit: `speed_limit` is renamed to `max_speed`",
        "entry control_parameters.speed_limit: `speed_limit` is renamed to `max_speed`: `speed_limit` → `max_speed`",
        "entry control_parameters.speed_limit: the index is 0x20 (was 0x0E)",
        "entry control_parameters.speed_pid: `speed_pid`, index 0x0B, is added",
        "entry control_parameters.speed_ramp: `speed_ramp`, index 0x26, is added",
        "entry control_parameters.torque_limit: `torque_limit`, index 0x0A, is removed",
        "type error_flags: `driver_overheat` (2) is added to `error_flags`",
        "type error_flags: `input_lost` (7) is added to `error_flags`",
        "type error_flags: `over_current` (4) is added to `error_flags`",
        "type error_flags: `over_temperature` of `error_flags` is renamed to `motor_overheat`: `over_temperature` → `motor_overheat`",
        "type error_flags: `over_voltage` (1) is added to `error_flags`",
        "type error_flags: `short_circuit` (5) is added to `error_flags`",
        "type error_flags: `stall` (6) is added to `error_flags`",
    ),
    (B, C): (
        "command calibrate_encoder: `calibrate_encoder` (0x18) is added",
        "command read_stored_setting: `read_stored_setting` (0x40) is added",
        "command save_stored_settings: `save_stored_settings` (0x44) is added",
        "command set_angle: the code of `set_angle` (0x95) now means `set_zero_ram`: Set present position as zero in RAM",
        "command stage_stored_setting: `stage_stored_setting` (0x42) is added",
        "entry control_parameters.current_ramp: `current_ramp`, index 0x24, is removed",
        "entry control_parameters.lower_angle: `lower_angle`, index 0x23, is added",
        "entry control_parameters.max_angle: the index 0x22 now means `upper_angle` (was `max_angle`)",
        "entry control_parameters.max_speed: `max_speed` has the type `speed_bound` (was `i32`): raw range 0..600000 (was not limited)",
        "entry control_parameters.max_torque_current: `max_torque_current` has the type `output_limit` (was `i16`): "
        "raw range [series MF, MG, MH] 0..2000 (was not limited), raw range [series MS] 0..850 (was not limited)",
        "entry control_parameters.speed_ramp: `speed_ramp` has the type `speed_ramp` (was `i32`): raw range 0..600000 (was not limited)",
        "type gain: the raw range of `gain` is 0..2000 (was not limited)",
    ),
}
"""All changes but those of texts between editions that follow one another, sorted."""


@cache
def edition(name: str) -> Edition:
    return specification(ROOT / "spec" / "mwd_motor" / f"{name}.yaml").edition


@cache
def changes(old: str, new: str) -> tuple[Change, ...]:
    return compare(edition(old), edition(new))


def sentences(reported: Iterable[Change]) -> list[str]:
    return [f"{change.item}: {change.says()}" for change in reported]


def sentences_of(old: str, new: str, *categories: Category) -> list[str]:
    return sorted(sentences(c for c in changes(old, new) if c.rule.category in categories))


@pytest.mark.parametrize("name", ALL)
def test_differences_of_editions_are_exactly_the_documented_ones(name: str) -> None:
    expected = [sentence for line in LINES if name in line.editions for sentence in line.says]
    assert sentences_of("v2.35", name, Category.WIRE, Category.VALUE) == sorted(expected)


@pytest.mark.parametrize("pair", LATER, ids=" to ".join)
def test_differences_between_later_editions(pair: tuple[str, str]) -> None:
    assert sentences_of(*pair, Category.WIRE, Category.VALUE, Category.API) == list(LATER[pair])


@pytest.mark.parametrize("name", ALL)
def test_unchanged_items_of_two_editions_are_not_reported(name: str) -> None:
    reported = changes("v2.35", name)
    touched = {c.item.name for c in reported if c.item.kind == "command" and c.rule.category is not Category.DOC}
    assert not touched & set(SAME[ALL])


def test_the_same_scale_written_otherwise_breaks_nothing() -> None:
    rewritten = [c for c in changes("v2.35", A) if c.rule.id == "scale-rewritten"]
    assert [c.says() for c in rewritten] == [
        "the scale of `iq` [series MF] is written as 33/4096 A (was 16.5/2048 A)",
        "the scale of `iq` [series MG] is written as 66/4096 A (was 33/2048 A)",
    ]
    assert all(c.impact.value == "safe" for c in rewritten)


def test_a_wrong_voltage_is_silent_and_a_missing_reply_is_loud() -> None:
    impact = {f"{c.rule.id} {c.item.name}": c.impact.value for c in changes("v2.35", C)}
    assert (
        impact["field-moved status_1"] == impact["scale-changed voltage"] == impact["field-added set_speed"] == "silent"
    )
    assert impact["id-changed motor"] == impact["command-removed read_pid"] == "loud"
    assert impact["reply-code-changed clear_errors"] == impact["command-added brake"] == "safe"
