"""The generated columns package: every frame is decoded as an array of one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

from canwright.conformance.adapter import (
    CanFrame,
    Cannot,
    Decoded,
    DecodeOnlyAdapter,
    Parameters,
    Raw,
    Refused,
    Value,
    write_files,
)
from canwright.conformance.modules import load
from canwright.model.edition import Edition
from canwright.model.layout import Field
from canwright.model.message import Direction
from canwright.model.refusal import Refusal
from canwright.model.types import NO_PARAMETERS, Encoding
from canwright.targets.base import EditionInput
from canwright.targets.columns.target import TARGET, package_name
from canwright.targets.columns.view import columns_of, constant_name
from canwright.targets.options import Options


class ColumnsAdapter(DecodeOnlyAdapter):
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
        self._decoders: dict[tuple[tuple[str, int | str | Fraction], ...], Any] = {}

    @classmethod
    def create(cls, specification: EditionInput, workdir: Path) -> ColumnsAdapter:
        folder = write_files(TARGET.generate([specification], {}, Options()), workdir)
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
        decoded = decoder.decode(self._runtime.frames(ids, data, way, kind=kind))
        number = int(decoded.message[0])
        assert number == decoded.message[2]
        if number < 0:
            return Refused(Refusal[self._runtime.Refusal(number).name])
        message = self._module.MESSAGES[number]
        if expected not in (None, message.command):
            raise Cannot("expected")
        table = decoded.tables[self._module.LAYOUTS[message.layout].name]
        assert table.rows[0] == 0 and table.message[0] == number
        node = int(table.node[0])
        ours = self.message_of(direction, message.command)
        raw: dict[str, Raw] = {}
        values: dict[str, Value] = {}
        for field, names in columns_of(ours.layout).items():
            own = [table.columns[name].tolist()[0] for name in names if name in table.columns]
            if own:
                raw[field.name] = own[-1]
                has_scale = names.value in table.columns
                type_: Any = getattr(self._module, constant_name(field.type))
                if field.type.names:
                    assert names.raw in table.columns or field.type.is_plain or not has_scale
                    assert type_.names == {member.value: member.name for member in field.type.names}
                if field.type.no_values:
                    values[field.name] = self._value_or_name(
                        field, own[0] if has_scale else None, table.columns[names.raw]
                    )
                    continue
                values[field.name] = self._value(own[0], field) if has_scale else None
        return Decoded(message.command, None if node < 0 else node, raw, values)

    def _value(self, value: Any, field: Field) -> Value:
        if field.type.flags or field.type.enum:
            names: Mapping[int, str] = getattr(self._module, constant_name(field.type)).names
            return [n for bit, n in names.items() if value >> bit & 1] if field.type.flags else names.get(value)
        if isinstance(value, str):
            return value
        if isinstance(value, list):
            return [float(element) for element in value]
        return None if math.isnan(value) else float(value)

    def _value_or_name(self, field: Field, value: Any, raw: Any) -> Any:
        """The value of a number, or the name of its raw integers; values without a scale are None."""
        named = getattr(self._module, constant_name(field.type)).no_value_names(raw)[0].tolist()
        if not isinstance(named, list):
            return self._named(field, value, named)
        values = value or [None] * len(named)
        return [self._named(field, each, name) for name, each in zip(named, values, strict=True)]

    def _named(self, field: Field, value: Any, name: str) -> float | str | None:
        is_infinite = field.type.encoding is Encoding.FLOAT and not name
        assert value is None or is_infinite or math.isnan(value) is bool(name)
        return name or (None if value is None or math.isnan(value) else float(value))

    def answers(self, request: CanFrame, reply: CanFrame, parameters: Parameters = NO_PARAMETERS) -> Refused | None:
        raise Cannot("exchanges")
