"""The guides of the documents: their examples run as printed, and the API page lists the public API."""

from __future__ import annotations

import inspect
import itertools
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import canwright
import click
import pytest
from canwright.cli import main

from .spec_texts import ROOT

DOCS = ROOT / "generated/docs"
GUIDES = ("api", "compare-editions", "logs", "own-protocol")
LANGUAGES = ("en", "zh")


def blocks(guide: str, language: str = "en") -> list[tuple[str, str]]:
    """The code blocks of a guide: language and text."""
    page = (DOCS / language / f"{guide}.md").read_text("utf-8")
    return re.findall(r"^```(\w+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)


LAMP = next(text for language, text in blocks("own-protocol") if language == "yaml")


def run(command: str, folder: Path) -> str:
    """What a `canwright` command of a guide prints, in a folder of its own."""
    program, *arguments = shlex.split(command)
    assert program == "canwright"
    environment = {**os.environ, "NO_COLOR": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "canwright", *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode < 2, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the spec of the guides, as a file and as an edition of a project."""
    (tmp_path / "spec/lamp").mkdir(parents=True)
    for file in ("lamp.yaml", "spec/lamp/v1.yaml"):
        (tmp_path / file).write_text(LAMP, "utf-8")
    return tmp_path


@pytest.mark.parametrize("guide", GUIDES)
def test_all_languages_have_the_same_code_blocks(guide: str) -> None:
    assert blocks(guide, "zh") == blocks(guide, "en") != []


def test_spec_of_the_guides_generates_all_outputs(folder: Path) -> None:
    (command,) = (text for language, text in blocks("own-protocol") if language == "sh")
    run(command, folder)
    assert (folder / "out/c/include/lamp/v1.h").is_file()
    assert (folder / "out/docs/en/v1/index.md").is_file()


def test_line_of_a_pipeline_tests_a_new_spec(tmp_path: Path) -> None:
    line = blocks("own-protocol")[-1][1].strip()
    install, *commands = line.removeprefix("- run: ").split(" && ")
    assert install == "pip install tools/canwright-*.whl" and commands
    run("canwright init lamp", tmp_path)
    for command in commands:
        assert run(command, tmp_path) == "\n"  # no finding
    edited = tmp_path / "spec/lamp/v1.frames.yaml"
    edited.write_text(edited.read_text("utf-8").replace("speed: -30", "speed: -31"), "utf-8")
    assert "::error file=spec/lamp/v1.frames.yaml,line=11,col=99" in run(commands[-1], tmp_path)


def test_log_commands_print_what_the_guide_shows(folder: Path) -> None:
    (_, log), *rest = blocks("logs")
    (folder / "bus.log").write_text(log, "utf-8")
    pairs = [*zip(rest[::2], rest[1::2], strict=True)]
    printing = [(command, printed) for (_, command), (language, printed) in pairs if language == "text"]
    assert len(printing) == len(pairs) - 1 == 4
    for command, printed in printing:
        assert run(command, folder).strip() == printed.strip()


@pytest.mark.interop("mcap")
def test_layout_of_a_viewer_shows_what_the_command_before_it_writes(folder: Path) -> None:
    from mcap.reader import make_reader

    (_, log), *rest = blocks("logs")
    (folder / "bus.log").write_text(log, "utf-8")
    ((_, command), (_, layout)) = next(pair for pair in itertools.pairwise(rest) if pair[1][0] == "json")
    run(command, folder)
    with (folder / "bus.mcap").open("rb") as file:
        written = [(channel.topic, json.loads(m.data)) for _, channel, m in make_reader(file).iter_messages()]
    panels = json.loads(layout)["configById"].values()
    paths = [path["value"] for panel in panels for path in panel.get("paths", [])]
    shown = [re.fullmatch(r"([\w/]+)(?:\{frame\.(\w+)=='(\w+)'\})?\.(\w+)", path) for path in paths]
    values = [
        [
            content[path[4]]
            for topic, content in written
            if topic == path[1] and content["frame"].get(path[2]) == path[3]
        ]
        for path in shown
        if path
    ]
    assert values == [[50], [12.5]]
    assert {panel["topicPath"] for panel in panels if "topicPath" in panel} <= {topic for topic, _ in written}


def test_editions_are_copied_compared_and_accepted_as_the_guide_shows(folder: Path) -> None:
    (_, copy), (_, edited), (_, diff), (_, changes), (_, accept), (_, accepted), (_, configuration) = blocks(
        "compare-editions"
    )
    run(copy, folder)
    new = folder / "spec/lamp/v2.yaml"
    text, replaced = re.subn(r"(?m)^  level: .*\n", edited, new.read_text("utf-8"))
    assert replaced == 1
    new.write_text(text, "utf-8")
    assert run(diff, folder).strip() == changes.strip()
    run(accept, folder)
    assert (folder / "accepted.yaml").read_text("utf-8") == accepted
    (folder / "canwright.toml").write_text(configuration, "utf-8")
    assert "0 changes; 1 more accepted" in run(diff, folder)


def test_api_example_prints_what_the_guide_shows(folder: Path) -> None:
    (_, program), (_, printed), *_ = blocks("api")
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == (printed, "")


def test_target_of_the_api_guide_lists_the_commands(folder: Path) -> None:
    program = next(text for language, text in blocks("api") if "(Target)" in text)
    names: dict[str, canwright.Target] = {}
    exec(program, names)  # a page of this repository
    outputs = names["TARGET"].generate([canwright.load(folder / "lamp.yaml")], {}, canwright.Options())
    assert list(outputs) == [canwright.Output("lamp-v1.txt", "dim\nread_level\n")]


@pytest.mark.parametrize("language", LANGUAGES)
def test_api_guide_lists_exactly_the_public_names(language: str) -> None:
    page = (DOCS / language / "api.md").read_text("utf-8")
    names = re.findall(r"^- `(\w+)(?:\([^`]*)?`[:：]", page, re.MULTILINE)
    assert sorted(names) == sorted(canwright.__all__)


@pytest.mark.parametrize("language", LANGUAGES)
def test_api_guide_names_every_member_of_a_target(language: str) -> None:
    (line,) = re.findall(r"^- `Target`.*$", (DOCS / language / "api.md").read_text("utf-8"), re.MULTILINE)
    members = {*vars(canwright.Target), *canwright.Target.__annotations__}
    assert {*re.findall(r"`(\w+)`", line)} == {"Target", *(name for name in members if not name.startswith("_"))}


@pytest.mark.parametrize("language", LANGUAGES)
def test_api_guide_shows_the_arguments_of_functions_and_methods(language: str) -> None:
    page = (DOCS / language / "api.md").read_text("utf-8")
    shown = re.findall(r"^- `([\w.]+)\(([^`]*)\)`[:：]", page, re.MULTILINE)
    assert {name for name, _ in shown} >= {"load", "generate", "Decoder", "Encoder", "CanFrame"}
    for path, arguments in shown:
        first, *attributes = path.split(".")
        item = getattr(canwright, first)
        for attribute in attributes:
            item = getattr(item, attribute)
        parameters = [p for p in inspect.signature(item).parameters.values() if p.name != "self"]
        texts = [p.name if p.default is p.empty else f"{p.name}={p.default!r}" for p in parameters]
        assert ", ".join(texts) == arguments, path
    for first in {path.partition(".")[0] for path, _ in shown if "." in path}:
        methods = {name for name in vars(getattr(canwright, first)) if not name.startswith("_")}
        assert methods == {path.partition(".")[2] for path, _ in shown if path.startswith(f"{first}.")}


def pages_for_readers() -> list[Path]:
    """Pages that name commands: all but those of single editions, in all languages."""
    texts = ("README.md", "CONTRIBUTING.md", "spec/README.md", ".github/SECURITY.md")
    return [*(ROOT / name for name in texts), *DOCS.glob("*/*.md"), *(ROOT / "generated").glob("*/README.md")]


def test_pages_name_only_commands_and_options_that_exist() -> None:
    context = click.Context(main)
    unknown = []
    for page in pages_for_readers():
        for name, rest in re.findall(r"(?:`|\.venv/bin/)canwright (\w+)([^`\n]*)", page.read_text("utf-8")):
            command = main.get_command(context, name)
            parameters = command.get_params(context) if command else []
            known = [option for parameter in parameters for option in parameter.opts]
            options = re.findall(r"--[\w-]+", rest)
            unknown += [f"{page}: canwright {name} {option}" for option in options if option not in known]
            unknown += [] if command else [f"{page}: canwright {name}"]
    assert unknown == []
