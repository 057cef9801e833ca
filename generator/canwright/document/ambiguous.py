"""Scalars that YAML 1.1 and 1.2 read differently, values that are missing, and what to write instead."""

from __future__ import annotations

import re
from fractions import Fraction

_LONG = re.compile(r"-?[1-9][0-9]{31,}|0x[0-9A-Fa-f]{17,}")
_AMBIGUOUS = re.compile(
    r"""(?aix) (?: yes|no|on|off | true|false | ~|null | [-+]?\.(?:inf|nan) | [-+]?0[obx][0-9a-f_]+
    | [-+]?_*\d[\d_]*(?:\.[\d_]*)?(?:e[-+]?\d+)? | [-+]?\.[\d_]+(?:e[-+]?\d+)?
    | [-+]?\d[\d_]*(?::[0-5]?\d)+(?:\.[\d_]*)? )"""
)
"""What some reader takes for something else than a text: all that is left of numbers, and other words for `true`."""


def ambiguity(text: str) -> tuple[str, str, str] | None:
    """Rule, message and hint for a bare scalar that is no number and may be no text either; None for a plain text."""
    if _LONG.fullmatch(text):
        message = f"this number has {len(text)} characters, more than any that is meant"
        return "value", message, "a whole number has at most 31 digits, or 16 hexadecimal ones"
    if not _AMBIGUOUS.fullmatch(text):
        return None
    short = text if len(text) <= 40 else f"{text[:40]}…"
    return "ambiguous-scalar", f"`{short}` reads differently from one YAML reader to the next", _clear(short)


def _clear(text: str) -> str:
    """How to write a scalar that reads in two ways."""
    quoted = f'for a text write "{text}" in quotes'
    if text.lower() in ("yes", "no", "on", "off", "true", "false"):
        return f"{quoted}; for yes or no write `{'true' if text.lower() in ('yes', 'on', 'true') else 'false'}`"
    if text.lower() in ("null", "~"):
        return f"where nothing is meant leave the key out, or write `none` where that is a word for it; {quoted}"
    number = number_notation(text)
    return (
        f"{quoted}; the number is written {number}"
        if number
        else f"{quoted}; a number is written like 12, 0x1F or 0.01"
    )


def number_notation(text: str) -> str:
    """A number as the language writes it: `0b101` is 0x5, `1e-2` is 0.01, `.5` is 0.5; empty for what is none."""
    word = text.replace("_", "").lower()
    found = re.fullmatch(r"([+-]?)(0b[01]{1,64}|0o[0-7]{1,21}|0x[0-9a-f]{1,16})", word)
    if found:
        return f"{found[1].replace('+', '')}0x{int(found[2], 0):X}"
    if not re.fullmatch(r"[+-]?(?:[1-9][0-9]{0,20}|0)?(?:\.[0-9]{0,20})?(?:e[+-]?[0-9]{1,2})?", word) or not re.search(
        "[0-9]", word
    ):
        return ""
    number_ = Fraction(word) if not word.startswith(("e", ".e")) else Fraction(0)
    return _decimal(number_)


def _decimal(number: Fraction) -> str:
    for digits in range(31):
        scaled = abs(number) * 10**digits
        if scaled.denominator == 1:
            text = str(scaled.numerator).zfill(digits + 1)
            sign = "-" if number < 0 else ""
            return sign + (text if not digits else f"{text[:-digits]}.{text[-digits:]}")
    return ""


def missing_value_hint(key: str, line: str) -> str:
    """What is usually behind a key without a value."""
    behind = line.partition(f"{key}:")[2].lstrip()
    if "=" in key:
        return f"a key has a colon and a space behind it: `{key.replace('=', ': ', 1)}`"
    if ":" in key:
        return f"a colon has a space behind it: `{key.replace(':', ': ', 1)}`"
    if key.isdigit() and re.search(rf"[0-9],{key}\b", line):
        return "within brackets a comma ends a value; a decimal is written with a dot: 0.1"
    if behind.startswith("#"):
        return "write one; `#` starts a comment, a text with it stands in quotes"
    if f"{key}:" not in line:
        return "write one; a text with a comma or a bracket in it stands in quotes"
    return "write one, or remove the key; what belongs to it is indented further"
