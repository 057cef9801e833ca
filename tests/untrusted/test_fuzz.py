"""Every spec gives either findings or files."""

from __future__ import annotations

import copy
import functools
import json
import operator
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.diagnostics.diagnostic import SpecError
from canwright.project.loader import load
from canwright.project.pipeline import generate
from canwright.targets.registry import default_targets
from hypothesis import HealthCheck, given, settings, strategies as st

from ..spec_texts import MINIMAL, ROOT
from .everything import filled
from .hostile import HARMLESS, HOSTILE, REFUSED

CHANCES = st.integers(0, 1 << 32).map(random.Random)
"""A seed, and not draws one by one: those Hypothesis keeps simple, and most mutants would be alike."""

Data = Any
Steps = tuple[str | int, ...]

MAIN = ROOT / "spec/mwd_motor/v2.35.yaml"


def bounded(examples: int) -> settings:
    return settings(max_examples=examples, suppress_health_check=[HealthCheck.function_scoped_fixture])


ODD: tuple[Data, ...] = (
    *(
        0,
        1,
        -1,
        2,
        7,
        8,
        255,
        256,
        65536,
        10**30,
        -(10**30),
        0.1,
        -0.5,
        1e-9,
        True,
        False,
        "",
        "x",
        " ",
        "none",
        "echo",
        "entry",
    ),
    *(
        "0..0",
        "1..4",
        "5..1",
        "-1..1",
        "0..65535",
        "0..99999999",
        "1..2*count",
        "-9*x-1..9*x+1",
        "1/3",
        "1/0",
        "1e9",
        "nan",
    ),
    *(
        "u1",
        "u64",
        "i1",
        "i64",
        "f32",
        "f64",
        "u0",
        "u65",
        "id.0",
        "id.28",
        "id.29",
        "7.7",
        "63",
        "64",
        "0x7FF",
        "0x1FFFFFFF",
    ),
    *(
        "node",
        "node << 0",
        "node << 28",
        "node + node",
        "0x100 + node << 3",
        "../../x",
        ".",
        "..",
        "con",
        "v1",
        "lamp",
        "a" * 49,
    ),
    *(
        "class",
        "int",
        "__init__",
        "self",
        "BO_",
        "little",
        "big",
        [],
        {},
        [1],
        [[]],
        {"x": 1},
        ["x", "x"],
        {"by": "size"},
    ),
)


def outcome(file: Path) -> str:
    """`made` or `refused`; anything else is raised."""
    try:
        specifications = load(file).specification
        files = generate([specifications], default_targets(), {}).files
    except SpecError as error:
        assert error.diagnostics
        assert all(finding.message and finding.position.line for finding in error.diagnostics)
        return "refused"
    for path, content in files.items():
        if path.endswith(".py"):
            _compile(content)
    return "made"


@functools.lru_cache
def _compile(source: bytes) -> None:
    """Most files are those of the last example."""
    compile(source, "generated.py", "exec")


def mutated(data: Data, chance: random.Random) -> Data:
    """A copy where one or several places are deleted, repeated, renamed, moved, or say something else."""
    data = copy.deepcopy(data)
    for _ in range(chance.choice((1, 1, 1, 2, 5))):
        places = list(_places(data))
        if places:
            _change(data, chance.choice(places), places, chance)
    return data


def _places(data: Data, path: Steps = ()) -> Iterator[Steps]:
    entries = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in entries:
        yield (*path, key)
        yield from _places(value, (*path, key))


def _at(data: Data, path: Steps) -> Data:
    return functools.reduce(operator.getitem, path, data)


def _change(data: Data, path: Steps, places: list[Steps], chance: random.Random) -> None:
    owner: Data = _at(data, path[:-1])
    key: Any = path[-1]
    how = chance.randrange(6)
    if how == 0:
        del owner[key]
    elif how == 1:
        owner[key] = chance.choice(ODD)
    elif how == 2:
        owner[key] = copy.deepcopy(_at(data, chance.choice(places)))
    elif how == 3 and isinstance(owner, dict):
        owner[chance.choice([str(place[-1]) for place in places] + ["x", "1", "entry"])] = owner.pop(key)
    elif how == 4 and isinstance(owner, dict):
        owner[str(chance.choice(places)[-1])] = copy.deepcopy(owner[key])
    elif isinstance(owner, list):
        owner.append(copy.deepcopy(owner[key]))
    else:
        owner[key] = chance.choice(HOSTILE + REFUSED)


def written(data: Data) -> str:
    """Data as YAML; numbers and texts stay what they are."""
    return json.dumps(data, indent=1, ensure_ascii=False)


@pytest.fixture(scope="module")
def everything(tmp_path_factory: pytest.TempPathFactory) -> tuple[Data, Data]:
    """The spec with all the language has, and its golden frames."""
    folder = tmp_path_factory.mktemp("everything")
    filled(lambda: HARMLESS, folder)
    return read(folder / "lamp.yaml"), read(folder / "lamp.frames.yaml")


@pytest.fixture(scope="module")
def large() -> tuple[Data, Data]:
    return read(MAIN), read(MAIN.with_name("v2.35.frames.yaml"))


def read(file: Path) -> Data:
    return yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)


def try_out(folder: Path, spec: Data, frames: Data | None) -> str:
    (folder / "x.yaml").write_text(written(spec), "utf-8")
    (folder / "x.frames.yaml").unlink(missing_ok=True)
    if frames is not None:
        (folder / "x.frames.yaml").write_text(written(frames), "utf-8")
    return outcome(folder / "x.yaml")


@bounded(150)
@given(st.binary(max_size=200) | st.text(max_size=200).map(lambda text: text.encode("utf-8", "surrogatepass")))
def test_any_bytes_give_findings_or_files(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "bytes.yaml"
    for whole in (content, MINIMAL.encode()[: len(content) * 3] + content, MINIMAL.encode() + content):
        file.write_bytes(whole)
        outcome(file)


@bounded(250)
@given(CHANCES)
def test_a_small_spec_with_random_mistakes_has_findings_or_loads(tmp_path: Path, chance: random.Random) -> None:
    try_out(tmp_path, mutated(yaml.load(MINIMAL, yaml.CSafeLoader), chance), None)


@pytest.mark.parametrize("values", ["[small]", "[big]", "[small, big]"])
def test_a_value_may_have_no_fields(values: str, tmp_path: Path) -> None:
    text = MINIMAL.replace("at: 2,", f"at: 2, only: {{size: {values}}},")
    (tmp_path / "x.yaml").write_text(f"{text}parameters: {{size: {{values: {{small: {{}}, big: {{}}}}}}}}\n", "utf-8")
    assert outcome(tmp_path / "x.yaml") == "made"


@bounded(90)
@given(CHANCES, st.booleans())
def test_a_spec_of_everything_with_mistakes(
    everything: tuple[Data, Data], tmp_path: Path, chance: random.Random, in_frames: bool
) -> None:
    spec, frames = everything
    try_out(tmp_path, spec if in_frames else mutated(spec, chance), mutated(frames, chance) if in_frames else frames)


@bounded(24)
@given(CHANCES)
def test_a_large_spec_with_mistakes(large: tuple[Data, Data], tmp_path: Path, chance: random.Random) -> None:
    spec, frames = large
    try_out(tmp_path, mutated(spec, chance), frames)
