"""Suggestions for invalid specs: the nearest name, or the word of the language for a foreign one."""

from __future__ import annotations

import re
from calendar import monthrange
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal

from ..diagnostics.diagnostic import near, nearest
from ..model.types import Unit
from .concept import Concept, keys
from .foreign_words import foreign_words

LISTED_KEYS = 24
"""The maximum number of keys to list if no key is similar."""

_MAPPING_KEYS = frozenset({"bus", "commands", "addresses", "enum", "flags"})
"""Keys that are not suggested for a number."""

_REMEDIES: Mapping[str, str] = {
    "a type": ": define one under `types`, and write `type: NAME` instead of `raw`",
    "a request or a reply": "; its fields are then in `layout`",
    "a field": " in a request, a reply or a layout",
}

_COUNT_WORDS = re.compile(r"\b(?:tick|pulse|step|increment|inc|lsb|cnt)s?\b")
"""Words for a count."""

DATE = r"^[0-9]{4}(-(0[1-9]|1[0-2])(-(0[1-9]|[12][0-9]|3[01]))?)?$"
VISIBLE = r"\S"
"""The pattern of a text that is not blank."""
NAME = "write a lowercase letter, then lowercase letters, digits and `_`"

_SHAPES: Mapping[str, str] = {
    r"^[a-z][a-z0-9_]*$": NAME,
    r"^[A-Za-z0-9][A-Za-z0-9_]*$": "write a letter or a digit, then letters, digits and `_`",
    r"^[A-Za-z][A-Za-z0-9_]*$": "write a letter, then letters, digits and `_`",
    r"^[A-Za-z0-9]+([.-][A-Za-z0-9]+)*$": "write letters and digits, separated by single dots or dashes, for example v2.35-2024-02",
}


def likely_key(written: str, known: Iterable[str], present: Collection[str] = (), value: object = None) -> str | None:
    """The known key that the author of an unknown key with this value probably meant; none that is `present`."""
    names = [name for name in known if name not in _MAPPING_KEYS or not isinstance(value, (int, Decimal))]
    word = written.strip().lower().replace("-", "_").replace(" ", "_")
    similar = near(word, names)
    if similar is not None and (similar in (word, f"{word}s", f"{word}es") or word == f"{similar}s"):
        return similar
    has_format = any(name in present and name != written for name in ("type", "raw"))
    used = {*present, "type", "raw"} if has_format else present
    meanings = [name for name, words in foreign_words("keys").items() if word in words]
    unused = (name for name in meanings if name in names and name not in used)
    return next(unused, None if meanings else similar)


def corrected_key(written: str, known: Iterable[str], present: Collection[str]) -> str | None:
    """The key that an unknown one misspells, unless it is present."""
    similar = near(written, known)
    return similar if similar and similar not in present and similar == likely_key(written, [similar]) else None


def likely_keys(concept: type[Concept], written: str, value: object, present: Mapping[str, object]) -> Iterator[str]:
    """The keys of a concept that the author of an unknown key probably meant; they are not reported as missing."""
    known = keys(concept)
    likely = likely_key(written, known, present, value)
    if likely:
        yield likely
    if _is_field(value) and "layout" in known:
        yield "layout"


def unknown_key(concept: type[Concept], written: str, value: object, present: Mapping[str, object]) -> str:
    """A hint for an unknown key with this value, beside the keys that are `present`."""
    known = list(keys(concept))
    advice = concept.advice.get(written.lower()) or _misplaced(concept, written, value)
    if advice:
        return advice
    likely = likely_key(written, known, present, value)
    if likely:
        return f"did you mean `{likely}`?" + (" It contains both limits: low..high" if likely == "range" else "")
    format_key = next((n for n in ("type", "raw") if n in present and n in known and n != written), None)
    if format_key and written.lower() in foreign_words("keys")["raw"]:
        several = ", or write `array: 1..4` for several values" if "array" in known else ""
        return f"remove it, because `{format_key}` defines the width and the sign{several}"
    key, owners = _owners(written, known)
    if owners:
        meant = f"`{written}`" if key == written else f"did you mean `{key}`? It"
        remedy = _REMEDIES.get(owners[0], "") if len(owners) == 1 else ""
        return f"{meant} belongs to {' or '.join(owners[:3])}{remedy}"
    return _listed(sorted(known))


