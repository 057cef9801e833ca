"""Diagnostics: position, rule, message, and what to write instead.

Belongs here: positions, findings, the nearest known name, and invisible characters.
Imports nothing of canwright.
"""
