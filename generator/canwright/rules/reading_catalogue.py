"""The rules that loading and resolving check: about files, YAML, the language and references."""

from __future__ import annotations

from ..document.builder import MAX_VALUES
from ..document.document import MAX_BYTES
from .rule import Rule

LOAD_RULES: tuple[Rule, ...] = (
    Rule("file-size", f"A file has at most {MAX_BYTES >> 20} MiB and {MAX_VALUES} values."),
    Rule("encoding", "A file is UTF-8 text."),
    Rule("unsafe-character", "Text has no invisible characters and none that change how others are displayed."),
    Rule("yaml", "A file is one YAML document, a mapping with plain keys and a value behind each."),
    Rule("yaml-alias", "There are no anchors, aliases or merge keys; types and layouts have names for that."),
    Rule("yaml-tag", "A spec is plain data, without YAML tags."),
    Rule("yaml-depth", "Nesting has at most 24 levels."),
    Rule("duplicate-key", "A mapping has no duplicate keys."),
    Rule("ambiguous-scalar", "Every value has one meaning for all YAML readers; `no`, `1_0` and `12:30` need quotes."),
    Rule("missing-key", "Required keys are present."),
    Rule("unknown-key", "Every key is defined in the language."),
    Rule("type", "A value has the expected type: mapping, list, text or number."),
    Rule("value", "A value has the notation of its key."),
    Rule("name", "A name consists of letters, digits and underscores, so that every target can use it."),
    Rule("other-edition", "Golden frames name the edition of the spec that they belong to."),
    Rule("unknown-reference", "A referenced name is defined."),
    Rule("missing-language", "Every text is given in every language of the edition."),
    Rule("missing-reply", "Every command has a `reply`, if only `none`."),
    Rule("echo-of-nothing", "Only a command with a request can echo it."),
    Rule("entry-of-nothing", "Only a command with a table can have an entry's layout."),
    Rule("circular-reference", "References between replies form neither a circle nor a long chain."),
    Rule("reply-of-table", "A reply of a command with a table is used only by commands with the same table."),
    Rule("no-effect", "A request, a reply and a field have only keys that affect them."),
    Rule("sending", "What is stated about when a frame is sent does not contradict itself."),
    Rule("too-many-values", "An entry has no more index values than its table has selectors."),
    Rule("no-selector", "A `selector` gives the position of the codes."),
    Rule("code-width", "Codes and index values fit the bits of their selector."),
    Rule("address-id", "An address has one id for each direction, and nodes where an id depends on them."),
    Rule("id-space", "Ids fit into 11 bits, extended ids into 29."),
    Rule("bit-runs", "The runs of bits of a field are different, in its byte order, and as wide as its type."),
    Rule("field-type", "A field has either a type or a raw format."),
    Rule("checksum-parameters", "A checksum is a named algorithm, or a CRC with a polynomial."),
    Rule(
        "two-ranges",
        "A range is given in raw integers or in the unit, not both; in the unit only where there is a scale.",
    ),
    Rule(
        "two-parameters", "The fields of a layout depend on one parameter, and so do scale, offset and range of a type."
    ),
    Rule("incomplete-choice", "What depends on a parameter is given for each of its values."),
    Rule("stale-output", "The generated files agree with the specs."),
    Rule("target-contradiction", "Generated code decodes, encodes and rejects golden frames as listed."),
    Rule("not-tested", "A test asks at least one golden frame of each edition."),
    Rule("parameter-kind", "A parameter is a choice or a number, and is used only where its kind is allowed."),
)
