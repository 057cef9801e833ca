"""Writes the program that drives a generated header; it calls what the header declares, and nothing else."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import jinja2
from canwright.model.edition import Edition
from canwright.model.joined import JoinedText
from canwright.model.layout import Field, Layout
from canwright.model.message import Direction, Message
from canwright.model.types import Encoding, Type
from canwright.semantics.plan import message_plan
from canwright.targets.c.names import PARTS, Names, layouts, member

from .c_facts import Facts
from .c_signatures import Function, Stored, functions

TEMPLATE = Path(__file__).with_name("c_harness.c.j2")

ARGUMENTS = {"frame": "frame", "message": "message", "node": "node", "parameters": "known", "field": "refused"}
"""The variables that the program keeps, by the names of parameters."""


def harness(edition: Edition, include: Path) -> str:
    """The program's text, for the headers below `include`."""
    name = f"{edition.family}/{edition.identifier}"
    text = header_text(edition, include)
    return _Harness(edition, functions(text)).text(name, Facts(edition, text).code())


def header_text(edition: Edition, include: Path) -> str:
    """All headers of an edition."""
    name = f"{edition.family}/{edition.identifier}"
    return "".join((include / f"{name}{part}.h").read_text("utf-8") for part in PARTS)


class _Harness:
    def __init__(self, edition: Edition, functions: Mapping[str, Function]) -> None:
        self._edition = edition
        self._functions = functions
        self._in_c = Names(edition)
        self._prefix = f"{edition.family}_{edition.identifier}_".lower()

    def text(self, include: str, facts: str) -> str:
        check = self._functions.get(f"{self._prefix}check_reply")
        with_fields = [layout for layout in layouts(self._edition) if _has_members(self._edition, layout)]
        template = jinja2.Environment(
            undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
        )
        return template.from_string(TEMPLATE.read_text("utf-8")).render(
            include=include,
            facts=facts,
            prefix=self._prefix,
            fd="fd_" if self._edition.bus.frame_format.is_fd else "",
            fd_flags={"classic": 0, "fd": 4, "fd_brs": 5}[self._edition.bus.frame_format.value],
            parameters=[self._parameter(p.name) for p in self._edition.parameters],
            layouts=[self._layout(layout) for layout in with_fields],
            milli=[t for t in (self._conversion(t, "milli", "milli") for t in self._edition.types) if t],
            single=[t for t in (self._conversion(t, "float", "value") for t in self._edition.types) if t],
            messages=[self._message(m) for m in self._edition.all_messages()],
            filters=list(self._filters()),
            directions=[d for d in map(self._direction, Direction) if d],
            check_reply=check.call({**ARGUMENTS, "request": "frame", "reply": "reply"})
            if check
            else "CANWRIGHT_NOT_ANSWER",
        )

    def _parameter(self, name: str) -> dict[str, Any]:
        values = [v.name for v in self._edition.parameter(name).values]
        enumerators = [f"{self._prefix}{name}_{value}".upper() for value in ("unknown", *values)]
        return {"name": name, "member": member(name), "enumerators": enumerators if values else []}

    def _filters(self) -> Iterator[dict[str, str]]:
        for address, direction in itertools.product(self._edition.addresses, Direction):
            name = f"{address.name}_{direction.value}_filter"
            function = self._functions.get(f"{self._prefix}{name}")
            if function:
                yield {"name": name, "call": function.call({**ARGUMENTS, "filter": "filter"})}

    def _direction(self, direction: Direction) -> dict[str, Any] | None:
        decode = self._functions.get(f"{self._prefix}decode_{direction.value}")
        if decode is None:
            return None
        check = self._functions.get(f"{self._prefix}any_{direction.value}_check")
        messages = [m for m in self._edition.messages(direction) if _has_members(self._edition, m.layout)]
        identify = self._functions.get(f"{self._prefix}identify_{direction.value}")
        print_ = self._functions[f"{self._prefix}print_{direction.value}"]
        names = {**ARGUMENTS, "text": "text", "size": "size"}
        return {
            "word": direction.value,
            "decode": decode.call({**ARGUMENTS, direction.value: "any"}),
            "identify": identify.call({**ARGUMENTS, "command": "command"}) if identify else "",
            "print": print_.call(names).replace("&text", "text"),
            "check": check.call({**ARGUMENTS, direction.value: "any"}) if check else "",
            "messages": [
                {
                    "enumerator": self._in_c.command(m.command),
                    "layout": self._names(m.layout),
                    "fields": [self._field(field) for field in m.layout.fields if field.is_given],
                    "member": member(self._in_c.short(m.command)),
                }
                for m in messages
            ],
        }

    def _message(self, message: Message) -> dict[str, Any]:
        c = self._in_c.lower(message.name)
        check = self._functions.get(self._in_c.lower(message.layout.name, "check"))
        return {
            "name": message.name,
            "command": message.command,
            "layout": self._names(message.layout) if _has_members(self._edition, message.layout) else None,
            "decode": self._functions[f"{c}_decode"].call(ARGUMENTS),
            "encode": self._functions[f"{c}_encode"].call(ARGUMENTS),
            "check": check.call(ARGUMENTS) if check else "",
        }

    def _names(self, layout: Layout) -> dict[str, str]:
        return {"name": layout.name, "c": self._in_c.lower(layout.name)}

    def _layout(self, layout: Layout) -> dict[str, Any]:
        fields = [self._field(field) for field in layout.fields if field.is_given]
        pack = self._functions.get(self._in_c.lower(layout.name, "pack"))
        return {
            **self._names(layout),
            "fields": fields,
            "code": _code_kind(self._edition, layout),
            "pack": pack.call(ARGUMENTS).replace("&message", "message") if pack else "(void)message",
            "pack_fails": pack is not None and "status" in pack.result,
        }

    def _field(self, field: Field) -> dict[str, Any]:
        type_ = field.type
        c = self._in_c.lower(self._in_c.type_stem(type_))
        members = [(m.name, f"{c}_{m.name}".upper()) for m in (*type_.enum, *type_.flags)]
        to, from_ = self._functions.get(f"{c}_to_double"), self._functions.get(f"{c}_from_double")
        names = self._functions.get(f"{c}_name")
        joined = field.type.joined
        word = "text" if isinstance(joined, JoinedText) else "number"
        width = next(w for w in (8, 16, 32, 64) if type_.width <= w)
        signed = type_.encoding is Encoding.SIGNED
        return {
            "name": field.name,
            "member": member(field.name),
            "places": [f"[{i}]" for i in range(len(field.elements))] if field.is_array else [""],
            "stored": Stored(
                f"canwright_float{width}_t"
                if type_.encoding is Encoding.FLOAT
                else f"{'' if signed else 'u'}int{width}_t"
            ),
            "signed": signed,
            "joined": None
            if joined is None
            else {"is_text": word == "text", "to": f"{c}_to_{word}", "from": f"{c}_from_{word}"},
            "enum": members if type_.enum else [],
            "flags": members if type_.flags else [],
            "names": names.call({"raw": "raw"}) if names and type_.enum else "",
            "no_value": self._functions[f"{c}_no_value"].call({"raw": "raw"}) if type_.no_values else "",
            "named": [(m.name, f"{c}_{m.name}".upper()) for m in (*type_.no_values, *type_.names)],
            "to": to.call({"value": "value", "raw": "raw", "parameters": "known"}) if to else "",
            "to_fails": to is not None and to.result != "double",
            "from": self._from(from_) if from_ else "",
        }

    def _conversion(self, type_: Type, ending: str, number: str) -> dict[str, Any] | None:
        """The pair of functions `_to_ENDING` and `_from_ENDING`, whose parameter is called `number`."""
        c = self._in_c.lower(self._in_c.type_stem(type_))
        to, from_ = self._functions.get(f"{c}_to_{ending}"), self._functions.get(f"{c}_from_{ending}")
        if to is None or from_ is None:
            return None
        arguments = {number: number, "raw": "raw", "parameters": "known"}
        return {
            "name": type_.name,
            "stored": Stored(to.types[to.parameters.index("raw")]),
            "signed": type_.encoding is Encoding.SIGNED,
            "number_kind": from_.types[from_.parameters.index(number)],
            "to": to.call(arguments),
            "to_fails": "status" in to.result,
            "from": from_.call(arguments),
        }

    @staticmethod
    def _from(function: Function) -> str:
        """A call where `raw` is a pointer already."""
        return function.call({"raw": "*raw", "value": "strtod(text, NULL)", "parameters": "known"}).replace("&*", "")


def _has_members(edition: Edition, layout: Layout) -> bool:
    return any(field.is_given for field in layout.fields) or bool(_code_kind(edition, layout))


def _code_kind(edition: Edition, layout: Layout) -> str:
    """The type of the member with the code; empty unless a message of a layout can have several."""
    several = [m for m in edition.of_layout(layout) if message_plan(m).codes]
    widths = [m.keys[0].width + (0 in message_plan(m).codes[1:]) for m in several]
    return f"uint{next(w for w in (8, 16, 32, 64) if w >= max(widths))}_t" if widths else ""
