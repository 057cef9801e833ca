"""The examples of the README, as printed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from canwright.cli import main
from click.testing import CliRunner

from .compilers import WARNINGS, compilers
from .spec_texts import ROOT, findings

README = (ROOT / "README.md").read_text("utf-8")


def example(name: str) -> str:
    """The code block behind `<!-- example: name -->`."""
    match = re.search(rf"<!-- example: {name} -->\n```\w+\n(.*?)```", README, re.DOTALL)
    assert match, f"README.md has no example {name}"
    return match.group(1)


def printed(name: str) -> str:
    """What the README says that an example prints."""
    match = re.search(rf"<!-- example: {name} -->\n```\w+\n.*?```\n\n```text\n(.*?)```", README, re.DOTALL)
    assert match, f"README.md does not say what example {name} prints"
    return match.group(1)


def test_the_python_example(tmp_path: Path) -> None:
    script = tmp_path / "example.py"
    script.write_text(example("python"), "utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "generated/python")}
    result = subprocess.run([sys.executable, script], capture_output=True, text=True, env=environment, check=False)
    assert (result.stdout, result.stderr) == (printed("python"), "")


def test_the_c_example(tmp_path: Path) -> None:
    source, program = tmp_path / "example.c", tmp_path / "example"
    source.write_text(example("c"), "utf-8")
    for compiler in compilers():
        compiler.run("c99", *WARNINGS, f"-I{ROOT}/generated/c/include", source, "-o", program)
        result = subprocess.run([str(program)], capture_output=True, text=True, check=True)
        assert result.stdout == printed("c")


def test_the_spec_example_generates(tmp_path: Path) -> None:
    assert findings(tmp_path, example("spec")) == []
    arguments = example("generate").split()
    assert arguments[0] == ".venv/bin/canwright"
    (tmp_path / "lamp.yaml").write_text(example("spec"), "utf-8")
    before = Path.cwd()
    os.chdir(tmp_path)
    try:
        result = CliRunner().invoke(main, arguments[1:], catch_exceptions=False)
    finally:
        os.chdir(before)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "out/c/include/lamp/v1.h").is_file()


def test_every_link_leads_somewhere() -> None:
    for page in ("README.md", "CONTRIBUTING.md"):
        for link in re.findall(r"\]\(([^)#:]+)\)", (ROOT / page).read_text("utf-8")):
            assert (ROOT / link).exists(), f"{page}: {link}"
