"""Table of all kinds of change: rule, category, purpose and sentence."""

from __future__ import annotations

from .change import Category, ChangeRule

_WIRE = (
    ("id-changed", "An address has a different CAN id.", "the {direction} id is `{new}` (was `{old}`)"),
    ("nodes-changed", "An address has different nodes.", "the nodes are {new} (were {old})"),
    ("address-added", "An address is added.", "the address `{name}`, `{new}`, is added"),
    ("address-removed", "An address is removed.", "the address `{name}`, `{old}`, is removed"),
    ("bit-rates-changed", "A bus mode has different bit rates.", "the bit rates are {new} kbit/s (were {old})"),
    (
        "frame-format-changed",
        "The frames of a bus have a different format.",
        "the frame format is {new} (was {old})",
    ),
    ("mode-added", "A bus mode is added.", "the bus mode `{name}` is added"),
    ("mode-removed", "A bus mode is removed.", "the bus mode `{name}` is removed"),
    ("command-added", "A command is added.", "`{name}`{code} is added"),
    ("command-removed", "A command is removed.", "`{name}`{code} is removed{deprecation}"),
    (
        "command-repurposed",
        "A code identifies a different command.",
        "the code of `{old}`{code} now means `{new}`: {meaning}",
    ),
    ("code-changed", "A command has a different code.", "the code is {new} (was {old})"),
    (
        "code-taken",
        "A command has a different code, and its old code now identifies another command.",
        "the code is {new} (was {old}, which now means `{other}`)",
    ),
    ("code-moved", "The code is at a different bit position.", "the code is at {new} (was at {old})"),
    ("index-moved", "The index of a table is at a different bit position.", "the index is at {new} (was at {old})"),
    ("index-changed", "An entry of a table has a different index.", "the index is {new} (was {old})"),
    ("entry-added", "An entry is added to a table.", "`{name}`, index {index}, is added"),
    ("entry-removed", "An entry of a table is removed.", "`{name}`, index {index}, is removed"),
    (
        "entry-repurposed",
        "An index identifies a different entry.",
        "the index {index} now means `{new}` (was `{old}`)",
    ),
    (
        "kind-changed",
        "An entry of a table has a different kind, on which codes depend.",
        "the kind is `{new}` (was `{old}`)",
    ),
    (
        "table-of-command-changed",
        "A command uses a different table, starts to use one, or stops using one.",
        "the command uses {new} (was {old})",
    ),
    ("reply-code-changed", "A reply has a different code.", "the reply code is {new} (was {old})"),
    ("accept-changed", "A reply is accepted with different codes.", "accepted reply codes: {new} (was {old})"),
    ("reply-form-changed", "A reply has a different form.", "the reply form is `{new}` (was `{old}`)"),
    ("request-changed", "The request of a command is added or removed.", "the request is `{new}` (was `{old}`)"),
    ("repliers-changed", "Different nodes reply.", "replies come from {new} (was {old})"),
    (
        "further-replies-changed",
        "Replies of different commands follow the reply.",
        "further replies: {new} (was {old})",
    ),
    (
        "alternative-replies-changed",
        "Replies of different commands can come instead of the reply.",
        "alternative replies: {new} (was {old})",
    ),
    (
        "frame-numbers-changed",
        "A reply has a different number of frames, or they are numbered differently.",
        "the {direction} has {new} (was {old})",
    ),
    (
        "address-of-command-changed",
        "A frame uses a different address.",
        "the {direction} uses the address `{new}` (was `{old}`)",
    ),
    (
        "mode-of-command-changed",
        "A command needs a different bus mode.",
        "the command belongs to the mode `{new}` (was `{old}`)",
    ),
    (
        "dlc-changed",
        "A frame has a different number of data bytes.",
        "the {direction} has {new} data bytes (was {old})",
    ),
    (
        "frame-kind-changed",
        "A data frame becomes a remote frame, or a remote frame a data frame.",
        "the {direction} is a {new} (was a {old})",
    ),
    (
        "availability-changed",
        "A command is available for different nodes.",
        "the command is available for {new} (was {old})",
    ),
    ("implemented-changed", "A command is implemented, or no longer is.", "implemented: {new} (was {old})"),
    ("field-added", "A field is added to a frame.", "`{name}` is added at {place}"),
    ("field-removed", "A field of a frame is removed.", "`{name}` at {place} is removed{deprecation}"),
    ("field-replaced", "The same bits contain a different field.", "{place} now contains `{new}` (was `{old}`)"),
    ("field-moved", "A field is at a different bit position.", "`{name}` is moved from {old} to {new}"),
    (
        "field-condition-changed",
        "A field is available for different nodes.",
        "`{name}` is available for {new} (was {old})",
    ),
    (
        "holds-changed",
        "A field contains the node number, or no longer does.",
        "`{name}` contains {new} (was {old})",
    ),
    ("constant-changed", "A constant has a different value.", "the value of `{name}` is {new} (was {old})"),
    (
        "checksum-changed",
        "A field becomes a checksum or is none any more, or the checksum is computed differently.",
        "`{name}` is {new} (was {old})",
    ),
    ("array-changed", "An array has different elements.", "the elements of `{name}` are {new} (were {old})"),
    ("width-changed", "A raw integer has a different width.", "`{name}` has {new} bits (was {old})"),
    ("sign-changed", "A raw integer becomes signed or unsigned.", "`{name}` is {new} (was {old})"),
    ("encoding-changed", "An integer becomes a float, or a float an integer.", "`{name}` is {new} (was {old})"),
    (
        "field-format-changed",
        "A field has a different type with another raw format.",
        "`{name}` has the type `{new}` (was `{old}`): {changes}",
    ),
    ("byte-order-changed", "The byte order is changed.", "`{name}` is {new}-endian (was {old}-endian)"),
    (
        "frames-affected",
        "Frames of a command are understood differently because of a change of another command.",
        "frames of `{name}` are understood differently because of a change of another command",
    ),
)
_VALUE = (
    ("scale-changed", "A scale is changed.", "the resolution of `{name}`{when} is {new} (was {old})"),
    ("offset-changed", "An offset is changed.", "the offset of `{name}`{when} is {new} (was {old})"),
    (
        "field-meaning-changed",
        "A field has a different type, whose values have another meaning.",
        "`{name}` has the type `{new}` (was `{old}`): {changes}",
    ),
    (
        "joined-changed",
        "Bytes or digits become a text or a number, no longer are one, or are read in another way.",
        "`{name}` is read as {new} (was {old})",
    ),
    ("unit-changed", "A unit is changed.", "the unit of `{name}` is {new} (was {old})"),
    ("range-changed", "A range is changed.", "the raw range of `{name}`{when} is {new} (was {old})"),
    (
        "member-added",
        "A member is added to an enum, to flags or to `no_value`.",
        "`{member}` ({value}) is added to `{name}`",
    ),
    (
        "member-removed",
        "A member of an enum, of flags or of `no_value` is removed.",
        "`{member}` ({value}) of `{name}` is removed{deprecation}",
    ),
    ("member-renumbered", "A member has a different value.", "`{member}` of `{name}` is {new} (was {old})"),
    (
        "member-replaced",
        "A value of an enum or a bit of flags has another meaning.",
        "{value} of `{name}` now means `{new}` (was `{old}`)",
    ),
    (
        "member-effects-changed",
        "Different effects do not occur if a request contains a value.",
        "effects that do not occur with `{member}` of `{name}`: {new}; were: {old}",
    ),
    ("parameter-bounds-changed", "A number has different bounds.", "the bounds of `{name}` are {new} (were {old})"),
    ("effects-changed", "A command has different effects.", "effects: {new}; were: {old}"),
    ("state-entry-changed", "A state is entered by other commands.", "`{name}` is entered by {new} (was {old})"),
    ("state-effects-changed", "A state prevents other effects.", "`{name}` prevents {new} (was {old})"),
    ("limits-changed", "A command is limited by different settings.", "limited by: {new}; was: {old}"),
    ("reply-time-changed", "The maximum reply time is changed.", "the reply time in ms is {new} (was {old})"),
    ("sending-changed", "A frame is sent on other occasions.", "the {direction} is sent {new} (was {old})"),
    (
        "period-changed",
        "A cyclic frame has a different period.",
        "the period of the {direction} in ms is {new} (was {old})",
    ),
    (
        "timeout-changed",
        "The silence that a receiver treats as a failure is changed.",
        "the time-out of the {direction} in ms is {new} (was {old})",
    ),
    (
        "counter-changed",
        "A field becomes a counter or is none any more, or the counter has other values.",
        "`{name}` is {new} (was {old})",
    ),
    (
        "max-nodes-changed",
        "The maximum number of nodes on a bus is changed.",
        "the maximum number of nodes on a bus is {new} (was {old})",
    ),
)
_API = (
    ("command-renamed", "A command is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    (
        "short-name-changed",
        "The short name of a command is changed.",
        "the short name is `{new}` (was `{old}`): {names}",
    ),
    ("entry-renamed", "An entry of a table is renamed.", "`{old}` is renamed to `{new}`"),
    ("field-renamed", "A field is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    ("type-renamed", "A type is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    ("type-of-field-changed", "A field has a different type.", "`{name}` has the type `{new}` (was `{old}`)"),
    (
        "member-renamed",
        "A member of an enum or of flags is renamed.",
        "`{old}` of `{name}` is renamed to `{new}`: {names}",
    ),
    (
        "layout-of-command-changed",
        "The same fields are defined in a different place: in a shared layout, or in the command.",
        "the {direction} has {new} (was {old}): {names}",
    ),
    ("layout-renamed", "A shared layout is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    ("address-renamed", "An address is renamed.", "`{old}` is renamed to `{new}`"),
    ("table-renamed", "A table is renamed.", "`{old}` is renamed to `{new}`"),
    ("mode-renamed", "A bus mode is renamed.", "`{old}` is renamed to `{new}`"),
    ("host-renamed", "The host is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    ("setting-renamed", "A setting is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    ("effect-renamed", "An effect is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    ("parameter-renamed", "A parameter is renamed.", "`{old}` is renamed to `{new}`: {names}"),
    (
        "parameter-value-renamed",
        "A value of a parameter is renamed.",
        "`{old}` of `{name}` is renamed to `{new}`: {names}",
    ),
    (
        "names-changed",
        "Names in the bindings disappear without another change of their item.",
        "names in the bindings disappear: {names}",
    ),
    ("parameter-added", "A parameter is added.", "the parameter `{name}` is added"),
    ("parameter-removed", "A parameter is removed.", "the parameter `{name}` is removed"),
    ("parameter-value-added", "A value is added to a parameter.", "the value `{value}` of `{name}` is added"),
    ("parameter-value-removed", "A value of a parameter is removed.", "the value `{value}` of `{name}` is removed"),
    (
        "parameters-of-type-changed",
        "A value depends on different parameters.",
        "`{name}` depends on {new} (was {old})",
    ),
)
_DOC = (
    ("deprecation-added", "An item is deprecated.", "`{name}` is deprecated: {new}"),
    ("deprecation-changed", "An item is deprecated for another time.", "`{name}` is deprecated {new} (was {old})"),
    ("deprecation-removed", "An item is no longer deprecated.", "`{name}` is no longer deprecated (was {old})"),
    ("title-changed", "A title is changed.", "the title of `{name}` is “{new}” (was “{old}”)"),
    ("text-changed", "A text is changed.", "the text of `{name}` is changed"),
    ("section-changed", "The section of the manual is changed.", "the manual section is {new} (was {old})"),
    ("manual-name-changed", "The name in the manual is changed.", "the name in the manual is {new} (was {old})"),
    (
        "scale-rewritten",
        "The same scale is written differently.",
        "the scale of `{name}`{when} is written as {new} (was {old})",
    ),
    (
        "plausible-changed",
        "The values that a working node reports are changed.",
        "the plausible values of `{name}` are {new} (were {old})",
    ),
    ("languages-changed", "The texts are in different languages.", "the languages are {new} (were {old})"),
    ("effect-level-changed", "An effect has a different level.", "the level of `{name}` is {new} (was {old})"),
    (
        "setting-scope-changed",
        "A setting is available for different nodes.",
        "`{name}` is available for {new} (was {old})",
    ),
    ("state-added", "A state is added.", "the state `{name}` is added"),
    ("state-removed", "A state is removed.", "the state `{name}` is removed"),
    ("setting-added", "A setting is added.", "the setting `{name}` is added"),
    ("setting-removed", "A setting is removed.", "the setting `{name}` is removed"),
    ("erratum-added", "An erratum is added.", "the erratum `{name}` is added: {used}"),
    ("erratum-removed", "An erratum is removed.", "the erratum `{name}` is removed"),
    (
        "erratum-moved",
        "An erratum is about a different part of the spec.",
        "the erratum `{name}` is about {new} (was about {old})",
    ),
    ("erratum-changed", "The text of an erratum is changed.", "the erratum `{name}` is changed: {used}"),
)

_WITHOUT_WITNESS = {
    "address-added": "frames",
    "effects-changed": "effects",
    "implemented-changed": "effects",
    "limits-changed": "effects",
    "member-effects-changed": "effects",
    "state-effects-changed": "effects",
    "state-entry-changed": "effects",
    "bit-rates-changed": "setting",
    "frame-format-changed": "setting",
    "max-nodes-changed": "setting",
    "counter-changed": "several",
    "mode-added": "setting",
    "mode-of-command-changed": "setting",
    "mode-removed": "setting",
    "parameter-bounds-changed": "setting",
    "frame-numbers-changed": "several",
    "period-changed": "timing",
    "reply-time-changed": "timing",
    "sending-changed": "timing",
    "timeout-changed": "timing",
}
"""The changes of bits and of meaning that no frame shows, with the key of the reason."""

CHANGES: dict[str, ChangeRule] = {
    id_: ChangeRule(id_, category, purpose, says, _WITHOUT_WITNESS.get(id_, ""))
    for category, rows in (
        (Category.WIRE, _WIRE),
        (Category.VALUE, _VALUE),
        (Category.API, _API),
        (Category.DOC, _DOC),
    )
    for id_, purpose, says in rows
}
