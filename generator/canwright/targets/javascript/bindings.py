"""The names of messages in other languages, for the programs that the frame explorer shows."""

from __future__ import annotations

from collections.abc import Mapping

from ...model.edition import Edition
from ..base import CodeNames, ItemNames
from ..nested_source import Value
from ..registry import own_targets
from ..tables import Positions


def bindings(edition: Edition) -> Mapping[str, Value]:
    """The names by language, each by the name in the spec; a field is listed where its name differs."""
    every = filter(None, (target.code_names(edition) for target in own_targets()))
    return {names.language: _names(edition, names) for names in every}


def _names(edition: Edition, names: CodeNames) -> Value:
    numbers = Positions(edition).types
    messages: dict[str, Value] = {}
    for message, name in names.messages.items():
        needs_parameters = message in names.needs_parameters
        messages[f"{message.direction.value} {message.command}"] = {"name": name, "needsParameters": needs_parameters}
    return {
        "source": names.source,
        "parametersType": names.parameters_type,
        "messages": messages,
        "fields": {name: names.fields[name] for name in sorted(names.fields) if names.fields[name] != name},
        "parameters": {parameter.name: _item(item) for parameter, item in names.parameters.items()},
        "types": {str(number): _item(names.types[t]) for t, number in numbers.items() if t in names.types} or None,
    }


def _item(item: ItemNames) -> Value:
    return {"name": item.name, "type": item.type or None, "members": item.members or None}
