"""Small specs for tests, and what goes wrong with them."""

from __future__ import annotations

from pathlib import Path

import yaml
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


NAMED = frozenset(
    (
        *("addresses", "parameters", "settings", "effects", "states", "modes", "types", "layouts", "tables", "entries"),
        *("commands", "fields", "layout", "request", "reply", "enum", "flags", "no_value", "values", "neighbours"),
        *("scale", "offset", "range", "raw_range"),
    )
)
"""Keys of the language below which the keys are, or can be, names: the output is in their order."""
MEANT_ORDER = frozenset(("addresses", "states", "modes", "no_value"))
"""Those of which the first is the usual address or mode, the state after power-up, or what an encoder sends for no value."""


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


def reversed_keys(text: str, kept: frozenset[str]) -> str:
    """A spec with the keys of all mappings in the opposite order, except of those below some keys."""
    root = yaml.compose(text, yaml.CSafeLoader)
    assert root is not None
    _reverse(root, is_kept=False, kept=kept)
    return yaml.serialize(root, width=60)


def _reverse(node: yaml.Node, *, is_kept: bool, kept: frozenset[str]) -> None:
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            _reverse(value, is_kept=key.value in kept, kept=kept)
        if not is_kept:
            node.value.reverse()
    elif isinstance(node, yaml.SequenceNode):
        for item in node.value:
            _reverse(item, is_kept=False, kept=kept)
