"""What is found while a spec is read: by the YAML reader, by the language, and where names are looked up."""

from __future__ import annotations

from .rule import Rule

READING: tuple[Rule, ...] = (
    Rule("file-size", "A file has at most 8 MiB."),
    Rule("encoding", "A file is UTF-8 text."),
    Rule("unsafe-character", "A text has no character that cannot be seen or changes how others are shown."),
    Rule("yaml", "A file is one YAML document, a mapping with plain keys and a value behind each."),
    Rule("yaml-alias", "There are no anchors, aliases or merge keys; types and layouts have names for that."),
    Rule("yaml-tag", "A spec is plain data, without YAML tags."),
    Rule("yaml-depth", "Nothing is nested deeper than 24 levels."),
    Rule("duplicate-key", "No key stands twice in one mapping."),
    Rule("ambiguous-scalar", "Every value means the same to every YAML reader: `no`, `1_0` or `12:30` need quotes."),
    Rule("missing-key", "Every concept has the keys that it needs."),
    Rule("unknown-key", "Every key is one of the language."),
    Rule("type", "A mapping stands where one is wanted, and a text where a text is wanted."),
    Rule("value", "A value is written the way that the language reads it."),
    Rule("name", "A name has letters, digits and underscores, so that every target can have it."),
    Rule("other-edition", "Golden frames stand beside the edition that they name."),
    Rule("unknown-reference", "A name that is referred to is there."),
    Rule("missing-language", "Every text is given in every language of the edition."),
    Rule("missing-reply", "Every command has a `reply`, if only `none`."),
    Rule("echo-of-nothing", "Only a command with a request can echo it."),
    Rule("entry-of-nothing", "Only a command with a table can have an entry's layout."),
    Rule("circular-reference", "Replies are not taken from one another in a circle, nor in a long chain."),
    Rule("reply-of-table", "Only a command with the same table takes the replies of one that has a table."),
    Rule("no-effect", "A request, a reply and a field say nothing that does not concern them."),
    Rule("too-many-values", "An entry has no more index values than its table has selectors."),
    Rule("no-selector", "A `selector` gives the position of the codes."),
    Rule("code-width", "Codes and index values fit the bits of their selector."),
    Rule("address-id", "An address has one id for each direction, and nodes where an id depends on them."),
    Rule("id-space", "Ids fit the 11 bits of a CAN id, or the 29 of an extended one."),
    Rule("field-type", "A field has a type or a raw format, and not both."),
    Rule(
        "two-ranges",
        "A range is given in raw integers or in the unit, not both; in the unit only where there is a scale.",
    ),
    Rule(
        "two-parameters", "The fields of a layout depend on one parameter, and so do scale, offset and range of a type."
    ),
    Rule("incomplete-choice", "What depends on a parameter is given for each of its values."),
    Rule("stale-output", "What is generated is what the specs say."),
    Rule("parameter-kind", "A parameter is a choice among values or a number, and stands where such a one can."),
)
