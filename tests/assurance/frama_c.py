"""Proves with Frama-C Eva that no function of an edition has undefined behaviour, whatever it is given.

    python -m tests.assurance.frama_c [SPEC...]

Eva calls every function with all frames, messages, parameters and raw integers, and must find no alarm. The headers of
floating point are not covered: their wide integers take Eva too long. Assertions state that a function that returns
CANWRIGHT_OK has written all of its outputs.
On Debian: apt-get install frama-c-base
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from collections.abc import Sequence
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
REACHED = r"\true"
"""The assertion at the end of each call: it is proven if the call returns."""


def driver(header: Header) -> tuple[str, int]:
    """A program that calls every function of a header with unknown inputs, and the number of functions."""
    fill, check = "Frama_C_make_unknown((char *)&{0}, sizeof {0});", "/*@ assert \\initialized(&{0}); */"
    bodies = Calls(header, fill.format, check.format).bodies()
    calls = "".join(
        f"static void call_{number}(void)\n{{\n{body}    /*@ assert {REACHED}; */\n}}\n\n"
        for number, body in enumerate(bodies)
    )
    chosen = "".join(f"    if (chosen == {number}) {{ call_{number}(); }}\n" for number in range(len(bodies)))
    start = f"#include <{header.name}>\n#include <__fc_builtin.h>\n\nstatic volatile int chosen;\n\n"
    return f"{start}{calls}int main(void)\n{{\n{chosen}    return 0;\n}}\n", len(bodies)


def unproven(header: Header) -> list[str]:
    """The properties of a header that are not proven, or that it does not return from a call."""
    text, count = driver(header)
    source, table = header.unit.with_suffix(".driver.c"), header.unit.with_suffix(".csv")
    source.write_text(text, "utf-8")
    run(tool("frama-c"), *OPTIONS, f"-cpp-extra-args=-I{header.include}", source, "-then", "-report-csv", table)
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    found = [row for row in rows if row["status"] not in PROVEN]
    assert sum(row["property"] == REACHED for row in rows) == count
    return [f"{row['file']}:{row['line']}: {row['status']}: {row['property']} ({row['function']})" for row in found]


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints what is not proven; the exit status is 1 if anything is not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("specs", nargs="*", type=Path, metavar="SPEC", default=SPECS)
    chosen = parser.parse_args(arguments)
    tool("frama-c")
    with tempfile.TemporaryDirectory() as name:
        headers = [header for header in write_headers(Path(name), chosen.specs) if not header.part]
        wrong = [
            f"{header.name}: {line}"
            for header, found in zip(headers, each(unproven, headers), strict=True)
            for line in found
        ]
        calls = sum(driver(header)[1] for header in headers)
    print("\n".join(wrong) or f"{len(headers)} headers, {calls} functions: no alarm, and all assertions are proven")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
