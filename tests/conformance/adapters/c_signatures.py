"""What a generated header declares: its functions, and how to call one with arguments that are known by name."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass

_FUNCTION = re.compile(r"^static inline (?P<result>.+?)(?P<name>\w+)\(\s*(?P<parameters>[^)]*?)\s*\)\s*\{", re.M)
_PARAMETER = re.compile(r"(?P<type>.+?)(?P<name>\w+)$")


@dataclass(frozen=True)
class Function:
    """A function: its result, and names and types of its parameters; a name has a `*` before it for a pointer."""

    name: str
    result: str
    parameters: tuple[str, ...]
    types: tuple[str, ...]

    def call(self, arguments: Mapping[str, str]) -> str:
        """A call; `arguments` are variables by the names of parameters, and what is a pointer gets their address."""
        given = [f"&{arguments[p[1:]]}" if p.startswith("*") else arguments[p] for p in self.parameters]
        return f"{self.name}({', '.join(given)})"


@dataclass(frozen=True)
class Stored:
    """The type of a raw integer in C: `integer`, or the struct `kind`, whose member `bits` is one."""

    kind: str

    @property
    def bits(self) -> str:
        """What follows a variable."""
        return ".bits" if self.kind.startswith("canwright_float") else ""

    @property
    def integer(self) -> str:
        return self.kind.replace("canwright_float", "uint")


@functools.cache
def functions(header: str) -> Mapping[str, Function]:
    """The functions of a header by name."""
    by_name = {}
    for match in _FUNCTION.finditer(header):
        parameters = [
            parameter.strip() for parameter in match["parameters"].split(",") if parameter.strip() not in ("", "void")
        ]
        names, types = [], []
        for parameter in parameters:
            parts = _PARAMETER.match(parameter)
            assert parts is not None, parameter
            names.append(("*" if "*" in parts["type"] else "") + parts["name"])
            types.append(parts["type"].strip())
        by_name[match["name"]] = Function(match["name"], match["result"].strip(), tuple(names), tuple(types))
    return by_name
