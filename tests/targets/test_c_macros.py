"""Macros of C headers against the model: units, scales, the reply time-out and what a device can report; and flags."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
from canwright.conformance.adapter import CanFrame
from canwright.model.message import Direction
from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.c.names import Names
from canwright.targets.c.target import CTarget
from canwright.targets.c.text import literal

from ..conformance.adapters.c import CAdapter
from ..spec_texts import MINIMAL, SPECS, called

FLAGS = MINIMAL.replace(
    'level: {raw: u16, unit: "%", scale: 0.1, raw_range: 0..1000}',
    "level: {raw: u48, flags: {first: {bit: 0}, middle: {bit: 33}, last: {bit: 47}}}",
)

WITHOUT_CONSTANT_SCALE = {"hoist", "stack"}
"""Specs whose types have a scale that depends on a parameter, or none: texts and digits."""


def macros(edition_input: EditionInput) -> dict[str, str]:
    header = next(
        o.text
        for o in CTarget().generate([edition_input], {})
        if o.path.endswith(f"/{edition_input.edition.identifier}.h")
    )
    return dict(re.findall(r'^#define (\w+) +(".*?"|\S+)', header, re.M))


@pytest.mark.parametrize("spec", SPECS, ids=called)
def test_macros_have_the_numbers_of_the_spec(spec: Path) -> None:
    edition_input = specification(spec)
    edition, definitions = edition_input.edition, macros(edition_input)
    names = Names(edition)
    assert definitions[names.upper("edition")] == f'"{edition.name}"'
    assert definitions[names.upper("spec_hash")] == f'"{edition.hash}"'
    assert definitions[names.upper("spec")] == f"0x{edition.hash[:8]}u"
    within = edition.bus.reply_within_ms
    assert definitions.get(names.upper("reply_within_us")) == (None if within is None else f"{within * 1000}u")
    used = {f.type.name for message in edition.all_messages() for f in message.layout.fields}
    count = 0
    for type_ in (t for t in edition.types if t.name in used):
        stem = names.type_stem(type_)
        unit = definitions.get(names.upper(stem, "unit"))
        assert unit == (f'"{type_.unit.dbc}"' if type_.unit else None)
        parts = [definitions.get(names.upper(stem, e)) for e in ("scale_num", "scale_den", "offset_num", "offset_den")]
        linear = type_.linear.constant
        if not type_.is_number or linear is None or linear.times or (type_.is_plain and not type_.unit):
            assert parts == [None] * 4
            continue
        above, below, plus, under = (int((part or "").strip("()")) for part in parts)
        assert (Fraction(above, below), Fraction(plus, under)) == (linear.scale, linear.offset)
        count += 1
    assert count == sum(name.endswith("_SCALE_NUM") for name in definitions)
    assert (count == 0) == (edition.family in WITHOUT_CONSTANT_SCALE)


def test_flags_without_a_name_and_above_32_bits(tmp_path: Path) -> None:
    file = tmp_path / "spec.yaml"
    file.write_text(FLAGS, "utf-8")
    target = CAdapter.create(specification(file), tmp_path)
    for raw, text in (
        (0, "none"),
        (1 << 47 | 1 << 33 | 1, "first|middle|last"),
        (1 << 46 | 1 << 33 | 2, "0x2|middle|0x400000000000"),
    ):
        frame = CanFrame(0x101, b"\x10\0" + raw.to_bytes(6, "little"))
        assert target.text(Direction.REQUEST, frame, {})[1] == f"dim request, node 1: level={text}"


def test_a_literal_is_ascii_and_cannot_end_early() -> None:
    assert literal('a"b\\c?d\n°1') == r'"a\042b\134c\077d\012\302\2601"'
