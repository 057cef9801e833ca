"""C functions that call every function of a generated header, with inputs and checks of the caller's choice."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence

from canwright.model.metadata import FrameFormat
from canwright.targets.c.view import edition_view

from ..conformance.adapters.c_signatures import Function, functions
from .headers import Header

_COMMENT = re.compile(r"/\*.*?\*/", re.S)
_STRUCT = re.compile(r"typedef struct \{([^{}]*)\} (\w+);")
_ALIAS = re.compile(r"typedef (\w+) (\w+);")
_MEMBER = re.compile(r"(\w+)(?:\[(\w+)\])?;")
_BUFFER = ("char text[64];", "size_t size = sizeof text;", "canwright_printer_t printer = {text, size, 0u};")
"""Variables for functions that print."""


class Calls:
    """Calls of the functions of a header.

    `fill` is the statement that sets a variable of a type to any value, and `check` the one that requires a place to be
    initialized. Outputs are checked if the function does not report an error.
    """

    def __init__(self, header: Header, fill: Callable[[str, str], str], check: Callable[[str], str]) -> None:
        self._fill, self._check = fill, check
        texts = [_COMMENT.sub("", file.read_text("utf-8")) for file in sorted(header.include.rglob("*.h"))]
        self._structs = {name: _MEMBER.findall(body) for text in texts for body, name in _STRUCT.findall(text)}
        self._aliases = {name: kind for text in texts for kind, name in _ALIAS.findall(text)}
        self._unions = _unions(header)
        self.functions = list(functions(header.text).values())

    def bodies(self) -> list[str]:
        """The statements of a call of each function."""
        return ["".join(f"    {line}\n" for line in self._lines(function)) for function in self.functions]

    def _lines(self, function: Function) -> Iterator[str]:
        outputs = {}
        prints = "char *" in function.types or "canwright_printer_t *" in function.types
        yield from _BUFFER if prints else ()
        for parameter, type_ in zip(function.parameters, function.types, strict=True):
            name, kind = parameter.lstrip("*"), type_.replace("const ", "").rstrip("* ")
            if prints and name in ("text", "size", "printer"):
                continue
            is_output = parameter.startswith("*") and not type_.startswith("const ")
            if is_output:
                outputs[name] = kind
            yield f"{kind} {name};"
            if not is_output or function.name.endswith("_pack"):
                yield self._fill(name, kind)
        call = function.call({name.lstrip("*"): name.lstrip("*") for name in function.parameters})
        call = call.replace("&text", "text")
        written = [line for name, kind in outputs.items() for line in self._initialized(name, kind)]
        if function.result == "canwright_status_t":
            yield f"const canwright_status_t result = {call};"
            yield from ("if (result == CANWRIGHT_OK) {", *written, "}")
        else:
            yield from (f"(void){call};", *written)

    def _initialized(self, name: str, kind: str) -> Iterator[str]:
        """Checks that all members of a variable are initialized; of a union, those of the command."""
        kind = self._aliases.get(kind, kind)
        if kind in self._unions:
            yield from (self._check(f"{name}.{member}") for member in ("command", "node"))
            for command, member, struct in self._unions[kind]:
                yield f"if ({name}.command == {command}) {{"
                yield from self._initialized(f"{name}.as.{member}", struct)
                yield "}"
        elif kind in self._structs:
            for member, length in self._structs[kind]:
                for element in [f"[{i}]" for i in range(_length(length))] if length else [""]:
                    yield self._check(f"{name}.{member}{element}")
        else:
            yield self._check(name)


def _length(text: str) -> int:
    formats = {"CANWRIGHT_MAX_DATA": FrameFormat.CLASSIC, "CANWRIGHT_FD_MAX_DATA": FrameFormat.FD}
    return formats[text].max_data_bytes if text in formats else int(text)


def _unions(header: Header) -> Mapping[str, Sequence[tuple[str, str, str]]]:
    """Command, member and struct of each member of the union of any message, by the type that contains it."""
    view = edition_view(header.specification.edition)
    return {
        f"{view.prefix}any_{direction.word}_t": [
            (message.enumerator, message.member, f"{message.layout.name}_t") for message in direction.members
        ]
        for direction in view.directions
    }
