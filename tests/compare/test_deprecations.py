"""Deprecated items: notices, and removals that were announced."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.cli import main
from canwright.compare import Change, Impact, compare
from canwright.model.deprecation import Deprecation, is_before
from canwright.project.configuration import DiffConfiguration
from click.testing import CliRunner

from ..spec_texts import MINIMAL, edition

FIELD = "level: {at: 2, type: level}"


def _changes(folder: Path, old: str, new: str, name: str = "v3", date: str = "") -> tuple[Change, ...]:
    named = new.replace("edition: v1", f"edition: {name}" + (f"\ndate: {date}" if date else ""))
    return compare(edition(folder, old), edition(folder, named))


def _fails(change: Change, *kinds: str) -> bool:
    return DiffConfiguration().fails(change, kinds or DiffConfiguration().fail_on)


@pytest.mark.parametrize(
    ("deprecated", "name", "date", "says", "fails"),
    [
        ("", "v3", "", "is removed", True),
        ("{since: v1}", "v2", "", "is removed as announced (deprecated since v1)", False),
        ("{since: v1, until: v3}", "v3", "", "is removed as announced (deprecated since v1, until v3)", False),
        ("{since: v1, until: v3}", "v3-2024-11", "", "is removed as announced (deprecated since v1, until v3)", False),
        ("{since: v1, until: v10}", "v9", "", "is removed earlier than announced (deprecated since v1, until v10)", True),
        ("{since: v1, until: 2027-03}", "w", "2027-03-02", "is removed as announced (deprecated since v1, until 2027-03)", False),
        ("{since: v1, until: 2027-03}", "w", "2027-02", "is removed earlier than announced (deprecated since v1, until 2027-03)", True),
        ("{since: v1, until: v3}", "w", "", "is removed perhaps earlier than announced (deprecated since v1, until v3)", True),
    ],
)  # fmt: skip
def test_removals(tmp_path: Path, deprecated: str, name: str, date: str, says: str, fails: bool) -> None:
    key = f"deprecated: {deprecated}, " if deprecated else ""
    old = MINIMAL + f"  stop: {{{key}code: 0x70, request: {{marker: {{at: 1, raw: u8}}}}, reply: none}}\n"
    (change,) = _changes(tmp_path, old, MINIMAL, name, date)
    assert change.rule.id == "command-removed" and change.says() == f"`stop` (0x70) {says}"
    assert change.impact is Impact.LOUD and _fails(change) is fails and _fails(change, "loud")


def test_fields_flags_and_values(tmp_path: Path) -> None:
    for kind, rest in (("enum", "value: 1"), ("flags", "bit: 1")):
        old = MINIMAL.replace(
            "types:", f"types:\n  state: {{raw: u8, {kind}: {{a: 0, b: {{{rest}, deprecated: {{since: v1}}}}}}}}"
        )
        old = old.replace(FIELD, f"{FIELD}, state: {{at: 1, type: state}}")
        (change,) = _changes(tmp_path, old, old.replace(f", b: {{{rest}, deprecated: {{since: v1}}}}", ""))
        assert change.rule.id == "member-removed" and change.announced and change.impact is Impact.SILENT
        assert change.says() == "`b` (1) of `state` is removed as announced (deprecated since v1)" and not _fails(
            change
        )
    old = MINIMAL.replace(FIELD, f"{FIELD}, more: {{at: 4, raw: u8, deprecated: {{since: v1, until: v3}}}}")
    for name, announced in (("v2", False), ("v3", True)):
        (change,) = _changes(tmp_path, old, MINIMAL, name)
        assert change.rule.id == "field-removed" and change.announced is announced and _fails(change) is not announced


def test_another_meaning_is_no_removal(tmp_path: Path) -> None:
    old = MINIMAL.replace(FIELD, "level: {at: 2, type: level, deprecated: {since: v1}}")
    changes = _changes(tmp_path, old, MINIMAL.replace(FIELD, "sum: {at: 2, raw: i16, title: Sum}"))
    assert any(change.rule.id == "field-replaced" and _fails(change) for change in changes)


def test_the_command_line(tmp_path: Path) -> None:
    for name, until in (("a", "v3"), ("b", "v4")):
        spec = MINIMAL + f"  stop: {{deprecated: {{since: v1, until: {until}}}, code: 0x70, reply: none}}\n"
        (tmp_path / f"{name}.yaml").write_text(spec, "utf-8")
    (tmp_path / "new.yaml").write_text(MINIMAL.replace("edition: v1", "edition: v3"), "utf-8")
    for name, options, status in (("a", (), 0), ("a", ("--fail-on", "wire"), 1), ("b", (), 1)):
        names = [str(tmp_path / f"{file}.yaml") for file in (name, "new")]
        assert CliRunner().invoke(main, ["diff", *names, *options]).exit_code == status


def test_order_of_editions() -> None:
    assert is_before("v2.9", "v2.10") and is_before("2027-03", "2027-11-02") and is_before("v2.35-2024-02", "v2.36")
    assert (
        is_before("v2.10", "v2.9") is False and is_before("v2", "v2") is False and is_before("v2-2024", "v2") is False
    )
    assert is_before("v2", "v2-2024") is None and is_before("v2", "w3") is None and is_before("v2", "2") is None
    assert Deprecation(since="v1", until="2027").allows_removal("v2", "") is None
