"""Names of families and editions that would replace files or modules are findings at the name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import canwright
import pytest
from canwright.diagnostics.diagnostic import SpecError
from canwright.project import pipeline
from canwright.project.loader import all_loaded
from canwright.targets import registry
from canwright.targets.base import EditionInput, Output, Target

from ..spec_texts import MINIMAL


@pytest.mark.parametrize(
    ("family", "edition", "rule", "message"),
    [
        *(
            (name, "v1", "name-collision", f"the module `{name}`")
            for name in ("enum", "struct", "site", "distutils", "can", "numpy")
        ),
        *((name, "v1", "name-collision", f"the header `{name}.h`") for name in ("stdint", "fenv", "arduino")),
        *((name, "v1", "file-name", "Windows") for name in ("con", "aux", "com1")),
        ("class", "v1", "name-collision", "the Python package `class` cannot be imported"),
        ("std", "v1", "name-collision", "the C++ namespace `std`"),
        *(("lamp", name, "name-collision", "cannot be imported") for name in ("import", "None")),
        *(("lamp", name, "name-collision", "already contains a module") for name in ("nodes", "Nodes", "python-can")),
        *(("lamp", name, "name-collision", "already contains a header") for name in ("canwright", "Canwright-exact")),
        *(("lamp", name, "name-collision", "name of a page") for name in ("index.md", "Support.HTML")),
        *(("lamp", name, "file-name", "Windows") for name in ("nul", "NUL", "con.v1")),
    ],
)
def test_name_that_would_replace_a_file_is_an_error(
    tmp_path: Path, family: str, edition: str, rule: str, message: str
) -> None:
    file = tmp_path / "spec.yaml"
    file.write_text(MINIMAL.replace("family: lamp", f"family: {family}").replace("edition: v1", f"edition: {edition}"))
    with pytest.raises(SpecError) as rejected:
        all_loaded([file])
    (finding,) = [diagnostic for diagnostic in rejected.value.diagnostics if diagnostic.severity.value == "error"]
    assert (finding.rule, finding.position.line) == (rule, 2 if family != "lamp" else 3)
    assert message in finding.message
    assert finding.position.text[finding.position.column - 1 :] == (family if family != "lamp" else edition)


@pytest.mark.parametrize(
    ("first", "second", "parameters"),
    [("v1", "V1", ""), ("v2.0", '"2.0"', ""), ("v1", "v1-big", "parameters: {size: {values: {big: {}, small: {}}}}\n")],
)
def test_editions_with_equal_file_names_are_an_error(tmp_path: Path, first: str, second: str, parameters: str) -> None:
    """File systems that do not distinguish upper case have one file for both."""
    files = [tmp_path / "one.yaml", tmp_path / "two.yaml"]
    files[0].write_text(MINIMAL.replace("edition: v1\n", f"edition: {first}\n{parameters}"))
    files[1].write_text(MINIMAL.replace("edition: v1\n", f"edition: {second}\n"))
    with pytest.raises(SpecError) as rejected:
        all_loaded(files)
    assert {finding.rule for finding in rejected.value.diagnostics} == {"name-collision"}


def test_an_edition_that_starts_with_a_digit_can_be_imported(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("edition: v1", 'edition: "2.0"'))
    files = canwright.generate([canwright.load(tmp_path / "lamp.yaml")], ["c", "python"])
    assert "python/lamp/v2_0.py" in files
    assert "namespace lamp::v2_0 " in files["c/include/lamp/v2_0.hpp"].decode()


class _Twice(Target):
    title = "Twice"

    def generate(self, specifications: object, set_parameters: object, options: object) -> Iterator[Output]:
        yield Output("read.me", "")
        yield Output("READ.ME", "")


def test_two_outputs_with_one_path_are_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL)
    specification: EditionInput = canwright.load(tmp_path / "lamp.yaml")
    monkeypatch.setattr(registry, "target", lambda name: _Twice())
    with pytest.raises(registry.TargetError, match=r"files twice/read[.]me and twice/READ[.]ME"):
        pipeline.generate([specification], ["twice"], {})
