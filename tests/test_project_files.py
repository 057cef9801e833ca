"""What a project on a code host has: workflows, templates, hooks, one version; nothing of a person or a machine."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import canwright
import pytest
import yaml

from .project.test_committed import MACHINE
from .spec_texts import ROOT
from .test_quality import TOOLS

BIN = Path(sys.executable).parent
GITHUB = ROOT / ".github"
WORKFLOWS = sorted((GITHUB / "workflows").glob("*.yml"))
FORMS = sorted(file for file in (GITHUB / "ISSUE_TEMPLATE").glob("*.yml") if file.name != "config.yml")


def read(file: Path) -> Any:
    # `on` of a workflow is a truth value in YAML 1.1; as text it is a key.
    return yaml.load(file.read_text("utf-8"), yaml.BaseLoader)


@pytest.mark.interop("check_jsonschema")
@pytest.mark.parametrize(
    ("schema", "files"),
    [
        ("vendor.github-workflows", WORKFLOWS),
        ("vendor.github-issue-forms", FORMS),
        ("vendor.github-issue-config", [GITHUB / "ISSUE_TEMPLATE/config.yml"]),
    ],
)
def test_files_of_the_code_host_fit_their_schema(schema: str, files: list[Path]) -> None:
    assert files
    command: list[str | Path] = [BIN / "check-jsonschema", "--builtin-schema", schema, *files]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda file: file.stem)
def test_workflows_only_read_and_use_no_secret(workflow: Path) -> None:
    content = read(workflow)
    assert content["permissions"] == {"contents": "read"}
    assert "secrets." not in workflow.read_text("utf-8")
    for job in content["jobs"].values():
        assert "permissions" not in job and "timeout-minutes" in job
        for step in job["steps"]:
            uses = step.get("uses", "actions/checkout@v0")
            assert re.fullmatch(r"actions/[\w-]+@v\d+", uses), uses
            if uses.startswith("actions/checkout") and "uses" in step:
                assert step["with"]["persist-credentials"] == "false"


def test_workflow_tests_the_lowest_and_the_newest_python() -> None:
    (workflow,) = WORKFLOWS
    jobs = read(workflow)["jobs"]
    (lowest,) = re.findall(r'requires-python = ">=([\d.]+)"', (ROOT / "pyproject.toml").read_text("utf-8"))
    assert jobs["bare"]["strategy"]["matrix"]["python"] == [lowest, "3.x"]
    commands = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    assert ".ci/run" in commands and any(command.endswith("pytest -m machine") for command in commands)


def test_hooks_run_the_tools_of_the_tests() -> None:
    (source,) = read(ROOT / ".pre-commit-config.yaml")["repos"]
    assert source["repo"] == "local"
    entries = [hook["entry"].removeprefix(".venv/bin/").removesuffix(" --force-exclude") for hook in source["hooks"]]
    changing = [" ".join(tool).removesuffix(" --check") for tool in TOOLS]
    assert sorted(entries) == sorted([*changing, "canwright check"])
    for hook in source["hooks"]:
        assert {"id", "name", "language"} <= {*hook}
        assert (BIN / hook["entry"].split()[0].removeprefix(".venv/bin/")).is_file()


def test_changelog_starts_with_this_version() -> None:
    headings = re.findall(r"(?m)^## (.*)$", (ROOT / "CHANGELOG.md").read_text("utf-8"))
    assert headings[0].split()[0] == canwright.__version__


def dependencies() -> str:
    """The lines of what pip installs with canwright."""
    text = (ROOT / "pyproject.toml").read_text("utf-8")
    (lines,) = re.findall(r"^dependencies = \[\n(.*?)^\]$", text, re.MULTILINE | re.DOTALL)
    return str(lines)


def test_dependencies_do_not_hide_that_python_is_too_old() -> None:
    """pip with an early Python names the first dependency without a release for it, unless a marker excludes all."""
    assert all("; python_version " in line for line in dependencies().splitlines())


def test_canwright_test_needs_no_extra_for_reference_python_and_dbc() -> None:
    sources = [file.read_text("utf-8") for file in (ROOT / "generator/canwright/conformance").glob("*.py")]
    imported = set(re.findall(r"(?m)^ *(?:from|import) (\w+)", "\n".join(sources))) - sys.stdlib_module_names
    assert {"cantools"} == imported <= set(re.findall(r'(?m)^  "([\w-]+)', dependencies()))


def test_version_is_written_once_in_the_sources() -> None:
    sources = [ROOT / "pyproject.toml", *(ROOT / "generator").rglob("*.py"), *(ROOT / "templates").rglob("*.j2")]
    written = [f.relative_to(ROOT).as_posix() for f in sources if f'"{canwright.__version__}"' in f.read_text("utf-8")]
    assert written == ["generator/canwright/__init__.py"]


def test_project_files_name_no_person_and_no_machine() -> None:
    files = [
        *GITHUB.rglob("*.*"),
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", ".pre-commit-config.yaml")),
    ]
    for file in (file for file in files if file.is_file()):
        text = file.read_text("utf-8")
        assert not MACHINE.search(text), file
        assert not re.search(r"[\w.-]+@[\w-]+\.\w|https?://", text), file
