"""Shared by the rules about golden frames: checks of ids and parameters, and frames as text."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TypeVar

from ..diagnostics.diagnostic import DocumentPath, nearest
from ..language.notation import LAST_ID, SHORT_ID
from ..model import formatting
from ..model.edition import Edition
from ..model.golden_frames import CheckedFrame, Exchange, Sourced
from ..model.layout import Field
from ..model.message import Message
from ..model.types import Parameter
from ..resolve.number_parameters import number
from ..semantics.decoder import Decoded, Value
from ..semantics.frame import Raw
from .rule import Finding, Findings, RelatedItem

EntryProblem = tuple[DocumentPath, str, str] | tuple[DocumentPath, str, str, RelatedItem]
"""The path within an entry, what is wrong, what to do about it, and the item of the spec that it contradicts."""

KEY = "[key]"
"""At the end of a path: the problem concerns the key, not its value."""

E = TypeVar("E", bound=Sourced)


def entry_findings(
    edition: Edition, key: str, entries: Sequence[E], problems_of: Callable[[E], Iterable[EntryProblem]]
) -> Findings:
    """Findings about the entries of a list: their ids and parameters; if these are valid, those of `problems_of`."""
    known = {parameter.name: parameter for parameter in edition.parameters}
    for i, entry in enumerate(entries):
        problems = [*_ids(entry), *_parameters(edition, known, entry.parameters)]
        for problem in problems or problems_of(entry):
            path, text, hint = problem[:3]
            at_key = path[-1:] == (KEY,)
            place = (key, i, *(path[:-1] if at_key else path))
            yield Finding(place, text, hint, key=at_key, in_frames=True, related=problem[3:])


def _ids(entry: Sourced) -> Iterator[EntryProblem]:
    """Ids that exceed the maximum of their format."""
    frames: dict[DocumentPath, CheckedFrame] = {(): entry} if isinstance(entry, CheckedFrame) else {}
    if isinstance(entry, Exchange):
        frames = {("request",): entry.request, ("reply",): entry.reply}
    for path, frame in frames.items():
        last = LAST_ID if frame.extended else SHORT_ID
        if frame.id > last:
            hint = "extended: true" if frame.id <= LAST_ID else "check the id"
            yield (*path, "id"), f"0x{frame.id:X} exceeds the maximum CAN id 0x{last:X}", hint


def _parameters(
    edition: Edition, known: Mapping[str, Parameter], given: Mapping[str, int | str | Fraction]
) -> Iterator[EntryProblem]:
    for name, value in given.items():
        path: DocumentPath = ("parameters", name)
        if name not in known:
            yield (*path, KEY), f"there is no parameter `{name}`", nearest(name, known) or "remove it"
        elif known[name].is_choice and str(value) not in (names := [v.name for v in known[name].values]):
            yield path, f"`{name}` has no value `{value}`", nearest(str(value), names) or "check `parameters`"
        elif not known[name].is_choice:
            try:
                number(edition, known[name], str(value))
            except ValueError as error:
                yield path, str(error), f"write the number of the source, as {name}: 12.5"


def described(decoded: Decoded) -> str:
    """A frame as text: `the request of dim, node 1: level 10 %`."""
    fields = [
        f"{field.name} {_shown(field, decoded.raws[field.name], decoded.values[field.name])}"
        for field in decoded.variant.fields
        if field.is_given
    ]
    return named(decoded.message, decoded.node) + (f": {', '.join(fields)}" if fields else "")


def named(message: Message, node: int | None) -> str:
    """A message as text: `the request of dim, node 1`."""
    return f"the {message.direction.value} of {message.command}" + (f", node {node}" if node is not None else "")


def _shown(field: Field, raw: Raw, value: Value | list[Value]) -> str:
    if isinstance(raw, list) and isinstance(value, list):
        return f"[{', '.join(_shown(field, *pair) for pair in zip(raw, value, strict=True))}]"
    if isinstance(value, Fraction):
        return formatting.exact(value) + (f" {field.type.unit.symbol}" if field.type.unit else "")
    return f"raw {raw}" if value is None else value if isinstance(value, str) else f"[{', '.join(map(str, value))}]"


def unknown_name(field: Field, value: object, reserved: Sequence[str]) -> tuple[str, str] | None:
    """Text and hint for a value that is no name of a field, nor a reserved word; None without one."""
    names = [member.name for member in field.type.members]
    for part in value if isinstance(value, list) else (value,):
        if isinstance(part, str) and part not in names and part not in reserved:
            text = f"`{field.name}` has no value `{part}`" if names else f"`{field.name}` is a number"
            return text, nearest(part, names) or "check the type in the spec"
    return None
