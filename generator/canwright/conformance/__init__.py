"""Replays golden frames through the reference decoder and encoder and through generated code, and compares.

Belongs here: the questions that a golden frame is for a target, and for some targets what drives their output as users do.
Imports `model`, `semantics` and `targets`. cantools is imported only by the modules about DBC files.
"""
