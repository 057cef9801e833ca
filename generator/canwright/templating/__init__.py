"""The Jinja2 environment, escaping for markup, and the data files of canwright.

Belongs here: loading and compilation of templates. Their content belongs to the targets.
Imports `diagnostics`, for characters that are shown by their number.
"""
