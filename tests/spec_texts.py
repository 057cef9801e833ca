"""Small specs for tests, and what goes wrong with them."""

from __future__ import annotations

from pathlib import Path

from canwright.diagnostics.diagnostic import Diagnostic, SpecError
from canwright.model.edition import Edition
from canwright.project.loader import spec_files, specification

ROOT = Path(__file__).parent.parent
SMALL = spec_files(ROOT / "tests/specs")
"""Small whole specs, which use what those of `spec/` do not."""
SPECS = [*spec_files(ROOT / "spec"), *SMALL]
"""Every whole spec there is."""
WITHOUT_SETTINGS_IN_IDS = [
    file
    for file in SPECS
    if all(message.id.parameter is None for message in specification(file).edition.all_messages())
]
"""Those whose ids depend on no parameter, so that a log without `--set` can be read."""


MINIMAL = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
types:
  level: {raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}
commands:
  dim:
    code: 0x10
    manual: "1"
    request: {level: {at: 2, type: level}}
    reply: echo
"""


def called(file: Path) -> str:
    """What a test calls a spec file."""
    return f"{file.parent.name}/{file.stem}"


def edition(folder: Path, text: str) -> Edition:
    """The edition that a text describes."""
    file = folder / "spec.yaml"
    file.write_text(text, "utf-8")
    return specification(file).edition


def findings(folder: Path, text: str) -> list[Diagnostic]:
    """What is wrong with a text; nothing when it is right."""
    try:
        edition(folder, text)
    except SpecError as error:
        return list(error.diagnostics)
    return []


def places(diagnostics: list[Diagnostic]) -> list[str]:
    """Findings as `line:column rule`."""
    return [f"{d.position.line}:{d.position.column} {d.rule}" for d in diagnostics]


def marked(diagnostics: list[Diagnostic]) -> list[str]:
    """Findings as `rule: what the caret underlines`."""
    return [f"{d.rule}: {d.position.text[d.position.column - 1 :][: d.position.length]}" for d in diagnostics]
