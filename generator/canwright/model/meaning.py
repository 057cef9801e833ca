"""The hash of a meaning: of everything that decides frames, values, names and refusals, whatever the text of the spec is."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from enum import Enum
from fractions import Fraction

NOT_MEANING = frozenset(
    (
        # texts, and what they are about
        *(
            "title",
            "about",
            "notes",
            "differs",
            "manual",
            "manual_name",
            "printed",
            "errata",
            "languages",
            "neighbours",
        ),
        # history, and positions in the document
        *("date", "deprecated", "renamed_from", "previous_name", "path"),
    )
)
"""The attributes of the model that are left out. Any other one counts, so that a new attribute is not forgotten."""

_UNORDERED = frozenset(
    (
        *("parameters", "settings", "effects", "states", "addresses", "types", "layouts", "tables", "commands"),
        *("modes", "values", "fields", "variants", "keys", "enum", "flags", "names"),
    )
)
"""The attributes that are in the order of the spec, which changes no frame."""

_SCALARS = frozenset((type(None), bool, int, Fraction, str, bytes, range))


def meaning_hash(item: object) -> str:
    """The SHA-256 of the meaning of a part of the model, in hex: of its canonical form, with exact numbers."""
    return _Canonical().digest(item)


class _Canonical:
    """The canonical form of values; a part of the model stands in it by its hash, which is computed once."""

    def __init__(self) -> None:
        self._digests: dict[int, str] = {}

    def digest(self, item: object) -> str:
        known = self._digests.get(id(item))
        if known is None:
            lines = sorted(f"{name}={self._attribute(name, value)}" for name, value in _attributes(item))
            written = "\n".join((type(item).__name__, *lines))
            known = self._digests[id(item)] = hashlib.sha256(written.encode("ascii")).hexdigest()
        return known

    def _attribute(self, name: str, value: object) -> str:
        if name in _UNORDERED and isinstance(value, tuple):
            return str(sorted(map(self._text, value)))
        return self._text(value)

    def _text(self, value: object) -> str:
        if type(value) in _SCALARS:
            return ascii(value)
        if dataclasses.is_dataclass(value):
            return self.digest(value)
        if isinstance(value, Enum):
            return ascii(value.value)
        if isinstance(value, Mapping):
            return str(sorted((ascii(key), self._text(content)) for key, content in value.items()))
        if isinstance(value, tuple):
            return str([*map(self._text, value)])
        raise TypeError(f"no canonical form of {type(value).__name__}")


def _attributes(item: object) -> list[tuple[str, object]]:
    """What an item means, by name; without None and empty tuples, so that a new optional key of specs changes no hash."""
    names = (field.name for field in dataclasses.fields(item) if field.name not in NOT_MEANING)  # type: ignore[arg-type]
    values = ((name, getattr(item, name)) for name in names)
    return [(name, value) for name, value in values if value is not None and value != ()]
