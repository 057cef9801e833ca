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
from ..strangers.everything import SPEC
from .recorded import findings, record, recorded

RECORDED = "every_key.txt"

NOT_COMPARED = {
    "EditionSpec.canwright": "the version of the language, not of the protocol",
    "EditionSpec.family": "other families are not compared",
    "EditionSpec.edition": "what is compared has two names",
    "EditionSpec.date": "what is compared has two dates",
    "Type.plausible": "for guessing alone",
}
TEXT = "Another text"
FIELD = "commands.dim.request.level"
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
    "EditionSpec.types": {"types.more": {"raw": "u24"}, "commands.turn.request.angle.type": "more"},
    "EditionSpec.layouts": {"layouts.more": {"fields": {"x": {"at": 3, "raw": "u8"}}}, "commands.read.reply": "more"},
    "EditionSpec.tables": {
        "tables.more": {"index": {"at": 1, "raw": "u8"}, "entries": {"gain": {"index": 1, "layout": {}}}},
        "commands.store.table": "more",
    },
    "EditionSpec.commands": {"commands.more": {"code": 0x70, "reply": "none"}},
    "EditionSpec.errata": {"errata": []},
    "Address.title": {"addresses.lamp.title": TEXT},
    "Address.about": {"addresses.lamp.about": TEXT},
    "Address.id": {"addresses.lamp.id": "0x110 + node"},
    "Address.request": {
        "addresses.lamp.id": None,
        "addresses.lamp.request": "0x110 + node",
        "addresses.lamp.reply": "0x100 + node",
    },
    "Address.reply": {
        "addresses.lamp.id": None,
        "addresses.lamp.request": "0x100 + node",
        "addresses.lamp.reply": "0x110 + node",
    },
    "Address.nodes": {"addresses.lamp.nodes": "1..5"},
    "Address.selector": {"addresses.all.selector": {"at": 7, "raw": "u8"}},
    "Address.reply_selector": {"addresses.lamp.reply_selector": {"at": 7, "raw": "u8"}},
    "Address.extended": {"addresses.lamp.extended": True},
    "Address.manual": {"addresses.lamp.manual": "9"},
    "Bus.host": {"bus.host": "Desk"},
    "Bus.dlc": {"bus.dlc": 7},
    "Bus.max_nodes": {"bus.max_nodes": 3},
    "Bus.reply_within_ms": {"bus.reply_within_ms": 2},
    "Bus.modes": {"bus.modes.more": {"bit_rates_kbps": [20]}},
    "Bus.manual": {"bus.manual": "9"},
    "Command.title": {"commands.dim.title": TEXT},
    "Command.about": {"commands.dim.about": TEXT},
    "Command.code": {"commands.dim.code": 0x70},
    "Command.address": {"commands.dim.address": "all"},
    "Command.mode": {"commands.dim.mode": "broadcast"},
    "Command.table": {"commands.store": {"code": 0x13, "reply": "echo"}},
    "Command.manual": {"commands.dim.manual": "9"},
    "Command.only": {"commands.dim.only": {"size": ["big"]}},
    "Command.implemented": {"commands.dim.implemented": False},
    "Command.request": {"commands.colours.request": "none"},
    "Command.reply": {"commands.dim.reply": "none"},
    "Command.effects": {"commands.dim.effects": ["glows"]},
    "Command.limited_by": {"commands.dim.limited_by": []},
    "Command.not_limited_by": {"commands.read.not_limited_by": []},
    "Command.notes": {"commands.dim.notes": [TEXT]},
    "EffectSpec.title": {"effects.glows.title": TEXT},
    "EffectSpec.about": {"effects.glows.about": TEXT},
    "EffectSpec.level": {"effects.glows.level": "danger"},
    "Entry.title": {"tables.store.entries.gain.title": TEXT},
    "Entry.about": {"tables.store.entries.gain.about": TEXT},
    "Entry.manual": {"tables.store.entries.gain.manual": "9"},
    "Entry.index": {"tables.store.entries.gain.index": 9},
    "Entry.layout": {"tables.store.entries.gain.layout": {"gain": {"at": 5, "raw": "u16"}}},
    "Entry.dlc": {"tables.store.entries.gain.dlc": 7},
    "Entry.only": {"tables.store.entries.state.only": {"size": ["small", "big"]}},
    "Entry.effects": {"tables.store.entries.gain.effects": []},
    "Entry.kind": {
        "tables.store.entries.gain.kind": "wide",
        "tables.store.entries.state.kind": "slim",
        "commands.store.code": {"wide": 0x13, "slim": 0x70},
    },
    "Entry.commands": {
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
    "FieldSpec.type": {"commands.colours.reply.colours.type": "state"},
    "FieldSpec.raw": {"tables.store.entries.gain.layout.gain.raw": "i16"},
    "FieldSpec.byte_order": {"tables.store.entries.gain.layout.gain.byte_order": "big"},
    "FieldSpec.array": {"commands.colours.reply.colours.array": "1..4"},
    "FieldSpec.only": {"commands.dim.request.small.only": {"size": ["big"]}},
    "FieldSpec.constant": {"commands.read.request.fixed.constant": 4},
    "FieldSpec.reserved": {"commands.read.request.fixed.constant": None, "commands.read.request.fixed.reserved": 3},
    "FieldSpec.holds": {"tables.store.entries.gain.layout.gain.holds": "node"},
    "FieldSpec.manual": {f"{FIELD}.manual": "9"},
    "Flag.title": {"types.state.flags.hot.title": TEXT},
    "Flag.about": {"types.state.flags.hot.about": TEXT},
    "Flag.bit": {"types.state.flags.hot.bit": 1},
    "LayoutSpec.title": {"layouts.status.title": TEXT},
    "LayoutSpec.about": {"layouts.status.about": TEXT},
    "LayoutSpec.fields": {"layouts.status.fields.more": {"at": 5, "raw": "u8"}},
    "LayoutSpec.manual": {"layouts.status.manual": "9"},
    "Member.title": {"types.colour.enum.red.title": TEXT},
    "Member.about": {"types.colour.enum.red.about": TEXT},
    "Member.value": {"types.colour.enum.red.value": 3},
    "MessageSpec.layout": {"commands.all.reply.layout": {}},
    "MessageSpec.fields": {"commands.all.reply.fields": {"more": {"at": 5, "raw": "u8"}}},
    "MessageSpec.of": {"commands.turn.reply": {"of": "colours"}},
    "MessageSpec.from_each": {"commands.all.reply.from_each": "1..2"},
    "MessageSpec.code": {"commands.all.reply.code": 0x71},
    "MessageSpec.accept": {"commands.all.reply.accept": [0x71]},
    "MessageSpec.address": {"commands.read.request": {"address": "all"}},
    "MessageSpec.dlc": {"commands.all.reply.dlc": 7},
    "MessageSpec.remote": {
        "addresses.calls": {"id": 0x700, "selector": {"at": "id.0", "raw": "u8"}},
        "commands.read.request": {"remote": True, "address": "calls"},
    },
    "Mode.title": {"bus.modes.usual.title": TEXT},
    "Mode.about": {"bus.modes.usual.about": TEXT},
    "Mode.bit_rates_kbps": {"bus.modes.usual.bit_rates_kbps": [500, 250]},
    "Mode.default_kbps": {"bus.modes.usual.default_kbps": None},
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
    "Table.title": {"tables.store.title": TEXT},
    "Table.about": {"tables.store.about": TEXT},
    "Table.manual": {"tables.store.manual": "9"},
    "Table.index": {"tables.store.index": {"at": 2, "raw": "u8"}},
    "Table.entries": {"tables.store.entries.more": {"index": 7, "layout": {}}},
    "Titled.title": {"parameters.size.values.big": {"title": TEXT}},
    "Titled.about": {"parameters.size.values.big": {"about": TEXT}},
    "Type.title": {"types.level.title": TEXT},
    "Type.about": {"types.level.about": TEXT},
    "Type.differs": {"types.level.differs": TEXT},
    "Type.raw": {"types.level.raw": "i16"},
    "Type.byte_order": {"types.level.byte_order": "big"},
    "Type.unit": {"types.level.unit": "V"},
    "Type.scale": {"types.level.scale": 0.2},
    "Type.offset": {"types.angle.offset": 2},
    "Type.raw_range": {"types.level.raw_range": "0..999"},
    "Type.range": {"types.angle.range": "-80..80"},
    "Type.enum": {"types.colour.enum.blue": {"value": 7}},
    "Type.flags": {"types.state.flags.wet": {"bit": 7}},
}
"""`Concept.key` to what is set in the spec, by dotted path; None takes a key away."""


def _keys() -> set[str]:
    schema = json_schema(EditionSpec)
    concepts = {schema["title"]: schema, **schema["$defs"]}
    return {f"{name}.{key}" for name, concept in concepts.items() for key in concept.get("properties", {})}


def _edition(folder: Path, changes: dict[str, Any]) -> Edition:
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
    return _edition(tmp_path_factory.mktemp("original"), {})


def test_every_key_is_known() -> None:
    assert {*CHANGES, *NOT_COMPARED} == _keys()
    assert not CHANGES.keys() & NOT_COMPARED.keys()
    assert recorded(RECORDED).keys() == CHANGES.keys()


@pytest.mark.parametrize(("key", "found"), recorded(RECORDED).items(), ids=recorded(RECORDED))
def test_a_change_of_a_key_is_found(key: str, found: str, original: Edition, tmp_path: Path) -> None:
    assert found != "none"
    assert findings(compare(original, _edition(tmp_path, CHANGES[key]))) == found


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        old = _edition(Path(made), {})
        record(RECORDED, {key: findings(compare(old, _edition(Path(made), CHANGES[key]))) for key in CHANGES})
