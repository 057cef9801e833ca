"""The docs target: Markdown that reads well on its own and builds into a site, in every language of the spec."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import jinja2
import yaml

from ... import resources, words
from ...compare import Change, compare
from ...model import Assignment
from ...render import environment
from .. import Described, Output, header
from . import editions
from .pages import Pages
from .text import code, markdown

_PAGES = ("types", "parameters", "errata", "bus")


def generate(described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
    """A folder for each language, in it one for each edition."""
    labels: dict[str, dict[str, str]] = _words("labels")
    says: dict[str, editions.Says] = _words("changes")
    env = environment(
        "docs",
        {"md": markdown, "code": code, "exact": words.exact, "raw_format": words.raw_format, "id_rule": words.id_rule},
    )
    compared: dict[tuple[int, int], Sequence[Change]] = {}
    families = {d.edition.family for d in described}
    for language in [one for one in labels if any(one in d.edition.languages for d in described)]:
        here = [d for d in described if language in d.edition.languages]
        folders = {
            id(d): d.edition.name if len(families) == 1 else f"{d.edition.family}-{d.edition.name}" for d in here
        }
        common: dict[str, object] = {"labels": labels[language], "lang": language}
        by_edition = {id(d.edition): folders[id(d)] for d in here}
        listed = [(by_edition[id(e)], e) for e in editions.in_order(d.edition for d in here)]
        tables = list(editions.support(listed, labels[language], language))
        lines = list(editions.front(listed))
        front = env.get_template("language.md.j2").render(common, editions=lines, has_support=bool(tables))
        yield Output(f"{language}/index.md", front)
        if tables:
            yield Output(f"{language}/support.md", env.get_template("support.md.j2").render(common, tables=tables))
            page = env.get_template(f"new_edition.{language}.md.j2").render(common)
            yield Output(f"{language}/new-edition.md", page)
        common["by_command"] = editions.by_command(listed)
        for item in here:
            old = editions.previous(item.edition, [edition for _, edition in listed])
            folder = f"{language}/{folders[id(item)]}"
            yield from _edition(env, item, {**common, "has_changes": old is not None}, folder)
            if old is not None:
                pair = (id(old), id(item.edition))
                if pair not in compared:
                    compared[pair] = compare(old, item.edition)
                changes = editions.changes(
                    old, compared[pair], language, labels[language], says.get(language, editions.ENGLISH)
                )
                view = {**common, "edition": item.edition, "header": header(item.edition), "changes": changes}
                yield Output(f"{folder}/changes.md", env.get_template("changes.md.j2").render(view))


def _words(name: str) -> Any:
    """A file of words of the documents, by language."""
    text = (resources.TEMPLATES / "docs" / f"{name}.yaml").read_text("utf-8")
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))


def _edition(env: jinja2.Environment, item: Described, common: Mapping[str, object], folder: str) -> Iterator[Output]:
    language = str(common["lang"])
    pages = Pages(item.edition, item.frames, common["labels"], language)  # type: ignore[arg-type]
    view = {**common, "edition": item.edition, "header": header(item.edition), "pages": pages}
    yield Output(f"{folder}/index.md", env.get_template("overview.md.j2").render(view, **pages.overview()))
    for name in _PAGES:
        yield Output(f"{folder}/{name}.md", env.get_template(f"{name}.md.j2").render(view, **pages.types()))
    template = env.get_template("command.md.j2")
    for command in item.edition.commands:
        page = pages.command(command)
        yield Output(f"{folder}/commands/{command.name}.md", template.render(view, **page))
        for half in page["halves"]:
            for picture in half.pictures:
                yield Output(f"{folder}/pictures/{picture.file}", picture.svg)
