"""C headers: both sides of a protocol, header-only, freestanding, without heap and, unless asked for, without floats."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ...golden import Refusal
from ...model import Assignment
from ...render import environment
from .. import Described, Output, header
from .bits import operand
from .text import code, comment, defines, function, in_comment, paragraph
from .view import edition_view

REFUSALS = {
    Refusal.UNKNOWN_ID: "No message of this direction has this id, or none of this format.",
    Refusal.UNKNOWN_CODE: "The id is known, the code is not.",
    Refusal.WRONG_LENGTH: "The message has another DLC.",
    Refusal.WRONG_CONSTANT: "A field that always holds one value holds another.",
    Refusal.MISSING_PARAMETER: "The answer depends on a parameter that is not known.",
    Refusal.NO_SCALE: "There is a raw integer, and no way to a value.",
    Refusal.OUT_OF_RANGE: "The value is beyond its range, its bits or its names; or a field is set that is not there.",
    Refusal.NOT_FINITE: "NaN or infinity.",
    Refusal.UNKNOWN_NODE: "The address has no such node.",
    Refusal.NOT_ANSWER: "The reply does not belong to the request.",
}


@dataclass(frozen=True)
class StatusView:
    name: str
    word: str
    doc: str


def generate(described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
    filters = {
        "code": code,
        "comment": comment,
        "defines": defines,
        "operand": operand,
        "paragraph": paragraph,
        "safe_text": in_comment,
    }
    env = environment("c", filters)
    env.globals.update(function=function, tab="    ")
    refusals = [StatusView(f"CANWRIGHT_{r.name}", r.value, REFUSALS[r]) for r in Refusal]
    families: dict[str, list[Described]] = {}
    for one in described:
        families.setdefault(one.edition.family, []).append(one)
    for family, editions in families.items():
        folder = f"include/{family}"
        headers = [header(one.edition) for one in editions]
        for file in ("canwright.h", "canwright_float.h"):
            text = env.get_template(f"{file}.j2").render(headers=headers, refusals=refusals)
            yield Output(f"{folder}/{file}", text)
        for one in editions:
            view = edition_view(one.edition)
            yield Output(f"{folder}/{view.file}.h", env.get_template("edition.h.j2").render(e=view))
            yield Output(f"{folder}/{view.file}_float.h", env.get_template("edition_float.h.j2").render(e=view))
