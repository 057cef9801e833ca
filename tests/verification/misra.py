"""Checks the generated headers against MISRA C:2012 with the addon of cppcheck.

    python -m tests.verification.misra

Every rule with a violation must have a row in the table of deviations of `templates/c/MISRA.md.j2`, which is part of the
generated C, and every row that cppcheck can check must have a violation. The texts of the rules belong to MISRA; cppcheck
prints their numbers. The self-test, a program of its own, and the header for C++ are not covered. On Debian: apt-get install cppcheck
"""

from __future__ import annotations

import argparse
import re
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ..spec_texts import SPECS
from ..tools import output, tool
from .headers import Header, each, write_headers

CHECKS = "warning,performance,portability"
"""The groups of cppcheck's own checks; its group `style` includes advice that MISRA contradicts."""

PLANTED = "extern int planted;\nint planted = 07;\n"
"""A violation after the header. cppcheck skips a file without a word if a header has an `#error`, and then misses it."""

PLANTED_RULE = "7.1"

_ROW = re.compile(r"^\| (\d+\.\d+) \|", re.M)
_FINDING = re.compile(r"^(?P<place>.+?:\d+): (?P<id>\S+) (?P<message>.*)$")
_MISRA = "misra-c2012-"


class Finding(NamedTuple):
    """A place in a file, the id of a check, and its message."""

    place: str
    id: str
    message: str

    @property
    def rule(self) -> str:
        """The MISRA rule; empty for a check of cppcheck itself."""
        return self.id.removeprefix(_MISRA) if self.id.startswith(_MISRA) else ""


def findings(headers: Sequence[Header]) -> list[Finding]:
    """All findings in the headers, each once. The headers of conversions and of printing include that of the edition."""
    outermost = [header for header in headers if header.part]
    return sorted({finding for group in each(lambda header: list(_findings(header)), outermost) for finding in group})


def _findings(header: Header) -> Iterator[Finding]:
    unit = header.unit.with_suffix("") / "planted.c"  # cppcheck writes files beside it
    unit.parent.mkdir(exist_ok=True)
    unit.write_text(header.unit.read_text("utf-8") + PLANTED, "utf-8")
    command = (
        tool("cppcheck"),
        "--quiet",
        "--std=c99",
        "--addon=misra",
        f"--enable={CHECKS}",
        "-U__cplusplus",
        "-DDBL_MANT_DIG=53",
        "-DFLT_MANT_DIG=24",
    )
    template = ("--template={file}:{line}: {id} {message}", "--template-location=")
    reported = [_finding(line) for line in output(*command, *template, f"-I{header.include}", unit).splitlines()]
    if not any(finding.rule == PLANTED_RULE and finding.place.startswith(str(unit)) for finding in reported):
        yield Finding(header.name, "skipped", "cppcheck did not check this header")
    yield from (finding for finding in reported if not finding.place.startswith(str(unit)))


def _finding(line: str) -> Finding:
    match = _FINDING.match(line)
    assert match is not None, line
    return Finding(match["place"], match["id"], match["message"])


def deviations(page: str) -> set[str]:
    """The rules in the table of deviations."""
    return set(_ROW.findall(page))


def problems(reported: Sequence[Finding], allowed: set[str]) -> Iterator[str]:
    """Findings without a deviation, and deviations without a finding."""
    for finding in reported:
        if finding.rule not in allowed:
            yield f"{finding.place}: {finding.id} {finding.message}"
    for rule in sorted(allowed - {finding.rule for finding in reported}):
        yield f"rule {rule} has a deviation but no violation"


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the problems, or the number of violations of each rule; the exit status is 1 with problems."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        headers = write_headers(Path(name), SPECS)
        allowed = deviations((headers[0].include.parent / "MISRA.md").read_text("utf-8"))
        reported = findings(headers)
        wrong = [problem.replace(f"{name}/", "") for problem in problems(reported, allowed)]
    print("\n".join(wrong) or _summary(len(headers), Counter(finding.rule for finding in reported)))
    return 1 if wrong else 0


def _summary(headers: int, rules: Mapping[str, int]) -> str:
    counts = ", ".join(f"{rule}: {count}" for rule, count in sorted(rules.items()))
    return f"{headers} headers, no violation without a deviation; violations with one: {counts}"


if __name__ == "__main__":
    raise SystemExit(main())
