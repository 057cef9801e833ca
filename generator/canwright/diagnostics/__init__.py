"""A finding about a spec: where it is, which rule it is of, its message, and what to write instead.

Belongs here: positions, findings, the nearest known name, and characters that are invisible to a reader.
Imports nothing of canwright.
"""
