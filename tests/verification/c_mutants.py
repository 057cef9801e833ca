"""Mutants of C headers: functions by their tokens, and one program that contains many mutated functions.

The text is cut into tokens without knowledge of names, so any header of plain functions will do. Mutated are operators,
numbers, constants, unary operators, statements and case labels in functions, and the numbers of macros and enumerators
outside of them. Not mutated are types, casts, members of structs and texts.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from .mutants import Change, Mutant, changed, make_mutant

_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<comment>/\*.*?\*/|//[^\n]*)|(?P<directive>^[ \t]*#(?:\\\n|[^\n])*)|(?P<text>\"(?:\\.|[^\"\\])*\")"
    r"|(?P<character>'(?:\\.|[^'\\])+')|(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)|(?P<word>\w+)"
    r"|(?P<sign><<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||->|\+\+|--|[-+*/%&|^]=|.)",
    re.DOTALL | re.MULTILINE,
)
_NUMBER = re.compile(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)$")
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]+(\S.*)$", re.MULTILINE)
_DECIMAL = re.compile(r"\d+\.\d+(?:[eE][-+]?\d+)?")

_PAIRS = ("< <=", "> >=", "== !=", "&& ||", "<< >>", "+ -", "* /", "& |", "+= -=", "|= &=", "<<= >>=", "true false")
OTHER = {old: new for pair in _PAIRS for old, new in itertools.permutations(pair.split())}
OTHER |= {"%": "*", "^": "|", "++": "--"}
"""What an operator or a constant is replaced by."""

UNARY_AFTER = {"(", ",", "=", "return", "?", ":", "{", ";", "&&", "||", "<", "<=", ">", ">=", "==", "!="}
UNARY_AFTER |= {"+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "!", "~", "+=", "-=", "|=", "&=", "case"}


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)


@dataclass(frozen=True)
class Function:
    """A function of a header: where its text and its body start and end, and the names of its parameters."""

    name: str
    start: int
    body: int
    end: int
    parameters: tuple[str, ...]
    tokens: tuple[Token, ...]
    """Those of the body, without spaces, comments and directives."""


def tokens(text: str) -> list[Token]:
    """All tokens of a text."""
    return [Token(str(match.lastgroup), match[0], match.start()) for match in _TOKEN.finditer(text)]


def functions(text: str) -> list[Function]:
    """The functions that a header defines: a body in braces after a list of parameters, outside of other braces."""
    definitions: list[Function] = []
    depth = 0
    body: int | None = None
    outside: list[Token] = []
    inside: list[Token] = []
    for token in tokens(text):
        if token.kind in ("space", "comment", "directive"):
            if token.kind == "directive" and depth == 0:
                outside = []
            continue
        if body is not None:
            inside.append(token)
            depth += {"{": 1, "}": -1}.get(token.text, 0)
            if depth == 0:
                opening = _opening(outside)
                name = outside[opening - 1].text
                parameters = tuple(_parameters(outside[opening + 1 : -1]))
                definitions.append(Function(name, outside[0].start, body, token.end, parameters, tuple(inside[:-1])))
                body, outside, inside = None, [], []
        elif token.text == "{" and depth == 0 and outside and outside[-1].text == ")":
            body, depth = token.end, 1
        else:
            is_linkage = token.text == "{" and bool(outside) and outside[-1].kind == "text"
            depth = max(0, depth + {"{": 1, "}": -1}.get(token.text, 0))
            if is_linkage:  # extern "C"
                depth, outside = 0, []
            elif depth == 0 and token.text == ";":
                outside = []
            elif depth == 0 or token.text != "{":
                outside.append(token)
    return definitions


def _opening(outside: Sequence[Token]) -> int:
    """The place of the parenthesis that the last one closes."""
    depth = 0
    for place in range(len(outside) - 1, -1, -1):
        depth += {")": 1, "(": -1}.get(outside[place].text, 0)
        if depth == 0:
            return place
    raise ValueError("a parenthesis is missing")


def _parameters(listed: Sequence[Token]) -> Iterator[str]:
    """The last word of each parameter."""
    words = [token for token in listed if token.kind == "word" or token.text == ","]
    for token, following in zip(words, [*words[1:], Token("sign", ",", 0)], strict=True):
        if token.kind == "word" and following.text == "," and token.text != "void":
            yield token.text


def mutants(file: str, text: str) -> list[Mutant]:
    """All mutants of a header."""
    siblings = _siblings(text)
    all_mutants: list[Mutant] = []
    inside: list[tuple[int, int]] = []
    for function in functions(text):
        inside.append((function.start, function.end))
        for changes in _in_function(function, siblings):
            all_mutants.append(line_mutant(file, text, function.name, text[function.start : function.end], changes))
    for start, end, new in _outside(text):
        if not any(low <= start < high for low, high in inside):
            all_mutants.append(line_mutant(file, text, "", text, ((start, end, new),)))
    return list({(m.function, m.changes): m for m in all_mutants}.values())


def line_mutant(file: str, text: str, function: str, scope: str, changes: tuple[Change, ...]) -> Mutant:
    """A mutant that is identified by the line of its first change; if that changes altogether, with the line before."""
    low, high, _ = changes[0]
    start = text.rfind("\n", 0, low) + 1
    if text[start:high].strip() == text[low:high]:  # as `break;`, which says little by itself
        start = text.rfind("\n", 0, start - 1) + 1
    return make_mutant(file, text, changes, (start, text.find("\n", high)), function=function, scope=scope)


def used(text: str, program: str) -> set[str]:
    """The functions of headers that a program calls, directly or through others."""
    calls = {function.name: {t.text for t in function.tokens if t.kind == "word"} for function in functions(text)}
    called: set[str] = set()
    left = {word for word in re.findall(r"\w+", program) if word in calls}
    while left:
        called |= left
        left = {word for name in left for word in calls[name] if word in calls} - called
    return called


def _in_function(function: Function, siblings: Mapping[str, str]) -> Iterator[tuple[Change, ...]]:
    body = function.tokens
    cases = [i for i, token in enumerate(body) if token.text == "case"]
    labels = [place + 1 for place in cases]
    for place, token in enumerate(body):
        before = body[place - 1].text if place else "{"
        for new in replacements(token, before, siblings):
            yield ((token.start, token.end, new),)
    for first, second in itertools.pairwise(labels):
        a, b = body[first], body[second]
        if body[first + 1].text == ":" and second == first + 3:
            continue  # both labels have one body
        if _NUMBER.match(a.text) and _NUMBER.match(b.text) and _integer(a.text) == _integer(b.text):
            continue  # of two switches
        yield ((a.start, a.end, b.text), (b.start, b.end, a.text))
    for start, end in statements(body):
        yield ((body[start].start, body[end].end, ";"),)


def replacements(token: Token, before: str, siblings: Mapping[str, str]) -> Iterator[str]:
    """What a token is replaced by."""
    text = token.text
    if token.kind == "number":
        yield from _numbers(text)
    elif text in ("!", "~") or (text == "-" and before in UNARY_AFTER):
        yield ""
    elif text in ("*", "&", "+") and before in UNARY_AFTER | {")"}:
        if before == ")" and text == "*":
            yield "/"  # a product after a cast or a parenthesis; that of a pointer does not compile
    elif text in OTHER:
        yield OTHER[text]
    elif token.kind == "word" and text in siblings and before != "case":
        yield siblings[text]


def _integer(text: str) -> int:
    return int(text.rstrip("uUlL"), 0)


def _numbers(text: str) -> Iterator[str]:
    match = _NUMBER.match(text)
    if match is None:
        if _DECIMAL.fullmatch(text):
            yield repr(float(text) + 1.0) if float(text) < 1e15 else repr(float(text) * 2)
        return
    number = int(match[1], 0)
    shown = hex if match[1][:2] in ("0x", "0X") else str
    for near in (number + 1, number - 1) if number else (1,):
        yield shown(near) + match[2]


def _siblings(text: str) -> dict[str, str]:
    """For each enumerator and each macro with a value the next one of its group, for the last the first."""
    groups = [
        re.findall(r"^\s*([A-Z]\w*)\s*[=,}\n]", body, re.M) for body in re.findall(r"enum\s*\{(.*?)\}", text, re.S)
    ]
    names = [match[1] for match in _MACRO.finditer(text)]
    by_stem: dict[str, list[str]] = {}
    for name in names:
        by_stem.setdefault(name.rpartition("_")[0], []).append(name)
    groups += [group for group in by_stem.values() if len(group) > 1]
    return {a: b for group in groups for a, b in zip(group, [*group[1:], group[0]], strict=True) if a != b}


def statements(body: Sequence[Token]) -> Iterator[tuple[int, int]]:
    """The places of the first and last token of statements that a function can lack: assignments, calls, and `break` before others."""
    start, depth = 0, 0
    for place, token in enumerate(body):
        depth += {"(": 1, ")": -1}.get(token.text, 0)
        if depth == 0 and token.text in (";", "{", "}", ":"):
            words = body[start:place]
            if token.text == ";" and words and (_is_removable(words) or _falls_through(body, place)):
                yield start, place
            start = place + 1


def _falls_through(body: Sequence[Token], place: int) -> bool:
    """Whether a `break` ends at this place that keeps the program from other statements than `break`."""
    following = [token.text for token in body[place + 1 :]]
    while following and following[0] in ("case", "default", "break"):
        end = following.index(";" if following[0] == "break" else ":")
        following = following[end + 1 :]
    return body[place - 1].text == "break" and following[:1] != ["}"]


def _is_removable(words: Sequence[Token]) -> bool:
    if words[0].text in ("return", "const", "static", "continue", "goto", "else", "do", "if", "for", "while", "switch"):
        return False
    is_declaration = words[0].kind == "word" and len(words) > 1 and (words[1].kind == "word" or words[1].text == "*")
    return not is_declaration and any(word.text in ("(", "=", "++", "--") or word.text in OTHER for word in words)


def _outside(text: str) -> Iterator[Change]:
    """Other numbers in macros and enumerators."""
    for match in _MACRO.finditer(text):
        for token in tokens(match[2].split("/*")[0]):
            if token.kind == "number":
                for new in list(_numbers(token.text))[:1]:
                    yield match.start(2) + token.start, match.start(2) + token.end, new
    for match in re.finditer(r"^\s*[A-Z]\w*\s*=\s*(0x[0-9a-fA-F]+|\d+)\b", text, re.MULTILINE):
        yield match.start(1), match.end(1), next(_numbers(match[1]))


VARIABLE = "canwright_mutant"

CHOICE = f"""\
#include <stdlib.h>
#include <sys/time.h>
static int {VARIABLE};
__attribute__((constructor)) static void canwright_choose(void)
{{
    const char *number = getenv("MUTANT");
    const char *milliseconds = getenv("MILLISECONDS");
    struct itimerval most = {{{{0, 0}}, {{0, 0}}}};
    {VARIABLE} = number != NULL ? atoi(number) : 0;
    if (milliseconds != NULL) {{
        most.it_value.tv_sec = atol(milliseconds) / 1000;
        most.it_value.tv_usec = atol(milliseconds) % 1000 * 1000;
        setitimer(ITIMER_PROF, &most, NULL);
    }}
}}
"""
"""Precedes a program of several mutants; the variable MUTANT of the environment selects one of them.

