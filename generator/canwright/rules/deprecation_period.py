"""The end of a deprecation is not before its start, and its dates exist."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..diagnostics.diagnostic import DocumentPath
from ..language.suggestions import DATE, is_day
from ..model.deprecation import Deprecation, is_before, is_date
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for path, deprecation in _deprecations(subject):
        for key, name in (("since", deprecation.since), ("until", deprecation.until)):
            if name is not None and is_date(name) and not _exists(name):
                yield Finding(
                    (*path, key), f"`{name}` is not a date", "write a month or a day, as 2027-03 or 2027-03-21"
                )
                break
        else:
            since, until = deprecation.since, deprecation.until
            if until is not None and is_before(until, since):
                text = f"`until` {until} is before `since` {since}"
                yield Finding((*path, "until"), text, "write the first edition, or its date, that may lack the item")


def _deprecations(subject: CheckInput) -> Iterator[tuple[DocumentPath, Deprecation]]:
    edition, by_path = subject.edition, dict[DocumentPath, Deprecation | None]()
    by_path |= {command.path: command.deprecated for command in edition.commands}
    for message in edition.all_messages():
        by_path |= {field.path: field.deprecated for field in message.layout.fields}
    for type_ in edition.types:
        by_path |= {(*type_.path, "enum", member.name): member.deprecated for member in type_.enum}
        by_path |= {(*type_.path, "flags", flag.name): flag.deprecated for flag in type_.flags}
        by_path |= {(*type_.path, "no_value", named.name): named.deprecated for named in type_.no_values}
        by_path |= {(*type_.path, "names", named.name): named.deprecated for named in type_.names}
    return (((*path, "deprecated"), deprecation) for path, deprecation in by_path.items() if deprecation is not None)


def _exists(date: str) -> bool:
    return re.fullmatch(DATE, date) is not None and is_day(date)
