"""A rename alone is a change of the bindings; another title, unit or type as well is another meaning, unless stated."""

from __future__ import annotations

from pathlib import Path

import pytest
from canwright.compare import compare

from ..spec_texts import edition
from .recorded import findings

SPEC = """\
canwright: 1
family: lamp
edition: v1
addresses: {lamp: {id: 0x100 + node, nodes: 1..4}}
selector: {at: 0, raw: u8}
types:
  state: {raw: u8, enum: {dark: 0, bright: {value: 1, title: Bright}}}
  alarms: {raw: u8, flags: {hot: {bit: 0, title: Hot}}}
tables:
  store: {index: {at: 1, raw: u8}, entries: {gain: {index: 1, title: Gain, layout: {gain: {at: 4, raw: u16}}}}}
commands:
  dim: {title: Dim, code: 0x10, request: {level: {at: 2, raw: u16, title: Level}}, reply: echo}
  read: {code: 0x11, reply: {state: {at: 1, type: state}, alarms: {at: 2, type: alarms}}}
  write: {code: 0x12, table: store, request: entry, reply: none}
"""


@pytest.mark.parametrize(
    ("old", "name", "title", "renamed", "reused"),
    [
        ("dim: {title: Dim,", "fade", "Fade of it", "command-renamed(command dim)", "command-repurposed(command dim)"),
        (
            "level: {at: 2, raw: u16, title: Level",
            "rate",
            "Rate of it",
            "field-renamed(command dim)",
            "field-replaced(command dim)",
        ),
        (
            "bright: {value: 1, title: Bright",
            "broken",
            "Broken of it",
            "member-renamed(type state)",
            "member-replaced(type state)",
        ),
        ("hot: {bit: 0, title: Hot", "wet", "Wet of it", "member-renamed(type alarms)", "member-replaced(type alarms)"),
        (
            *("gain: {index: 1, title: Gain,", "bias", "Bias of it"),
            *("entry-renamed(entry store.gain)", "entry-repurposed(entry store.gain)"),
        ),
    ],
)
def test_a_reused_name_is_another_item(
    old: str, name: str, title: str, renamed: str, reused: str, tmp_path: Path
) -> None:
    original, (was, _, rest) = edition(tmp_path, SPEC), old.partition(":")
    new = f"{name}:{rest}"
    titled = new.replace(f"title: {old.partition('title: ')[2].rstrip(',')}", f"title: {title}")
    stated = titled.replace("{", f"{{renamed_from: {was}, ", 1)
    assert SPEC.count(old) == 1 and len({old, new, titled, stated}) == 4

    def found(written: str) -> str:
        return findings(compare(original, edition(tmp_path, SPEC.replace(old, written))))

    assert found(new) == f"build {renamed}"
    assert found(titled) == f"silent {reused}"
    item = renamed.partition("(")[2]
    assert found(stated) == f"build {renamed}, safe title-changed({item}"


def test_a_former_name_refers_to_the_other_edition(tmp_path: Path) -> None:
    """Names that are exchanged; then an edition without changes, with the same statements; then the way back."""
    exchanged = SPEC.replace("dim: {title: Dim,", "read_all: {title: Dim, renamed_from: dim,")
    exchanged = exchanged.replace("  read: {code", "  dim: {renamed_from: read, title: All of it, code")
    old, new = edition(tmp_path, SPEC), edition(tmp_path, exchanged)
    renamed = (
        "build command-renamed(command dim), build command-renamed(command read), safe title-changed(command read)"
    )
    assert findings(compare(old, new)) == renamed
    assert findings(compare(new, new)) == "none"
    back = (
        "build command-renamed(command dim), build command-renamed(command read_all), safe title-changed(command dim)"
    )
    assert findings(compare(new, old)) == back


def test_values_without_a_renamed_effect_are_unchanged(tmp_path: Path) -> None:
    text = SPEC.replace("types:", "effects: {glows: {title: A light}}\ntypes:").replace(
        "dark: 0", "dark: {value: 0, without_effects: [glows]}"
    )
    text = text.replace("request: {level", "effects: [glows], request: {state: {at: 1, type: state}, level")
    old, new = edition(tmp_path, text), edition(tmp_path, text.replace("glows", "shines"))
    assert findings(compare(old, new)) == "build effect-renamed(effect glows)"
