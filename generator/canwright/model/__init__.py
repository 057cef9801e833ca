"""The resolved edition: types, layouts, messages, commands and metadata; frozen and exact.

Belongs here: what every target reads, free of YAML, of targets and of any one protocol. Numbers are `int` or
`Fraction`. Imports `diagnostics`, for the paths that lead from an item back to its document.

Objects are constructed by keyword; only small numeric values (`Segment`, `Element`, `Linear`, `Bound`, `Range`, a
constant's raw value) take positional arguments. What has a name and a place in the spec is an entity and compares by
identity: edition, command, message, layout, variant, field, type, parameter, address, table, entry, effect, setting,
mode, erratum. Everything else is a value and compares by value.
"""
