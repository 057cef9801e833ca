"""A spec with a text in every field that can have one; the fields are found in the JSON Schema, and none is listed."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import yaml
from canwright.language.edition import EditionSpec, json_schema
from canwright.language.golden_frames import GoldenFramesSpec
from canwright.language.suggestions import VISIBLE
from canwright.project.loader import load
from canwright.targets.base import EditionInput

Say = Callable[[], str]
Schema = dict[str, Any]

LOOKED_UP = {"unit", "where", "edition"}
"""Strings without a pattern that are no texts: they have to be found elsewhere."""

SPEC = """\
canwright: 1
family: lamp
edition: v1
date: "2023-03"
languages: [en, zh]
bus: {modes: {usual: {bit_rates_kbps: [500], default_kbps: 500}, broadcast: {bit_rates_kbps: [1000]}}, max_nodes: 4, answers: in_order}
addresses:
  lamp: {id: 0x100 + node, nodes: 1..4}
  all: {id: 0x200}
  host: {request: 0x300 + host_id, reply: (host_id << 4) + node, nodes: 1..2, extended: true}
selector: {at: 0, raw: u8}
parameters:
  size: {values: {small: {}, big: {}}}
  count: {number: {min: 1, max: 9}}
  bits: {values: [14, 15]}
  host_id: {number: {max: 9}}
settings: {limit: {only: {size: [small]}}}
effects: {glows: {level: note}, heats: {level: warning, repeat: never}, burns: {level: danger, consent: wear, kept: rom}}
states: {bright: {entered_by: [dim]}, dark: {entered_by: [turn], prevents: [glows]}}
types:
  level: {raw: u16, unit: "%", scale: {by: size, small: 0.1, big: none}, raw_range: 0..1000}
  angle: {raw: i24, unit: deg, scale: 0.01, offset: 1, range: "-90..90"}
  colour: {raw: u8, enum: {red: {value: 1, deprecated: {since: v1, until: v3}}, green: {value: 2}}}
  state: {raw: u8, flags: {hot: {bit: 0, deprecated: {since: v1}}, cold: {bit: 3}}}
  turns: {raw: u8, raw_range: 0..2*count+1}
  label: {raw: utf8_4, padding: 32}
  share: {raw: u10, unit: A, scale: 1/512*count, offset: -count, range: -1/2*count..1/2*count}
  heat: {raw: u8, unit: degC, no_value: {absent: {raw: 255, deprecated: {since: v1}}, faulty: {raw: 250..253}, hot: 254},
         names: {boiling: {value: 100, deprecated: {since: v1}}, icy: 0}}
layouts:
  status: {fields: {state: {at: 1, type: state}, level: {at: 2, type: level}, turns: {at: 4, type: turns}}}
tables:
  store:
    index: {at: 1, raw: u8}
    entries:
      gain: {index: 1, layout: {gain: {at: 4, raw: u16}}, effects: [burns]}
      state: {index: 2, layout: {state: {at: 4, type: state}}, only: {size: [big]}}
commands:
  dim:
    short_name: dm
    deprecated: {since: v1, until: 2027-03}
    code: 0x10
    request:
      level: {at: 2, type: level}
      colour: {at: 1, type: colour}
      small: {at: 4, raw: u8, deprecated: {since: v1}, only: {size: [small]}}
    reply: echo
    effects: [glows, heats, burns]
    limited_by: [limit]
    notes: []
  read: {code: 0x11, request: {fixed: {at: 1, raw: u8, constant: 3}}, reply: status, not_limited_by: [limit]}
  turn: {code: 0x12, request: {angle: {at: 1, type: angle}, share: {at: 4, type: share}}, reply: {of: read}, reply_within_ms: 1/2, implemented: false}
  store: {code: 0x13, table: store, request: entry, reply: echo, only: {size: [big]}}
  all: {code: 0x14, address: all, mode: broadcast, reply: {layout: status, address: lamp, from_each: 1..3}}
  colours: {code: 0x15, reply: {colours: {at: 1, array: 1..3, type: colour}}}
  heat: {code: 0x40, reply: {heat: {at: 1, type: heat}, cause: {at: [2..3, 4.5..4.7], raw: u19, byte_order: little}, rest: {at: 5, type: state}, step: {at: 5.5, raw: u2, byte_order: little}}}
  beat: {code: 0x16, address: all, request: none, reply: {layout: status, every_ms: 100, timeout_ms: 500, sent: [cyclic, on_change]}}
  seal: {code: 0x1C, request: {count: {at: 1, raw: u4, counter: 0..14}, crc: {at: 5, raw: u8, checksum: {poly: 7, over: 0..4}}}, reply: none}
  parts: {code: 0x28, reply: {layout: {part: {at: 1, raw: u8}, serial: {at: 2, raw: u8, array: 1..4}}, frames: {part: 1..3}}, further_replies: [rest], alternative_replies: [refused]}
  cut: {code: 0x2C, ends_motion: switch_off, repeat: same, reply: none}
  rest: {code: 0x29, request: none, reply: {rest: {at: 1, raw: u8}}}
  refused: {code: 0x2A, request: none, reply: {cause: {at: 1, raw: u8}}}
  greet: {code: 0x17, address: host, request: {host: {at: 1, raw: u8, constant: host_id}, level: {at: 2, type: level}, gain: {at: 4, entry: gain}}, reply: echo}
  tag: {code: 0x2B, reply: {label: {at: 1, type: label}}}
errata:
  - {id: wrong_level, where: [commands.dim, types.level]}
"""

FRAMES = """\
canwright: 1
family: lamp
edition: v1
sources: {manual: {}}
frames:
  - {request: turn, source: manual, id: 0x101, node: 1, data: 12 64 00 00 00 02 00 00,
     parameters: {count: 3}, raw: {angle: 100, share: 512}, values: {angle: 2, share: 0}}
