"""C headers for host and node: header-only, freestanding, without heap; floats only in separate headers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from ...model.types import Assignment
from ...templating.environment import environment
from ..base import Output, Specification
from .examples import example
from .expressions import operand
from .text import arguments, comment, defines, fold, in_comment, paragraph
from .view import edition_view

RUNTIME = Path(__file__).parent / "runtime"
"""The headers that are the same for every protocol."""

SHARED = ("canwright.h", "canwright_exact.h", "canwright_float.h", "canwright_print.h")
PARTS = ("", "_float", "_print")
"""The endings of the names of the headers of an edition."""

FILTERS: dict[str, Callable[..., object]] = {
    "arguments": arguments,
    "comment": comment,
    "defines": defines,
    "fold": fold,
    "operand": operand,
    "paragraph": paragraph,
    "safe_text": in_comment,
}


class FamilyView(NamedTuple):
    """A family: the headers of its editions, and their examples."""

    name: str
    editions: tuple[str, ...]
    examples: tuple[str, ...]


def generate(specifications: Sequence[Specification], set_parameters: Assignment) -> Iterator[Output]:
    """Headers, a CMake package, and an example for each edition; nothing without an edition.

    Parameters are not fixed; they are arguments of functions.
    """
    env = environment("c", FILTERS)
    views = [(one, edition_view(one.edition)) for one in specifications]
    shown = [(view, example(one, view)) for one, view in views]
    families: list[FamilyView] = []
    for family in dict.fromkeys(view.family for _, view in views):
        editions = [view for _, view in views if view.family == family]
        for file in SHARED:
            lines = "".join(f"/* {view.header} */\n" for view in editions)
            yield Output(f"include/{family}/{file}", lines + (RUNTIME / file).read_text("utf-8"))
        for view in editions:
            for part in PARTS:
                text = env.get_template(f"edition{part}.h.j2").render(e=view)
                yield Output(f"include/{family}/{view.file}{part}.h", fold(text))
        examples = tuple(x.file for v, x in shown if v.family == family and x.exchanges)
        families.append(FamilyView(family, tuple(v.file for v in editions), examples))
    for view, x in shown:
        if x.exchanges:
            yield Output(f"examples/{x.file}.c", fold(env.get_template("examples/example.c.j2").render(e=view, x=x)))
    has_examples = any(x.exchanges for _, x in shown)
    env.globals.update(headers=[view.header for _, view in views], families=families, has_examples=has_examples)
    for file in (
        ("CMakeLists.txt", *(["examples/CMakeLists.txt"] * has_examples), "README.md", "MISRA.md") if shown else ()
    ):
        e, x = shown[0]
        yield Output(file, env.get_template(f"{file}.j2").render(e=e, x=x))
