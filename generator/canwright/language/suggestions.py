"""What the author of an invalid spec probably meant: nearest names, and words that others use for those of the language."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal

from ..diagnostics.diagnostic import near, nearest
from ..model.types import Unit
from .aliases import REMOTE
from .concept import Concept, keys

LISTED_KEYS = 20
"""Up to so many keys are listed where none is near."""

_MEANT: Mapping[str, tuple[str, ...]] = {
    "accept": ("also", "alternatives"),
    "about": ("desc", "description", "doc", "details"),
    "bit": ("value", "position", "pos", "index", "number", "mask", "shift", "raw"),
    "value": ("raw", "val", "number", "num"),
    "addresses": ("ids", "nodes", "can_id"),
    "at": ("byte", "bytes", "position", "pos", "start", "start_bit", "start_byte", "startbit", "offset", "bit"),
    "bit_rates_kbps": ("baud", "baudrate", "bitrate", "bit_rate", "speed"),
    "bus": ("network", "can"),
    "canwright": ("version", "schema"),
    "command": ("cmd", "message"),
    "commands": ("messages", "frames", "access", "rw", "read_only", "readonly", "ro", "write_only", "writable"),
    "byte_order": ("endian", "endianness", "endianess", "order"),
    "code": ("cmd", "command", "opcode", "command_id", "cmd_id"),
    "constant": ("const", "fixed", "value"),
    "data": ("bytes", "payload", "hex"),
    "decode": ("request", "reply", "direction"),
    "dlc": ("length", "len", "size"),
    "echo": ("same", "request", "mirror", "copy"),
    "edition": ("version", "revision", "rev"),
    "encode": ("request", "reply", "direction"),
    "enum": ("values", "choices", "states"),
    "extended": ("ext", "29bit", "is_extended", "is_extended_id", "extended_id", "eff", "ide"),
    "family": ("name", "protocol", "namespace"),
    "flags": ("bits", "bitfield", "bitmask"),
    "id": ("can_id", "canid", "arbitration_id", "base"),
    "index": ("code", "address", "id", "subindex", "sub_index", "sub"),
    "max": ("maximum", "high", "upper"),
    "min": ("minimum", "low", "lower"),
    "nodes": ("range", "node_ids", "node_range", "devices"),
    "none": ("nothing", "no", "null", "nil", "empty", "void", "no_reply", "noreply"),
    "note": ("comment", "comments", "remark", "notes", "description", "desc"),
    "notes": ("comment", "comments", "note", "remarks"),
    "range": ("min", "max", "minimum", "maximum", "limits"),
    "raw": ("type", "width", "bits", "length", "len", "size", "format", "dtype", "signed", "is_signed", "sign"),
    "reply": ("response", "answer", "feedback", "rx"),
    "remote": REMOTE,
    "request": ("query", "tx", "send", "command", "message"),
    "says": ("reason", "refusal", "error", "expect", "expected"),
    "scale": ("factor", "resolution", "gain", "multiplier", "lsb", "step"),
    "selector": ("discriminator", "multiplexer", "mux", "switch"),
    "source": ("src", "origin"),
    "title": ("name", "label", "caption"),
    "unit": ("units",),
    "values": ("physical", "phys", "decoded"),
    "where": ("path", "location"),
    "why": ("because", "reason"),
}

_OF_MAPPINGS = frozenset({"bus", "commands", "addresses", "enum", "flags"})
"""Keys that a single number or word is not meant for."""

_ALL_MEANT = frozenset(word for words in _MEANT.values() for word in words)

_REMEDIES: Mapping[str, str] = {
    "a type": ": name one under `types`, and write `type: NAME` in place of `raw`",
    "a request or a reply": ", which then has its fields in `layout`",
    "a field": ", which stands in a request, a reply or a layout",
}

_SPELT: Mapping[str, tuple[str, ...]] = {
    "A": ("amp",),
    "degC": ("c", "celsius", "deg c", "deg_c", "degrees c", "centigrade"),
    "degF": ("f", "fahrenheit", "deg f", "deg_f"),
    "deg/s": ("dps", "deg/sec"),
    "h": ("hr",),
    "km/h": ("kph", "kmh", "km/hr"),
    "m/s": ("m/sec", "mps"),
    "min": ("minutes",),
    "ms": ("msec", "milli"),
    "Nm": ("n-m", "n m", "newton metre", "newton-metre"),
    "rad/s": ("rad/sec",),
    "rpm": ("1/min", "r/min", "rev/min", "u/min", "min^-1"),
    "s": ("sec",),
    "%": ("pct", "prozent", "per cent"),
}
"""Units as others spell them, besides their symbols and titles."""

_STEPS = re.compile(r"\b(?:tick|pulse|step|increment|inc|lsb|cnt)s?\b")
"""What other manuals call a count."""

DATE = r"^[0-9]{4}(-(0[1-9]|1[0-2])(-(0[1-9]|[12][0-9]|3[01]))?)?$"
VISIBLE = r"\S"
"""The pattern of a text in which there is something."""
NAME = "a small letter, then small letters, digits and `_`"

_SHAPES: Mapping[str, str] = {
    r"^[a-z][a-z0-9_]*$": NAME,
    r"^[A-Za-z0-9][A-Za-z0-9_]*$": "a letter or a digit, then letters, digits and `_`",
    r"^[A-Za-z][A-Za-z0-9_]*$": "a letter, then letters, digits and `_`",
    r"^[A-Za-z0-9]+([.-][A-Za-z0-9]+)*$": "letters and digits, with single dots and dashes between: v2.35-2024-02",
}


def meant(written: str, known: Iterable[str], there: Collection[str] = (), value: object = None) -> str | None:
    """The one of the known keys that an unknown one with this value stands for, and that is not `there` yet."""
    names = [name for name in known if name not in _OF_MAPPINGS or not isinstance(value, (int, Decimal))]
    word = written.strip().lower().replace("-", "_").replace(" ", "_")
    found = near(word, names)
    if found is None or (found not in (word, f"{word}s", f"{word}es") and word != f"{found}s"):
        has_format = any(name in there and name != written for name in ("type", "raw"))
        taken = {*there, "type", "raw"} if has_format else there
        free = (name for name in _MEANT if name in names and name not in taken)
        found = next((name for name in free if word in _MEANT[name]), None if word in _ALL_MEANT else found)
    return found


def slip(written: str, known: Iterable[str], there: Collection[str]) -> str | None:
    """The key that an unknown one is a slip of the pen for, unless that is there already."""
    found = near(written, known)
    return found if found and found not in there and found == meant(written, [found]) else None


def all_meant(concept: type[Concept], written: str, value: object, there: Mapping[str, object]) -> Iterator[str]:
    """The keys of a concept that an unknown one may stand for: these are not missing."""
    known = keys(concept)
    found = meant(written, known, there, value)
    if found:
        yield found
    if _is_field(value) and "layout" in known:
        yield "layout"


def unknown_key(concept: type[Concept], written: str, value: object, there: Mapping[str, object]) -> str:
    """What to write in place of an unknown key with this value, beside the keys that are `there`."""
    known = list(keys(concept))
    advice = concept.advice.get(written.lower()) or _misplaced(concept, written, value)
    if advice:
        return advice
    found = meant(written, known, there, value)
    if found:
        return f"did you mean `{found}`?" + (" It contains both ends: low..high" if found == "range" else "")
    format_key = next((name for name in ("type", "raw") if name in there and name in known and name != written), None)
    if format_key and written.lower() in _MEANT["raw"]:
        several = ", or write `array: 1..4` for several" if "array" in known else ""
        return f"remove it: `{format_key}` has the width and the sign{several}"
    owners = _owners(written, known)
    if owners:
        return f"`{written}` belongs to {' or '.join(owners[:3])}" + (
            _REMEDIES.get(owners[0], "") if len(owners) == 1 else ""
        )
    return _listed(sorted(known))


def _misplaced(concept: type[Concept], written: str, value: object) -> str:
    """Where a field or a command stands that was written elsewhere."""
    known = keys(concept)
    if _is_field(value) and {"layout", "fields"} <= set(known):
        return f"a field stands in `layout` here: {{layout: {{{written}: …}}, dlc: …}}"
    if _is_field(value) and concept.called == "a layout":
        return "a field stands in `fields`; indent it further"
    if _is_field(value) and concept.called == "a command":
        return "a field stands in `request` or `reply`; indent it further"
    if isinstance(value, dict) and {"code", "reply"} & set(value) and concept.called in ("a command", "the edition"):
        return f"a command stands in `commands`; indent it {'less' if concept.called == 'a command' else 'further'}"
    return ""


def _is_field(value: object) -> bool:
    return isinstance(value, dict) and "at" in value


def _owners(written: str, known: Collection[str]) -> list[str]:
    """The concepts that have a key which stands where it does not belong."""
    names = [written, *(name for name, words in _MEANT.items() if written.lower() in words)]
    owners = ([one.called for one in Concept.all if name in keys(one)] for name in names if name not in known)
    return next((called for called in owners if called), [])


def _listed(names: Sequence[str]) -> str:
    return "there are: " + ", ".join(f"`{n}`" for n in names) if 0 < len(names) <= LISTED_KEYS else ""


def shape(pattern: str) -> str:
    """What a pattern of the language wants, in words."""
    return _SHAPES.get(pattern, f"it has to match {pattern}")


def plain(written: str) -> str:
    """A name in small letters and `_`."""
    parts = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", written)
    return re.sub(r"[^A-Za-z0-9]+", "_", parts).strip("_").lower()


def name(written: str, pattern: str) -> str:
    """What a name has to look like, and this one as it would."""
    kept = r"[^A-Za-z0-9.-]+" if "." in pattern else r"[^A-Za-z0-9]+"
    meant = plain(written) if pattern.startswith("^[a-z]") else re.sub(kept, "_", written).strip("._-")
    wanted = shape(pattern)
    if array := re.fullmatch(r"([a-z][a-z0-9_]*)\[([1-9][0-9]?)\]", written):
        return f"{wanted}; several are an array: {array[1]} with `array: 1..{array[2]}`"
    return f"{wanted}: `{meant}`" if meant != written and re.fullmatch(pattern, meant) else wanted


def place(dotted: str, data: object) -> str:
    """The path that one which leads to nothing was probably meant for."""
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
            found = near(step, names)
            if found:
                return f"did you mean `{'.'.join([*steps[:i], found, *steps[i + 1 :]])}`?"
            where = f"below `{'.'.join(steps[:i])}`" if i else "at the top"
            return f"{where} there is " + (
                ", ".join(f"`{n}`" for n in names) if 0 < len(names) <= LISTED_KEYS else "no such thing"
            )
        data = data[int(step)] if isinstance(data, list) else data[step] if isinstance(data, dict) else None
    return ""


def date(written: str) -> str:
    """How a date is written, and this one as it would be."""
    parts = re.fullmatch(r"([0-9]{4})[-/. ]?([0-9]{1,2})?[-/. ]?([0-9]{1,2})?", written.strip())
    found = "-".join(part.zfill(2) for part in parts.groups() if part) if parts else ""
    wanted = "a year, a month, or a day: 2023, 2023-03 or 2023-03-21"
    return f"{wanted}: `{found}`" if found != written and re.fullmatch(DATE, found) else wanted


def as_yaml(value: object) -> str:
    """A scalar as it is written."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def integer(written: object) -> str:
    """How a whole number that was not read as one is written."""
    text = str(written).strip()
    if re.fullmatch(r"0x[0-9A-Fa-f]+|0|[1-9][0-9]*", text):
        return f"write {text} without quotes"
    if re.fullmatch(r"(?:0x[0-9A-Fa-f]+|0|[1-9][0-9]*)[;,]", text):
        return f"write {text[:-1]}: there is nothing behind a value"
    if parts := re.fullmatch(r"(0x[0-9A-Fa-f]+)[:.](?:0x)?([0-9A-Fa-f]{1,2})", text):
        return f"did you mean [{parts[1]}, 0x{parts[2].upper()}]?"
    digits = text[:-1] if text[-1:] in "hH" else text[1:] if text[:1] in "$#xX" else text
    return (
        f"did you mean 0x{digits.upper()}?"
        if re.fullmatch(r"[0-9A-Fa-f]+", digits)
        else "a whole number is written like 16 or 0x10"
    )


