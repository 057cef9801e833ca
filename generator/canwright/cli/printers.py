"""Formats of findings: text, JSON, GitHub annotations, SARIF."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .. import __version__
from ..diagnostics.diagnostic import Diagnostic, Position, Severity
from ..rules import ALL_RULES
from .terminal import bold, json_text

_COLOURS = {Severity.ERROR: "red", Severity.WARNING: "yellow"}


def text(findings: Sequence[Diagnostic]) -> str:
    """`file:line:col: severity: message [rule]`, the source line, a caret and the hint; in colour on a terminal."""
    return "\n".join(map(_coloured, findings))


def _coloured(finding: Diagnostic) -> str:
    head, *rest = str(finding).split("\n")
    at, colour = finding.position, _COLOURS[finding.severity]
    place, severity = f"{at.file}:{at.line}:{at.column}:", f"{finding.severity.value}:"
    message = head[len(place) + 1 + len(severity) :]
    lines = [bold(place) + " " + bold(severity, colour) + message]
    for i, line in enumerate(rest):
        caret = bool(at.text) and i == 1
        lines.append(bold(line, colour) if caret else line)
    return "\n".join(lines)


def as_json(findings: Sequence[Diagnostic]) -> str:
    """An object with `findings`: file, line, column, end_column, severity, rule, message, hint and related positions."""
    listed = [
        {
            "file": d.position.file,
            "line": d.position.line,
            "column": d.position.column,
            "end_column": d.position.column + max(1, d.position.length),
            "severity": d.severity.value,
            "rule": d.rule,
            "message": d.message,
            "hint": d.hint,
            "related": [
                {"file": at.file, "line": at.line, "column": at.column, "item": item} for at, item in d.related
            ],
        }
        for d in findings
    ]
    return json_text({"findings": listed})


def github(findings: Sequence[Diagnostic]) -> str:
    """Workflow commands that GitHub shows at the lines of a change."""
    return "\n".join(map(_annotation, findings))


def _annotation(finding: Diagnostic) -> str:
    message = "\n".join(filter(None, (finding.message, *finding.related_lines, finding.hint)))
    return annotation(finding.severity.value, finding.position, finding.rule, message)


def annotation(level: str, at: Position, title: str, message: str) -> str:
    """One workflow command of GitHub; `level` is error, warning or notice."""
    places = f"file={_property(at.file)},line={at.line},col={at.column},title={_property(title)}"
    return f"::{level} {places}::{_escaped(message)}"


def _escaped(written: str) -> str:
    return written.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(written: str) -> str:
    return _escaped(written).replace(":", "%3A").replace(",", "%2C")


def sarif(findings: Sequence[Diagnostic]) -> str:
    """SARIF 2.1.0, one run."""
    rules = [{"id": r, "shortDescription": {"text": ALL_RULES[r].purpose}} for r in sorted({d.rule for d in findings})]
    driver = {"name": "canwright", "version": __version__, "rules": rules}
    return json_text(
        {
            "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
            "version": "2.1.0",
            "runs": [{"tool": {"driver": driver}, "results": [_result(d) for d in findings]}],
        }
    )


def _result(finding: Diagnostic) -> dict[str, Any]:
    message = f"{finding.message}; {finding.hint}" if finding.hint else finding.message
    related = [{**_location(at), "id": i, "message": {"text": item}} for i, (at, item) in enumerate(finding.related, 1)]
    return {
        "ruleId": finding.rule,
        "level": finding.severity.value,
        "message": {"text": message},
        "locations": [_location(finding.position)],
        **({"relatedLocations": related} if related else {}),
    }


def _location(at: Position) -> dict[str, Any]:
    region = {"startLine": at.line, "startColumn": at.column, "endColumn": at.column + max(1, at.length)}
    return {"physicalLocation": {"artifactLocation": {"uri": at.file}, "region": region}}


PRINTERS: Mapping[str, Callable[[Sequence[Diagnostic]], str]] = {
    "text": text,
    "json": as_json,
    "github": github,
    "sarif": sarif,
}
