"""Questions of users with answers: a page for each language, and records for the search."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from ...model.edition import Edition
from ...templating import resources
from ...templating.data_files import read_data
from ...templating.markup import code
from .links import COMMANDS
from .tables import codes

PAGE = "questions"
Record = Mapping[str, Any]


Link = tuple[str, str, Sequence[tuple[str, Edition]]]
"""A command that answers a question, in Markdown, its page, and the editions that have it with their folders."""


def questions(listed: Sequence[tuple[str, Edition]]) -> Iterator[tuple[Record, Sequence[Link]]]:
    """The questions of the families of some editions, which have folders, with the commands that answer them."""
    for family, written in _written(edition for _, edition in listed):
        of_family = [(folder, edition) for folder, edition in listed if edition.family == family]
        yield written, [link for name in written.get("commands", ()) for link in _links(name, of_family)]


def _links(name: str, listed: Sequence[tuple[str, Edition]]) -> Iterator[Link]:
    """One link for each code, or id without one, that the command has in some editions."""
    having: dict[str, list[tuple[str, Edition]]] = {}
    for folder, edition in listed:
        for command in edition.forms(name)[:1]:
            having.setdefault(" ".join(map(code, codes(command))), []).append((folder, edition))
    for shown, editions in having.items():
        yield f"{shown} {code(name)}".lstrip(), f"{COMMANDS}{name}.md", editions


def question_records(editions: Iterable[Edition]) -> Iterator[Record]:
    """The questions as records for the search."""
    for _, written in _written(editions):
        yield {
            "kind": "question",
            "name": written["name"],
            "title": written["ask"],
            "about": written["answer"],
            "words": written.get("words", []),
            "pages": [f"{PAGE}#{PAGE}.{written['name']}"],
        }


def _written(editions: Iterable[Edition]) -> Iterator[tuple[str, Record]]:
    """The questions of each family, with its name, as they are written."""
    families = dict.fromkeys(edition.family for edition in editions)
    data = read_data(resources.QUESTIONS)
    return ((family, written) for family in families for written in data.get(family, ()))
