"""Writes the files of a run: all of them or none.

Belongs here: safe paths, the manifest, the transaction, the lock between two runs. Knows neither specs nor targets.
Imports `diagnostics`.
"""
