"""Every rule by its examples, `bad.yaml` with its exact findings and `good.yaml` without; output formats of findings."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from canwright.cli import main
from canwright.compare import CHANGES
from canwright.diagnostics.diagnostic import Diagnostic, Position, Severity, SpecError
from canwright.project.loader import load
from canwright.rules import ALL_RULES
from canwright.templating.resources import EXAMPLES, SCHEMA
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from ..spec_texts import MINIMAL, findings

FOLDERS = sorted(folder.name for folder in EXAMPLES.iterdir())
ELSEWHERE = {
    "file-size": "its example would be a megabyte; tests/untrusted/test_limits.py has it",
    "stale-output": "it is about output; tests/cli has it",
    "target-contradiction": "it is about output; tests/cli has it",
    "not-tested": "it is about a command; tests/cli has it",
}


def findings_of_example(folder: Path, name: str, rule: str, monkeypatch: pytest.MonkeyPatch) -> list[Diagnostic]:
    """Findings of an example, without the warning about missing golden frames, unless this is the rule."""
    monkeypatch.chdir(folder)
    try:
        findings = load(Path(name)).warnings
    except SpecError as error:
        findings = error.diagnostics
    return [finding for finding in findings if rule == "missing-frame" or finding.rule != "missing-frame"]


def test_every_rule_has_examples() -> None:
    assert set(FOLDERS) | set(ELSEWHERE) == set(ALL_RULES)
    assert not set(FOLDERS) & set(ELSEWHERE)


@pytest.mark.parametrize("rule", FOLDERS)
def test_findings_of_the_examples(rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = EXAMPLES / rule
    bad = findings_of_example(folder, "bad.yaml", rule, monkeypatch)
    assert "\n".join(map(str, bad)) + "\n" == (folder / "expected.txt").read_text("utf-8")
    assert {(finding.rule, finding.severity) for finding in bad} == {(rule, ALL_RULES[rule].severity)}
    assert all(finding.hint for finding in bad) or rule in ("value", "yaml")
    assert findings_of_example(folder, "good.yaml", rule, monkeypatch) == []


STRUCTURAL = (
    *("field-type", "missing-key", "missing-reply", "name", "parameter-kind", "two-ranges", "type", "unknown-key"),
    *("value", "ambiguous-scalar", "no-effect"),
)
"""Rules about the shape of a spec, which a JSON Schema can say as well."""


@pytest.fixture(scope="module")
def json_schema() -> Draft202012Validator:
    return Draft202012Validator(json.loads(SCHEMA.read_text("utf-8")))


@pytest.mark.parametrize("rule", FOLDERS)
def test_the_json_schema_accepts_good_examples(rule: str, json_schema: Draft202012Validator) -> None:
    assert json_schema.is_valid(yaml.load((EXAMPLES / rule / "good.yaml").read_text("utf-8"), yaml.CSafeLoader))


@pytest.mark.parametrize("rule", STRUCTURAL)
def test_the_json_schema_rejects_bad_examples_of_structural_rules(rule: str, json_schema: Draft202012Validator) -> None:
    assert not json_schema.is_valid(yaml.load((EXAMPLES / rule / "bad.yaml").read_text("utf-8"), yaml.CSafeLoader))


@pytest.mark.parametrize("rule", ALL_RULES)
def test_explain_shows_purpose_and_examples(rule: str) -> None:
    result = CliRunner().invoke(main, ["explain", rule])
    assert result.exit_code == 0
    assert result.output.startswith(f"{rule} ({ALL_RULES[rule].severity.value})\n\n{ALL_RULES[rule].purpose}\n")
    assert ("Bad, bad.yaml:" in result.output) == (rule in FOLDERS)
    assert f"[{rule}]" in result.output or rule in ELSEWHERE


def test_explain_lists_all_and_names_the_nearest() -> None:
    listed = CliRunner().invoke(main, ["explain"]).output
    assert [line.split()[0] for line in listed.splitlines()] == [*ALL_RULES, *CHANGES]
    result = CliRunner().invoke(main, ["explain", "overlp"])
    assert (result.exit_code, "did you mean `overlap`?" in result.output) == (2, True)


PHASES = (
    ("reply: echo", "reply: echo\n    reply: none\n    notes: [yes]", ["14:5 duplicate-key", "15:13 ambiguous-scalar"]),
    ("selector:", "selecter:", ["5:1 unknown-key", "7:16 value"]),
    ("u16", "u99", ["7:16 value"]),
    ("type: level", "type: levl", ["7:27 unknown-reference", "12:36 unknown-reference"]),
    ('unit: "%"', "unit: furlong", ["7:27 unknown-reference"]),
    ("0x100 + node", "0x800 + node", ["4:24 id-space", "10:11 code-width"]),
    ("code: 0x10", "code: 0x110", ["10:11 code-width"]),
    ("F lamp", "lump", ["F 2:9 other-edition"]),
    ("F source: manual", "source: manul", ["F 6:99 unknown-reference"]),
    ("scale: 0.1", "scale: 0", ["7:39 zero-scale"]),
    ("F raw: {level: 100}", "raw: {level: 99}", ["F 6:86 frame-contradiction"]),
)
"""Mistakes of each phase in their order, and what a run reports if those before it are corrected."""


@pytest.mark.parametrize("first", range(len(PHASES)), ids=[f"{old} => {new}" for old, new, _ in PHASES])
def test_a_phase_reports_all_its_findings_and_hides_those_of_later_ones(first: int, tmp_path: Path) -> None:
    spec, frames = MINIMAL, FRAMES.replace('"0x101"', "0x101")
    for old, new, _ in PHASES[first:]:
        spec = spec if old.startswith("F ") else spec.replace(old, new, 1)
        frames = frames.replace(old[2:], new, 1) if old.startswith("F ") else frames
    (tmp_path / "my.yaml").write_text(spec, "utf-8")
    (tmp_path / "my.frames.yaml").write_text(frames, "utf-8")
    with pytest.raises(SpecError) as refused:
        load(tmp_path / "my.yaml")
    assert [
        f"{'F ' if d.position.file.endswith('.frames.yaml') else ''}{d.position.line}:{d.position.column} {d.rule}"
        for d in refused.value.diagnostics
        if d.severity is Severity.ERROR
    ] == PHASES[first][2]


FRAMES = """canwright: 1
family: lamp
edition: v1
sources: {manual: The manual.}
frames:
  - {request: dim, node: 1, id: "0x101", data: "10 00 64 00 00 00 00 00", raw: {level: 100}, source: manual}
