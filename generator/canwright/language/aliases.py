"""Foreign notations and their equivalents in the language: `[0, 10]` is 0..10, `uint8_t` is u8.

A rewrite is suggested only if the language accepts it and a row of the table matches the whole text, because a wrong hint
is worse than none.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from typing import Any

from ..diagnostics.diagnostic import DocumentPath, near
from ..document.ambiguous import number_notation
from ..model.layout import MAX_DATA_BYTES
from . import notation as language
from .foreign_words import foreign_words, meant

Row = tuple[str, Callable[[re.Match[str]], str] | str]

_TEXTS = ("string", "str", "text", "ascii", "chars", "char[]", "bytes", "bytearray", "hex")
_TRUE, _FALSE = frozenset({"true", "yes", "on", "y", "1"}), frozenset({"false", "no", "off", "n", "0"})

_N = r"([+-]?[0-9]+(?:\.[0-9]+)?)"
_Q = r"([+-]?[0-9]+(?:\.[0-9]+)?(?:/[0-9]+(?:\.[0-9]+)?)?)"
_UNIT = r"(?!(?:pi|e|k|s|us|min)\b)[A-Za-zµ°]+(?:/[A-Za-z]+)?"
_PARAMETER = r"((?!(?:pi|raw|x)\b)[a-z][a-z0-9_]*)"
_LOW, _HIGH = "(?:min|low|from|minimum|lower)", "(?:max|high|to|maximum|upper)"
_BETWEEN = r"(?:\.\.\.?|…|-|~|～|:|,|to)"

_SPANS: Sequence[Row] = (
    (rf"[\[(]?\s*{_N}\s*{_BETWEEN}\s*{_N}\s*(?:[\])]|{_UNIT})?", r"\1..\2"),
    (rf"[\[(]?\s*{_N}\s*{_BETWEEN}\s*{_N}\s*[\])]?", r"\2..\1"),
    (rf"\{{{_LOW}: {_N}, {_HIGH}: {_N}\}}", r"\1..\2"),
    (rf"(?:±|\+/?-) *{_N} *(?:{_UNIT})?", r"-\1..\1"),
)
_NUMBERS: Sequence[Row] = (
    (rf"{_N} ?{_UNIT}", r"\1"),
    (rf"(?:raw|x) *\* *{_N}", r"\1"),
    (r"([+-]?[0-9]+),([0-9]+)", r"\1.\2"),
    (r"/ *([0-9.]+)", r"1/\1"),
    (r"2 ?(?:\*\*|\^) ?\(?-([0-9]{1,2})\)?", lambda match: f"1/{2 ** int(match[1])}"),
    (rf"{_Q} *\* *{_PARAMETER}", r"\1*\2"),
    (rf"{_PARAMETER} *\* *{_N}", r"\2*\1"),
    (rf"{_N} *\* *{_PARAMETER} */ *{_N}", r"\1/\3*\2"),
    (rf"{_PARAMETER} */ *{_N}", r"1/\2*\1"),
    (".*", lambda match: number_notation(match[0])),
)
_POSITIONS: Sequence[Row] = (
    (r"([0-9]{1,3})\|[0-9]{1,2}@([01])[+-]", lambda match: _dbc_start(int(match[1]), match[2] == "0")),
    (r"(?:can_?)?id[ ._]*\[?([0-9]{1,2})\]?", r"id.\1"),
    (r"(?:can_?)?id[ ._]*\[?[0-9]{1,2} *[:-] *([0-9]{1,2})\]?", r"id.\1"),
    (r"(?:byte|data|b)?[ _]*\[?([0-9])\]?(?: *(?:\.\.|-) *[0-9])?", r"\1"),
)
_IDS: Sequence[Row] = (
    (r"\b([0-9][0-9A-Fa-f]*)[hH]\b", r"0x\1"),
    (r"(?i)\b([0-9]+)(?=[a-z]*node)", r"\1 * "),
    (r"(?<=node) *x(?= *[0-9])", " *"),
    (r"[\[({})\]$]", " "),
    (r"\|", "+"),
    (r"(?i)\b(?:[a-z]*_?id|nodes?|device|n|i)\b", "node"),
    (r"\b[a-z_]+\b", lambda word: near(word[0], ["node"]) or word[0]),
    (r" +", " "),
)
"""Substitutions, applied in this order; from the other tables, the first row that matches the whole text applies."""


def notation(written: object, parse: Callable[[Any], object]) -> str:
    """A hint for a value that a parser of the language rejects; empty without a clear equivalent."""
    text = _text(written)
    if parse in (language.raw_format, language.code_format):
        order = {"le": "little", "be": "big"}.get(text.lower()[-2:])
        if text.lower() in _TEXTS:
            return "write the number of bytes: raw: ascii7, or utf8_7"
        if order and raw_format(text):
            return f"did you mean `{raw_format(text)}`, with `byte_order: {order}` beside it?"
    rewrite = _REWRITES.get(parse)
    equivalent = _if_accepted(rewrite(text), parse) if rewrite else ""
    if parse is language.data_bytes:
        equivalent = data(written)
    return f"did you mean `{equivalent}`?" if equivalent else ""


def _id_expression(text: str) -> str:
    for pattern, replacement in _IDS:
        text = re.sub(pattern, replacement, text)
    return text.strip()


def _whole_range(text: str) -> str:
    number = re.sub("0x[0-9A-Fa-f]{1,8}", lambda hexadecimal: str(int(hexadecimal[0], 16)), text)
    return f"1..{number}" if re.fullmatch("[1-9][0-9]{0,4}", number) else span(number)


def _number(text: str) -> str:
    return _first(_NUMBERS, text.lower(), language.multiple)


def span(text: str) -> str:
    """A range: `0 to 10`, `0-10`, `±10`."""
    return _first(_SPANS, text, language.span)


def raw_format(written: str) -> str:
    """The raw format for a type of C or of another tool: `uint16_t` is u16."""
    word = written.strip().lower()
    parts = re.fullmatch(r"(u|s|i|uint|int|sint|unsigned|signed)?[ _]?([1-9][0-9]?)(?:_t)?[ _]?(?:le|be)?", word)
    if parts and int(parts[2]) <= 64:
        return ("u" if (parts[1] or "u").startswith("u") else "i") + parts[2]
    return meant("formats", word.removeprefix("unsigned "))


def data(written: object) -> str:
    """Data bytes from a list of numbers, from digits with `0x` or commas, or from the output of `candump`."""
    if isinstance(written, list):
        written = " ".join(f"{b:02X}" for b in written if (isinstance(b, int) and 0 <= b <= 255) or "?")
    parts = re.split(r"[\s,:-]+", str(written).strip().rpartition("#")[2])
    if len(parts) == 1 and len(parts[0]) % 2 == 0:
        parts = re.findall("..", parts[0].removeprefix("0x"))
    bytes_ = [part[2:] if part[:2] in ("0x", "0X") else part for part in parts]
    if all(re.fullmatch("[0-9A-Fa-f]{1,2}", b) for b in bytes_) and len(bytes_) <= MAX_DATA_BYTES:
        return '"' + " ".join(b.zfill(2).upper() for b in bytes_) + '"'
    return ""


def truth(written: object) -> str:
    """`true` or `false` for a synonym."""
    word = str(written).lower()
    return "true" if word in _TRUE else "false" if word in _FALSE else ""


def raw_integer(path: DocumentPath) -> str:
    """A hint for a value in place of a raw integer of a golden frame."""
    return (
        "`raw` has the integer in the frame; write a value in its unit, or a name, into `values`"
        if "raw" in path
        else ""
    )


_MAX_FD_KBPS = 8000
"""The highest bit rate of data in use."""


def limit(written: int, path: DocumentPath) -> str:
    """A hint for a number above its maximum: the bit of a mask, kbit/s for bit/s, or the rate of the data of CAN FD."""
    if "flags" in path and written > 0 and written.bit_count() == 1:
        return f"flags are bit numbers, not masks: write {written.bit_length() - 1} for 0x{written:X}"
    if "bit_rates_kbps" in path and written > _MAX_FD_KBPS and written % 1000 == 0:
        return f"the unit is kbit/s: write {written // 1000}"
    if "bit_rates_kbps" in path and written <= _MAX_FD_KBPS:
        return "only the data of CAN FD frames have a higher bit rate; write that of the other bits"
    return ""


def mapping(written: object, path: DocumentPath) -> str:
    """A hint for a value in place of a mapping: a parameter with a value, a number with a range, a word."""
    last = str(path[-1]) if path else ""
    if last == "selector" and str(written).lower() in ("none", "null", "no", "false", "id"):
        return "omit `selector` if no bits of a frame identify its command"
    if last == "number" and (low_high := span(_text(written)).split(".."))[1:]:
        return f"write {{min: {low_high[0]}, max: {low_high[1]}}}"
    if isinstance(written, (int, Decimal)) and (last == "number" or (path[:1] == ("parameters",) and len(path) == 2)):
        number = "number: {}" if last == "number" else f"{last}: {{number: {{}}}}"
        return f"write {number}, or limits, {{min: 1, max: 10}}; the user of the output sets the value"
    return "did you mean `remote`?" if last.lower() in foreign_words("keys")["remote"] and written is True else ""


def by(written: Mapping[str, object]) -> str:
    """A hint for a choice by a parameter without `by`, such as `{model: {A: 1}}`."""
    if equivalent := span(_text(written)):
        return f"did you mean `{equivalent}`?"
    name, cases = next(iter(written.items()), ("", None))
    if len(written) == 1 and isinstance(cases, dict):
        return f"write {{by: {name}, {', '.join(f'{value}: {_text(case)}' for value, case in cases.items())}}}"
    return ""


def names_first(written: Mapping[str, object]) -> str:
    """`{0: idle}` as `{idle: 0}`."""
    return f"{{{', '.join(f'{name}: {number}' for number, name in written.items())}}}"


def named(written: object) -> str:
    """A hint for a list of mappings with names: the names as keys."""
    items = written if isinstance(written, list) else []
    if items and all(isinstance(item, dict) and len(item) == 1 for item in items):
        return (
            f"write a mapping without dashes: {flow({name: value for item in items for name, value in item.items()})}"
        )
    first = items[0] if items else None
    key = next((k for k in ("name", "id", "title") if isinstance(first, dict) and isinstance(first.get(k), str)), None)
    if key is None or not isinstance(first, dict):
        return ""
    rest = ", ".join(f"{k}: …" for k in first if k != key)
    return f"write a mapping without dashes, with names as keys: {{{first[key]}: {{{rest}}}}}"


def listed(written: object, key: str) -> str:
    """A hint for a list of names in place of names with numbers."""
    if key not in ("enum", "flags") or not isinstance(written, list) or not all(isinstance(w, str) for w in written):
        return ""
    numbered = ", ".join(f"{name}: {i}" for i, name in enumerate(written[:8])) + ", …" * (len(written) > 8)
    return f"write the {'bit' if key == 'flags' else 'value'} of each: {{{numbered}}}"


def fields(written: object) -> str:
    """A hint for a list of names in place of fields."""
    if not isinstance(written, list) or not written or not all(isinstance(name, str) for name in written):
        return ""
    return f"write fields as a mapping: {{{written[0]}: {{at: 4, raw: u16}}{', …' if len(written) > 1 else ''}}}"


def flow(value: object) -> str:
    """Data in the notation of the language, on one line."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{name}: {flow(inner)}' for name, inner in value.items())}}}"
    return f"[{', '.join(map(flow, value))}]" if isinstance(value, (list, tuple)) else str(value)


