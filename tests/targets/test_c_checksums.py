"""CRCs in C, bit by bit and by a table, with the check values of the catalogue."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest
from canwright.conformance.adapter import write_files
from canwright.model.checksum import ALGORITHMS, Arithmetic
from canwright.project.loader import specification
from canwright.targets.c.target import CTarget

from ..compilers import SANITIZED, build
from ..semantics.test_checksum import BY_PARAMETERS, NAMED

CRCS: Mapping[str, tuple[int | None, str, int]] = {
    **{
        name: (of.width, f"algorithm: {name}", NAMED[name])
        for name, of in ALGORITHMS.items()
        if of.arithmetic is Arithmetic.CRC
    },
    **BY_PARAMETERS,
}
"""The width of each CRC, what a spec says, and the checksum of `123456789`."""
SPEC = """\
canwright: 1
family: catalogue
edition: v1
addresses: {device: {id: 0, selector: {at: id.0, raw: u11}}}
commands:
"""
COMMAND = """\
  crc_{number}:
    code: {number}
    request:
      digits: {{at: 0, raw: u32}}
      check: {{at: 4, raw: u{width}, byte_order: little, checksum: {{{checksum}, over: [0..3, "35 36 37 38 39"]}}}}
    reply: none
"""
PROGRAM = """\
#include <stdio.h>
#include "catalogue/v1.h"
int main(void)
{
    const canwright_frame_t frame = {0u, 8u, {0u, 0u, 0u}, {'1', '2', '3', '4', 0xFFu, 0xFFu, 0xFFu, 0xFFu}};
%s
    return 0;
}
"""


@pytest.mark.parametrize("flags", [(), ("-DCANWRIGHT_CRC_TABLE",)], ids=["bit by bit", "table"])
@pytest.mark.parametrize("standard", ["c99", "c++17"])
def test_the_check_values_of_the_catalogue(standard: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    spec = tmp_path / "catalogue.yaml"
    commands = [COMMAND.format(number=n, width=c[0], checksum=c[1]) for n, c in enumerate(CRCS.values())]
    spec.write_text(SPEC + "".join(commands), "utf-8")
    folder = write_files(CTarget().generate([specification(spec)], {}), tmp_path)
    source = tmp_path / "checksums.c"
    calls = [f'    printf("%X\\n", (unsigned)catalogue_v1_crc_{n}_request_sum(&frame));' for n in range(len(CRCS))]
    source.write_text(PROGRAM % "\n".join(calls), "utf-8")
    options = ("-O0", "-g0", *SANITIZED, *flags, *(("-x", "c++") if standard != "c99" else ()))
    program = build([source], folder / "include", tmp_path / "checksums", *options, standard=standard)
    printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    assert [int(value, 16) for value in printed] == [check for _, _, check in CRCS.values()]
