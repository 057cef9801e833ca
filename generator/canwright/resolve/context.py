"""What every step of resolving needs: the document, what of it could not be read, and the findings so far."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from ..diagnostics.diagnostic import MOST_FINDINGS, Diagnostic, DocumentPath, near, nearest
from ..document.document import Document
from ..language import edition as schema, suggestions
from ..model import formatting
from ..model.types import UNNAMED, Text

T = TypeVar("T")


@dataclass
class Context:
    """What every step of resolving needs: the document for positions, the languages, and the findings so far.

    `dropped` are the parts that could not be read; what is missing because of them is not a finding of its own.
    """

    document: Document
    languages: tuple[schema.Language, ...]
    diagnostics: list[Diagnostic]
    dropped: frozenset[DocumentPath] = frozenset()

    def __post_init__(self) -> None:
        self.amiss: list[DocumentPath] = []
        """Where something is amiss that is more than a text."""
        self._unnamed: set[str] = set()
        """Languages of texts that the edition does not name."""
        self._lacking = {path[:end] for path in self.dropped for end in range(len(path) + 1)}
        self._lost = {name for path in self.dropped if path for name in (path[-1], suggestions.plain(str(path[-1])))}

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
        """A finding at `path`, `about` what makes it amiss where that is more than what stands there."""
        self.amiss.append(path if about is None else about)
        self._tell(path, rule, message, hint, key)

    def _tell(self, path: DocumentPath, rule: str, message: str, hint: str, key: bool = False) -> None:
        if path not in self._lacking and len(self.diagnostics) < MOST_FINDINGS:
            self.diagnostics.append(self.document.finding(path, rule, message, hint, key=key))

    def find(
        self, path: DocumentPath, kind: str, name: str, known: Mapping[str, T], hint: str = "", *, key: bool = False
    ) -> T | None:
        """`known[name]`, or a finding that there is no such thing, at the value or at the `key` that names it."""
        if name not in known and (name in self._lost or self.is_lost(_plural(kind)) or self._near_lost(kind, name)):
            self.amiss.append(path)
        elif name not in known:
            hint = hint or self._other_kind(name) or nearest(name, known) or _defined(kind, len(known))
            self.report(path, "unknown-reference", f"there is no {kind} `{name}`", hint, key=key)
        return known.get(name)

    def _other_kind(self, name: str) -> str:
        """What a name is, when it is that of something of another kind."""
        data = self.document.data if isinstance(self.document.data, dict) else {}
        kinds = (kind for key, kind in _KINDS.items() if isinstance(found := data.get(key), dict) and name in found)
        return next((f"`{name}` is {kind}" for kind in kinds), "")

    def is_amiss(self, path: DocumentPath) -> bool:
        """Whether there is a finding at a path, or something within was left out."""
        return path in self.amiss or path in self._lacking

    def has_lost(self, dotted: str) -> bool:
        """Whether a dotted path may have led to something that could not be read."""
        steps = dotted.split(".")
        return not {(steps[0],), (steps[0], UNNAMED)}.isdisjoint(self.dropped) or not self._lost.isdisjoint(steps[1:])

    def _near_lost(self, kind: str, name: str) -> bool:
        """Whether a name may be that of something that could not be read: its own is much alike, or not known."""
        lost = {str(path[1]) for path in self.dropped if path[:1] == (_plural(kind),) and len(path) == 2}
        return UNNAMED in lost or near(name, lost) is not None

    def is_partly_dropped(self, path: DocumentPath, keys: Iterable[str]) -> bool:
        """Whether one of these keys of what is at a path could not be read."""
        return any((*path, key) in self.dropped for key in keys)

    def is_lost(self, key: str) -> bool:
        """Whether all that stands under a key of the edition could not be read."""
        return (key,) in self.dropped

    def text(self, path: DocumentPath, written: schema.Text | None) -> Text:
        """A text in every language; a plain one stands for the only language."""
        if written is None:
            return dict.fromkeys(self.languages, "")
        if isinstance(written, str):
            if len(self.languages) > 1:
                wanted = ", ".join(f"{language}: …" for language in self.languages)
                self._tell(path, "missing-language", "this text is in one language only", f"write {{{wanted}}}")
            return dict.fromkeys(self.languages, written)
        for language in self.languages:
            if language not in written:
                hint = f"add {language}: …, or take `{language}` out of `languages`"
                self._tell(path, "missing-language", f"this text has no `{language}`", hint)
        for language in written.keys() - {*self.languages, *self._unnamed}:
            self._unnamed.add(language)
            if not self.is_lost("languages"):
                hint = f"languages: [{', '.join((*self.languages, language))}]"
                self._tell((*path, language), "missing-language", f"the edition does not name `{language}`", hint, True)
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

_DEFINED = {
    "type": "types",
    "layout": "layouts",
    "table": "tables",
    "parameter": "parameters",
    "setting": "settings",
    "effect": "effects",
    "mode": "bus.modes",
}
"""Where what there can be of a kind is defined."""


def _defined(kind: str, number: int) -> str:
    """What to do where none of a kind is alike: where the others stand."""
    there = f"stand under `{_DEFINED.get(kind, '')}`"
    if kind not in _DEFINED:
        return ""
    return (
        f"none of the {number} that {there} is like it; define it there" if number else f"none is defined; they {there}"
    )


def _plural(kind: str) -> str:
    return f"{kind}es" if kind.endswith("s") else f"{kind}s"
