"""What was written in another notation, written in that of the language: `[0, 10]` is 0..10, `0b101` is 0x5."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from ..diagnostics.diagnostic import near
from ..document.ambiguous import number_notation
from ..model.layout import MAX_DATA_BYTES
from . import notation as language

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

_NUMBER = r"[+-]?[0-9]+(?:\.[0-9]+)?"
_UNIT = "[A-Za-zµ°/%]+"
_ALL_ONES = r"\( *2 *(?:\^|\*\*) *([1-9][0-9]?) *- *1 *\)"
_LOW = ("min", "low", "from", "minimum", "lower")
_HIGH = ("max", "high", "to", "maximum", "upper")
_TRUE, _FALSE = frozenset({"true", "yes", "on", "y", "1"}), frozenset({"false", "no", "off", "n", "0"})
_NODE = r"(?i)\b(?:[a-z]*_?id|nodes?|device|n|i)\b"


def notation(written: object, message: str, key: str) -> str:
    """What to write for what a notation could not read; empty when that is not clear."""
    if "is not a raw format" in message:
        meant: str = raw_format(str(written))
        order = {"le": "little", "be": "big"}.get(str(written).strip().lower()[-2:])
        if meant and order:
            return f"did you mean `{meant}`, with `byte_order: {order}` beside it?"
    elif "data" in message and "hex" in message:
        meant = data(written)
    else:
        meant = next(
            (found for words, parse in _NOTATIONS.items() if words in message and (found := parse(written))), ""
        )
        meant = meant or (_LISTED[key](written) if key in _LISTED and not isinstance(written, str) else "")
    return f"did you mean `{meant}`?" if meant else ""


def raw_format(written: str) -> str:
    """The raw format that a type of C or of another tool stands for: `uint16_t` is u16."""
    word = written.strip().lower()
    found = re.fullmatch(r"(u|s|i|uint|int|sint|unsigned|signed)?[ _]?([1-9][0-9]?)(?:_t)?[ _]?(?:le|be)?", word)
    if found and int(found[2]) <= 64:
        return ("u" if (found[1] or "u").startswith("u") else "i") + found[2]
    return _FORMATS.get(word.removeprefix("unsigned "), "")


def span(written: object) -> str:
    """A range: `[0, 10]`, `0 to 10`, `0-10`, `{min: 0, max: 10}` are 0..10."""
    if isinstance(written, list) and len(written) == 2:
        low, high = map(str, written)
    elif isinstance(written, list) and all(isinstance(n, int) for n in written) and _is_row(written):
        low, high = str(written[0]), str(written[-1])
    elif isinstance(written, dict) and set(written) <= {*_LOW, *_HIGH} and len(written) == 2:
        low, high = (next((str(written[k]) for k in words if k in written), "") for words in (_LOW, _HIGH))
    else:
        between = r"\.\.\.?|…|-|–|—|~|～|:|,|to"
        found = re.fullmatch(
            rf"[\[(]?\s*({_NUMBER})\s*(?:{between})\s*({_NUMBER})\s*(?:[\])]|{_UNIT})?", _plain(written)
        )
        both = re.fullmatch(rf"(?:±|\+/?-) *({_NUMBER}) *(?:{_UNIT})?", _plain(written))
        low, high = found.groups() if found else (f"-{both[1]}", both[1]) if both else ("", "")
    meant = f"{low}..{high}".replace("+", "")
    return _if_read(meant, language.span) or _if_read("..".join(reversed(meant.split(".."))), language.span)


def nodes(written: object) -> str:
    """A range of whole numbers; one number is that of the last."""
    text = re.sub("0x[0-9A-Fa-f]{1,8}", lambda hexadecimal: str(int(hexadecimal[0], 16)), str(written))
    meant = (
        f"1..{text}" if re.fullmatch("[1-9][0-9]{0,4}", text) else span(text if isinstance(written, str) else written)
    )
    return _if_read(meant, language.nodes)


def id_(written: object) -> str:
    """A rule for ids: `(0x100 | node)`, `0x100 + ID`, `100h + node`; `0x101..0x104` are those of nodes 1 to 4."""
    text = re.sub(r"\b([0-9][0-9A-Fa-f]*)[hH]\b", r"0x\1", str(written))
    several = re.fullmatch(r"(0x[0-9A-Fa-f]+|[0-9]+) *(?:\.\.|-|–) *(0x[0-9A-Fa-f]+|[0-9]+)", text)
    if several and 0 < (first := int(several[1], 0)) < int(several[2], 0):
        return _if_read(f"0x{first - 1:X} + node", language.id_expression)
    text = re.sub(r"\b([0-9]+)(?=[a-z]*node)|(?<=node) *x(?= *[0-9])", _times, text, flags=re.I)
    text = re.sub(r"[\[({})\]$]", " ", text).replace("|", "+").replace("_ID", "_id")
    text = re.sub(_NODE, "node", text).strip()
    text = re.sub(r"\b[a-z_]+\b", lambda word: near(word[0], ["node"]) or word[0], text)
    return _if_read(re.sub(" +", " ", text), language.id_expression)


def _times(found: re.Match[str]) -> str:
    return f"{found[1]} * " if found[1] else " *"


def rational(written: object) -> str:
    """A number: `0,1` is 0.1, `/10` is 1/10, `10%` and `raw * 10` are 10; a parameter stands last, as in 2/3*size."""
    text = re.sub(r"^(?:raw|x) *\* *", "", _plain(written))
    text = re.sub(_ALL_ONES, lambda bits: str(2 ** int(bits[1]) - 1), text)
    if isinstance(written, bool):
        return str(int(written))
    with_unit = re.fullmatch(rf"({_NUMBER}) ?{_UNIT}", text)
    power = re.fullmatch(r"2 ?(?:\*\*|\^) ?\(?(-?)([0-9]{1,2})\)?", text)
    quotient = rf"{_NUMBER}(?:/{_NUMBER})?"
    times = re.fullmatch(
        rf"(?:({quotient}) *\* *)?([a-z][a-z0-9_]*)(?: *\* *({_NUMBER}))?( */ *{_NUMBER})?", text.lower()
    )
    if with_unit:
        text = with_unit[1]
    elif power:
        text = f"1/{2 ** int(power[2])}" if power[1] else str(2 ** int(power[2]))
    elif times and (times[1] is None or times[3] is None) and times[2] not in ("pi", "raw", "x"):
        below = (times[4] or "").replace(" ", "")
        return _if_read(f"{times[1] or times[3] or 1}{below}*{times[2]}", language.multiple)
    elif re.fullmatch(r"[+-]?[0-9]+,[0-9]+", text):
        text = text.replace(",", ".")
    elif text.startswith("/"):
        text = f"1{text}"
    else:
        return number_notation(text)
    return _if_read(text, language.rational)


def at(written: object) -> str:
    """A position: `16|16@1-` of a DBC file is bit 0 of byte 2, `2:3` bit 3 of byte 2."""
    text = str(written)
    if in_id := re.fullmatch(r"(?i)(?:can_?)?id[ ._]*\[?(?:([0-9]{1,2}) *[:-] *)?([0-9]{1,2})\]?", text):
        return f"id.{min(int(bit) for bit in in_id.groups() if bit)}"
    found = re.fullmatch(r"([0-9]{1,3})\|([0-9]{1,2})@([01])[+-]", text)
    if found:
        bit = int(found[1])
        return _if_read(f"{bit // 8}.{bit % 8}" if bit % 8 or found[3] == "0" else str(bit // 8), language.at)
    if isinstance(written, list) and all(isinstance(n, int) for n in written) and _is_row(written):
        return str(written[0])
    found = (
        re.fullmatch(r"(?:byte|data|b)?[ _]*\[?([0-9])\]?(?: *(?:\.\.|-|:) *[0-9])?", text, re.I)
        if ":" not in text
        else None
    )
    return found[1] if found else ""


def data(written: object) -> str:
    """Data bytes: a list of numbers, digits with `0x` or commas, one number, or what `candump` prints."""
    if isinstance(written, int) and 0xFF < written < 1 << 64:
        written = f"{written:X}".zfill((written.bit_length() + 7) // 8 * 2)
    if isinstance(written, list) and written and all(isinstance(b, int) and 0 <= b <= 255 for b in written):
        return '"' + " ".join(f"{b:02X}" for b in written) + '"'
    parts = re.split(r"[\s,:-]+", str(written).strip().rpartition("#")[2])
    if len(parts) == 1 and len(parts[0]) % 2 == 0:
        parts = re.findall("..", parts[0].removeprefix("0x"))
    bytes_ = [part[2:] if part[:2] in ("0x", "0X") else part for part in parts]
    if all(re.fullmatch("[0-9A-Fa-f]{1,2}", b) for b in bytes_) and len(bytes_) <= MAX_DATA_BYTES:
        return '"' + " ".join(b.zfill(2).upper() for b in bytes_) + '"'
    return ""


def truth(written: object) -> str:
    """`true` or `false`, of a word for one of them."""
    word = str(written).lower()
    return "true" if word in _TRUE else "false" if word in _FALSE else ""


def mask(written: object) -> str:
    """The bit that a mask stands for."""
    if isinstance(written, int) and written > 0 and written.bit_count() == 1:
        return f"flags are numbers of bits, not masks: 0x{written:X} is bit {written.bit_length() - 1}"
    return ""


def limits(written: object) -> str:
    """Limits of a number that are written as a range."""
    meant = span(written)
    low, _, high = meant.partition("..")
    return f"write {{min: {low}, max: {high}}}" if meant else ""


def by(written: object) -> str:
    """A choice by a parameter: `{model: {A: 1}}` names the parameter first."""
    if meant := span(written) if isinstance(written, dict) else "":
        return f"did you mean `{meant}`?"
    if isinstance(written, dict) and len(written) == 1:
        ((name, cases),) = written.items()
        if isinstance(cases, dict):
            return f"write {{by: {name}, {', '.join(f'{value}: {_shown(case)}' for value, case in cases.items())}}}"
    return ""


def names_first(written: Mapping[str, object]) -> str:
    """`{0: idle}` as `{idle: 0}`."""
    return f"{{{', '.join(f'{name}: {number}' for number, name in written.items())}}}"


def named(written: object) -> str:
    """For a list of mappings with a name: the names as keys."""
    if not isinstance(written, list) or not all(isinstance(item, dict) for item in written) or not written:
        return ""
    key = next((k for k in ("name", "id", "title") if isinstance(written[0].get(k), str)), None)
    if key is None:
        return ""
    rest = ", ".join(f"{k}: …" for k in written[0] if k != key)
    return f"a mapping has no dashes, and each name is a key: {{{written[0][key]}: {{{rest}}}}}"


def listed(written: object, key: str) -> str:
    """For a list of words: the words with numbers, where a key wants these."""
    if key not in ("enum", "flags") or not isinstance(written, list) or not all(isinstance(w, str) for w in written):
        return ""
    numbered = ", ".join(f"{name}: {i}" for i, name in enumerate(written[:8])) + ", …" * (len(written) > 8)
    return f"say the {'bit' if key == 'flags' else 'value'} of each: {{{numbered}}}"


def _plain(written: object) -> str:
    """A text with the minus sign of a keyboard in place of others."""
    return re.sub("^[−–－]|(?<=[^0-9 ])[−–－]", "-", str(written).strip())


def _if_read(text: str, read: Callable[[str], object]) -> str:
    try:
        read(text)
    except ValueError:
        return ""
    return text


def _is_row(numbers: list[int]) -> bool:
    """Whether these are one whole number after the other."""
    return len(numbers) > 0 and numbers == list(range(numbers[0], numbers[0] + len(numbers)))


def _shown(value: object) -> str:
    return "…" if isinstance(value, (dict, list)) else str(value)


_NOTATIONS: Mapping[str, Callable[[object], str]] = {
    "is not a range of whole": nodes,
    "range": span,
    "not a number": rational,
    "not a position": at,
    "belong in an id": id_,
}
"""What a notation says that it expected, and how to find what was meant."""

_LISTED: Mapping[str, Callable[[object], str]] = {
    "range": span,
    "raw_range": span,
    "plausible": span,
    "nodes": span,
    "array": span,
    "from_each": span,
    "at": at,
}
"""How to find what a list or a mapping stands for, by the key that it is the value of."""
