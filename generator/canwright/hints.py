"""What the writer of a wrong spec probably meant: words of other languages and habits of hand, put right."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from .diagnostics import near
from .model import Unit

LISTED_KEYS = 20
"""Up to so many keys are listed where none is near."""

_MEANT: Mapping[str, tuple[str, ...]] = {
    "accept": ("also", "alternatives"),
    "about": ("desc", "description", "doc", "details"),
    "addresses": ("ids", "nodes", "can_id"),
    "at": ("byte", "position", "pos", "start", "start_bit", "start_byte"),
    "bit_rates_kbps": ("baud", "baudrate", "bitrate", "bit_rate"),
    "byte_order": ("endian", "endianness", "endianess", "order"),
    "code": ("cmd", "command", "opcode", "command_id", "cmd_id"),
    "constant": ("const", "fixed", "value"),
    "dlc": ("length", "len", "size"),
    "enum": ("values", "choices", "states"),
    "extended": ("ext", "29bit", "is_extended", "eff"),
    "flags": ("bits", "bitfield", "bitmask"),
    "id": ("can_id", "canid", "arbitration_id", "base"),
    "index": ("code", "address", "id"),
    "notes": ("comment", "comments", "note", "remarks"),
    "range": ("min", "max", "minimum", "maximum", "limits"),
    "raw": ("type", "width", "bits", "length", "len", "size", "format", "dtype"),
    "reply": ("response", "answer", "feedback", "rx"),
    "request": ("query", "tx", "send"),
    "scale": ("factor", "resolution", "gain", "multiplier", "lsb", "step"),
    "title": ("name", "label", "caption"),
    "unit": ("units",),
}

_FORMATS: Mapping[str, str] = {
    "float": "f32",
    "float32": "f32",
    "real": "f32",
    "single": "f32",
    "double": "f64",
    "float64": "f64",
    "byte": "u8",
    "char": "i8",
    "bool": "u1",
    "boolean": "u1",
    "bit": "u1",
    "word": "u16",
    "dword": "u32",
    "short": "i16",
    "int": "i32",
    "long": "i32",
}

_STEPS = re.compile(r"\b(?:tick|pulse|step|increment|inc|lsb|cnt)s?\b")
"""What other manuals call a count."""

_LONG = re.compile(r"-?[1-9][0-9]{31,}|0x[0-9A-Fa-f]{17,}")
_AMBIGUOUS = re.compile(
    r"""(?aix) (?: yes|no|on|off | true|false | ~|null | [-+]?\.(?:inf|nan) | [-+]?0[obx][0-9a-f_]+
    | [-+]?_*\d[\d_]*(?:\.[\d_]*)?(?:e[-+]?\d+)? | [-+]?\.[\d_]+(?:e[-+]?\d+)?
    | [-+]?\d[\d_]*(?::[0-5]?\d)+(?:\.[\d_]*)? )"""
)
"""What some reader takes for something else than a text: all that is left of numbers, and other words for `true`."""

NAME = "a small letter, then small letters, digits and `_`"

_SHAPES: Mapping[str, str] = {
    r"^[a-z][a-z0-9_]*$": NAME,
    r"^[A-Za-z0-9][A-Za-z0-9_]*$": "a letter or a digit, then letters, digits and `_`",
    r"^[A-Za-z][A-Za-z0-9_]*$": "a letter, then letters, digits and `_`",
    r"^[A-Za-z0-9]+([.-][A-Za-z0-9]+)*$": "letters and digits, with single dots and dashes between: v2.35-2024-02",
    r"^[0-9]{4}(-[0-9]{2}){0,2}$": "a year, a month, or a day: 2023, 2023-03 or 2023-03-21",
}


def key(written: str, known: Iterable[str]) -> str:
    """The key that an unknown one stands for; or those that there are."""
    names = sorted(set(known))
    word = written.strip().lower().replace("-", "_").replace(" ", "_")
    meant = near(word, names)
    if meant is None or word not in (meant, f"{meant}s", meant.rstrip("s")):
        meant = next((name for name, others in _MEANT.items() if name in names and word in others), meant)
    if meant:
        return f"did you mean `{meant}`?"
    return "there are: " + ", ".join(f"`{n}`" for n in names) if 0 < len(names) <= LISTED_KEYS else ""


def raw_format(written: str) -> str:
    """The raw format that a type of C or of another tool stands for: `uint16_t` is u16."""
    word = written.strip().lower()
    found = re.fullmatch(r"(u|s|i|uint|int|sint|unsigned|signed)?[ _]?([1-9][0-9]?)(?:_t)?", word)
    if found and int(found[2]) <= 64:
        return ("u" if (found[1] or "u").startswith("u") else "i") + found[2]
    return _FORMATS.get(word.removeprefix("unsigned "), "")


def shape(pattern: str) -> str:
    """What a pattern of the language wants, in words."""
    return _SHAPES.get(pattern, f"it has to match {pattern}")


def name(written: str, pattern: str) -> str:
    """What a name has to look like, and this one as it would."""
    parts = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", written)
    meant = re.sub(r"[^A-Za-z0-9]+", "_", parts).strip("_")
    meant = meant.lower() if pattern.startswith("^[a-z]") else meant
    wanted = shape(pattern)
    return f"{wanted}: `{meant}`" if meant != written and re.fullmatch(pattern, meant) else wanted


def integer(written: object) -> str:
    """How a whole number that was not read as one is written."""
    text = str(written).strip()
    if re.fullmatch(r"0x[0-9A-Fa-f]+|0|[1-9][0-9]*", text):
        return f"write {text} without quotes"
    digits = text[:-1] if text[-1:] in "hH" else text[1:] if text[:1] in "$#xX" else text
    return (
        f"did you mean 0x{digits.upper()}?"
        if re.fullmatch(r"[0-9A-Fa-f]+", digits)
        else "a whole number is written like 16 or 0x10"
    )


def word(written: str, known: Iterable[str]) -> str:
    """Which of a few words is meant; or all of them."""
    words = list(known)
    inside = next((one for one in words if one in written.lower()), None)
    return near(written, words) or inside or " or ".join(words)


def unit(written: str, units: Mapping[str, Unit]) -> str:
    """The unit that another spelling stands for; or all that there are."""
    spelt = {spelling.casefold(): u for u in units.values() for spelling in (u.symbol, u.title["en"], u.dbc)}
    spelt |= {f"{spelling}s": u for spelling, u in spelt.items()} | {"c": units["degC"]} if "degC" in units else {}
    word = written.strip().casefold()
    meant = units.get(written) or spelt.get(word) or units.get(_STEPS.sub("count", word))
    if meant:
        return f"did you mean `{meant.name}`?"
    close = near(written, units)
    without = "leave `unit` out and say it in `title`, or take one of these: "
    return f"did you mean `{close}`?" if close else without + ", ".join(units)


def doubt(text: str) -> tuple[str, str, str] | None:
    """Rule, message and hint for a bare scalar that is no number and may be no text either; None for a plain text."""
    if _LONG.fullmatch(text):
        message = f"this number has {len(text)} characters, more than any that is meant"
        return "value", message, "a whole number has at most 31 digits, or 16 hexadecimal ones"
    if not _AMBIGUOUS.fullmatch(text):
        return None
    short = text if len(text) <= 40 else f"{text[:40]}…"
    hint = f'for a text write "{short}" in quotes; a number is written like 12, 0x1F or 0.01'
    return "ambiguous-scalar", f"`{short}` reads differently from one YAML reader to the next", hint


def flow(example: object) -> str:
    """An example of the language as it is written on one line."""
    if isinstance(example, dict):
        return f"{{{', '.join(f'{name}: {flow(value)}' for name, value in example.items())}}}"
    return f"[{', '.join(map(flow, example))}]" if isinstance(example, list) else str(example)


def yaml(problem: str, line: str) -> str:
    """What is usually behind a complaint of the YAML reader about a line."""
    if "\t" in line[: len(line) - len(line.lstrip())]:
        return "indent with spaces; YAML takes no tabs there"
    return next((hint for words, hint in _YAML.items() if words in problem), "")


_YAML: Mapping[str, str] = {
    "mapping values are not allowed": "is there a colon, and a space after it, on the line before? are lines that belong "
    "together indented alike? a text with a colon in it needs quotes",
    "did not find expected ',' or '}'": "is a `{` before this left open, or a comma missing?",
    "did not find expected ',' or ']'": "is a `[` before this left open, or a comma missing?",
    "did not find expected key": "lines that belong together are indented alike",
    "could not find expected ':'": "is the colon behind the key missing, or the space after it?",
    "cannot start any token": "put a text with such a character in quotes; is a quote before this left open?",
    "quoted scalar": "is the closing quote missing?",
    "unexpected end of stream": "is a quote or a bracket left open?",
    "did not find expected node content": "is a value missing here?",
}
