"""The text of a DBC file.

A file repeats its lines for every node, and a template of 50 lines took most of the time of a run; so it is Python.
The messages of these nodes have one tuple of signals, whose texts are created once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .sending import SEND_TYPES
from .text import number, text
from .view import File, Message, Signal

_VERSION_LENGTH = 32
"""A longer VERSION is an error in some readers, and so is a comma in it."""
_ATTRIBUTES = """\
BA_DEF_ "BusType" STRING;
BA_DEF_ "DBName" STRING;
BA_DEF_ BO_ "VFrameFormat" ENUM {frame_formats};
BA_DEF_ BO_ "GenMsgSendType" ENUM {send_types};
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 0;
BA_DEF_ SG_ "GenSigStartValue" INT 0 0;
{definitions}BA_DEF_DEF_ "BusType" "CAN";
BA_DEF_DEF_ "DBName" "";
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
{defaults}BA_DEF_DEF_ "GenMsgSendType" "Event";
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_DEF_DEF_ "GenSigStartValue" 0;
BA_ "BusType" "{bus_type}";"""
_FRAME_FORMATS = ("StandardCAN", "ExtendedCAN")
_FD_FRAME_FORMATS = (*_FRAME_FORMATS, *("reserved",) * 12, "StandardCAN_FD", "ExtendedCAN_FD")


_LONG_NAMES = {"BO_": "SystemMessageLongSymbol", "SG_": "SystemSignalLongSymbol"}
"""The attributes with the whole names of messages and signals."""


class _Texts:
    """What the lines of a signal have in common for every node; empty where it has no such line."""

    def __init__(self, signal: Signal) -> None:
        name, numbers = signal.name, signal.numbers
        bits = f"{signal.start}|{len(signal.bits)}@{0 if signal.big_endian else 1}{'-' if numbers.signed else '+'}"
        steps = f"({number(numbers.linear.scale)},{number(numbers.linear.offset)})"
        limits = f"[{number(numbers.minimum)}|{number(numbers.maximum)}]"
        has_start = numbers.start_value or not numbers.minimum <= 0 <= numbers.maximum
        values = " ".join(f'{value} "{text(meaning)}"' for value, meaning in signal.values)
        self.signal = (
            f' SG_ {name}{f" {signal.mux}" if signal.mux else ""} : {bits} {steps} {limits} "{text(numbers.unit)}"'
        )
        self.start_value = f"{name} {numbers.start_value}" if has_start else ""
        self.values = f"{name} {values}" if values else ""
        self.float_kind = f"{name} : {numbers.float_kind}" if numbers.float_kind else ""
        self.long_name = f'{name} "{signal.whole_name}"' if name != signal.whole_name else ""


def printed(file: File) -> str:
    """The file, in the order of sections that the format requires."""
    distinct = {id(message.signals): message.signals for message in file.messages}
    texts = {of: [_Texts(signal) for signal in signals] for of, signals in distinct.items()}
    return "".join(f"{line}\n" for line in _lines(file, [(m, texts[id(m.signals)]) for m in file.messages]))


def _lines(file: File, messages: Sequence[tuple[Message, Sequence[_Texts]]]) -> Iterator[str]:
    digest = file.edition.hash[:12]
    version = f"{file.edition.name[: _VERSION_LENGTH - len(digest) - 1]} {digest}"
    yield f'VERSION "{version}"\n\nNS_ :\n\nBS_:\n\nBU_: {" ".join(file.nodes)}\n'
    for message, signals in messages:
        receivers = ",".join(message.receivers)
        yield f"BO_ {message.id} {message.name}: {message.length} {message.senders[0]}"
        yield from (f"{texts.signal} {receivers}" for texts in signals)
        yield ""
    for message in file.messages:
        if len(message.senders) > 1:
            yield f"BO_TX_BU_ {message.id} : {','.join(message.senders)};"
    yield from _comments(file)
    yield from _attributes(file, messages)
    for message, signals in messages:
        yield from (
            f'BA_ "GenSigStartValue" SG_ {message.id} {texts.start_value};' for texts in signals if texts.start_value
        )
    for message, signals in messages:
        yield from (f"VAL_ {message.id} {texts.values} ;" for texts in signals if texts.values)
    for message, signals in messages:
        yield from (f"SIG_VALTYPE_ {message.id} {texts.float_kind};" for texts in signals if texts.float_kind)
    yield from _ranges(file.messages)


def _ranges(messages: Sequence[Message]) -> Iterator[str]:
    """The selector values of all signals of a message, if one of them has more than one."""
    for message in messages:
        if any(signal.ranges for signal in message.signals):
            selector, *signals = message.signals
            for signal in signals:
                values = [f"{span[0]}-{span[-1]}" for span in signal.ranges] or [f"{signal.mux[1:]}-{signal.mux[1:]}"]
                yield f"SG_MUL_VAL_ {message.id} {signal.name} {selector.name} {', '.join(values)};"


def _attributes(file: File, messages: Sequence[tuple[Message, Sequence[_Texts]]]) -> Iterator[str]:
    """The attributes with their definitions and defaults, but for start values."""
    send_types = list(dict.fromkeys((*SEND_TYPES, *(m.send_type for m in file.messages if m.send_type))))
    frame_format = file.edition.bus.frame_format
    formats = _FD_FRAME_FORMATS if frame_format.is_fd else _FRAME_FORMATS
    long_names = [
        *(("BO_", f'{m.id} "{m.whole_name}"') for m in file.messages if m.name != m.whole_name),
        *(("SG_", f"{m.id} {texts.long_name}") for m, signals in messages for texts in signals if texts.long_name),
    ]
    kinds = dict.fromkeys(kind for kind, _ in long_names)
    definitions = [f'BA_DEF_ {kind} "{_LONG_NAMES[kind]}" STRING;\n' for kind in kinds]
    defaults = [f'BA_DEF_DEF_ "{_LONG_NAMES[kind]}" "";\n' for kind in kinds]
    if frame_format.is_fd:
        definitions.append('BA_DEF_ BO_ "CANFD_BRS" ENUM "0","1";\n')
        defaults.append(f'BA_DEF_DEF_ "CANFD_BRS" "{int(frame_format.switches_rate)}";\n')
    yield _ATTRIBUTES.format(
        send_types=_listed(send_types),
        frame_formats=_listed(formats),
        bus_type="CAN FD" if frame_format.is_fd else "CAN",
        definitions="".join(definitions),
        defaults="".join(defaults),
    )
    yield f'BA_ "DBName" "{text(file.name)}";'
    for message in file.messages:
        if message.extended or frame_format.is_fd:
            yield f'BA_ "VFrameFormat" BO_ {message.id} {len(formats) - (1 if message.extended else 2)};'
    yield from (f'BA_ "{_LONG_NAMES[kind]}" {kind} {name};' for kind, name in long_names)
    for message in file.messages:
        if message.send_type:
            yield f'BA_ "GenMsgSendType" BO_ {message.id} {send_types.index(message.send_type)};'
        if message.cycle_ms:
            yield f'BA_ "GenMsgCycleTime" BO_ {message.id} {message.cycle_ms};'


def _listed(names: Sequence[str]) -> str:
    return ",".join(f'"{name}"' for name in names)


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