def word(written: str, known: Iterable[str]) -> str:
    """Which of a few words is meant; or all of them."""
    words, lower = list(known), written.lower()
    inside = next((one for one in words if one in lower), None)
    other = next((one for one in words if lower.replace("_", "-") in _WORDS.get(one, ())), None)
    every = f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else "".join(words)
    return other or near(lower, words) or inside or every


def unit(written: str, units: Mapping[str, Unit]) -> str:
    """The unit that another spelling stands for; or all that there are."""
    if written.strip().lower() in ("", "-", "none", "raw", "1", "n/a", "no unit", "unitless"):
        return "leave `unit` out: without it, this is a bare number"
    spelt = {spelling.casefold(): u for u in units.values() for spelling in (u.symbol, u.title["en"], u.dbc)}
    spelt |= {spelling: units[name] for name, spellings in _SPELT.items() if name in units for spelling in spellings}
    spelt |= {f"{spelling}s": u for spelling, u in spelt.items() if f"{spelling}s" not in spelt}
    word = written.strip().casefold().replace("meter", "metre")
    meant = units.get(written) or spelt.get(word) or units.get(_STEPS.sub("count", word))
    if meant:
        return f"did you mean `{meant.name}`?"
    close = near(written, units)
    listed = ", ".join([*units][:LISTED_KEYS])
    return f"did you mean `{close}`?" if close else f"leave `unit` out and name it in `title`, or use {listed}, …"


def layout(written: str, known: Sequence[str], commands: Collection[str], types: Collection[str]) -> str:
    """What stands in place of the name of a layout that is not there."""
    if written in commands:
        return f"`{written}` is a command: its reply is {{of: {written}}}"
    if written in types:
        return f"`{written}` is a type, of a field: {{{written}: {{at: 0, type: {written}}}}}"
    if written.lower() in ("remote", *REMOTE):
        return "a remote frame is {remote: true}"
    word = next((one for one in known if written.lower() in _MEANT.get(one, ())), None)
    found = word or near(written, known)
    return f"did you mean `{found}`?" if found else f"{nearest(written, known)}, or fields".removeprefix(", or ")


_WORDS: Mapping[str, tuple[str, ...]] = {
    "little": ("le", "intel", "lsb", "lsb-first", "@1"),
    "big": ("be", "motorola", "msb", "msb-first", "network", "@0"),
    "zh": ("cn", "chinese", "zh-hans"),
    "en": ("english", "eng", "en-us", "en-gb"),
    "danger": ("high", "critical", "error"),
    "warning": ("medium", "warn"),
    "note": ("low", "info", "hint"),
}
"""What other people call the words of the language."""
