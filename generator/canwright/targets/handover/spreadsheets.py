"""Rows as CSV and as an Excel file: numbers are numbers, and no text is a formula."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from datetime import datetime
from fractions import Fraction
from typing import NamedTuple

from ...model import formatting
from .matrix import Cell, Row

_FORMULA = ("=", "+", "-", "@", "\t")
"""Starts of a text that a spreadsheet takes for a formula."""
_CREATED = datetime(2000, 1, 1)
"""A fixed date, so that equal rows make an equal file."""
_EXACT = 10**15
"""Excel keeps 15 digits of a number."""


class Sheet(NamedTuple):
    """A sheet of an Excel file; each row has a cell for each heading."""

    name: str
    headings: Sequence[str]
    rows: Sequence[Sequence[Cell]]


def csv_text(rows: Sequence[Row], headings: Mapping[str, str]) -> bytes:
    """CSV in UTF-8 with the mark by which spreadsheets recognise it; no cell is a formula."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\r\n")
    writer.writerow([headings[name] for name in Row._fields])
    writer.writerows(
        [_decimal(cell) if isinstance(cell, Fraction) else _harmless(cell) for cell in row] for row in rows
    )
    return stream.getvalue().encode("utf-8-sig")


def _decimal(number: Fraction) -> str:
    """An exact decimal if there is one of moderate length, else the nearest double."""
    exact = formatting.exact(number)
    return repr(float(number)) if "/" in exact else exact


def _harmless(cell: str) -> str:
    return f"'{cell}" if cell.startswith(_FORMULA) else cell


def excel(sheets: Sequence[Sheet], title: str) -> bytes:
    """An Excel file; each sheet has the title above the rows, a filter and fixed headings. Equal rows make an equal file.

    Raises ImportError.
    """
    import xlsxwriter

    stream = io.BytesIO()
    book = xlsxwriter.Workbook(stream, {"in_memory": True})
    book.set_properties({"title": title, "created": _CREATED})
    large = book.add_format({"bold": True, "font_size": 14})
    head = book.add_format({"bold": True, "text_wrap": True, "valign": "top"})
    body = book.add_format({"text_wrap": True, "valign": "top"})
    for content in sheets:
        sheet = book.add_worksheet(content.name)
        sheet.write_string(0, 0, title, large)
        for column, heading in enumerate(content.headings):
            sheet.write_string(1, column, heading, head)
            longest = max((len(shown(row[column])) for row in content.rows), default=0)
            sheet.set_column(column, column, min(36, max(6, longest, len(heading))))
        for at, row in enumerate(content.rows, 2):
            for column, cell in enumerate(row):
                if isinstance(cell, Fraction) and abs(cell) < _EXACT:
                    sheet.write_number(at, column, float(cell), body)
                else:
                    sheet.write_string(at, column, shown(cell), body)
        sheet.freeze_panes(2, 1)
        sheet.autofilter(1, 0, len(content.rows) + 1, len(content.headings) - 1)
        sheet.set_landscape()
        sheet.set_paper(9)
        sheet.fit_to_pages(1, 0)
        sheet.repeat_rows(0, 1)
    book.close()
    return stream.getvalue()


def shown(cell: Cell) -> str:
    return _decimal(cell) if isinstance(cell, Fraction) else cell