def _misplaced(concept: type[Concept], written: str, value: object) -> str:
    """A hint for a field or a command at the wrong level."""
    known = keys(concept)
    if _is_field(value) and {"layout", "fields"} <= set(known):
        return f"move the field into `layout`: {{layout: {{{written}: …}}, dlc: …}}"
    if _is_field(value) and concept.called == "a layout":
        return "move the field into `fields`; indent it further"
    if _is_field(value) and concept.called == "a command":
        return "move the field into `request` or `reply`; indent it further"
    if isinstance(value, dict) and {"code", "reply"} & set(value) and concept.called in ("a command", "the edition"):
        return f"move the command into `commands`; indent it {'less' if concept.called == 'a command' else 'further'}"
    return ""


def _is_field(value: object) -> bool:
    return isinstance(value, dict) and "at" in value


def _owners(written: str, known: Collection[str]) -> tuple[str, list[str]]:
    """A key, or another key of which it is a synonym, and the concepts that have it."""
    names = [written, *(name for name, words in foreign_words("keys").items() if written.lower() in words)]
    owners = ((name, [c.called for c in Concept.all if name in keys(c)]) for name in names if name not in known)
    return next(((name, called) for name, called in owners if called), ("", []))


def _listed(names: Sequence[str]) -> str:
    return "write one of " + ", ".join(f"`{n}`" for n in names) if 0 < len(names) <= LISTED_KEYS else ""


def shape(pattern: str) -> str:
    """What to write for a pattern of the language."""
    return _SHAPES.get(pattern, f"write a text that matches {pattern}")


def plain(written: str) -> str:
    """A name in lowercase letters and `_`."""
    parts = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", written)
    return re.sub(r"[^A-Za-z0-9]+", "_", parts).strip("_").lower()


def name(written: str, pattern: str) -> str:
    """A hint for an invalid name: the rule for names, and the nearest valid name."""
    kept = r"[^A-Za-z0-9.-]+" if "." in pattern else r"[^A-Za-z0-9]+"
    valid = plain(written) if pattern.startswith("^[a-z]") else re.sub(kept, "_", written).strip("._-")
    rule = shape(pattern)
    if array := re.fullmatch(r"([a-z][a-z0-9_]*)\[([1-9][0-9]?)\]", written):
        return f"{rule}; write an array as {array[1]} with `array: 1..{array[2]}`"
    return f"{rule}: `{valid}`" if valid != written and re.fullmatch(pattern, valid) else rule


def place(dotted: str, data: object) -> str:
    """A hint for a path that does not exist."""
    steps = dotted.split(".")
    for i, step in enumerate(steps):
        names = (
            list(data)
            if isinstance(data, dict)
            else [str(n) for n in range(len(data))]
            if isinstance(data, list)
            else []
        )
        if step not in names:
            similar = near(step, names)
            if similar:
                return f"did you mean `{'.'.join([*steps[:i], similar, *steps[i + 1 :]])}`?"
            parent = f"`{'.'.join(steps[:i])}`" if i else "the file"
            listed = ", ".join(f"`{n}`" for n in names) if 0 < len(names) <= LISTED_KEYS else f"no `{step}`"
            return f"{parent} contains {listed}"
        data = data[int(step)] if isinstance(data, list) else data[step] if isinstance(data, dict) else None
    return ""


def date(written: str) -> str:
    """A hint for an invalid date: the notation of dates, and the nearest valid date."""
    parts = re.fullmatch(r"([0-9]{4})[-/. ]?([0-9]{1,2})?[-/. ]?([0-9]{1,2})?", written.strip())
    valid = "-".join(part.zfill(2) for part in parts.groups() if part) if parts else ""
    rule = "write a year, a month or a day, as 2023, 2023-03 or 2023-03-21"
    return f"{rule}: `{valid}`" if valid != written and re.fullmatch(DATE, valid) else rule


