"""Every kind of change, in one table."""

from __future__ import annotations

from .change import Category, ChangeRule

_WIRE = (
    ("id-changed", "An address has another CAN id.", "the {direction} id is `{new}`, was `{old}`"),
    ("nodes-changed", "An address has other nodes.", "the nodes are {new}, were {old}"),
    ("address-added", "There is a new address.", "the address `{name}` is new, `{new}`"),
    ("address-removed", "An address is gone.", "the address `{name}`, `{old}`, is gone"),
    ("bit-rates-changed", "A bus mode has other bit rates.", "the bit rates are {new} kbit/s, were {old}"),
    ("mode-added", "There is a new bus mode.", "the bus mode `{name}` is new"),
    ("mode-removed", "A bus mode is gone.", "the bus mode `{name}` is gone"),
    ("command-added", "There is a new command.", "`{name}`{code} is new"),
    ("command-removed", "A command is gone.", "`{name}`{code} is gone"),
    (
        "command-repurposed",
        "A code means another command.",
        "the code of `{old}`{code} now means `{new}`: {meaning}",
    ),
    ("code-changed", "A command has another code.", "the code is {new}, was {old}"),
    (
        "code-taken",
        "The old code of a command now is that of another.",
        "the code is {new}, was {old}, which now means `{other}`",
    ),
    ("code-moved", "The code stands in other bits.", "the code stands in {new}, stood in {old}"),
    ("index-moved", "The index of a table stands in other bits.", "the index stands in {new}, stood in {old}"),
    ("index-changed", "An entry of a table has another index.", "the index is {new}, was {old}"),
    ("entry-added", "A table has a new entry.", "`{name}`, index {index}, is new"),
    ("entry-removed", "An entry of a table is gone.", "`{name}`, index {index}, is gone"),
    ("entry-repurposed", "An index means another entry.", "index {index} now means `{new}`, was `{old}`"),
    (
        "table-of-command-changed",
        "A command reads and writes by an index, or ceases to.",
        "it uses {new}, used {old}",
    ),
    ("reply-code-changed", "A reply starts with another code.", "the reply has the code {new}, had {old}"),
    ("accept-changed", "A reply may have other codes.", "a receiver also takes the codes {new}, took {old}"),
    ("reply-form-changed", "The reply comes about in another way.", "the reply is `{new}`, was `{old}`"),
    ("request-changed", "A command gets or loses its request.", "the request is `{new}`, was `{old}`"),
    ("repliers-changed", "Other nodes reply.", "replies come from {new}, came from {old}"),
    ("address-of-command-changed", "A frame uses another address.", "the {direction} uses `{new}`, used `{old}`"),
    ("mode-of-command-changed", "A command needs another bus mode.", "it belongs to the mode `{new}`, was `{old}`"),
    ("dlc-changed", "A frame has another number of data bytes.", "the {direction} has {new} data bytes, had {old}"),
    ("frame-kind-changed", "A data frame became a remote frame, or back.", "the {direction} is a {new}, was a {old}"),
    ("availability-changed", "Other nodes have a command.", "it is there for {new}, was for {old}"),
    ("implemented-changed", "A command begins or ceases to work.", "implemented: {new}, was {old}"),
    ("field-added", "A frame has a new field.", "`{name}` is new in {place}"),
    ("field-removed", "A field is gone.", "`{name}` in {place} is gone"),
    ("field-replaced", "Bits hold another field.", "{place} now holds `{new}`, held `{old}`"),
    ("field-moved", "A field stands in other bits.", "`{name}` moves from {old} to {new}"),
    ("field-condition-changed", "A field is there for others.", "`{name}` is there for {new}, was for {old}"),
    ("holds-changed", "A field began or ceased to tell the node.", "`{name}` holds {new}, held {old}"),
    ("constant-changed", "A constant field holds something else.", "`{name}` holds {new}, held {old}"),
    ("array-changed", "An array has other elements.", "the elements of `{name}` are {new}, were {old}"),
    ("width-changed", "A raw integer has another width.", "`{name}` has {new} bits, had {old}"),
    ("sign-changed", "A raw integer gets or loses its sign.", "`{name}` is {new}, was {old}"),
    ("encoding-changed", "An integer became a float, or back.", "`{name}` is {new}, was {old}"),
    ("byte-order-changed", "Bytes come in another order.", "`{name}` is {new}-endian, was {old}-endian"),
)
_VALUE = (
    ("scale-changed", "A raw step is worth something else.", "one step of `{name}`{when} is {new}, was {old}"),
    ("offset-changed", "Raw 0 is worth something else.", "raw 0 of `{name}`{when} is {new}, was {old}"),
    ("unit-changed", "A value has another unit.", "`{name}` is in {new}, was in {old}"),
    ("range-changed", "A range is another one.", "the raw range of `{name}`{when} is {new}, was {old}"),
    ("member-added", "An enum has a new member, or flags a new bit.", "`{member}` ({value}) is new in `{name}`"),
    ("member-removed", "A member or a flag is gone.", "`{member}` ({value}) of `{name}` is gone"),
    ("member-renumbered", "A member has another value.", "`{member}` of `{name}` is {new}, was {old}"),
    ("parameter-bounds-changed", "A number has other bounds.", "`{name}` lies in {new}, was {old}"),
    ("effects-changed", "A command does something else besides.", "effects: {new}; were: {old}"),
    ("limits-changed", "Other settings limit a command.", "limited by: {new}; was: {old}"),
    ("reply-time-changed", "Replies take another time.", "milliseconds to a reply: {new}, was {old}"),
    ("max-nodes-changed", "A bus holds another number of nodes.", "most nodes on a bus: {new}, was {old}"),
)
_API = (
    ("command-renamed", "A command has another name.", "`{old}` is called `{new}`: {names}"),
    ("entry-renamed", "An entry of a table has another name.", "`{old}` is called `{new}`"),
    ("field-renamed", "A field has another name.", "`{old}` is called `{new}`: {names}"),
    ("type-renamed", "A type has another name.", "`{old}` is called `{new}`: {names}"),
    ("type-of-field-changed", "A field has another type.", "`{name}` has the type `{new}`, had `{old}`"),
    ("member-renamed", "A member or a flag has another name.", "`{old}` of `{name}` is called `{new}`: {names}"),
    ("layout-renamed", "A shared layout has another name.", "`{old}` is called `{new}`: {names}"),
    ("address-renamed", "An address has another name.", "`{old}` is called `{new}`"),
    ("table-renamed", "A table has another name.", "`{old}` is called `{new}`"),
    ("mode-renamed", "A bus mode has another name.", "`{old}` is called `{new}`"),
    ("host-renamed", "The host has another name.", "`{old}` is called `{new}`: {names}"),
    ("setting-renamed", "A setting has another name.", "`{old}` is called `{new}`: {names}"),
    ("effect-renamed", "An effect has another name.", "`{old}` is called `{new}`: {names}"),
    ("parameter-renamed", "A parameter has another name.", "`{old}` is called `{new}`: {names}"),
    (
        "parameter-value-renamed",
        "A value of a parameter has another name.",
        "`{old}` of `{name}` is called `{new}`: {names}",
    ),
    ("parameter-added", "There is a new parameter.", "the parameter `{name}` is new"),
    ("parameter-removed", "A parameter is gone.", "the parameter `{name}` is gone"),
    ("parameter-value-added", "A parameter has a new value.", "`{name}` can be `{value}`"),
    ("parameter-value-removed", "A value of a parameter is gone.", "`{name}` cannot be `{value}` any more"),
    (
        "parameters-of-type-changed",
        "A value depends on other parameters.",
        "`{name}` depends on {new}, did on {old}",
    ),
)
_DOC = (
    ("title-changed", "A title is another one.", "the title of `{name}` is “{new}”, was “{old}”"),
    ("text-changed", "A text is another one.", "the text of `{name}` is another one"),
    ("section-changed", "The manual says it elsewhere.", "section {new} of the manual, was {old}"),
    ("scale-rewritten", "The same scale is written otherwise.", "`{name}`{when} is given as {new}, was as {old}"),
    ("languages-changed", "Texts are given in other languages.", "the texts are in {new}, were in {old}"),
    ("effect-level-changed", "An effect matters more, or less.", "`{name}` counts as {new}, did as {old}"),
    ("setting-scope-changed", "Other nodes have a setting.", "`{name}` is there for {new}, was for {old}"),
    ("setting-added", "There is a new setting.", "the setting `{name}` is new"),
    ("setting-removed", "A setting is gone.", "the setting `{name}` is gone"),
    ("erratum-added", "There is a new erratum.", "the erratum `{name}` is new: {used}"),
    ("erratum-removed", "An erratum is gone.", "the erratum `{name}` is gone"),
    ("erratum-moved", "An erratum is about something else.", "the erratum `{name}` is about {new}, was about {old}"),
    ("erratum-changed", "An erratum says something else.", "the erratum `{name}` says something else: {used}"),
)

CHANGES: dict[str, ChangeRule] = {
    id_: ChangeRule(id_, category, purpose, says)
    for category, rows in (
        (Category.WIRE, _WIRE),
        (Category.VALUE, _VALUE),
        (Category.API, _API),
        (Category.DOC, _DOC),
    )
    for id_, purpose, says in rows
}
