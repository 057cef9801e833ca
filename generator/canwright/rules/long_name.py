"""A name is short enough for a DBC file to hold it whole."""

from __future__ import annotations

from ..targets import dbc
from .rule import Finding, Found, Subject


def check(subject: Subject) -> Found:
    for path, text, hint in dbc.long_names(subject.edition):
        yield Finding(path, text, hint, key=True)
