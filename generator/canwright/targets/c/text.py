"""C source as text: comments with escaped spec text and facts of types and fields, macros, and folded lines."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ...diagnostics.diagnostic import DocumentPath
from ...diagnostics.unicode_safety import visible
from ...model import formatting
from ...model.deprecation import Deprecation
from ...model.edition import Edition
from ...model.formatting import english
from ...model.layout import Field, Layout, Space
from ...model.message import Address, Command
from ...model.types import Encoding, Type
from ...semantics.valid_raws import valid_raws

WIDTH = 118


class MacroView(NamedTuple):
    name: str
    value: str
    doc: str


_ENTITIES = str.maketrans({"\\": "&#92;", "@": "&#64;"})


class Markup(str):
    """A text that is escaped already, with commands of Doxygen."""


def with_deprecation(text: str, deprecation: Deprecation | None) -> str:
    """A text and, for a deprecated item, the command that marks it in Doxygen."""
    return Markup(f"{in_comment(text)} @deprecated {_sentence(deprecation)}".lstrip()) if deprecation else text


def _sentence(deprecation: Deprecation) -> str:
    shown = str(deprecation)
    return f"{shown[:1].upper()}{shown[1:]}."


def in_comment(text: str) -> str:
    """A text escaped for a comment, for the compiler and for Doxygen: spec text is untrusted."""
    if isinstance(text, Markup):
        return text
    line = visible(text)
    line = re.sub(r"\*(?=/)", "* ", line)
    line = re.sub(r"/(?=[*/])", "/ ", line)
    line = re.sub(r"\?(?=\?)", "? ", line)
    line = re.sub(r"&(?=[#A-Za-z])", "&amp;", line)
    line = re.sub(r"<(?=[A-Za-z/!?])", "&lt;", line)
    return line.translate(_ENTITIES)


def literal(text: str) -> str:
    """A text as a string literal, in UTF-8; octal escapes of three digits never take a digit that follows."""
    plain = (chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}" for byte in text.encode())
    return f'"{"".join(plain)}"'


def comment(paragraphs: str | Sequence[str], indent: int = 0) -> str:
    """Paragraphs as one Doxygen comment, on one line if they fit. The first line is not indented; empty ones are left out."""
    texts = [in_comment(p) for p in ([paragraphs] if isinstance(paragraphs, str) else paragraphs) if p]
    margin = " " * indent
    if len(texts) == 1 and len(texts[0]) + indent + 7 <= WIDTH:
        return f"/** {texts[0]} */"
    lines = ["/**"]
    for number, text in enumerate(texts):
        lines += [f"{margin} *"] if number else []
        lines += [f"{margin} * {line}" for line in _wrapped(text, WIDTH - indent - 3)]
    return "\n".join([*lines, f"{margin} */"])


def _wrapped(text: str, width: int) -> list[str]:
    return textwrap.wrap(text, width, break_long_words=False, break_on_hyphens=False)


def paragraph(text: str) -> str:
    """A paragraph inside a comment."""
    return "\n".join(f" * {line}" for line in _wrapped(in_comment(text), WIDTH - 3))


def fold(source: str) -> str:
    """C source with folded lines of code: after the parenthesis of a function head, after commas, before operators.

    Comments and directives are not changed.
    """
    return "\n".join(line if len(line) <= WIDTH else _folded(line) for line in source.split("\n"))


def arguments(names: Sequence[str]) -> str:
    """Arguments of a call or of the head of a function; empty ones are left out."""
    return ", ".join(filter(None, names))


def defines(macros: Sequence[MacroView]) -> str:
    """Aligned macros, each with its comment on the same line if all fit, else above."""
    names = max((len(m.name) for m in macros), default=0)
    values = max((len(m.value) for m in macros), default=0)
    plain = [f"#define {m.name:{names}} {m.value}" for m in macros]
    with_comments = [f"#define {m.name:{names}} {m.value:{values}} /**< {in_comment(m.doc)} */" for m in macros]
    if all(len(line) <= WIDTH for line in with_comments):
        lines = [line if m.doc else bare for m, line, bare in zip(macros, with_comments, plain, strict=True)]
    else:
        pairs = zip(macros, plain, strict=True)
        lines = [line for m, bare in pairs for line in ([comment(m.doc)] if m.doc else []) + [bare]]
    return "\n".join(lines)


_NO_CODE = ("#", "/*", "* ", "*/")
_FOLD = re.compile(r"((?<=,) | (?=(?:&&|\|\||\|) ))")


def _folded(line: str) -> str:
    code = line.lstrip(" ")
    if code.startswith(_NO_CODE):
        return line
    margin = " " * (len(line) - len(code) + 4)
    first, *rest = _FOLD.split(line)
    head, parenthesis, argument = first.partition("(")
    lines = [head + parenthesis, margin + argument] if line == code and parenthesis else [first]
    for separator, part in zip(rest[::2], rest[1::2], strict=True):
        if len(lines[-1]) + 1 + len(part) > WIDTH:
            lines.append(margin + part)
        else:
            lines[-1] += separator + part
    return "\n".join(lines)


def type_facts(type_: Type, among: Sequence[str] = ()) -> list[str]:
    """Resolution and range of a type, only for the parameter values in `among` if there are any."""
    return [s for s in (_scale(type_, among), _range(type_, among), _no_values(type_), _names(type_)) if s]


def field_facts(field: Field, parameter: str | None, use: str, of_type: Sequence[str], *, low_bits: bool) -> str:
    """A field in one paragraph: title, position, type, resolution, range, condition.

    `use` names the type and its functions, `of_type` are the facts of the type. With `low_bits`, a field for the node
    has only the low bits of it.
    """
    among = field.only if parameter in field.type.parameters else ()
    parts = [f"{english(field.title)}, {_places(field)}. {use}"]
    if field.is_array:
        indices = [e.index for e in field.elements]
        parts.append(f"Element 0 is number {indices[0]}, the last one number {indices[-1]}.")
    if field.is_node:
        parts.append("It contains the low bits of the node." if low_bits else "It contains the node.")
    if field.counter:
        parts.append(f"A counter from {field.counter.first} to {field.counter.last}.")
    if english(field.about):
        parts.append(english(field.about))
    parts += type_facts(field.type, among) if among else of_type
    parts += in_manual(field.manual_name)
    if field.only:
        parts.append(f"Only {parameter} {', '.join(field.only)}; 0 otherwise.")
    return " ".join(parts)


def heading(item: Address | Command | Layout) -> str:
    """The title of an item with its section of the manual."""
    return english(item.title) + (f" ({item.manual})" if item.manual else "")


def in_manual(name: str) -> list[str]:
    """The name in the manual as a sentence. Headers are ASCII, so a name in another script is left out."""
    return [f"In the manual: {name}."] if name.isascii() and name else []


def errata(edition: Edition, path: DocumentPath) -> list[str]:
    """The errata about the item at `path`, one paragraph each."""
    return [
        f"Erratum ({e.manual}): {english(e.printed)} Used here: {english(e.used)} {english(e.why)}"
        for e in edition.errata_at(path)
    ]


def _scale(type_: Type, among: Sequence[str]) -> str:
    unit = type_.unit.dbc if type_.unit else ""
    if not type_.is_number:
        return ""
    if type_.is_bare_float:
        return f"In {unit}, as the bits of an IEEE 754 number." if unit else "The bits of an IEEE 754 number."
    scales = formatting.scale(type_, among, ", counted from ", unit)
    cases = [(names, formatting.with_ascii_pi(scale)) for names, scale in scales]
    given = _alternatives(
        type_.linear.parameter, [(names, what) for names, what in cases if what != formatting.NOT_GIVEN]
    )
    lacking = [names for names, what in cases if what == formatting.NOT_GIVEN]
    if not given:
        return "No scale is known." if lacking else ""
    if given == ["1"]:
        return ""
    sentence = f"Resolution (1 LSB): {' or '.join(given)}."
    return sentence + (f" None is known for {lacking[0]}." if lacking else "")


def _range(type_: Type, among: Sequence[str]) -> str:
    if not type_.is_number:
        return ""
    what = "Range" if type_.encoding is Encoding.FLOAT else "Raw"
    given = _alternatives(valid_raws(type_).parameter, formatting.ranges(type_, tuple(among)))
    return f"{what} {', '.join(given)}." if given else ""


def _no_values(type_: Type) -> str:
    named = (f"{no_value.name} ({formatting.no_value(no_value)})" for no_value in type_.no_values)
    return f"Without a value: {', '.join(named)}." if type_.no_values else ""


def _names(type_: Type) -> str:
    named = (f"{member.name} ({member.value})" for member in type_.names)
    return f"Named: {', '.join(named)}." if type_.names else ""


def _alternatives(parameter: str | None, cases: Iterable[tuple[str, str]]) -> list[str]:
    return [f"{what} ({parameter} {names})" if names else what for names, what in cases]


def _places(field: Field) -> str:
    places = [formatting.place(field.space, e.segments, order=field.type.order) for e in field.elements]
    if len(places) == 1 or field.space is Space.ID:
        return places[0]
    return f"{places[0]} to {places[-1]}"
