"""The generated C++17 header, compiled into a small program and driven through its overloads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2
from canwright.conformance.adapter import write_files
from canwright.model.edition import Edition
from canwright.model.layout import Field, Layout
from canwright.model.types import Encoding
from canwright.semantics.plan import message_plan
from canwright.targets.base import EditionInput
from canwright.targets.c.choices import enumerator_numbers
from canwright.targets.c.cpp.header import CxxView, FieldView
from canwright.targets.c.names import layouts, member
from canwright.targets.c.target import CTarget
from canwright.targets.c.view import edition_view

from ...compilers import SANITIZED, WARNINGS, ZIG
from .c import CAdapter
from .c_signatures import Stored

TEMPLATE = Path(__file__).with_name("cxx_harness.cpp.j2")
FLAGS = ("-O0", "-g0", "-fno-exceptions", "-fno-rtti", *SANITIZED)


class CxxAdapter(CAdapter):
    """Answers through `encode`, `decode`, `get`, `set` and `has`; the program speaks the protocol of that for C."""

    name = "cxx"
    reports_absent = True

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> CxxAdapter:
        """Compiles a program around the generated header."""
        folder = write_files(CTarget().generate([specification], {}), workdir)
        source = folder / "harness.cpp"
        source.write_text(cxx_harness(specification.edition), "utf-8")
        unit, program = folder / "harness.o", folder / "harness"
        ZIG.run("c++17", *WARNINGS, *FLAGS, f"-I{folder / 'include'}", "-c", source, "-o", unit)
        ZIG.run("c++17", *FLAGS, "-nostdlib++", unit, "-o", program)  # zig would first build the library, for a minute
        return cls(specification.edition, program)


def cxx_harness(edition: Edition) -> str:
    """The text of the program."""
    view = edition_view(edition)
    names = CxxView(edition, view)
    with_members = [_fields(layout) for layout in layouts(edition) if _has_members(edition, layout)]
    environment = jinja2.Environment(undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(TEMPLATE.read_text("utf-8")).render(
        e=view,
        x=names,
        include=f"{edition.family}/{edition.identifier}",
        choices={enum.name: enum.members for enum in names.enums},
        messages=[message.name for message in edition.all_messages()],
        commands=[message.command for message in edition.all_messages()],
        command_names=["", *(command.name for command in edition.commands)],
        numbers={p.name: [0, *enumerator_numbers(p).values()] for p in edition.parameters},
        members={p.name: member(p.name) for p in edition.parameters},
        tags=view.fields,
        codes=[edition.command(message.command).code for message in edition.all_messages()],
        structs=[
            {
                "name": layout.name,
                "fields": [_field(names, *pair) for pair in zip(fields, layout.fields, strict=True)],
                "code": layout.code.kind if layout.code else "",
            }
            for fields, layout in zip(with_members, names.layouts, strict=True)
        ],
    )


def _has_members(edition: Edition, layout: Layout) -> bool:
    return bool(_fields(layout)) or any(message_plan(message).codes for message in edition.of_layout(layout))


def _fields(layout: Layout) -> list[Field]:
    return [field for field in layout.fields if field.is_given]


def _field(names: CxxView, field: Field, view: FieldView) -> dict[str, Any]:
    enums = {enum.name: enum for enum in names.enums}
    type_ = view.type
    enum = enums.get(type_.named or type_.flags)
    members = (*field.type.enum, *field.type.flags)
    return {
        "name": field.name,
        "tag": view.tag.name,
        "member": view.member,
        "stored": Stored(type_.view.kind),
        "signed": field.type.encoding is Encoding.SIGNED,
        "length": view.length,
        "places": [(f"[{i}]", f", {i}u") for i in range(view.length)] or [("", "")],
        "named": type_.named,
        "flags": type_.flags,
        "members": [(m.name, e.name) for m, e in zip(members, enum.members, strict=True)] if enum else [],
        "others": []
        if view.presence
        else [conversion for conversion in type_.conversions if conversion.name != "value"],
        "value": next((conversion for conversion in type_.conversions if conversion.name == "value"), None),
        "presence": view.presence,
        "no_value": f"{type_.view.name}_no_value" if field.type.no_values else "",
        "macros": [(m.name, f"{type_.view.name}_{m.name}".upper()) for m in (*field.type.no_values, *field.type.names)],
        "joined": type_.view.joined,
        "is_text": type_.view.is_text,
        "type": type_.name,
    }
