"""Witness frames: what an old host and a new node make of one another's frames, by running both editions.

Belongs here: which frames are tried, how the meaning of two readings is compared, and the sentence about a witness.
"""
