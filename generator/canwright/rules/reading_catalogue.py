"""The rules that loading and resolving check: about files, YAML, the language and references."""

from __future__ import annotations

from typing import NamedTuple

from ..diagnostics.diagnostic import Severity
from ..document.builder import MAX_VALUES
from ..document.document import MAX_BYTES


class LoadRule(NamedTuple):
    """An id for people to look up, and what the rule wants."""

    id: str
    purpose: str
    severity: Severity = Severity.ERROR


LOAD_RULES: tuple[LoadRule, ...] = (
    LoadRule("file-size", f"A file has at most {MAX_BYTES >> 20} MiB and {MAX_VALUES} values."),
    LoadRule("encoding", "A file is UTF-8 text."),
    LoadRule("unsafe-character", "Text has no invisible characters and none that change how others are displayed."),
    LoadRule("yaml", "A file is one YAML document, a mapping with plain keys and a value behind each."),
    LoadRule("yaml-alias", "There are no anchors, aliases or merge keys; types and layouts have names for that."),
    LoadRule("yaml-tag", "A spec is plain data, without YAML tags."),
    LoadRule("yaml-depth", "Nesting has at most 24 levels."),
    LoadRule("duplicate-key", "A mapping has no duplicate keys."),
    LoadRule(
        "ambiguous-scalar", "Every value has one meaning for all YAML readers; `no`, `1_0` and `12:30` need quotes."
    ),
    LoadRule("missing-key", "Required keys are present."),
    LoadRule("unknown-key", "Every key is defined in the language."),
    LoadRule("type", "A value has the expected type: mapping, list, text or number."),
    LoadRule("value", "A value has the notation of its key."),
    LoadRule("name", "A name consists of letters, digits and underscores, so that every target can use it."),
    LoadRule("other-edition", "Golden frames name the edition of the spec that they belong to."),
    LoadRule("unknown-reference", "A referenced name is defined."),
    LoadRule("missing-language", "Every text is given in every language of the edition."),
    LoadRule("missing-reply", "Every command has a `reply`, if only `none`."),
    LoadRule("echo-of-nothing", "Only a command with a request can echo it."),
    LoadRule("entry-of-nothing", "Only a command with a table can have an entry's layout."),
    LoadRule("circular-reference", "References between replies form neither a circle nor a long chain."),
    LoadRule("reply-of-table", "A reply of a command with a table is used only by commands with the same table."),
    LoadRule("no-effect", "A request, a reply and a field have only keys that affect them."),
    LoadRule("sending", "What is stated about when a frame is sent does not contradict itself."),
    LoadRule("too-many-values", "An entry has no more index values than its table has selectors."),
    LoadRule("no-selector", "A `selector` gives the position of the codes."),
    LoadRule("code-width", "Codes and index values fit the bits of their selector."),
    LoadRule("address-id", "An address has one id for each direction, and nodes where an id depends on them."),
    LoadRule("id-space", "Ids fit into 11 bits, extended ids into 29."),
    LoadRule("bit-runs", "The runs of bits of a field are different, in its byte order, and as wide as its type."),
    LoadRule("field-type", "A field has either a type or a raw format."),
    LoadRule("checksum-parameters", "A checksum is a named algorithm, or a CRC with a polynomial."),
    LoadRule(
        "two-ranges",
        "A range is given in raw integers or in the unit, not both; in the unit only where there is a scale.",
    ),
    LoadRule(
        "two-parameters", "The fields of a layout depend on one parameter, and so do scale, offset and range of a type."
    ),
    LoadRule("incomplete-choice", "What depends on a parameter is given for each of its values."),
    LoadRule("stale-output", "The generated files agree with the specs."),
    LoadRule("target-contradiction", "Generated code decodes, encodes and rejects golden frames as listed."),
    LoadRule("not-tested", "A test asks at least one golden frame of each edition."),
    LoadRule("parameter-kind", "A parameter is a choice or a number, and is used only where its kind is allowed."),
)
