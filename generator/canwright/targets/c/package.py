"""The files of the C package: headers, self-tests, examples, and descriptions for build systems and Arduino."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from jinja2 import Environment, Template

from ...model.edition import Edition
from ...model.formatting import english
from ...templating.environment import environment
from ..base import PACKAGE_VERSION, CodeExample, EditionInput, Output, WorkedExchange
from .choices import enumerator_numbers
from .cpp import SHARED_CXX
from .cpp.header import CxxExample, CxxView
from .examples import CommandExample, ExampleView
from .expressions import operand
from .names import FD, PARTS, SHARED, TEXT, member
from .selftest import SelfTest, has_self_test
from .text import arguments, comment, defines, fold, in_comment, paragraph
from .view import EditionView, edition_view

RUNTIME = Path(__file__).parent / "runtime"
"""The headers that are the same for every protocol."""

PACKAGES = ("CMakeLists.txt", "library.json", "library.properties", "README.md", "MISRA.md")
FILTERS: dict[str, Callable[..., object]] = {
    "arguments": arguments,
    "comment": comment,
    "defines": defines,
    "english": english,
    "enumerators": enumerator_numbers,
    "fold": fold,
    "member": member,
    "operand": operand,
    "paragraph": paragraph,
    "safe_text": in_comment,
}


class FamilyView(NamedTuple):
    """A family: the headers of its editions, and their examples. `headers` are their lines."""

    name: str
    headers: tuple[str, ...]
    editions: tuple[str, ...]
    examples: tuple[str, ...]


def files(specifications: Sequence[EditionInput]) -> Iterator[Output]:
    """Headers, packages for CMake, pkg-config, Arduino and PlatformIO, and examples; nothing without an edition."""
    if not specifications:
        return
    env = environment("c", FILTERS)
    views = [(item, edition_view(item.edition)) for item in specifications]
    shown = [(view, ExampleView(item, view)) for item, view in views]
    families: list[FamilyView] = []
    for name in dict.fromkeys(view.family for _, view in views):
        editions = [view for _, view in views if view.family == name]
        family = FamilyView(
            name=name,
            headers=tuple(view.header for view in editions),
            editions=tuple(view.file for view in editions),
            examples=tuple(x.file for view, x in shown if view.family == name and x.exchanges),
        )
        families.append(family)
        yield from _headers(env, family, [(item, view) for item, view in views if view.family == name])
    has_examples = any(x.exchanges for _, x in shown)
    env.globals.update(
        headers=[view.header for _, view in views],
        families=families,
        has_examples=has_examples,
        tested=[view.file for item, view in views if has_self_test(item)],
        version=PACKAGE_VERSION,
        library="_".join(family.name for family in families),
    )
    for view, x in ((view, x) for view, x in shown if x.exchanges):
        sketch = f"{x.file}_sketch"
        programs = {"example.c": f"{x.file}.c", "socketcan.c": f"{x.file}_socketcan.c"}
        programs |= {"sketch.ino": f"{sketch}/{sketch}.ino", "platformio.ini": f"{sketch}/platformio.ini"}
        for name, path in programs.items():
            text = env.get_template(f"examples/{name}.j2").render(e=view, x=x)
            yield Output(f"examples/{path}", fold(text))
    for family in families:
        yield Output(f"share/pkgconfig/{family.name}.pc", env.get_template("package.pc.j2").render(family=family))
    e, x = shown[0]
    cxx = CxxView(views[0][0].edition, e)
    y = CxxExample(cxx, x.exchanges[0]) if x.exchanges else None
    parametric = next((view for _, view in views if view.parameters), e)
    for file in (*PACKAGES, *(["examples/CMakeLists.txt"] * has_examples)):
        yield Output(file, env.get_template(f"{file}.j2").render(e=e, x=x, cxx=cxx, y=y, parametric=parametric))


def declared(edition: Edition) -> frozenset[str]:
    """The names in the code of the headers with integers and with floating point."""
    templates = (environment("c", FILTERS).get_template(f"edition{part}.h.j2") for part in PARTS[:2])
    text = "".join(template.render(e=edition_view(edition)) for template in templates)
    return frozenset(re.findall(r"\w+", re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)))


def program(edition: Edition, worked: WorkedExchange) -> CodeExample:
    """A program that encodes the request of a command and decodes its reply."""
    x = CommandExample(edition, worked)
    lines = "\n".join(f"status = {call};" for call in x.calls)
    return CodeExample("c", fold(_program_template().render(e=x.e, x=x)), lines)


@functools.cache
def _program_template() -> Template:
    return environment("c", FILTERS).get_template("command_example.c.j2")


def _runtime(file: str) -> str:
    """A header that is the same for every protocol."""
    return (RUNTIME / file).read_text("utf-8")


def _fd_self_test() -> str:
    """The parts of `canwright_selftest.h` that contain frames, for those of CAN FD."""
    text = _runtime("canwright_selftest.h")
    head, rest = text.split("/* From here on, everything contains frames. */\n\n")
    pragmas = head[head.index("#if defined(__cplusplus)") : head.index("/** What a golden frame shows")]
    rest = re.sub(r"\bcanwright_(?!status_t|step_t)(?=[a-z])", "canwright_fd_", rest)
    rest = rest.replace("CANWRIGHT_MAX_DATA", "CANWRIGHT_FD_MAX_DATA")
    return (
        "/**\n * @file\n * The self-tests of editions with CAN FD: `canwright_selftest.h` with their frames.\n */\n"
        "#ifndef CANWRIGHT_FD_SELFTEST_H\n#define CANWRIGHT_FD_SELFTEST_H\n\n"
        f'#include "{FD}"\n#include "canwright_selftest.h"\n\n{pragmas}{rest}'
    )


def _headers(
    env: Environment, family: FamilyView, editions: Sequence[tuple[EditionInput, EditionView]]
) -> Iterator[Output]:
    """The headers of a family, and those through which Arduino finds them."""
    lines = "".join(f"/* {line} */\n" for line in family.headers)
    files = {file: lines + _runtime(file) for file in SHARED}
    files[SHARED_CXX.name] = lines + SHARED_CXX.read_text("utf-8")
    if any(view.fd for _, view in editions):
        files |= {FD: lines + _runtime(FD), "canwright_fd_selftest.h": lines + _fd_self_test()}
    if any(view.has_joined for _, view in editions):
        files[TEXT] = lines + _runtime(TEXT)
    for item, view in editions:
        for part in PARTS:
            files[f"{view.file}{part}.h"] = fold(env.get_template(f"edition{part}.h.j2").render(e=view))
        files[f"{view.file}.hpp"] = fold(
            env.get_template("cpp/edition.hpp.j2").render(e=view, x=CxxView(item.edition, view))
        )
        if item.frames is not None and has_self_test(item):
            test = SelfTest(item.edition, item.frames, view)
            files[f"{view.file}_selftest.h"] = fold(env.get_template("edition_selftest.h.j2").render(e=view, t=test))
    for file, text in files.items():
        yield Output(f"include/{family.name}/{file}", text)
        forward = env.get_template("src/forward.h.j2").render(family=family, file=file)
        yield Output(f"src/{family.name}/{file}", forward)
    yield Output(f"src/{family.name}.h", env.get_template("src/family.h.j2").render(family=family))
