"""Runs static analyzers over every function of every generated header: clang-tidy, clang's analyzer and GCC's.

    python -m tests.verification.analyzers

Nothing may be found. On Debian: apt-get install clang clang-tidy gcc
"""

from __future__ import annotations

import argparse
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..targets.test_c_compiles import everything
from ..tools import output, tool
from .headers import Header, each, write_headers

CHECKS = ("bugprone-*", "cert-*", "clang-analyzer-*", "misc-*", "portability-*")
NOT_CHECKED = ("bugprone-easily-swappable-parameters",)
"""Two numbers in a row are as easy to swap in every C function that has them; the names of parameters are in the header."""

_HEADERS = ("-Xclang", "-analyzer-opt-analyze-headers")
"""Without it, clang analyzes functions of the main file only."""

ANALYZERS: Mapping[str, Sequence[str]] = {
    "clang-tidy": (
        *("--quiet", f"--checks={','.join(('-*', *CHECKS, *(f'-{check}' for check in NOT_CHECKED)))}"),
        *("--header-filter=.*", *(f"--extra-arg={argument}" for argument in ("-std=c99", *_HEADERS))),
    ),
    "clang": ("--analyze", "-std=c99", "-Wall", "-Wextra", *_HEADERS, "-Xclang", "-analyzer-output=text"),
    "gcc": ("-fanalyzer", "-std=c99", "-O1", "-Wall", "-Wextra", "-c", "-o", "/dev/null"),
}
"""The arguments of each analyzer, without the file and the folder of headers."""

_FINDING = re.compile(r"^.*?:\d+:\d+: (?:warning|error|fatal error): .*$", re.M)


def findings(analyzer: str, unit: Path, include: Path) -> list[str]:
    """The findings of an analyzer in a C file and its headers."""
    ending = ("--", f"-I{include}") if analyzer == "clang-tidy" else (f"-I{include}",)
    return _FINDING.findall(output(tool(analyzer), *ANALYZERS[analyzer], unit, *ending))


def all_findings(header: Header) -> list[str]:
    """The findings of every analyzer in a header and those that it includes."""
    names = (header.name.replace(f"_{header.part}.h", ".h"), header.name)
    unit = header.unit.with_suffix(".all.c")
    unit.write_text(everything(header.include, names), "utf-8")
    return [f"{analyzer}: {line}" for analyzer in ANALYZERS for line in findings(analyzer, unit, header.include)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the findings; the exit status is 1 with any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args(arguments)
    for analyzer in ANALYZERS:
        tool(analyzer)
    with tempfile.TemporaryDirectory() as name:
        outermost = [header for header in write_headers(Path(name)) if header.part]
        reports = sorted({line.replace(f"{name}/", "") for lines in each(all_findings, outermost) for line in lines})
    print("\n".join(reports) or f"{len(outermost)} headers, {len(ANALYZERS)} analyzers: no finding")
    return 1 if reports else 0


if __name__ == "__main__":
    raise SystemExit(main())
