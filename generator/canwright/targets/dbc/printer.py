"""The text of a DBC file.

A file repeats its lines for every node, and a template of 50 lines took most of the time of a run; so it is Python.
The messages of these nodes have one tuple of signals, whose texts are created once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from .text import text
from .view import File, Message, Signal

_ATTRIBUTES = """\
BA_DEF_ "BusType" STRING;
BA_DEF_ "DBName" STRING;
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN";
BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","Event";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 0;
BA_DEF_ SG_ "GenSigStartValue" INT 0 0;
BA_DEF_DEF_ "BusType" "CAN";
BA_DEF_DEF_ "DBName" "";
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_DEF_DEF_ "GenMsgSendType" "Event";
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_DEF_DEF_ "GenSigStartValue" 0;
BA_ "BusType" "CAN";"""


class _Texts(NamedTuple):
    """What the lines of a signal have in common for every node; empty where it has no such line."""

    signal: str
    start_value: str
    values: str
    float_kind: str


def printed(file: File) -> str:
    """The file, in the order of sections that the format requires."""
    distinct = {id(message.signals): message.signals for message in file.messages}
    texts = {number: [_texts(signal) for signal in signals] for number, signals in distinct.items()}
    return "".join(f"{line}\n" for line in _lines(file, [(m, texts[id(m.signals)]) for m in file.messages]))


def _texts(signal: Signal) -> _Texts:
    name = f"{signal.name} {signal.mux}" if signal.mux else signal.name
    bits = f"{signal.start}|{signal.width}@{0 if signal.big_endian else 1}{'-' if signal.signed else '+'}"
    numbers = f"({signal.factor},{signal.offset}) [{signal.minimum}|{signal.maximum}]"
    has_start = signal.start_value or not float(signal.minimum) <= 0 <= float(signal.maximum)
    values = " ".join(f'{value} "{text(name)}"' for value, name in signal.values)
    return _Texts(
        signal=f' SG_ {name} : {bits} {numbers} "{text(signal.unit)}"',
        start_value=f"{signal.name} {signal.start_value}" if has_start else "",
        values=f"{signal.name} {values}" if values else "",
        float_kind=f"{signal.name} : {signal.float_kind}" if signal.float_kind else "",
    )


def _lines(file: File, messages: Sequence[tuple[Message, Sequence[_Texts]]]) -> Iterator[str]:
    yield f'VERSION "{file.version}"\n\nNS_ :\n\nBS_:\n\nBU_: {" ".join(file.nodes)}\n'
    for message, signals in messages:
        receivers = ",".join(message.receivers)
        yield f"BO_ {message.id} {message.name}: {message.length} {message.senders[0]}"
        yield from (f"{texts.signal} {receivers}" for texts in signals)
        yield ""
    for message in file.messages:
        if len(message.senders) > 1:
            yield f"BO_TX_BU_ {message.id} : {','.join(message.senders)};"
    yield from _comments(file)
    yield _ATTRIBUTES
    yield f'BA_ "DBName" "{text(file.name)}";'
    for message in file.messages:
        if message.extended:
            yield f'BA_ "VFrameFormat" BO_ {message.id} 1;'
    for message, signals in messages:
        yield from (
            f'BA_ "GenSigStartValue" SG_ {message.id} {texts.start_value};' for texts in signals if texts.start_value
        )
    for message, signals in messages:
        yield from (f"VAL_ {message.id} {texts.values} ;" for texts in signals if texts.values)
    for message, signals in messages:
        yield from (f"SIG_VALTYPE_ {message.id} {texts.float_kind};" for texts in signals if texts.float_kind)


def _comments(file: File) -> Iterator[str]:
    """Each comment once: that of a signal which every node has is in the message of the first node."""
    yield f'CM_ "{file.comment}";'
    seen: set[tuple[str, str]] = {("", "")}
    listed: set[int] = set()
    for message in file.messages:
        if ("", message.comment) not in seen:
            seen.add(("", message.comment))
            yield f'CM_ BO_ {message.id} "{message.comment}";'
        if id(message.signals) in listed:
            continue
        listed.add(id(message.signals))
        for signal in message.signals:
            if signal.comment and (signal.name, signal.comment) not in seen:
                seen.add((signal.name, signal.comment))
                yield f'CM_ SG_ {message.id} {signal.name} "{signal.comment}";'
