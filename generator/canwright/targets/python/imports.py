"""The imports of a generated module, collected while its views and templates name them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

PUBLIC = ("CodecError", "FieldAbsent", "Message", "Refusal", "Reply", "Request")
"""What a program needs besides the classes of an edition; every module exports it."""

_RUNTIME = {
    "_codec": (
        *PUBLIC,
        *("ArrayType", "Bound", "EnumType", "FlagsType", "Float", "Integer", "NodeParameters", "Number", "Real"),
        *("ToAll", "ToNode", "check_choice", "check_number", "constant", "merge", "missing", "new"),
    ),
    "_dispatch": ("Answer", "DataByte", "Dispatcher", "Route", "Select", "data_length"),
}
_STANDARD_LIBRARY = {
    "collections.abc": ("Iterable",),
    "dataclasses": ("dataclass",),
    "enum": ("Enum", "IntEnum", "IntFlag"),
    "fractions": ("Fraction",),
    "struct": ("Struct",),
    "typing": ("TYPE_CHECKING", "Any", "Literal", "NoReturn", "TypeAlias", "Union"),
}
_TYPE_CHECKING = {"typing_extensions": ("Self",)}

NAMES = frozenset(
    name for group in (_RUNTIME, _STANDARD_LIBRARY, _TYPE_CHECKING) for names in group.values() for name in names
)
"""Every name that a generated module may import."""

Modules = Iterator[tuple[str, list[str]]]
"""Modules with the names to import from each, sorted; constants first."""


class Imports:
    """The names that one module uses."""

    def __init__(self) -> None:
        self._used = set(PUBLIC)

    def use(self, name: str) -> str:
        """The name itself, which the module now imports. Raises KeyError for a name that is in no list above."""
        if name not in NAMES:
            raise KeyError(name)
        self._used.add(name)
        if name in _TYPE_CHECKING["typing_extensions"]:
            self._used.add("TYPE_CHECKING")
        return name

    def runtime(self) -> Modules:
        """The imports from the runtime, by module."""
        return self._of(_RUNTIME.items())

    def standard_library(self) -> Modules:
        """The imports from the standard library, by module."""
        return self._of(_STANDARD_LIBRARY.items())

    def type_checking(self) -> list[tuple[str, list[str]]]:
        """The imports that only a type checker needs, by module."""
        return list(self._of(_TYPE_CHECKING.items()))

    def _of(self, modules: Iterable[tuple[str, tuple[str, ...]]]) -> Modules:
        for module, names in modules:
            used = sorted(self._used.intersection(names), key=lambda name: (not name.isupper(), name))
            if used:
                yield module, used
