"""What C programs write to use an edition."""

from __future__ import annotations

from ...model.edition import Edition
from ..base import CodeNames, ItemNames
from .names import Names, member
from .view import edition_view


def code_names(edition: Edition) -> CodeNames:
    """Raw integers stand for the members of types."""
    names, messages = Names(edition), edition.all_messages()
    frames = [frame for command in edition_view(edition).commands for frame in command.frames]
    needs_parameters = {frame.name for frame in frames if frame.takes_parameters}
    return CodeNames(
        language="c",
        source=f"{edition.family}/{edition.identifier}.h",
        parameters_type=names.lower("parameters_t"),
        messages={message: names.lower(message.name) for message in messages},
        needs_parameters=frozenset(m for m in messages if names.lower(m.name) in needs_parameters),
        fields={field.name: member(field.name) for m in messages for field in m.layout.fields},
        parameters={
            p: ItemNames(member(p.name), "", {v.name: names.upper(p.name, v.name) for v in p.values})
            for p in edition.parameters
        },
        types={},
    )
