"""Decodes the golden frames with the DBC files in readers of other projects.

`python -m tests.verification.dbc_readers [--edition NAME] [--sample] [READER ...]`

Each reader loads the files of the editions and must return the values of the golden frames, and no other signals. The
readers are cantools in strict mode, canmatrix, can_decoder, asammdf and Qt SerialBus (`pip install PySide6-Addons`, more
than 140 MB), which are Python packages; can-go (needs Go), can-dbc and dbc-rs (need Cargo), which are downloaded and built;
and dbcppp and dbcc, which must be installed. The functions that dbcc generates do not say which signals a frame has.
Rules that only other readers enforce are checked in the text: VERSION has at most 32 characters and no comma. The exit
status is 1 if a value differs, and 2 if a reader is missing.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path

from canwright.model.edition import Edition
from canwright.model.golden_frames import GoldenFrame
from canwright.model.layout import Field, Space
from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.dbc.files import files
from canwright.targets.dbc.frames import Part
from canwright.targets.dbc.names import signal_name, signals_of
from canwright.targets.dbc.printer import printed
from canwright.targets.dbc.selection import NODES
from canwright.targets.dbc.view import EXTENDED, File, Message, Signal, agree
from canwright.targets.options import Options

from ..spec_texts import SPECS, called
from .readers import Case, Reader, UnsupportedFileError
from .readers.programs import PROGRAMS
from .readers.python import PYTHON

READERS: Sequence[Reader] = (*PYTHON, *PROGRAMS)


def violations(text: str) -> Iterator[str]:
    """Violations of rules that only readers in other languages enforce."""
    version = re.match(r'VERSION "([^"]*)"', text)
    if not version or len(version[1]) > 32 or "," in version[1]:
        yield "VERSION has more than 32 characters or a comma, which dbc-rs and candied reject"


def differences(reader: Reader, text: str, cases: Sequence[Case]) -> Iterator[str]:
    """What a reader returns other than the values of the golden frames; raises UnsupportedFileError."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "file.dbc"
        file.write_text(text, "ascii")
        try:
            results = reader.decode(file, cases)
        except UnsupportedFileError:
            raise
        except Exception as error:  # of any reader
            yield f"{reader.name}: {error!r}"
            return
    for case, values in zip(cases, results, strict=True):
        frame = f"{case.can_id:X}#{case.data.hex().upper()}"
        for name in sorted({*values} - case.names):
            yield f"{reader.name}: {frame} has no signal {name}"
        for name, value in case.values.items():
            if name not in values or abs(values[name] - value) > reader.tolerance * max(1, abs(value)):
                yield f"{reader.name}: {frame} {name} is {values.get(name)}; expected {value}"


def cases_of(item: EditionInput, file: File) -> list[Case]:
    """The golden frames that a file describes completely."""
    views = {message.id: message for message in file.messages}
    cases: list[Case] = []
    for frame in item.frames.frames if item.frames else ():
        view = views.get(frame.id | (EXTENDED if frame.extended else 0))
        fits = frame.direction in file.directions and agree(file.assignment, frame.parameters)
        if view and fits and not frame.remote and not frame.decode_only and len(frame.data) == view.length:
            cases += _case(item.edition, frame, view, file)
    return cases


def _case(edition: Edition, frame: GoldenFrame, view: Message, file: File) -> Iterator[Case]:
    command = edition.command(frame.command)
    message = command.message(frame.direction)
    assert message
    part = Part(command, message)
    if not command.available(file.assignment) or (len(part.selectors) > 1) is not bool(file.table):
        return
    selector = next((s for s in view.signals if s.mux == "M"), None)
    if file.table and selector and command.name not in dict(selector.values).values():
        return
    shown = [s for s in view.signals if not selector or s.mux in ("M", f"m{_raw(selector, frame.data)}")]
    by_name = {s.whole_name: s for s in shown if s is not selector}
    values = {
        by_name[name].name: value
        for field in message.layout.fields
        if field.name in frame.raw and field.space is Space.DATA
        for name, value in _values(part, field, frame, by_name)
    }
    yield Case(frame.id, frame.extended, frame.data, values, frozenset(s.name for s in shown))


def _values(part: Part, field: Field, frame: GoldenFrame, signals: Mapping[str, Signal]) -> Iterator[tuple[str, float]]:
    """The name and the value of each signal of a field, as far as the golden frame has a value."""
    raw, value = frame.raw[field.name], frame.values.get(field.name)
    for i, element in enumerate(field.elements):
        name = signal_name(part, field, element)
        if field.type.flags:
            assert isinstance(raw, int)
            named = (bits for bits in signals_of(field, element) if bits.flag and name + bits.ending in signals)
            yield from ((name + bits.ending, float(raw >> bits.low & 1)) for bits in named)
            continue
        one_raw, one_value = (
            (raw[i], value[i] if isinstance(value, list) else None) if isinstance(raw, list) else (raw, value)
        )
        if (
            name in signals
            and (signals[name].numbers.unit == "raw" or field.type.enum)
            and not signals[name].numbers.float_kind
        ):
            yield name, float(one_raw)
        elif name in signals and isinstance(one_value, Fraction):
            yield name, float(one_value)


def _raw(signal: Signal, data: bytes) -> int:
    """The raw integer of a signal."""
    value, bit = 0, signal.start
    for i in range(len(signal.bits)):
        digit = data[bit // 8] >> bit % 8 & 1
        value = value << 1 | digit if signal.big_endian else value | digit << i
        bit += (15 if bit % 8 == 0 else -1) if signal.big_endian else 1
    return value


def samples(item: EditionInput, options: Options) -> Iterator[tuple[File, Sequence[Case]]]:
    """The files of an edition that have golden frames."""
    for file in files(item.edition, {}, options):
        cases = cases_of(item, file)
        if cases:
            yield file, cases


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"of {', '.join(r.name for r in READERS)}")
    parser.add_argument("--edition", help="only editions with this text in their name")
    parser.add_argument("--sample", action="store_true", help="only the first node, which is faster")
    arguments = parser.parse_args()
    unknown = {*arguments.readers} - {reader.name for reader in READERS}
    if unknown:
        parser.error(f"there is no reader {', '.join(sorted(unknown))}")
    chosen = [reader for reader in READERS if reader.name in (arguments.readers or [r.name for r in READERS])]
    missing = [f"{reader.name} needs {reader.source}\n" for reader in chosen if not reader.is_installed()]
    if missing:
        print(f"{''.join(missing)}Install them, or name the readers to use.", file=sys.stderr)
        return 2
    failed = False
    for spec in SPECS:
        if arguments.edition and arguments.edition not in called(spec):
            continue
        item = specification(spec)
        nodes = sorted({n for m in item.edition.all_messages() if m.id.nodes for n in m.id.nodes[:1]})
        made = list(samples(item, Options({NODES: tuple(nodes) if arguments.sample else ()})))
        for file, cases in made:
            text = printed(file)
            problems = list(violations(text))
            for reader in chosen:
                try:
                    problems += differences(reader, text, cases)
                except UnsupportedFileError as error:
                    print(f"{file.name}: not supported by {reader.name}: {error}")
            print(f"{file.name}: {len(cases)} frames, {len(problems)} differences", flush=True)
            print("".join(f"  {line}\n" for line in problems[:10]), end="")
            failed = failed or bool(problems)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
