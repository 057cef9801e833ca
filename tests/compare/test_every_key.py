"""Every key of the language: a change of it has exactly the findings in `every_key.txt`, or it is known why none.

`python -m tests.compare.test_every_key` rewrites that file.
"""

from __future__ import annotations

import copy
import functools
import json
import tempfile
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.compare import compare
from canwright.language.edition import EditionSpec, json_schema
from canwright.model.edition import Edition

from ..spec_texts import edition
from ..untrusted.everything import SPEC
from .recorded import findings, record, recorded

RECORDED = "every_key.txt"

NOT_COMPARED = {
    "EditionSpec.canwright": "the version of the language, not of the protocol",
    "EditionSpec.family": "other families are not compared",
    "EditionSpec.edition": "what is compared has two names",
    "EditionSpec.date": "what is compared has two dates",
    **{
        f"{concept}.renamed_from": "what is compared with what, see test_renames.py"
        for concept in ("CommandSpec", "EntrySpec", "FieldSpec", "FlagSpec", "MemberSpec", "NameSpec", "NoValueSpec")
    },
}
TEXT = "Another text"
FIELD = "commands.dim.request.level"
CHECKSUM = "commands.seal.request.crc.checksum"
CHANGES: dict[str, dict[str, Any]] = {
    "EditionSpec.title": {"title": TEXT},
    "EditionSpec.about": {"about": TEXT},
    "EditionSpec.languages": {"languages": ["zh"]},
    "EditionSpec.manual": {"manual": TEXT},
    "EditionSpec.byte_order": {"byte_order": "big"},
    "EditionSpec.bus": {"bus": {"modes": {"usual": {"bit_rates_kbps": [250]}, "broadcast": {"bit_rates_kbps": [1]}}}},
    "EditionSpec.addresses": {"addresses.spare": {"id": 0x300}},
    "EditionSpec.selector": {"selector": {"at": 7, "raw": "u8"}},
    "EditionSpec.parameters": {"parameters.more": {"values": ["a", "b"]}},
    "EditionSpec.settings": {"settings.more": {}},
    "EditionSpec.effects": {"effects.more": {}, "commands.dim.effects": ["more"]},
    "EditionSpec.states": {"states.more": {}},
    "EditionSpec.types": {"types.more": {"raw": "u24"}, "commands.turn.request.angle.type": "more"},
    "EditionSpec.layouts": {"layouts.more": {"fields": {"x": {"at": 3, "raw": "u8"}}}, "commands.read.reply": "more"},
    "EditionSpec.tables": {
        "tables.more": {"index": {"at": 1, "raw": "u8"}, "entries": {"spare": {"index": 1, "layout": {}}}},
        "commands.store.table": "more",
    },
    "EditionSpec.commands": {"commands.more": {"code": 0x70, "reply": "none"}},
    "EditionSpec.errata": {"errata": []},
    "AddressSpec.title": {"addresses.lamp.title": TEXT},
    "AddressSpec.about": {"addresses.lamp.about": TEXT},
    "AddressSpec.id": {"addresses.lamp.id": "0x110 + node", "addresses.host.request": "host_id"},
    "AddressSpec.request": {
        "addresses.lamp.id": None,
        "addresses.lamp.request": "0x110 + node",
        "addresses.lamp.reply": "0x100 + node",
    },
    "AddressSpec.reply": {
        "addresses.lamp.id": None,
        "addresses.lamp.request": "0x100 + node",
        "addresses.lamp.reply": "0x110 + node",
    },
    "AddressSpec.nodes": {"addresses.lamp.nodes": "1..5"},
    "AddressSpec.selector": {"addresses.all.selector": {"at": 7, "raw": "u8"}},
    "AddressSpec.reply_selector": {"addresses.lamp.reply_selector": {"at": 7, "raw": "u8"}},
    "AddressSpec.extended": {"addresses.lamp.extended": True},
    "AddressSpec.alternative_replies": {"addresses.lamp.alternative_replies": ["refused"]},
    "AddressSpec.manual": {"addresses.lamp.manual": "9"},
    "BusSpec.host": {"bus.host": "Desk"},
    "BusSpec.dlc": {"bus.dlc": 7},
    "TypeSpec.padding": {"types.label.padding": 255},
    "BusSpec.frame_format": {"bus.frame_format": "fd_brs"},
    "BusSpec.answers": {"bus.answers": None},
    "BusSpec.max_nodes": {"bus.max_nodes": 3},
    "BusSpec.reply_within_ms": {"bus.reply_within_ms": 2},
    "BusSpec.modes": {"bus.modes.more": {"bit_rates_kbps": [20]}},
    "BusSpec.manual": {"bus.manual": "9"},
    "ChecksumSpec.algorithm": {CHECKSUM: {"algorithm": "sum", "over": "0..4"}},
    "ChecksumSpec.poly": {f"{CHECKSUM}.poly": 0x1D},
    "ChecksumSpec.init": {f"{CHECKSUM}.init": 1},
    "ChecksumSpec.reflected": {f"{CHECKSUM}.reflected": True},
    "ChecksumSpec.xor_out": {f"{CHECKSUM}.xor_out": 1},
    "ChecksumSpec.over": {f"{CHECKSUM}.over": ["id", "0..4"]},
    "CommandSpec.title": {"commands.dim.title": TEXT},
    "CommandSpec.about": {"commands.dim.about": TEXT},
    "CommandSpec.code": {"commands.dim.code": 0x70},
    "CommandSpec.short_name": {"commands.dim.short_name": "d"},
    "CommandSpec.deprecated": {"commands.read.deprecated": {"since": "v1"}},
    "CommandSpec.address": {"commands.dim.address": "all"},
    "CommandSpec.mode": {"commands.dim.mode": "broadcast"},
    "CommandSpec.table": {"commands.store": {"code": 0x13, "reply": "echo"}},
    "CommandSpec.manual": {"commands.dim.manual": "9"},
    "CommandSpec.manual_name": {"commands.dim.manual_name": TEXT},
    "CommandSpec.only": {"commands.dim.only": {"size": ["big"]}},
    "CommandSpec.reply_within_ms": {"commands.dim.reply_within_ms": 2000},
    "CommandSpec.implemented": {"commands.dim.implemented": False},
    "CommandSpec.request": {"commands.colours.request": "none"},
    "CommandSpec.reply": {"commands.dim.reply": "none"},
    "CommandSpec.further_replies": {"commands.parts.further_replies": ["colours"]},
    "CommandSpec.alternative_replies": {"commands.parts.alternative_replies": ["read"]},
    "CommandSpec.effects": {"commands.dim.effects": ["glows"]},
    "CommandSpec.repeat": {"commands.dim.repeat": "never"},
    "CommandSpec.ends_motion": {"commands.cut.ends_motion": "stop"},
    "CommandSpec.limited_by": {"commands.dim.limited_by": []},
    "CommandSpec.not_limited_by": {"commands.read.not_limited_by": []},
    "CommandSpec.notes": {"commands.dim.notes": [TEXT]},
    "DeprecatedSpec.since": {"commands.dim.deprecated.since": "v2"},
    "DeprecatedSpec.until": {"commands.dim.deprecated.until": "v4"},
    "EffectSpec.title": {"effects.glows.title": TEXT},
    "EffectSpec.about": {"effects.glows.about": TEXT},
    "EffectSpec.consent": {"effects.glows.consent": "motion"},
    "EffectSpec.repeat": {"effects.glows.repeat": "never"},
    "EffectSpec.kept": {"effects.glows.kept": "ram"},
    "EffectSpec.level": {"effects.glows.level": "danger"},
    "EntrySpec.title": {"tables.store.entries.gain.title": TEXT},
    "EntrySpec.about": {"tables.store.entries.gain.about": TEXT},
    "EntrySpec.manual": {"tables.store.entries.gain.manual": "9"},
    "EntrySpec.index": {"tables.store.entries.gain.index": 9},
    "EntrySpec.layout": {"tables.store.entries.gain.layout": {"gain": {"at": 5, "raw": "u16"}}},
    "EntrySpec.dlc": {"tables.store.entries.gain.dlc": 7},
    "EntrySpec.only": {"tables.store.entries.state.only": {"size": ["small", "big"]}},
    "EntrySpec.effects": {"tables.store.entries.gain.effects": []},
    "EntrySpec.kind": {
        "tables.store.entries.gain.kind": "wide",
        "tables.store.entries.state.kind": "slim",
        "commands.store.code": {"wide": 0x13, "slim": 0x70},
    },
    "EntrySpec.commands": {
        "commands.fetch": {"code": 0x70, "table": "store", "reply": "entry"},
        "tables.store.entries.state.commands": ["fetch"],
    },
    "ErratumSpec.id": {"errata.0.id": "another"},
    "ErratumSpec.where": {"errata.0.where": ["types.level"]},
    "ErratumSpec.manual": {"errata.0.manual": "9"},
    "ErratumSpec.printed": {"errata.0.printed": TEXT},
    "ErratumSpec.used": {"errata.0.used": TEXT},
    "ErratumSpec.why": {"errata.0.why": TEXT},
    "FieldSpec.title": {f"{FIELD}.title": TEXT},
    "FieldSpec.about": {f"{FIELD}.about": TEXT},
    "FieldSpec.at": {f"{FIELD}.at": 5},
    "FieldSpec.deprecated": {f"{FIELD}.deprecated": {"since": "v1"}},
    "FieldSpec.type": {"commands.colours.reply.colours.type": "state"},
    "FieldSpec.raw": {"tables.store.entries.gain.layout.gain.raw": "i16"},
    "FieldSpec.entry": {"commands.greet.request.gain.entry": "state"},
    "FieldSpec.byte_order": {"tables.store.entries.gain.layout.gain.byte_order": "big"},
    "FieldSpec.array": {"commands.colours.reply.colours.array": "1..4"},
    "FieldSpec.only": {"commands.dim.request.small.only": {"size": ["big"]}},
    "FieldSpec.constant": {"commands.read.request.fixed.constant": 4, "commands.greet.request.host.constant": 5},
    "FieldSpec.reserved": {"commands.read.request.fixed.constant": None, "commands.read.request.fixed.reserved": 3},
    "FieldSpec.holds": {"tables.store.entries.gain.layout.gain.holds": "node"},
    "FieldSpec.counter": {"commands.seal.request.count.counter": "0..13"},
    "FieldSpec.checksum": {CHECKSUM: None},
    "FieldSpec.variable": {"commands.dim.request.level.variable": "turns"},
    "FieldSpec.manual": {f"{FIELD}.manual": "9"},
    "FieldSpec.manual_name": {f"{FIELD}.manual_name": TEXT},
    "FlagSpec.title": {"types.state.flags.hot.title": TEXT},
    "FlagSpec.about": {"types.state.flags.hot.about": TEXT},
    "FlagSpec.deprecated": {"types.state.flags.cold.deprecated": {"since": "v1"}},
    "FlagSpec.bit": {"types.state.flags.hot.bit": 1},
    "LayoutSpec.title": {"layouts.status.title": TEXT},
    "LayoutSpec.about": {"layouts.status.about": TEXT},
    "LayoutSpec.fields": {"layouts.status.fields.more": {"at": 5, "raw": "u8"}},
    "LayoutSpec.manual": {"layouts.status.manual": "9"},
    "MemberSpec.title": {"types.colour.enum.red.title": TEXT},
    "MemberSpec.about": {"types.colour.enum.red.about": TEXT},
    "MemberSpec.deprecated": {"types.colour.enum.green.deprecated": {"since": "v1"}},
    "MemberSpec.without_effects": {"types.colour.enum.red.without_effects": ["heats"]},
    "MemberSpec.value": {"types.colour.enum.red.value": 3},
    "MessageSpec.layout": {"commands.all.reply.layout": {}},
    "MessageSpec.fields": {"commands.all.reply.fields": {"more": {"at": 5, "raw": "u8"}}},
    "MessageSpec.of": {"commands.turn.reply": {"of": "colours"}},
    "MessageSpec.from_each": {"commands.all.reply.from_each": "1..2"},
    "MessageSpec.code": {"commands.all.reply.code": 0x71},
    "MessageSpec.accept": {"commands.all.reply.accept": [0x71]},
    "MessageSpec.address": {"commands.read.request": {"address": "all"}},
    "MessageSpec.dlc": {"commands.all.reply.dlc": 7},
    "MessageSpec.every_ms": {"commands.beat.reply.every_ms": 50},
    "MessageSpec.timeout_ms": {"commands.beat.reply.timeout_ms": 400},
    "MessageSpec.sent": {"commands.beat.reply.sent": ["cyclic", "event"]},
    "MessageSpec.frames": {"commands.parts.reply.frames": {"part": "1..2"}},
    "MessageSpec.remote": {
        "addresses.calls": {"id": 0x700, "selector": {"at": "id.0", "raw": "u8"}},
        "commands.read.request": {"remote": True, "address": "calls"},
    },
    "ModeSpec.title": {"bus.modes.usual.title": TEXT},
    "ModeSpec.about": {"bus.modes.usual.about": TEXT},
    "ModeSpec.bit_rates_kbps": {"bus.modes.usual.bit_rates_kbps": [500, 250]},
    "ModeSpec.default_kbps": {"bus.modes.usual.default_kbps": None},
    "NumberRange.min": {"parameters.count.number.min": 2},
    "NumberRange.max": {"parameters.count.number.max": 8},
    "OffsetBy.by": {"types.level.offset": {"by": "size", "small": 1, "big": 0}},
    "ParameterSpec.title": {"parameters.size.title": TEXT},
    "ParameterSpec.about": {"parameters.size.about": TEXT},
    "ParameterSpec.values": {"parameters.bits.values": [14, 15, 16]},
    "ParameterSpec.number": {"parameters.count.number": {"min": 1}},
    "RangeBy.by": {"types.angle.raw_range": {"by": "size", "small": "0..9", "big": "none"}, "types.angle.range": None},
    "ScaleBy.by": {"types.level.scale": {"by": "bits", "14": 0.1, "15": "none"}},
    "Selector.at": {"tables.store.index.at": 2},
    "Selector.raw": {"tables.store.index.raw": "u7"},
    "Selector.byte_order": {"selector": {"at": 6, "raw": "u16", "byte_order": "big"}},
    "SettingSpec.title": {"settings.limit.title": TEXT},
    "SettingSpec.about": {"settings.limit.about": TEXT},
    "SettingSpec.only": {"settings.limit.only": {"size": ["big"]}},
    "StateSpec.title": {"states.dark.title": TEXT},
    "StateSpec.about": {"states.dark.about": TEXT},
    "StateSpec.entered_by": {"states.dark.entered_by": ["dim"]},
    "StateSpec.prevents": {"states.dark.prevents": ["heats"]},
    "TableSpec.title": {"tables.store.title": TEXT},
    "TableSpec.about": {"tables.store.about": TEXT},
    "TableSpec.manual": {"tables.store.manual": "9"},
    "TableSpec.index": {"tables.store.index": {"at": 2, "raw": "u8"}},
    "TableSpec.entries": {"tables.store.entries.more": {"index": 7, "layout": {}}},
    "Description.title": {"parameters.size.values.big": {"title": TEXT}},
    "Description.about": {"parameters.size.values.big": {"about": TEXT}},
    "NameSpec.title": {"types.heat.names.boiling.title": TEXT},
    "NameSpec.about": {"types.heat.names.boiling.about": TEXT},
    "NameSpec.deprecated": {"types.heat.names.boiling.deprecated": {"since": "v2"}},
    "NameSpec.value": {"types.heat.names.boiling.value": 99},
    "NoValueSpec.title": {"types.heat.no_value.absent.title": TEXT},
    "NoValueSpec.about": {"types.heat.no_value.absent.about": TEXT},
    "NoValueSpec.deprecated": {"types.heat.no_value.faulty.deprecated": {"since": "v1"}},
    "NoValueSpec.raw": {"types.heat.no_value.faulty.raw": "249..253"},
    "TypeSpec.title": {"types.level.title": TEXT},
    "TypeSpec.about": {"types.level.about": TEXT},
    "TypeSpec.differs": {"types.level.differs": TEXT},
    "TypeSpec.raw": {"types.level.raw": "i16"},
    "TypeSpec.byte_order": {"types.level.byte_order": "big"},
    "TypeSpec.unit": {"types.level.unit": "V"},
    "TypeSpec.scale": {"types.level.scale": 0.2},
    "TypeSpec.offset": {"types.angle.offset": 2},
    "TypeSpec.raw_range": {"types.level.raw_range": "0..999"},
    "TypeSpec.range": {"types.angle.range": "-80..80"},
    "TypeSpec.plausible": {"types.level.plausible": "1..2"},
    "TypeSpec.enum": {"types.colour.enum.blue": {"value": 7}},
    "TypeSpec.names": {"types.heat.names": {"icy": 1, "warm": 20}},
    "TypeSpec.no_value": {"types.heat.no_value.cold": 248, "types.heat.no_value.faulty.raw": "249..253"},
    "TypeSpec.flags": {"types.state.flags.wet": {"bit": 7}},
}
"""`Concept.key` to what is set in the spec, by dotted path; None takes a key away."""


