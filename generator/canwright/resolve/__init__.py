"""Decoded spec to model: parameters, types, layouts, reply forms, bit positions.

Belongs here: the construction of an edition from a spec in which every name is defined.
Imports `diagnostics`, `document`, `templating`, `model` and `language`.
"""
