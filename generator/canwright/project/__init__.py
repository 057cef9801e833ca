"""The specs of a folder: loaded, checked and generated; golden frames, git revisions, the site.

Belongs here: what combines the other packages into one run, without printing anything.
Imports every package but `recordings` and `cli`.
"""