refused:
  - {decode: request, source: manual, id: 0x7FF, data: "", parameters: {host_id: 1}, says: unknown_id}
  - {encode: request, command: turn, source: manual, node: 1, values: {angle: 91, share: 0}, says: out_of_range}
exchanges:
  - source: manual
    request: {id: 0x101, data: 10 01 64 00 00 00 00 00}
    reply: {id: 0x101, data: 10 01 64 00 00 00 00 00}
"""


def filled(say: Say, folder: Path, languages: tuple[str, ...] = ("en", "zh")) -> EditionInput:
    """The edition with what `say` says in every text."""
    folder.mkdir(exist_ok=True)
    for name, written, concept in (("lamp.yaml", SPEC, EditionSpec), ("lamp.frames.yaml", FRAMES, GoldenFramesSpec)):
        data = yaml.load(written, yaml.CSafeLoader)
        if concept is EditionSpec:
            data["languages"] = list(languages)
        data = _Filler(_schema(concept), say, languages).all(data)
        (folder / name).write_text(json.dumps(data, ensure_ascii=False, indent=1), "utf-8")
    return load(folder / "lamp.yaml").specification


def text_fields() -> set[str]:
    """`Concept.key` of every text that the language knows."""
    fields: set[str] = set()
    for concept in (EditionSpec, GoldenFramesSpec):
        schema = _schema(concept)
        filler = _Filler(schema, str, ())
        for name, concept_schema in {schema["title"]: schema, **schema["$defs"]}.items():
            fields |= {
                f"{name}.{key}"
                for key, inner in concept_schema.get("properties", {}).items()
                if filler.is_text(key, inner)
            }
    return fields


def filled_fields() -> set[str]:
    """`Concept.key` of every text that is filled."""
    fields: set[str] = set()
    for written, concept in ((SPEC, EditionSpec), (FRAMES, GoldenFramesSpec)):
        filler = _Filler(_schema(concept), str, ("en",))
        filler.all(yaml.load(written, yaml.CSafeLoader))
        fields |= filler.found
    return fields


class _Filler:
    """Walks data along its JSON Schema; `found` are the texts that it came by."""

    def __init__(self, root: Schema, say: Say, languages: tuple[str, ...]) -> None:
        self._root = root
        self._say = say
        self._languages = languages
        self.found: set[str] = set()

    def all(self, data: Any) -> Any:
        return self._filled(self._root, data)

    def is_text(self, key: str, schema: Schema) -> bool:
        """Whether a key takes any string, or a list of them."""
        choices = [choice for choice in self._choices(schema) if choice.get("type") != "null"]
        items = [item for choice in choices for item in self._choices(choice.get("items", {}))]
        return key not in LOOKED_UP and (_are_text(choices) or _are_text(items))

    def _filled(self, schema: Schema, value: Any) -> Any:
        if isinstance(value, list):
            items: Schema = next((item["items"] for item in self._choices(schema) if "items" in item), {})
            return [self._said("", items, item) for item in value]
        if not isinstance(value, dict):
            return value
        concept = self._concept(schema, value)
        result = dict(value)
        for key, inner in concept.get("properties", {}).items():
            if self.is_text(key, inner):
                self.found.add(f"{concept['title']}.{key}")
            if key in value or self.is_text(key, inner):
                result[key] = self._said(key, inner, value.get(key))
        for key in set(value) - set(concept.get("properties", {})):
            result[key] = self._said(key, _entries(concept), value[key])
        return result

    def _concept(self, schema: Schema, value: dict[str, Any]) -> Schema:
        """The choice of a schema that knows all keys of a mapping, or takes any."""
        choices = [choice for choice in self._choices(schema) if choice.get("type") == "object"]
        fitting = (choice for choice in choices if set(choice.get("properties", {})) >= set(value))
        return next(fitting, None) or next(filter(_entries, choices), {})

    def _said(self, key: str, schema: Schema, value: Any) -> Any:
        """A text where there should be one, in every language where it has languages; else what is there, filled."""
        if key in LOOKED_UP:
            return value
        if not self.is_text(key, schema):
            return self._filled(schema, value)
        choices = list(self._choices(schema))
        if any(map(_has_languages, choices)):
            return {language: self._say() for language in self._languages}
        if any(map(_is_any_string, choices)):
            return self._say()
        return self._filled(schema, [None])

    def _choices(self, schema: Schema) -> Iterator[Schema]:
        if "$ref" in schema:
            schema = self._root["$defs"][schema["$ref"].rsplit("/", 1)[1]]
        inner = [*schema.get("anyOf", ()), *schema.get("oneOf", ())]
        if not inner or "properties" in schema:
            yield schema
            return
        for choice in inner:
            yield from self._choices(choice)


@functools.cache
def _schema(concept: type[EditionSpec] | type[GoldenFramesSpec]) -> Schema:
    return json_schema(concept)


def _entries(schema: Schema) -> Schema:
    """The schema of the entries of a mapping that takes any key."""
    value: Schema | bool = schema.get("additionalProperties") or next(
        iter(schema.get("patternProperties", {}).values()), {}
    )
    return value if isinstance(value, dict) else {}


def _are_text(choices: list[Schema]) -> bool:
    return bool(choices) and all(_is_any_string(choice) or _has_languages(choice) for choice in choices)


def _has_languages(schema: Schema) -> bool:
    return "enum" in schema.get("propertyNames", {})


def _is_any_string(schema: Schema) -> bool:
    closed = {"pattern", "enum", "const", "format"} & set(schema)
    return schema.get("type") == "string" and (not closed or schema.get("pattern") == VISIBLE)
