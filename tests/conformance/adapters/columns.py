"""The generated columns package: every frame is decoded as an array of one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.targets import columns as target
from canwright.targets.base import Specification
from canwright.targets.columns.files import package_name
from canwright.targets.columns.view import column

from ..adapter import (
    Adapter,
    CanFrame,
    Cannot,
    Decoded,
    Encoded,
    ExactValue,
    Parameters,
    Raw,
    Refused,
    Value,
    write_files,
)
from .modules import load


class ColumnsAdapter(Adapter):
    """Answers through `decoder(...).decode`."""

    name = "columns"
    cannot: ClassVar[Mapping[str, str]] = {
        "encode": "columns are decoded from recordings; nothing is encoded",
        "expected": "no function expects a message: a frame is decoded by itself, in a given direction",
        "exchanges": "a table does not relate a reply to its request",
    }

    def __init__(self, edition: Edition, module: ModuleType, runtime: ModuleType) -> None:
        super().__init__(edition)
        self._module: Any = module
        self._runtime: Any = runtime
        self._decoders: dict[tuple[tuple[str, int | str], ...], Any] = {}

    @classmethod
    def create(cls, specification: Specification, workdir: Path) -> ColumnsAdapter:
        folder = write_files(target.generate([specification], {}), workdir)
        package = package_name(specification.edition.family)
        module, runtime = load(folder, f"{package}.{specification.edition.identifier}", f"{package}._columns")
        return cls(specification.edition, module, runtime)

    def decode(
        self, direction: Direction, frame: CanFrame, parameters: Parameters, expected: str | None
    ) -> Decoded | Refused:
        known = tuple(parameters.items())
        if known not in self._decoders:
            self._decoders[known] = self._module.decoder(parameters, raw=True)
        decoder = self._decoders[known]
        kind = frame.extended * self._runtime.Kind.EXTENDED | frame.remote * self._runtime.Kind.REMOTE
        way = self._runtime.Direction[direction.name]
        # a frame of another kind beside it: no result may depend on the other frames of an array
        ids, data = [frame.id, frame.id ^ 1, frame.id], [frame.data, b"\x55" * 8, frame.data]
        found = decoder.decode(self._runtime.frames(ids, data, way, kind=kind))
        number = int(found.message[0])
        assert number == found.message[2]
        if number < 0:
            return Refused(Refusal[self._runtime.Refusal(number).name])
        message = self._module.MESSAGES[number]
        if expected not in (None, message.command):
            raise Cannot("expected")
        table = found.tables[self._module.LAYOUTS[message.layout].name]
        assert table.rows[0] == 0 and table.message[0] == number
        node = int(table.node[0])
        ours = self.message_of(direction, message.command)
        fields = {f.name: f for f in ours.layout.fields if f.fixed is None}
        present = {n: f for n, f in fields.items() if column(f) in table.columns or f"{column(f)}_raw" in table.columns}
        return Decoded(
            message.command,
            None if node < 0 else node,
            {name: self._raw(table.columns, field) for name, field in present.items()},
            {name: self._value(table.columns, field) for name, field in present.items()},
        )

    def _raw(self, columns: Mapping[str, Any], field: Field) -> Raw:
        raw: Raw = columns.get(f"{column(field)}_raw", columns.get(column(field)))[0].tolist()
        return raw

    def _value(self, columns: Mapping[str, Any], field: Field) -> Value:
        if column(field) not in columns:
            return None
        value = columns[column(field)][0].tolist()
        declared = next(f.type for layout in self._module.LAYOUTS for f in layout.fields if f.name == column(field))
        if field.type.enum:
            name: str | None = declared.names.get(value)
            return name
        if field.type.flags:
            return [name for bit, name in declared.names.items() if value >> bit & 1]
        if isinstance(value, list):
            return [float(one) for one in value]
        return None if math.isnan(value) else float(value)

    def encode_raw(
        self, direction: Direction, command: str, node: int | None, raw: Mapping[str, Raw], parameters: Parameters
    ) -> Encoded | Refused:
        raise Cannot("encode")

    def encode_values(
        self,
        direction: Direction,
        command: str,
        node: int | None,
        values: Mapping[str, ExactValue],
        parameters: Parameters,
    ) -> Encoded | Refused:
        raise Cannot("encode")

    def answers(self, request: CanFrame, reply: CanFrame) -> Refused | None:
        raise Cannot("exchanges")
