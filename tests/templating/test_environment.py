"""Templates are compiled once, kept as Python keeps compiled modules, and never used where they do not fit."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import jinja2
import pytest
from jinja2 import nodes

from ..spec_texts import ROOT

SPEC = ROOT / "tests/specs/valve/v1.yaml"
WATCHED = """
import sys, jinja2
compiled = []
compile_ = jinja2.Environment.compile
jinja2.Environment.compile = lambda *a, **k: compiled.append(a[2]) or compile_(*a, **k)
from canwright.cli import main
try:
    main()
except SystemExit as ended:
    print(len(compiled))
    sys.exit(ended.code)
"""


def generate(out: Path, cache: Path | str, **environment: str) -> tuple[dict[str, bytes], int]:
    """Every C header that a process makes of a small spec, and how many templates it compiled."""
    options = ("generate", "--spec", str(SPEC), "--target", "c", "--out", str(out), "--force")
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    done = subprocess.run(
        [sys.executable, "-c", WATCHED, *options],
        capture_output=True,
        text=True,
        check=False,
        env={**clean, "PYTHONPYCACHEPREFIX": str(cache), **environment},
    )
    assert done.returncode == 0, done.stderr
    return {f.name: f.read_bytes() for f in out.rglob("*.h")}, int(done.stdout.split()[-1])


def kept(cache: Path) -> list[Path]:
    return sorted(cache.rglob("*.jinja"))


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, bytes], int, Path]:
    """What a run makes that finds nothing kept: the headers, how many templates it compiled, and what it kept."""
    folder = tmp_path_factory.mktemp("first")
    return *generate(folder / "out", folder / "cache"), folder / "cache"


def test_a_template_is_compiled_once(first: tuple[dict[str, bytes], int, Path], tmp_path: Path) -> None:
    made, compiled, cache = first
    assert compiled == len(kept(cache)) > 5
    assert generate(tmp_path / "again", cache) == (made, 0)


@pytest.mark.parametrize("length", [0, 2, 30, 45, 100, 1000])
def test_a_damaged_compiled_template_is_compiled_again(
    first: tuple[dict[str, bytes], int, Path], tmp_path: Path, length: int
) -> None:
    made, compiled, cache = first
    shutil.copytree(cache, tmp_path / "cache")
    for file in kept(tmp_path / "cache"):
        file.write_bytes(file.read_bytes()[:length])
    assert generate(tmp_path / "again", tmp_path / "cache") == (made, compiled)


def test_templates_are_compiled_again_for_other_options_of_jinja(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from canwright.templating import environment, resources

    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "cache"))
    (tmp_path / "t").write_text("{% if true %}\nyes\n{% endif %}\n", "utf-8")
    monkeypatch.setattr(resources, "TEMPLATES", tmp_path)
    assert environment.environment(".", {}).get_template("t").render() == "yes\n"
    assert len(kept(tmp_path / "cache")) == 1
    environment._environment.cache_clear()
    monkeypatch.setattr(environment, "_OPTIONS", "others")
    (env := environment.environment(".", {})).trim_blocks = False
    assert env.get_template("t").render() == "\nyes\n\n"
    environment._environment.cache_clear()


def test_templates_work_without_a_cache_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    first, compiled = generate(tmp_path / "out", tmp_path / "file/below")
    assert first and compiled


def test_no_template_is_cached_if_python_writes_no_bytecode(tmp_path: Path) -> None:
    _, compiled = generate(tmp_path / "out", tmp_path / "cache", PYTHONDONTWRITEBYTECODE="1")
    assert compiled and not kept(tmp_path / "cache")


class AnyFilter(dict[str, Any]):
    """Knows every filter."""

    def get(self, name: str, default: Any = None) -> Any:
        return lambda *arguments, **named: ""


def worked_out(source: str) -> list[int]:
    """The lines where a filter is applied while a template is compiled, for all it is applied to is constant."""
    env = jinja2.Environment()
    env.filters = AnyFilter()
    lines = []
    for node in env.parse(source).find_all(nodes.Filter):
        with contextlib.suppress(nodes.Impossible):
            node.as_const(nodes.EvalContext(env))
            lines.append(node.lineno)
    return lines


def test_no_filter_is_evaluated_while_a_template_is_compiled() -> None:
    """What a filter makes of a constant would be kept with the template, and stay when the filter changes."""
    assert worked_out("{{ a | code }}{{ [a] | code }}\n{{ 'a' | code }}") == [2]
    templates = sorted((ROOT / "templates").rglob("*.j2"))
    assert len(templates) > 30
    assert [t.name for t in templates if worked_out(t.read_text("utf-8"))] == []
