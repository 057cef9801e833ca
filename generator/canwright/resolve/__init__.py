"""Decoded spec to model: references, parameters, reply forms, bit positions.

Belongs here: the construction of an edition, with checks of references and of keys that exclude each other.
Imports `diagnostics`, `document`, `templating`, `model` and `language`.
"""
