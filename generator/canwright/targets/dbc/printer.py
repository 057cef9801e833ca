"""The text of a DBC file.

A file repeats its lines for every node, and a template of 50 lines took most of the time of a run; so it is Python.
"""

from __future__ import annotations

from collections.abc import Iterator

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


def printed(file: File) -> str:
    """The file, in the order of sections that the format requires."""
    return "".join(f"{line}\n" for line in _lines(file))


def _lines(file: File) -> Iterator[str]:
    yield f'VERSION "{file.version}"\n\nNS_ :\n\nBS_:\n\nBU_: {" ".join(file.nodes)}\n'
    for message in file.messages:
        yield f"BO_ {message.id} {message.name}: {message.length} {message.senders[0]}"
        yield from (_signal(signal, message) for signal in message.signals)
        yield ""
    for message in file.messages:
        if len(message.senders) > 1:
            yield f"BO_TX_BU_ {message.id} : {','.join(message.senders)};"
    yield from _comments(file)
    yield _ATTRIBUTES
    yield from _attributes(file)
    for message, signal in _signals(file):
        if signal.values:
            names = " ".join(f'{value} "{text(name)}"' for value, name in signal.values)
            yield f"VAL_ {message.id} {signal.name} {names} ;"
    for message, signal in _signals(file):
        if signal.float_kind:
            yield f"SIG_VALTYPE_ {message.id} {signal.name} : {signal.float_kind};"


def _signals(file: File) -> Iterator[tuple[Message, Signal]]:
    return ((message, signal) for message in file.messages for signal in message.signals)


def _comments(file: File) -> Iterator[str]:
    """Each comment once: that of a signal which every node has is in the message of the first node."""
    yield f'CM_ "{file.comment}";'
    seen: set[tuple[str, str]] = {("", "")}
    for message in file.messages:
        if ("", message.comment) not in seen:
            seen.add(("", message.comment))
            yield f'CM_ BO_ {message.id} "{message.comment}";'
        for signal in message.signals:
            if signal.comment and (signal.name, signal.comment) not in seen:
                seen.add((signal.name, signal.comment))
                yield f'CM_ SG_ {message.id} {signal.name} "{signal.comment}";'


def _attributes(file: File) -> Iterator[str]:
    yield f'BA_ "DBName" "{text(file.name)}";'
    for message in file.messages:
        if message.extended:
            yield f'BA_ "VFrameFormat" BO_ {message.id} 1;'
    for message, signal in _signals(file):
        if signal.start_value or not float(signal.minimum) <= 0 <= float(signal.maximum):
            yield f'BA_ "GenSigStartValue" SG_ {message.id} {signal.name} {signal.start_value};'


def _signal(signal: Signal, message: Message) -> str:
    name = f"{signal.name} {signal.mux}" if signal.mux else signal.name
    bits = f"{signal.start}|{signal.width}@{0 if signal.big_endian else 1}{'-' if signal.signed else '+'}"
    numbers = f"({signal.factor},{signal.offset}) [{signal.minimum}|{signal.maximum}]"
    return f' SG_ {name} : {bits} {numbers} "{text(signal.unit)}" {",".join(message.receivers)}'
