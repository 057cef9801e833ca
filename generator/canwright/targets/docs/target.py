"""The target `docs`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import jinja2

from ...model import formatting
from ...model.edition import Edition
from ...model.types import Assignment
from ...templating import resources
from ...templating.data_files import read_data, template_texts
from ...templating.environment import environment
from ...templating.markup import block, code, markdown, spaced, xml
from ..base import EditionInput, Output, Target, header
from ..options import NO_OPTIONS, Options
from . import editions, guides, tables
from .common import Common
from .editions import Book
from .links import COMMANDS, PICTURES, command_page, entry_anchor
from .overview import overview
from .pages import Pages
from .probes import probes
from .questions import PAGE as QUESTIONS, questions
from .site_data import FILE, site_data
from .steps import first_steps

_RUNTIME = Path(__file__).parent / "runtime"
_PAGES = ("types", "parameters", "errata", "bus", "states")
_GUIDES = (
    *("quickstart", "which-edition", "logs", "bus-load", "dbc-import", "downloads", "glossary"),
    *("own-protocol", "new-edition", "compare-editions", "api", "assurance"),
)
"""Pages that are not about a single edition, with one template for each language."""


class DocsTarget(Target):
    """Generates Markdown documents."""

    title = "Markdown"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options = NO_OPTIONS
    ) -> Iterator[Output]:
        """One folder for each language, with one folder for each edition; and data for the site."""
        env = environment(
            "docs",
            {
                "md": markdown,
                "spaced": spaced,
                "code": code,
                "block": block,
                "command_page": command_page,
                "entry_anchor": entry_anchor,
                "exact": formatting.exact,
                "condition": formatting.condition,
                "raw_format": formatting.raw_format,
                "no_value": formatting.no_value,
                "id_rule": formatting.id_rule,
                "id_range": formatting.id_range,
                "label": labels_of([d.edition for d in specifications]).__getitem__,
            },
        )
        folder_of = folders([d.edition for d in specifications])
        books = list(_books(specifications, folder_of))
        commons = {item.edition: Common(item.edition, item.frames) for item in specifications}
        for book in books:
            yield from _front(env, book, commons)
        for item in specifications:
            common = commons[item.edition]
            yield from _pictures(common, folder_of[item.edition])
            for book in books:
                if book.language in item.edition.languages:
                    folder = f"{book.language}/{folder_of[item.edition]}"
                    yield from _edition(env, common, book, folder)
        yield Output(f"{PICTURES}/overview.svg", (_RUNTIME / "overview.svg").read_text("utf-8"))
        listed = [(folder_of[edition], edition) for edition in editions.in_order(folder_of)]
        yield Output(FILE, site_data(listed, labels_of([edition for _, edition in listed])))

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        for edition, folder in folders(editions).items():
            if folder.lower().endswith((".html", ".md")):
                yield edition, f"the folder `{folder}` of this edition would have the name of a page of the documents"


def folders(editions: Sequence[Edition]) -> Mapping[Edition, str]:
    """The folder of each edition."""
    families = {edition.family for edition in editions}
    return {edition: edition.name if len(families) == 1 else f"{edition.family}-{edition.name}" for edition in editions}


def labels_of(editions: Sequence[Edition]) -> Mapping[Edition, str]:
    """The label of each edition in titles and menus; with the family if there are several."""
    families = {edition.family for edition in editions}
    return {e: e.name if len(families) == 1 else f"{e.family} {e.name}" for e in editions}


def _books(specifications: Sequence[EditionInput], folders: Mapping[Edition, str]) -> Iterator[Book]:
    wordings: Mapping[str, editions.Wording] = template_texts("docs/changes.yaml")
    for language, labels in template_texts("docs/labels.yaml").items():
        here = editions.in_order(d.edition for d in specifications if language in d.edition.languages)
        if here:
            listed = [(folders[edition], edition) for edition in here]
            view = {"lang": language, "labels": labels, "by_command": editions.by_command(listed)}
            yield Book(language, labels, wordings.get(language, editions.ENGLISH), listed, view)


def _front(env: jinja2.Environment, book: Book, commons: Mapping[Edition, Common]) -> Iterator[Output]:
    """Pages that are not about a single edition."""
    language = book.language
    listed = [(folder, commons[edition]) for folder, edition in book.listed]
    only_editions = [edition for _, edition in book.listed]
    older = {edition: editions.previous(edition, only_editions) for edition in only_editions}
    changed = {
        edition: {
            name
            for name, changes in commons[edition].since(old).by_command.items()
            if changes and all(change.rule.id != "command-added" for change in changes)
        }
        for edition, old in older.items()
        if old
    }
    supported = list(editions.support(book, changed))
    starts = list(guides.starts(listed))
    about = {
        "editions": only_editions,
        "lengths": guides.lengths(only_editions),
        "has_support": bool(supported),
        "has_quickstart": bool(starts),
        "has_questions": False,
        "starts": starts,
        "first_steps": list(first_steps(book.listed, language)),
        "hints": {name: book.labels[f"hint_{name}"] for name in ("c", "python", "sh")},
        "telling": list(guides.telling_frames(listed)),
        "probes": list(probes(book.listed)),
        "words": [(edition, list(guides.words(edition))) for edition in only_editions],
    }
    view = {**book.view, **about}
    causes = read_data(resources.NO_ANSWER)
    no_answer = next((causes[edition.family] for edition in only_editions if edition.family in causes), None)
    view["labels"] = {**book.labels, "no_answer": markdown(no_answer["title"][language]) if no_answer else ""}
    asked = list(questions(book.listed))
    if asked:
        view["has_questions"] = True
        yield Output(f"{language}/{QUESTIONS}.md", env.get_template(f"{QUESTIONS}.md.j2").render(view, questions=asked))
    if no_answer:
        yield Output(f"{language}/no-answer.md", env.get_template("no-answer.md.j2").render(view, page=no_answer))
    lines = list(editions.front(book.listed))
    yield Output(f"{language}/index.md", env.get_template("language.md.j2").render(view, editions=lines))
    if supported:
        yield Output(f"{language}/support.md", env.get_template("support.md.j2").render(view, tables=supported))
    for name in _GUIDES:
        if (name != "new-edition" or supported) and (name != "quickstart" or starts):
            page = env.get_template(f"{name}.{language}.md.j2").render(view)
            yield Output(f"{language}/{name}.md", page)
    script = (_RUNTIME / "bus_load.js").read_text("utf-8")
    data = guides.load_data(book.listed, language)
    calculator = env.get_template("bus-load.html.j2").render(view, data=data, script=script)
    yield Output(f"{language}/bus-load-calculator.html", calculator)


def _edition(env: jinja2.Environment, common: Common, book: Book, folder: str) -> Iterator[Output]:
    edition = common.edition
    pages = Pages(common, book)
    old = editions.previous(edition, [listed for _, listed in book.listed])
    about = {
        "edition": edition,
        "header": header(edition),
        "pages": pages,
        "has_changes": old is not None,
        "pictures": f"../../../{PICTURES}/{folder.partition('/')[2]}/",
    }
    view = {**book.view, **about}
    yield Output(
        f"{folder}/index.md",
        env.get_template("overview.md.j2").render(view, **overview(edition, book)),
    )
    named = [type_ for type_ in edition.types if type_.path[0] == "types"]
    for name in _PAGES if edition.states else _PAGES[:-1]:
        yield Output(
            f"{folder}/{name}.md",
            env.get_template(f"{name}.md.j2").render(view, named_types=named, tables=tables, uses=common.uses),
        )
    template = env.get_template("command.md.j2")
    for sheet in common.sheets:
        changed = old and editions.changed(old, common.since(old).by_command[sheet.name], book)
        page = template.render({**view, **sheet.view, "sheet": sheet, "forms": sheet.forms, "changed": changed})
        yield Output(f"{folder}/{COMMANDS}{sheet.name}.md", page)
    if old is not None:
        changes = editions.changes(old, common.since(old).changes, book)
        yield Output(f"{folder}/changes.md", env.get_template("changes.md.j2").render(view, changes=changes))


def _pictures(common: Common, folder: str) -> Iterator[Output]:
    """The pictures, whose texts are names, so that all languages share them."""
    for sheet in common.sheets:
        for form in sheet.forms:
            for direction, side in form.sides:
                for drawn in side.drawn if side else ():
                    title = " ".join(filter(None, (form.command.name, direction.value, drawn.only)))
                    yield Output(f"{PICTURES}/{folder}/{drawn.file}", drawn.drawing.svg(xml(title)))


TARGET = DocsTarget()
