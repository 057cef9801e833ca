"""The Jinja2 environment, and the data files of canwright.

Belongs here: loading and compilation of templates. Their content belongs to the targets.
Imports nothing of canwright.
"""
