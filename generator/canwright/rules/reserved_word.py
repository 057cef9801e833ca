"""A word that means something in the language is not used as a name where it would be taken for that."""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from ..language.edition import MessageSpec, keys
from .rule import Finding, Found, Subject

LAYOUTS = {"none": "no frame", "echo": "the request that comes back", "entry": "the layout of a table's entry"}
VALUES = {"by": "the parameter that decides", "none": "nothing that is known"}
FIELDS = {"node": "the node of a frame", **dict.fromkeys(keys(MessageSpec), "a key of a message")}


def check(subject: Subject) -> Found:
    for name in subject.spec.layouts:
        yield from _if_reserved(("layouts", name), name, LAYOUTS)
    for name, parameter in subject.spec.parameters.items():
        for value in parameter.values if isinstance(parameter.values, dict) else ():
            yield from _if_reserved(("parameters", name, "values", value), value, VALUES)
    fields = {field.path: field.name for message in subject.edition.all_messages() for field in message.layout.fields}
    for path, name in fields.items():
        yield from _if_reserved(path, name, FIELDS)


def _if_reserved(path: DocumentPath, name: str, words: dict[str, str]) -> Found:
    if name in words:
        yield Finding(path, f"`{name}` means {words[name]} here", "choose another name", key=True)
