"""The handover target: each edition as one HTML file in each language, and its command matrix as CSV and Excel."""

from __future__ import annotations

import importlib.util
import shlex
from collections.abc import Iterator, Mapping, Sequence

from .. import registry
from ..base import BinaryOutput, EditionInput, Output
from ..options import NO_OPTIONS
from . import matrix, spreadsheets
from .document import document
from .labels import labels

_NEEDED = {"markdown_it": "markdown-it-py", "xlsxwriter": "XlsxWriter"}
"""Modules and the packages that contain them."""


def generate(specifications: Sequence[EditionInput]) -> Iterator[Output | BinaryOutput]:
    """The documents of every edition in each of its languages that has labels. Raises TargetError without the packages."""
    missing = [package for module, package in _NEEDED.items() if importlib.util.find_spec(module) is None]
    if missing:
        raise registry.TargetError(f"required packages are not installed; run: pip install {shlex.join(missing)}")
    for family in dict.fromkeys(item.edition.family for item in specifications):
        of_family = [item for item in specifications if item.edition.family == family]
        pages = _pages(of_family)
        for edition in (item.edition for item in of_family):
            for language in (name for name in edition.languages if name in labels()):
                folder = f"{language}/{edition.name}"
                name = f"{family}-{edition.name}-{language}"
                dated = f" ({edition.date})" if edition.date else ""
                title = f"{family} {edition.name}{dated}: {edition.title[language]}"
                rows = list(matrix.rows(edition, language))
                yield Output(f"{name}.html", document(pages, folder, language, title))
                yield BinaryOutput(f"{name}.csv", spreadsheets.csv_text(rows, labels()[language]))
                yield BinaryOutput(f"{name}.xlsx", spreadsheets.excel(rows, labels()[language], title, edition.name))


def _pages(specifications: Sequence[EditionInput]) -> Mapping[str, str]:
    """The pages of editions of one family, each in the folder of its name."""
    outputs = registry.target("docs").generate(specifications, {}, NO_OPTIONS)
    return {output.path: output.text for output in outputs if isinstance(output, Output)}