"""


def test_findings_of_all_specs_are_reported_in_one_run(tmp_path: Path) -> None:
    """An error of one spec hides the later phases of this spec, not those of others, nor their warnings."""
    broken = MINIMAL.replace("types:", "types: {")
    texts = {
        "a.yaml": broken,
        "a.frames.yaml": FRAMES,
        "b.yaml": MINIMAL.replace("scale: 0.1", "scale: 0"),
        "b.frames.yaml": FRAMES.replace("{request", "[{request"),
        "c.yaml": MINIMAL.replace("type: level", "type: levl"),
        "d.yaml": MINIMAL,
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, "utf-8")
    specs = [argument for name in "abcd" for argument in ("--spec", str(tmp_path / f"{name}.yaml"))]
    result = CliRunner().invoke(main, ["check", "--format", "json", *specs])
    told = [(Path(f["file"]).name, f["line"], f["rule"]) for f in json.loads(result.stdout)["findings"]]
    assert (result.exit_code, told) == (
        1,
        [
            ("a.yaml", 6, "yaml"),
            ("b.frames.yaml", 6, "yaml"),
            ("c.yaml", 12, "unknown-reference"),
            ("d.yaml", 1, "missing-frame"),
        ],
    )


MISSPELLED = MINIMAL.replace("selector:", "selecter:").replace("u16", "u99")


def machine(folder: Path, printer: str, text: str = MISSPELLED) -> tuple[int, str]:
    file = folder / "a, b.yaml"
    file.write_text(text, "utf-8")
    result = CliRunner().invoke(main, ["check", "--spec", str(file), "--format", printer])
    return result.exit_code, result.stdout.replace(str(folder), "folder")


def test_json(tmp_path: Path) -> None:
    code, printed = machine(tmp_path, "json")
    assert code == 1
    findings = json.loads(printed)["findings"]
    assert len(findings) == 2
    assert findings[0] == {
        "file": "folder/a, b.yaml",
        "line": 5,
        "column": 1,
        "end_column": 9,
        "severity": "error",
        "rule": "unknown-key",
        "message": "unknown key `selecter`",
        "hint": "did you mean `selector`?",
        "related": [],
    }


def test_github_annotations(tmp_path: Path) -> None:
    code, printed = machine(tmp_path, "github", MINIMAL.replace("at: 2", "at: 7"))
    assert code == 1
    assert printed == (
        "::error file=folder/a%2C b.yaml,line=12,col=27,title=beyond-frame::"
        "`level` uses bytes 7 to 8, but the frame has bytes 0 to 7%0Acheck `at`, the type and `dlc`\n"
    )


def test_sarif(tmp_path: Path) -> None:
    code, printed = machine(tmp_path, "sarif")
    assert code == 1
    (run,) = json.loads(printed)["runs"]
    assert {rule["id"] for rule in run["tool"]["driver"]["rules"]} == {result["ruleId"] for result in run["results"]}
    region = run["results"][0]["locations"][0]["physicalLocation"]["region"]
    assert region == {"startLine": 5, "startColumn": 1, "endColumn": 9}


def test_the_other_position_of_two_colliding_items(tmp_path: Path) -> None:
    """Every format has it; the text has it in one line that an editor links."""
    text = MINIMAL.replace("type: level}}", "type: level}, glow: {at: 3, raw: u8}}")
    (finding,) = json.loads(machine(tmp_path, "json", text)[1])["findings"]
    assert finding["related"] == [{"file": "folder/a, b.yaml", "line": 12, "column": 27, "item": "`level`"}]
    assert "byte 3 with `level`%0A`level` is at folder/a, b.yaml:12:27%0Amove" in machine(tmp_path, "github", text)[1]
    (run,) = json.loads(machine(tmp_path, "sarif", text)[1])["runs"]
    (related,) = run["results"][0]["relatedLocations"]
    assert related["message"] == {"text": "`level`"}
    assert related["physicalLocation"]["region"] == {"startLine": 12, "startColumn": 27, "endColumn": 28}


def test_a_big_endian_field_at_its_low_byte_is_reported_itself(tmp_path: Path) -> None:
    fields = "a: {at: 1, raw: u8}, b: {at: 4, raw: u16, byte_order: big}, c: {at: 5, raw: u8}"
    wrong = MINIMAL.replace("level: {at: 2, type: level}}", f"{fields}}}")
    (finding,) = json.loads(machine(tmp_path, "json", wrong)[1])["findings"]
    assert finding["message"].startswith("`b` is big-endian")
    assert finding["hint"].endswith("write at: 3 for bytes 3 to 4")
    assert [item["item"] for item in finding["related"]] == ["`c`"]
    full = wrong.replace("a: {at: 1, raw: u8}", "a: {at: 3, raw: u8}")
    (finding,) = json.loads(machine(tmp_path, "json", full)[1])["findings"]
    assert finding["message"].startswith("`c` shares")
    last = MINIMAL.replace("at: 2, type: level", "at: 7, raw: u16, byte_order: big")
    assert "write at: 6 for bytes 6 to 7" in machine(tmp_path, "github", last)[1]


def test_the_caret_is_below_the_value_in_a_terminal() -> None:
    """Wide characters take two columns there, and combining ones none; machines are told characters."""
    text = "  灯e\u0301: {title: 调光, at: x}"
    shown = str(Diagnostic(Severity.ERROR, "value", "no", Position("a.yaml", 1, text.index("x") + 1, 1, text)))
    assert shown.split("\n")[2].index("^") - 2 == text.index("x") + 3 - 1
    wide = str(Diagnostic(Severity.ERROR, "value", "no", Position("a.yaml", 1, text.index("调") + 1, 2, text)))
    assert wide.endswith("^^^^")


def test_a_layout_that_a_message_extends_is_used(tmp_path: Path) -> None:
    (tmp_path / "my.yaml").write_text(
        MINIMAL
        + "  ask: {code: 0x11, manual: '1', reply: {layout: state, fields: {lamp: {at: 1, raw: u8}}}}\n"
        + "layouts: {state: {fields: {level: {at: 2, type: level}}}}\n",
        "utf-8",
    )
    assert [d.rule for d in load(tmp_path / "my.yaml").warnings] == ["missing-frame"]


def test_machine_formats_without_errors(tmp_path: Path) -> None:
    assert machine(tmp_path, "github", MINIMAL)[0] == 0
    code, printed = machine(tmp_path, "json", MINIMAL)
    assert (code, [f["rule"] for f in json.loads(printed)["findings"]]) == (0, ["missing-frame"])


def test_hints_about_refused_entries_list_valid_names(tmp_path: Path) -> None:
    """A name that a copied spec no longer has is reported before the entry is checked."""
    (tmp_path / "lamp.yaml").write_text(MINIMAL, "utf-8")
    (tmp_path / "lamp.frames.yaml").write_text(
        "canwright: 1\nfamily: lamp\nedition: v1\nsources: {manual: The manual.}\nframes: []\nrefused:\n"
        "  - {encode: request, command: dim, node: 1, raw: {levle: 1001}, says: out_of_range, source: manual}\n"
        "  - {encode: request, command: dom, node: 1, raw: {level: 1001}, says: out_of_range, source: manual}\n"
        "  - {encode: request, command: dim, node: 1, raw: {level: 1001}, says: out_of_range, source: manual}\n",
        "utf-8",
    )
    with pytest.raises(SpecError) as refused:
        load(tmp_path / "lamp.yaml")
    assert [
        (d.position.line, d.message, d.hint) for d in refused.value.diagnostics if d.rule == "refused-contradiction"
    ] == [
        (7, "there is no field `levle` in the request of dim", "did you mean `level`?"),
        (8, "there is no command `dom`", "did you mean `dim`?"),
    ]


def test_a_moved_field_has_one_finding_in_each_frame(tmp_path: Path) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL.replace("at: 2", "at: 4"), "utf-8")
    frame = "id: 0x101, node: 1, data: 10 00 64 00 00 00 00 00, source: manual"
    (tmp_path / "lamp.frames.yaml").write_text(
        "canwright: 1\nfamily: lamp\nedition: v1\nsources: {manual: The manual.}\nframes:\n"
        f"  - {{request: dim, {frame}, raw: {{level: 100}}, values: {{level: 10}}}}\n"
        f"  - {{request: dim, {frame}, raw: {{level: 0}}, values: {{level: 10}}}}\n",
        "utf-8",
    )
    with pytest.raises(SpecError) as refused:
        load(tmp_path / "lamp.yaml")
    assert [(d.position.line, d.message) for d in refused.value.diagnostics] == [
        (6, "`level` is 0 in `data`"),
        (7, "`level` is 0 according to the scale in the spec"),
    ]


def test_big_endian_fields_at_their_lowest_bytes_are_reported_themselves(tmp_path: Path) -> None:
    fields = "{level: {at: 3, raw: u16}, time: {at: 5, raw: u16}, end: {at: 6, raw: u8}}"
    text = MINIMAL.replace("request: {level: {at: 2, type: level}}", f"request: {fields}") + "byte_order: big\n"
    (finding,) = (f for f in findings(tmp_path, text) if f.rule == "overlap")
    assert finding.message.startswith("`time` is big-endian and uses bytes 5 to 6")
    assert finding.hint.endswith("write at: 4 for bytes 4 to 5")


@pytest.mark.parametrize(("bus", "related"), [("", []), ("bus: {dlc: 8}\n", ["the length of dim_request"])])
def test_a_wrong_length_is_related_to_the_line_that_defines_it(tmp_path: Path, bus: str, related: list[str]) -> None:
    (tmp_path / "lamp.yaml").write_text(MINIMAL + bus, "utf-8")
    frame = '{request: dim, node: 1, id: 0x101, data: "10 00 F4 01 00 00 00", raw: {level: 500}, source: manual}'
    head = "canwright: 1\nfamily: lamp\nedition: v1\nsources: {manual: The manual}\n"
    (tmp_path / "lamp.frames.yaml").write_text(f"{head}frames:\n  - {frame}\n", "utf-8")
    with pytest.raises(SpecError) as rejected:
        load(tmp_path / "lamp.yaml")
    (finding,) = (f for f in rejected.value.diagnostics if f.rule == "frame-contradiction")
    assert finding.message == "7 bytes, but dim_request has 8"
    assert [item.item for item in finding.related] == related
