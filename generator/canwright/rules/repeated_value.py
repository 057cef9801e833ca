"""A list of names or codes has no duplicates."""

from __future__ import annotations

from collections.abc import Iterator

from ..diagnostics.diagnostic import DocumentPath
from ..language.concept import parts
from ..language.edition import EditionSpec
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    for path, values in _lists(subject.spec):
        first: dict[object, int] = {}
        for i, value in enumerate(values):
            if value in first:
                related = RelatedItem((*path, first[value]), "the first one")
                yield Finding((*path, i), f"duplicate value {value}", "remove one", related=(related,))
            first.setdefault(value, i)
    for name, command in subject.spec.commands.items():
        limited_by = {*command.limited_by}
        for i, setting in enumerate(command.not_limited_by):
            if setting in limited_by:
                at: DocumentPath = ("commands", name, "not_limited_by", i)
                earlier: DocumentPath = ("commands", name, "limited_by", command.limited_by.index(setting))
                text = f"`{setting}` is also in `limited_by`"
                yield Finding(at, text, "remove one of them", related=(RelatedItem(earlier, "the other one"),))
    for message in subject.edition.all_messages():
        for i, code in enumerate(message.accepted_codes):
            if message.keys and code == message.keys[0].value:
                text = f"0x{code:02X} is already the code of this message"
                yield Finding((*message.path, "accept", i), text, "remove it; `accept` is for additional codes")


def _lists(spec: EditionSpec) -> Iterator[tuple[DocumentPath, list[object]]]:
    """The lists of names or numbers, except for the index of an entry and the values of parameters."""
    for path, part in parts(spec):
        if isinstance(part, list) and path[0] != "parameters" and (path[0], *path[4:]) != ("tables", "index"):
            yield path, [item for item in part if isinstance(item, str | int)]
