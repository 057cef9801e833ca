"""YAML text to plain data with line and column, within limits, rejecting what is unsafe or ambiguous.

Belongs here: everything about YAML itself, for any document. A wrong line or column of a finding is repaired here.
Imports `diagnostics`.
"""
