"""The names of commands, layouts and errata are unique.

So are those that tables generate.
"""

from __future__ import annotations

from ..diagnostics.diagnostic import DocumentPath
from .rule import CheckInput, Finding, Findings, RelatedItem


def check(subject: CheckInput) -> Findings:
    edition = subject.edition
    commands = [(c.name, c.path) for c in edition.commands]
    layouts = [(layout.name, layout.path) for layout in edition.layouts]
    errata = [(erratum.id, ("errata", i, "id")) for i, erratum in enumerate(edition.errata)]
    for what, named in (("command", commands), ("layout", layouts), ("erratum", errata)):
        first: dict[str, DocumentPath] = {}
        for name, path in named:
            if name in first:
                is_key = what != "erratum"
                text = f"the {what} `{name}` is already defined at {'.'.join(map(str, first[name]))}"
                related = RelatedItem(first[name], f"the other {what}", key=is_key)
                yield Finding(path, text, "rename one of them", key=is_key, related=(related,))
            first.setdefault(name, path)
    for message in edition.all_messages():
        seen: dict[str, DocumentPath] = {}
        for field in message.layout.fields:
            if field.name in seen:
                text = f"the layout of this message already has a field `{field.name}`"
                related = RelatedItem(field.path, "the other field", key=True)
                yield Finding(seen[field.name], text, "rename one of them", key=True, related=(related,))
            seen.setdefault(field.name, field.path)
