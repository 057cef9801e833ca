"""The resolved edition: types, layouts, messages, commands and metadata; frozen and exact.

Belongs here: what every target reads. Nothing here depends on YAML, on a target or on one protocol. Numbers are `int`
or `Fraction`. Imports `diagnostics`, for the paths that lead from an item back to its document.

Objects are constructed by keyword; only small numeric values (`Segment`, `Element`, `Linear`, `Bound`, `Range`, a
constant's raw value) take positional arguments. An item with a name and a position in the spec is an entity and
compares by identity: edition, command, message, layout, variant, field, type, parameter, address, table, entry, effect,
setting, mode, erratum. Everything else is a value and compares by value.
"""
