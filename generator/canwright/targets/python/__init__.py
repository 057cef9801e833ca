"""The Python target: an installable, typed package, one module an edition, one small class a message."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...model import formatting
from ...model.edition import Edition
from ...model.message import Direction
from ...model.refusal import Refusal
from ...model.types import Assignment, Parameter
from ...templating.environment import environment
from .. import Described, Output, header
from . import codec_names, messages, routes, text, types
from .examples import example
from .problems import problems as problems

_TEXTS = re.compile(r'""".*?"""|"[^"\\\n]*(?:\\.[^"\\\n]*)*"', re.DOTALL)
"""Docstrings and other texts of a module, whose words are no names."""


class ParameterView(NamedTuple):
    """A parameter as a field of `Parameters`, and as an enum where it is a choice among names."""

    name: str
    python: str
    doc: str
    check: str
    """A call that refuses what it cannot be, of `self`."""


class ChoiceView(NamedTuple):
    """A choice among names, as an enum."""

    name: str
    doc: str
    members: tuple[types.MemberView, ...]


def generate(described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
    """The distribution with a package for each family."""
    env = environment("python", {"literal": text.literal, "docstring": text.docstring})
    families = list(dict.fromkeys(d.edition.family for d in described))
    distribution = families[0] if len(families) == 1 else "canwright_bindings"
    yield Output("pyproject.toml", env.get_template("pyproject.toml.j2").render(name=distribution, families=families))
    yield Output("README.md", env.get_template("README.md.j2").render(name=distribution, x=example(described)))
    for family in families:
        yield Output(f"{family}/__init__.py", env.get_template("__init__.py.j2").render(family=family))
        yield Output(f"{family}/py.typed", "")
        yield Output(f"{family}/_codec.py", env.get_template("_codec.py.j2").render(refusals=list(Refusal)))
        yield Output(f"{family}/nodes.py", env.get_template("nodes.py.j2").render())
        yield Output(f"{family}/python_can.py", env.get_template("python_can.py.j2").render())
    module, body = env.get_template("edition.py.j2"), env.get_template("edition_body.py.j2")
    for item in described:
        view = _module(item.edition)
        text_of_body = body.render(view)
        used = _words(text_of_body)
        imports = sorted(name for name in codec_names.NAMES if name in used or name in codec_names.PUBLIC)
        structs = [name for name in ("Struct", "pack") if name in used]
        yield Output(
            f"{item.edition.family}/{item.edition.identifier}.py",
            module.render(view, body=text_of_body, used=used, imports=imports, structs=structs),
        )


def _words(module: str) -> set[str]:
    """The names in the code of a module. Most of its pieces stand there many times."""
    pieces = set(_TEXTS.sub("", module).split())
    return set(re.findall(r"\w+", " ".join(pieces)))


def _module(edition: Edition) -> dict[str, object]:
    views = types.type_views(edition)
    built = messages.MessageViews(edition, views)
    bodies = [*(v.body for v in built.layouts), *(m.body for m in built.messages if m.body)]
    readers = routes.Readers()
    enums = [v for v in views.values() if v.enum]
    choices = tuple(_choice(p) for p in edition.parameters if p.is_choice and not p.is_numeric)
    return {
        "header": header(edition),
        "doc": (f"{edition.family} {edition.name}: {text.english(edition.title)}", text.english(edition.about)),
        "family": text.literal(edition.family),
        "edition": text.literal(edition.name),
        "hash": text.literal(edition.hash),
        "enum_bases": sorted(
            ({"Enum"} if choices else set()) | {"IntFlag" if v.is_flags else "IntEnum" for v in enums}
        ),
        "choices": choices,
        "public": _public(built, [c.name for c in choices], [v.enum for v in enums]),
        "parameters": tuple(map(_parameter, edition.parameters)),
        "enums": enums,
        "numbers": [v for v in views.values() if not v.enum],
        "patterns": list(dict.fromkeys(c.struct for b in bodies for c in b.cases if c.struct)),
        "layouts": built.layouts,
        "messages": built.messages,
        "request_routes": list(routes.routes(edition, Direction.REQUEST, readers)),
        "reply_routes": list(routes.routes(edition, Direction.REPLY, readers)),
        "answers": list(routes.answers(edition, readers)),
        "readers": readers.names,
    }


def _choice(parameter: Parameter) -> ChoiceView:
    members = tuple(
        types.MemberView(text.member_name(v.name), text.literal(v.name), text.english(v.title))
        for v in parameter.values
    )
    return ChoiceView(text.class_name(parameter.name), text.english(parameter.title), members)


def _parameter(parameter: Parameter) -> ParameterView:
    python = "Real"
    if parameter.is_choice:
        python = "int" if parameter.is_numeric else text.class_name(parameter.name)
    attribute = text.attribute(parameter.name)
    given = f"self.{attribute}, {text.literal(parameter.name)}"
    if parameter.is_choice:
        values = f" One of {', '.join(v.name for v in parameter.values)}."
        check = f"check_choice({given}, {', '.join(types.parameter_key(parameter, v.name) for v in parameter.values)})"
    else:
        allowed = formatting.allowed(parameter)
        values = f" {allowed[:1].upper()}{allowed[1:]}." if allowed else ""
        ends = [types.exact(end) if end is not None else "None" for end in (parameter.minimum, parameter.maximum)]
        check = f"check_number({given}, {', '.join(ends)})"
    doc = text.sentence(text.english(parameter.title)) + values + " " + text.english(parameter.about)
    return ParameterView(attribute, python, doc.strip(), check)


def _public(built: messages.MessageViews, choices: Sequence[str], enums: Sequence[str]) -> list[str]:
    """What a module is used for, by name."""
    constants = ("EDITION", "FAMILY", "SPEC_HASH", "UNKNOWN", "Parameters")
    functions = ("check_reply", "decode_answer", "decode_reply", "decode_request", "ids_of", "node_of")
    classes = [*(layout.name for layout in built.layouts), *(message.name for message in built.messages)]
    return sorted({*constants, *functions, *codec_names.PUBLIC, *choices, *enums, *classes})
