"""Load, check and generate the specs of a folder; golden frames, git revisions, the site.

Belongs here: the combination of other packages into one run, without printing.
Imports `diagnostics`, `document`, `model`, `language`, `resolve`, `targets`, `rules` and `output`.
"""