def _text(written: object) -> str:
    """Data on one line, with consecutive numbers as a range and ASCII minus signs."""
    whole = written if isinstance(written, list) and all(isinstance(n, int) for n in written) else []
    if len(whole) > 1 and whole == list(range(whole[0], whole[0] + len(whole))):
        return f"{whole[0]}..{whole[-1]}"
    short = flow(written) if len(str(written)) <= language.LONGEST else ""
    return re.sub("^[−–－]|(?<=[^0-9 ])[−–－]", "-", short.strip()).replace("–", "-")


def _dbc_start(bit: int, is_big: bool) -> str:
    return f"{bit // 8}.{bit % 8}" if bit % 8 or is_big else str(bit // 8)


def _first(rows: Sequence[Row], text: str, parse: Callable[[str], object]) -> str:
    """The rewrite by the first row with a result that the parser accepts."""
    for pattern, replacement in rows:
        if match := re.fullmatch(pattern, text):
            rewritten = match.expand(replacement) if isinstance(replacement, str) else replacement(match)
            if rewritten and _if_accepted(rewritten, parse):
                return rewritten
    return ""


def _if_accepted(text: str, parse: Callable[[str], object]) -> str:
    try:
        parse(text)
    except ValueError:
        return ""
    return text


_REWRITES: Mapping[Callable[[Any], object], Callable[[str], str]] = {
    language.raw_format: raw_format,
    language.code_format: raw_format,
    language.id_expression: _id_expression,
    language.nodes: _whole_range,
    language.indices: _whole_range,
    language.span: span,
    language.rational: _number,
    language.multiple: _number,
    language.value: _number,
    language.at: lambda text: _first(_POSITIONS, text.lower(), language.at),
}
"""Parsers of the language, and how to rewrite a text that they reject."""
