"""The shared context of resolvers: the document, affected definitions, and findings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from ..diagnostics.diagnostic import MAX_FINDINGS, Diagnostic, DocumentPath, nearest, with_number_of_others
from ..document.document import Document
from ..language import edition as schema
from ..model import formatting
from ..model.types import ImpliedTitle, Text
from .affected import Affected

T = TypeVar("T")


_INDEPENDENT_RULES = ("unknown-reference", "missing-language")
"""Rules with findings that do not depend on the rest of a definition."""


@dataclass
class Context:
    """The shared context of resolvers. In definitions `affected` by errors, they report only unknown names."""

    document: Document
    languages: tuple[schema.Language, ...]
    diagnostics: list[Diagnostic]
    affected: Affected

    def __post_init__(self) -> None:
        self.invalid: dict[DocumentPath, None] = {}
        """Paths of errors, except for errors in texts."""
        self.unknown: list[DocumentPath] = []
        """Paths of names without a valid definition."""
        self._unlisted: set[str] = set()
        """Languages of texts that are not in `languages`."""
        self._more = 0

    @property
    def is_full(self) -> bool:
        """Whether further findings are only counted."""
        return len(self.diagnostics) >= MAX_FINDINGS

    @property
    def findings(self) -> list[Diagnostic]:
        """The findings so far; the last one states how many more there are."""
        return with_number_of_others(self.diagnostics, self._more)

    def report(
        self,
        path: DocumentPath,
        rule: str,
        message: str,
        hint: str = "",
        *,
        key: bool = False,
        about: DocumentPath | None = None,
    ) -> None:
        """Adds a finding at `path`; `about` is the path of the invalid value, if it is a different one."""
        self.invalid[path if about is None else about] = None
        self._report(path, rule, message, hint, key)

    def _report(self, path: DocumentPath, rule: str, message: str, hint: str, key: bool = False) -> None:
        is_hidden = path in self.affected if rule not in _INDEPENDENT_RULES else self.affected.has_error(path)
        if not is_hidden and self.is_full:
            self._more += 1
        elif not is_hidden:
            self.diagnostics.append(self.document.finding(path, rule, message, hint, key=key))

    def find(
        self, path: DocumentPath, kind: str, name: str, known: Mapping[str, T], hint: str = "", *, key: bool = False
    ) -> T | None:
        """`known[name]`, or None and a finding for an unknown name, which is a value or a `key`."""
        if name not in known:
            self.unknown.append(path)
            section = _SECTION.get(kind.partition(" ")[0], "")
            if section in (self.affected.sections if " " in kind else self.affected.incomplete):
                self.invalid[path] = None
            else:
                if not self.is_full:
                    hint = hint or self._other_kind(name) or nearest(name, known) or _defined(kind, len(known))
                self.report(path, "unknown-reference", f"there is no {kind} `{name}`", hint, key=key)
        return known.get(name)

    def _other_kind(self, name: str) -> str:
        """A hint for a name with a definition of another kind."""
        data = self.document.data if isinstance(self.document.data, dict) else {}
        kinds = (kind for key, kind in _KINDS.items() if isinstance(named := data.get(key), dict) and name in named)
        return next((f"`{name}` is {kind}" for kind in kinds), "")

    def is_invalid(self, path: DocumentPath) -> bool:
        """Whether there is an error at a path, or in its definition."""
        return path in self.invalid or path in self.affected

    def text(self, path: DocumentPath, written: schema.Text | None) -> Text:
        """A text in every language; a plain text is that of the only language."""
        if written is None or "languages" in self.affected.sections:
            return dict.fromkeys(self.languages, "")
        if isinstance(written, str):
            if len(self.languages) > 1:
                texts = ", ".join(f"{language}: …" for language in self.languages)
                self._report(path, "missing-language", "this text is in one language only", f"write {{{texts}}}")
            return dict.fromkeys(self.languages, written)
        for language in self.languages:
            if language not in written:
                hint = f"add {language}: …, or remove `{language}` from `languages`"
                self._report(path, "missing-language", f"this text has no `{language}`", hint)
        for language in written.keys() - {*self.languages, *self._unlisted}:
            self._unlisted.add(language)
            hint = f"remove it, or write languages: [{', '.join((*self.languages, language))}]"
            self._report(
                (*path, language),
                "missing-language",
                f"`languages` of the edition does not contain `{language}`",
                hint,
                True,
            )
        return {language: written.get(language, "") for language in self.languages}

    def title(self, path: DocumentPath, written: schema.Text | None, name: str) -> Text:
        """A title; by default the words of the name."""
        if written is None:
            return ImpliedTitle.fromkeys(self.languages, formatting.spoken(name))
        return self.text((*path, "title"), written)


_KINDS = {
    "types": "a type",
    "layouts": "a layout",
    "tables": "a table",
    "commands": "a command",
    "parameters": "a parameter",
    "addresses": "an address",
    "settings": "a setting",
    "effects": "an effect",
}

_SECTION = {
    "type": "types",
    "layout": "layouts",
    "table": "tables",
    "command": "commands",
    "code": "commands",
    "parameter": "parameters",
    "value": "parameters",
    "address": "addresses",
    "setting": "settings",
    "effect": "effects",
    "mode": "bus",
}
"""Sections with definitions, by the first word of a kind."""


def _defined(kind: str, number: int) -> str:
    """A hint for an unknown name without a similar one."""
    section = _SECTION.get(kind, "").replace("bus", "bus.modes")
    if not section or section in ("commands", "addresses"):
        return ""
    return (
        f"define it under `{section}`; none of the {number} names there is similar"
        if number
        else f"define it under `{section}`"
    )
