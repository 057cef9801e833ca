"""The resolved edition: types, layouts, messages, commands and metadata; frozen and exact.

Belongs here: what every target reads, free of YAML, of targets and of any one protocol. Numbers are `int` or
`Fraction`. Imports `diagnostics`, for the paths that lead from an item back to its document.
"""
