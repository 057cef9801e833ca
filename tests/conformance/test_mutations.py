"""The replay is proven by breaking what it guards: every small change of a spec must make it fail."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.conformance.adapter import Adapter, assignment
from canwright.conformance.runner import Runner
from canwright.diagnostics.diagnostic import DocumentPath, Severity, SpecError
from canwright.document.document import Document, read_document
from canwright.language.decoder import decode
from canwright.language.edition import EditionSpec
from canwright.model.edition import Edition
from canwright.model.golden_frames import GoldenFrame, GoldenFrames, RefusedValues
from canwright.project.loader import specification
from canwright.rules import exchange_contradiction, frame_contradiction, refused_contradiction
from canwright.rules.rule import CheckInput
from canwright.semantics.encoder import Encoder
from canwright.targets.base import EditionInput

from ..spec_texts import SMALL, SPECS, called
from .adapters import ADAPTERS
from .mutants import MESSAGE_KEYS, Change, mutants

COMPLETE = 120
"""So many mutants of one spec, evenly spread over it, are replayed by `pytest -m exhaustive`."""

MOST = 4
"""So many of them are always replayed through the reference decoder, and one of each kind."""

GENERATED = 2
"""So many of the latter, evenly spread, are always replayed through generated code as well."""

EVERYWHERE = {
    "mwd_motor/v2.35": ("types.torque_current.scale.MG 1",),
    "blower/v1": ("types.speed.byte_order big", "commands.set_speed.request.trim.raw u16"),
    "arm/v1": (
        "types.torque.scale t_max as v_max",
        "types.position.scale p_max as twice",
        "types.speed.scale v_max as 1",
    ),
    "joint/v1": ("types.torque.scale 1",),
    "mixer/v2-2024-02": ("types.tone.offset 1", "types.level.scale 1"),
    "press/v1": ("commands.identify.code 5",),
    "pump/v1": ("types.charge.byte_order little", "commands.status.reply current<->duty"),
}
"""What the targets are shown that take longer."""

OF_ALL_FRAMES = {"addresses", "bus", "byte_order", "selector"}
"""The keys of an edition that can concern all its frames."""

OF_NAMES = {"addresses", "commands", "entries", "enum", "fields", "flags", "layout", "layouts", "names", "range"}
OF_NAMES |= {"raw_range", "scale", "tables", "types"}
"""The keys whose values have keys that a spec names."""

PLACE = {"overlap", "beyond-frame", "id-bits", "ambiguous-message"}
ID = {"id-space", "id-collision", "id-bits", "ambiguous-message", "value"}
REJECTIONS = {
    "at": PLACE,
    "bit": {"member-value"},
    "byte_order": {"overlap", "bit-runs"},
    "constant": {"duplicate-code", "ambiguous-message"},
    "counter": {"counter-field"},
    "dlc": {"beyond-frame", "checksum-field"},
    "enum": {"member-value"},
    "extended": {"id-space", "beyond-frame"},
    "flags": {"member-value", "overlap"},
    "from_each": {"unknown-node"},
    "gone": {"node-variable", "no-value", "overlap", "beyond-width", "ambiguous-message"},
    "id": ID,
    "index": {"code-width"},
    "kind": {"unknown-reference"},
    "names": {"member-value"},
    "nodes": {"unknown-node", "id-collision"},
    "offset": {"two-parameters", "beyond-width"},
    "range": {"beyond-width", "two-parameters"},
    "raw": {"code-width", "beyond-width", "beyond-frame", "overlap", "node-field", "member-value", "checksum-field"},
    "raw_range": {"beyond-width"},
    "remote": {"beyond-frame"},
    "reply": ID,
    "request": ID,
    "scale": {"two-parameters", "value"},
    "swapped": PLACE,
    "value": {"member-value"},
}
"""The rules that can reject a change of a key of the language."""

SIMILAR = 3
"""So many mutants of the kind of a rejected one are tried in its place."""

JUDGED = 2
"""So many mutants of each small spec that make a golden frame stale are asked what they make of every single one."""

FILES = {called(spec): spec for spec in SPECS}
DATA: dict[str, dict[str, Any]] = {called(spec): yaml.load(spec.read_text("utf-8"), yaml.CSafeLoader) for spec in SPECS}
MUTANTS = {name: dict(mutants(data)) for name, data in DATA.items()}


def _spread(names: Sequence[str], most: int) -> list[str]:
    step = max(1.0, len(names) / most)
    return [names[int(i * step)] for i in range(min(most, len(names)))]


def _names(steps: Sequence[str]) -> set[int]:
    """The places in a path of names that a spec gives; the other steps are keys of the language."""
    places: set[int] = set()
    for place, step in enumerate(steps[1:], 1):
        before = steps[place - 1]
        has_names = before in OF_NAMES or (before in ("request", "reply") and step not in MESSAGE_KEYS)
        if has_names and place - 1 not in places:
            places.add(place)
    return places


def _rejections(mutant: str) -> set[str]:
    """The rules that can reject a mutant."""
    *keys, change = _kind(mutant)
    return REJECTIONS[keys[-1] if change == "set" else change]


def _kind(mutant: str) -> tuple[str, ...]:
    """What is changed, in the keys of the language alone."""
    path, _, change = mutant.partition(" ")
    kind = "swapped" if "<->" in change else change if change in ("gone", "checked") else "set"
    steps = path.split(".")
    names = _names(steps)
    return (*(step for place, step in enumerate(steps) if place not in names), kind)


def _cases() -> Iterator[object]:
    seen: set[tuple[str, ...]] = set()
    for spec, changes in MUTANTS.items():
        names = [
            mutant for mutant in changes if "frames" not in _kind(mutant)
        ]  # how many frames come is in none of them
        complete = {*_spread(names, COMPLETE)}
        always = {*_spread(names, MOST)}
        for mutant in names:
            if _kind(mutant) not in seen:
                seen.add(_kind(mutant))
                always.add(mutant)
        generated = {*_spread([mutant for mutant in names if mutant in always], GENERATED)}
        for mutant in names:
            if mutant in always:
                yield _case(spec, mutant, ("reference", "python") if mutant in generated else ("reference",))
            if mutant in complete - generated:
                targets = ("python",) if mutant in always else ("reference", "python")
                yield _case(spec, mutant, targets, pytest.mark.exhaustive)


def _case(spec: str, mutant: str, targets: tuple[str, ...], *marks: pytest.MarkDecorator) -> object:
    return pytest.param(spec, mutant, targets, id=f"{spec}-{mutant}-{'-'.join(targets)}", marks=marks)


def _changed(spec: str, change: Change, folder: Path) -> EditionInput:
    """The changed edition with the golden frames as they are. Raises SpecError if the change is rejected."""
    data = copy.deepcopy(DATA[spec])
    change(data)
    for erratum in data.get("errata", ()):
        erratum["where"] = ["commands"]
    file = folder / "changed.yaml"
    file.write_text(json.dumps(data, ensure_ascii=False, indent=1), "utf-8")  # YAML as well, and written fast
    return EditionInput(specification(file).edition, specification(FILES[spec]).frames)


def _accepted(spec: str, mutant: str, folder: Path) -> tuple[str, EditionInput]:
    """The mutant, or if it is rejected some of its kind, then those that follow: a rejected spec replays nothing."""
    names = list(MUTANTS[spec])
    at = names.index(mutant)
    following = [*names[at + 1 :], *names[:at]]
    similar = [name for name in following if _kind(name) == _kind(mutant)]
    for name in (mutant, *similar[:SIMILAR], *following):
        try:
            return name, _changed(spec, MUTANTS[spec][name], folder)
        except SpecError as error:
            _check_rejection(name, error, read_document(folder / "changed.yaml")[0])
    raise AssertionError(f"all mutants of {spec} are rejected")


def _replay(item: EditionInput, target: str, folder: Path) -> list[str]:
    """What fails. A golden frame that cannot even be asked for, as its field or command is gone, fails too."""
    assert item.frames is not None
    adapter = ADAPTERS[target].create(item, folder)
    asked, gone = _asked(item.edition, item.frames)
    return [*map(str, Runner(item.edition, asked, adapter, stop_at_first=True).run().failures)] or gone


def _asked(edition: Edition, frames: GoldenFrames) -> tuple[GoldenFrames, list[str]]:
    """The golden frames whose messages and fields an edition has, and the commands of the others."""
    kept: dict[str, list[Any]] = {"frames": [], "refused": [], "exchanges": []}
    gone = []
    for key, entries in kept.items():
        for entry in getattr(frames, key):
            if _has_message(edition, entry):
                entries.append(entry)
            else:
                gone.append(f"{entry.command} is gone, or one of its fields")
    return replace(frames, **kept), gone  # type: ignore[arg-type]


def _has_message(edition: Edition, entry: object) -> bool:
    """Whether the message of a golden frame exists with exactly its fields, if parameters do not keep that open."""
    if not isinstance(entry, (GoldenFrame, RefusedValues)):
        return True
    direction = entry.direction if isinstance(entry, GoldenFrame) else entry.encode
    command = next((command for command in edition.commands if command.name == entry.command), None)
    message = command.message(direction) if command else None
    if message is None:
        return False
    fields = Encoder(assignment(entry.parameters)).fields(message)
    if fields is None:
        return True
    are_arrays = all(
        isinstance(raw, list) is fields[name].is_array for name, raw in entry.raw.items() if name in fields
    )
    return set(entry.raw or entry.values) == set(fields) and are_arrays


def _says_the_same(edition: Edition, changed: Edition) -> bool:
    """Whether a change changes no more than how a spec is written."""
    return repr(replace(edition, errata=())) == repr(replace(changed, errata=()))


@pytest.mark.parametrize("spec", FILES)
def test_the_replay_of_an_unchanged_spec_passes(spec: str, tmp_path: Path) -> None:
    item = _changed(spec, lambda data: None, tmp_path)
    assert item.frames is not None
    assert _says_the_same(item.edition, specification(FILES[spec]).edition)
    assert _asked(item.edition, item.frames) == (item.frames, [])
    assert Runner(item.edition, item.frames, ADAPTERS["python"].create(item, tmp_path)).run().failures == []


@pytest.mark.parametrize(("spec", "mutant", "targets"), list(_cases()))
def test_the_replay_of_a_changed_spec_fails(spec: str, mutant: str, targets: tuple[str, ...], tmp_path: Path) -> None:
    accepted, item = _accepted(spec, mutant, tmp_path)
    assert targets and not _says_the_same(item.edition, specification(FILES[spec]).edition)
    for target in targets:
        assert _replay(item, target, tmp_path), f"{accepted} survives in {spec}, {target}: a golden frame is missing"


@pytest.mark.parametrize(
    ("claimed", "complaint"),
    [
        ("types.level.scale 2", "by another rule"),
        ("layouts.state.fields.lamp.at 4", "elsewhere"),
        ("commands.set_levels.request channel<->levels", "elsewhere"),
    ],
)
def test_a_rejection_for_an_unrelated_reason_is_noticed(claimed: str, complaint: str, tmp_path: Path) -> None:
    spec = "mixer/v2-2024-02"
    with pytest.raises(SpecError) as rejected:
        _changed(spec, MUTANTS[spec]["commands.mute_group.reply.layout.volume.at 1"], tmp_path)
    with pytest.raises(AssertionError, match=complaint):
        _check_rejection(claimed, rejected.value, read_document(tmp_path / "changed.yaml")[0])


def _check_rejection(mutant: str, error: SpecError, document: Document) -> None:
    """Every finding has a rule that can reject such a change, and is at an affected line; further off, it names the item."""
    changed = tuple(mutant.partition(" ")[0].split("."))
    names = {f"`{changed[place]}`" for place in _names(changed)}
    part = changed[:2] if changed[0] == "commands" else changed[:-1]
    near, far = (_affected_lines(document, changed, whole) for whole in (part, changed[:2]))
    errors = [finding for finding in error.diagnostics if finding.severity is Severity.ERROR]
    assert errors
    for finding in errors:
        assert finding.rule in _rejections(mutant), f"{mutant} is rejected by another rule: {finding}"
        named = any(name in finding.message for name in names)
        about = {finding.position.line, *(related.position.line for related in finding.related)}
        assert about & (far if named else near), f"{mutant} is rejected elsewhere: {finding}"


def _affected_lines(document: Document, changed: tuple[str, ...], part: DocumentPath) -> set[int]:
    """The lines of a changed part, of the items that refer to it by name, and of those that it refers to."""
    items = list(_items(document.data))
    if changed[0] in OF_ALL_FRAMES:
        parts: set[DocumentPath] = {()}
    else:
        users = {path[:-1] for path, value in items if value == changed[1] and len(path) > 2}
        layouts = {path[1] for path in users if path[0] == "layouts"}
        users |= {path[:-1] for path, value in items if str(value) in layouts and path[0] == "commands"}
        used = {value for path, value in items if path[:2] == changed[:2] and isinstance(value, str)}
        parts = {part, *users, *(path for path, _ in items if len(path) == 2 and path[1] in used)}
    affected = (path for path, _ in items if any(path[: len(part)] == part for part in parts))
    return {document.position(path, key=True).line for path in affected}


def _items(data: object, path: DocumentPath = ()) -> Iterator[tuple[DocumentPath, object]]:
    """Everything in a document with its path."""
    yield path, data
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield from _items(value, (*path, key))


@pytest.mark.parametrize("target", ["c", "dbc", "docs", "javascript"])
@pytest.mark.parametrize(("spec", "mutant"), [(spec, mutant) for spec, some in EVERYWHERE.items() for mutant in some])
def test_the_replay_of_a_changed_spec_fails_in_every_target(
    spec: str, mutant: str, target: str, tmp_path: Path
) -> None:
    item = _changed(spec, MUTANTS[spec][mutant], tmp_path)
    assert _replay(item, target, tmp_path), f"{mutant} survives in {target}"


def _judged(item: EditionInput, file: Path) -> dict[tuple[str | int, ...], str]:
    """What `check` says of the golden frames, by list and place in it."""
    spec = decode(read_document(file)[0], EditionSpec).value
    assert spec is not None
    subject = CheckInput(item.edition, spec, item.frames)
    rules = (frame_contradiction, refused_contradiction, exchange_contradiction)
    return {finding.path[:2]: finding.message for rule in rules for finding in rule.check(subject)}


def _fails(item: EditionInput, adapter: Adapter, key: str, entry: object) -> bool:
    """Whether one golden frame fails when it is replayed by itself, or cannot be asked for."""
    assert item.frames is not None
    entries: dict[str, Any] = {"frames": [], "refused": [], "exchanges": [], key: [entry]}
    asked, gone = _asked(item.edition, replace(item.frames, **entries))
    return bool(gone or Runner(item.edition, asked, adapter).run().failures)


@pytest.mark.parametrize("spec", [called(spec) for spec in SMALL])
def test_check_reports_the_golden_frames_that_fail_in_a_replay(spec: str, tmp_path: Path) -> None:
    """Of every golden frame, when the spec is changed and they are not; so no replay is needed to find what is stale."""
    seen = 0
    for name in _spread(list(MUTANTS[spec]), COMPLETE):
        if seen == JUDGED:
            break
        try:
            item = _changed(spec, MUTANTS[spec][name], tmp_path)
        except SpecError:
            continue  # no golden frame is judged then
        assert item.frames is not None
        judged = _judged(item, tmp_path / "changed.yaml")
        seen += bool(judged)
        adapter = ADAPTERS["python"].create(item, tmp_path)
        for key in ("frames", "refused", "exchanges"):
            for i, entry in enumerate(getattr(item.frames, key)):
                said = judged.get((key, i), "")
                if not said.startswith("there is no field"):  # that is said, too, of what is refused for its node
                    assert bool(said) is _fails(item, adapter, key, entry), f"{name}: {key} {i}: {said or 'nothing'}"
    assert seen
