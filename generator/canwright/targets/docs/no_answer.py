"""Why a device does not answer: a page for each language, of the family that states it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from ...model.edition import Edition
from ...templating import resources
from ...templating.data_files import read_data
from ...templating.markup import markdown, spaced

PAGE = "no-answer"


class Cause(NamedTuple):
    """A cause, and the commands that show it; the texts are Markdown."""

    anchor: str
    title: str
    text: str
    commands: str


class NoAnswerPage(NamedTuple):
    """The page; the texts are Markdown."""

    title: str
    about: str
    causes: Sequence[Cause]


def no_answer_page(editions: Iterable[Edition], language: str) -> NoAnswerPage | None:
    """The page of the first family that has one."""
    data = read_data(resources.NO_ANSWER)
    written = next((data[edition.family] for edition in editions if edition.family in data), None)
    if written is None:
        return None
    causes = [
        Cause(
            f"{PAGE}.{cause['name']}",
            markdown(cause["title"][language]),
            spaced(markdown(cause["text"][language])),
            cause["commands"],
        )
        for cause in written["causes"]
    ]
    return NoAnswerPage(markdown(written["title"][language]), spaced(markdown(written["about"][language])), causes)
