"""Logs of a bus: readers, and which editions the frames fit.

Belongs here: formats of recordings, and what is inferred from many frames. What one frame means is in `semantics`.
Imports every package but `cli`.
"""
