"""What is committed is what the specs say, and nothing in it belongs elsewhere."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from canwright.cli import main
from canwright.language.edition import EditionSpec, schema_text
from canwright.language.golden_frames import GoldenFramesSpec
from canwright.project.loader import frames_file, spec_files
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from ..own_targets import COMMAND
from ..spec_texts import ROOT, SMALL

FOREIGN = re.compile(r"motor(?!ola\b)|\biq\b|mwd|0x140|torque|\bseries\b|encoder_bits|\bM[FHG]\b", re.IGNORECASE)
SPECS = spec_files(ROOT / "spec")
MACHINE = re.compile(r"(^|[^A-Za-z0-9_.])/(home|root|work|tmp|Users)/")


def tracked(*folders: str) -> list[Path]:
    return [
        file
        for folder in folders
        for file in sorted((ROOT / folder).rglob("*"))
        if file.is_file() and "__pycache__" not in file.parts
    ]


def test_committed_output_equals_a_new_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    result = CliRunner().invoke(main, ["check"], catch_exceptions=False)
    assert result.exit_code == 0, result.output[:4000]


@pytest.mark.parametrize(
    ("name", "concept"), [("canwright.schema.json", EditionSpec), ("canwright.frames.schema.json", GoldenFramesSpec)]
)
def test_the_json_schema_is_that_of_the_language(
    name: str, concept: type[EditionSpec] | type[GoldenFramesSpec]
) -> None:
    text = (ROOT / "spec" / name).read_text("utf-8")
    assert text == schema_text(concept), f"run `canwright schema > spec/{name}`"


def test_the_json_schema_describes_every_key_and_allows_no_other() -> None:
    schema = json.loads((ROOT / "spec/canwright.schema.json").read_text("utf-8"))
    for name, concept in {"edition": schema, **schema["$defs"]}.items():
        if concept.get("type") != "object":
            continue
        assert "additionalProperties" in concept, name
        for key, value in concept["properties"].items():
            assert value.get("description"), f"{name}.{key}"


class _Loader(yaml.CSafeLoader):
    """Leaves dates as text, like the loader of the language."""

    yaml_implicit_resolvers = {
        key: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith(":timestamp")]
        for key, resolvers in yaml.CSafeLoader.yaml_implicit_resolvers.items()
    }


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("canwright.schema.json", [*SPECS, *SMALL]),
        ("canwright.frames.schema.json", [frames_file(file) for file in (*SPECS, *SMALL)]),
    ],
)
def test_specs_fit_the_json_schema(name: str, files: list[Path]) -> None:
    validator = Draft202012Validator(json.loads((ROOT / "spec" / name).read_text("utf-8")))
    for file in files:
        content = yaml.load(file.read_bytes(), _Loader)
        assert [error.message for error in validator.iter_errors(content)] == [], file


def test_generator_contains_no_word_of_the_protocol() -> None:
    for file in tracked("generator", "templates"):
        match = FOREIGN.search(file.read_text("utf-8", "replace"))
        assert not match, f"{file}: {match}"


def test_no_path_of_a_machine_is_committed() -> None:
    for file in tracked("generator", "templates", "spec", "generated", "tests"):
        if file != Path(__file__) and file.suffix in (
            ".py",
            ".j2",
            ".yaml",
            ".md",
            ".h",
            ".c",
            ".dbc",
            ".txt",
            ".json",
        ):
            assert not MACHINE.search(file.read_text("utf-8", "replace")), file


def test_output_is_the_same_whatever_the_hash_seed_and_the_locale(tmp_path: Path) -> None:
    trees = []
    for seed, locale in (("1", "C"), ("2", "C.UTF-8")):
        out = tmp_path / seed
        specs = [f"--spec={file}" for file in (SPECS[0], SPECS[-1])]
        command = [sys.executable, "-c", COMMAND, "generate", "--out", str(out), *specs]
        environment = {**os.environ, "PYTHONHASHSEED": seed, "LC_ALL": locale}
        subprocess.run(command, check=True, capture_output=True, cwd=ROOT, env=environment)
        trees.append({f.relative_to(out): f.read_bytes() for f in out.rglob("*") if f.is_file()})
    assert trees[0] == trees[1]


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_a_manual_is_cited_only_for_frames_that_it_can_print(spec: Path) -> None:
    """Tables of the manuals print whole frames without numbers; frames with numbers are computed."""
    golden = yaml.safe_load(frames_file(spec).read_text("utf-8"))
    cited = [item for items in (golden["frames"], golden["refused"], golden["exchanges"]) for item in items]
    for item in (item for item in cited if item["source"] == "manual"):
        assert "request" in item or "reply" in item, item
        assert not item.get("decode_only") and "parameters" not in item, item
        assert all(isinstance(value, str) for value in item.get("values", {}).values()), item


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_errata_name_other_editions_by_their_ids(spec: Path) -> None:
    """A label does not identify an edition, nor does "later"."""
    vague = re.compile(r"\bV\d|(?<!all )\b(?:later|earlier|other|another) editions?\b|后续版本|其他版本")
    for erratum in yaml.safe_load(spec.read_text("utf-8"))["errata"]:
        if erratum["id"] == "edition_label":
            continue
        for text in (text for key in ("printed", "used", "why") for text in erratum[key].values()):
            assert not vague.search(text.replace("All", "all")), (erratum["id"], text)


def test_c_headers_are_ascii() -> None:
    """Compilers disagree about the encoding of a source file, and some warn about other characters in comments."""
    headers = [file for file in tracked("generated/c") if file.suffix == ".h"]
    assert headers and [file.name for file in headers if not file.read_bytes().isascii()] == []
