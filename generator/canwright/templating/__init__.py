"""The Jinja2 environment, escaping for markup, and the files that are installed with canwright.

Belongs here: how templates are loaded and compiled. What they contain is up to each target.
Imports `diagnostics`, for characters that are shown by their number.
"""
