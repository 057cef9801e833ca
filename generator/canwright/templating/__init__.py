"""The Jinja2 environment, and the files that an installed canwright brings along.

Belongs here: how templates are loaded and compiled. What they contain is up to each target.
Imports nothing of canwright.
"""
