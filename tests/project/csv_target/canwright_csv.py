"""A canwright target: one table of all fields of an edition, for spreadsheets and databases."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

from canwright import Assignment, DocumentPath, Edition, EditionInput, NameProblem, Output, Target

COLUMNS = ("message", "direction", "field", "bits", "type", "unit")
RESERVED = frozenset({"group", "order", "select"})
"""Words of SQL, which cannot name a column without quotes."""


class CsvTarget(Target):
    """`FAMILY-EDITION.csv`, one row for each field of each message."""

    title = "CSV"

    def generate(self, specifications: Sequence[EditionInput], set_parameters: Assignment) -> Iterator[Output]:
        for edition, _ in specifications:
            table = io.StringIO()
            writer = csv.writer(table, lineterminator="\n")
            writer.writerow(COLUMNS)
            writer.writerows(_rows(edition))
            yield Output(f"{edition.family}-{edition.name}.csv", table.getvalue())

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        fields = {field.path: field for message in edition.all_messages() for field in message.layout.fields}
        for path, field in fields.items():
            if field.name in RESERVED:
                yield NameProblem(path, f"`{field.name}` is a reserved word of SQL", "choose another name")

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        return ((field.path, field.name) for message in edition.all_messages() for field in message.layout.fields)


def _rows(edition: Edition) -> Iterator[tuple[str, ...]]:
    for message in edition.all_messages():
        for field in message.layout.fields:
            bits = " ".join(str(bit) for element in field.elements for bit in element.bits)
            unit = field.type.unit.symbol if field.type.unit else ""
            yield message.name, message.direction.value, field.name, bits, field.type.name, unit


TARGET = CsvTarget()
