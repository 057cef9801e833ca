"""The replay is proven by breaking what it guards: every small change of the spec must make it fail."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.diagnostics import SpecError
from canwright.load import described
from canwright.targets import Described

from ..spec_texts import ROOT
from .adapters import ADAPTERS
from .runner import Runner

SPEC = ROOT / "spec/mwd_motor/v2.35.yaml"
ORIGINAL = described(SPEC)

Change = Callable[[dict[str, Any]], None]


def _set(path: tuple[str, ...], value: object) -> Change:
    def change(data: dict[str, Any]) -> None:
        _walk(data, path[:-1])[path[-1]] = value

    return change


def _drop(path: tuple[str, ...]) -> Change:
    def change(data: dict[str, Any]) -> None:
        del _walk(data, path[:-1])[path[-1]]

    return change


def _mutants(data: dict[str, Any]) -> Iterator[tuple[str, Change]]:
    """Every type, field, code, id and reply form of a spec, changed a little."""
    yield "byte_order", _set(("byte_order",), "big")
    yield "bus.dlc", _set(("bus", "dlc"), 7)
    for name, address in data["addresses"].items():
        yield (
            f"addresses.{name}.id",
            _set(("addresses", name, "id"), str(address["id"]).replace("0x1", "0x2").replace("640", "641")),
        )
        if "nodes" in address:
            low, high = address["nodes"].split("..")
            yield f"addresses.{name}.nodes+1", _set(("addresses", name, "nodes"), f"{low}..{int(high) + 1}")
            yield f"addresses.{name}.nodes-1", _set(("addresses", name, "nodes"), f"{low}..{int(high) - 1}")
            yield f"addresses.{name}.nodes0", _set(("addresses", name, "nodes"), f"0..{high}")
    for name, type_ in data["types"].items():
        yield from _type_mutants(("types", name), type_)
    for name, layout in data["layouts"].items():
        yield from _field_mutants(("layouts", name, "fields"), layout["fields"])
    for name, command in data["commands"].items():
        path = ("commands", name)
        if "code" in command:
            yield f"{name}.code", _set((*path, "code"), 0xE0)
        for half in ("request", "reply"):
            if isinstance(command.get(half), dict) and not {"layout", "of"} & set(command[half]):
                yield from _field_mutants((*path, half), command[half])
        if command["reply"] == "echo":
            yield f"{name}.reply none", _set((*path, "reply"), "none")
        if isinstance(command["reply"], dict) and "accept" in command["reply"]:
            yield f"{name}.reply.code", _set((*path, "reply", "code"), command["code"])
            yield f"{name}.reply.accept", _set((*path, "reply", "accept"), [])
        if isinstance(command["reply"], dict) and "from_each" in command["reply"]:
            yield f"{name}.reply.from_each+1", _set((*path, "reply", "from_each"), "1..5")
            yield f"{name}.reply.from_each-1", _set((*path, "reply", "from_each"), "1..3")


def _type_mutants(path: tuple[str, ...], type_: dict[str, Any]) -> Iterator[tuple[str, Change]]:
    name, raw = ".".join(path), type_["raw"]
    yield f"{name} sign", _set((*path, "raw"), ("u" if raw[0] == "i" else "i") + raw[1:])
    if int(raw[1:]) > 8:
        yield f"{name} order", _set((*path, "byte_order"), "big")
        yield f"{name} width", _set((*path, "raw"), f"{raw[0]}{int(raw[1:]) - 8}")
    if "enum" not in type_ and "flags" not in type_:
        yield f"{name} offset", _set((*path, "offset"), 1)
    scale = type_.get("scale", 1)
    if isinstance(scale, dict):
        for case in scale:
            if case != "by" and scale[case] != "none":
                yield f"{name} scale {case}", _set((*path, "scale", case), 2)
        if "MH" in scale:
            yield f"{name} scale MH", _set((*path, "scale", "MH"), 1)
    elif "enum" not in type_ and "flags" not in type_:
        yield f"{name} scale", _set((*path, "scale"), 2 if scale == 1 else 1)
    limits = type_.get("raw_range")
    if isinstance(limits, dict):
        for case in limits:
            if case != "by":
                yield f"{name} raw_range {case}", _set((*path, "raw_range", case), "0..9")
    elif limits is not None:
        low, high = limits.split("..")
        yield f"{name} raw_range", _drop((*path, "raw_range"))
        for changed in [f"{int(low) - 1}..{high}", f"{int(low) + 1}..{high}"] if low != "0" else [f"1..{high}"]:
            yield f"{name} raw_range {changed}", _set((*path, "raw_range"), changed)
        if high.lstrip("-").isdigit():
            for changed in (f"{low}..{int(high) - 1}", f"{low}..{int(high) + 1}"):
                yield f"{name} raw_range {changed}", _set((*path, "raw_range"), changed)
        else:
            yield f"{name} raw_range bound", _set((*path, "raw_range"), f"{low}..{high[:-2]}")
    for kind, key in (("enum", "value"), ("flags", "bit")):
        for member, one in type_.get(kind, {}).items():
            yield f"{name} {member}", _set((*path, kind, member, key), one[key] + 2)


def _field_mutants(path: tuple[str, ...], fields: dict[str, Any]) -> Iterator[tuple[str, Change]]:
    for name, field in fields.items():
        yield f"{'.'.join(path)}.{name} gone", _drop((*path, name))
        for at in {field["at"] - 1, field["at"] + 1} - {-1}:
            yield f"{'.'.join(path)}.{name} at {at}", _set((*path, name, "at"), at)
        if "only" in field:
            yield f"{'.'.join(path)}.{name} only", _drop((*path, name, "only"))
    for one, other in zip(list(fields), list(fields)[1:], strict=False):
        if fields[one]["at"] == fields[other]["at"]:
            continue  # two fields of different variants in one place: swapping them changes nothing
        yield f"{'.'.join(path)} {one}<->{other}", _swap(path, one, other)


def _swap(path: tuple[str, ...], one: str, other: str) -> Change:
    def change(data: dict[str, Any]) -> None:
        fields = _walk(data, path)
        fields[one]["at"], fields[other]["at"] = fields[other]["at"], fields[one]["at"]

    return change


def _walk(data: dict[str, Any], path: tuple[str, ...]) -> dict[str, Any]:
    for step in path:
        data = data[step]
    return data


DATA: dict[str, Any] = yaml.safe_load(SPEC.read_text("utf-8").replace("date: 2023-03", "date: '2023-03'"))
MUTANTS = dict(_mutants(DATA))


def _changed(change: Change, folder: Path) -> Described | None:
    """The changed edition with the golden frames as they are; None when the change is refused as no edition at all."""
    data = copy.deepcopy(DATA)
    change(data)
    for erratum in data["errata"]:
        erratum["where"] = ["types"]
    file = folder / SPEC.name
    file.write_text(yaml.safe_dump(data, allow_unicode=True, sort_keys=False), "utf-8")
    try:
        return Described(described(file).edition, ORIGINAL.frames)
    except SpecError:
        return None


def _replay(item: Described, target: str, folder: Path) -> list[str]:
    assert item.frames is not None
    return Runner(item.edition, item.frames, ADAPTERS[target](item, folder), stop_at_first=True).run().failures


def test_the_unchanged_spec_passes(tmp_path: Path) -> None:
    item = _changed(lambda data: None, tmp_path)
    assert item is not None
    assert _replay(item, "python", tmp_path) == []


@pytest.mark.parametrize("mutant", MUTANTS)
def test_a_changed_spec_fails(mutant: str, tmp_path: Path) -> None:
    item = _changed(MUTANTS[mutant], tmp_path)
    assert item is None or _replay(item, "python", tmp_path), f"{mutant} survives: a golden frame is missing"


SOME = (
    "byte_order",
    "types.voltage sign",
    "types.voltage scale",
    "types.torque_current scale MG",
    "types.torque_current raw_range",
    "types.speed offset",
    "layouts.status_1.fields.voltage at 4",
    "set_speed.code",
)


@pytest.mark.parametrize("target", ["c", "dbc", "docs"])
@pytest.mark.parametrize("mutant", SOME)
def test_every_target_notices(mutant: str, target: str, tmp_path: Path) -> None:
    item = _changed(MUTANTS[mutant], tmp_path)
    assert item is not None
    assert _replay(item, target, tmp_path), f"{mutant} survives in {target}"
