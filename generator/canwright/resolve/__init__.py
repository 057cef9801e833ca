"""Validated spec to model: references, parameters, reply forms, bit positions.

Belongs here: everything that is decided once, while a spec becomes an edition.
Imports `diagnostics`, `document`, `templating`, `model`, `language` and `semantics`.
"""
