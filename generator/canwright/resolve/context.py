"""What every step of resolving needs: the document, what errors affect, and the findings so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from ..diagnostics.diagnostic import MOST_FINDINGS, Diagnostic, DocumentPath, nearest
from ..document.document import Document
from ..language import edition as schema
from ..model import formatting
from ..model.types import Text
from .affected import Affected

T = TypeVar("T")


_OF_AFFECTED = ("unknown-reference", "missing-language")
"""Rules whose findings do not depend on the rest of a definition."""


@dataclass
class Context:
    """What every step of resolving needs: the document for positions, the languages, and the findings so far.

    Definitions that are `affected` by errors are only checked for names that do not exist.
    """

    document: Document
    languages: tuple[schema.Language, ...]
    diagnostics: list[Diagnostic]
    affected: Affected

    def __post_init__(self) -> None:
        self.invalid: list[DocumentPath] = []
        """Where there is an error in more than a text."""
        self.unknown: list[DocumentPath] = []
        """Where there is a name of something that does not exist, or that is invalid."""
        self._unnamed: set[str] = set()
        """Languages of texts that the edition does not name."""

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
        """A finding at `path`, `about` what is invalid where that is more than what stands there."""
        self.invalid.append(path if about is None else about)
        self._report(path, rule, message, hint, key)

    def _report(self, path: DocumentPath, rule: str, message: str, hint: str, key: bool = False) -> None:
        is_hidden = path in self.affected if rule not in _OF_AFFECTED else self.affected.has_error(path)
        if not is_hidden and len(self.diagnostics) < MOST_FINDINGS:
            self.diagnostics.append(self.document.finding(path, rule, message, hint, key=key))

    def find(
        self, path: DocumentPath, kind: str, name: str, known: Mapping[str, T], hint: str = "", *, key: bool = False
    ) -> T | None:
        """`known[name]`, or a finding that there is no such thing, at the value or at the `key` that names it."""
        if name not in known:
            self.unknown.append(path)
            section = _SECTION.get(kind.partition(" ")[0], "")
            if section in (self.affected.sections if " " in kind else self.affected.incomplete):
                self.invalid.append(path)
            else:
                hint = hint or self._other_kind(name) or nearest(name, known) or _defined(kind, len(known))
                self.report(path, "unknown-reference", f"there is no {kind} `{name}`", hint, key=key)
        return known.get(name)

    def _other_kind(self, name: str) -> str:
        """What a name is, when it is that of something of another kind."""
        data = self.document.data if isinstance(self.document.data, dict) else {}
        kinds = (kind for key, kind in _KINDS.items() if isinstance(found := data.get(key), dict) and name in found)
        return next((f"`{name}` is {kind}" for kind in kinds), "")

    def is_invalid(self, path: DocumentPath) -> bool:
        """Whether there is an error at a path, or in the definition."""
        return path in self.invalid or path in self.affected

    def text(self, path: DocumentPath, written: schema.Text | None) -> Text:
        """A text in every language; a plain one stands for the only language."""
        if written is None or "languages" in self.affected.sections:
            return dict.fromkeys(self.languages, "")
        if isinstance(written, str):
            if len(self.languages) > 1:
                wanted = ", ".join(f"{language}: …" for language in self.languages)
                self._report(path, "missing-language", "this text is in one language only", f"write {{{wanted}}}")
            return dict.fromkeys(self.languages, written)
        for language in self.languages:
            if language not in written:
                hint = f"add {language}: …, or take `{language}` out of `languages`"
                self._report(path, "missing-language", f"this text has no `{language}`", hint)
        for language in written.keys() - {*self.languages, *self._unnamed}:
            self._unnamed.add(language)
            hint = f"languages: [{', '.join((*self.languages, language))}]"
            self._report((*path, language), "missing-language", f"the edition does not name `{language}`", hint, True)
        return {language: written.get(language, "") for language in self.languages}

    def title(self, path: DocumentPath, written: schema.Text | None, name: str) -> Text:
        """A title; a name in words where none is written."""
        if written is None:
            return dict.fromkeys(self.languages, formatting.spoken(name))
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
"""Where what there can be of a kind is defined; by the first word of the kind."""


def _defined(kind: str, number: int) -> str:
    """What to do where none of a kind is alike: where the others stand."""
    section = _SECTION.get(kind, "").replace("bus", "bus.modes")
    if not section or section in ("commands", "addresses"):
        return ""
    return (
        f"none of the {number} under `{section}` is like it; define it there"
        if number
        else f"none is defined; define it under `{section}`"
    )
