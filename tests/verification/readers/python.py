"""Readers of DBC files that are Python packages."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import Case, Reader, UnsupportedFileError, Values


class PythonReader(Reader):
    """A reader that is a package of PyPI."""

    package: str

    def is_installed(self) -> bool:
        return importlib.util.find_spec(self.package) is not None


class Cantools(PythonReader):
    name = package = "cantools"
    source = "pip install cantools"

    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        import cantools

        database: Any = cantools.database.load_file(file, strict=True)
        return [
            database.decode_message(c.can_id, c.data, decode_choices=False, force_extended_id=c.extended) for c in cases
        ]


class Canmatrix(PythonReader):
    name = package = "canmatrix"
    source = "pip install canmatrix"

    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        import canmatrix.formats

        matrix: Any = canmatrix.formats.loadp_flat(str(file))
        type(matrix)._frames_dict_id_extend.clear()  # canmatrix keeps ids in its class, also those of other files
        if matrix.load_errors:
            raise ValueError(f"{matrix.load_errors[0]}")
        decoded = (matrix.decode(canmatrix.ArbitrationId(c.can_id, extended=c.extended), c.data) for c in cases)
        return [{name: float(signal.phys_value) for name, signal in signals.items()} for signals in decoded]


class CanDecoder(PythonReader):
    name = package = "can_decoder"
    source = "pip install can_decoder"

    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        import can_decoder
        import pandas

        decoder = can_decoder.DataFrameDecoder(can_decoder.load_dbc(str(file)))
        times = pandas.to_datetime(range(len(cases)), unit="s", utc=True)
        columns = {
            "ID": [c.can_id for c in cases],
            "IDE": [c.extended for c in cases],
            "DataLength": [len(c.data) for c in cases],
            "DataBytes": [list(c.data) for c in cases],
        }
        frames = pandas.DataFrame(columns, index=pandas.Index(times, name="TimeStamp"))
        try:
            decoded = decoder.decode_frame(frames)
        except TypeError as error:
            if "decimal.Decimal" in str(error) and "SIG_VALTYPE_" in file.read_text("ascii"):
                raise UnsupportedFileError("it multiplies floating-point signals by a Decimal, and fails") from error
            raise
        results: list[dict[str, float]] = [{} for _ in cases]
        rows = zip(decoded.index, decoded["Signal"], decoded["Physical Value"], strict=True) if len(decoded) else ()
        for time, name, value in rows:
            results[int(time.timestamp())][name] = float(value)
        return results


class Asammdf(PythonReader):
    name = package = "asammdf"
    source = "pip install asammdf"

    def decode(self, file: Path, cases: Sequence[Case]) -> Sequence[Values]:
        import numpy
        from asammdf import MDF, Signal as Channel
        from asammdf.blocks.source_utils import Source
        from asammdf.blocks.v4_constants import BUS_TYPE_CAN

        length = max((len(c.data) for c in cases), default=0) or 1  # NumPy has no arrays of 0 bytes
        record = numpy.zeros(
            len(cases),
            dtype=[
                ("CAN_DataFrame.BusChannel", "<u1"),
                ("CAN_DataFrame.ID", "<u4"),
                ("CAN_DataFrame.IDE", "<u1"),
                ("CAN_DataFrame.DLC", "<u1"),
                ("CAN_DataFrame.DataLength", "<u1"),
                ("CAN_DataFrame.DataBytes", "<u1", (length,)),
            ],
        )
        for i, c in enumerate(cases):
            record[i] = (1, c.can_id, c.extended, len(c.data), len(c.data), list(c.data.ljust(length, b"\0")))
        source = Source(name="CAN", path="CAN", comment="", source_type=Source.SOURCE_BUS, bus_type=BUS_TYPE_CAN)
        times = numpy.arange(len(cases), dtype=float)
        with MDF(version="4.10") as log:
            log.append(Channel(record, times, name="CAN_DataFrame", source=source))
            group: Any = log.groups[-1].channel_group
            group.flags |= 2 | 4  # a bus event with plain names
            extracted: Any = log.extract_bus_logging({"CAN": [(str(file), 0)]})
            results: list[dict[str, float]] = [{} for _ in cases]
            for i, group in enumerate(extracted.groups):
                for channel in group.channels[1:]:
                    signal = extracted.get(channel.name, group=i, raw=True)
                    physical = signal.physical()
                    shown = signal if physical.samples.dtype.kind in "SU" else physical  # a named value is text
                    for time, value in zip(shown.timestamps, shown.samples, strict=True):
                        results[round(time)][channel.name] = float(value)
            return results


PYTHON: Sequence[PythonReader] = (Cantools(), Canmatrix(), CanDecoder(), Asammdf())
