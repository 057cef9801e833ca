"""Proves with Frama-C Eva that no function of an edition has undefined behaviour, whatever it is given.

    python -m tests.verification.frama_c [SPEC...]

Eva calls every function of the edition and float headers with all frames, messages, parameters, raw integers and finite
values, and must find no alarm but those of BEYOND_EVA. Assertions state that a function that returns CANWRIGHT_OK has
written all of its outputs. Infinity and NaN are left to the sanitizers: Eva does not conclude from a comparison that a
number is not NaN. The headers that print are not covered: their wide integers take Eva too long.
On Debian: apt-get install frama-c-base
"""

from __future__ import annotations

import argparse
import csv
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..spec_texts import SPECS
from ..tools import run, tool
from .calls import Calls
from .headers import Header, each, write_headers

OPTIONS = (
    *("-machdep", "gcc_x86_64", "-eva", "-eva-precision", "6", "-eva-split-return", "full"),
    *("-warn-special-float", "none", "-eva-verbose", "0", "-kernel-verbose", "0"),
)
PROVEN = ("Valid", "Considered valid")
BEYOND_EVA: Mapping[re.Pattern[str], str] = {
    re.compile(r"-\d+ ≤ .*\bwhole\b.* \(canwright_signed(?:32_from_float|64_from_float|64_from_double)\)"): (
        "The lowest integer is not rounded down further: a number of this magnitude has no fraction."
    ),
    re.compile(r"(?:≤ \d+|-\d+ ≤ .*) \(canwright_(?:share64|divide64)\)"): (
        "The products fit: |share| is at most `most * ratio`. Eva does not relate numbers by a product."
    ),
    re.compile(r"Dead: .*\.as\."): "A reply with the layout of another command's reply is identified as that one.",
}
"""Alarms that Eva cannot exclude, and why they cannot occur."""

FINITE = {
    "float": "{0} = Frama_C_float_interval(-FLT_MAX, FLT_MAX);",
    "double": "{0} = Frama_C_double_interval(-DBL_MAX, DBL_MAX);",
}
UNKNOWN = "Frama_C_make_unknown((char *)&{0}, sizeof {0});"
REACHED = r"\true"
"""The assertion at the end of each call: it is proven if the call returns."""


def driver(header: Header) -> tuple[str, int]:
    """A program that calls every function of a header with unknown inputs, and the number of functions."""

    def fill(name: str, kind: str) -> str:
        return FINITE.get(kind, UNKNOWN).format(name)

    bodies = Calls(header, fill, "/*@ assert \\initialized(&{0}); */".format).bodies()
    calls = "".join(
        f"static void call_{number}(void)\n{{\n{body}    /*@ assert {REACHED}; */\n}}\n\n"
        for number, body in enumerate(bodies)
    )
    chosen = "".join(f"    if (chosen == {number}) {{ call_{number}(); }}\n" for number in range(len(bodies)))
    start = (
        f"#include <{header.name}>\n#include <float.h>\n#include <__fc_builtin.h>\n\nstatic volatile int chosen;\n\n"
    )
    return f"{start}{calls}int main(void)\n{{\n{chosen}    return 0;\n}}\n", len(bodies)


def unproven(header: Header) -> list[str]:
    """The properties of a header that are not proven, or that it does not return from a call."""
    text, count = driver(header)
    source, table = header.unit.with_suffix(".driver.c"), header.unit.with_suffix(".csv")
    source.write_text(text, "utf-8")
    run(tool("frama-c"), *OPTIONS, f"-cpp-extra-args=-I{header.include}", source, "-then", "-report-csv", table)
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    assert sum(row["property"] == REACHED for row in rows) == count
    alarms = [
        f"{row['file']}:{row['line']}: {row['status']}: {row['property']} ({row['function']})"
        for row in rows
        if row["status"] not in PROVEN
    ]
    return [line for line in alarms if not any(known.search(line) for known in BEYOND_EVA)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints what is not proven; the exit status is 1 if anything is not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("specs", nargs="*", type=Path, metavar="SPEC", default=SPECS)
    chosen = parser.parse_args(arguments)
    tool("frama-c")
    with tempfile.TemporaryDirectory() as name:
        headers = [header for header in write_headers(Path(name), chosen.specs) if header.part != "print"]
        wrong = [
            f"{header.name}: {line}"
            for header, lines in zip(headers, each(unproven, headers), strict=True)
            for line in lines
        ]
        calls = sum(driver(header)[1] for header in headers)
    print(
        "\n".join(wrong)
        or f"{len(headers)} headers, {calls} functions: no alarm but those of BEYOND_EVA, and all assertions are proven"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
