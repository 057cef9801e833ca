"""YAML text to plain data with line and column: limits, and rejection of unsafe or ambiguous YAML.

Belongs here: everything about YAML itself, for any document. An incorrect line or column of a finding is fixed here.
Imports `diagnostics`.
"""
