"""Targets: each lays out the model for its templates.

Belongs here: the `Target` interface, the registry, and one package for each target of canwright. A target reads the
model and `semantics`, knows no YAML, and is reached through the registry alone, also by another target.
Imports `diagnostics`, `templating`, `model`, `language`, `semantics` and `compare`.
"""
