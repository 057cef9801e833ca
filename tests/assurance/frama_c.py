"""Proves with Frama-C Eva that no function of any generated header has undefined behaviour, whatever it is given.

    python -m tests.assurance.frama_c [SPEC...]

Eva calls every function with all frames, messages, parameters and numbers, including NaN and infinity, and must find no
alarm. Assertions state that a function that returns CANWRIGHT_OK has written all of its outputs.
On Debian: apt-get install frama-c-base
"""

from __future__ import annotations

import argparse
import csv
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from canwright.targets.c.view import edition_view

from ..conformance.adapters.c_signatures import Function, functions
from ..spec_texts import SPECS
from ..tools import run, tool
from .headers import Header, each, write_headers

OPTIONS = (
    *("-machdep", "gcc_x86_64", "-eva", "-eva-precision", "6", "-eva-split-return", "full"),
    *("-warn-special-float", "none", "-eva-verbose", "0", "-kernel-verbose", "0"),
)
PROVEN = ("Valid", "Considered valid")
REACHED = r"\true"
"""The assertion at the end of each call: it is proven if the call returns."""

_COMMENT = re.compile(r"/\*.*?\*/", re.S)
_STRUCT = re.compile(r"typedef struct(?: \w+)? \{([^{}]*)\}\s*(?:\w+\([^;]*\)\s*)?(\w+);", re.S)
_ANY = re.compile(r"typedef struct \{[^{}]*union \{[^{}]*\} as;\s*\} (\w+);", re.S)
_ALIAS = re.compile(r"typedef (\w+) (\w+);")
_MEMBER = re.compile(r"(\w+)(?:\[(\w+)\])?;")


class Driver:
    """A program that calls every function of a header with unknown inputs."""

    def __init__(self, header: Header) -> None:
        self._header = header
        texts = [_COMMENT.sub("", file.read_text("utf-8")) for file in sorted(header.include.rglob("*.h"))]
        self._structs = {name: _MEMBER.findall(body) for text in texts for body, name in _STRUCT.findall(text)}
        self._aliases = {name: kind for text in texts for kind, name in _ALIAS.findall(text)}
        self.functions = functions(header.text)

    def text(self) -> str:
        calls = [self._call(number, function) for number, function in enumerate(self.functions.values())]
        chosen = "".join(f"    if (chosen == {number}) {{ call_{number}(); }}\n" for number in range(len(calls)))
        start = f"#include <{self._header.name}>\n#include <__fc_builtin.h>\n\nstatic volatile int chosen;\n\n"
        return f"{start}{''.join(calls)}int main(void)\n{{\n{chosen}    return 0;\n}}\n"

    def _call(self, number: int, function: Function) -> str:
        lines = []
        outputs = {}
        for parameter, type_ in zip(function.parameters, function.types, strict=True):
            name, kind = parameter.lstrip("*"), type_.replace("const ", "").rstrip("* ")
            lines.append(f"{kind} {name};")
            is_output = parameter.startswith("*") and not type_.startswith("const ")
            if is_output:
                outputs[name] = kind
            if not is_output or function.name.endswith("_pack"):
                lines.append(f"Frama_C_make_unknown((char *)&{name}, sizeof {name});")
        arguments = {name.lstrip("*"): name.lstrip("*") for name in function.parameters}
        result = "" if function.result == "void" else f"{function.result} result = "
        lines.append(f"{result}{function.call(arguments)};")
        written = [line for name, kind in outputs.items() for line in self._initialized(name, kind)]
        if function.result == "canwright_status_t" and written:
            lines += ["if (result == CANWRIGHT_OK) {", *written, "}"]
        else:
            lines += written
        lines.append(f"/*@ assert {REACHED}; */")
        return "".join([f"static void call_{number}(void)\n{{\n", *(f"    {line}\n" for line in lines), "}\n\n"])

    def _initialized(self, name: str, kind: str) -> Iterator[str]:
        """Assertions that all members of a variable are initialized; of a union, those of the command."""
        kind = self._aliases.get(kind, kind)
        if kind in self._structs:
            for member, length in self._structs[kind]:
                elements = f"[0 .. {length.rstrip('u')} - 1]" if length else ""
                yield f"/*@ assert \\initialized(&{name}.{member}{elements}); */"
        elif kind in self._unions:
            yield from (f"/*@ assert \\initialized(&{name}.{member}); */" for member in ("command", "node"))
            for command, member, struct in self._unions[kind]:
                yield f"if ({name}.command == {command}) {{"
                yield from self._initialized(f"{name}.as.{member}", struct)
                yield "}"
        else:
            yield f"/*@ assert \\initialized(&{name}); */"

    @property
    def _unions(self) -> Mapping[str, Sequence[tuple[str, str, str]]]:
        """Command, member and struct of each member of the union of any message, by its type."""
        view = edition_view(self._header.specification.edition)
        return {
            f"{view.prefix}any_{direction.word}_t": [
                (content.command, content.member, f"{layout.name}_t") for layout, content in direction.members
            ]
            for direction in view.directions
        }


def unproven(header: Header) -> list[str]:
    """The properties of a header that are not proven, or that it does not return from a call."""
    driver = Driver(header)
    source, table = header.unit.with_suffix(".driver.c"), header.unit.with_suffix(".csv")
    source.write_text(driver.text(), "utf-8")
    run(tool("frama-c"), *OPTIONS, f"-cpp-extra-args=-I{header.include}", source, "-then", "-report-csv", table)
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    found = [row for row in rows if row["status"] not in PROVEN]
    assert sum(row["property"] == REACHED for row in rows) == len(driver.functions)
    return [f"{row['file']}:{row['line']}: {row['status']}: {row['property']} ({row['function']})" for row in found]


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints what is not proven; the exit status is 1 if anything is not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("specs", nargs="*", type=Path, metavar="SPEC", default=SPECS)
    chosen = parser.parse_args(arguments)
    tool("frama-c")
    with tempfile.TemporaryDirectory() as name:
        headers = write_headers(Path(name), chosen.specs)
        wrong = [
            f"{header.name}: {line}"
            for header, found in zip(headers, each(unproven, headers), strict=True)
            for line in found
        ]
        calls = sum(len(Driver(header).functions) for header in headers)
    print("\n".join(wrong) or f"{len(headers)} headers, {calls} functions: no alarm, and all assertions are proven")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