A program that uses more than MILLISECONDS of processor time is stopped, however busy the machine is.
"""


@dataclass(frozen=True)
class Merged:
    """A header that contains mutated copies of its functions, and the mutant of each line that belongs to a copy."""

    text: str
    lines: Mapping[int, int]


def merged(text: str, chosen: Mapping[int, Mutant]) -> Merged:
    """A header in which each function calls its copy of the mutant that is selected; `chosen` are those of functions."""
    by_function: dict[str, list[int]] = {}
    for number, mutant in chosen.items():
        by_function.setdefault(mutant.function, []).append(number)
    parts: list[str] = []
    lines: dict[int, int] = {}
    line, done = 1, 0

    def add(part: str, number: int = 0) -> None:
        nonlocal line
        count = part.count("\n")
        if number:
            lines.update(dict.fromkeys(range(line, line + count + 1), number))
        line += count
        parts.append(part)

    for function in functions(text):
        numbers = by_function.get(function.name, [])
        if not numbers:
            continue
        add(text[done : function.start])
        for number in numbers:
            add(_copy(text, function, chosen[number], number), number)
            add("\n")
        add(text[function.start : function.body])
        arguments = ", ".join(function.parameters)
        cases = "".join(f"case {n}: return {function.name}_{n}({arguments});\n" for n in numbers)
        add(f"\nswitch ({VARIABLE}) {{\n{cases}default: break;\n}}\n")
        done = function.body
    add(text[done:])
    return Merged("".join(parts), lines)


def selectable(text: str, chosen: Mapping[int, Mutant]) -> str:
    """A header in which the mutant that is selected changes the number of a macro; `chosen` are those of macros."""
    changes = tuple(
        (start, end, f"({VARIABLE} == {number} ? {new} : {text[start:end]})")
        for number, mutant in chosen.items()
        for start, end, new in mutant.changes
    )
    return changed(text, changes)


def _copy(text: str, function: Function, mutant: Mutant, number: int) -> str:
    """The text of a function under another name, with the changes of a mutant."""
    head = text[function.start : function.body]
    head = re.sub(rf"\b{function.name}\b", f"{function.name}_{number}", head)
    return head + changed(text, mutant.changes, function.body, function.end)
