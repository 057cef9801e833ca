"""Logs of a bus: readers of log formats, and the identification of the edition.

Belongs here: log formats, and conclusions from many frames. The meaning of one frame is in `semantics`.
Imports `model`, `semantics` and `compare`.
"""
