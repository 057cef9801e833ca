"""Titles, menus, neighbours and the search index of the pages of one language."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

_COMMANDS = "commands/"


class Item(NamedTuple):
    """A link of a menu; `code` is that of a command."""

    page: str
    code: str
    title: str

    @property
    def text(self) -> str:
        """Code and title; the title alone if it contains the code."""
        return self.title if self.code in self.title else f"{self.code} {self.title}"


class Page(NamedTuple):
    """What the theme shows around a page; texts are not escaped."""

    item: Item
    title: str
    """For the window, bookmarks and other search engines: with code and edition."""
    description: str
    edition: str
    """The folder of the edition; empty on pages that are not about a single edition."""
    others: Sequence[tuple[str, str, bool]]
    """Folder, page and whether the page exists, for each edition of the family; the current one included."""


class Menu:
    """The pages of one language. `titles` and `metadata` are those of Sphinx; `data` is the file of the docs target."""

    def __init__(
        self,
        data: Mapping[str, Any],
        titles: Mapping[str, str],
        metadata: Mapping[str, Mapping[str, Any]],
        language: str,
    ) -> None:
        self._titles = titles
        self._metadata = metadata
        self._language = language
        self._words = {key: data[key] for key in ("synonyms", "stops", "questions")}
        self.editions = {e["folder"]: e for e in data["editions"] if language in e["languages"]}
        self._commands: dict[str, list[Mapping[str, Any]]] = {}
        for folder, edition in self.editions.items():
            for record in edition["records"]:
                if record["kind"] == "command":
                    self._commands.setdefault(f"{folder}/{record['pages'][0]}", []).append(record)
        self.front = [self._item(name) for name in self._ordered("")]
        """Pages that are not about a single edition."""
        self.pages = {folder: [self._item(n) for n in self._ordered(f"{folder}/")] for folder in self.editions}
        """Pages of each edition other than those of commands."""
        self.commands = {
            folder: [self._item(name) for name in self._commands if name.startswith(f"{folder}/")]
            for folder in self.editions
        }
        """Pages of the commands of each edition, in the order of the spec."""
        self._neighbours = dict(self._all_neighbours())

    def _all_neighbours(self) -> Iterator[tuple[str, tuple[Item | None, Item | None]]]:
        """The pages before and after each page, in the order of the menus and within an edition."""
        for items in (self.front, *([*self.pages[folder], *self.commands[folder]] for folder in self.editions)):
            for before, item, after in zip([None, *items], items, [*items[1:], None], strict=False):
                yield item.page, (before, after)

    def _ordered(self, folder: str) -> Iterable[str]:
        """Pages of a folder that are not of commands: the first page, those it links in this order, and the others."""
        own = [name for name in sorted(self._titles) if name.startswith(folder) and "/" not in name[len(folder) :]]
        first = f"{folder}index"
        linked = [name for name in self._metadata.get(first, {}).get("links", ()) if name in own]
        return dict.fromkeys([*([first] if first in own else []), *linked, *own])

    def _item(self, name: str) -> Item:
        records = self._commands.get(name, ())
        codes = ", ".join(dict.fromkeys(record["code"] for record in records if record.get("code")))
        only = records[0] if len(records) == 1 else None
        return Item(name, codes, only["title"][self._language] if only else self._titles[name])

    def page(self, name: str) -> Page:
        """What the theme shows around a page."""
        folder = self.edition_of(name)
        item = self._item(name)
        label = self.editions[folder]["name"] if folder else ""
        title = item.text if not label or label in item.text else f"{item.text}, {label}"
        records = self._commands.get(name, ())
        about = records[0].get("about", {}).get(self._language, "") if records else ""
        return Page(item, title, about or title, folder, list(self._others(name, folder)))

    def _others(self, name: str, folder: str) -> Iterator[tuple[str, str, bool]]:
        family = self.editions[folder]["family"] if folder else None
        for member, edition in self.editions.items():
            if edition["family"] == family:
                same = member + name[len(folder) :]
                yield member, same if same in self._titles else f"{member}/index", same in self._titles

    def edition_of(self, name: str) -> str:
        """The folder of the edition that a page is about; empty without one."""
        folder, slash, _ = name.partition("/")
        return folder if slash and folder in self.editions else ""

    def neighbours(self, name: str) -> tuple[Item | None, Item | None]:
        """The pages before and after a page, within an edition."""
        return self._neighbours.get(name, (None, None))

    def _searched(self, name: str) -> Mapping[str, Any]:
        noted = self._metadata.get(name, {})
        return {"headings": noted.get("headings", []), "text": " ".join(noted.get("text", "").split())}

    def index(self) -> Mapping[str, Any]:
        """What the search finds: records of the editions; titles, headings and texts of the other pages."""
        return {
            **self._words,
            "pages": {
                name: {"title": self._item(name).text, **self._searched(name)}
                for name in self._titles
                if name not in self._commands
            },
            "editions": [
                {key: edition[key] for key in ("folder", "family", "name", "date", "records")}
                for edition in self.editions.values()
            ],
        }
