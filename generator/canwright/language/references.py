"""References of a file, each of which needs a definition."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from ..diagnostics.diagnostic import MAX_FINDINGS, Diagnostic, SpecError, nearest, with_number_of_others
from ..document.document import Document
from . import aliases, suggestions
from .findings import Names, Reference
from .units import read_units

MAX_USES = 3
"""The number of references to an unknown name above which only the first is listed."""

_SECTIONS: Mapping[str, str] = {
    **{kind: f"{kind}s" for kind in ("type", "layout", "table", "parameter", "setting", "effect")},
    "mode": "bus.modes",
    "neighbour": "bus.neighbours",
}
"""Where a kind is defined, if a new definition of it may be what is missing."""


def check_references(document: Document, names: Names) -> None:
    """Raises SpecError with a finding for each name that has no definition."""
    known = _Definitions(document, names)
    uses: dict[tuple[str, str, str], list[Reference]] = {}
    for reference in names.references:
        if not known.contains(reference):
            uses.setdefault((reference.kind, reference.owner, reference.name), []).append(reference)
    listed = [(use, len(same)) for same in uses.values() for use in (same if len(same) <= MAX_USES else same[:1])]
    findings = [known.finding(use, number) for use, number in listed[:MAX_FINDINGS]]
    if findings:
        raise SpecError(with_number_of_others(findings, max(0, len(listed) - MAX_FINDINGS)))


class _Definitions:
    """The definitions of a file, and the units."""

    def __init__(self, document: Document, names: Names) -> None:
        self._document = document
        _, self._units = read_units()
        self._names: dict[tuple[str, str], dict[str, None]] = {("unit", ""): dict.fromkeys(self._units)}
        for definition in names.definitions:
            self._names.setdefault((definition.kind, definition.owner), {})[definition.name] = None

    def contains(self, reference: Reference) -> bool:
        """Whether a name is defined. The parts of a definition that has none, or does not exist, are not checked."""
        if reference.kind == "path":
            return self._document.contains(reference.name)
        return reference.name in self._of(reference) or bool(reference.owner and not self._of(reference))

    def _of(self, reference: Reference) -> Collection[str]:
        return self._names.get((reference.kind, reference.owner), {})

    def finding(self, reference: Reference, uses: int) -> Diagnostic:
        kind = f"{reference.kind} of `{reference.owner}`:" if reference.owner else reference.kind
        text = f"there is no {kind} `{reference.name}`"
        if reference.kind == "path":
            text = f"`{reference.name}` is not a path of this file"
        if uses > MAX_USES:
            text += f", to which {uses} items refer"
        return self._document.finding(
            reference.path, "unknown-reference", text, self._hint(reference), key=reference.key
        )

    def _hint(self, reference: Reference) -> str:
        """What to write instead of an unknown name."""
        name, known = reference.name, self._of(reference)
        if reference.kind == "path":
            return suggestions.place(name, self._document.data)
        if reference.kind == "unit":
            return suggestions.unit(name, self._units)
        if reference.kind == "layout":
            words: Sequence[str] = (*known, *reference.words)
            return suggestions.layout(name, words, self._kind("command"), self._kind("type"))
        if reference.kind == "type" and (raw := aliases.raw_format(name)):
            return f"write `raw: {raw}`"
        if reference.kind == "source":
            return nearest(name, known) or f"define it under `sources`: {{{name}: …}}"
        if reference.path[-1] == "constant":
            hint = nearest(name, known)
            return "write a whole number, for example 16, or a number parameter" + (f"; {hint}" if hint else "")
        if reference.path[-1] == "of" and name in self._kind("layout"):
            return f"`{name}` is a layout: write reply: {name}"
        return self._other_kind(name) or nearest(name, known) or self._defined(reference.kind, len(known))

    def _kind(self, kind: str) -> Collection[str]:
        return self._names.get((kind, ""), {})

    def _other_kind(self, name: str) -> str:
        """A hint for a name of a definition of another kind."""
        kinds = (kind for (kind, owner), names in self._names.items() if kind != "unit" and not owner and name in names)
        return next((f"`{name}` is {'an' if kind[0] in 'aeiou' else 'a'} {kind}" for kind in kinds), "")

    def _defined(self, kind: str, number: int) -> str:
        """A hint for an unknown name without a similar one."""
        if kind not in _SECTIONS:
            return ""
        return f"define it under `{_SECTIONS[kind]}`" + (
            f"; none of the {number} names there is similar" if number else ""
        )
