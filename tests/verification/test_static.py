"""Each command reports a defect that is planted in a header."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..spec_texts import MINIMAL
from . import analyzers, frama_c, misra, sanitizers
from .headers import Header, write_headers

pytestmark = pytest.mark.tools

SPEC = MINIMAL.replace("reply: echo", "reply: {state: {at: 1, raw: u8}, level: {at: 2, type: level}}")
OVERRUN = "message->state = frame->data[1];", "message->state = frame->data[message->level - message->level + 9];"
OMITTED = "    message->state = frame->data[1];\n", ""
MISPLACED = "frame->data[1]", "(&frame->dlc)[frame->data[1]]"
UNCLEAR = "message->state = frame->data[1];", "message->state = (uint8_t)(frame->data[1] + 2u * 3u);"
NULL = "    message->state = frame->data[1];\n", "    message->state = *(uint8_t *)NULL;\n"


@pytest.fixture
def headers(tmp_path: Path) -> list[Header]:
    spec = tmp_path / "v1.yaml"
    spec.write_text(SPEC, "utf-8")
    return write_headers(tmp_path / "c", [spec])


def _plant(header: Header, old: str, new: str) -> None:
    assert old in header.text
    (header.include / header.name).write_text(header.text.replace(old, new), "utf-8")


def test_misra_reports_a_violation_without_a_deviation(headers: list[Header]) -> None:
    allowed = {"2.5", "15.5", "19.2"}
    violations = [finding for finding in misra.findings(headers) if finding.rule not in allowed]
    _plant(headers[0], *UNCLEAR)
    planted = set(misra.findings(headers)) - set(violations)
    assert "12.1" in {finding.rule for finding in planted}
    assert any("12.1" in problem for problem in misra.problems(sorted(planted), allowed))
    assert list(misra.problems([], {"15.5"})) == ["rule 15.5 has a deviation but no violation"]


def test_misra_reports_a_header_that_cppcheck_skips(headers: list[Header]) -> None:
    _plant(headers[0], "#ifndef LAMP_V1_H", "#if LIMIT != 53\n#error skipped\n#endif\n#ifndef LAMP_V1_H")
    assert "skipped" in {finding.id for finding in misra.findings(headers)}


@pytest.mark.parametrize("planted", [OVERRUN, OMITTED, MISPLACED])
def test_frama_c_reports_a_defect(headers: list[Header], planted: tuple[str, str]) -> None:
    assert not frama_c.unproven(headers[0])
    _plant(headers[0], *planted)
    assert frama_c.unproven(headers[0])


def test_frama_c_reports_a_defect_beside_an_exception(headers: list[Header]) -> None:
    """In functions of BEYOND_EVA, whose known alarms are ignored: an overflow upwards, and of another expression."""
    header = next(header for header in headers if header.part == "float")
    runtime = header.include / "lamp" / "canwright_float.h"
    text, old = runtime.read_text("utf-8"), "    *nearest = whole + ("
    assert old in text and not frama_c.unproven(header)
    runtime.write_text(text.replace(old, "    *nearest = whole + whole + ("), "utf-8")
    assert any("canwright_signed32_from_float" in line for line in frama_c.unproven(header))


def test_analyzers_report_a_null_pointer(headers: list[Header]) -> None:
    assert not analyzers.all_findings(headers[1])
    _plant(headers[0], *NULL)
    findings = analyzers.all_findings(headers[1])
    assert {line.split(":")[0] for line in findings} == set(analyzers.ANALYZERS)


@pytest.mark.parametrize(
    ("name", "planted"),
    [
        ("gcc, ASan and UBSan", OVERRUN),
        ("clang, ASan and UBSan", OVERRUN),
        ("clang, MSan", OMITTED),
    ],
)
def test_sanitizers_report_a_defect(headers: list[Header], name: str, planted: tuple[str, str]) -> None:
    sanitizer = sanitizers.SANITIZERS[name]
    assert not sanitizers.failures(headers[0], sanitizer, 200)
    _plant(headers[0], *planted)
    assert sanitizers.failures(headers[0], sanitizer, 200)


def test_stored_inputs_belong_to_headers(tmp_path: Path) -> None:
    files = set(sanitizers.CORPUS.iterdir())
    assert files
    assert files <= {sanitizers.stored(header) for header in write_headers(tmp_path)}


def test_libfuzzer_reports_a_defect(headers: list[Header]) -> None:
    _plant(headers[0], *OVERRUN)
    assert sanitizers.fuzzed(headers[0], 5)
