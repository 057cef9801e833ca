"""Every key of the language reaches an output: a generated file, or for golden frames also a finding of `check`."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.diagnostics.diagnostic import SpecError
from canwright.language.edition import EditionSpec, json_schema
from canwright.language.golden_frames import GoldenFramesSpec
from canwright.project.loader import load
from canwright.project.pipeline import generate
from canwright.targets.registry import default_targets

from ..compare.test_every_key import CHANGES, TEXT
from ..untrusted.everything import FRAMES, SPEC

NOT_SHOWN = {
    "EditionSpec.canwright": "the version of the language",
    "GoldenFramesSpec.canwright": "the version of the language",
    "TypeSpec.plausible": "for `identify` and `decode`, see tests/recordings/test_identify.py",
    **{
        f"{concept}.renamed_from": "for `diff`, see tests/compare/test_renames.py"
        for concept in ("CommandSpec", "EntrySpec", "FieldSpec", "FlagSpec", "MemberSpec", "NameSpec", "NoValueSpec")
    },
}

NOT_SHOWN |= {
    f"{concept}.{key}": "for readers of the golden frames"
    for concept in ("ExchangeSpec", "RefusedFrameSpec", "RefusedValuesSpec")
    for key in ("manual", "note")
}

OF_EDITION: dict[str, dict[str, Any]] = {
    **{key: changes for key, changes in CHANGES.items() if key not in NOT_SHOWN},
    "EditionSpec.family": {"family": "torch"},
    "EditionSpec.edition": {"edition": "v2"},
    "EditionSpec.date": {"date": "2024-01"},
    "ErratumSpec.where": {"errata.0.where": ["commands.read"]},
}
"""`Concept.key` to what is set in the spec, by dotted path; None takes a key away."""

REQUEST = {"id": 0x101, "data": "11 03 00 00 00 00 00 00"}
FRAME, REFUSED, VALUES, EXCHANGE = "frames.0", "refused.0", "refused.1", "exchanges.0"
OF_FRAMES: dict[str, dict[str, Any]] = {
    "GoldenFramesSpec.family": {"family": "torch"},
    "GoldenFramesSpec.edition": {"edition": "v2"},
    "GoldenFramesSpec.sources": {"sources": {"paper": TEXT}},
    "GoldenFramesSpec.frames": {"frames": []},
    "GoldenFramesSpec.refused": {
        "refused": [REQUEST | {"decode": "request", "source": "manual", "says": "unknown_id"}]
    },
    "GoldenFramesSpec.exchanges": {
        "exchanges": [{"source": "manual", "request": REQUEST, "reply": REQUEST | {"id": 0x102}}]
    },
    "CheckedFrameSpec.id": {f"{EXCHANGE}.reply.id": 0x102},
    "CheckedFrameSpec.extended": {f"{EXCHANGE}.reply.extended": True},
    "CheckedFrameSpec.remote": {f"{EXCHANGE}.reply.remote": True},
    "CheckedFrameSpec.data": {f"{EXCHANGE}.reply.data": "11 01 64 00 00 00 00 00"},
    "ExchangeSpec.source": {f"{EXCHANGE}.source": "paper"},
    "ExchangeSpec.parameters": {f"{EXCHANGE}.parameters": {"size": "huge"}},
    "ExchangeSpec.request": {f"{EXCHANGE}.request": {"id": 0x102, "data": "10 01 64 00 00 00 00 00"}},
    "ExchangeSpec.reply": {f"{EXCHANGE}.reply": {"id": 0x102, "data": "10 01 64 00 00 00 00 00"}},
    "ExchangeSpec.says": {f"{EXCHANGE}.says": "not_answer"},
    "GoldenFrameSpec.source": {f"{FRAME}.source": "paper"},
    "GoldenFrameSpec.manual": {f"{FRAME}.manual": "9"},
    "GoldenFrameSpec.note": {f"{FRAME}.note": TEXT},
    "GoldenFrameSpec.parameters": {f"{FRAME}.parameters": {"count": 2}},
    "GoldenFrameSpec.request": {f"{FRAME}.request": "dim"},
    "GoldenFrameSpec.reply": {f"{FRAME}.reply": "turn"},
    "GoldenFrameSpec.id": {f"{FRAME}.id": 0x102},
    "GoldenFrameSpec.extended": {f"{FRAME}.extended": True},
    "GoldenFrameSpec.remote": {f"{FRAME}.remote": True},
    "GoldenFrameSpec.node": {f"{FRAME}.node": 2},
    "GoldenFrameSpec.data": {f"{FRAME}.data": "12 65 00 00 00 02 00 00"},
    "GoldenFrameSpec.raw": {f"{FRAME}.raw.angle": 101},
    "GoldenFrameSpec.values": {f"{FRAME}.values.angle": 3},
    "GoldenFrameSpec.decode_only": {f"{FRAME}.decode_only": True},
    "RefusedFrameSpec.source": {f"{REFUSED}.source": "paper"},
    "RefusedFrameSpec.parameters": {f"{REFUSED}.parameters": {"size": "huge"}},
    "RefusedFrameSpec.decode": {f"{REFUSED}.decode": "reply", f"{REFUSED}.id": 0x200},
    "RefusedFrameSpec.id": {f"{REFUSED}.id": 0x101},
    "RefusedFrameSpec.extended": {"refused.2.extended": None},
    "RefusedFrameSpec.remote": {"refused.3.remote": None},
    "RefusedFrameSpec.data": {f"{REFUSED}.id": 0x101, f"{REFUSED}.data": "11 03 00 00 00 00 00 00"},
    "RefusedFrameSpec.says": {f"{REFUSED}.says": "wrong_length"},
    "RefusedValuesSpec.source": {f"{VALUES}.source": "paper"},
    "RefusedValuesSpec.parameters": {f"{VALUES}.parameters": {"size": "huge"}},
    "RefusedValuesSpec.encode": {f"{VALUES}.encode": "reply"},
    "RefusedValuesSpec.command": {f"{VALUES}.command": "dim"},
    "RefusedValuesSpec.node": {f"{VALUES}.node": 9},
    "RefusedValuesSpec.raw": {f"{VALUES}.values": None, f"{VALUES}.raw": {"angle": 0}},
    "RefusedValuesSpec.values": {f"{VALUES}.values": {"angle": 0, "share": 0}},
    "RefusedValuesSpec.says": {f"{VALUES}.says": "no_scale"},
    "RefusedValuesSpec.field": {f"{VALUES}.field": "share"},
}

Files = Mapping[str, str]


def _keys(concept: type[EditionSpec] | type[GoldenFramesSpec]) -> set[str]:
    schema = json_schema(concept)
    concepts = {schema["title"]: schema, **schema["$defs"]}
    return {f"{name}.{key}" for name, definition in concepts.items() for key in definition.get("properties", {})}


def _output(folder: Path, of_edition: Mapping[str, Any], of_frames: Mapping[str, Any], *, golden: bool) -> Files:
    """Every generated file, with the same hash of the spec; with golden frames also what `check` finds."""
    spec = yaml.load(SPEC, yaml.CSafeLoader)
    spec["languages"] = ["en"]
    spec["errata"][0] |= {"manual": "1", "printed": "One.", "used": "Another.", "why": "It is so."}
    frames = yaml.load(FRAMES, yaml.CSafeLoader)
    frames["sources"] = {"manual": "A manual"}
    read = {
        "decode": "request",
        "source": "manual",
        "id": 0x101,
        "data": "11 03 00 00 00 00 00 00",
        "parameters": {"host_id": 1},
        "says": "unknown_id",
    }
    frames["refused"] += [read | {"extended": True}, read | {"remote": True}]
    for data, changes in ((spec, of_edition), (frames, of_frames)):
        for path, value in changes.items():
            _set(data, path, value)
    for name, data in (("spec.yaml", spec), ("spec.frames.yaml", frames)):
        (folder / name).write_text(json.dumps(data, indent=1), "utf-8")
    try:
        loaded = load(folder / "spec.yaml", "spec.yaml", for_output=golden)
    except SpecError as error:
        return {"check": str(error)}
    vars(loaded.specification.edition)["hash"] = "0" * 64  # instead of what it computes
    files = generate([loaded.specification], default_targets(), {}).files
    outputs = {"check": "\n".join(map(str, loaded.warnings))} if golden else {}
    return outputs | {path: content.decode("utf-8") for path, content in files.items()}


def _set(data: Any, path: str, value: object) -> None:
    *steps, last = [int(step) if step.isdigit() and step != "14" else step for step in path.split(".")]
    for step in steps:
        data = data[step]
    if value is None:
        del data[last]
    else:
        data[last] = copy.deepcopy(value)


@pytest.fixture(scope="module")
def unchanged(tmp_path_factory: pytest.TempPathFactory) -> Mapping[bool, Files]:
    """The output without and with golden frames."""
    folder = tmp_path_factory.mktemp("unchanged")
    output = {golden: _output(folder, {}, {}, golden=golden) for golden in (False, True)}
    assert "error" not in output[True]["check"]
    return output


def test_every_key_is_known() -> None:
    assert {*OF_EDITION, *OF_FRAMES, *NOT_SHOWN} == _keys(EditionSpec) | _keys(GoldenFramesSpec)
    assert not {*OF_EDITION, *OF_FRAMES} & {*NOT_SHOWN}


@pytest.mark.parametrize("key", OF_EDITION)
def test_a_key_of_an_edition_is_printed(key: str, unchanged: Mapping[bool, Files], tmp_path: Path) -> None:
    changed = _output(tmp_path, OF_EDITION[key], {}, golden=False)
    assert "check" not in changed, "the change makes the spec invalid"
    assert _shown(OF_EDITION[key], unchanged[False], changed), f"{key} {MISSING}"


@pytest.mark.parametrize("key", OF_FRAMES)
def test_a_key_of_golden_frames_is_printed_or_checked(
    key: str, unchanged: Mapping[bool, Files], tmp_path: Path
) -> None:
    changed = _output(tmp_path, {}, OF_FRAMES[key], golden=True)
    assert not re.search(r"\[(missing-key|type|unknown-key|value)\]", changed["check"]), "the change is not valid"
    assert _shown(OF_FRAMES[key], unchanged[True], changed), f"{key} {MISSING}"


MISSING = "reaches no output: print it, or list it with a reason in NOT_SHOWN"


def _shown(changes: Mapping[str, Any], unchanged: Files, changed: Files) -> list[str]:
    """The files in which a change appears; that of a text appears as the text."""
    differing = [path for path in changed if changed[path] != unchanged.get(path)]
    return [path for path in differing if TEXT in changed[path] or TEXT not in changes.values()]
