"""C headers: both sides of a protocol, header-only, freestanding, without heap and, unless asked for, without floats."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from ...model.refusal import Refusal
from ...model.types import Assignment
from ...templating.environment import environment
from .. import Described, Output
from .bits import operand
from .examples import example
from .problems import between as between, problems as problems
from .text import call, code, comment, defines, function, in_comment, paragraph
from .view import edition_view

SHARED = ("canwright.h", "canwright_float.h")
FILTERS: dict[str, Callable[..., object]] = {
    "code": code,
    "comment": comment,
    "defines": defines,
    "operand": operand,
    "paragraph": paragraph,
    "safe_text": in_comment,
}
REFUSALS = {
    Refusal.UNKNOWN_ID: "No message of this direction has this id, or none of this format.",
    Refusal.UNKNOWN_CODE: "The id is known, the code is not.",
    Refusal.WRONG_LENGTH: "The message has another DLC.",
    Refusal.WRONG_CONSTANT: "A field that always holds one value holds another.",
    Refusal.MISSING_PARAMETER: "The answer depends on a parameter that is not known.",
    Refusal.NO_SCALE: "There is a raw integer, and no way to a value.",
    Refusal.OUT_OF_RANGE: "Beyond the range, the bits or the names of the type; or a field that is not there is set.",
    Refusal.NOT_FINITE: "NaN or infinity.",
    Refusal.UNKNOWN_NODE: "The address has no such node.",
    Refusal.NOT_ANSWER: "The reply does not belong to the request.",
}


class StatusView(NamedTuple):
    """A status, its word and what it means."""

    name: str
    word: str
    doc: str


STATUSES = tuple(StatusView(f"CANWRIGHT_{refusal.name}", refusal.value, REFUSALS[refusal]) for refusal in Refusal)


class FamilyView(NamedTuple):
    """What the files for a whole family say of it: the headers of its editions and their examples."""

    name: str
    editions: tuple[str, ...]
    examples: tuple[str, ...]


def generate(described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
    """Headers, a CMake package, and an example an edition; nothing where there is no edition.

    The parameters stay open: a program decides on them.
    """
    env = environment("c", FILTERS)
    env.globals.update(call=call, function=function, tab="    ")
    views = [(one, edition_view(one.edition)) for one in described]
    shown = [(view, example(one, view)) for one, view in views]
    families: list[FamilyView] = []
    for family in dict.fromkeys(view.family for _, view in views):
        editions = [view for _, view in views if view.family == family]
        for file in SHARED:
            text = env.get_template(f"{file}.j2").render(headers=[v.header for v in editions], refusals=STATUSES)
            yield Output(f"include/{family}/{file}", text)
        for view in editions:
            yield Output(f"include/{family}/{view.file}.h", env.get_template("edition.h.j2").render(e=view))
            yield Output(f"include/{family}/{view.file}_float.h", env.get_template("edition_float.h.j2").render(e=view))
        examples = tuple(x.file for v, x in shown if v.family == family and x.exchanges)
        families.append(FamilyView(family, tuple(v.file for v in editions), examples))
    for view, x in shown:
        if x.exchanges:
            yield Output(f"examples/{x.file}.c", env.get_template("examples/example.c.j2").render(e=view, x=x))
    has_examples = any(x.exchanges for _, x in shown)
    env.globals.update(headers=[view.header for _, view in views], families=families, has_examples=has_examples)
    for file in ("CMakeLists.txt", *(["examples/CMakeLists.txt"] * has_examples), "README.md") if shown else ():
        e, x = shown[0]
        yield Output(file, env.get_template(f"{file}.j2").render(e=e, x=x))
