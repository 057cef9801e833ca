"""The spec language and that of golden frames: schema, notation, validation, and messages about mistakes.

Belongs here: which keys there are, how a value is written, and what the author of a wrong spec probably meant.
Imports `diagnostics`, `document`, `templating` and `model`.
"""
