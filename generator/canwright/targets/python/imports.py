"""The imports of a generated module, collected while its views and templates name them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

PUBLIC = ("CodecError", "FieldAbsent", "Message", "Refusal", "Reply", "Request")
"""What a program needs besides the classes of an edition; every module exports it."""

_RUNTIME = {
    "_codec": (
        *PUBLIC,
        *("ArrayType", "Bound", "ClientFacts", "Counter", "DigitsType", "EnumType", "FlagsType", "Float", "Integer"),
        *("NodeParameters", "Number", "Real"),
        *("OptionalFloat", "OptionalInteger", "OptionalNumber", "TextType"),
        *("ToAll", "ToNode", "check_choice", "check_number", "checksum", "constant", "crc_of", "join"),
        *("merge", "missing", "new", "sum_of", "whole", "wrong_message", "xor_of"),
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

_GROUPS: dict[str, Mapping[str, tuple[str, ...]]] = {
    "runtime": _RUNTIME,
    "standard library": _STANDARD_LIBRARY,
    "type checking": _TYPE_CHECKING,
}

NAMES = frozenset(name for group in _GROUPS.values() for names in group.values() for name in names)
"""Every name that a generated module may import."""


class Imports:
    """The names that one module uses."""

    def __init__(self) -> None:
        self._used = set(PUBLIC)

    def use(self, name: str) -> str:
        """The name itself, which the module now imports. Raises KeyError for a name that is in no list above."""
        if name not in NAMES:
            raise KeyError(f"{name} is in no list of {__name__}")
        self._used.add(name)
        if name in _TYPE_CHECKING["typing_extensions"]:
            self._used.add("TYPE_CHECKING")
        return name

    def modules(self, group: str) -> Iterator[tuple[str, list[str]]]:
        """The modules of a group with the used names of each, sorted; constants first."""
        for module, names in _GROUPS[group].items():
            used = sorted(self._used.intersection(names), key=lambda name: (not name.isupper(), name))
            if used:
                yield module, used
