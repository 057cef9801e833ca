"""What several commands share is worked out once, and each page still says what is its command's own."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from canwright.project.loader import specification
from canwright.targets.docs.picture import ROW
from canwright.targets.docs.target import DocsTarget

from ..spec_texts import ROOT

SHARED = """\
canwright: 1
family: lamp
edition: v1
addresses:
  short: {id: node << 4, nodes: 1..4}
  long: {id: node << 4, nodes: 1..4, extended: true}
selector: {at: 0, raw: u8}
parameters: {model: {values: {A: {}, B: {}}}}
types:
  level: {raw: u16, unit: A, scale: {by: model, A: 1/10, B: 1/100}}
layouts:
  outcome:
    manual: "7"
    fields: {part: {at: id.0, raw: u4, manual: "2"}, level: {at: 1, type: level, manual: "3"}, rest: {at: 3, raw: u40}}
commands:
  both: {code: 0x10, manual: "2", request: none, reply: outcome}
  one: {code: 0x11, manual: "3", only: {model: [A]}, request: none, reply: outcome}
  other: {code: 0x12, manual: "3", only: {model: [B]}, request: none, reply: outcome}
  far: {code: 0x13, manual: "3", address: long, request: none, reply: outcome}
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    spec = tmp_path_factory.mktemp("spec") / "spec.yaml"
    spec.write_text(SHARED, "utf-8")
    return {
        output.path.removeprefix("en/v1/"): output.text for output in DocsTarget().generate([specification(spec)], {})
    }


def _row(page: str, field: str) -> str:
    return next(line for line in page.splitlines() if f"`{field}`" in line)


def test_a_scale_is_shown_for_parameter_values_with_the_command(pages: dict[str, str]) -> None:
    both, only_a, only_b = (_row(pages[f"commands/{name}.md"], "level") for name in ("both", "one", "other"))
    assert "A: `1/10 A`<br>B: `1/100 A`" in both
    assert "A: `1/10 A`" in only_a
    assert "B: `1/100 A`" in only_b
    assert "`1/100 A`" not in only_a
    assert "`1/10 A`" not in only_b


def test_a_manual_is_cited_where_it_differs_from_that_of_the_command(pages: dict[str, str]) -> None:
    for name, part, level in (("both", "Part", "Level (Manual 3)"), ("far", "Part (Manual 2)", "Level")):
        page = pages[f"commands/{name}.md"]
        assert _row(page, "part").endswith(f"| {part} |")
        assert _row(page, "level").endswith(f"| {level} |")


def test_a_layout_is_drawn_below_the_rows_that_an_id_has(pages: dict[str, str]) -> None:
    """An id of 29 bits has two rows more than one of 11."""

    def rows(name: str) -> list[int]:
        picture = pages[f"pictures/v1/{name}-reply.svg"]
        return [int(y) // ROW for y in re.findall(r'<rect class="[kab]"[^>]* y="([0-9]+)"', picture)]

    assert rows("far") == [row + 2 for row in rows("both")]


def test_bits_are_called_reserved_where_they_are_data(pages: dict[str, str]) -> None:
    assert not [path for path, text in pages.items() if "Other bits: 0" in text]
    blower = specification(ROOT / "tests/specs/blower/v1.yaml")
    asked = next(o.text for o in DocsTarget().generate([blower], {}) if o.path == "en/v1/commands/read_voltage.md")
    assert "remote frame, `4` data bytes" in asked
    assert "Other bits: 0" not in asked


def test_a_float_has_a_unit_but_no_resolution(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    scaled = "scale: {by: model, A: 1/10, B: 1/100}"
    spec.write_text(
        SHARED.replace("u16", "f32").replace(f", {scaled}", "").replace("at: 3, raw: u40", "at: 5, raw: u24"), "utf-8"
    )
    texts = {output.path: output.text for output in DocsTarget().generate([specification(spec)], {})}
    assert "| `f32` | `A` |" in _row(texts["en/v1/commands/both.md"], "level")
    assert "1 A" not in texts["en/v1/commands/both.md"] + texts["en/v1/types.md"]


def test_the_one_id_of_all_replies_is_not_the_code_of_a_command(tmp_path: Path) -> None:
    spec = tmp_path / "spec.yaml"
    spec.write_text(
        "canwright: 1\nfamily: lamp\nedition: v1\n"
        "addresses: {lamp: {request: node, reply: 0, nodes: 1..4}, all_lamps: {request: 0x10, reply: node, nodes: 1..4}}\n"
        "commands:\n  dim: {request: {level: {at: 0, raw: u16}}, reply: {lamp: {at: 0, raw: u8, holds: node}}}\n"
        "  find: {address: all_lamps, request: {dlc: 0}, reply: {layout: {state: {at: 0, raw: u8}}, from_each: 1..4}}\n",
        "utf-8",
    )
    texts = {output.path: output.text for output in DocsTarget().generate([specification(spec)], {})}
    assert texts["en/v1/commands/dim.md"].startswith("# Dim, v1\n")
    assert texts["en/v1/commands/find.md"].startswith("# 0x10 Find, v1\n")