def is_day(written: str) -> bool:
    """Whether a year, a month or a day in the valid form exists in the calendar."""
    year, month, day = (*map(int, written.split("-")), 1, 1)[:3]
    return day <= monthrange(max(year, 1), month)[1]


def as_yaml(value: object) -> str:
    """A scalar in the notation of YAML."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def is_quoted_number(written: str, pattern: str | None) -> bool:
    """Whether a text in quotes is a whole number, and not a name with this pattern."""
    is_number = re.fullmatch(r"0x[0-9A-Fa-f]+|0|[1-9][0-9]*", written) is not None
    return is_number and pattern is not None and re.search(pattern, written) is None


def integer(written: object) -> str:
    """A hint for a value that is not a whole number."""
    text = str(written).strip()
    if re.fullmatch(r"0x[0-9A-Fa-f]+|0|[1-9][0-9]*", text):
        return f"write {text} without quotes"
    if re.fullmatch(r"(?:0x[0-9A-Fa-f]+|0|[1-9][0-9]*)[;,]", text):
        return f"write {text[:-1]}, without a character after it"
    if parts := re.fullmatch(r"(0x[0-9A-Fa-f]+)[:.](?:0x)?([0-9A-Fa-f]{1,2})", text):
        return f"did you mean [{parts[1]}, 0x{parts[2].upper()}]?"
    digits = text[:-1] if text[-1:] in "hH" else text[1:] if text[:1] in "$#xX" else text
    return (
        f"did you mean 0x{digits.upper()}?"
        if re.fullmatch(r"[0-9A-Fa-f]+", digits)
        else "write a whole number, for example 16 or 0x10"
    )


def word(written: str, known: Iterable[str]) -> str:
    """The most likely of several words; all of them without a likely one."""
    words, lower = list(known), written.lower()
    contained = next((candidate for candidate in words if candidate in lower), None)
    synonym = next(
        (candidate for candidate in words if lower.replace("_", "-") in foreign_words("words").get(candidate, ())), None
    )
    listed = f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else "".join(words)
    return synonym or near(lower, words) or contained or listed


def unit(written: str, units: Mapping[str, Unit]) -> str:
    """A hint for an unknown unit."""
    if written.strip().lower() in ("", "-", "none", "raw", "1", "n/a", "no unit", "unitless"):
        return "omit `unit` for a plain number"
    spellings = {spelling.casefold(): u for u in units.values() for spelling in (u.symbol, u.title["en"], u.dbc)}
    spellings |= {
        spelling: units[name]
        for name, several in foreign_words("units").items()
        if name in units
        for spelling in several
    }
    spellings |= {f"{spelling}s": u for spelling, u in spellings.items() if f"{spelling}s" not in spellings}
    word = written.strip().casefold().replace("meter", "metre")
    likely = units.get(written) or spellings.get(word) or units.get(_COUNT_WORDS.sub("count", word))
    if likely:
        return f"did you mean `{likely.name}`?"
    close = near(written, units)
    listed = ", ".join([*units][:LISTED_KEYS])
    return f"did you mean `{close}`?" if close else f"omit `unit` and state it in `title`, or use {listed}, …"


def layout(written: str, known: Sequence[str], commands: Collection[str], types: Collection[str]) -> str:
    """A hint for an unknown layout."""
    if written in commands:
        return f"`{written}` is a command: write {{of: {written}}} for its reply"
    if written in types:
        return f"`{written}` is a type: write a field, {{{written}: {{at: 0, type: {written}}}}}"
    if written.lower() in ("remote", *foreign_words("keys")["remote"]):
        return "write {remote: true} for a remote frame"
    word = next((candidate for candidate in known if written.lower() in foreign_words("keys").get(candidate, ())), None)
    likely = word or near(written, known)
    return f"did you mean `{likely}`?" if likely else f"{nearest(written, known)}, or fields".removeprefix(", or ")
