"""Reference of the language, generated from its JSON Schema: every concept with its keys, values and examples."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ..templating.environment import environment
from . import aliases
from .edition import EditionSpec, schema_text
from .golden_frames import GoldenFramesSpec

JsonSchema = Mapping[str, Any]

NAME_PATTERN = "^[a-z][a-z0-9_]*$"
IN_ALL = frozenset(("title", "about"))
"""Keys of nearly every concept, described once."""


class KeyReference(NamedTuple):
    """One key of a concept. `takes` describes its value."""

    name: str
    about: str
    takes: str
    example: str
    default: str
    required: bool


class ConceptReference(NamedTuple):
    """One concept of the language."""

    name: str
    about: str
    keys: tuple[KeyReference, ...]


@functools.cache
def concepts() -> tuple[ConceptReference, ...]:
    """Every concept of specs and golden frames, each after a concept that contains it."""
    result: dict[str, ConceptReference] = {}
    for root in (EditionSpec, GoldenFramesSpec):
        whole = json.loads(schema_text(root))
        for name, schema in _reached(root.__name__, whole):
            if "properties" in schema:
                keys = tuple(_keys(schema, whole["$defs"]))
                result.setdefault(
                    _spoken(name), ConceptReference(_spoken(name), schema["description"].split("\n")[0], keys)
                )
    return tuple(result.values())


def explained(word: str) -> Iterator[str]:
    """The description of a key or a concept, in lines; empty for other words."""
    every = concepts()
    for concept in every:
        if word in (concept.name, concept.name.replace(" ", "_")):
            yield f"{concept.name}: {concept.about}"
            yield from (f"  {line}" for key in concept.keys for line in _lines(key.name, key))
    own = [(concept, key) for concept in every for key in concept.keys if key.name == word]
    shown: set[KeyReference] = set()
    for _, key in own:
        if key not in shown:
            shown.add(key)
            names = ", ".join(f"`{other.name}`" for other, same in own if same == key)
            yield from _lines(f"{word} of {names}", key)


def words() -> list[str]:
    """All keys and concepts."""
    return sorted({word for concept in concepts() for word in (concept.name, *(key.name for key in concept.keys))})


def page(limits: Mapping[str, int]) -> str:
    """The guide to writing a spec and the reference of every key, in Markdown; `limits` are those of a spec, by name."""
    every = concepts()
    names = {concept.name for concept in every}

    def linked(text: str) -> str:
        return re.sub(r"`([a-z ]+)`", lambda m: f"[{m[1]}](#{m[1].replace(' ', '-')})" if m[1] in names else m[0], text)

    template = environment("language", {"row": _row, "linked": linked}).get_template("page.md.j2")
    return template.render(concepts=every, in_all=IN_ALL, limits={name: f"{limit:,}" for name, limit in limits.items()})


def _lines(head: str, key: KeyReference) -> Iterator[str]:
    yield f"{head}: {key.about}"
    example = f"; example: {key.example}" if key.example else ""
    presence = "required" if key.required else f"default: {key.default}" if key.default else "optional"
    yield f"    {key.takes}{example}; {presence}"


def _row(text: str) -> str:
    """A text as a cell of a Markdown table."""
    return re.sub(r"([|<>*\\])", r"\\\1", text)


def _reached(name: str, whole: JsonSchema) -> Iterator[tuple[str, JsonSchema]]:
    """The concepts below a root concept, in breadth-first order of their keys."""
    waiting: list[tuple[str, JsonSchema]] = [(name, whole)]
    seen = {name}
    while waiting:
        name, schema = waiting.pop(0)
        yield name, schema
        for reference in _references(schema.get("properties", {})):
            if reference not in seen:
                seen.add(reference)
                waiting.append((reference, whole["$defs"][reference]))


def _references(schema: Any) -> Iterator[str]:
    if isinstance(schema, dict):
        if "$ref" in schema:
            yield schema["$ref"].rpartition("/")[2]
        schema = list(schema.values())
    for part in schema if isinstance(schema, list) else ():
        yield from _references(part)


def _keys(schema: JsonSchema, known: JsonSchema) -> Iterator[KeyReference]:
    for name, of in schema["properties"].items():
        examples = next(_examples(of), ())
        example = next((one for one in examples if isinstance(one, dict)), None)
        shown = aliases.flow(example) if isinstance(example, dict) else ", ".join(map(aliases.flow, examples))
        default = of.get("default")
        yield KeyReference(
            name,
            of["description"],
            _takes(of, known),
            shown,
            "" if default is None or isinstance(default, dict) or default == [] else aliases.flow(default).lower(),
            name in schema.get("required", ()),
        )


def _examples(schema: JsonSchema) -> Iterator[Sequence[Any]]:
    """The examples of a key, or of its forms."""
    if "examples" in schema:
        yield schema["examples"]
    for choice in (*schema.get("oneOf", ()), *schema.get("anyOf", ())):
        yield from _examples(choice)


def _takes(schema: JsonSchema, known: JsonSchema) -> str:
    """A description of the value of a key."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return _takes(known[name], known) if "enum" in known[name] else f"`{_spoken(name)}`"
    choices: Sequence[JsonSchema] = schema.get("oneOf") or schema.get("anyOf") or ()
    if choices:
        return " or ".join(dict.fromkeys(_takes(choice, known) for choice in choices))
    if "enum" in schema:
        return " or ".join(f"`{value}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    if schema.get("type") == "array":
        return f"list of {_takes(schema['items'], known)}" if schema.get("items") else "list"
    if schema.get("type") == "object":
        named = [*schema.get("patternProperties", {}).values(), schema.get("additionalProperties")]
        inside = next((part for part in named if isinstance(part, dict)), None)
        of_languages = "enum" in schema.get("propertyNames", {})
        return "text" if of_languages else f"names, each with {_takes(inside, known)}" if inside else "mapping"
    if schema.get("type") == "string":
        return "name" if schema.get("pattern") == NAME_PATTERN else "text"
    return {"integer": "whole number", "number": "number", "boolean": "`true` or `false`"}[schema["type"]]


def _spoken(name: str) -> str:
    """The name of a concept in texts: `field` for FieldSpec."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.removesuffix("Spec")).lower()
