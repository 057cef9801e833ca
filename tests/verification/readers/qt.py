"""Decodes frames on the standard input with Qt SerialBus: `python -m tests.verification.readers.qt FILE`.

Prints the signals of a frame on one line. The process ends at once, since Qt can abort while the interpreter unloads it;
the exit status is 3 if Qt has a warning about the file, which is printed.
"""

from __future__ import annotations

import os
import sys

UNSUPPORTED = 3


def main() -> int:
    from PySide6.QtSerialBus import QCanBusFrame, QCanDbcFileParser, QCanFrameProcessor

    parser = QCanDbcFileParser()
    if not parser.parse(sys.argv[1]):
        print(parser.errorString(), file=sys.stderr)
        return 1
    if parser.warnings():  # names of negative values, messages without data
        print(parser.warnings()[0], file=sys.stderr)
        return UNSUPPORTED
    processor = QCanFrameProcessor()
    processor.setMessageDescriptions(parser.messageDescriptions())
    processor.setUniqueIdDescription(QCanDbcFileParser.uniqueIdDescription())
    for line in sys.stdin:
        id_, _, data = line.strip().partition("#")
        number = int(id_, 16)
        frame = QCanBusFrame(number & 0x1FFFFFFF, bytes.fromhex(data))
        frame.setExtendedFrameFormat(bool(number >> 31))
        values = processor.parseFrame(frame).signalValues
        print(*(f"{name}={float(value)!r}" for name, value in values.items()))
    return 0


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
