"""Positions of a change in the documents of both editions: the lines that were edited."""

from __future__ import annotations

from collections.abc import Collection

from ..diagnostics.diagnostic import DocumentPath, Position
from ..document.builder import Data
from ..document.document import Document
from .change import Change

_MISSING = object()
_OTHER_KEYS = {
    "raw_range": ("range",),
    "id": ("request", "extended"),
    "request": ("id", "extended"),
    "reply": ("id", "extended"),
    "reply_selector": ("selector",),
}
"""Keys that can be written instead of the key of a change."""


def positions(change: Change, old: Document, new: Document) -> tuple[Position, Position]:
    """The positions of a change: of its item or key, or of what differs inside, if that is a single key or everything."""
    before, after = change.old or (), change.new or ()
    item = max(before, after, key=len)
    is_named = bool(item) and isinstance(item[-1], str)  # a number is that of another item in the other edition
    is_inside = len(before) != len(after)
    if (
        is_named
        and is_inside
        and item in old
        and item in new
        and item[: min(len(before), len(after))] in (before, after)
    ):
        before = after = item  # written in both, but without effect in one
    cases = {str(value) for case in change.cases for value in case.values()}
    before, after = _edited(old, new, before, after, cases)
    return old.position(before, key=True), new.position(after, key=True)


def _edited(
    old: Document, new: Document, before: DocumentPath, after: DocumentPath, cases: Collection[str]
) -> tuple[DocumentPath, DocumentPath]:
    """The paths of what differs at or below two paths, as far as it is a single key, or the key of one of the `cases`.

    They lead into one of the documents; to the first keys where nothing is the same.
    """
    wanted = before[-1:] if before not in old and after not in new else ()
    before, after = _known(old, before), _known(new, after)
    old_value, new_value = _value(old, before), _value(new, after)
    while before[-1:] == after[-1:]:
        keys = _keys(old_value, new_value)
        differing = [key for key in keys if _item(old_value, key) != _item(new_value, key)]
        other_keys = _OTHER_KEYS.get(str(wanted[0]), ()) if wanted else ()
        differing = [key for key in differing if key in other_keys or str(key) in cases][:1] or differing
        if len(differing) > 1 and differing == keys and not wanted:
            return (*before, *_keys(old_value, old_value)[:1]), (*after, *_keys(new_value, new_value)[:1])
        if len(differing) != 1:
            break
        key = differing[0]
        before, after, wanted = (*before, key), (*after, key), ()
        old_value, new_value = _item(old_value, key), _item(new_value, key)
    return before, after


def _known(document: Document, path: DocumentPath) -> DocumentPath:
    while path and path not in document:
        path = path[:-1]
    return path


def _keys(first: object, second: object) -> list[str | int]:
    if isinstance(first, dict) and isinstance(second, dict):
        return list({**first, **second})
    if isinstance(first, list) and isinstance(second, list):
        return list(range(max(len(first), len(second))))
    return []


def _item(data: object, key: str | int) -> object:
    if isinstance(data, dict):
        return data.get(key, _MISSING)
    if isinstance(data, list) and isinstance(key, int) and key < len(data):
        return data[key]
    return _MISSING


def _value(document: Document, path: DocumentPath) -> object:
    data: Data | object = document.data
    for key in path:
        data = _item(data, key)
    return data
