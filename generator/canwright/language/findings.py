"""What the decoder finds in a file: findings, and names with the places of their definitions and references."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import NamedTuple

from ..diagnostics.diagnostic import MAX_FINDINGS, Diagnostic, DocumentPath, with_number_of_others
from ..document.document import Document
from .concept import Defines, Ref


class Definition(NamedTuple):
    """The definition of a name; `owner` is the definition of which it is a part, such as the parameter of a value."""

    path: DocumentPath
    kind: str
    name: str
    owner: str


class Reference(NamedTuple):
    """A reference to a definition; with `key`, a key of a mapping refers to it."""

    path: DocumentPath
    kind: str
    name: str
    owner: str
    key: bool
    words: tuple[str, ...]
    """Words that are valid instead of a name."""


@dataclass
class Names:
    """The definitions and references of a file, in their order."""

    definitions: list[Definition] = field(default_factory=list)
    references: list[Reference] = field(default_factory=list)


class Findings:
    """The findings about a document, and the names in it; `languages` are those of its texts, if they are known."""

    def __init__(self, document: Document, languages: Sequence[str]) -> None:
        self._document = document
        self._languages = languages
        self._unlisted: set[str] = set()
        """Languages of texts that are not in `languages`."""
        self._listed: list[Diagnostic] = []
        self.number = 0
        """The number of findings so far."""
        self.names = Names()

    @property
    def is_full(self) -> bool:
        """Whether further findings are only counted."""
        return len(self._listed) >= MAX_FINDINGS

    @property
    def findings(self) -> list[Diagnostic]:
        """The findings so far; the last one states how many more there are."""
        return with_number_of_others(self._listed, self.number - len(self._listed))

    def finding(self, path: DocumentPath, rule: str, message: str, hint: str = "", *, key: bool = False) -> None:
        """Adds a finding at a path."""
        self.number += 1
        if not self.is_full:
            message = message[:1].lower() + message[1:]
            self._listed.append(self._document.finding(path, rule, message, hint, key=key))

    def add_name(self, role: Defines | Ref, name: str, path: DocumentPath, owner: str, key: bool) -> None:
        """Adds a name that is defined or referred to at a path."""
        owner = owner if role.of else ""
        if isinstance(role, Defines):
            self.names.definitions.append(Definition(path, role.kind, name, owner))
        elif name not in role.words:
            self.names.references.append(Reference(path, role.kind, name, owner, key, role.words))

    def no_text(self) -> dict[str, str]:
        """The text in every language for a key that is omitted."""
        return dict.fromkeys(self._languages, "")

    def translated(self, path: DocumentPath, written: str | Mapping[str, str]) -> dict[str, str]:
        """A text in every language; a plain text is that of the only language."""
        if isinstance(written, str):
            if len(self._languages) > 1:
                texts = ", ".join(f"{language}: …" for language in self._languages)
                text = "this text is in one language only"
                self.finding(path, "missing-language", text, f"write {{{texts}}}")
            return dict.fromkeys(self._languages, written)
        for language in self._languages:
            if language not in written:
                hint = f"add {language}: …, or remove `{language}` from `languages`"
                self.finding(path, "missing-language", f"this text has no `{language}`", hint)
        for language in written.keys() - {*self._languages, *self._unlisted} if self._languages else ():
            self._unlisted.add(language)
            hint = f"remove it, or write languages: [{', '.join((*self._languages, language))}]"
            text = f"`languages` of the edition does not contain `{language}`"
            self.finding((*path, language), "missing-language", text, hint, key=True)
        return {language: written.get(language, "") for language in self._languages}

    def is_type(self, name: object) -> bool:
        """Whether the document defines a type of this name."""
        data = self._document.data
        types = data.get("types") if isinstance(data, dict) else None
        return isinstance(types, dict) and isinstance(name, str) and name in types

    def written(self, path: DocumentPath, value: object, *, key: bool = False) -> str:
        """A number in the notation of the file: 0x80, not 128."""
        if not key and (isinstance(value, bool) or not isinstance(value, (int, Decimal))):
            return str(value)
        at = self._document.position(path, key=key)
        text = at.text[at.column - 1 :][: at.length].strip("'\"")
        return text if text and len(text) < 40 else str(value)
