"""The spec language and that of golden frames: schema, notation, validation, and messages about mistakes.

Belongs here: the keys, the notations of values, the check of references, and the suggestions for invalid specs.
Imports `diagnostics`, `document`, `templating` and `model`.
"""
