"""Output of the commands: the only module that writes to the terminal, safely for untrusted text and any encoding."""

from __future__ import annotations

import contextlib
import functools
import json
import os
import re
import sys
from collections.abc import Callable, Iterator
from typing import TextIO

import click

from ..diagnostics.unicode_safety import unseen

_STYLE = re.compile(r"\x1b\[[0-9;]*m")
_WORKFLOW_COMMAND = re.compile(r"^[^\S\n]*(?=::)|##(?=\[|vso\[|teamcity\[)", re.MULTILINE)
"""Before what a CI system would execute: `::error` at the start of a line, `##[error]` anywhere in it."""
_PLAIN = {"→": "->", "“": '"', "”": '"', "‘": "'", "’": "'", "…": "...", "–": "-", "—": "-"}
"""Typographic characters, and what replaces them where the encoding lacks them."""


def print_text(text: str, *, error: bool = False, styled: bool = False) -> None:
    """Writes a text for people, on standard error with `error`.

    Invisible characters are escaped, and so is what a CI system would execute. Only a `styled` text keeps its colours,
    and only on a terminal.
    """
    stream = sys.stderr if error else sys.stdout
    if styled and not stream.isatty():
        text, styled = click.unstyle(text), False
    _echo(_safe(text, styled=styled).translate(_replacements(stream.encoding or "utf-8")), stream)


def print_data(text: str) -> None:
    """Writes a text for programs, which is escaped for its format, on standard output."""
    _echo(text, sys.stdout)


def print_json(data: object) -> None:
    """Writes a value as JSON."""
    print_data(json_text(data) + "\n")


def json_text(data: object) -> str:
    """A value as JSON; texts of it are not executed by a CI system."""
    return json.dumps(data, indent=2, ensure_ascii=False).replace("##", "#\\u0023")


def bold(text: str, colour: str | None = None) -> str:
    """A bold text, in a colour, unless the user wants none (`NO_COLOR`)."""
    return text if os.environ.get("NO_COLOR") else click.style(text, fg=colour, bold=True)


@contextlib.contextmanager
def progress(noun: str, *, shown: bool) -> Iterator[Callable[[int], object]]:
    """Shows a count on standard error, if it is a terminal, until the end; the function adds to it."""
    if not (shown and sys.stderr.isatty()):
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.completed:,.0f} {task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(noun, total=None)
        yield lambda count: bar.advance(task, count)


def _echo(text: str, stream: TextIO) -> None:
    click.echo(text, file=stream, nl=False)


def _safe(text: str, *, styled: bool) -> str:
    escapes = {ord(c): f"[U+{ord(c):04X}]" for c in unseen(_STYLE.sub("", text) if styled else text)}
    text = text.translate(escapes) if escapes else text
    return _WORKFLOW_COMMAND.sub(lambda match: match.group() + "\\", text)


@functools.cache
def _replacements(encoding: str) -> dict[int, str]:
    return {ord(c): plain for c, plain in _PLAIN.items() if c.encode(encoding, "ignore") == b""}