def _keys() -> set[str]:
    schema = json_schema(EditionSpec)
    concepts = {schema["title"]: schema, **schema["$defs"]}
    return {f"{name}.{key}" for name, concept in concepts.items() for key in concept.get("properties", {})}


def edition_with(folder: Path, changes: dict[str, Any]) -> Edition:
    data = copy.deepcopy(_original())
    for path, value in changes.items():
        *steps, last = [int(step) if step.isdigit() and step != "14" else step for step in path.split(".")]
        part = data
        for step in steps:
            part = part[step]
        if value is None:
            del part[last]
        else:
            part[last] = value
    return edition(folder, json.dumps(data))


@functools.cache
def _original() -> Any:
    data = yaml.load(SPEC, yaml.CSafeLoader)
    data["languages"] = ["en"]
    data["errata"][0] |= {"manual": "1", "printed": "One.", "used": "Another.", "why": "It is so."}
    return data


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Edition:
    return edition_with(tmp_path_factory.mktemp("original"), {})


def test_every_key_is_known() -> None:
    assert {*CHANGES, *NOT_COMPARED} == _keys()
    assert not CHANGES.keys() & NOT_COMPARED.keys()
    assert recorded(RECORDED).keys() == CHANGES.keys(), "`python -m tests.compare.test_every_key` records their changes"


@pytest.mark.parametrize(("key", "expected"), recorded(RECORDED).items(), ids=recorded(RECORDED))
def test_a_change_of_a_key_is_found(key: str, expected: str, original: Edition, tmp_path: Path) -> None:
    assert expected != "none"
    assert findings(compare(original, edition_with(tmp_path, CHANGES[key]))) == expected


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        old = edition_with(Path(made), {})
        record(RECORDED, {key: findings(compare(old, edition_with(Path(made), CHANGES[key]))) for key in CHANGES})
