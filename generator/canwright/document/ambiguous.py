"""Scalars that YAML 1.1 and 1.2 read differently, missing values, and what to write instead."""

from __future__ import annotations

import re
from fractions import Fraction

_LONG = re.compile(r"-?[1-9][0-9]{31,}|0x[0-9A-Fa-f]{17,}")
MAX_DECIMALS = 30
_LONG_DECIMAL = re.compile(rf"-?(?:0|[1-9][0-9]*)\.([0-9]{{{MAX_DECIMALS + 1},}})")
_AMBIGUOUS = re.compile(
    r"""(?aix) (?: yes|no|on|off | true|false | ~|null | [-+]?\.(?:inf|nan) | [-+]?0[obx][0-9a-f_]+
    | [-+]?_*\d[\d_]*(?:\.[\d_]*)?(?:e[-+]?\d+)? | [-+]?\.[\d_]+(?:e[-+]?\d+)?
    | [-+]?\d[\d_]*(?::[0-5]?\d)+(?:\.[\d_]*)? )"""
)
"""Scalars that some YAML readers do not read as a text: other notations of numbers, other words for `true`."""


def ambiguity(text: str) -> tuple[str, str, str] | None:
    """Rule, message and hint for a plain scalar that may be a number, a truth value or a text; None for a text."""
    if _LONG.fullmatch(text):
        message = f"this number has {len(text)} characters, too many"
        return "value", message, "a whole number has at most 31 digits, or 16 hexadecimal ones"
    if long := _LONG_DECIMAL.fullmatch(text):
        message = f"this number has {len(long[1])} decimals, more than the maximum of {MAX_DECIMALS}"
        return "value", message, "write fewer, or an exact quotient, for example 33/2048"
    if not _AMBIGUOUS.fullmatch(text):
        return None
    short = text if len(text) <= 40 else f"{text[:40]}…"
    return "ambiguous-scalar", f"`{short}` has different meanings in different YAML readers", _disambiguation(short)


def _disambiguation(text: str) -> str:
    """How to write each meaning of an ambiguous scalar."""
    quoted = f'for a text write "{text}" in quotes'
    if text.lower() in ("yes", "no", "on", "off", "true", "false"):
        return f"{quoted}; for yes or no write `{'true' if text.lower() in ('yes', 'on', 'true') else 'false'}`"
    if text.lower() in ("null", "~"):
        return f"for no value omit the key, or write `none` if the key allows it; {quoted}"
    number = number_notation(text)
    return (
        f"{quoted}; for a number write {number}"
        if number
        else f"{quoted}; for a number write, for example, 12, 0x1F or 0.01"
    )


def number_notation(text: str) -> str:
    """A number in the notation of the language: `0b101` is 0x5, `1e-2` is 0.01, `.5` is 0.5; empty for other texts."""
    word = text.replace("_", "").lower()
    prefixed = re.fullmatch(r"([+-]?)(0b[01]{1,64}|0o[0-7]{1,21}|0x[0-9a-f]{1,16})", word)
    if prefixed:
        return f"{prefixed[1].replace('+', '')}0x{int(prefixed[2], 0):X}"
    if not re.fullmatch(r"[+-]?(?:[1-9][0-9]{0,20}|0)?(?:\.[0-9]{0,20})?(?:e[+-]?[0-9]{1,2})?", word) or not re.search(
        "[0-9]", word
    ):
        return ""
    return _decimal(Fraction(word) if not word.startswith(("e", ".e")) else Fraction(0))


def _decimal(number: Fraction) -> str:
    for digits in range(31):
        scaled = abs(number) * 10**digits
        if scaled.denominator == 1:
            text = str(scaled.numerator).zfill(digits + 1)
            sign = "-" if number < 0 else ""
            return sign + (text if not digits else f"{text[:-digits]}.{text[-digits:]}")
    return ""


def missing_value(key: str, line: str) -> tuple[str, str]:
    """The message and the hint for a key without a value on a line, by the usual causes."""
    if re.fullmatch(rf"\s*- +{re.escape(key)}:\s*(?:#.*)?", line):
        hint = f"for names with keys, write a mapping without dashes: `{key}:`, with its keys indented below it"
        return f"this is an item of a list, and `{key}` has no value", hint
    return "there is no value here", _missing_value_hint(key, line)


def _missing_value_hint(key: str, line: str) -> str:
    """What to write, by the usual causes of a key without a value."""
    after = line.partition(f"{key}:")[2].lstrip()
    if "=" in key:
        return f"write a colon and a space after a key: `{key.replace('=', ': ', 1)}`"
    if ":" in key:
        return f"write a space after a colon: `{key.replace(':', ': ', 1)}`"
    if key.isdigit() and re.search(rf"[0-9],{key}\b", line):
        return "in brackets a comma ends a value; write a decimal with a dot: 0.1"
    if after.startswith("#"):
        return "write one; `#` starts a comment, so put a text that contains it in quotes"
    if f"{key}:" not in line:
        return "write one; put a text that contains a comma or a bracket in quotes"
    return "write one, or remove the key; indent the lines that belong to it further"
