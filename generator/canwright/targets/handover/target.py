"""The target `handover`."""

from __future__ import annotations

import importlib.util
import shlex
from collections.abc import Iterator, Mapping, Sequence

from ...model.edition import Edition
from ...model.types import Assignment
from ...templating.data_files import template_texts
from .. import registry
from ..base import BinaryOutput, EditionInput, Output, Target
from ..options import NO_OPTIONS, Options, TargetOption
from . import matrix, spreadsheets
from .document import document
from .pdf import FONTS, pdf
from .reference import reference
from .sheets import sheets

_NEEDED = {"markdown_it": "markdown-it-py", "xlsxwriter": "XlsxWriter"}
"""Modules and the packages that contain them."""
_NEEDED_FOR_PDF = {"typst": "typst", FONTS: "pylopdf-fonts-zh-cn"}


def _chosen(text: str, editions: Sequence[Edition]) -> bool:
    if text not in ("yes", "no"):
        raise ValueError("expected yes or no")
    return text == "yes"


PDF: TargetOption[bool] = TargetOption(
    name="pdf",
    metavar="yes|no",
    help="Also write a PDF of each edition and language; default: no.",
    default=False,
    parse=_chosen,
)


class HandoverTarget(Target):
    """Generates documents to hand over, which need packages that canwright does not install."""

    title = "Hand-over documents"
    is_default = False
    options = (PDF,)

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options = NO_OPTIONS
    ) -> Iterator[Output | BinaryOutput]:
        """The documents of every edition in each of its languages that has labels. Raises TargetError without the packages."""
        needed = _NEEDED | (_NEEDED_FOR_PDF if options[PDF] else {})
        missing = [package for module, package in needed.items() if importlib.util.find_spec(module) is None]
        if missing:
            raise registry.TargetError(f"required packages are not installed; run: pip install {shlex.join(missing)}")
        labels = template_texts("handover/labels.yaml")
        for family in dict.fromkeys(item.edition.family for item in specifications):
            of_family = [item for item in specifications if item.edition.family == family]
            pages = _pages(of_family)
            for item in of_family:
                edition = item.edition
                for language in (name for name in edition.languages if name in labels):
                    folder = f"{language}/{edition.name}"
                    name = f"{family}-{edition.name}-{language}"
                    dated = f" ({edition.date})" if edition.date else ""
                    title = f"{family} {edition.name}{dated}: {edition.title[language]}"
                    shown = matrix.Shown(edition, language, labels[language])
                    rows = list(matrix.rows(shown))
                    yield Output(f"{name}.html", document(pages, folder, language, title, labels[language]))
                    yield BinaryOutput(f"{name}.csv", spreadsheets.csv_text(rows, labels[language]))
                    yield BinaryOutput(f"{name}.xlsx", spreadsheets.excel(sheets(item, rows, shown), title))
                    if options[PDF]:
                        yield BinaryOutput(f"{name}.pdf", pdf(reference(item, rows, shown, title)))


def _pages(specifications: Sequence[EditionInput]) -> Mapping[str, str]:
    """The pages of editions of one family, each in the folder of its name."""
    outputs = registry.target("docs").generate(specifications, {}, NO_OPTIONS)
    return {output.path: output.text for output in outputs if isinstance(output, Output)}


TARGET = HandoverTarget()
